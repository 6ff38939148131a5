"""Compiled loop that draws the gel from the events of one dip of its light."""

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.process.kernel_cache import kernel

OFF, ON = 1.0, 2.0  # weight of an event at once; later ones count less


@kernel
def add_answers(
    events: NDArray[np.void],
    off_us: int,
    on_us: int,
    answer_us: int,
    level: NDArray[np.float32],
) -> None:
    """Adds what pixels answered to light that goes off and on again.

    Bright pixels answer sooner and more often than dark ones.

    Args:
        events: (m,) EVENT_DTYPE around the dip.
        off_us: when the light went off.
        on_us: when it came back.
        answer_us: for this time after that, events are an answer.
        level: (260, 346) float32, larger where it is brighter; updated.
    """
    for k in range(len(events)):
        event = events[k]
        t = event["t"]
        if event["p"]:
            weight, since, until = ON, t - on_us, answer_us
        else:
            weight, since, until = OFF, t - off_us, on_us - off_us
        if 0 <= since < until:
            level[event["y"], event["x"]] += np.float32(weight * (1.0 - since / until))
