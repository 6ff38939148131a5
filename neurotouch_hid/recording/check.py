"""Checks a recording of any format without reading it."""

from pathlib import Path

from neurotouch_hid.recording.clip import Clip, check_clip
from neurotouch_hid.recording.container import Container
from neurotouch_hid.recording.reader import Recording
from neurotouch_hid.recording.simulation import Simulation
from neurotouch_hid.vocabulary import is_clip


def check_recording(path: Path) -> None:
    """Checks that a file is there and has the header of a recording.

    Raises:
        RecordingError: the file is missing, a folder, empty, of another format or damaged.
    """
    if is_clip(path):
        check_clip(path)
    else:
        Container(path).close()


def find_simulation(path: Path) -> Simulation | None:
    """Returns where a recording's simulated data come from; None for a sensor's data.

    Raises:
        RecordingError: it is no readable recording.
    """
    return (Clip(path) if is_clip(path) else Recording(path)).simulation
