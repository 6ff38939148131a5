"""Waiting for what another thread or process does."""

import time
from collections.abc import Callable
from typing import Any

LIMIT_S = 600.0
"""A process may compile first, on a busy machine."""


def wait_until(happened: Callable[[], Any], explain: Callable[[], object] = str) -> Any:
    """Returns what the condition returns, as soon as that is true."""
    deadline = time.monotonic() + LIMIT_S
    while not (outcome := happened()):
        assert time.monotonic() < deadline, explain()
        time.sleep(0.005)
    return outcome
