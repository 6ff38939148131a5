"""A fresh Debian as a disk image, made once and kept: what a player's machine has.

It is the same release as this machine, for which the package is built, too.
"""

import platform
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]
RELEASE = platform.freedesktop_os_release()
CACHE = ROOT / ".cache/system" / f"{RELEASE['ID']}-{RELEASE.get('VERSION_ID', 'testing')}"
IMAGE = CACHE / "disk.img"
ROOT_FOLDER = CACHE / "rootfs"
"""The same as a folder."""
KERNEL, RAMDISK = CACHE / "vmlinuz", CACHE / "initrd.img"

SIZE = "4G"
"""Sparse; Debian takes 0.6 GB of it, the package 0.6 GB, an upgrade of it once more."""

PLAYER = "player"
"""The ordinary user who sits at the machine."""

PACKAGES = {
    "mmdebstrap": "mmdebstrap",
    "mke2fs": "e2fsprogs",
    "qemu-system-x86_64": "qemu-system-x86",
}
"""The programs needed here, and the Debian packages that hold them."""

_INSTALLED = (
    "apt",
    "dbus",
    "initramfs-tools",
    "kmod",
    "libpam-systemd",
    "linux-image-amd64",
    "login",
    "passwd",
    "python3",
    "systemd-sysv",
    "udev",
)
_AT_HAND = ("acl", "libusb-1.0-0", "python3")
"""What our package may pull in: not installed, but in apt's cache, for the guest has no network."""

_HOOKS = {
    # A ramdisk with three drivers starts in half the time of one with all of them.
    "essential": (
        'mkdir -p "$1/etc/initramfs-tools/conf.d" "$1/usr/share/initramfs-tools/modules.d"',
        'echo MODULES=list > "$1/etc/initramfs-tools/conf.d/small"',
        r'printf "virtio_pci\nvirtio_blk\next4\n"'
        ' > "$1/usr/share/initramfs-tools/modules.d/system-test"',
    ),
    "customize": (
        f'chroot "$1" useradd --create-home --shell /bin/bash {PLAYER}',
        f'chroot "$1" passwd --delete {PLAYER}',
        # Somebody sits at the machine: logged in at the first console of seat0.
        'mkdir -p "$1/etc/systemd/system/getty@tty1.service.d"',
        r'printf "[Service]\nExecStart=\nExecStart=-/sbin/agetty --autologin '
        rf'{PLAYER} --noclear %%I linux\n"'
        ' > "$1/etc/systemd/system/getty@tty1.service.d/autologin.conf"',
        'mkdir "$1/mnt/results"',
        r'printf "/dev/vda / ext4 defaults\nresults /mnt/results 9p trans=virtio,msize=262144\n"'
        ' > "$1/etc/fstab"',
        r'printf "[Service]\nExecStart=sh /mnt/results/start\nExecStopPost=systemctl poweroff\n'
        r"StandardOutput=file:/mnt/results/output.txt\nStandardError=inherit\n"
        r"[Unit]\nAfter=getty@tty1.service\nRequiresMountsFor=/mnt/results\n"
        r'[Install]\nWantedBy=multi-user.target\n"'
        ' > "$1/etc/systemd/system/system-test.service"',
        'chroot "$1" systemctl enable system-test.service',
        'echo neurotouch-test > "$1/etc/hostname"',
        f'chroot "$1" apt-get clean && chroot "$1" apt-get install -y --download-only '
        f"{' '.join(_AT_HAND)}",
        f'cp -L "$1/vmlinuz" {KERNEL} && cp -L "$1/initrd.img" {RAMDISK}',
    ),
}


def find_missing() -> list[str]:
    """The Debian packages that this machine lacks."""
    return [name for program, name in PACKAGES.items() if not shutil.which(program)]


def make_image() -> Path:
    """The disk image; made at the first call, which takes some minutes and needs root.

    Raises:
        subprocess.CalledProcessError: Debian cannot be had; its output says why.
    """
    if IMAGE.exists():
        return IMAGE
    CACHE.mkdir(parents=True, exist_ok=True)
    unfinished = IMAGE.with_suffix(".unfinished")
    shutil.rmtree(ROOT_FOLDER, ignore_errors=True)
    hooks = [f"--{when}-hook={line}" for when, lines in _HOOKS.items() for line in lines]
    keep = ["--skip=cleanup/apt/lists", "--skip=cleanup/apt/cache"]
    include = f"--include={','.join(_INSTALLED)}"
    release = RELEASE["VERSION_CODENAME"]
    _run("mmdebstrap", "--variant=apt", include, *keep, *hooks, release, str(ROOT_FOLDER))
    # No journal: the disk is thrown away, and each of dpkg's many flushes would write one.
    format_ = ("mke2fs", "-q", "-t", "ext4", "-O", "^has_journal")
    _run(*format_, "-d", str(ROOT_FOLDER), str(unfinished), SIZE)
    unfinished.rename(IMAGE)
    return IMAGE


def _run(*command: str) -> None:
    subprocess.run(command, cwd=ROOT, check=True, stdin=subprocess.DEVNULL, stdout=sys.stderr)


if __name__ == "__main__":
    print(make_image())
