"""Writes the numbers of ``neurotouch stream lsl`` to a CSV file: record_lsl.py FILE SECONDS.

Needs pylsl, which comes with ``pip install 'neurotouch-hid[lsl]'``.
"""

import csv
import sys
from pathlib import Path

import pylsl


def main(path: Path, seconds: float) -> None:
    """Records until the time is over."""
    found = pylsl.resolve_byprop("name", "neurotouch", 1, 10.0)
    if not found:
        sys.exit("No stream 'neurotouch' was found. Start it: neurotouch stream lsl")
    inlet = pylsl.StreamInlet(found[0])
    info = inlet.info(10.0)  # its channels are freed with it
    channel = info.desc().child("channels").child("channel")
    names = ["lsl_time"]
    while not channel.empty():
        names.append(channel.child_value("label"))
        channel = channel.next_sibling()
    end = pylsl.local_clock() + seconds
    with path.open("w", newline="") as file:
        rows = csv.writer(file)
        rows.writerow(names)
        while pylsl.local_clock() < end:
            values, stamp = inlet.pull_sample(1.0)
            if stamp is not None:
                rows.writerow([stamp, *values])


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit("Usage: record_lsl.py FILE SECONDS")
    main(Path(sys.argv[1]), float(sys.argv[2]))
