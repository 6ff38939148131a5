"""Writes the live view as lines of text, for terminals, screen readers and pipes."""

import re
from collections.abc import Iterator
from typing import Final

from neurotouch_hid.driver_state import Action, Health, State
from neurotouch_hid.profile.decision_log import describe_decision
from neurotouch_hid.status import GelFacts

SAY_S: Final = 0.5
"""Shortest time between two sentences about one subject, so that a screen reader can follow."""

HEALTH_S: Final = 20.0

_BAR: Final = 30
_MOST_MM: Final = 15.0
_STAGES: Final = {
    "tracker": "tracker",
    "gesture": "gesture",
    "profile": "profile and filter",
    "device": "to the kernel",
}


class LineWriter:
    """Turns states into lines of text; each line begins with its subject and says the change."""

    def __init__(self) -> None:
        self._shape = self._said = ""
        self._place: tuple[str, ...] = ()
        self._gel: tuple[bool, str] = True, ""
        self._said_s = self._health_s = float("-inf")
        self._told: tuple[int, str] | None = None

    def write(self, head: State, now_s: float) -> Iterator[str]:
        """Returns lines about the changes in a state.

        Args:
            head: head of the state.
            now_s: present time on any steady clock.
        """
        slow = head["slow"]
        place = (head["profile"], head["layer"], head["state"], slow["source"])
        if place != self._place:
            self._place = place
            profile, layer, state, source = place
            simulated = "SIMULATED " if slow["simulated"] else ""
            yield f"driver: {state}, profile {profile}, layer {layer}, source {simulated}{source}"
        yield from self._write_gel(head["gel"])
        yield from self._write_actions(head["actions"])
        shape = re.sub(r"[\d.]+", "", head["say"])
        if shape != self._shape and now_s - self._said_s >= SAY_S:
            self._shape, self._said_s = shape, now_s
            yield f"hand: {head['say']}"
        if now_s - self._health_s >= HEALTH_S and slow["slices_hz"]:
            self._health_s = now_s
            yield describe_health(head)
            yield describe_times(slow)

    def _write_gel(self, gel: GelFacts) -> Iterator[str]:
        found = gel["found"], gel["problem"]
        if found != self._gel:
            self._gel = found
            yield f"gel: {gel['text']}. {gel['fix']}".rstrip()

    def _write_actions(self, actions: list[Action]) -> Iterator[str]:
        new = [each for each in actions if self._told is None or each[0] > self._told[0]]
        if self._told is None:
            new = new[-3:]
        for t_us, verdict, what, why in new:
            self._told = t_us, what
            yield describe_decision(verdict, what, why)
        if self._told is None:
            self._told = (actions[-1][0], actions[-1][2]) if actions else (-1, "")


def describe_health(head: State) -> str:
    """Returns for example ``health: 177 of 177 markers tracked, 25.0 frames a second, …``."""
    slow = head["slow"]
    rest = slow["rezero_s"]
    return (
        f"health: {slow['tracked']} of {head['gel']['markers']} markers tracked, "
        f"{slow['frames_hz']:g} frames, {slow['slices_hz']} slices and "
        f"{slow['events_hz']:,} events a second, {slow['lost']:,} events lost, "
        f"backlog {slow['backlog_ms']:g} ms, "
        + ("rest not seen yet" if rest is None else f"rest seen {rest:g} s ago")
    )


def describe_times(slow: Health) -> str:
    """Returns for example ``latency: time slice 10 ms, tracker 0.31 (95 %: 0.50) ms, …``."""
    parts = [f"time slice {slow['window_ms']:g} ms"]
    parts += [
        f"{name} {slow['stages'][stage][0]:.2f} (95 %: {slow['stages'][stage][1]:.2f}) ms"
        for stage, name in _STAGES.items()
        if stage in slow["stages"]
    ]
    if hand_ms := slow.get("hand_ms"):
        parts.append(f"mouse to pad {hand_ms[0]:g} (95 %: {hand_ms[1]:g}) ms")
    return "latency: " + ", ".join(parts)


def draw_picture(head: State) -> list[str]:
    """Returns a state as a picture of text, for repeated drawing."""
    gesture, slow = head["gesture"], head["slow"]
    filled = round(_BAR * min(gesture["felt_mm"] / _MOST_MM, 1.0))
    bar = "█" * filled + "░" * (_BAR - filled)
    lines = [
        f"NeuroTouch  {slow['source']}  profile {head['profile']}, layer {head['layer']}, "
        f"{head['state']}",
        "",
        head["say"],
        f"gel {head['gel']['text']}",
        f"{gesture['movement'].replace('_', ' '):<12} {bar} {gesture['felt_mm']:5.1f} mm",
        "",
    ]
    lines += [describe_health(head), describe_times(slow), ""]
    lines += [
        f"{(t_us - head['t_us']) / 1e6:8.1f} s  {describe_decision(verdict, what, why)}"
        for t_us, verdict, what, why in reversed(head["actions"][-8:])
    ]
    return lines
