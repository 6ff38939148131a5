"""What the tests of sound share: a profile, and a turn of the line without a camera."""

import numpy as np

from neurotouch_hid.geometry import PAPER_GEL, Rig
from neurotouch_hid.messages import (
    EVENT_DTYPE,
    EventPacket,
    GelProblem,
    GelState,
    Gesture,
    MarkerField,
    Step,
)
from neurotouch_hid.profile import Mapping, Profile
from neurotouch_hid.profile.reading.load import parse_profile

REST_PX = Rig((173.0, 130.0), 2.5).to_px(PAPER_GEL.points_mm).astype(np.float32)

BUTTONS = """\
version: 1
name: buttons
bindings:
  - {when: {gesture: push, direction: left}, do: {button: a}}
  - {when: {gesture: push, direction: right}, do: {layer: second}}
  - {when: pinch, do: {command: pause}}
layers:
  - name: second
    bindings:
      - {when: zoom, do: {button: b}}
"""

FLICK = "rest 100ms; push left 12mm 10ms hold 100ms; rest 200ms"
"""So quick that it begins and acts in one turn."""


def parse(text: str) -> Profile:
    return parse_profile(text.encode(), "x.yaml")


FOUND = GelState(is_found=True, was_found=True, problem=GelProblem.NONE)


def turn(mapping: Mapping, gesture: Gesture, n_tracked: int = 177, gel: GelState = FOUND) -> Step:
    """What the line says of a gesture while so many markers are measured."""
    valid = np.arange(177) < n_tracked
    markers = MarkerField(gesture.t_us, REST_PX, REST_PX, valid)
    packet = EventPacket(gesture.t_us - 10_000, gesture.t_us, np.zeros(0, EVENT_DTYPE))
    return Step(packet, None, markers, gesture, mapping.update(gesture), gel)
