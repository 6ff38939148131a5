"""Completes in the shells what click's own classes do not."""

import os
import re

from click.shell_completion import (
    BashComplete,
    CompletionItem,
    FishComplete,
    ZshComplete,
    split_arg_string,
)

_BREAKS = frozenset(":=")


class Bash(BashComplete):
    """Bash, which splits words at colons and equals signs.

    It replaces only what is behind the last of them. Beside "any file" click's script forgets all
    names, so names come first here.
    """

    _n_kept = 0  # letters of the incomplete value that bash does not replace

    def get_completion_args(self) -> tuple[list[str], str]:
        """Returns the complete words behind the program's name, and the incomplete one."""
        place = int(os.environ["COMP_CWORD"])
        parts = split_arg_string(os.environ["COMP_WORDS"])[1 : place + 1]
        words: list[str] = []
        for i, part in enumerate(parts):
            if i and (part in _BREAKS or parts[i - 1] in _BREAKS):
                words[-1] += part
            else:
                words.append(part)
        if len(parts) < place:  # nothing of the next word is typed yet
            return words, ""
        *before, incomplete = words
        option, equals, value = incomplete.partition("=")
        if not (equals and option.startswith("--")):
            value = incomplete
        self._n_kept = len(value) - len("" if parts[-1] in _BREAKS else parts[-1])
        return before, incomplete

    def get_completions(self, args: list[str], incomplete: str) -> list[CompletionItem]:
        """Returns what bash can offer."""
        found = super().get_completions(args, incomplete)
        names = [item.value[self._n_kept :] for item in found if item.type == "plain"]
        return [CompletionItem(_quote(name)) for name in names] or found


class Zsh(ZshComplete):
    """Zsh, which replaces the whole word: with a value alone, ``--profile=`` would be lost."""

    # Files are completed by zsh itself, which must not look for one called ``--gel=``.
    source_template = ZshComplete.source_template.replace(
        "            _path_files -f", "            compset -P 1 '--*='\n            _path_files -f"
    )

    def get_completions(self, args: list[str], incomplete: str) -> list[CompletionItem]:
        """Returns what zsh can offer, each as a whole word."""
        found = super().get_completions(args, incomplete)
        option, equals, _ = incomplete.partition("=")
        if equals and option.startswith("--"):
            for item in found:
                item.value = option + equals + item.value
        return found


class Fish(FishComplete):
    """Fish, which takes only what begins as the word does, so the option goes before each value."""

    source_template = (
        FishComplete.source_template.replace(
            "    for completion",
            "    set -l option (string match -r -- '^--[^=]+=' (commandline -ct));\n"
            "    for completion",
            1,
        )
        .replace("echo $metadata[2]", 'echo "$option$metadata[2]"')
        .replace(
            "__fish_complete_path $metadata[2]",
            'printf "$option%%s\\n" (__fish_complete_path $metadata[2])',
        )
    )


def _quote(name: str) -> str:
    """Returns a name as it is typed; of two backslashes click's script takes one away."""
    return re.sub(r"[^\w@%+=:,./~-]", r"\\\\\g<0>", name)
