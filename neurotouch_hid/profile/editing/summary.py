"""A whole profile in words, one fact a line."""

from collections.abc import Iterator
from typing import Any, Final

from neurotouch_hid.profile.diagnostics.description import describe_binding, describe_condition
from neurotouch_hid.profile.editing.key_paths import name_bindings
from neurotouch_hid.profile.editing.yaml_values import format_value
from neurotouch_hid.profile.schema.conditions import CONDITION_KEYS
from neurotouch_hid.profile.schema.layering import merge_bindings
from neurotouch_hid.profile.schema.movements import MOVEMENTS
from neurotouch_hid.profile.schema.profile import Binding, Layer, Profile
from neurotouch_hid.profile.schema.targets import TARGETS
from neurotouch_hid.profile.schema.timing import resolve_times
from neurotouch_hid.profile.schema.user import UserSettings, choose_filter

TOUR: Final = "\n".join(
    f"{gesture} {amount} {way}; rest 1500ms"
    for gesture, amount in (
        ("push left", "11mm"),
        ("push right", "11mm"),
        ("push up", "11mm"),
        ("push down", "11mm"),
        ("pinch", "11mm"),
        ("zoom", "7.9mm"),
        ("twist_cw", "11mm"),
        ("twist_ccw", "11mm"),
    )
    for way in ("tap", "300ms hold 2s")
)
"""Every movement once quickly and once held, as far as people go."""

_SAID_OF_WHEN: Final = ("sequence", *CONDITION_KEYS)
_SAID_OF_DO: Final = (*TARGETS, "sign", "mode")
"""The keys that are in a binding's words already."""


_IN_WORDS: Final = {
    "off_mm": "released below {:g} mm",
    "gain": "times {:g}",
    "slew_per_s": "at most {:g} of its range a second",
    "speed_px_s": "{:g} pixels a second",
    "clicks_per_s": "{:g} clicks a second",
}
"""Keys of a binding that a person reads as words, with their number."""


def summarize(profile: Profile, user: UserSettings | None = None) -> Iterator[str]:
    """Gives the profile line by line.

    Args:
        profile: as written, or with everything it is built on.
        user: the person; then every time and the layers' inherited bindings are given too.
    """
    yield f"profile: {profile.name}"
    if profile.description:
        yield f"description: {' '.join(profile.description.split())}"
    if profile.extends:
        yield f"built on: {', '.join(profile.extends)}"
    yield from _summarize_times(profile, user)
    layers = profile.all_layers
    for layer in layers:
        shown = layer
        if user is not None and layer is not layers[0]:
            bindings = list(merge_bindings(layer, layers[0]))
            shown = layer.model_copy(update={"bindings": bindings})
        yield from _summarize_layer(shown, alone=len(layers) == 1)
    for name in ("pause", "panic"):
        gesture = getattr(profile.safety, name)
        if gesture is not None:
            words = describe_condition(gesture.condition)
            yield f"{name}: {words}, held {gesture.hold_ms} ms"


def summarize_binding(binding: Binding) -> str:
    """Returns a binding with everything it sets, ``push -> stick left, from 1 to 8 mm``."""
    words = [describe_binding(binding)]
    for part, said in ((binding.when, _SAID_OF_WHEN), (binding.do, _SAID_OF_DO)):
        if not isinstance(part, str):
            written = part.model_dump(mode="json", exclude_unset=True)
            words += [_say_setting(key, value) for key, value in written.items() if key not in said]
    return ", ".join(words)


def _say_setting(key: str, value: Any) -> str:
    """Returns what a key of a binding sets, in words where there are some."""
    if key == "curve":
        bend = value.get("expo", value.get("power"))
        return "curve of its own" if bend is None else f"bend {bend:g}"
    if key in ("range_mm", "range_mm_s"):
        low, high = value
        return f"from {low:g} to {high:g} {key.removeprefix('range_').replace('_s', '/s')}"
    if key == "value":
        return f"pressed to {100 * value:.0f} %"
    words = _IN_WORDS.get(key)
    return f"{key} {format_value(value)}" if words is None else words.format(value)


def _summarize_times(profile: Profile, user: UserSettings | None) -> Iterator[str]:
    if user is None:
        for key in ("timing", "filter", "latch"):
            value = getattr(profile, key)
            if value is not None:
                plain = (
                    value if isinstance(value, str | bool) else value.model_dump(exclude_unset=True)
                )
                yield f"{key}: {format_value(plain)}"
        return
    times = resolve_times(profile.timing, user.timing)
    for key in times.__slots__:
        value = getattr(times, key)
        if key == "filter":
            value = choose_filter(profile, user)
        yield f"{key}: {format_value(value)}"
    for movement, range_ in user.range:
        if range_ is not None:
            yield f"your range of {movement}: {range_.rest:g} to {range_.full:g} mm"
    if user.unused:
        yield f"you do not use: {', '.join(MOVEMENTS[name].words for name in user.unused)}"
    if user.tremor_hz is not None:
        yield f"your tremor_hz: {user.tremor_hz:g}"
    for key in ("handedness", "mirror", "rotate_deg", "neutral"):
        yield f"your {key}: {format_value(getattr(user, key))}"


def _summarize_layer(layer: Layer, *, alone: bool) -> Iterator[str]:
    if not alone:
        others = "as in the first layer" if layer.below == "inherit" else "nothing"
        yield f"layer: {layer.name}; every other gesture does {others}"
    written = [each.model_dump(mode="json", exclude_unset=True) for each in layer.bindings]
    for name, binding in zip(name_bindings(written), layer.bindings, strict=True):
        yield f"  {name}: {summarize_binding(binding)}"
