"""Numbers and records of V4L2, as a C compiler makes them of Linux's own header."""

import ctypes
import os
import shutil
import subprocess
from pathlib import Path

import pytest

from neurotouch_hid.source.video import v4l2
from tests.processes import run_command

CALLS = (
    *("QUERYCAP", "ENUM_FMT", "G_FMT", "S_FMT", "REQBUFS", "QUERYBUF", "QBUF", "DQBUF"),
    *("STREAMON", "STREAMOFF", "G_PARM", "S_PARM", "G_CTRL", "S_CTRL", "QUERYCTRL"),
    *("ENUM_FRAMESIZES", "ENUM_FRAMEINTERVALS"),
)
RECORDS = {
    v4l2.Capability: ("v4l2_capability", "card", "bus_info", "capabilities", "device_caps"),
    v4l2.FormatDescription: ("v4l2_fmtdesc", "index", "type", "description", "pixelformat"),
    v4l2.FrameSize: ("v4l2_frmsizeenum", "pixel_format", "type", "size:discrete"),
    v4l2.FrameInterval: ("v4l2_frmivalenum", "width", "height", "type", "interval:discrete"),
    v4l2.Format: ("v4l2_format", "type", "fmt"),
    v4l2.PixelFormat: ("v4l2_pix_format", "pixelformat", "field", "bytesperline", "sizeimage"),
    v4l2.StreamParameters: ("v4l2_streamparm", "type", "parm"),
    v4l2.CaptureParameters: ("v4l2_captureparm", "capability", "timeperframe"),
    v4l2.RequestBuffers: ("v4l2_requestbuffers", "count", "type", "memory"),
    v4l2.Buffer: (
        *("v4l2_buffer", "index", "type", "bytesused", "flags", "field", "timestamp"),
        *("timecode", "sequence", "memory", "m", "length"),
    ),
    v4l2.QueryControl: ("v4l2_queryctrl", "minimum", "maximum", "step", "default_value", "flags"),
    v4l2.Control: ("v4l2_control", "id", "value"),
}
CONSTANTS = [
    name
    for name in dir(v4l2)
    if name.startswith(("CAP_", "BUF_FLAG", "CTRL_FLAG", "CID_", "BUF_TYPE", "MEMORY", "FIELD_"))
]
OTHER_NAMES = {"CAP_TIMEPERFRAME": "V4L2_CAP_TIMEPERFRAME"}


@pytest.fixture(scope="module")
def said(tmp_path_factory):
    """What a compiled program prints: a name and a number in each line."""
    compiler = shutil.which("cc") or shutil.which("gcc")
    if compiler is None or not Path("/usr/include/linux/videodev2.h").exists():
        assert "CI" not in os.environ, "a C compiler and linux-libc-dev are needed here"
        pytest.skip("no C compiler, or no linux/videodev2.h")
    lines = [f'P("{name}", VIDIOC_{name});' for name in CALLS]
    lines += [f'P("{name}", {OTHER_NAMES.get(name, f"V4L2_{name}")});' for name in CONSTANTS]
    for record, (name, *fields) in RECORDS.items():
        lines.append(f'P("{record.__name__}", sizeof(struct {name}));')
        for field in fields:
            ours, _, theirs = field.partition(":")
            place = f"offsetof(struct {name}, {theirs or ours})"
            lines.append(f'P("{record.__name__}.{ours}", {place});')
    folder = tmp_path_factory.mktemp("c")
    (folder / "sizes.c").write_text(
        "#include <stdio.h>\n#include <stddef.h>\n#include <linux/videodev2.h>\n"
        '#define P(name, value) printf("%s %lu\\n", name, (unsigned long)(value))\n'
        "int main(void) {\n" + "\n".join(lines) + "\nreturn 0;\n}\n"
    )
    program = folder / "sizes"
    subprocess.run([compiler, "-o", program, folder / "sizes.c"], check=True)
    done = run_command(program)
    return {name: int(value) for name, value in map(str.split, done.stdout.splitlines())}


def test_every_number_is_that_of_the_header(said):
    ours = {name: getattr(v4l2, name) for name in (*CALLS, *CONSTANTS)}
    assert len(CONSTANTS) > 20
    assert ours == {name: said[name] for name in ours}


@pytest.mark.parametrize("record", RECORDS, ids=lambda record: record.__name__)
def test_every_record_has_the_size_and_the_places_of_the_header(said, record):
    assert ctypes.sizeof(record) == said[record.__name__]
    for field in RECORDS[record][1:]:
        ours = field.partition(":")[0]
        assert getattr(record, ours).offset == said[f"{record.__name__}.{ours}"], ours
