"""Installs the package and waits for the power to be cut; after the cut, looks at what is there.

    python -m tests.system.guest.installing RESULTS

Runs in a guest whose disk keeps what was written.
"""

import json
import sys
import time
from hashlib import sha256
from pathlib import Path
from typing import Any

from tests.system.guest.observation import SERVICE, find_pad, run, show

_CACHE = Path("/var/cache/neurotouch")
_DIGEST_BYTES = 32


def main() -> None:
    results = Path(sys.argv[1])
    if (results / "installed.json").exists():
        (results / "found.json").write_text(json.dumps(look()))
        return
    lay_kernels(results)
    run("sync")  # what the package writes is not flushed with it
    done = run("env", "NUMBA_CPU_NAME=generic", "apt-get", "install", "--yes", find(results))
    (results / "installed.json").write_text(json.dumps(done))
    time.sleep(1000.0)


def lay_kernels(results: Path) -> None:
    """Lays compiled kernels where the service finds them: here that takes a quarter of an hour."""
    run("cp", "-r", str(results / "compiled-service"), str(_CACHE))
    run("chmod", "-R", "a+rwX", str(_CACHE))


def choose_processor() -> None:
    """Lets services load the kernels that the host has compiled for any processor."""
    Path("/etc/systemd/system.conf.d").mkdir(exist_ok=True)
    Path("/etc/systemd/system.conf.d/test.conf").write_text(
        "[Manager]\nDefaultEnvironment=NUMBA_CPU_NAME=generic\n"
    )
    run("systemctl", "daemon-reexec")


def find(results: Path) -> str:
    """The package."""
    return str(next(results.glob("*.deb")))


def look() -> dict[str, Any]:
    """What dpkg and the service say after the cut."""
    saw: dict[str, Any] = {
        "state": run("dpkg-query", "--show", "--showformat=${Status}", "neurotouch-hid")["out"],
        "audit": run("dpkg", "--audit")["out"],
        "verified": run("dpkg", "--verify", "neurotouch-hid")["out"],
        "kernels": {
            path.name.split("-")[0] + path.suffix: is_whole(path)
            for ending in ("nbc", "code")
            for path in _CACHE.rglob(f"*.{ending}")
        },
        "checked": run("neurotouch", "profile", "check"),
    }
    choose_processor()
    saw["started"] = run("systemctl", "start", SERVICE)
    return {**saw, "pad": find_pad(), "show": show("ActiveState", "NRestarts")}


def is_whole(path: Path) -> bool:
    """Whether a compiled kernel is what was written: it begins with a digest of the rest."""
    content = path.read_bytes()
    return sha256(content[_DIGEST_BYTES:]).digest() == content[:_DIGEST_BYTES]


if __name__ == "__main__":
    main()
