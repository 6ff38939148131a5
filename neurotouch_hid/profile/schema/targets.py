"""Targets of a binding: exactly one output, and the way it acts."""

from typing import Annotated, Final, Literal, Self

from pydantic import AfterValidator, Discriminator, Field, Tag, model_validator
from pydantic_core import PydanticCustomError

from neurotouch_hid.profile.schema.keyboard_keys import parse_chord
from neurotouch_hid.profile.schema.shaping import Linear, Planar
from neurotouch_hid.profile.schema.strict import Strict, find_tag, give_unit, make_optional
from neurotouch_hid.profile.schema.timing import Ms
from neurotouch_hid.vocabulary import NAME_PATTERN, Button

Side = Literal["left", "right"]
StickAxis = Literal["left_x", "left_y", "right_x", "right_y"]
EightWay = Literal["left", "right", "up", "down", "up_left", "up_right", "down_left", "down_right"]
MouseButton = Literal["left", "right", "middle", "back", "forward"]
ModeName = Literal["hold", "toggle", "sticky", "oneshot", "turbo"]
CommandName = Literal["pause", "panic", "rezero", "next_profile"]

LAYER_PATTERN: Final = NAME_PATTERN


class Repeat(Strict):
    """Presses again and again while held, like a key of a keyboard."""

    delay_ms: Ms | None = Field(
        default=None,
        description="When the second press comes, in ms. Default: the timing preset's.",
        json_schema_extra=make_optional("ms"),
    )
    every_ms: Annotated[int, Field(ge=60, le=10_000)] | None = Field(
        default=None,
        description="The time from each to the next, in ms. Default: the timing preset's.",
        json_schema_extra=make_optional("ms"),
    )


class Acting(Strict):
    """Mode of an output that is either pressed or not."""

    mode: ModeName = Field(
        default="hold",
        description="hold: down as long as the gesture. toggle: down until the gesture comes "
        "again. sticky: down until the next other action is done; twice in a row locks it. "
        "oneshot: the same without the lock. turbo: quick presses while held. Default: hold.",
    )
    repeat: Repeat | None = Field(
        default=None,
        description="Press again and again while held: {} or {delay_ms, every_ms}. Default: no.",
        json_schema_extra=make_optional(),
    )
    every_ms: Annotated[int, Field(ge=60, le=10_000)] = Field(
        default=100,
        description="The period of turbo, in ms. Default: 100 ms.",
        json_schema_extra=give_unit("ms"),
    )
    max_s: Annotated[float, Field(ge=0.5, le=60.0)] = Field(
        default=5.0,
        description="When turbo stops by itself, in s, so that a stuck hand cannot go on for "
        "ever. Default: 5 s.",
        json_schema_extra=give_unit("s"),
    )

    @model_validator(mode="after")
    def _repeats_what_is_held(self) -> Self:
        if self.repeat is not None and self.mode != "hold":
            raise PydanticCustomError("repeat", "only 'mode: hold' can repeat", {"at": ("repeat",)})
        return self


class Driven(Linear, Acting):
    """One axis or trigger: driven by a measure, or pressed to a fixed value."""

    value: Annotated[float, Field(ge=0.1, le=1.0)] | None = Field(
        default=None,
        description="Press it to this value instead of following the gesture; then it has modes "
        "like a button. Default: follow.",
        json_schema_extra=make_optional("1"),
    )

    @model_validator(mode="after")
    def _acts_only_with_a_value(self) -> Self:
        if self.value is None and (self.mode != "hold" or self.repeat is not None):
            at = "mode" if self.mode != "hold" else "repeat"
            raise PydanticCustomError(
                "mode",
                "only what is pressed has modes: add 'value: 1.0' to press this to its end",
                {"at": (at,)},
            )
        return self


class StickTarget(Planar):
    """A push moves a whole stick, the way and as far as it goes."""

    stick: Side = Field(description="The stick. No default.")


class AxisTarget(Driven):
    """A measure moves one axis of a stick."""

    axis: StickAxis = Field(description="The axis; right and down are positive. No default.")
    sign: Literal["+", "-"] = Field(
        default="+",
        description='Which way: "+" is right or down, "-" is left or up. Default: "+".',
    )


class TriggerTarget(Driven):
    """A measure pulls a trigger."""

    trigger: Side = Field(description="The trigger. No default.")


class ButtonTarget(Acting):
    """A button is down while the condition is met."""

    button: Annotated[Button, Field(strict=False)] = Field(
        description="The button, by the word printed on it. No default."
    )


class DpadTarget(Acting):
    """The D-pad is pressed one way while the condition is met."""

    dpad: EightWay = Field(description="The way. No default.")


class KeyTarget(Acting):
    """A key or a chord of keys is down while the condition is met."""

    key: Annotated[str, AfterValidator(lambda text: (parse_chord(text), text)[1])] = Field(
        max_length=64,
        description="A key of a keyboard, or several joined by +, such as ctrl+c. No default.",
    )

    @property
    def kernel_names(self) -> tuple[str, ...]:
        """The keys as the kernel names them, in the order written."""
        return parse_chord(self.key)


class MouseButtonTarget(Acting):
    """A button of the mouse is down while the condition is met."""

    mouse: MouseButton = Field(description="The button. No default.")


class MouseMotionTarget(Planar):
    """A push moves the mouse pointer, the further the faster."""

    mouse: Literal["motion"] = Field(description="Move the pointer. No default.")
    speed_px_s: Annotated[float, Field(ge=10.0, le=5000.0)] = Field(
        default=800.0,
        description="How fast a full push moves it, in px/s. Default: 800 px/s.",
        json_schema_extra=give_unit("px/s"),
    )
    dwell_ms: Annotated[int, Field(ge=200, le=10_000)] | None = Field(
        default=None,
        description="Click the left button when the pointer has rested this long after a "
        "movement, in ms. Default: never.",
        json_schema_extra=make_optional("ms"),
    )
    freeze_on_click: bool = Field(
        default=True,
        description="Keep the pointer still while a mouse button is down, until it is pushed 12 "
        "px away. Default: true.",
    )


class MouseWheelTarget(Linear):
    """A measure turns the wheel of the mouse."""

    mouse: Literal["wheel"] = Field(description="Turn the wheel. No default.")
    sign: Literal["+", "-"] = Field(
        default="+",
        description='Which way: "+" is up (away), "-" is down (towards you). Default: "+".',
    )
    clicks_per_s: Annotated[float, Field(ge=0.5, le=50.0)] = Field(
        default=10.0,
        description="How fast a full gesture turns it, in clicks per second. Default: 10.",
        json_schema_extra=give_unit("1/s"),
    )


class LayerTarget(Strict):
    """Another layer of bindings becomes the current one."""

    layer: str = Field(
        pattern=LAYER_PATTERN,
        description="The layer's name; in that layer itself, the way back to the first. "
        "No default.",
    )
    mode: Literal["hold", "toggle", "oneshot"] = Field(
        default="toggle",
        description="hold: as long as the gesture. toggle: until it comes again. oneshot: for the "
        "next action. Default: toggle.",
    )


class CommandTarget(Strict):
    """The program itself does something."""

    command: CommandName = Field(
        description="pause: stop and release everything, or go on. panic: the same, and only a "
        "person at the keyboard can go on. rezero: what the hand does now is rest. next_profile: "
        "the next of the favourites. No default."
    )


TARGETS: Final[dict[str, type[Strict]]] = {
    "stick": StickTarget,
    "axis": AxisTarget,
    "trigger": TriggerTarget,
    "button": ButtonTarget,
    "dpad": DpadTarget,
    "key": KeyTarget,
    "mouse": MouseButtonTarget,
    "layer": LayerTarget,
    "command": CommandTarget,
}
MICE: Final[dict[str, type[Strict]]] = {"motion": MouseMotionTarget, "wheel": MouseWheelTarget}


def _find_target(value: object) -> str | None:
    tag = find_tag(value, TARGETS)
    if isinstance(value, dict) and tag == "<mouse>" and value["mouse"] in ("motion", "wheel"):
        return f"<{value['mouse']}>"
    if tag is None:
        return next((f"<{key}>" for key, model in MICE.items() if type(value) is model), None)
    return tag


Target = Annotated[
    Annotated[StickTarget, Tag("<stick>")]
    | Annotated[AxisTarget, Tag("<axis>")]
    | Annotated[TriggerTarget, Tag("<trigger>")]
    | Annotated[ButtonTarget, Tag("<button>")]
    | Annotated[DpadTarget, Tag("<dpad>")]
    | Annotated[KeyTarget, Tag("<key>")]
    | Annotated[MouseButtonTarget, Tag("<mouse>")]
    | Annotated[MouseMotionTarget, Tag("<motion>")]
    | Annotated[MouseWheelTarget, Tag("<wheel>")]
    | Annotated[LayerTarget, Tag("<layer>")]
    | Annotated[CommandTarget, Tag("<command>")],
    Discriminator(
        _find_target,
        custom_error_type="one_of",
        custom_error_message="needs exactly one of: " + ", ".join(TARGETS),
    ),
]
