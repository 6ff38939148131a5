"""Only a small regular file is read; all else is refused at once, in words."""

import errno
import os
import socket
from pathlib import Path

import pytest

from neurotouch_hid.files.small_file import may_be_there, read_bytes, read_text


def refusal(path, most=100):
    with pytest.raises(OSError, match=r"^\[Errno \d+\] \S") as caught:
        read_text(path, most)
    return caught.value.strerror


def test_a_file_is_read_up_to_the_limit(tmp_path):
    path = tmp_path / "a"
    path.write_bytes(b"\xef\xbb\xbfa\r\nb")
    assert read_bytes(path, 7) == b"\xef\xbb\xbfa\r\nb"
    assert read_text(path, 7) == "a\r\nb"
    path.write_bytes(bytes(3 << 20))
    assert len(read_bytes(path, 3 << 20)) == 3 << 20
    assert refusal(path, (3 << 20) - 1) == "it is larger than 3071 kB"


def test_what_is_no_file_is_not_waited_for(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    assert refusal(tmp_path / "pipe") == "it is a pipe, not a file"
    assert refusal(tmp_path) == "it is a folder, not a file"
    (tmp_path / "zero").symlink_to("/dev/zero")
    assert refusal(tmp_path / "zero") == "it is a device, not a file"
    with socket.socket(socket.AF_UNIX) as server:
        server.bind(str(tmp_path / "socket"))
        assert refusal(tmp_path / "socket") == "it is a socket, not a file"


def test_a_missing_file_and_names_that_are_none(tmp_path):
    with pytest.raises(FileNotFoundError):
        read_bytes(tmp_path / "gone", 10)
    for name in ("a\0b", "\ud800"):
        assert refusal(tmp_path / name) == "no file can have this name"
    (tmp_path / "loop").symlink_to("loop")
    assert refusal(tmp_path / "loop") == os.strerror(errno.ELOOP)


def test_only_what_is_certainly_missing_is_taken_for_missing(tmp_path):
    (tmp_path / "file").touch()
    (tmp_path / "loop").symlink_to("loop")
    assert may_be_there(tmp_path / "file")
    assert not may_be_there(tmp_path / "none")
    assert not may_be_there(tmp_path / "file/none")
    for path in (tmp_path / ("x" * 300), tmp_path / "loop"):
        assert may_be_there(path)
        assert refusal(path)


def test_what_is_no_text(tmp_path):
    (tmp_path / "a").write_bytes(b"one\ntwo \xff")
    assert refusal(tmp_path / "a") == "byte 0xff in line 2 is not UTF-8 text"


def test_no_descriptor_stays_open(tmp_path):
    (tmp_path / "a").write_bytes(bytes(1000))
    before = len(list(Path("/proc/self/fd").iterdir()))
    refusal(tmp_path / "a")
    read_bytes(tmp_path / "a", 1000)
    assert len(list(Path("/proc/self/fd").iterdir())) == before
