"""What a browser may send: anything. It gets a sentence, and nothing changes."""

import json

import pytest

from neurotouch_hid.labelling.host import LabelHost
from neurotouch_hid.labelling.label_file import LabelFile
from neurotouch_hid.labelling.track import UNLABELLED
from neurotouch_hid.recording import read_labels
from tests.labelling.made import make_moments


class Browser:
    """Keeps what it is told."""

    def __init__(self):
        self.told = {}

    def queue_message(self, message):
        self.told |= message


@pytest.fixture
def host(tmp_path):
    moments = make_moments([0, 1, 1, 0], [[], [(9.0, 9.0)], [(9.0, 9.0)], []])
    return LabelHost(moments, LabelFile(tmp_path / "a.labels.csv", moments), name="a.aedat4")


async def ask(host, **request):
    browser = Browser()
    await host._hear(browser, json.dumps(request))
    return browser.told


@pytest.mark.parametrize(
    "request_",
    [
        {},
        {"do": "nonsense"},
        {"do": ["confirm"]},
        {"do": "confirm"},
        {"do": "confirm", "first": 0, "last": 99},
        {"do": "confirm", "first": True, "last": 2},
        {"do": "type", "first": 0, "last": 1, "kind": "fly"},
        {"do": "type", "first": 0, "last": 1, "kind": {}},
        {"do": "move", "k": 1, "index": 0, "x": "left", "y": 0},
        {"do": "move", "k": 1, "index": 0, "x": 1e300, "y": 0},
        {"do": "move", "k": 1, "index": 0, "x": 5000, "y": 0},
        {"do": "add", "k": 1.5, "x": 1, "y": 1},
        {"do": "show", "k": -1},
        {"do": "show"},
    ],
    ids=json.dumps,
)
def test_a_wrong_request_is_refused(host, run_async, request_):
    told = run_async(ask(host, **request_))
    assert told["refused"]
    assert "saved" not in told
    assert (host.sheet.labels.kind == UNLABELLED).all()


def test_a_fault_of_ours_is_not_called_a_wrong_request(host, run_async, monkeypatch):
    monkeypatch.setattr(host.sheet, "accept", lambda first, last: {}[first, last])
    with pytest.raises(KeyError):
        run_async(ask(host, do="confirm", first=0, last=3))


def test_a_change_is_on_disk_when_it_is_said_to_be_saved(host, run_async, tmp_path):
    told = run_async(ask(host, do="confirm", first=0, last=3, n=7))
    assert (told["saved"], told["n"]) == ("Confirmed.", 7)
    assert [truth.kind for truth in read_labels(tmp_path / "a.labels.csv")] == [0, 1, 1, 0]


def test_what_cannot_be_written_is_not_said_to_be_saved(host, run_async, tmp_path):
    (tmp_path / "a.labels.csv").mkdir()
    told = run_async(ask(host, do="confirm", first=0, last=3))
    assert "saved" not in told
    assert "a.labels.csv" in told["refused"]
