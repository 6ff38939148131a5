"""Plays the DAVIS of this machine through the library, as a program of its own, until it is gone.

    python -m tests.source.events.pulled

It prints a line once a push moves the stick, and another one with the time (s, of the machine's
clock) at which the pad was neutral after that.
"""

import threading
import time

from neurotouch_hid.gesture import GestureConfig
from neurotouch_hid.messages import GestureKind
from neurotouch_hid.profile import load_profile
from neurotouch_hid.runtime import Pipeline, run_pipeline, warm_up
from neurotouch_hid.source.events.source import EventCameraSource
from tests.soak.plugs import TimedDevice

PATIENCE_S = 120.0
N_PUSHED = 20


def main():
    pad, stop, n_pushed, end_s = TimedDevice(), threading.Event(), 0, time.monotonic() + PATIENCE_S

    def look(step):
        nonlocal n_pushed
        before, is_push = n_pushed, step.gesture.kind is GestureKind.PUSH
        n_pushed = n_pushed + 1 if is_push else 0
        if before < N_PUSHED <= n_pushed:
            print("pushed", flush=True)

    def turned():
        if (n_pushed >= N_PUSHED and not pad.is_pushed.is_set()) or time.monotonic() > end_s:
            stop.set()

    warm_up(Pipeline.build(load_profile("spacecraft"), GestureConfig()))
    pipeline = Pipeline.build(load_profile("spacecraft"), GestureConfig())
    with EventCameraSource(slice_us=4_000) as source:
        run_pipeline(source, pipeline, pad, [look], stop=stop, on_round=turned)
    print(pad.released_s, flush=True)


if __name__ == "__main__":
    main()
