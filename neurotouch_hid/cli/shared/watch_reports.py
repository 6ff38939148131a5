"""``neurotouch devices --watch``: prints the reports of a pad as they arrive."""

import json

from neurotouch_hid.cli.ui.output import echo
from neurotouch_hid.device.inputs.hid_pad_reader import HidPad, Report, find_hid_pads, read_reports
from neurotouch_hid.errors import DeviceError


def watch_pad(*, as_json: bool) -> None:
    """Prints each report of our first HID pad, a line each, until the pad is removed or Ctrl-C.

    Raises:
        DeviceError: there is none, or it cannot be read.
    """
    pads = find_hid_pads()
    if not pads:
        raise DeviceError(
            "No HID pad of this program was found.",
            hint="Make one: neurotouch run --device hid",
        )
    pad = pads[0]
    reports = read_reports(pad)
    echo(f"Reports of {pad.name} ({pad.node}). Ctrl-C ends.", err=True)
    for report in reports:
        if report is not None:
            echo(json.dumps(_tabulate(pad, report)) if as_json else _describe(report))
    echo(f"{pad.name} was removed.", err=True)


def _tabulate(pad: HidPad, report: Report) -> dict[str, object]:
    return {
        "pad": pad.place,
        "buttons": sorted(report.buttons),
        "axes": {axis: round(value, 5) for axis, value in report.axes.items()},
    }


def _describe(report: Report) -> str:
    parts = [
        *sorted(report.buttons),
        *(f"{axis} {value:+.3f}" for axis, value in report.axes.items()),
    ]
    return "  ".join(parts) or "at rest"
