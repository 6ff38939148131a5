"""Reads our HID pad through hidapi, as a program would that knows it."""

import contextlib
import os
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import hidraw

from neurotouch_hid.device.outputs.identity import load_identities
from tests.kernel.guest.opening import properties

OWN = load_identities()["own"]
LONGEST = 64


def find_pads() -> list[dict[str, Any]]:
    """What hidapi lists of our pads."""
    return hidraw.enumerate(OWN.vendor, OWN.product)


def list_pads() -> list[dict[str, Any]]:
    """What hidapi says of each: its listing, its descriptor, and how it answers questions."""
    listed = []
    for found in find_pads():
        pad = hidraw.device()
        pad.open_path(found["path"])
        begun = time.monotonic()
        report = pad.get_input_report(0, LONGEST)
        with contextlib.suppress(OSError):
            pad.get_feature_report(1, LONGEST)
        wrote = pad.send_feature_report(b"\1abc")
        listed.append(
            {
                **{key: value for key, value in found.items() if key != "path"},
                "tags": properties(Path(os.fsdecode(found["path"]))).get("TAGS", ""),
                "descriptor": bytes(pad.get_report_descriptor()).hex(),
                "report": bytes(report).hex(),
                "wrote": wrote,
                "answered_s": time.monotonic() - begun,
            }
        )
        pad.close()
    return listed


@contextlib.contextmanager
def read_pad() -> Iterator[list[str]]:
    """Collects the reports of our pad, if it is one, in hexadecimal."""
    reports: list[str] = []
    found = find_pads()
    if not found:
        yield reports
        return
    pad = hidraw.device()
    pad.open_path(found[0]["path"])
    done = threading.Event()

    def collect() -> None:
        while not done.is_set():
            report = pad.read(LONGEST, timeout_ms=50)
            if report:
                reports.append(bytes(report).hex())

    thread = threading.Thread(target=collect)
    thread.start()
    try:
        yield reports
    finally:
        done.set()
        thread.join()
        pad.close()
