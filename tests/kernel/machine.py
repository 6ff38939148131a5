"""A Debian kernel under QEMU that sees this machine's files and runs one program on them."""

import fcntl
import os
import select
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import IO

ROOT = Path(__file__).parents[2]
CACHE = ROOT / ".cache/kernel"
COMPILED = CACHE / "numba"
"""Compiled kernels; the guest may write there, for Numba does not read what it cannot write."""

PACKAGES = {
    "apt-get": "apt",
    "busybox": "busybox-static",
    "depmod": "kmod",
    "dpkg": "dpkg",
    "ip": "iproute2",
    "qemu-system-x86_64": "qemu-system-x86",
    "udevadm": "udev",
    "v4l2-ctl": "v4l-utils",
}
"""The programs that are needed here or in the guest, and the Debian packages that hold them."""

KVM_PATIENCE_S = 30.0
"""With working hardware virtualisation the guest answers within a few seconds."""

_MODULES = Path("/sys/module")

_EMULATED = ("--disable-kvm", "--qemu-opts=-cpu Nehalem")
"""QEMU 7.2 carries out AVX2 wrongly, see ``tests/system/machine.py``."""

_NICENESS = -5
"""A guest plays in time; other tests can wait."""

_KERNEL_OPTIONS = "mitigations=off norandmaps"
"""Without hardware virtualisation it is dear to change address spaces; and QEMU translates a
library once where all programs have it at the same address."""

_PROGRAMS = Path(__file__).with_name("bin")
"""Come before programs of the same name."""

CAMERA_TESTS = ("test_camera", "test_davis")
"""The files whose chapters are played by a machine of their own, beside that of the others."""


class MissingError(Exception):
    """This machine cannot boot the kernel; the message says what is missing."""


def choose_machine(test_file: str) -> str:
    """Which of the machines plays the chapters that a file of tests asks about."""
    if test_file.startswith(("test_processor", "test_video", "test_uvc", "test_eye")):
        return "processors"
    return "cameras" if test_file.startswith(CAMERA_TESTS) else "pads"


def has_virtualisation() -> bool:
    """True if the processor itself can run a guest. Some KVMs can do without, but not with Debian's
    kernel: the guest would hang, busy."""
    knows = any((_MODULES / name).exists() for name in ("kvm_intel", "kvm_amd"))
    return knows and os.access("/dev/kvm", os.R_OK | os.W_OK)


def require_packages() -> None:
    """Check that everything needed is installed.

    Raises:
        MissingError: names the packages.
    """
    path = f"{os.environ['PATH']}:/usr/sbin:/sbin"
    missing = [name for program, name in PACKAGES.items() if not shutil.which(program, path=path)]
    if missing:
        raise MissingError(f"these Debian packages are missing: {' '.join(missing)}")
    if not _vng().exists():
        raise MissingError("virtme-ng is missing: pip install --group dev")


def fetch_kernel() -> Path:
    """Return Debian's kernel image, its modules beside it; downloaded and unpacked once.

    Raises:
        MissingError: the package cannot be had.
    """
    CACHE.mkdir(parents=True, exist_ok=True)
    with (CACHE / "lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)  # two processes of tests may ask at once
        cached = sorted(CACHE.glob("linux-image-*/boot/vmlinuz-*"))
        return cached[-1] if cached else _download_kernel()


def _download_kernel() -> Path:
    listed = _output("apt-cache", "depends", "linux-image-amd64")
    names = [line.split()[-1] for line in listed.splitlines() if "Depends: linux-image-" in line]
    if not names:
        raise MissingError("apt knows no linux-image-amd64: run apt-get update (on Debian)")
    unpacked = CACHE / f"unpacking-{os.getpid()}"
    unpacked.mkdir(parents=True)
    try:
        _output("apt-get", "download", names[0], cwd=unpacked)
        for package in unpacked.glob("*.deb"):
            _output("dpkg", "-x", str(package), str(unpacked))
            package.unlink()
        version = next((unpacked / "lib/modules").iterdir()).name
        _output("/sbin/depmod", "-b", str(unpacked), version)
        kernel = CACHE / names[0] / "boot" / f"vmlinuz-{version}"
        unpacked.rename(CACHE / names[0])
    except subprocess.CalledProcessError as error:
        raise MissingError(f"{error.cmd[0]} failed: {error.stderr.strip()}") from error
    finally:
        shutil.rmtree(unpacked, ignore_errors=True)
    return kernel


@contextmanager
def take_turn() -> Iterator[None]:
    """Waits until fewer guests run than there are processors; a guest that starves fails."""
    with ExitStack() as files:
        places = [
            files.enter_context((CACHE / f"guest-{k}").open("w"))
            for k in range(os.cpu_count() or 1)
        ]
        while not any(map(_lock, places)):
            time.sleep(0.5)
        yield


def _lock(place: IO[str]) -> bool:
    try:
        fcntl.flock(place, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    return True


def boot(
    kernel: Path,
    program: list[str],
    results: Path,
    *,
    time_limit_s: float,
    n_processors: int = 1,
    disk: Path | None = None,
    is_over: Callable[[], bool] = lambda: False,
) -> str:
    """Boot, run the program as root, power off; return what the console showed.

    Args:
        kernel: the image.
        program: the command. It must first make a file called ``booted`` in ``results``.
        results: a folder that the guest can write; all but this and COMPILED is read-only there.
        time_limit_s: after this time the machine is switched off.
        n_processors: how many the machine has.
        disk: the image of a disk that the guest may write.
        is_over: looked at often; when it says True, the power is cut.
    """
    command = [
        str(_vng()),
        "--verbose",
        "--force-9p",
        "--disable-microvm",
        f"--rwdir={results}",
        f"--rwdir={COMPILED}",
        *("--run", str(kernel)),
        *("--user", "root"),
        *("--cpus", str(n_processors)),
        *("--memory", "2G"),
        *("--append", _KERNEL_OPTIONS),
        *(() if disk is None else ("--disk", str(disk))),
    ]
    COMPILED.mkdir(parents=True, exist_ok=True)
    booted = results / "booted"
    booted.unlink(missing_ok=True)  # of the boot before
    if has_virtualisation():
        # Where nested virtualisation is broken, QEMU ends at once or hangs.
        console = _run([*command, "--", *program], booted, (KVM_PATIENCE_S, time_limit_s), is_over)
        if booted.exists():
            return console
    limits_s = (time_limit_s, time_limit_s)
    return _run([*command, *_EMULATED, "--", *program], booted, limits_s, is_over)


def _run(
    command: list[str],
    booted: Path,
    limits_s: tuple[float, float],
    is_over: Callable[[], bool],
) -> str:
    """Run the command on a terminal of its own, which vng asks for; return what it printed.

    Args:
        command: vng and its arguments.
        booted: the file that the guest makes.
        limits_s: until it has made it, and until it has ended.
        is_over: see ``boot``.
    """
    patience_s, time_limit_s = limits_s
    terminal, inside = os.openpty()
    # vng starts helpers by name.
    path = f"{_PROGRAMS}:{_vng().parent}:{os.environ['PATH']}:/usr/sbin:/sbin"
    process = subprocess.Popen(
        command,
        cwd=ROOT,
        env={**os.environ, "PATH": path},
        stdin=inside,
        stdout=inside,
        stderr=inside,
        start_new_session=True,
    )
    os.close(inside)
    with suppress(OSError):  # only root may; and Linux need not group processes by session
        os.setpriority(os.PRIO_PGRP, process.pid, _NICENESS)
        Path(f"/proc/{process.pid}/autogroup").write_text(str(_NICENESS))
    begun = time.monotonic()
    printed = bytearray()
    try:
        while time.monotonic() - begun < (time_limit_s if booted.exists() else patience_s):
            if is_over():
                break
            if not select.select([terminal], [], [], 0.1)[0]:
                continue
            try:
                printed += os.read(terminal, 1 << 16)
            except OSError:  # everybody at the other end has gone
                break
    finally:
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)
        process.wait()
        os.close(terminal)
    return printed.decode(errors="replace")


def _vng() -> Path:
    return Path(sys.executable).with_name("vng")


def _output(*command: str, cwd: Path = ROOT) -> str:
    done = subprocess.run(command, cwd=cwd, check=True, capture_output=True, text=True)
    return done.stdout
