"""Checks whether the program is complete, and whether the machine is fast enough."""

import importlib.metadata
import os
import struct
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING, Final

from neurotouch_hid.doctor.finding import Finding, approve, fail, warn

if TYPE_CHECKING:
    from neurotouch_hid.messages import Step

_DISTRIBUTION: Final = "neurotouch-hid"
_LEAST_SPEED: Final = 2.0
"""Speed in multiples of real time: below it, a busy moment makes the pad late."""

_SLICE_US: Final = 10_000
_PERIOD_S: Final = _SLICE_US / 1e6
_TICKS: Final = 200
_LATE_S: Final = 0.005
"""Half a slice: with a longer delay the pad is a slice behind."""

_GOVERNOR: Final = Path("/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor")
_RTKIT: Final = Path("/usr/share/dbus-1/system-services/org.freedesktop.RealtimeKit1.service")


def check_python() -> Finding:
    """Checks Python and every package that the program needs."""
    version = ".".join(map(str, sys.version_info[:3]))
    bits = struct.calcsize("P") * 8
    if sys.version_info < (3, 11) or bits != 64:
        return fail(f"Python {version}, {bits} bit.", "Use 64-bit Python 3.11 or newer.")
    missing = _find_missing()
    if missing:
        return fail(
            f"Python {version}, 64 bit; but not everything is installed: {', '.join(missing)}.",
            "Install it again: pip install --force-reinstall neurotouch-hid",
        )
    return approve(f"Python {version}, 64 bit; everything it needs is installed.")


def _find_missing() -> list[str]:
    from packaging.requirements import Requirement

    from neurotouch_hid.resources import find_resources

    missing = [
        f"the folder {find_resources(kind)}"
        for kind in ("profiles", "udev", "modules-load.d")
        if not any(find_resources(kind).glob("*"))
    ]
    try:
        needed = importlib.metadata.requires(_DISTRIBUTION) or []
    except importlib.metadata.PackageNotFoundError:
        return missing  # run from a checkout that was not installed
    for requirement in map(Requirement, needed):
        if requirement.marker and not requirement.marker.evaluate({"extra": ""}):
            continue  # of another machine, another Python, or an extra
        try:
            importlib.metadata.version(requirement.name)
        except importlib.metadata.PackageNotFoundError:
            missing.append(requirement.name)
    return missing


def check_pipeline() -> Finding:
    """Plays a simulated push through the whole pipeline, as fast as it goes."""
    from neurotouch_hid.driver import REFERENCE, Driver
    from neurotouch_hid.evaluation.speed.workload import DenseSource, load_scene

    moved = False

    def watch(step: "Step") -> None:
        nonlocal moved
        moved = moved or bool(step.pad.axes)

    scene = load_scene("push", _SLICE_US)  # made beforehand, so that making it is not measured
    seconds = len(scene.packets) * _SLICE_US / 1e6
    with Driver(REFERENCE, make_source=lambda: DenseSource(scene, seconds)) as driver:
        stats = driver.run([watch])
    if not moved:
        return fail("A simulated push did not move the pad.", "Report this as a bug.")
    speed, cores = stats.sensor_s / stats.host_s, len(os.sched_getaffinity(0))
    sentence = (
        f"A simulated push moves the pad; this machine computes {speed:.0f} seconds of play in "
        f"one, with {cores} processor{'s' if cores > 1 else ''}."
    )
    if speed < _LEAST_SPEED:
        return warn(
            sentence,
            "Close other programs, use a faster machine, or the lighter method: --method paper",
        )
    if cores < 2:
        return warn(sentence, "With one processor the game slows the gel down. Use two.")
    return approve(sentence)


def check_timer() -> Finding:
    """Checks how late the system wakes this process for a slice."""
    late_s = []
    due = time.monotonic()
    for _ in range(_TICKS):
        due += _PERIOD_S
        time.sleep(max(due - time.monotonic(), 0.0))
        late_s.append(time.monotonic() - due)
    p99_s = sorted(late_s)[int(0.99 * _TICKS)]
    governor = _GOVERNOR.read_text().strip() if _GOVERNOR.exists() else "unknown"
    kit = "there" if _RTKIT.exists() else "not available (and not needed)"
    sentence = (
        f"Of {_TICKS} slices of 10 ms, 99 % come at most {p99_s * 1e3:.1f} ms late; governor "
        f"{governor}, real-time kit {kit}."
    )
    if p99_s > _LATE_S:
        fix = "Close other programs"
        if governor == "powersave":
            fix += ", or choose the power profile 'performance' or 'balanced'"
        return warn(sentence, f"{fix}.")
    return approve(sentence)
