"""Explains a wrong command line in one sentence, then shows the correct one."""

import difflib
import re
from collections.abc import Sequence

import click

from neurotouch_hid.vocabulary import SourceKind, find_source_kind


class WrongUsage(click.UsageError):
    """A command line that click accepts, but this program refuses.

    Args:
        message: the mistake, in a sentence.
        hint: the correct command line.
    """

    def __init__(self, message: str, *, hint: str) -> None:
        super().__init__(message)
        self.hint = hint


class SignedCommand(click.Command):
    """A command whose arguments may begin with a minus, as -0.5; ``--word`` is still an option."""

    ignore_unknown_options = True

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Parses the words; one that looks like an option must be one."""
        known = {option for param in self.get_params(ctx) for option in param.opts}
        for word in args:
            name = word.partition("=")[0]
            if re.fullmatch(r"--[A-Za-z][\w-]*", name) and name not in known:
                raise click.NoSuchOption(name, ctx=ctx)
        return super().parse_args(ctx, args)


def explain_usage(error: click.UsageError) -> tuple[str, str]:
    """Returns the mistake in a command line, and the fix.

    It rewords click's messages; a message that it does not know stays as it is.
    """
    message, hint = error.message, ""
    if isinstance(error, WrongUsage):
        hint = error.hint
    elif isinstance(error, click.NoSuchOption):
        message, hint = _explain_option(error)
    elif isinstance(error, click.MissingParameter) and error.param is not None:
        message, hint = f"{_label(error.param)} is missing.", _give_example(error)
    elif isinstance(error, click.BadParameter) and error.param is not None:
        message, hint = _explain_value(error.message, error.param)
    elif isinstance(error, click.BadOptionUsage):
        message, hint = _explain_missing_value(error)
    elif found := re.match(r"Got unexpected extra arguments? \((.*)\)", message):
        message, hint = _explain_extra(error, found[1])
    return _finish(message), hint or f"See: {_name(error)} --help"


def _name(error: click.UsageError) -> str:
    """Returns the command as it is typed, without its options."""
    return "neurotouch" if error.ctx is None else error.ctx.command_path


def _finish(words: str) -> str:
    """Returns the words as a sentence."""
    words = words.strip()
    return words[:1].upper() + words[1:].rstrip(".") + "."


def _label(param: click.Parameter) -> str:
    if isinstance(param, click.Argument):
        return (param.metavar or param.name or "").strip("[].").replace("]", "").upper()
    return f"Option {max(param.opts, key=len)}"


def _explain_option(error: click.NoSuchOption) -> tuple[str, str]:
    name, ctx = error.option_name, error.ctx
    words = f"There is no option {name}."
    known = [] if ctx is None else [o for p in ctx.command.get_params(ctx) for o in p.opts]
    long = [option for option in known if option.startswith("--")]
    words_near = difflib.get_close_matches(name.lower().strip("-"), [o[2:] for o in long], 1)
    near = [f"--{each}" for each in words_near]
    begun = [option for option in long if len(name) > 2 and option.startswith(name.lower())]
    if near or begun:
        return words, f"Did you mean {(begun or near)[0]}?"
    if ctx is not None and ctx.parent is None:
        return words, "Options come after the command, as in: neurotouch demo --seconds 10"
    return words, ""


def _explain_value(message: str, param: click.Parameter) -> tuple[str, str]:
    label, kind = _label(param), param.type
    value = message.partition(" is not ")[0].strip("'\"")
    if isinstance(kind, click.Choice):
        choices = [str(choice) for choice in kind.choices]
        return f"{label} cannot be '{value}'.", _offer(value, choices)
    if isinstance(kind, click.types.IntParamType | click.types.FloatParamType):
        if " is not " not in message:
            return f"{label}: {message}", ""
        return f"{label} must be {_describe(kind)}, not '{value}'.", _write(param, kind)
    if isinstance(kind, click.Path):
        return _explain_path(message, label)
    return f"{label}: {message}", ""


def _explain_path(message: str, label: str) -> tuple[str, str]:
    name = message.partition("'")[2].rpartition("'")[0]
    if "is a directory" in message:
        return f"{label} must be a file, and '{name}' is a folder.", "Give the name of a file."
    if "is a file" in message:
        return f"{label} must be a folder, and '{name}' is a file.", "Give the name of a folder."
    if "does not exist" in message:
        return f"There is no file '{name}'.", "Check the name."
    return f"{label}: {message}", ""


def _offer(wrong: str, choices: Sequence[str]) -> str:
    """Returns a hint with the choices, the nearest first."""
    near = difflib.get_close_matches(wrong.lower().replace("-", "_"), choices, 1)
    near = near or difflib.get_close_matches(wrong.lower(), choices, 1)
    listed = f"Choices: {', '.join(choices)}."
    return f"Did you mean {near[0]}? {listed}" if near else listed


def _describe(kind: click.ParamType) -> str:  # type: ignore[type-arg]  # generic from click 8.5 on
    """Returns the required kind of number, in words."""
    what = "a whole number" if isinstance(kind, click.types.IntParamType) else "a number"
    low, high = getattr(kind, "min", None), getattr(kind, "max", None)
    if low is not None and high is not None:
        return f"{what} from {low:g} to {high:g}"
    return what if low is None else f"{what} of at least {low:g}"


def _write(param: click.Parameter, kind: click.ParamType) -> str:  # type: ignore[type-arg]
    """Returns a hint with a valid number."""
    low, high = getattr(kind, "min", None), getattr(kind, "max", None)
    default = param.default if isinstance(param.default, int | float) else None
    number = 10 if default is None else default
    if param.name == "port":
        number = 7900  # a port that every user may use
    if low is not None:
        number = max(number, low)
    if high is not None:
        number = min(number, high)
    name = max(param.opts, key=len) if isinstance(param, click.Option) else _label(param)
    return f"For example: {name} {number:g}"


def _explain_missing_value(error: click.BadOptionUsage) -> tuple[str, str]:
    name, ctx = error.option_name, error.ctx
    if "does not take a value" in error.message:
        return f"Option {name} takes no value.", f"Write only {name}"
    params = [] if ctx is None else ctx.command.get_params(ctx)
    param = next((each for each in params if name in each.opts), None)
    words = f"Option {name} needs a value."
    if param is None:
        return words, ""
    if isinstance(param.type, click.Choice):
        return words, f"Choices: {', '.join(map(str, param.type.choices))}."
    if isinstance(param.type, click.types.IntParamType | click.types.FloatParamType):
        return words, _write(param, param.type)
    metavar = param.metavar or ("FILE" if isinstance(param.type, click.Path) else "TEXT")
    return words, f"Write: {name} {metavar}"


def _explain_extra(error: click.UsageError, words: str) -> tuple[str, str]:
    """Returns the fix for words that a command does not take, such as ``run sim:tour``."""
    first, ctx = words.split(maxsplit=1)[0] if words else "", error.ctx
    names = [] if ctx is None else [param.name for param in ctx.command.get_params(ctx)]
    sentence = f"'{words}' is one argument too many."
    if " " in words:
        sentence = f"These arguments are too many: {words}."
    if "source" in names and find_source_kind(first) is not SourceKind.OTHER:
        return sentence, f"Did you mean: {_name(error)} --source {first}"
    if ctx is not None and "when" in names:
        return sentence, _quote_binding(ctx, words.split())
    option = next((name for name in ("scene", "profile") if name in names), None)
    if option is not None and re.fullmatch(r"[\w-]+", first):
        return sentence, f"Did you mean: {_name(error)} --{option} {first}"
    return sentence, ""


def _quote_binding(ctx: click.Context, extra: list[str]) -> str:
    """Returns the fix for a gesture and an action that are typed without quotation marks."""
    from neurotouch_hid.errors import ProfileError
    from neurotouch_hid.profile.editing import parse_do, parse_when

    name, when, do = (str(ctx.params.get(key)) for key in ("name", "when", "do"))
    words = [*when.split(), *do.split(), *extra]
    for n in range(len(words), 0, -1):
        parts = [part for part in (" ".join(words[:n]), " ".join(words[n:])) if part]
        try:
            parse_when(parts[0])
            if len(parts) > 1:
                parse_do(parts[1])
            elif ctx.command.name == "bind":
                continue
        except ProfileError:
            continue
        typed = " ".join(f'"{part}"' if " " in part else part for part in parts)
        return f"Try: {ctx.command_path} {name} {typed}"
    return ""


def _give_example(error: click.UsageError) -> str:
    """Returns the first example of the command's help, or nothing."""
    epilog = "" if error.ctx is None else error.ctx.command.epilog or ""
    for line in epilog.splitlines():
        example = re.split(r"\s{2,}", line.strip())[0]
        if example.startswith(_name(error)):
            return f"For example: {example}"
    return ""
