"""A real slicer accepts every part."""

import shutil

import pytest

from neurotouch_hid.gel_making.folder import make_files
from tests.gel_making.plans import plan
from tests.processes import run_command

SLICER = shutil.which("prusa-slicer")
PRINTER = (
    "--layer-height=0.2",
    "--first-layer-height=0.2",
    "--nozzle-diameter=0.4",
    "--bed-shape=0x0,250x0,250x210,0x210",
    "--max-print-height=250",
)

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
        info = run_command(SLICER, "--info", path)
        assert "manifold = yes" in info.stdout
        assert "open_edges" not in info.stdout
        support = ["--support-material"] if name.startswith("dome") else []
        run_command(SLICER, "--export-gcode", *PRINTER, *support, "-o", out, path)
        assert out.read_text().count("G1 ") > 500
