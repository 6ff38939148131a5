"""Lab Streaming Layer: one outlet of numbers for each state, and one of the gesture's name."""

import os
from pathlib import Path
from typing import Final

from neurotouch_hid.errors import StreamError
from neurotouch_hid.players import find_player
from neurotouch_hid.stream.reading import Reading
from neurotouch_hid.stream.sender import Sender
from neurotouch_hid.subscriber import MOST_HZ
from neurotouch_hid.vocabulary import Axis, GestureKind

MOST_CONTACTS: Final = 5
CHANNELS: Final = (
    ("kind", "0 none, 1 push, 2 pinch, 3 zoom, 4 twist_cw, 5 twist_ccw"),
    ("intensity", "mm"),
    ("confidence", ""),
    ("moved_x", "mm"),
    ("moved_y", "mm"),
    ("turned", "rad"),
    ("scale", ""),
    ("sensor_time", "s"),
    *((f"contact_{n}_{axis}", "mm") for n in range(1, MOST_CONTACTS + 1) for axis in "xy"),
    *((str(axis), "") for axis in Axis),
)
"""Name and unit of each channel. Contact points that are not there are not a number."""
_NUMBERS: Final = {each.label: float(each) for each in GestureKind}
_CONFIGS: Final = tuple(
    Path(os.path.expanduser(each))  # noqa: PTH111  a Path raises where nobody knows the home
    for each in ("lsl_api.cfg", "~/lsl_api/lsl_api.cfg", "/etc/lsl_api/lsl_api.cfg")
)
"""Where LSL looks for a laboratory's own settings, which stay as they are."""
_NOWHERE: Final = float("nan")


class LslOutlets(Sender):
    """Offers the streams ``neurotouch`` and ``neurotouch-gesture``; a context manager.

    The first has numbers, see ``CHANNELS``. The second has the name of the gesture whenever that
    changes. With ``markers`` a third, ``neurotouch-markers``, has x and y of each marker in mm.
    The names of player 2 begin with ``neurotouch-2``.

    Args:
        markers: whether the displacement of each marker is sent, too.

    Raises:
        StreamError: pylsl or its library is missing.
    """

    def __init__(self, *, markers: bool) -> None:
        try:
            import pylsl  # noqa: PLC0415
        except RuntimeError as error:
            raise StreamError(
                "LSL needs the library liblsl, which pylsl does not find.",
                hint="Install liblsl, or name its file in the variable PYLSL_LIB.",
            ) from error
        except ImportError:
            raise StreamError(
                "LSL needs pylsl, which is not installed.",
                hint="Install it: pip install 'neurotouch-hid[lsl]'",
            ) from None
        if "LSLAPICFG" not in os.environ and not any(each.exists() for each in _CONFIGS):
            pylsl.set_config_content("[log]\nlevel = -2\n")  # errors only
        self._pylsl, self._markers = pylsl, markers
        player = find_player()
        self._stem = stem = "neurotouch" if player == 1 else f"neurotouch-{player}"
        self.name = f"LSL streams '{stem}' and '{stem}-gesture'"
        info = pylsl.StreamInfo(stem, "Touch", len(CHANNELS), pylsl.IRREGULAR_RATE, "float32", stem)
        channels = info.desc().append_child("channels")
        for label, unit in CHANNELS:
            channel = channels.append_child("channel")
            channel.append_child_value("label", label)
            channel.append_child_value("unit", unit)
        info.desc().append_child_value("most_per_second", str(MOST_HZ))
        self._numbers = pylsl.StreamOutlet(info)
        self._gestures = pylsl.StreamOutlet(
            pylsl.StreamInfo(
                f"{stem}-gesture",
                "Markers",
                1,
                pylsl.IRREGULAR_RATE,
                "string",
                f"{stem}-gesture",
            )
        )
        self._fields: pylsl.StreamOutlet | None = None
        self._n_values = 0
        self._kind = ""

    def send(self, reading: Reading) -> None:
        """Sends a state with the time of this call; LSL keeps it for listeners that are slow."""
        now = self._pylsl.local_clock()
        self._numbers.push_sample(list_numbers(reading), now)
        if reading.kind != self._kind:
            self._gestures.push_sample([reading.kind], now)
            self._kind = reading.kind
        if self._markers and len(reading.markers_mm):
            self._send_field(reading.markers_mm.ravel().tolist(), now)

    def close(self) -> None:
        """Takes the streams off the network."""
        for name in ("_numbers", "_gestures", "_fields"):
            self.__dict__.pop(name, None)

    def _send_field(self, values: list[float], now: float) -> None:
        if self._fields is None or len(values) != self._n_values:  # another gel
            self._n_values = len(values)
            self._fields = self._pylsl.StreamOutlet(
                self._pylsl.StreamInfo(
                    f"{self._stem}-markers",
                    "Markers displacement",
                    len(values),
                    self._pylsl.IRREGULAR_RATE,
                    "float32",
                    f"{self._stem}-markers",
                )
            )
        self._fields.push_sample(values, now)


def list_numbers(reading: Reading) -> list[float]:
    """Returns the values of all channels, in the order of ``CHANNELS``."""
    contacts = [each for point in reading.contacts_mm[:MOST_CONTACTS] for each in point]
    contacts += [_NOWHERE] * (2 * MOST_CONTACTS - len(contacts))
    return [
        _NUMBERS[reading.kind],
        reading.intensity_mm,
        reading.confidence,
        *reading.moved_mm,
        reading.turned_rad,
        reading.scale,
        reading.t_us / 1e6,
        *contacts,
        *(reading.axes[axis] for axis in Axis),
    ]
