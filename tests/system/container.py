"""Boots the folder in a container, at full speed; it runs ``start`` and powers off.

The container shares the kernel of this machine, so it has no camera, no ``/dev/uinput`` and no
udev. systemd, logind and dpkg work as in a machine of its own.
"""

import contextlib
import os
import subprocess
import sysconfig
import time
from pathlib import Path

from tests.system.image import ROOT, SIZE

_START = """\
touch /mnt/results/booted
cd {root}
export PYTHONPATH=/mnt/packages:{root}/devtools PYTHONDONTWRITEBYTECODE=1
export NUMBA_CACHE_DIR=/mnt/results/compiled
python3 -m tests.system.guest /mnt/results
journalctl --boot --no-pager > /mnt/results/journal.txt
"""

_APART = (
    *("setpriv", "--pdeathsig=KILL"),
    *("unshare", "--fork", "--kill-child", "--pid", "--mount", "--mount-proc"),
)
"""Processes and mounts of their own, which end with this program, whatever ends it."""

_ENTER = f"""\
set -e
for group do echo 0 > "$group/cgroup.procs"; done
mount -t tmpfs -o size={SIZE} tmpfs /run
mkdir /run/changes /run/work /run/root
mount -t overlay -o "lowerdir=$LOWER,upperdir=/run/changes,workdir=/run/work" overlay /run/root
exec systemd-nspawn --quiet --keep-unit --register=no --settings=no --private-network \
    --link-journal=no --resolv-conf=off --timezone=off --console=pipe --directory=/run/root \
    --bind="$RESULTS:/mnt/results" --bind-ro="$CHECKOUT" --bind-ro="$PACKAGES:/mnt/packages" --boot
"""
"""Changes go to memory."""

_GROUPS = [Path("/sys/fs/cgroup", kind) for kind in ("", "systemd", "unified")]
"""Where systemd keeps control groups: in one hierarchy, or with cgroups of version 1 in two."""

_PATIENCE_S = 20.0


def boot(folder: Path, results: Path, *, time_limit_s: float) -> None:
    """Boots, runs the guest's program, powers off; the folder stays as it is.

    Args:
        folder: the root of the system.
        results: a folder that the guest can write; the console goes there too.
        time_limit_s: after this time the container is ended.
    """
    (results / "start").write_text(_START.format(root=ROOT))
    environment = {
        **os.environ,
        "LOWER": str(folder),
        "RESULTS": str(results),
        "CHECKOUT": str(ROOT),
        "PACKAGES": sysconfig.get_path("purelib"),
    }
    groups = [
        group / f"neurotouch-system-test-{os.getpid()}"
        for group in _GROUPS
        if (group / "cgroup.procs").exists()
    ]
    command = [*_APART, "sh", "-c", _ENTER, "enter", *map(str, groups)]
    try:
        for group in groups:
            group.mkdir()
        _run(command, environment, results / "console.txt", time_limit_s)
    finally:
        for group in groups:
            _remove(group)


def _run(
    command: list[str], environment: dict[str, str], console: Path, time_limit_s: float
) -> None:
    """Runs a command to its end or until a limit; what is missing shows in the results."""
    with console.open("w") as output:
        # In a session of its own: Ctrl-C reaches only this program, which ends the container.
        process = subprocess.Popen(
            command,
            stdin=subprocess.DEVNULL,
            stdout=output,
            stderr=subprocess.STDOUT,
            env=environment,
            start_new_session=True,
        )
    try:
        with contextlib.suppress(subprocess.TimeoutExpired):
            process.wait(time_limit_s)
    finally:
        process.kill()
        process.wait()


def _remove(group: Path) -> None:
    """Removes a control group with all that are in it, once its processes have ended."""
    deadline_s = time.monotonic() + _PATIENCE_S
    while group.exists():
        for folder, _, _ in os.walk(group, topdown=False):
            with contextlib.suppress(OSError):
                Path(folder).rmdir()
        if time.monotonic() > deadline_s:
            raise TimeoutError(f"processes of the container are still in {group}")
        time.sleep(0.05)
