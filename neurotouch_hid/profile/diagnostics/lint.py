"""Warnings: what loads, but does nothing or is risky."""

from collections.abc import Iterator, Mapping
from typing import Final

from neurotouch_hid.files.faults import Fault, Keys, format_path
from neurotouch_hid.files.yaml_document import Node, find_mark
from neurotouch_hid.profile.diagnostics.consistency import list_bindings
from neurotouch_hid.profile.diagnostics.description import describe_binding
from neurotouch_hid.profile.schema.conditions import Sequence
from neurotouch_hid.profile.schema.keyboard_keys import is_order_to_kernel
from neurotouch_hid.profile.schema.layering import merge_bindings
from neurotouch_hid.profile.schema.profile import Binding, Profile
from neurotouch_hid.profile.schema.targets import KeyTarget, LayerTarget
from neurotouch_hid.profile.schema.timing import PRESETS
from neurotouch_hid.vocabulary import GestureKind

COUNTING_MM: Final = 7.0
"""From here on the number of fingers is right in 90 % of cases [NT, "Results"]."""

NOISE_MM: Final = 0.96
"""Mean error of the intensity [NT, "Results"]."""

CERTAIN_MM: Final = 2.5
LEVELS_MM: Final = 3.0
LONG_HOLD_MS: Final = 5_000

REACH_MM: Final = {
    GestureKind.PUSH: 17.5,
    GestureKind.PINCH: 12.0,
    GestureKind.ZOOM: 8.0,
    GestureKind.TWIST_CW: 12.0,
    GestureKind.TWIST_CCW: 12.0,
}
"""How far people go: the paper's figure for push and zoom, a cautious reading for the others."""

_Remark = tuple[str, Keys, str]


def find_warnings(profile: Profile, whole: Profile, root: Node) -> list[Fault]:
    """Returns the warnings about what is in the file.

    Args:
        profile: as it is in the file.
        whole: with everything it is built on.
        root: the file.
    """
    layers, listed = whole.all_layers, list(list_bindings(profile))
    merged = {layer.name: merge_bindings(layer, layers[0]) for layer in layers}
    if profile.bindings is not None:  # they belong to the first layer, whatever its name
        merged[profile.all_layers[0].name] = merged[layers[0].name]
    findings = list(_check_whole(profile, whole))
    lines = {id(binding): find_mark(root, keys).line + 1 for keys, _, binding in listed}
    for keys, layer, binding in listed:
        beside = [other for other in merged[layer.name] if other is not binding]
        for code, place, sentence in (
            *_check_binding(binding),
            *_check_beside(binding, beside, lines),
            *_check_twin(binding, layer.bindings, keys),
        ):
            findings.append((code, (*keys, *place), sentence))
    return [
        Fault(find_mark(root, keys), format_path(keys), sentence, code=code)
        for code, keys, sentence in findings
    ]


def _check_whole(profile: Profile, whole: Profile) -> Iterator[_Remark]:
    if profile.safety.panic is not None and whole.safety.pause is None:
        yield "NT211", ("safety", "panic"), "a panic gesture, but no pause gesture"
    reached = {
        binding.do.layer
        for layer in whole.all_layers
        for binding in layer.bindings
        if isinstance(binding.do, LayerTarget)
    }
    for i, layer in enumerate(profile.layers or ()):
        if layer.name not in reached and layer.name != whole.all_layers[0].name:
            yield "NT209", ("layers", i, "name"), f"nothing leads to the layer '{layer.name}'"


def _check_binding(binding: Binding) -> Iterator[_Remark]:
    if isinstance(binding.do, LayerTarget) and binding.do.mode == "hold":
        yield (
            "NT206",
            ("do", "mode"),
            "while a gesture holds this layer, no other gesture can be made",
        )
    if isinstance(binding.do, KeyTarget) and is_order_to_kernel(binding.do.kernel_names):
        yield "NT213", ("do", "key"), "Linux takes Alt+Print for itself, so Print is left out"
    if isinstance(binding.when, Sequence):
        return
    condition = binding.condition
    on_mm, off_mm = binding.thresholds_mm
    if condition.contacts is not None and on_mm < COUNTING_MM:
        yield (
            "NT201",
            ("when", "contacts"),
            f"fingers are counted reliably only from {COUNTING_MM:g} mm on: add 'on_mm: 7'",
        )
    if 0.0 < on_mm < CERTAIN_MM:
        yield "NT210", ("when", "on_mm"), f"below {CERTAIN_MM:g} mm a gesture is often mistaken"
    if 0.0 < on_mm < off_mm + NOISE_MM:
        key = "off_mm" if condition.off_mm is not None else "on_mm"
        yield (
            "NT202",
            ("when", key),
            f"only {on_mm - off_mm:.2g} mm between pressing and releasing, less than the noise "
            f"({NOISE_MM:g} mm)",
        )
    reach_mm = max(REACH_MM[kind] for kind in condition.kinds)
    if on_mm > reach_mm - NOISE_MM:
        yield (
            "NT204",
            ("when", "on_mm"),
            f"people reach {reach_mm:g} mm with this gesture: this may never act",
        )
    if condition.hold_ms is not None and condition.hold_ms > LONG_HOLD_MS:
        yield "NT205", ("when", "hold_ms"), "a hold of more than 5 s tires"


def _check_beside(
    binding: Binding, beside: list[Binding], lines: Mapping[int, int]
) -> Iterator[_Remark]:
    """Gives the remarks about bindings of one gesture that affect each other.

    Args:
        binding: the binding.
        beside: the others of its layer.
        lines: the lines of the bindings that are in this file, by ``id``.
    """
    if binding.is_followed or isinstance(binding.when, Sequence):
        return
    condition = binding.condition
    others = [
        other
        for other in beside
        if not isinstance(other.when, Sequence)
        and not other.is_followed
        and condition.has_gesture_of(other.condition)
    ]
    if condition.press == "tap" and any(other.condition.press == "double" for other in others):
        waits = ", ".join(f"{times.double_ms} ms ({name})" for name, times in PRESETS.items())
        yield "NT203", ("when", "press"), f"waits for the double tap beside it: {waits}"
    later = [
        f"'{describe_binding(other)}'{_name_line(lines.get(id(other)))}"
        for other in others
        if other.condition.press is not None
        and other.condition.level == condition.level
        and other.thresholds_mm[0] >= binding.thresholds_mm[0]
    ]
    if condition.press is None and later:
        words = f"'{describe_binding(binding)}' acts first, each time that you make"
        yield "NT208", ("when",), f"{words} {' or '.join(later)}"
    if condition.level == "hard":
        soft = [other.thresholds_mm[0] for other in others if other.condition.level == "soft"]
        if soft and condition.thresholds_mm[0] - max(soft) < LEVELS_MM:
            yield "NT207", ("when", "level"), "less than 3 mm above the soft level"


def _name_line(line: int | None) -> str:
    return "" if line is None else f" (line {line})"


def _check_twin(binding: Binding, bindings: list[Binding], keys: Keys) -> Iterator[_Remark]:
    before = bindings[: int(keys[-1])]
    if any(other.when == binding.when and other.do == binding.do for other in before):
        yield "NT204", ("when",), "an earlier binding does the same"
