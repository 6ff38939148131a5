"""The file that describes a gel, and which one applies."""

from base64 import b64encode
from pathlib import Path

import numpy as np
import pytest

from neurotouch_hid.driver.control_socket import ControlSocket
from neurotouch_hid.driver.gel_file import choose_gel, find_gel_file, find_gel_folder
from neurotouch_hid.errors import DriverError, NotRunningError, ProfileError
from neurotouch_hid.geometry import PAPER_GEL

HEX = "version: 1\nname: hex\nlayout: {kind: hex, pitch_mm: 4.65, radius_mm: 30}\n"


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))
    folder = find_gel_folder()
    folder.mkdir(parents=True)
    return folder


def read(tmp_path: Path, text: str):
    path = tmp_path / "a.gel.yaml"
    path.write_text(text)
    return choose_gel(str(path)).gel


@pytest.mark.parametrize(
    ("layout", "n", "pitch_mm"),
    [
        ("kind: square, pitch_mm: 4, radius_mm: 30", 177, 4.0),
        ("kind: hex, pitch_mm: 4.65, radius_mm: 30", 151, 4.65),
        ("kind: rings, pitch_mm: 4.7, radius_mm: 30", 127, 4.7),
        ("kind: grid, columns: 10, rows: 7, pitch_mm: 4", 70, 4.0),
        ("kind: grid, columns: 10, rows: 7, pitch_mm: [4, 5.5]", 70, 4.0),
    ],
)
def test_each_kind_of_layout_has_its_dots(tmp_path, layout, n, pitch_mm):
    gel = read(tmp_path, f"layout: {{{layout}}}")
    assert gel.n_markers == n
    assert gel.pitch_mm == pytest.approx(pitch_mm)
    assert np.hypot(*gel.points_mm.T).max() <= gel.radius_mm + 1e-9
    np.testing.assert_allclose(gel.points_mm.mean(axis=0), 0.0, atol=1e-9)


def test_the_square_of_the_paper_is_the_gel_of_the_paper(tmp_path):
    gel = read(tmp_path, "layout: {kind: square, pitch_mm: 4, radius_mm: 30}")
    np.testing.assert_array_equal(gel.points_mm, PAPER_GEL.points_mm)
    np.testing.assert_array_equal(gel.neighbours, PAPER_GEL.neighbours)
    assert (gel.dot_mm, gel.light, gel.dome_height_mm) == (1.0, True, 15.0)


def test_rings_begin_at_angle_0(tmp_path):
    points = read(tmp_path, "layout: {kind: rings, pitch_mm: 5, radius_mm: 25}").points_mm
    np.testing.assert_allclose(points[:3], [[0, 0], [5, 0], [2.5, 5 * 0.75**0.5]], atol=1e-9)
    assert [tuple(np.round(points[k], 9)) for k in (7, 19, 37, 61)] == [
        (10, 0), (15, 0), (20, 0), (25, 0)
    ]  # fmt: skip


def test_every_key_reaches_the_gel(tmp_path):
    points = [[3 * (k % 7), 3.5 * (k // 7)] for k in range(42)]
    gel = read(
        tmp_path,
        f"version: 1\nname: mine\nlayout: {{kind: points, points_mm: {points}}}\n"
        "dot_mm: 0.8\ndots: dark\ndome_height_mm: 0\n",
    )
    np.testing.assert_array_equal(gel.points_mm, points)
    assert (gel.name, gel.pitch_mm, gel.dot_mm, gel.light) == ("mine", 3.0, 0.8, False)
    assert gel.dome_height_mm == 0.0


TWICE = [[3 * (k % 39 % 7), 3 * (k % 39 // 7)] for k in range(40)]
LAYOUT = "layout: {kind: square, pitch_mm: 4, radius_mm: 30}\n"


@pytest.mark.parametrize(
    ("text", "place", "words"),
    [
        ("", ":1:1", "empty"),
        ("name: hex\n", ":1:1", "the key 'layout' is missing"),
        (LAYOUT + "dot: 1\n", ":2:1", "dot_mm"),
        (LAYOUT + "dots: black\n", ":2:7", "light, dark"),
        (LAYOUT + "dot_mm: 0\n", ":2:9", "at least 0.2"),
        (LAYOUT + "dome_height_mm: .nan\n", ":2:17", "finite"),
        (LAYOUT + "version: 2\n", ":2:10", "version 1"),
        (LAYOUT + "name: Über uns\n", ":2:7", "small letters"),
        ("layout: {kind: cube, pitch_mm: 4}\n", ":1:16", "square, hex, rings, grid, points"),
        ("layout: {kind: hex, pitch_mm: 4}\n", ":1:16", "needs the key 'radius_mm'"),
        (
            "layout:\n  kind: hex\n  pitch_mm: 4\n  radius_mm: 30\n  rows: 4\n",
            ":5:",
            "it has pitch_mm, radius_mm",
        ),
        ("layout: {kind: hex, pitch_mm: [4, 5], radius_mm: 30}\n", ":1:21", "only a grid"),
        ("layout: {kind: hex, pitch_mm: 30, radius_mm: 20}\n", ":1:46", "gives 1 dots"),
        ("layout: {kind: hex, pitch_mm: 4, radius_mm: 32}\n", ":1:45", "at most 31 mm"),
        (
            "layout: {kind: grid, columns: 15, rows: 15, pitch_mm: 4}\n",
            ":1:31",
            "dot 1 is 39.6 mm from the middle, and 31 mm are possible",
        ),
        ("layout: {kind: square, pitch_mm: 0.5, radius_mm: 30}\n", ":1:50", "40 to 400"),
        ("layout: {kind: grid, columns: 200, rows: 200, pitch_mm: 1}\n", ":1:31", "40000 dots"),
        ("layout: {kind: points, points_mm: [[1, 2], [3, 4]]}\n", ":1:24", "at least 40 entries"),
        (
            f"layout: {{kind: points, points_mm: {TWICE}}}\n",
            ":1:",
            "dots 1 and 40 are 0 mm apart",
        ),
        (LAYOUT + "dot_mm: 4\n", ":1:", "larger distances, or a smaller 'dot_mm'"),
        (
            "layout: {kind: hex, pitch_mm: 0.1, radius_mm: 30}\n",
            ":1:31",
            "layout.pitch_mm: 0.1 is too small, at least 0.5 mm",
        ),
        (
            "layout: {kind: grid, columns: 9, rows: 9, pitch_mm: [4, x]}\n",
            ":1:57",
            "layout.pitch_mm[1]: needs a number, not 'x'",
        ),
        (LAYOUT + "version: 1.0\n", ":2:10", "write 1\n"),
        (LAYOUT + "making: {camera: {name: a/b}}\n", ":2:25", "'a/b' is empty, too long, or has"),
    ],
)
def test_mistakes_are_told_with_their_place(tmp_path, text, place, words):
    with pytest.raises(ProfileError) as caught:
        read(tmp_path, text)
    said = f"{caught.value.message}\n{caught.value.hint or ''}"
    assert f"a.gel.yaml{place}" in said
    assert words in said


def test_the_gel_is_chosen_in_order(folder, tmp_path):
    clip = tmp_path / "clip.aedat4"
    assert choose_gel(None, f"file:{clip}").gel is PAPER_GEL
    (folder / "gel.yaml").write_text(HEX)
    assert choose_gel(None, "davis:").gel.name == choose_gel(None, f"{clip}").gel.name == "hex"
    assert choose_gel(None, f"file:{clip}", personal=False).gel is PAPER_GEL
    assert choose_gel(None, "sim:tour").gel is PAPER_GEL
    beside = tmp_path / "clip.gel.yaml"
    beside.write_text(HEX.replace("name: hex", "name: beside"))
    assert choose_gel(None, f"file:{clip}").gel.name == "beside"
    assert choose_gel(None, f"file:{clip}", personal=False).gel.name == "beside"
    (folder / "soft.gel.yaml").write_text(HEX.replace("name: hex", "name: soft"))
    assert choose_gel("soft", f"file:{clip}").gel.name == "soft"
    assert choose_gel(str(beside), "sim:tour").gel.name == "beside"
    assert choose_gel("paper", f"file:{clip}").gel is PAPER_GEL
    assert find_gel_file("paper") is None


def test_a_gel_that_is_not_there_is_told_with_where_to_put_it(folder):
    with pytest.raises(ProfileError, match="no gel file") as caught:
        choose_gel("soft")
    assert f"{folder}/NAME.gel.yaml" in str(caught.value.hint)


def test_the_gel_of_the_running_driver_is_the_one_that_it_tells(folder, tmp_path, monkeypatch):
    monkeypatch.setenv("RUNTIME_DIRECTORY", str(tmp_path / "run"))
    (folder / "gel.yaml").write_text(HEX)  # of this person, whom the driver need not play for
    with pytest.raises(NotRunningError):
        choose_gel(None, "driver:")
    told = HEX.replace("name: hex", "name: told").encode()
    answer = {"ok": True, "file": b64encode(told).decode()}
    with ControlSocket(tmp_path / "run") as driver:
        driver.serve(lambda _question, _uid: answer)
        chosen = choose_gel(None, "driver:", personal=False)
        assert (chosen.gel.name, chosen.file) == ("told", told)
        answer["file"] = ""
        assert choose_gel(None, "driver:") == (PAPER_GEL, b"")
        for damaged in (None, 7, "?", "AAA"):
            answer["file"] = damaged
            with pytest.raises(DriverError, match="lacks 'file'"):
                choose_gel(None, "driver:")
        answer["file"] = b64encode(b"layout: {kind: cube}\n").decode()
        with pytest.raises(ProfileError, match="running driver"):
            choose_gel(None, "driver:")
