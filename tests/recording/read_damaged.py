"""Reads damaged copies of a recording and prints every fault that is not a RecordingError.

Runs in a process of its own, so that an abort or a hang inside a library fails one test only:
``python read_damaged.py ORIGINAL SCRATCH N_CUTS N_FLIPS``.
"""

import random
import sys
from collections.abc import Iterator
from pathlib import Path

from neurotouch_hid.errors import RecordingError
from neurotouch_hid.recording import Recording


def damaged_copies(data: bytes, n_cuts: int, n_flips: int) -> Iterator[tuple[str, bytes]]:
    chance = random.Random(4)
    header = min(400, len(data))
    cuts = {0, 1, 13, 14, 17, 18, 40, 100, len(data) - 1}
    cuts |= {chance.randrange(len(data)) for _ in range(n_cuts)}
    for cut in sorted(cuts):
        yield f"cut at {cut}", data[:cut]
    places = [chance.randrange(len(data)) for _ in range(n_flips)]
    places += [chance.randrange(header) for _ in range(n_flips)]
    places += [len(data) - 1 - chance.randrange(header) for _ in range(n_flips)]
    packets = data.index(b"</dv>") + 5
    places += range(packets, min(packets + 60, len(data)))
    for place in places:
        flipped = bytearray(data)
        flipped[place] ^= 1 << chance.randrange(8)
        yield f"bit flipped at {place}", bytes(flipped)


def main(original: str, scratch: str, n_cuts: str, n_flips: str) -> None:
    path = Path(scratch)
    for what, data in damaged_copies(Path(original).read_bytes(), int(n_cuts), int(n_flips)):
        path.write_bytes(data)
        try:
            for _ in Recording(path):
                pass
        except RecordingError:
            continue
        except BaseException as error:
            print(f"{what}: {type(error).__name__}: {error}")
    print("done")


if __name__ == "__main__":
    main(*sys.argv[1:])
