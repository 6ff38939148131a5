"""The table of ``make room``: one row for each condition, two figures where there are two seeds."""

from collections.abc import Mapping, Sequence
from typing import Any

from tests.room.matrix import Condition

HEAD = (
    "| nuisance | gel found after s | tracked: median, 5 % | gestures right | type % | count % "
    "| distance mm | intensity mm | rest F1 | false gestures | at the end "
    "| what the software says |"
)


def format_table(
    conditions: Sequence[Condition], results: Mapping[str, Sequence[dict[str, Any]]]
) -> str:
    """Returns the table in Markdown, chapter by chapter.

    Type and count are followed by what the labels allow at best, see ``find_bound``.

    Args:
        conditions: the rows; those without results are left out.
        results: of each condition by its name, one for each seed.
    """
    lines, chapter = [HEAD, "| --- " * 12 + "|"], ""
    for condition in conditions:
        found = results.get(condition.name)
        if not found:
            continue
        if condition.chapter != chapter:
            chapter = condition.chapter
            lines.append(f"| **{chapter}** |" + " |" * 11)
        lines.append(f"| `{condition.name}` | " + " | ".join(_cells(found)) + " |")
    return "\n".join(lines)


def _cells(found: Sequence[dict[str, Any]]) -> list[str]:
    says = list(dict.fromkeys(sentence for each in found for sentence in each["says"]))
    return [
        _join("never" if each["found_s"] is None else f"{each['found_s']:.2f}" for each in found),
        _join(f"{each['tracked']}, {each['tracked_5']}" for each in found),
        _join(f"{each['right']} of {each['gestures']}" for each in found),
        *(_join(_show_share(each, name) for each in found) for name in ("type", "count")),
        _join(_show(each["distance_mm"], 1, 2) for each in found),
        _join(_show(each["intensity_mm"], 1, 2) for each in found),
        _join(_show(each["rest_f1"], 1, 3) for each in found),
        _join(str(each["false_gestures"]) for each in found),
        _join(each["end"] for each in found),
        "; ".join(says) or "all OK",
    ]


def _join(texts: Any) -> str:
    texts = list(texts)
    return texts[0] if len(set(texts)) == 1 else " / ".join(texts)


def _show_share(found: Mapping[str, Any], name: str) -> str:
    return f"{_show(found[name], 100, 1)} of {_show(found[f'{name}_bound'], 100, 1)}"


def _show(value: float | None, times: float, digits: int) -> str:
    return "–" if value is None else f"{times * value:.{digits}f}"
