"""Boots the image under QEMU; it runs ``start`` from a shared folder and powers off."""

import subprocess
import sysconfig
import time
from collections.abc import Callable
from pathlib import Path

from tests.kernel.machine import has_virtualisation
from tests.system.image import KERNEL, RAMDISK, ROOT

_CLOCK = ("-icount", "shift=0")
"""Emulation is many times slower than the machine. So the guest's clock counts instructions, a
thousand million a second: in there it is a real, slow processor, and 100 ms are 100 ms of it."""

_PROCESSOR = "Nehalem"
"""Without AVX2: QEMU 7.2 gathers from wrong addresses where the index is in ymm4, so that NumPy's
``argsort`` gives a wrong order or a general protection fault. And without ``erms``, with which the
kernel copies one byte at a time, which QEMU would repeat."""

_EMULATED = ("-accel", "tcg", "-cpu", _PROCESSOR, *_CLOCK)
_VIRTUAL = ("-accel", "kvm", "-cpu", "host")

_KVM_PATIENCE_S = 60.0
"""With working hardware virtualisation the guest's program starts within some seconds."""

_START = """\
touch /mnt/results/booted
modprobe -a 9p vhci-hcd evdev joydev
for share in checkout:{root} packages:/mnt/packages; do
    mkdir -p ${{share#*:}}
    mount -t 9p -o trans=virtio,ro,msize=262144,cache=loose ${{share%:*}} ${{share#*:}} || exit 1
done
cd {root}
export PYTHONPATH=/mnt/packages:{root}/devtools PYTHONDONTWRITEBYTECODE=1
export NUMBA_CPU_NAME=generic NUMBA_CACHE_DIR=/mnt/results/compiled
python3 -m {program} /mnt/results
journalctl --boot --no-pager > /mnt/results/journal.txt
"""


def boot(
    image: Path,
    results: Path,
    *,
    time_limit_s: float,
    program: str = "tests.system.guest",
    keeps_changes: bool = False,
    port: Path | None = None,
    is_over: Callable[[], bool] = lambda: False,
) -> None:
    """Boots, runs the guest's program, powers off.

    Args:
        image: the disk.
        results: a folder that the guest can write; the console goes there too.
        time_limit_s: after this time the machine is switched off.
        program: the module that the guest runs.
        keeps_changes: the guest writes to the image, which otherwise stays as it is.
        port: a socket that becomes a USB port of the machine, for ``UsbRedir``.
        is_over: looked at often; when it says True, the power is cut.
    """
    (results / "start").write_text(_START.format(root=ROOT, program=program))
    booted = results / "booted"
    booted.unlink(missing_ok=True)  # of the boot before
    disk = f"file={image},format=raw,if=virtio,cache=unsafe"
    if not keeps_changes:
        disk += ",snapshot=on"
    parts = ("-drive", disk)
    if port is not None:
        socket = f"socket,id=port,path={port},server=on,wait=off"
        parts += ("-device", "qemu-xhci", "-chardev", socket, "-device", "usb-redir,chardev=port")
    if has_virtualisation():
        # Where nested virtualisation is broken, QEMU ends at once or hangs.
        _run((*_VIRTUAL, *parts), results, (_KVM_PATIENCE_S, time_limit_s), is_over)
    if not booted.exists():
        _run((*_EMULATED, *parts), results, (time_limit_s, time_limit_s), is_over)


def _run(
    parts: tuple[str, ...],
    results: Path,
    limits_s: tuple[float, float],
    is_over: Callable[[], bool],
) -> None:
    """Runs the machine until it powers off, or until a limit.

    Args:
        parts: who carries out its instructions, its disk and its USB port.
        results: the folder that the guest can write.
        limits_s: until it has booted, and until it has powered off.
        is_over: see ``boot``.
    """
    patience_s, time_limit_s = limits_s
    command = [
        *("qemu-system-x86_64", *parts),
        *("-smp", "1", "-m", "3G", "-no-reboot", "-display", "none", "-vga", "std"),
        *("-nic", "none", "-kernel", str(KERNEL), "-initrd", str(RAMDISK)),
        *("-append", "root=/dev/vda rw console=tty1 console=ttyS0 quiet mitigations=off"),
        *("-serial", f"file:{results / 'console.txt'}", "-monitor", "none"),
        *_share("results", results, "security_model=none"),
        *_share("checkout", ROOT, "security_model=none,readonly=on"),
        *_share("packages", Path(sysconfig.get_path("purelib")), "security_model=none,readonly=on"),
    ]
    process = subprocess.Popen(command, stdin=subprocess.DEVNULL)
    begun = time.monotonic()
    try:
        while process.poll() is None:
            limit_s = time_limit_s if (results / "booted").exists() else patience_s
            if time.monotonic() - begun > limit_s:
                break  # what is missing shows in the results
            if is_over():
                break
            time.sleep(0.05)
    finally:
        process.kill()
        process.wait()


def _share(tag: str, folder: Path, options: str) -> tuple[str, str]:
    return ("-virtfs", f"local,path={folder},mount_tag={tag},multidevs=remap,{options}")
