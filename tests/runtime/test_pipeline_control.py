"""What a running line can be told, and what it tells."""

import dataclasses

import pytest

from neurotouch_hid.device import MemoryDevice
from neurotouch_hid.errors import DriverError
from neurotouch_hid.gesture import GestureConfig
from neurotouch_hid.messages import Button
from neurotouch_hid.profile import UserSettings, load_profile, rehearse
from neurotouch_hid.runtime import Pipeline, PipelineControl, run_pipeline
from neurotouch_hid.runtime.command_queue import CAPACITY, Command, CommandQueue
from neurotouch_hid.runtime.stage_timing import KEPT


class Line:
    """A line over a push that holds from 1.0 to 1.7 s, with things happening at given times."""

    def __init__(self, push, user=None, profile="spacecraft"):
        self.push = push
        self.heard = []
        self.steps = []
        self.pipeline = Pipeline.build(load_profile(profile), GestureConfig(), user=user)
        self.control = PipelineControl(self.pipeline, user or UserSettings())
        self.control.on_command(self.heard.append)

    def play(self, happenings=None):
        """Runs; ``happenings`` maps the time of a slice in ms to what happens before it."""
        waiting = dict(happenings or {})

        def packets():
            for packet in self.push.packets:
                happening = waiting.pop(packet.t_begin_us // 1000, None)
                if happening is not None:
                    happening()
                yield packet

        device = MemoryDevice()
        run_pipeline(packets(), self.pipeline, device, [self.steps.append], control=self.control)
        assert not waiting
        assert not device.states or device.states[-1].is_neutral
        return self

    def pressed_ms(self):
        return [step.gesture.t_us // 1000 for step in self.steps if not step.pad.is_neutral]


def test_line_without_orders_is_the_same_with_a_control(push):
    bare = []
    line = Pipeline.build(load_profile("spacecraft"), GestureConfig())
    run_pipeline(push.packets, line, MemoryDevice(), [bare.append])
    assert [step.pad for step in Line(push).play().steps] == [step.pad for step in bare]


CHORD = """
version: 1
name: chord
bindings:
  - {when: {gesture: push, with_button: x}, do: {button: a}}
  - {when: push, do: {button: b}}
"""


def test_a_button_of_who_plays_along_makes_a_chord_of_the_push(push, tmp_path):
    (tmp_path / "chord.yaml").write_text(CHORD)
    line = Line(push, profile=str(tmp_path / "chord.yaml"))
    held = set()
    line.control.set_helper(lambda: frozenset(held))
    line.play({1200: lambda: held.add(Button.X), 1400: held.clear})
    pressed = {step.gesture.t_us // 1000: step.pad.buttons for step in line.steps}
    assert pressed[1200] == {Button.B}
    assert {pressed[t_ms] for t_ms in range(1210, 1401, 10)} == {frozenset({Button.A})}
    assert pressed[1410] == frozenset()


def test_pause_releases_in_the_same_slice_and_tracking_goes_on(push):
    line = Line(push)
    line.play({1300: lambda: line.control.submit("pause")})
    assert max(line.pressed_ms()) == 1300
    assert line.heard == ["pause"]
    after = [step for step in line.steps if step.gesture.t_us == 1_500_000]
    assert after[0].gesture.kind.label == "push"
    assert after[0].markers.valid.sum() > 170


def test_resume_acts_at_the_next_gesture_not_in_the_middle_of_one(push):
    line = Line(push)
    line.play(
        {1200: lambda: line.control.submit("pause"), 1300: lambda: line.control.submit("resume")}
    )
    assert max(line.pressed_ms()) == 1200
    assert line.control.status()["state"] == "running"


def test_toggle_pauses_and_resumes_but_does_not_end_a_panic(push):
    line = Line(push)
    states = []

    def toggle():
        states.append(line.control.status()["state"])
        line.control.submit("toggle")

    line.play(dict.fromkeys((100, 200, 300), toggle))
    assert states == ["running", "paused", "running"]
    line = Line(push)
    line.play(
        {100: lambda: line.control.submit("panic"), 200: lambda: line.control.submit("toggle")}
    )
    assert line.control.status()["state"] == "panic"
    assert line.pressed_ms() == []


def test_panic_outlasts_pause_and_a_switch_of_profile_and_of_the_person(push):
    line = Line(push)
    racing = load_profile("racing")
    line.play(
        {
            100: lambda: line.control.submit("panic"),
            200: lambda: line.control.submit("pause"),
            300: lambda: line.control.switch(racing, UserSettings()),
            400: lambda: line.control.switch(racing, UserSettings(mirror=True)),
            500: lambda: line.control.switch(racing, UserSettings(mirror=True)),
        }
    )
    status = line.control.status()
    assert (status["state"], status["profile"]) == ("panic", "racing")
    assert line.pressed_ms() == []


def test_pause_outlasts_other_values_of_the_person(push):
    line = Line(push)
    profile = load_profile("spacecraft")
    line.play(
        {
            100: lambda: line.control.submit("pause"),
            200: lambda: line.control.switch(profile, UserSettings(mirror=True)),
        }
    )
    assert line.control.status()["state"] == "paused"
    assert line.pressed_ms() == []


@pytest.mark.parametrize("user", [UserSettings(), UserSettings(mirror=True)])
def test_switch_in_mid_gesture_releases_and_waits_for_the_next_gesture(push, user):
    line = Line(push)
    done = []
    spacecraft = load_profile("spacecraft")
    line.play({1300: lambda: done.append(line.control.switch(spacecraft, user).done)})
    assert done[0].done()
    assert max(line.pressed_ms()) == 1300


def test_other_values_of_the_person_hold_from_the_next_gesture_on(push):
    line = Line(push)
    user = UserSettings(mirror=True)
    line.play({100: lambda: line.control.switch(load_profile("spacecraft"), user)})
    values = {step.pad.axes.get("left_x", 0.0) for step in line.steps}
    assert min(values) < -0.3
    assert max(values) <= 0.0


def test_panic_throws_away_what_waits_and_finds_room(push):
    queue = CommandQueue()
    commands = [queue.submit(Command("resume")) for _ in range(CAPACITY)]
    with pytest.raises(DriverError, match="too many"):
        queue.submit(Command("resume"))
    queue.submit(Command("panic"))
    assert queue.take().name == "panic"
    assert queue.take() is None
    with pytest.raises(DriverError, match=r"panic .* Everything is released\.") as caught:
        commands[0].done.result(0)
    assert caught.value.hint == "To continue: neurotouch resume"


def test_panic_throws_no_switch_of_profile_away_for_it_has_been_told_as_done():
    queue = CommandQueue()
    for order in ("pause", "switch", "resume", "switch"):
        queue.submit(Command(order))
    queue.submit(Command("panic"))
    assert [queue.take().name for _ in range(3)] == ["switch", "switch", "panic"]
    assert queue.take() is None


def test_order_while_the_line_stands_still_holds_from_its_return(push):
    line = Line(push)
    done = line.control.submit("panic").done
    assert not done.done()
    line.play()
    assert done.done()
    assert line.pressed_ms() == []


def test_commands_from_the_gel_are_told(push):
    line = Line(push)
    step = line.play().steps[0]
    commands = ("rezero", "next_profile")
    pad = dataclasses.replace(step.pad, commands=commands)
    line.control.record(dataclasses.replace(step, pad=pad))
    assert line.heard == list(commands)


REZERO = """
version: 1
name: rezero
bindings:
  - {when: {gesture: push, accept_ms: 300}, do: {command: rezero}}
"""


def test_rezero_from_the_gel_makes_the_pose_of_the_moment_neutral(push, tmp_path):
    (tmp_path / "rezero.yaml").write_text(REZERO)
    line = Line(push, profile=str(tmp_path / "rezero.yaml")).play()
    at = next(i for i, step in enumerate(line.steps) if "rezero" in step.pad.commands)
    assert line.steps[at].gesture.kind.label == "push"
    held = [step.gesture.kind.label for step in line.steps if step.gesture.t_us < 1_590_000]
    assert set(held[at + 1 :]) == {"none"}
    assert len(held) > at + 20


@pytest.mark.parametrize("poses", [("lifted", "resting"), ("resting", "lifted")])
def test_another_neutral_pose_holds_from_the_next_slice_on(push, poses):
    before, after = (UserSettings(neutral=pose) for pose in poses)
    line = Line(push, user=before)
    recognizer = line.pipeline.recognizer
    assert recognizer.neutral == poses[0]
    line.play({1300: lambda: line.control.switch(load_profile("spacecraft"), after)})
    assert recognizer.neutral == poses[1]


def test_a_pose_that_holds_already_is_not_looked_for_anew(push):
    line = Line(push)
    recognizer = line.pipeline.recognizer
    recognizer.choose_neutral("resting")
    user, spacecraft = UserSettings(neutral="resting", mirror=True), load_profile("spacecraft")
    line.play({1300: recognizer.rezero, 1400: lambda: line.control.switch(spacecraft, user)})
    held = [step for step in line.steps if 1_310_000 < step.gesture.t_us < 1_590_000]
    assert {step.gesture.kind.label for step in held} == {"none"}


def test_status_tells_counts_times_and_errors(push):
    line = Line(push)
    empty = line.control.status()
    assert (empty["slices"], empty["markers_tracked"], empty["errors"]) == (0, 0, [])
    assert not empty["gel"]["found"]
    for n in range(7):
        line.control.note_error(f"error {n}")
    status = line.play().control.status()
    assert status["slices"] == len(push.packets)
    assert status["markers_tracked"] == 177
    assert (status["layer"], status["gel"]["text"]) == ("base", "found")
    assert [error["error"] for error in status["errors"]] == [f"error {n}" for n in range(2, 7)]


def test_status_names_what_was_held_for_long(push, monkeypatch):
    monkeypatch.setattr("neurotouch_hid.runtime.rates.WINDOW_S", 1e-6)
    line = Line(push)
    for gesture in rehearse("push left 6mm 200ms hold 6s; rest 500ms"):
        line.control.mapping.update(gesture)
    assert line.play().control.status()["long_holds"] == {"push_left": 1}


def test_every_stage_is_timed_where_it_runs(push):
    line = Line(push).play()
    timings = line.pipeline.timings
    spread_ms = timings.spread_ms()
    for stage in ("rest", "tracker", "gesture", "profile", "device"):
        assert timings.spent_ns[stage] > 0
        assert 0.0 < spread_ms[stage][0] <= spread_ms[stage][-1]
        assert len(timings.recent_ns()[stage]) == min(KEPT, len(line.steps))
    assert timings.spent_ns["head"] == 0  # only a live pipeline gets partial slices
