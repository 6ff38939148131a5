"""A source for hours: disturbances, a plug, and the same undisturbed stretch, again and again."""

import os
import random
import select
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from contextlib import closing
from dataclasses import replace
from itertools import islice

import numpy as np
from neurotouch_devtools.emulator import Fault

from neurotouch_hid.closing import Closing
from neurotouch_hid.evaluation.speed.workload import load_scene
from neurotouch_hid.events import join_events, shift_packet
from neurotouch_hid.geometry import Rig
from neurotouch_hid.messages import EVENT_DTYPE, EventPacket, Frame
from neurotouch_hid.source.davis import DavisSource
from tests.soak.people import ACTIONS
from tests.source.davis.cable import Cable, Clock, emulate

Packets = Iterator[EventPacket | None]

SLICE_US = 10_000
CYCLE_US = 120_000_000
"""A plug and a stretch need a fifth of it, a disturbance about a tenth; then the gel is idle."""
SETTLE_US = 3_000_000
"""Rest between a plug and the stretch that is compared."""
DISTURBED = 500
"""Slices of the tour that have faults, from a random one on."""
MERGED = 4
"""Slices in a packet while nothing happens, as the camera's source joins them."""
FRAMES_EVERY = 6
"""Of these packets have a frame: an idle camera is asked for four a second."""
CAMERA_EVERY = 10
"""Cycles in which the emulated camera plays once, with a fault."""
CAMERA_FAULTS = (
    *("short+5x9", "odd+5x9", "stale", "timeout+5", "range+9x3", "backward+9x3", "unknown+9x3"),
    *("babble+9x3", "protocol+9x3", "stall+9", "reset+9", "missing+9", "garbage+9", "wrap+9"),
    *("overflow+9", "suspend+9", "stall+9x3", "silence+9", "lost+9"),
)
PATIENCE_S = 60.0


class SoakSource(Closing):
    """Plays cycles of two minutes until the time is over.

    Args:
        hours: sensor time.
        seed: of all random choices.
        tour: the packets of the stretch, from rest to rest.
        at_end: is called at the end of each cycle.

    Attributes:
        is_undisturbed: whether a stretch that nobody disturbs is played.
        rest: packets without a gesture.
        n_cycles: cycles that have ended.
        done: how often each disturbance has happened.
        failed: what people could not do.
    """

    name = "soak"
    rig: Rig | None = None
    is_live = True
    is_simulated = False

    def __init__(
        self,
        hours: float,
        seed: int,
        tour: tuple[EventPacket, ...],
        at_end: Callable[[], object],
    ) -> None:
        self._end_us = round(3.6e9 * hours)
        self._chance = random.Random(seed)
        self._tour, self._at_end = tour, at_end
        self.rest = [packet for packet in tour if packet.t_end_us <= tour[0].t_begin_us + 480_000]
        self._idle = _merge(self.rest)
        self._now_us = 0
        self._gap = 0
        self._people: subprocess.Popen[str] | None = None
        self.is_undisturbed = False
        self.n_cycles = 0
        self.done: Counter[str] = Counter()
        self.failed: list[str] = []

    def __iter__(self) -> Iterator[EventPacket]:
        return (packet for packet in self.poll() if packet is not None)

    def poll(self) -> Packets:
        """Gives the packets; None while the camera is unplugged."""
        while self._now_us < self._end_us:
            until_us = self._now_us + CYCLE_US
            yield from self._disturb(self._chance)
            yield from self._plug(away_us=1_000_000, away_s=0.0)
            yield from self._pause(SETTLE_US)
            self.is_undisturbed = True
            yield from map(self._at_now, self._tour)
            self.is_undisturbed = False
            yield from self._pause(max(0, until_us - self._now_us), is_idle=True)
            self.n_cycles += 1
            self._at_end()

    @property
    def hours(self) -> float:
        """Sensor time that has passed."""
        return self._now_us / 3.6e9

    def close(self) -> None:
        """Sends the people home."""
        if self._people is not None:
            self._people.communicate()
            self._people = None

    def _at_now(self, packet: EventPacket) -> EventPacket:
        moved = shift_packet(packet, self._now_us - packet.t_begin_us)
        self._now_us = moved.t_end_us
        if self._gap:
            moved, self._gap = replace(moved, gap=moved.gap + self._gap), 0
        return moved

    def _pause(self, length_us: int, *, is_idle: bool = False) -> Packets:
        """The gel at rest."""
        rest = self._idle if is_idle else self.rest
        until_us, k = self._now_us + length_us, 0
        while self._now_us < until_us:
            yield self._at_now(rest[k % len(rest)])
            k += 1

    def _plug(self, away_us: int, away_s: float) -> Packets:
        """The camera is away: nothing comes, and then its clock has gone on."""
        self.done["plug"] += 1
        end_s = time.monotonic() + away_s
        yield None
        while time.monotonic() < end_s:
            time.sleep(0.02)
            yield None
        self._now_us += away_us
        self._gap += 1

    def _disturb(self, chance: random.Random) -> Packets:
        """A tour with faults, while people do two things."""
        kind = chance.choice(("lose", "add", "blind", "jump", "stall", "plug in mid-gesture"))
        if kind != "plug in mid-gesture":
            self.done[kind] += 1
        first = [] if self.n_cycles else ["use_all"]
        waiting = [*first, *chance.sample(sorted(ACTIONS), 2), "settle"]
        is_asked = False
        begin = chance.randrange(len(self._tour))
        for packet in self._tour[begin : begin + DISTURBED]:
            yield from self._harm(packet, kind, chance)
            if self._has_answered(is_asked):
                is_asked = bool(waiting) and self._ask(waiting.pop(0))
        deadline_s = time.monotonic() + PATIENCE_S
        while is_asked or waiting:
            if time.monotonic() > deadline_s:
                raise AssertionError(f"the driver has not answered for {PATIENCE_S:.0f} s")
            yield from self._pause(100_000)
            if self._has_answered(is_asked):
                is_asked = bool(waiting) and self._ask(waiting.pop(0))
        if self.n_cycles % CAMERA_EVERY == CAMERA_EVERY - 1:
            yield from self._play_camera(chance.choice(CAMERA_FAULTS))

    def _harm(self, packet: EventPacket, kind: str, chance: random.Random) -> Packets:
        """One packet of the tour, with a fault now and then."""
        if chance.random() > 0.02:
            yield self._at_now(packet)
            return
        match kind:
            case "lose":
                kept = packet.events[: len(packet.events) // 2]
                gap = len(packet.events) - len(kept)
                yield self._at_now(replace(packet, events=kept, gap=max(1, gap)))
            case "add":
                yield self._at_now(replace(packet, events=_add_noise(packet, chance)))
            case "blind":
                frames = tuple(_blind(frame, chance) for frame in packet.frames)
                yield self._at_now(replace(packet, frames=frames))
            case "jump":
                self._now_us += chance.choice((10_000, 90_000, 2_000_000))
                yield self._at_now(packet)
            case "stall":
                time.sleep(0.1)
                yield self._at_now(packet)
            case _:
                yield from self._plug(chance.choice((30_000, 300_000, 3_000_000)), 0.12)
                yield self._at_now(packet)

    def _play_camera(self, fault: str) -> Packets:
        """The emulated camera plays a part of the tour through the camera's own driver."""
        self.done[f"camera: {fault}"] += 1
        clock = Clock()
        first_us = self._tour[0].t_begin_us
        scene = [shift_packet(packet, -first_us) for packet in islice(self._tour, 40)]
        cable = Cable(emulate(scene, [Fault.parse(fault)], clock), clock.step)
        self._gap += 1
        with closing(DavisSource(cameras=cable, sleep_s=lambda _: None)) as source:
            deadline_s, n = time.monotonic() + PATIENCE_S, 0
            for packet in source.poll():
                if packet is not None and not packet.is_partial:
                    n += 1
                    yield self._at_now(packet)
                if n >= 60 or time.monotonic() > deadline_s:
                    break
            if n < 60:
                self.failed.append(f"the camera gave {n} slices after {fault}")

    def _ask(self, action: str) -> bool:
        self.done[action] += 1
        if self._people is None:
            self._people = subprocess.Popen(
                [sys.executable, "-m", "tests.soak.people", "1"],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                text=True,
                env={**os.environ},
            )
        print(action, file=self._people.stdin, flush=True)
        return True

    def _has_answered(self, is_asked: bool) -> bool:
        if not is_asked or self._people is None:
            return True
        if not select.select([self._people.stdout], [], [], 0.0)[0]:
            return False
        answer = self._people.stdout.readline().strip()
        if answer != "done":
            self.failed.append(answer)
        return True


def _merge(packets: Sequence[EventPacket]) -> list[EventPacket]:
    """Joins each few packets to one, and leaves out most frames."""
    parts = [packets[k : k + MERGED] for k in range(0, len(packets) - MERGED + 1, MERGED)]
    return [
        EventPacket(
            part[0].t_begin_us,
            part[-1].t_end_us,
            join_events([packet.events for packet in part]),
            () if k % FRAMES_EVERY else tuple(f for packet in part for f in packet.frames),
        )
        for k, part in enumerate(parts)
    ]


def _add_noise(packet: EventPacket, chance: random.Random) -> np.ndarray:
    rng = np.random.default_rng(chance.randrange(1 << 30))
    noise = np.zeros(20_000, EVENT_DTYPE)
    noise["t"] = rng.integers(packet.t_begin_us, packet.t_end_us, len(noise))
    noise["x"], noise["y"] = rng.integers(346, size=len(noise)), rng.integers(260, size=len(noise))
    noise["p"] = rng.integers(2, size=len(noise))
    every = np.concatenate([packet.events, noise])
    return every[np.argsort(every["t"], kind="stable")]


def _blind(frame: Frame, chance: random.Random) -> Frame:
    rng = np.random.default_rng(chance.randrange(1 << 30))
    pixels = {
        "black": np.zeros_like(frame.pixels),
        "white": np.full_like(frame.pixels, 255),
        "noise": rng.integers(256, size=frame.pixels.shape).astype(np.uint8),
    }[chance.choice(("black", "white", "noise"))]
    return replace(frame, pixels=pixels)


def load_tour(length_us: int) -> tuple[EventPacket, ...]:
    """Returns the packets of all gestures, from rest to rest."""
    return load_scene("tour", SLICE_US, length_us).packets
