"""From the gel through the emulated camera to the pad, with the camera pulled out in between."""

import threading
import time

from neurotouch_hid.device import MemoryDevice
from neurotouch_hid.evaluation.speed.workload import load_scene
from neurotouch_hid.events import shift_packet
from neurotouch_hid.gesture import GestureConfig
from neurotouch_hid.messages import GestureKind
from neurotouch_hid.profile import load_profile
from neurotouch_hid.runtime import Pipeline, run_pipeline, warm_up
from neurotouch_hid.source.davis import DavisSource
from tests.source.davis.cable import Cable, emulate

PATIENCE_S = 240.0
REST_US = 6_000_000


class Player:
    """Pulls the camera out while a push is held, waits, and puts it back."""

    def __init__(self, packets):
        self.packets = packets
        self.cable = Cable(emulate(packets))
        self.stop = threading.Event()
        self.pad = MemoryDevice()
        self.seen = []
        self.began = time.monotonic()

    def look(self, step):
        """Tap of the line."""
        self.seen.append(step)
        if len(self.seen) > 100 and self.pushed(self.seen[-20:]) and self.cable.n_plugs == 1:
            self.pulled_at = len(self.seen)
            self.cable.unplug()

    def turned(self):
        """Called after every turn of the loop."""
        if self.cable.camera is None and self.pad.states[-1].is_neutral:
            self.cable.plug(emulate(self.packets))
        over = self.cable.camera is not None and self.cable.camera.ended
        if (over and self.cable.n_plugs == 2) or time.monotonic() - self.began > PATIENCE_S:
            self.stop.set()

    @staticmethod
    def pushed(steps):
        return all(step.gesture.kind is GestureKind.PUSH for step in steps)


def test_a_push_is_felt_through_the_camera_and_again_after_it_was_pulled_out(push):
    pipeline = Pipeline.build(load_profile("spacecraft"), GestureConfig())
    warm_up(Pipeline.build(load_profile("spacecraft"), GestureConfig()))
    player = Player(push.packets)
    with DavisSource(cameras=player.cable, max_delay_us=60_000_000) as source:
        run_pipeline(
            source, pipeline, player.pad, [player.look], stop=player.stop, on_round=player.turned
        )
    before, after = player.seen[: player.pulled_at], player.seen[player.pulled_at :]
    assert not before[-1].pad.is_neutral
    # What was read before the end may still come; then nothing is known until the gel is at rest.
    back = next(k for k, step in enumerate(after) if step.packet.gap)
    last = player.seen[player.pulled_at + back - 1]
    assert after[back].packet.t_begin_us > last.packet.t_end_us + 100_000
    found = next(k for k, step in enumerate(after) if k >= back and step.markers.valid.any())
    assert any(step.rest is not None for step in after[back : found + 1])
    assert all(step.pad.is_neutral for step in after[back:found])
    kinds = [step.gesture.kind for step in after[found:]]
    assert kinds.count(GestureKind.PUSH) > 50
    times = [step.markers.t_us for step in player.seen]
    assert times == sorted(times)
    assert player.pad.states[-1].is_neutral


class Slipping(Cable):
    """``slip`` lets one byte of the stream get lost."""

    slips = False

    def slip(self):
        self.slips = True

    def queue(self, receive):
        super().queue(lambda data: receive(self.cut(data)))

    def cut(self, data):
        slips, self.slips = self.slips and bool(data), self.slips and not data
        return data[1:] if slips else data


def test_a_push_is_released_while_the_stream_is_out_of_step_and_felt_again_after_it(push):
    pipeline = Pipeline.build(load_profile("spacecraft"), GestureConfig())
    warm_up(Pipeline.build(load_profile("spacecraft"), GestureConfig()))
    cable, pad, stop, seen = Slipping(emulate(push.packets)), MemoryDevice(), threading.Event(), []
    began_s, slipped = time.monotonic(), []

    def look(step):
        seen.append(step)
        if not slipped and len(seen) > 100 and Player.pushed(seen[-20:]):
            slipped.append(len(seen))
            cable.slip()

    with DavisSource(cameras=cable, max_delay_us=60_000_000) as source:

        def turned():
            """The scene begins again only once the driver has noticed and let go."""
            if cable.camera is None:
                cable.plug(emulate(push.packets))
            elif source.n_restarts and pad.states[-1].is_neutral and cable.n_plugs == 1:
                cable.unplug()
            over = cable.n_plugs == 2 and cable.camera is not None and cable.camera.ended
            if over or time.monotonic() - began_s > PATIENCE_S:
                stop.set()

        run_pipeline(source, pipeline, pad, [look], stop=stop, on_round=turned)
        assert source.n_restarts == 1
    before, after = seen[: slipped[0]], seen[slipped[0] :]
    assert not before[-1].pad.is_neutral
    back = next(
        k
        for k, step in enumerate(after)
        if step.packet.t_begin_us > before[-1].packet.t_end_us + 200_000
    )
    assert after[back].packet.gap
    assert after[back].packet.t_end_us - before[-1].packet.t_end_us < 60_000_000
    assert sum(len(step.packet.events) for step in after[:back]) < 10_000
    assert [step.gesture.kind for step in after[back:]].count(GestureKind.PUSH) > 50
    assert pad.states[-1].is_neutral


def test_few_frames_come_while_nothing_happens_and_all_of_them_when_it_is_touched(push):
    rest = load_scene("rest", 10_000, REST_US).packets
    touched = (shift_packet(packet, REST_US) for packet in push.packets)
    cable = Cable(emulate([*rest, *touched]))
    line = Pipeline.build(load_profile("spacecraft"), GestureConfig(), frame_thread=True)
    warm_up(Pipeline.build(load_profile("spacecraft"), GestureConfig(), frame_thread=True))
    stop, seen, idle = threading.Event(), [], []

    def look(step):
        seen.append(step)
        idle.append(line.is_at_rest)
        if cable.camera.ended or step.packet.t_end_us > 60_000_000:
            stop.set()

    with DavisSource(cameras=cable, max_delay_us=60_000_000) as source:
        run_pipeline(source, line, MemoryDevice(), [look], stop=stop)
    pushed = [k for k, step in enumerate(seen) if step.gesture.kind is GestureKind.PUSH]
    late_us = range(REST_US - 1_500_000, REST_US + 300_000)  # a busy machine is seconds late
    rested = [k for k, step in enumerate(seen) if step.packet.t_end_us in late_us]
    assert all(idle[k] for k in rested)
    assert len(pushed) > 50
    assert count_frames(seen, rested) < 8.0
    assert count_frames(seen, pushed) > 20.0


def count_frames(steps, chosen):
    """Frames a second of the camera's time."""
    packets = [steps[k].packet for k in chosen]
    length_us = sum(packet.t_end_us - packet.t_begin_us for packet in packets)
    return 1e6 * sum(len(packet.frames) for packet in packets) / length_us
