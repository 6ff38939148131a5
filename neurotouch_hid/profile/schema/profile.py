"""Model of a profile: version 1 of the file format, strict, bounded and self-describing.

A profile is a list of bindings, or several lists, its layers. Each binding says *when* (a gesture,
perhaps narrowed) and what to *do* (exactly one output, perhaps shaped).
"""

from typing import Annotated, Any, Final, Literal, Self

from pydantic import AfterValidator, BaseModel, Field, model_validator
from pydantic_core import PydanticCustomError

from neurotouch_hid.printable import is_printable
from neurotouch_hid.profile.schema.conditions import Condition, GestureName, Sequence, When
from neurotouch_hid.profile.schema.shaping import Linear, Planar, Shaped
from neurotouch_hid.profile.schema.strict import Strict, give_unit, make_optional
from neurotouch_hid.profile.schema.targets import (
    LAYER_PATTERN,
    Acting,
    Driven,
    EightWay,
    LayerTarget,
    StickTarget,
    Target,
)
from neurotouch_hid.profile.schema.timing import FilterName, TimingSetting
from neurotouch_hid.vocabulary import NAME_PATTERN, GestureKind

FIRST_LAYER: Final = "base"
"""What the layer of a profile without layers is called."""

DEFAULT_REST_MM: Final = 1.0
"""Where an axis begins to move: just above the mean error of the intensity."""

DEFAULT_FULL_MM: Final = {
    GestureKind.PUSH: 8.0,
    GestureKind.PINCH: 7.0,
    GestureKind.ZOOM: 4.5,
    GestureKind.TWIST_CW: 7.0,
    GestureKind.TWIST_CCW: 7.0,
}
"""Where an axis reaches its end. Opening the hand is the weakest movement, pushing the strongest:
recorded zooms reach 8 mm, pushes 17.5 mm [NT, intensity figure]."""

POSITION_RANGE_MM: Final = (2.0, 18.0)
"""From the middle of the gel outwards; the error of a contact point is 3.4 mm [NT, "Results"]."""

SPEED_RANGE_MM_S: Final = (20.0, 150.0)
"""Recorded gestures reach about 210 mm/s [NT, intensity figure]."""


def check_version(version: int) -> int:
    """Returns the version, if this program knows it."""
    if version != 1:
        hint = "update the program" if version > 1 else "neurotouch profile upgrade FILE"
        text = "this program reads version 1 of the format"
        raise PydanticCustomError("version", text, {"hint": hint})
    return version


class SettingsFile(Strict):
    """A file of settings, whose first key is the version of its format."""

    version: Annotated[int, AfterValidator(check_version)] = Field(
        default=1,
        description="The version of this format: 1. Default: 1.",
        json_schema_extra={"const": 1},
    )


def check_visible(text: str) -> str:
    """Returns the text, if nothing in it could change what a terminal shows around it."""
    for char in text:
        if not is_printable(char) and char not in "\n\t":
            raise PydanticCustomError(
                "invisible",
                "has a character that cannot be seen, {code}",
                {"code": f"U+{ord(char):04X}", "hint": "remove it"},
            )
    return text


class Binding(Strict):
    """One line of a profile: when this, do that."""

    when: When = Field(
        description="A gesture's name, its name with what narrows it, or a sequence of gestures. "
        "No default."
    )
    do: Target = Field(description="Exactly one output, with how it acts. No default.")

    @property
    def condition(self) -> Condition:
        """The long form of ``when``; of a sequence, its last step."""
        match self.when:
            case str():
                return Condition.model_construct(gesture=self.when)
            case Sequence():
                return make_step(self.when.sequence[-1])
            case _:
                return self.when

    @property
    def is_followed(self) -> bool:
        """True if the output follows a measure; false if it is pressed or not."""
        return isinstance(self.do, Shaped) and not (
            isinstance(self.do, Driven) and self.do.value is not None
        )

    @property
    def thresholds_mm(self) -> tuple[float, float]:
        """The thresholds to act and to release, in mm; 0 where only its range decides."""
        condition = self.condition
        if self.is_followed and condition.on_mm is None and condition.level is None:
            return 0.0, 0.0
        return condition.thresholds_mm

    def range_for(self, kind: GestureKind) -> tuple[float, float]:
        """Returns the range in which the output moves, in mm, or mm/s for a speed."""
        if isinstance(self.do, Linear) and self.do.follow == "speed":
            return self.do.range_mm_s or SPEED_RANGE_MM_S
        if isinstance(self.do, Shaped) and self.do.range_mm is not None:
            return self.do.range_mm
        if isinstance(self.do, Linear | Planar) and self.do.follow.startswith("position"):
            return POSITION_RANGE_MM
        return DEFAULT_REST_MM, DEFAULT_FULL_MM[kind]

    @model_validator(mode="after")
    def _fits_together(self) -> Self:
        gesture = self.condition.gesture
        if isinstance(self.do, Planar) and self.do.follow == "push" and gesture != "push":
            key = "stick" if isinstance(self.do, StickTarget) else "mouse"
            way = f"'axis: {self.do.stick}_x'" if isinstance(self.do, StickTarget) else "the wheel"
            raise PydanticCustomError(
                "stick",
                "a whole {what} follows the direction of a push; a {gesture} moves one axis, {way}",
                {
                    "at": ("do", key),
                    "what": "stick" if key == "stick" else "pointer",
                    "gesture": gesture,
                    "way": way,
                },
            )
        if isinstance(self.do, Linear) and self.do.follow.startswith("push") and gesture != "push":
            raise PydanticCustomError(
                "stick", "only a push has this part", {"at": ("do", "follow"), "gesture": gesture}
            )
        if self.is_followed and not isinstance(self.when, str | Sequence):
            for key in ("press", "trigger", "accept_ms", "ignore_repeat_ms"):
                if getattr(self.when, key) is not None:
                    raise PydanticCustomError(
                        "timed",
                        "what follows a gesture has no '{key}', only what is pressed",
                        {
                            "at": ("when", "<pattern>", key),
                            "key": key,
                            "hint": "remove it, or press something instead, as with 'button: a'",
                        },
                    )
        if isinstance(self.when, Sequence) and self.is_followed:
            raise PydanticCustomError(
                "timed", "a sequence can only press something", {"at": ("when",)}
            )
        return self

    @property
    def mode(self) -> str:
        """The mode of a target that is pressed or a layer; ``hold`` for all others."""
        return self.do.mode if isinstance(self.do, Acting | LayerTarget) else "hold"


def make_step(name: str) -> Condition:
    """Returns the condition of one step of a sequence: ``push_left`` is a push to the left."""
    if name.startswith("push_"):
        return Condition.model_construct(gesture="push", direction=name.removeprefix("push_"))
    return Condition.model_construct(gesture=name)


Bindings = Annotated[list[Binding], Field(min_length=1, max_length=256)]


class Layer(Strict):
    """A set of bindings that are active together."""

    name: str = Field(
        pattern=LAYER_PATTERN,
        description="The layer's name: small letters, digits, _ and -. No default.",
    )
    below: Literal["inherit", "empty"] = Field(
        default="inherit",
        description="inherit: what no binding here covers is done as in the first layer. empty: "
        "nothing else is done. Default: inherit.",
    )
    bindings: Bindings = Field(description="What each gesture does in this layer. No default.")


class SafetyGesture(Strict):
    """A gesture that is held on purpose; it works in every layer."""

    gesture: GestureName = Field(description="The gesture. No default.")
    direction: EightWay | None = Field(
        default=None,
        description="Only a push this way. Default: any direction.",
        json_schema_extra=make_optional(),
    )
    on_mm: Annotated[float, Field(ge=1.0, le=18.0)] = Field(
        default=2.5,
        description="From this intensity on, in mm. Default: 2.5 mm.",
        json_schema_extra=give_unit("mm"),
    )
    hold_ms: Annotated[int, Field(ge=1000, le=10_000)] = Field(
        default=1500,
        description="For this long, in ms. Default: 1500 ms.",
        json_schema_extra=give_unit("ms"),
    )

    @property
    def condition(self) -> Condition:
        """The same as the condition of a binding."""
        return Condition.model_construct(
            gesture=self.gesture,
            direction=self.direction,
            on_mm=self.on_mm,
            press="long",
            hold_ms=self.hold_ms,
        )

    @model_validator(mode="after")
    def _fits_together(self) -> Self:
        if self.direction is not None and self.gesture != "push":
            raise PydanticCustomError(
                "direction",
                "only a push has a direction, a {gesture} has none",
                {"at": ("direction",), "gesture": self.gesture},
            )
        return self


class Safety(Strict):
    """Ways to stop with the gel alone, beside the keyboard and the command line."""

    pause: SafetyGesture | None = Field(
        default=None,
        description="Releases everything until the same gesture comes again. Default: none.",
        json_schema_extra=make_optional(),
    )
    panic: SafetyGesture | None = Field(
        default=None,
        description="Releases everything until a person resumes at the keyboard. Default: none.",
        json_schema_extra=make_optional(),
    )


class Profile(Strict):
    """A profile: turns gestures on the gel into a game controller."""

    version: Annotated[int, AfterValidator(check_version)] = Field(
        description="The version of this format: 1. No default.", json_schema_extra={"const": 1}
    )
    name: str = Field(
        pattern=NAME_PATTERN,
        description="The profile's name: small letters, digits, _ and -, at most 64. No default.",
    )
    description: Annotated[str, AfterValidator(check_visible)] = Field(
        default="", max_length=500, description="What it is for, in a sentence. Default: empty."
    )
    extends: Annotated[
        list[Annotated[str, Field(pattern=NAME_PATTERN)]], Field(min_length=1, max_length=4)
    ] = Field(
        default=[],
        description="Names of profiles this one is built on; what it says itself comes first. "
        "Default: none.",
    )
    timing: TimingSetting | None = Field(
        default=None,
        description="How fast and how patient: game, steady, slow, or a preset with changes. "
        "Where the user has a timing too, the slower one applies. Default: game.",
        json_schema_extra=make_optional(),
    )
    filter: FilterName | None = Field(
        default=None,
        description="The tremor filter: none, light, medium or strong. The user's own goes "
        "first. Default: the timing preset's.",
        json_schema_extra=make_optional(),
    )
    latch: bool | None = Field(
        default=None,
        description="Keep the gesture that was recognised until it ends. Default: true.",
        json_schema_extra=make_optional(),
    )
    bindings: Bindings | None = Field(
        default=None,
        description="What each gesture does. Where two move one axis, the larger value counts; "
        "where they are equal, the earlier binding. Default: none; then there are layers or "
        "other profiles this one extends.",
        json_schema_extra=make_optional(),
    )
    layers: Annotated[list[Layer], Field(min_length=1, max_length=8)] | None = Field(
        default=None,
        description="Several sets of bindings. One is active at a time, at the start the first. "
        "Default: one, made of 'bindings'.",
        json_schema_extra=make_optional(),
    )
    safety: Safety = Field(
        default_factory=Safety.model_construct,
        description="Gestures that pause everything. Default: none.",
    )

    @property
    def all_layers(self) -> tuple[Layer, ...]:
        """The layers, the first one first; ``bindings`` are one called ``base``."""
        if self.bindings is not None:
            base = Layer.model_construct(name=FIRST_LAYER, bindings=self.bindings)
            return (base, *(self.layers or ()))
        return tuple(self.layers or ())


def make_schema(model: type[BaseModel], title: str) -> dict[str, Any]:
    """Returns the JSON Schema of a file format, for editors."""
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        **model.model_json_schema(),
        "title": title,
    }


def profile_schema() -> dict[str, Any]:
    """Returns the JSON Schema of a profile; shipped as ``profiles/schema/profile-1.json``."""
    return make_schema(Profile, "neurotouch_hid profile")
