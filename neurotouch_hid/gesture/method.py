"""What a method is, and how one is found by its name."""

from typing import Final, Protocol

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.errors import PluginError
from neurotouch_hid.geometry import Rig
from neurotouch_hid.gesture.config import GestureConfig
from neurotouch_hid.messages import Gesture
from neurotouch_hid.plugins import METHODS, list_plugins, load_plugin

BUILT_IN: Final = ("neurotouch", "paper")


class GestureMethod(Protocol):
    """Recognises the gesture from the markers, one slice at a time.

    A package offers its own under ``neurotouch.methods``: a function that takes a
    ``GestureConfig`` and returns an object with these two functions.
    """

    def update(
        self,
        t_us: int,
        step_us: int,
        rest_px: NDArray[np.float32],
        moved_px: NDArray[np.float64],
        use: NDArray[np.bool_],
        rig: Rig,
    ) -> Gesture:
        """Returns the gesture at the end of a slice.

        Args:
            t_us: the end of the slice, in µs of sensor time.
            step_us: the time since the slice before, in µs.
            rest_px: (177, 2) float32, the markers at rest, columns x, y; a new array object when
                they have changed.
            moved_px: (177, 2) float64, how far each marker is from the neutral pose, in px; NaN
                where ``use`` is False.
            use: (177,) bool, True where the marker is measured.
            rig: turns pixels into mm and back.
        """

    def reset(self) -> None:
        """Forgets the gesture that is being made: the gel was lost, or the neutral pose changed."""


def list_methods() -> tuple[str, ...]:
    """Returns the names of all methods, our own first."""
    return *BUILT_IN, *(name for name in list_plugins(METHODS) if name not in BUILT_IN)


def make_method(config: GestureConfig) -> GestureMethod:
    """Returns a new recogniser of ``config.method``.

    Raises:
        PluginError: there is no such method, or it cannot be used.
    """
    if config.method == "neurotouch":
        from neurotouch_hid.gesture.elastic import ElasticMethod  # noqa: PLC0415

        return ElasticMethod(config)
    if config.method == "paper":
        # With OpenCV, which takes 60 MB and a twentieth of every start.
        from neurotouch_hid.gesture.paper.method import PaperMethod  # noqa: PLC0415

        return PaperMethod(config)
    make = load_plugin(METHODS, config.method)
    if make is None:
        raise PluginError(
            f"There is no method '{config.method}'.", hint=f"Methods: {', '.join(list_methods())}."
        )
    return _Checked(config.method, make(config))


class _Checked:
    """A method of another package; what it gives is checked, so that mistakes are named."""

    def __init__(self, name: str, method: GestureMethod) -> None:
        for function in ("update", "reset"):
            if not callable(getattr(method, function, None)):
                raise PluginError(
                    f"The method '{name}' has no function '{function}'.",
                    hint="It must be what GestureMethod describes.",
                )
        self._name, self._method = name, method

    def update(
        self,
        t_us: int,
        step_us: int,
        rest_px: NDArray[np.float32],
        moved_px: NDArray[np.float64],
        use: NDArray[np.bool_],
        rig: Rig,
    ) -> Gesture:
        gesture: object = self._method.update(t_us, step_us, rest_px, moved_px, use, rig)
        if not isinstance(gesture, Gesture):
            raise PluginError(
                f"The method '{self._name}' returned {type(gesture).__name__}, not a Gesture.",
                hint="Return neurotouch_hid.messages.Gesture, or no_gesture(t_us).",
            )
        return gesture

    def reset(self) -> None:
        self._method.reset()
