"""A real slicer accepts every part."""

import shutil
import subprocess

import pytest

from neurotouch_hid.gel_making.folder import make_files
from tests.gel_making.plans import plan

SLICER = shutil.which("prusa-slicer")
PRINTER = (
    "--layer-height=0.2", "--first-layer-height=0.2", "--nozzle-diameter=0.4",
    "--bed-shape=0x0,250x0,250x210,0x210", "--max-print-height=250",
)  # fmt: skip

pytestmark = pytest.mark.skipif(SLICER is None, reason="needs the package prusa-slicer")


@pytest.mark.parametrize("way", ["printed", "cast"])
def test_every_part_is_sliced(tmp_path, way):
    files = make_files(plan("board", "small", way), b"")
    for name in sorted(files):
        if not name.endswith((".stl", ".3mf")) or name == "dome-light.stl":
            continue  # dots alone would be printed in the air
        if way == "cast" and not name.startswith(("mould", "pegs")):
            continue  # the housing is the same
        path, out = tmp_path / name, tmp_path / f"{name}.gcode"
        path.write_bytes(files[name])
        info = subprocess.run(
            [SLICER, "--info", path], capture_output=True, text=True, timeout=120, check=True
        )
        assert "manifold = yes" in info.stdout
        assert "open_edges" not in info.stdout
        support = ["--support-material"] if name.startswith("dome") else []
        done = subprocess.run(
            [SLICER, "--export-gcode", *PRINTER, *support, "-o", out, path],
            capture_output=True, text=True, timeout=300, check=False,
        )  # fmt: skip
        assert done.returncode == 0, done.stderr
        assert out.read_text().count("G1 ") > 500
