"""Event cameras that nobody has: the library's interface, with packets that are made up.

The configurations are the library's own, so what is written into them is checked by it.
"""

import threading
import time
from functools import cache
from types import SimpleNamespace

import neuromorphic_drivers
import numpy as np

from neurotouch_hid.source.events.models import find_model
from neurotouch_hid.source.sensor_map import find_places
from neurotouch_hid.source.view import whole_view

EVENTS = np.dtype(
    {
        "names": ["t", "x", "y", "on"],
        "formats": ["<u8", "<u2", "<u2", "?"],
        "offsets": [0, 8, 10, 12],
        "itemsize": 13,
    }
)
"""As of neuromorphic-drivers 0.18.2: nothing between the fields."""
SETTLED_S = 0.1
"""If it closes an unplugged camera sooner, the library aborts: Linux still has transfers."""


def make_packet(events=None, overflows=None, frames=None):
    packet = SimpleNamespace(polarity_events=events, polarity_events_overflow_indices=overflows)
    if frames is not None:
        packet.frames = frames
    return packet


def make_events(times, x=0, y=0, on=True):
    events = np.zeros(len(times), EVENTS)
    events["t"], events["x"], events["y"], events["on"] = times, x, y, on
    return events


def list_places(view):
    """The canonical pixel of each pixel of the sensor: x + 65,536 y, or -1."""
    columns, rows = (places.astype(np.int32) for places in find_places(view))
    return np.where((columns < 0) | (rows < 0), -1, columns | rows << 16)


@cache
def sort_places(view):
    """The canonical pixels of a view in order, and each one's pixel of the sensor."""
    places = list_places(view).ravel()
    order = np.argsort(places, kind="stable")
    return places[order], order


def magnify(events, view):
    """What a finer sensor sends: each event in all its pixels that a canonical pixel stands for."""
    places, order = sort_places(view)
    keys = events["x"].astype(np.int64) | events["y"].astype(np.int64) << 16
    first = np.searchsorted(places, keys)
    counts = np.searchsorted(places, keys, side="right") - first
    which = np.repeat(np.arange(len(events)), counts)
    begin = np.repeat(np.cumsum(counts) - counts, counts)
    pixels = order[first[which] + np.arange(len(which)) - begin]
    y, x = np.divmod(pixels, view.width_px)
    return make_events(events["t"][which], x, y, events["p"][which])


class Device:
    """An open camera that gives the items of ``script``: packets, errors, None for silence."""

    def __init__(self, camera, configuration, timeout_s):
        self.camera, self.configuration, self.timeout_s = camera, configuration, timeout_s
        self.closed = False
        self.cleared = []
        self.failed_s = None

    def __iter__(self):
        return self

    def __next__(self):
        assert not self.closed
        camera = self.camera
        if camera.unplugged.is_set():
            self.failed_s = time.monotonic()
            raise RuntimeError("Usb(NoDevice)")
        item = camera.script.pop(0) if camera.script else None
        now = time.time()
        if isinstance(item, Exception):
            raise item
        if item is None:
            time.sleep(0.002)
            return SimpleNamespace(system_time=now, ring=None), None
        t_us, packet, ring = item
        ring = {"system_time": now, "backlog": 0, "dropped_packets": 0} | ring
        return SimpleNamespace(
            system_time=now, ring=SimpleNamespace(current_t=t_us, **ring)
        ), packet

    def serial(self):
        return self.camera.serial

    def clear_backlog(self, until):
        self.cleared.append(until)

    def close(self):
        assert self.failed_s is None or time.monotonic() > self.failed_s + SETTLED_S
        self.closed = True
        self.camera.device = None


class Camera:
    """A camera that is plugged in."""

    def __init__(self, title="Prophesee EVK4", serial="00ca0123", error=None, script=()):
        self.title, self.serial, self.error = title, serial, error
        self.script = list(script)
        self.device = None
        self.unplugged = threading.Event()
        self.n_opened = self.n_plugs = 0

    @property
    def model(self):
        return find_model(self.title)

    @property
    def view(self):
        return whole_view(self.model.width_px, self.model.height_px)

    def show(self, t_us, events=None, **ring):
        """Adds a packet that ends at a time of the camera."""
        overflows = ring.pop("overflows", None)
        self.script.append((t_us, make_packet(events, overflows), ring))


class Library:
    """The library; whatever is not here is the real one's."""

    def __init__(self, *cameras):
        self.cameras = list(cameras)
        self.refusal = None
        self.n_listed = 0

    def __getattr__(self, name):
        return getattr(neuromorphic_drivers, name)

    def list_devices(self):
        self.n_listed += 1
        if self.refusal is not None:
            raise RuntimeError(self.refusal)
        names = {name.value: name for name in neuromorphic_drivers.Name}
        return [
            neuromorphic_drivers.ListedDevice(
                name=names[camera.title],
                connection=neuromorphic_drivers.Connection.USB_SUPER,
                address="bus 2, address 7",
                serial=camera.serial,
                error=camera.error,
            )
            for camera in self.cameras
        ]

    def open(self, *, configuration, iterator_timeout, serial, ring_configuration):
        configuration.serialize()
        if ring_configuration is not None:
            ring_configuration.serialize()
        for camera in self.cameras:
            if camera.serial == serial and configuration.type() == camera.model.key:
                assert camera.device is None
                camera.n_opened += 1
                camera.unplugged.clear()
                camera.device = Device(camera, configuration, iterator_timeout)
                return camera.device
        raise RuntimeError("device not found")

    def list_plugged(self):
        """What Linux lists; a camera that is plugged in again is another one."""
        return frozenset(f"{id(camera)} {camera.n_plugs}" for camera in self.cameras)

    def plug(self, camera):
        camera.n_plugs += 1
        self.cameras.append(camera)

    def unplug(self, camera):
        self.cameras.remove(camera)
        camera.unplugged.set()
