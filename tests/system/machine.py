"""Boots the image under QEMU; it runs ``start`` from a shared folder and powers off."""

import os
import subprocess
import sysconfig
import time
from pathlib import Path

from tests.system.image import KERNEL, RAMDISK, ROOT

_CLOCK = ("-icount", "shift=0")
"""Emulation is many times slower than the machine. So the guest's clock counts instructions, a
thousand million a second: in there it is a real, slow processor, and 100 ms are 100 ms of it."""

_PROCESSOR = "max,-erms,-fsrm"
"""Without them the kernel copies eight bytes at a time instead of one, which QEMU would repeat."""

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
python3 -m tests.system.guest /mnt/results
journalctl --boot --no-pager > /mnt/results/journal.txt
"""


def boot(image: Path, results: Path, *, time_limit_s: float) -> None:
    """Boots, runs the guest's program, powers off; the image stays as it is.

    Args:
        image: the disk.
        results: a folder that the guest can write; the console goes there too.
        time_limit_s: after this time the machine is switched off.
    """
    (results / "start").write_text(_START.format(root=ROOT))
    booted = results / "booted"
    if os.access("/dev/kvm", os.R_OK | os.W_OK):
        # Where nested virtualisation is broken, QEMU ends at once or hangs.
        _run(_VIRTUAL, image, results, _KVM_PATIENCE_S, time_limit_s)
    if not booted.exists():
        _run(_EMULATED, image, results, time_limit_s, time_limit_s)


def _run(
    processor: tuple[str, ...], image: Path, results: Path, patience_s: float, time_limit_s: float
) -> None:
    """Runs the machine until it powers off, or until a limit.

    Args:
        processor: who carries out its instructions.
        image: the disk.
        results: the folder that the guest can write.
        patience_s: until it has booted.
        time_limit_s: until it has powered off.
    """
    command = [
        *("qemu-system-x86_64", *processor),
        *("-smp", "1", "-m", "3G", "-no-reboot", "-display", "none", "-vga", "std"),
        *("-nic", "none", "-kernel", str(KERNEL), "-initrd", str(RAMDISK)),
        *("-append", "root=/dev/vda rw console=tty1 console=ttyS0 quiet mitigations=off"),
        *("-serial", f"file:{results / 'console.txt'}", "-monitor", "none"),
        *("-drive", f"file={image},format=raw,if=virtio,snapshot=on,cache=unsafe"),
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
            time.sleep(0.5)
    finally:
        process.kill()
        process.wait()


def _share(tag: str, folder: Path, options: str) -> tuple[str, str]:
    return ("-virtfs", f"local,path={folder},mount_tag={tag},multidevs=remap,{options}")
