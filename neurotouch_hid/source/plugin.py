"""Opens the source of another package, and checks its packets."""

import math
from collections.abc import Iterator
from typing import Any, Final

from neurotouch_hid.closing import Closing
from neurotouch_hid.errors import PluginError
from neurotouch_hid.geometry import Rig
from neurotouch_hid.messages import (
    EVENT_DTYPE,
    SENSOR_HEIGHT_PX,
    SENSOR_WIDTH_PX,
    EventPacket,
    Frame,
)
from neurotouch_hid.plugins import SOURCES, Plugin, find_plugin
from neurotouch_hid.source.check import refuse_source
from neurotouch_hid.source.protocol import ActivityAware, PolledSource, Source

_MEMBERS: Final = ("name", "rig", "is_live", "is_simulated", "__iter__", "close")
_TYPES: Final = {"name": str, "rig": Rig | None, "is_live": bool, "is_simulated": bool}
_LONGEST_US: Final = 60_000_000
"""A slice that is longer must be in another unit."""
_SHAPE: Final = (SENSOR_HEIGHT_PX, SENSOR_WIDTH_PX)


def open_plugin(spec: str, slice_us: int, seed: int) -> Source:
    """Opens a source of another package, see ``plugins``.

    Args:
        spec: ``KIND:REST``; the entry point KIND in ``neurotouch.sources`` is called as
            ``make(REST, slice_us=..., seed=...)``.
        slice_us: length of a slice.
        seed: of the simulator's chance.

    Raises:
        SourceError: no package offers KIND.
        PluginError: the package cannot be loaded, or its object is no source.
    """
    kind, colon, rest = spec.partition(":")
    plugin = find_plugin(SOURCES, kind) if colon else None
    if plugin is None:
        raise refuse_source(spec)
    source = plugin.make(rest, slice_us=slice_us, seed=seed)
    with plugin.running():
        _require_members(kind, source)
        return (_CheckedPolled if isinstance(source, PolledSource) else _Checked)(plugin, source)


def _require_members(kind: str, source: Any) -> None:
    missing = [each for each in _MEMBERS if not hasattr(source, each)]
    if missing:
        raise PluginError(
            f"The source '{kind}:' has no {', '.join(missing)}.",
            hint="It must be what neurotouch_hid.source.Source describes.",
        )
    for member, wanted in _TYPES.items():
        value = getattr(source, member)
        if not isinstance(value, wanted):
            raise PluginError(
                f"The source '{kind}:' has {value!r} as {member}.",
                hint="It must be what neurotouch_hid.source.Source describes.",
            )


class _Checked(Closing):
    """A source of another package that checks its packets, so that an error names the mistake."""

    def __init__(self, plugin: Plugin, source: Any) -> None:
        self.name, self.rig = source.name, source.rig
        self.is_live, self.is_simulated = source.is_live, source.is_simulated
        self._plugin, self._source = plugin, source

    def __iter__(self) -> Iterator[EventPacket]:
        done_us = -math.inf
        with self._plugin.running():
            for packet in self._source:
                done_us = self._check(packet, done_us)
                yield packet

    def close(self) -> None:
        with self._plugin.running():
            self._source.close()

    def _check(self, packet: Any, done_us: float) -> float:
        """Checks a packet, and returns up to when the packets are whole."""
        mistake = next(_find_mistakes(packet, done_us), None)
        if mistake is not None:
            what, must = mistake
            name = self._plugin.point.name
            raise PluginError(f"The source '{name}:' gave {what}.", hint=f"{must}.")
        return done_us if packet.is_partial else float(packet.t_end_us)


class _CheckedPolled(_Checked):
    """The same for a source that may have no packets for a while."""

    def poll(self) -> Iterator[EventPacket | None]:
        done_us = -math.inf
        with self._plugin.running():
            for packet in self._source.poll():
                if packet is not None:
                    done_us = self._check(packet, done_us)
                yield packet

    def set_activity(self, *, is_idle: bool, wants_frames: bool = True) -> None:
        if isinstance(self._source, ActivityAware):
            with self._plugin.running():
                self._source.set_activity(is_idle=is_idle, wants_frames=wants_frames)


def _find_mistakes(packet: Any, done_us: float) -> Iterator[tuple[str, str]]:
    """Gives what is wrong in a packet of another package, and how it must be.

    The compiled loops trust all of this: an event beside the sensor would crash the process.
    """
    if not isinstance(packet, EventPacket):
        must = "It must give neurotouch_hid.messages.EventPacket"
        yield f"{type(packet).__name__}, not an EventPacket", must
    begin_us, end_us, events = packet.t_begin_us, packet.t_end_us, packet.events
    for name in ("t_begin_us", "t_end_us", "gap"):
        if type(number := getattr(packet, name)) is not int:
            yield f"{number!r} as {name}", "It must be a plain int"
    if not 0 < end_us - begin_us <= _LONGEST_US:
        must = f"Its end must come after its begin, by at most {_LONGEST_US:,} us"
        yield f"a slice from {begin_us} to {end_us} us", must
    if begin_us < done_us:
        must = "Slices must come in the order of their time"
        yield f"a slice from {begin_us} us on after one that ended at {done_us:.0f} us", must
    if getattr(events, "dtype", None) != EVENT_DTYPE:
        must = "It must be an array of neurotouch_hid.messages.EVENT_DTYPE"
        yield f"events of the dtype {getattr(events, 'dtype', None)}", must
    if events.ndim != 1:
        yield f"events of the shape {events.shape}", "It must be (n,), for n events"
    if len(events):
        yield from _find_mistakes_in_events(events, begin_us, end_us)
    if not isinstance(packet.frames, tuple):
        yield f"frames of the type {type(packet.frames).__name__}", "It must be a tuple"
    for frame in packet.frames:
        yield from _find_mistakes_in_frame(frame)


def _find_mistakes_in_events(events: Any, begin_us: int, end_us: int) -> Iterator[tuple[str, str]]:
    for name, n_px in (("x", SENSOR_WIDTH_PX), ("y", SENSOR_HEIGHT_PX)):
        least, most = events[name].min(), events[name].max()
        if least < 0 or most >= n_px:
            wrong = least if least < 0 else most
            yield f"an event at {name} = {wrong}", f"It must be from 0 to {n_px - 1}"
    t_us = events["t"]
    if (t_us[1:] < t_us[:-1]).any():
        yield "events that are not in the order of their time", "Sort them by 't'"
    if t_us[0] < begin_us or t_us[-1] >= end_us:
        wrong = t_us[0] if t_us[0] < begin_us else t_us[-1]
        slice_us = f"a slice from {begin_us} to {end_us} us"
        yield f"an event at {wrong} us in {slice_us}", "It must be in the slice, before its end"


def _find_mistakes_in_frame(frame: Any) -> Iterator[tuple[str, str]]:
    if not isinstance(frame, Frame):
        must = "It must be neurotouch_hid.messages.Frame"
        yield f"{type(frame).__name__} as a frame", must
    dtype, shape = (getattr(frame.pixels, each, None) for each in ("dtype", "shape"))
    if dtype != "uint8" or shape != _SHAPE:
        yield f"a frame of {dtype}, {shape}", f"It must be uint8, {_SHAPE}"
    for name in ("exposure_begin_us", "exposure_end_us"):
        if type(number := getattr(frame, name)) is not int:
            yield f"{number!r} as {name}", "It must be a plain int"
