"""Whose word counts between processes, for every owner and mode."""

import os
import socket
import stat
import struct
from types import SimpleNamespace

import pytest

from neurotouch_hid import ipc

ME, OTHER = 1000, 7


def make_folder(owner, owner_above, mode_above, kind=stat.S_IFDIR):
    above = SimpleNamespace(st_uid=owner_above, st_mode=stat.S_IFDIR | mode_above)
    found = SimpleNamespace(st_uid=owner, st_mode=kind | 0o755)
    return SimpleNamespace(lstat=lambda: found, parent=SimpleNamespace(stat=lambda: above))


@pytest.mark.parametrize(
    ("owner", "owner_above", "mode_above", "believed"),
    [
        (ME, ME, 0o755, {0, ME}),
        (ME, OTHER, 0o777, {0, ME}),
        (0, OTHER, 0o777, {0, ME}),
        (OTHER, 0, 0o755, {0, ME, OTHER}),
        (OTHER, 0, 0o775, set()),
        (OTHER, 0, 0o757, set()),
        (OTHER, 0, 0o1777, set()),
        (OTHER, ME, 0o755, set()),
        (OTHER, OTHER, 0o755, set()),
        (1, OTHER, 0o755, set()),
    ],
)
def test_a_folder_is_believed_by_its_owner_or_where_only_root_makes_folders(
    monkeypatch, owner, owner_above, mode_above, believed
):
    monkeypatch.setattr(os, "geteuid", lambda: ME)
    folder = make_folder(owner, owner_above, mode_above)
    assert ipc.find_believed(folder) == believed
    link = make_folder(owner, owner_above, mode_above, kind=stat.S_IFLNK)
    assert ipc.find_believed(link) == set()


def test_only_the_own_user_and_root_are_own_peers(monkeypatch):
    monkeypatch.setattr(os, "geteuid", lambda: ME)
    monkeypatch.setattr(ipc, "find_peer", lambda uid: uid)
    assert [uid for uid in (0, 1, OTHER, ME - 1, ME, ME + 1) if ipc.is_own_peer(uid)] == [0, ME]


def test_the_kernel_names_the_peer():
    ours, theirs = socket.socketpair()
    with ours, theirs:
        assert ipc.find_peer(ours) == os.geteuid()


@pytest.mark.parametrize(("open_to_all", "mode"), [(False, 0o600), (True, 0o666)])
def test_a_socket_replaces_one_that_was_left_and_never_waits(tmp_path, open_to_all, mode):
    path = tmp_path / "socket"
    ipc.listen_at(path).close()
    with ipc.listen_at(path, open_to_all=open_to_all) as listener:
        assert stat.S_IMODE(path.stat().st_mode) == mode
        with pytest.raises(BlockingIOError):
            listener.accept()
        with ipc.connect_to(path) as peer:
            assert peer.gettimeout() == 0.0
            listener.accept()[0].close()


def test_numbers_too_large_for_arithmetic_become_floats():
    assert repr(ipc.read_object(f'{{"a": {"9" * 15}, "b": {"1" * 16}}}')) == (
        f"{{'a': {'9' * 15}, 'b': 1111111111111111.0}}"
    )
    assert ipc.read_object(f'{{"a": {"9" * 400}}}') == {"a": float("inf")}
    assert [ipc.read_object(text) for text in ("[1]", "7", "{", "[" * 100_000, b"\xff")] == [
        None
    ] * 5


def test_the_peer_is_the_user_and_neither_process_nor_group():
    peer = SimpleNamespace(getsockopt=lambda *_: struct.pack("3i", 7, 1001, 2002))
    assert ipc.find_peer(peer) == 1001


TCP = """\
  sl  local_address rem_address   st tx_queue rx_queue tr tm->when retrnsmt   uid  timeout inode
   0: 0100007F:1F90 0100007F:C350 06 00000000:00000000 03:00000D9F 00000000     0        0 0 3
   1: 0100007F:1F90 00000000:0000 0A 00000000:00000000 00:00000000 00000000     3        0 9 1
   2: 0100007F:C350 0100007F:1F90 01 00000000:00000000 00:00000000 00000000  1001        0 8 1
   3: 0100007F:1F90 0100007F:C350 01 00000000:00000000 00:00000000 00000000  1002        0 7 1
"""
"""As the kernel writes it: an old connection, a listener, and both ends of a new connection."""


def test_the_user_of_an_end_of_a_connection_is_in_the_kernels_list(tmp_path, monkeypatch):
    monkeypatch.setattr(ipc, "_TCP", tmp_path / "tcp")
    page, browser = ("127.0.0.1", 8080), ("127.0.0.1", 50000)
    assert ipc.find_tcp_user(browser, page) is None  # no such file
    (tmp_path / "tcp").write_text(TCP)
    assert ipc.find_tcp_user(browser, page) == 1001
    assert ipc.find_tcp_user(page, browser) == 1002
    assert ipc.find_tcp_user(page, page) is None
    assert ipc.find_tcp_user(("::1", 8080, 0, 0), ("::1", 50000, 0, 0)) is None
