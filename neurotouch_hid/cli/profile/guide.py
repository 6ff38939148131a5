"""The questions and answers of ``neurotouch profile edit``."""

from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

import click

from neurotouch_hid.cli.profile.drafts import keep_draft
from neurotouch_hid.cli.profile.gel import see_gesture, try_on_gel
from neurotouch_hid.cli.profile.saving import offer_saving
from neurotouch_hid.cli.profile.values import ask_value
from neurotouch_hid.cli.ui.outcome import show_faults
from neurotouch_hid.cli.ui.output import choose, echo, is_plain, say, show_changes
from neurotouch_hid.errors import ProfileError

if TYPE_CHECKING:
    from neurotouch_hid.profile import Profile
    from neurotouch_hid.profile.editing import EditedFile, ProfileText
    from neurotouch_hid.profile.schema import Binding


class _Back(Exception):  # noqa: N818  it is an answer
    """The person wants the question before."""


class Guide:
    """Asks, changes the draft and shows the result; the person keeps it or undoes it."""

    def __init__(
        self,
        edited: "EditedFile",
        text: "ProfileText",
        draft: Path,
        source: str | None,
        *,
        plain: bool,
    ) -> None:
        self._edited = edited
        self._text = text
        self._draft = draft
        self._source = source
        self._plain = plain

    def run(self) -> bool:
        """Asks until the person is done; where it cannot be saved, or on Ctrl-C, a draft is kept.

        Raises:
            ProfileError: the profile has errors already.
        """
        try:
            self._edited.check(self._text).require()
        except ProfileError as error:
            hint = f"Fix it first: neurotouch profile edit {self._edited.name} --editor"
            raise ProfileError(error.message, hint=hint) from None
        with keep_draft(self._draft, self._edited, lambda: self._text):
            while self._ask_what():
                pass
            offer_saving(self._edited, self._text, plain=self._plain)
        return True

    def _load(self) -> "Profile":
        from neurotouch_hid.profile import Profile

        written = self._edited.check(self._text).written
        assert isinstance(written, Profile)  # noqa: S101  every step leaves a right draft
        return written

    def _ask_what(self) -> bool:
        from neurotouch_hid.profile.editing import summarize_binding
        from neurotouch_hid.profile.schema import FIRST_LAYER

        profile = self._load()
        layers = list(profile.all_layers)
        at = 0
        if len(layers) > 1:
            at = choose("Which layer?", [*(inner.name for inner in layers), "Done"])
            if at == len(layers):
                return False
        name, bindings = (layers[at].name, layers[at].bindings) if layers else (FIRST_LAYER, [])
        choices = [summarize_binding(binding) for binding in bindings]
        n = len(choices)
        more = ["Bind a gesture", f"Timing: {self._word(profile.timing)}"]
        more += [f"Tremor filter: {profile.filter or 'the default'}", "Done"]
        at = choose(f"{profile.name}: what do you want to change?", [*choices, *more])
        try:
            if at < n:
                self._change_binding(name, at, bindings[at])
            elif at == n:
                self._bind(name)
            elif at == n + 1:
                self._set("timing", ("game", "steady", "slow"))
            elif at == n + 2:
                self._set("filter", ("none", "light", "medium", "strong"))
        except _Back:
            return True
        return at <= n + 2

    @staticmethod
    def _word(timing: object) -> str:
        return timing if isinstance(timing, str) else "the default" if timing is None else "own"

    def _change_binding(self, layer: str, at: int, binding: "Binding") -> None:
        from neurotouch_hid.profile.editing import summarize_binding

        self._show_response(binding)
        answer = _pick(
            summarize_binding(binding),
            ["Let it do something else", "Give it another gesture", "Adjust it", "Remove it"],
        )
        if answer == 0:
            self._replace(layer, at, "do", self._ask_do())
        elif answer == 1:
            self._replace(layer, at, "when", self._ask_when())
        elif answer == 2:
            self._adjust(layer, at, binding)
        elif answer == 3:
            self._try(self._text.remove((*self._find(layer), at)))

    def _adjust(self, layer: str, at: int, binding: "Binding") -> None:
        from neurotouch_hid.profile.editing import format_value, list_questions

        questions = list(list_questions(binding))
        shown = [
            f"{q.key}: {'the default' if q.value is None else format_value(q.value)}"
            for q in questions
        ]
        question = questions[_pick("What do you want to adjust?", shown)]
        echo(question.description)
        path = f"{self._path(layer)}[{at}].{question.part}.{question.key}"
        self._set(path, question.choices, layer, at)

    def _set(
        self, path: str, words: tuple[str, ...], layer: str | None = None, at: int = 0
    ) -> None:
        from neurotouch_hid.profile.editing import parse_value, reset_value, set_value

        try:
            value = ask_value(words)
            if value is None:
                raise _Back
            text = (
                set_value(self._text, path, parse_value(value))
                if value
                else reset_value(self._text, path)
            )
        except ProfileError as error:
            say("FAILED", error.message, error.hint or "", plain=self._plain)
            return
        self._try(text, layer, at)

    def _bind(self, layer: str) -> None:
        from neurotouch_hid.profile.editing import bind

        while True:
            when = self._ask_when()
            with suppress(_Back):
                do = None if when is None else self._ask_do()
                break
        name = layer if self._find(layer) != ("bindings",) else None
        if when is not None and do is not None:
            self._try(bind(self._text, when, do, name, add=True))

    def _replace(self, layer: str, at: int, part: str, value: object) -> None:
        if value is not None:
            self._try(self._text.replace((*self._find(layer), at, part), value), layer, at)

    def _find(self, layer: str) -> tuple[str | int, ...]:
        from neurotouch_hid.profile.editing import locate_bindings

        return locate_bindings(self._text.document, layer)

    def _path(self, layer: str) -> str:
        from neurotouch_hid.files.faults import format_path

        return format_path(self._find(layer))

    def _ask_when(self) -> object:
        from neurotouch_hid.profile.editing import GESTURES, PRESSES, parse_when

        gestures = list(GESTURES)
        if self._source is not None:
            gestures.append("Show it on the gel")
        while True:
            number = _pick("Which gesture?", gestures)
            gesture = gestures[number]
            if number == len(GESTURES):
                shown = see_gesture(self._source or "")
                if shown is None:
                    return None
                gesture = shown
            with suppress(_Back):
                press = _pick("How?", list(PRESSES), default=0)
                return parse_when(f"{gesture} {list(PRESSES.values())[press]}")

    def _ask_do(self) -> object:
        from neurotouch_hid.profile.editing import OUTPUTS, parse_do

        kinds = list(OUTPUTS)
        while True:
            words = OUTPUTS[kinds[_pick("What should it do?", kinds)]]
            with suppress(_Back):
                chosen = words[_pick("Which one?", words)] if words else f"key {_ask_key()}"
                try:
                    return parse_do(chosen)
                except ProfileError as error:
                    say("FAILED", error.message, error.hint or "", plain=self._plain)
                    return None

    def _try(self, text: "ProfileText", layer: str | None = None, at: int = 0) -> None:
        """Shows what a change does, and keeps it if the person wants it."""
        from neurotouch_hid.profile.editing import compare

        checked = self._edited.check(text)
        if checked.whole is None:
            show_faults(checked, plain=self._plain)
            echo("That does not fit, nothing has changed.")
            return
        before, self._text = self._text, text
        show_changes(compare(before, text), plain=self._plain)
        show_faults(checked, plain=self._plain)
        if layer is not None:
            layers = {inner.name: inner for inner in self._load().all_layers}
            self._show_response(layers[layer].bindings[at])
        answers = ["Keep it", "Take it back"]
        if self._source is not None:
            answers.append("Try it on the gel")
        answer = choose("Keep it?", answers, default=0)
        while answer == 2:
            try_on_gel(self._source or "", self._load())
            answer = choose("Keep it?", answers, default=0)
        if answer == 1:
            self._text = before

    def _show_response(self, binding: "Binding") -> None:
        """Shows the value moving through the curve, from rest to beyond the end."""
        from neurotouch_hid.profile.editing import sample_response

        for measure, value in sample_response(binding):
            bar = "" if self._plain or is_plain() else " " + "#" * round(40 * value)
            echo(f"at {measure:>8}: {100 * value:3.0f} percent{bar}")


def _pick(question: str, choices: Sequence[str], *, default: int | None = None) -> int:
    """Asks for one of several; the last answer goes back.

    Raises:
        _Back: the person wants the question before.
    """
    number = choose(question, [*choices, "Back"], default=default)
    if number == len(choices):
        raise _Back
    return number


def _ask_key() -> str:
    """Asks for a key.

    Raises:
        _Back: the person wants the question before.
    """
    question = "Key, or several with +, such as ctrl+c; nothing goes back"
    key: str = click.prompt(question, default="", show_default=False)
    if not key.strip():
        raise _Back
    return key
