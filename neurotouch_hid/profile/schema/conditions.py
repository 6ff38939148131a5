"""Conditions of a binding: a gesture, perhaps narrowed, or several one after another."""

from typing import Annotated, Final, Literal, Self

from pydantic import Discriminator, Field, Tag, model_validator
from pydantic_core import PydanticCustomError

from neurotouch_hid.profile.schema.strict import Strict, give_unit, make_optional
from neurotouch_hid.profile.schema.targets import EightWay
from neurotouch_hid.profile.schema.timing import Ms, Trigger
from neurotouch_hid.vocabulary import Button, GestureKind

DEFAULT_ON_MM: Final = 2.5
"""Where an output that is either pressed or not presses: the type of a gesture is right in more
than 90 % of cases from 2.5 mm on [NT, "Results"]."""

HARD_ON_MM: Final = 6.0
"""Where the hard level begins: two levels at most, and more than 3 mm apart, for the mean error
of the intensity is 0.96 mm [NT, "Results"]."""

OFF_SHARE: Final = 0.6
"""``off_mm`` as a share of ``on_mm`` where a profile does not say: 2.5 mm on, 1.5 mm off, a gap as
large as the mean error of the intensity (0.96 mm [NT, "Results"])."""

GestureName = Literal["push", "pinch", "zoom", "twist_cw", "twist_ccw", "twist", "scale", "any"]
StepName = Literal[
    "push",
    "push_left",
    "push_right",
    "push_up",
    "push_down",
    "pinch",
    "zoom",
    "twist_cw",
    "twist_ccw",
]
Zone = Literal["centre", "left", "right", "up", "down"]
PressName = Literal["tap", "double", "hold", "long"]

_TWISTS: Final = (GestureKind.TWIST_CW, GestureKind.TWIST_CCW)
_SCALES: Final = (GestureKind.ZOOM, GestureKind.PINCH)
KINDS: Final[dict[str, tuple[GestureKind, ...]]] = {
    **{kind.label: (kind,) for kind in GestureKind if kind != GestureKind.NONE},
    "twist": _TWISTS,
    "scale": _SCALES,
    "any": tuple(kind for kind in GestureKind if kind != GestureKind.NONE),
}
"""The kinds each name means."""


CONDITION_KEYS: Final = (
    *("gesture", "direction", "zone", "contacts", "with_button"),
    *("level", "press", "phase", "on_mm"),
)
"""The keys of a condition that people say, in their order; the others only say how it acts."""

_PRESSED_KEYS: Final = ("level", "press", "on_mm")


class WeakRelease(Strict):
    """For hands that close more easily than they open."""

    drop: Annotated[float, Field(ge=0.1, le=0.9)] = Field(
        default=0.35,
        description="Release when the intensity has fallen by this share from its peak; a rise of "
        "20 % presses again. Default: 0.35.",
        json_schema_extra=give_unit("1"),
    )
    max_hold_ms: Annotated[int, Field(ge=100, le=60_000)] | None = Field(
        default=None,
        description="Release after this long in any case, in ms. Default: never.",
        json_schema_extra=make_optional("ms"),
    )


class Condition(Strict):
    """The condition of a binding: a gesture, narrowed by the other keys."""

    gesture: GestureName = Field(
        description="The gesture. Clockwise and counter-clockwise are as seen by the user. twist "
        "is both twists, scale is zoom and pinch (to the negative side), any is every gesture. "
        "No default."
    )
    direction: EightWay | None = Field(
        default=None,
        description="Only a push this way; down is towards the user. Default: any direction.",
        json_schema_extra=make_optional(),
    )
    sectors: Literal[4, 8] | None = Field(
        default=None,
        description="Into how many directions pushes are told apart: 4 of 90° or 8 of 45°. "
        "Default: 8 for a diagonal direction, else 4.",
        json_schema_extra=make_optional(),
    )
    zone: Zone | None = Field(
        default=None,
        description="Only where the fingers were laid on this part of the gel: its centre or one "
        "of four sides, with 4 mm between them that belong to none. Default: anywhere.",
        json_schema_extra=make_optional(),
    )
    contacts: Annotated[int, Field(ge=1, le=3)] | None = Field(
        default=None,
        description="Only with this many fingers. Counting is right in 90 % of cases from 7 mm on, "
        "so do not let it alone guard anything important. Default: any number.",
        json_schema_extra=make_optional("fingers"),
    )
    with_button: Annotated[Button, Field(strict=False)] | None = Field(
        default=None,
        description="Only while this button is held on the device that plays along (run "
        "--copilot); which of the two comes first does not matter. Meanwhile the gesture is this "
        "binding's alone: those without a button do not act on it. Default: none.",
        json_schema_extra=make_optional(),
    )
    level: Literal["soft", "hard"] | None = Field(
        default=None,
        description="soft: from 2.5 mm on, and where a hard level is bound too, only if the "
        "gesture stays below it. hard: from 6 mm on. Default: no levels.",
        json_schema_extra=make_optional(),
    )
    phase: Literal["attack", "hold", "release"] | None = Field(
        default=None,
        description="Only while the intensity rises, stays or falls. Default: always.",
        json_schema_extra=make_optional(),
    )
    min_speed_mm_s: Annotated[float, Field(ge=5.0, le=200.0)] | None = Field(
        default=None,
        description="Only if the gesture has risen at least this fast, in mm/s. Default: any.",
        json_schema_extra=make_optional("mm/s"),
    )
    on_mm: Annotated[float, Field(ge=1.0, le=18.0)] | None = Field(
        default=None,
        description="Act from this intensity on, in mm. Default: 2.5 mm for what is pressed (6 mm "
        "for the hard level), no threshold for what follows (its range does it).",
        json_schema_extra=make_optional("mm"),
    )
    off_mm: Annotated[float, Field(ge=0.5, le=17.0)] | None = Field(
        default=None,
        description="Release below this intensity, in mm. Default: 0.6 of on_mm, so 1.5 mm.",
        json_schema_extra=make_optional("mm"),
    )
    press: PressName | None = Field(
        default=None,
        description="tap: pressed and released quickly. double: the second of two taps. hold: kept "
        "for a while. long: kept for longer still; a hold beside it then acts when it ends sooner. "
        "Default: as soon and as long as the gesture is there.",
        json_schema_extra=make_optional(),
    )
    hold_ms: Ms | None = Field(
        default=None,
        description="How long a hold or long press of this binding takes, in ms. Default: the "
        "timing preset's.",
        json_schema_extra=make_optional("ms"),
    )
    accept_ms: Ms | None = Field(
        default=None,
        description="How long the gesture must last before it counts, in ms. Default: the timing "
        "preset's.",
        json_schema_extra=make_optional("ms"),
    )
    ignore_repeat_ms: Ms | None = Field(
        default=None,
        description="How long the same is ignored after it began and again after it ended, in ms. "
        "Default: the timing preset's.",
        json_schema_extra=make_optional("ms"),
    )
    trigger: Trigger | None = Field(
        default=None,
        description="Act when the gesture begins (press) or when it ends (release); what turns "
        "into another gesture before it ends does nothing. Default: the timing preset's.",
        json_schema_extra=make_optional(),
    )
    release: WeakRelease | None = Field(
        default=None,
        description="Release more easily: {} or {drop, max_hold_ms}. Default: the timing preset's.",
        json_schema_extra=make_optional(),
    )

    @property
    def kinds(self) -> tuple[GestureKind, ...]:
        """The gestures as the recognizer names them."""
        return KINDS[self.gesture]

    @property
    def thresholds_mm(self) -> tuple[float, float]:
        """The thresholds to act and to release, in mm, with defaults filled in."""
        usual = HARD_ON_MM if self.level == "hard" else DEFAULT_ON_MM
        on_mm = usual if self.on_mm is None else self.on_mm
        return on_mm, OFF_SHARE * on_mm if self.off_mm is None else self.off_mm

    def has_gesture_of(self, other: "Condition") -> bool:
        """Returns True if both act on the same gesture, apart from how it is pressed."""
        keys = (key for key in CONDITION_KEYS if key not in _PRESSED_KEYS)
        return all(getattr(self, key) == getattr(other, key) for key in keys)

    @model_validator(mode="after")
    def _fits_together(self) -> Self:
        for key in ("direction", "sectors"):
            if getattr(self, key) is not None and self.gesture != "push":
                raise PydanticCustomError(
                    "direction",
                    "only a push has a direction, a {gesture} has none",
                    {"at": (key,), "gesture": self.gesture},
                )
        if self.sectors == 4 and self.direction and "_" in self.direction:
            raise PydanticCustomError(
                "sectors", "a diagonal direction needs 8 sectors", {"at": ("sectors",)}
            )
        on_mm, off_mm = self.thresholds_mm
        if off_mm >= on_mm:
            raise PydanticCustomError(
                "thresholds",
                "off_mm ({off} mm) must be below on_mm ({on} mm), or the output would flicker",
                {
                    "at": ("off_mm",),
                    "on": f"{on_mm:g}",
                    "off": f"{off_mm:g}",
                    "hint": f"set on_mm above {off_mm:g} first, or off_mm below {on_mm:g}",
                },
            )
        if self.hold_ms is not None and self.press not in ("hold", "long"):
            raise PydanticCustomError(
                "hold", "only with 'press: hold' or 'press: long'", {"at": ("hold_ms",)}
            )
        return self


class Sequence(Strict):
    """Gestures one after another; the last one acts, as long as it is there."""

    sequence: list[StepName] = Field(
        min_length=2,
        max_length=8,
        description="Two to eight gestures, in this order; push_left is a push to the left. "
        "No default.",
    )
    within_ms: Annotated[int, Field(ge=200, le=60_000)] | None = Field(
        default=None,
        description="How long all of it may take, in ms. Default: as long as you like.",
        json_schema_extra=make_optional("ms"),
    )


def _tag_when(value: object) -> str:
    if isinstance(value, Sequence) or (isinstance(value, dict) and "sequence" in value):
        return "<sequence>"
    return "<pattern>" if isinstance(value, dict | Condition) else "<name>"


When = Annotated[
    Annotated[GestureName, Tag("<name>")]
    | Annotated[Condition, Tag("<pattern>")]
    | Annotated[Sequence, Tag("<sequence>")],
    Discriminator(_tag_when),
]
