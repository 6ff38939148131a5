"""Opens the source of another package, and checks its packets."""

from collections.abc import Iterator
from typing import Any

from neurotouch_hid.closing import Closing
from neurotouch_hid.errors import PluginError
from neurotouch_hid.messages import EVENT_DTYPE, EventPacket
from neurotouch_hid.plugins import SOURCES, Plugin, find_plugin
from neurotouch_hid.source.check import refuse_source
from neurotouch_hid.source.protocol import ActivityAware, PolledSource, Source

_MEMBERS = ("name", "rig", "is_live", "is_simulated", "__iter__", "close")


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
    missing = [each for each in _MEMBERS if not hasattr(source, each)]
    if missing:
        raise PluginError(
            f"The source '{kind}:' has no {', '.join(missing)}.",
            hint="It must be what neurotouch_hid.source.Source describes.",
        )
    return (_CheckedPolled if isinstance(source, PolledSource) else _Checked)(plugin, source)


class _Checked(Closing):
    """A source of another package that checks its packets, so that an error names the mistake."""

    def __init__(self, plugin: Plugin, source: Any) -> None:
        self.name, self.rig = source.name, source.rig
        self.is_live, self.is_simulated = source.is_live, source.is_simulated
        self._plugin, self._source = plugin, source

    def __iter__(self) -> Iterator[EventPacket]:
        with self._plugin.running():
            for packet in self._source:
                self._check(packet)
                yield packet

    def close(self) -> None:
        with self._plugin.running():
            self._source.close()

    def _check(self, packet: object) -> None:
        fault = None
        if not isinstance(packet, EventPacket):
            fault = f"{type(packet).__name__}, not an EventPacket"
        elif packet.t_end_us <= packet.t_begin_us:
            fault = f"a slice from {packet.t_begin_us} to {packet.t_end_us} us"
        elif getattr(packet.events, "dtype", None) != EVENT_DTYPE:
            fault = f"events of the dtype {getattr(packet.events, 'dtype', None)}"
        if fault is not None:
            raise PluginError(
                f"The source '{self._plugin.point.name}:' gave {fault}.",
                hint="It must give neurotouch_hid.messages.EventPacket, its events of EVENT_DTYPE.",
            )


class _CheckedPolled(_Checked):
    """The same for a source that may have no packets for a while."""

    def poll(self) -> Iterator[EventPacket | None]:
        with self._plugin.running():
            for packet in self._source.poll():
                if packet is not None:
                    self._check(packet)
                yield packet

    def set_activity(self, *, is_idle: bool, wants_frames: bool = True) -> None:
        if isinstance(self._source, ActivityAware):
            with self._plugin.running():
                self._source.set_activity(is_idle=is_idle, wants_frames=wants_frames)
