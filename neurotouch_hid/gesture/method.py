"""Interface of methods, and ``make_method``, which finds one by its name."""

from collections.abc import Iterator
from typing import Any, Final, Protocol

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.errors import PluginError
from neurotouch_hid.geometry import PAPER_GEL, Gel, Rig
from neurotouch_hid.gesture.config import GestureConfig
from neurotouch_hid.messages import Gesture, GestureKind
from neurotouch_hid.plugins import METHODS, Plugin, check_call, find_plugin, list_plugins

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
            t_us: the end of the slice, µs of sensor time.
            step_us: the time since the previous slice, µs.
            rest_px: (n, 2) float32 px, the markers at rest, columns x, y; a new array object when
                they have changed. Their number n depends on the gel.
            moved_px: (n, 2) float64 px, displacement of each marker from the neutral pose;
                without meaning where ``use`` is False. Valid until the next call, as ``use``.
            use: (n,) bool, True for measured markers.
            rig: fitted to ``rest_px``; converts pixels to mm and back.
        """

    def reset(self) -> None:
        """Forgets the gesture in progress: the gel was lost, or the neutral pose changed."""


class Recognition(GestureMethod, Protocol):
    """A method as ``GestureRecognizer`` uses it."""

    def note_rest(self, t_us: int) -> None:
        """Takes that a frame, exposed about ``t_us``, shows the gel at rest."""


def list_methods() -> tuple[str, ...]:
    """Returns the names of all methods, our own first."""
    return *BUILT_IN, *(name for name in list_plugins(METHODS) if name not in BUILT_IN)


def make_method(config: GestureConfig, gel: Gel = PAPER_GEL) -> Recognition:
    """Returns a new recogniser of ``config.method`` for a gel.

    Raises:
        PluginError: there is no such method, or it cannot be used.
    """
    if config.method == "neurotouch":
        from neurotouch_hid.gesture.elastic import ElasticMethod  # noqa: PLC0415

        return ElasticMethod(config, gel)
    if config.method == "paper":
        # It imports OpenCV, which takes 60 MB and a twentieth of the time of a start.
        from neurotouch_hid.gesture.paper.method import PaperMethod  # noqa: PLC0415

        return PaperMethod(config)
    plugin = find_plugin(METHODS, config.method)
    if plugin is None:
        raise PluginError(
            f"There is no method '{config.method}'.", hint=f"Methods: {', '.join(list_methods())}."
        )
    method = plugin.make(config)
    with plugin.running():
        return _Checked(plugin, method)


_UPDATE: Final = ("t_us", "step_us", "rest_px", "moved_px", "use", "rig")
_MOST: Final = 1e6
"""Larger numbers make no sense, and streams could not send them."""
_RANGES: Final = (
    ("intensity_mm", 0.0, _MOST),
    ("rotation_rad", -_MOST, _MOST),
    ("scale", 0.0, _MOST),
    ("confidence", 0.0, 1.0),
)


class _Checked:
    """Checks what another package's method returns, so that an error names the mistake."""

    def __init__(self, plugin: Plugin, method: GestureMethod) -> None:
        name = plugin.point.name
        for function, arguments in (("update", _UPDATE), ("reset", ())):
            if not callable(getattr(method, function, None)):
                raise PluginError(
                    f"The method '{name}' has no function '{function}'.",
                    hint="It must be what GestureMethod describes.",
                )
            what = f"The function '{function}' of the method '{name}'"
            check_call(what, getattr(method, function), *arguments)
        self._name, self._method, self._plugin = name, method, plugin

    def update(
        self,
        t_us: int,
        step_us: int,
        rest_px: NDArray[np.float32],
        moved_px: NDArray[np.float64],
        use: NDArray[np.bool_],
        rig: Rig,
    ) -> Gesture:
        gesture: object
        with self._plugin.running():
            gesture = self._method.update(t_us, step_us, rest_px, moved_px, use, rig)
        if not isinstance(gesture, Gesture):
            raise PluginError(
                f"The method '{self._name}' returned {type(gesture).__name__}, not a Gesture.",
                hint="Return neurotouch_hid.messages.Gesture, or no_gesture(t_us).",
            )
        mistake = next(_find_mistakes(gesture, t_us), None)
        if mistake is not None:
            what, must = mistake
            raise PluginError(f"The method '{self._name}' returned {what}.", hint=f"{must}.")
        return gesture

    def note_rest(self, t_us: int) -> None:
        """Does nothing: other packages' methods have two functions only."""

    def reset(self) -> None:
        with self._plugin.running():
            self._method.reset()


def _find_mistakes(gesture: Any, t_us: int) -> Iterator[tuple[str, str]]:
    """Gives what is wrong in a gesture of another package, and how it must be."""
    if not isinstance(gesture.kind, GestureKind):
        yield f"the kind {gesture.kind!r}", "It must be a GestureKind, for example GestureKind.PUSH"
    if gesture.t_us != t_us:
        yield f"the time {gesture.t_us}", f"It must be the t_us that was given, {t_us} here"
    points = gesture.contacts_mm, gesture.contacts_px
    if not all(isinstance(each, np.ndarray) and each.dtype.kind == "f" for each in points):
        types = " and ".join(str(getattr(each, "dtype", type(each).__name__)) for each in points)
        yield f"contacts of the types {types}", "Both must be arrays of float64"
    elif len(shape := points[0].shape) != 2 or shape[1] != 2 or points[1].shape != shape:
        shapes = f"contacts of the shapes {shape} (mm) and {points[1].shape} (px)"
        yield shapes, "Both must be (K, 2), for K contacts"
    elif not all((np.abs(each) <= _MOST).all() for each in points):
        yield (
            "a contact that is nowhere",
            f"Both numbers must be from {-_MOST:,.0f} to {_MOST:,.0f}",
        )
    for name, least, most in _RANGES:
        value = getattr(gesture, name)
        if not _is_number(value, least, most):
            must = f"It must be a plain float from {least:,.0f} to {most:,.0f}"
            yield f"{value!r} as {name}", must
    pair = gesture.translation_mm
    is_pair = isinstance(pair, tuple) and len(pair) == 2
    if not is_pair or not all(_is_number(each, -_MOST, _MOST) for each in pair):
        yield f"{pair!r} as translation_mm", "It must be a tuple of two plain floats, (x, y)"


def _is_number(value: object, least: float, most: float) -> bool:
    """Returns True for a number in a range that can be written as JSON, which numpy's cannot."""
    return isinstance(value, int | float) and least <= value <= most
