"""Opens a device node of the kernel; if that fails, the error names the likely reason."""

import errno
import os
from dataclasses import dataclass
from pathlib import Path

from neurotouch_hid.errors import DeviceError


@dataclass(frozen=True, slots=True)
class DeviceNode:
    """A node through which programs create devices.

    Attributes:
        node: its path.
        module: the kernel module behind it.
        rule: the udev rule that gives it to the person at the machine.
        file: name of the rule's file.
    """

    node: Path
    module: str
    rule: str
    file: str

    def open(self, node: Path | None = None) -> int:
        """Returns an open descriptor.

        Args:
            node: another place, for tests.

        Raises:
            DeviceError: there is no node, no module behind it, or no right to use it.
        """
        node = node or self.node
        try:
            return os.open(node, os.O_RDWR | os.O_CLOEXEC)
        except OSError as error:
            raise self._explain(node, error) from error

    def _explain(self, node: Path, error: OSError) -> DeviceError:
        load = f"sudo modprobe {self.module}"
        if error.errno == errno.ENOENT:
            return DeviceError(
                f"There is no {node} here, so no virtual gamepad can be made.",
                hint=f"Load the module: {load}. A container needs the host's {node}.",
            )
        if error.errno in (errno.ENODEV, errno.ENXIO):
            return DeviceError(
                f"'{node}' exists, but the kernel module behind it is missing.",
                hint=f"Load it: {load}. If it is not found, this kernel was built "
                "without it: install your distribution's package of extra kernel modules.",
            )
        if error.errno in (errno.EACCES, errno.EPERM):
            mode = node.stat().st_mode & 0o777
            return DeviceError(
                f"You have no right to write to {node} (its mode is {mode:04o}).",
                hint=f"{explain_rule(self.rule, self.file, f'--name-match={self.module}')}\n"
                "In a container the host must grant the device as well.",
            )
        return DeviceError(f"'{node}' cannot be opened: {error.strerror}.")


def explain_rule(rule: str, file: str, trigger: str) -> str:
    """Returns how to install a rule and make it take effect."""
    return (
        "Allow it for the person at the machine:\n"
        f"  echo '{rule}' | sudo tee /etc/udev/rules.d/{file}\n"
        f"  sudo udevadm control --reload && sudo udevadm trigger {trigger}"
    )
