"""A fresh Debian, made once and kept: a disk image for QEMU, or a folder for a container.

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
CONTAINER = CACHE / "container"
"""The same without a kernel, as a container needs none."""
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
CONTAINER_PACKAGES = {"mmdebstrap": "mmdebstrap", "systemd-nspawn": "systemd-container"}
"""The same for a container."""

_INSTALLED = (
    "apt",
    "dbus",
    "kmod",
    "libpam-systemd",
    "login",
    "passwd",
    "python3",
    "systemd-sysv",
    "udev",
)
_KERNEL_INSTALLED = ("initramfs-tools", "linux-image-amd64")
_AT_HAND = ("acl", "libusb-1.0-0", "python3")
"""What our package may pull in: not installed, but in apt's cache, for the guest has no network."""

_KERNEL_HOOKS = {
    # A ramdisk with three drivers starts in half the time of one with all of them.
    "essential": (
        'mkdir -p "$1/etc/initramfs-tools/conf.d" "$1/usr/share/initramfs-tools/modules.d"',
        'echo MODULES=list > "$1/etc/initramfs-tools/conf.d/small"',
        r'printf "virtio_pci\nvirtio_blk\next4\n"'
        ' > "$1/usr/share/initramfs-tools/modules.d/system-test"',
    ),
    "customize": (
        r'printf "/dev/vda / ext4 defaults\nresults /mnt/results 9p trans=virtio,msize=262144\n"'
        ' > "$1/etc/fstab"',
        f'cp -L "$1/vmlinuz" {KERNEL} && cp -L "$1/initrd.img" {RAMDISK}',
    ),
}
_HOOKS = {
    "customize": (
        f'chroot "$1" useradd --create-home --shell /bin/bash {PLAYER}',
        f'chroot "$1" passwd --delete {PLAYER}',
        # Somebody sits at the machine: logged in at the first console of seat0.
        'mkdir -p "$1/etc/systemd/system/getty@tty1.service.d"',
        r'printf "[Service]\nExecStart=\nExecStart=-/sbin/agetty --autologin '
        rf'{PLAYER} --noclear %%I linux\n"'
        ' > "$1/etc/systemd/system/getty@tty1.service.d/autologin.conf"',
        'mkdir "$1/mnt/results"',
        r'printf "[Service]\nExecStart=sh /mnt/results/start\nExecStopPost=systemctl poweroff\n'
        r"StandardOutput=file:/mnt/results/output.txt\nStandardError=inherit\n"
        r"[Unit]\nAfter=getty@tty1.service\nRequiresMountsFor=/mnt/results\n"
        r'[Install]\nWantedBy=multi-user.target\n"'
        ' > "$1/etc/systemd/system/system-test.service"',
        'chroot "$1" systemctl enable system-test.service',
        'echo neurotouch-test > "$1/etc/hostname"',
        f'chroot "$1" apt-get clean && chroot "$1" apt-get install -y --download-only '
        f"{' '.join(_AT_HAND)}",
    ),
}


def find_missing(packages: dict[str, str]) -> list[str]:
    """The Debian packages that this machine lacks."""
    return [name for program, name in packages.items() if not shutil.which(program)]


def make_image() -> Path:
    """The disk image; made at the first call, which takes some minutes and needs root.

    Raises:
        subprocess.CalledProcessError: Debian cannot be had; its output says why.
    """
    if IMAGE.exists():
        return IMAGE
    CACHE.mkdir(parents=True, exist_ok=True)
    unfinished = IMAGE.with_suffix(".unfinished")
    _make_folder(ROOT_FOLDER, (*_INSTALLED, *_KERNEL_INSTALLED), _HOOKS, _KERNEL_HOOKS)
    # No journal: the disk is thrown away, and each of dpkg's many flushes would write one.
    format_ = ("mke2fs", "-q", "-t", "ext4", "-O", "^has_journal")
    _run(*format_, "-d", str(ROOT_FOLDER), str(unfinished), SIZE)
    unfinished.rename(IMAGE)
    return IMAGE


def make_container() -> Path:
    """The folder for a container; made at the first call, which takes a minute and needs root.

    Raises:
        subprocess.CalledProcessError: Debian cannot be had; its output says why.
    """
    if not CONTAINER.exists():
        CACHE.mkdir(parents=True, exist_ok=True)
        unfinished = CONTAINER.with_suffix(".unfinished")
        _make_folder(unfinished, _INSTALLED, _HOOKS)
        unfinished.rename(CONTAINER)
    return CONTAINER


def _make_folder(
    folder: Path, packages: tuple[str, ...], *hooks: dict[str, tuple[str, ...]]
) -> None:
    """Installs Debian into a folder, in place of what is there.

    Args:
        folder: the root of the new system.
        packages: what is installed beside the essential packages.
        hooks: by mmdebstrap's name of the moment, what a shell does then.
    """
    shutil.rmtree(folder, ignore_errors=True)
    lines = [
        f"--{when}-hook={line}" for each in hooks for when, those in each.items() for line in those
    ]
    keep = ["--skip=cleanup/apt/lists", "--skip=cleanup/apt/cache"]
    include = f"--include={','.join(packages)}"
    release = RELEASE["VERSION_CODENAME"]
    _run("mmdebstrap", "--variant=apt", include, *keep, *lines, release, str(folder))


def _run(*command: str) -> None:
    subprocess.run(command, cwd=ROOT, check=True, stdin=subprocess.DEVNULL, stdout=sys.stderr)


if __name__ == "__main__":
    print(make_image())
