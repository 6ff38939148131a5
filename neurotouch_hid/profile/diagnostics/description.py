"""Says a binding in words, for people who watch, listen or test."""

from neurotouch_hid.profile.schema.conditions import Condition, Sequence
from neurotouch_hid.profile.schema.profile import Binding
from neurotouch_hid.profile.schema.targets import (
    AxisTarget,
    ButtonTarget,
    CommandTarget,
    DpadTarget,
    KeyTarget,
    LayerTarget,
    MouseButtonTarget,
    MouseMotionTarget,
    MouseWheelTarget,
    StickTarget,
    Target,
    TriggerTarget,
)


def describe_binding(binding: Binding) -> str:
    """Returns for example ``push left tap -> key ctrl+c``."""
    return f"{describe_when(binding)} -> {describe_target(binding.do)}"


def describe_when(binding: Binding) -> str:
    """Returns for example ``push left tap``."""
    if isinstance(binding.when, Sequence):
        return " then ".join(step.replace("_", " ") for step in binding.when.sequence)
    return describe_condition(binding.condition)


def describe_condition(condition: Condition) -> str:
    """Returns for example ``push left tap`` or ``pinch hard``."""
    words = [condition.gesture.replace("_", " ")]
    if condition.direction is not None:
        words.append(condition.direction.replace("_", " "))
    if condition.zone is not None:
        words.append(f"at the {condition.zone}")
    if condition.contacts is not None:
        words.append(f"with {condition.contacts} finger{'s' if condition.contacts > 1 else ''}")
    if condition.with_button is not None:
        words.append(f"while {condition.with_button} is held")
    words += [word for word in (condition.level, condition.press) if word is not None]
    if condition.phase is not None:
        words.append(f"in its {condition.phase}")
    if condition.on_mm is not None:
        words.append(f"from {condition.on_mm:g} mm")
    return " ".join(words)


def describe_target(target: Target) -> str:
    """Returns for example ``button a`` or ``toggle key ctrl+c``."""
    match target:
        case StickTarget():
            words = f"stick {target.stick}"
        case AxisTarget():
            words = f"axis {target.axis} {target.sign}"
        case TriggerTarget():
            words = f"trigger {target.trigger}"
        case ButtonTarget():
            words = f"button {target.button.value}"
        case DpadTarget():
            words = f"dpad {target.dpad.replace('_', ' ')}"
        case KeyTarget():
            words = f"key {target.key}"
        case MouseButtonTarget():
            words = f"mouse {target.mouse}"
        case MouseMotionTarget():
            words = "mouse pointer"
        case MouseWheelTarget():
            words = "mouse wheel"
        case LayerTarget():
            words = f"layer {target.layer}"
        case CommandTarget():
            return target.command.replace("_", " ")
    mode = getattr(target, "mode", "hold")
    return words if mode == "hold" else f"{mode} {words}"
