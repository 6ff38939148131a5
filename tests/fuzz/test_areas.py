"""A few hundred cases of each area; `make fuzz` runs as many as time allows."""

import json
import random
import sys

import pytest

from neurotouch_hid.errors import RecordingError
from tests.fuzz.area import Area, run_area
from tests.fuzz.areas import FILES
from tests.processes import run_command


@pytest.mark.parametrize("name", FILES)
def test_damaged_input_ends_in_one_sentence(tmp_path, name):
    report = run_area(FILES[name], f"{name}-1", tmp_path, cases=300)
    assert report.faults == []
    assert report.refused > 30
    assert report.refused < 300  # some come through, so the program's work is reached


def test_the_same_seed_gives_the_same_cases():
    for area in FILES.values():
        for n in range(20):
            assert area.make(random.Random(f"x:{n}")) == area.make(random.Random(f"x:{n}"))


@pytest.mark.parametrize(
    ("check", "fault"),
    [
        (lambda path: 1 // 0, "ZeroDivisionError"),
        (lambda path: bytearray(600 << 20).count(1), " MB"),
    ],
)
def test_a_fault_is_kept(tmp_path, check, fault):
    area = Area(lambda chance: b"x", check, RecordingError, ".x")
    report = run_area(area, "s", tmp_path, cases=1)
    (said,) = report.faults
    assert fault in said
    assert (tmp_path / "s-0.x").read_bytes() == b"x"


def test_by_coverage_it_ends_by_itself(tmp_path):
    pytest.importorskip("atheris")
    words = ["-m", "tests.fuzz", "labels", "--guided", "--seed", "1", "--minutes", "0.03"]
    done = run_command(sys.executable, *words, "--folder", tmp_path)
    (line,) = done.stdout.splitlines()
    assert line.endswith("0 faults")
    assert int(line.split(" cases")[0].split()[-1]) > 200  # more than it began with


def test_by_coverage_a_process_that_takes_much_memory_is_followed_by_another(tmp_path):
    pytest.importorskip("atheris")
    code = (
        "import sys; from tests.fuzz import guided; guided.MAX_TAKEN_BYTES = 0;"
        "sys.argv[1:] = ['labels', '1', '60', *sys.argv[1:]]; guided.main()"
    )
    corpus = tmp_path / "corpus"
    corpus.mkdir()
    done = run_command(sys.executable, "-c", code, tmp_path, corpus)
    first = json.loads(done.stdout)
    assert first["cases"] < 200
    assert len(list(corpus.iterdir())) >= 200  # for the next one
