"""Which bindings hold in a layer: its own, and those of the first that it does not cover."""

from neurotouch_hid.profile.conditions import Condition, Sequence
from neurotouch_hid.profile.schema import Binding, Layer

_NARROWING = ("direction", "zone", "contacts", "level", "phase", "press")


def merge_bindings(upper: Layer, first: Layer) -> tuple[Binding, ...]:
    """The bindings of a layer with those it inherits, its own first."""
    if upper is first or upper.below == "empty":
        return tuple(upper.bindings)
    return (*upper.bindings, *uncovered(first.bindings, upper.bindings))


def uncovered(lower: list[Binding], upper: list[Binding]) -> list[Binding]:
    """The bindings of ``lower`` that no binding of ``upper`` covers."""
    return [binding for binding in lower if not any(covers(top, binding) for top in upper)]


def covers(upper: Binding, lower: Binding) -> bool:
    """True if ``upper`` acts whenever ``lower`` would: its gesture, and no narrower."""
    if isinstance(upper.when, Sequence) or isinstance(lower.when, Sequence):
        return upper.when == lower.when
    return _is_within(lower.condition, upper.condition)


def _is_within(narrow: Condition, wide: Condition) -> bool:
    return set(narrow.kinds) <= set(wide.kinds) and all(
        getattr(wide, key) in (None, getattr(narrow, key)) for key in _NARROWING
    )
