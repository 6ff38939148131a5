"""Times: the three presets, and the changes a profile or a user makes to them."""

from dataclasses import dataclass, fields, replace
from typing import Annotated, Any, Final, Literal

from pydantic import Discriminator, Field, Tag

from neurotouch_hid.profile.schema.strict import Strict, make_optional

PresetName = Literal["game", "steady", "slow"]
FilterName = Literal["none", "light", "medium", "strong"]
Trigger = Literal["press", "release"]

Ms = Annotated[int, Field(ge=0, le=10_000)]
"""A time a person may need to change: up to ten times a second and more."""


@dataclass(frozen=True, slots=True)
class Times:
    """Every time of a preset, in ms.

    Attributes:
        accept_ms: how long a gesture must last before it counts (slow keys).
        ignore_repeat_ms: how long after it ended the same does not count again (bounce keys).
        tap_ms: the longest tap.
        hold_ms: when a press becomes a hold.
        long_ms: when a hold becomes a long hold.
        double_ms: the longest pause between the two taps of a double tap.
        gap_ms: the shortest; below it is a tremor, not a tap.
        repeat_delay_ms: when a repeat begins.
        repeat_every_ms: its period.
        trigger: act when a gesture begins or when it ends.
        weak_release: releases when the intensity falls clearly, even above the threshold.
        filter: the tremor filter that goes with it.
        floor: the person's own times, if there are some: nothing in a profile goes below them.
    """

    accept_ms: int
    ignore_repeat_ms: int
    tap_ms: int
    hold_ms: int
    long_ms: int
    double_ms: int
    gap_ms: int
    repeat_delay_ms: int
    repeat_every_ms: int
    trigger: Trigger
    weak_release: bool
    filter: FilterName
    floor: "Times | None" = None

    def choose_ms(self, name: str, own: int | None) -> int:
        """Returns the named time, or the binding's own one if that is not below the person's."""
        if own is None:
            return int(getattr(self, name))
        return own if self.floor is None else max(own, int(getattr(self.floor, name)))

    def choose_trigger(self, own: Trigger | None) -> Trigger:
        """Returns the trigger, or a binding's own one; what acts on release always does."""
        if own is None or (self.floor is not None and self.floor.trigger == "release"):
            return self.trigger
        return own


PRESETS: Final[dict[PresetName, Times]] = {
    "game": Times(0, 0, 220, 350, 800, 300, 80, 500, 120, "press", False, "light"),
    "steady": Times(120, 200, 400, 700, 1500, 600, 80, 500, 120, "press", False, "medium"),
    "slow": Times(400, 500, 900, 1500, 3000, 1500, 80, 2000, 2000, "release", True, "strong"),
}
"""Starting points, not truths: gamers' tools sit at 80 to 300 ms, access tools at 300 to 2000 ms,
so that no single default serves both."""


def _ms(text: str) -> Any:
    return Field(
        default=None,
        description=f"{text} Default: the preset's.",
        json_schema_extra=make_optional("ms"),
    )


class Timing(Strict):
    """A preset with changes."""

    preset: PresetName = Field(
        default="game",
        description="What the other times are taken from: game, steady or slow. Default: game.",
    )
    accept_ms: Ms | None = _ms("How long a gesture must last before it counts, in ms.")
    ignore_repeat_ms: Ms | None = _ms("How long after it ended the same is ignored, in ms.")
    tap_ms: Ms | None = _ms("The longest tap, in ms.")
    hold_ms: Ms | None = _ms("When a press becomes a hold, in ms.")
    long_ms: Ms | None = _ms("When it becomes a long hold, in ms.")
    double_ms: Ms | None = _ms("The longest pause between the taps of a double tap, in ms.")
    gap_ms: Ms | None = _ms("The shortest pause between the taps of a double tap, in ms.")
    trigger: Trigger | None = Field(
        default=None,
        description="Whether a button acts when a gesture begins (press) or when it ends "
        "(release). Default: the preset's.",
        json_schema_extra=make_optional(),
    )
    weak_release: bool | None = Field(
        default=None,
        description="Release when the intensity falls by a third, even above the threshold. "
        "Default: the preset's.",
        json_schema_extra=make_optional(),
    )


TimingSetting = Annotated[
    Annotated[PresetName, Tag("<name>")] | Annotated[Timing, Tag("<timing>")],
    Discriminator(lambda value: "<timing>" if isinstance(value, dict | Timing) else "<name>"),
]


def resolve_times(game: str | Timing | None, user: str | Timing | None) -> Times:
    """Returns the times that apply: the profile's or the user's, the slower of both."""
    times = _resolve(game if game is not None else "game")
    if user is None:
        return times
    floor = _resolve(user)
    return Times(
        **{
            field.name: max(getattr(times, field.name), getattr(floor, field.name))
            for field in fields(Times)
            if field.name not in ("trigger", "weak_release", "filter", "gap_ms", "floor")
        },
        gap_ms=floor.gap_ms,
        trigger="release" if "release" in (times.trigger, floor.trigger) else "press",
        weak_release=times.weak_release or floor.weak_release,
        filter=floor.filter,
        floor=floor,
    )


def _resolve(setting: str | Timing) -> Times:
    if not isinstance(setting, Timing):
        return PRESETS[setting]  # type: ignore[index]
    changes = setting.model_dump(exclude={"preset"}, exclude_none=True)
    return replace(PRESETS[setting.preset], **changes)
