"""Warns of bindings that need movements a person does not make."""

from collections.abc import Collection, Iterator
from typing import Final

from neurotouch_hid.files.faults import Fault, Keys, format_path
from neurotouch_hid.files.yaml_document import Node, find_mark
from neurotouch_hid.profile.diagnostics.consistency import list_bindings
from neurotouch_hid.profile.schema.conditions import Condition, Sequence
from neurotouch_hid.profile.schema.movements import MOVEMENTS
from neurotouch_hid.profile.schema.profile import Binding, Profile, make_step
from neurotouch_hid.vocabulary import GestureKind

_PUSHES: Final = tuple(name for name in MOVEMENTS if name.startswith("push_"))


def find_unmet(
    profile: Profile, whole: Profile, root: Node, unused: Collection[str]
) -> list[Fault]:
    """Returns the warnings about movements a person does not make.

    Args:
        profile: as it is in the file.
        whole: with everything it is built on.
        root: the file.
        unused: the movements the person does not make.
    """
    if not unused:
        return []
    found = list(_check_bindings(profile, unused))
    if profile.extends:
        own = [binding for _, _, binding in list_bindings(profile)]
        theirs = [b for layer in whole.all_layers for b in layer.bindings if b not in own]
        lost = {name for binding in theirs for name in _find_lost(binding, unused)}
        if lost:
            found.append(
                (("extends",), f"what it is built on needs {_join(lost)}, which you do not use")
            )
    for name in ("pause", "panic"):
        gesture = getattr(profile.safety, name)
        if gesture is not None and not _list_made(gesture.condition, unused):
            found.append((("safety", name), f"you do not use this gesture: no {name} by the gel"))
    return [
        Fault(find_mark(root, keys), format_path(keys), sentence, code="NT212")
        for keys, sentence in found
    ]


def _check_bindings(profile: Profile, unused: Collection[str]) -> Iterator[tuple[Keys, str]]:
    for keys, _, binding in list_bindings(profile):
        lost = _find_lost(binding, unused)
        if not lost:
            continue
        words = _join(lost)
        if isinstance(binding.when, Sequence) or not _list_made(binding.condition, unused):
            yield (*keys, "when"), f"you do not use {words}: this never acts"
        else:
            yield (*keys, "when"), f"you do not use {words}: this never goes that way"


def _find_lost(binding: Binding, unused: Collection[str]) -> list[str]:
    """Returns the movements a binding misses.

    What is pressed misses none as long as one way is left.
    """
    if isinstance(binding.when, Sequence):
        steps = [make_step(name) for name in binding.when.sequence]
        return [name for step in steps if not _list_made(step, unused) for name in _list_all(step)]
    movements = _list_all(binding.condition)
    lost = [name for name in movements if name in unused]
    return lost if binding.is_followed or not _list_made(binding.condition, unused) else []


def _list_made(condition: Condition, unused: Collection[str]) -> list[str]:
    """Returns the movements that still meet a condition; a diagonal push needs two at once."""
    movements = _list_all(condition)
    made = [name for name in movements if name not in unused]
    needs_all = condition.direction is not None and len(made) < len(movements)
    return [] if needs_all else made


def _list_all(condition: Condition) -> list[str]:
    """Returns every movement that meets a condition."""
    found: list[str] = []
    for kind in condition.kinds:
        if kind != GestureKind.PUSH:
            found.append(kind.label)
        elif condition.direction is None:
            found += _PUSHES
        else:
            found += [f"push_{way}" for way in condition.direction.split("_")]
    return found


def _join(names: Collection[str]) -> str:
    return " and ".join(MOVEMENTS[name].words for name in MOVEMENTS if name in names)
