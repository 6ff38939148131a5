"""Merges the bindings of a layer with those of the first layer that it does not cover."""

from neurotouch_hid.profile.schema.conditions import CONDITION_KEYS, Sequence
from neurotouch_hid.profile.schema.profile import Binding, Layer

_NARROWING = (*(set(CONDITION_KEYS) - {"gesture", "on_mm"}), "min_speed_mm_s")


def merge_bindings(upper: Layer, first: Layer) -> tuple[Binding, ...]:
    """Returns the bindings of a layer with those it inherits, its own first."""
    if upper is first or upper.below == "empty":
        return tuple(upper.bindings)
    return (*upper.bindings, *uncovered(first.bindings, upper.bindings))


def uncovered(lower: list[Binding], upper: list[Binding]) -> list[Binding]:
    """Returns the bindings of ``lower`` that no binding of ``upper`` covers."""
    return [binding for binding in lower if not any(covers(top, binding) for top in upper)]


def covers(upper: Binding, lower: Binding) -> bool:
    """Returns True if ``upper`` acts whenever ``lower`` would: its gesture, and no narrower."""
    if isinstance(upper.when, Sequence) or isinstance(lower.when, Sequence):
        return upper.when == lower.when
    wide, narrow = upper.condition, lower.condition
    if wide.on_mm is not None and wide.on_mm > lower.thresholds_mm[0]:
        return False
    return set(narrow.kinds) <= set(wide.kinds) and all(
        getattr(wide, key) in (None, getattr(narrow, key)) for key in _NARROWING
    )
