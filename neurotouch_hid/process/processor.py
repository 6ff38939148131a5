"""Tells processors apart by their abilities, as Linux names them in ``/sys``.

``/proc/cpuinfo`` names them as well, but a service with ``ProcSubset=pid`` does not see that file.
"""

import re
from pathlib import Path
from typing import Final

_ABILITIES: Final = Path("/sys/devices/system/cpu/modalias")

_V2: Final = {0x080, 0x089, 0x08D, 0x093, 0x094, 0x097, 0x0C0}
"""SSE3, SSSE3, CMPXCHG16B, SSE4.1, SSE4.2, POPCNT, LAHF; numbers of Linux' ``cpufeatures.h``."""
_V3: Final = _V2 | {0x08C, 0x096, 0x09A, 0x09C, 0x09D, 0x0C5, 0x123, 0x125, 0x128}
"""These, and FMA, MOVBE, XSAVE, AVX, F16C, LZCNT, BMI1, AVX2, BMI2."""
_LEVELS: Final = {"x86-64-v3": _V3, "x86-64-v2": _V2}


def read_abilities() -> str:
    """Returns model and abilities of the processor; empty if Linux does not tell them."""
    try:
        return _ABILITIES.read_text(encoding="ascii")
    except OSError:
        return ""


def find_levels(abilities: str) -> list[str]:
    """Returns which levels of x86-64 a processor has, the highest first; LLVM knows these names.

    Source: System V Application Binary Interface, AMD64 supplement, micro-architecture levels.

    Args:
        abilities: what ``read_abilities`` has returned.
    """
    kind, _, numbers = abilities.partition(":feature:")
    if not kind.startswith("cpu:type:x86,"):
        return []
    found = {int(number, 16) for number in re.findall(r"[0-9A-F]+", numbers)}
    return [level for level, needed in _LEVELS.items() if needed <= found]
