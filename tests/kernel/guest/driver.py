"""Runs the driver itself: ``neurotouch run`` on the simulated gel."""

from pathlib import Path
from typing import Any


def play_tour(results: Path) -> Any:
    raise NotImplementedError


def terminate(results: Path) -> Any:
    raise NotImplementedError


def kill(results: Path) -> Any:
    raise NotImplementedError
