"""Saving: whole or not at all, with the versions before kept beside."""

import fcntl
import json
import os
import re
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import Final

from neurotouch_hid.errors import ProfileError
from neurotouch_hid.files.small_file import MAX_SETTINGS_BYTES, read_bytes, suggest_reading
from neurotouch_hid.partial_file import suggest_fix, write_whole
from neurotouch_hid.players import look_into
from neurotouch_hid.printable import make_printable

KEPT: Final = 20
_VERSION_FILE: Final = re.compile(r"(\d{6})-([\w-]+)\.yaml")


@dataclass(frozen=True, slots=True)
class Version:
    """An earlier version of a file.

    Attributes:
        number: counts up from 1.
        stamp: when it was replaced.
        path: where it is kept.
    """

    number: int
    stamp: str
    path: Path

    def read(self) -> bytes:
        """Returns its content.

        Raises:
            ProfileError: something else has been put in its place.
        """
        try:
            return read_bytes(self.path, MAX_SETTINGS_BYTES)
        except OSError as error:
            raise _fail(self.path, "read", error) from None


class Store:
    """A file and its earlier versions in ``.history/NAME/`` beside it.

    ``undone.json`` there says which versions an undo has left, and to which one the last undo went.
    A version that was left is kept, but no undo brings it back. ``last_saved`` is what was written
    here last: where the file differs from it, another program has changed the file, and what it
    replaced becomes a version too. ``deleted_link`` is the link that the file was when it was
    deleted. ``lock`` lets one process at a time change all of these.

    Args:
        path: the file; its name without the suffix is NAME. It need not exist.
        stamp: gives the present moment as letters, digits, ``-`` and ``_``.
        kept: how many versions are kept.

    Attributes:
        path: the file.
        undone_file: changes after the file itself when a change of it is undone.
    """

    def __init__(self, path: Path, stamp: Callable[[], str], *, kept: int = KEPT) -> None:
        self.path = path
        self._stamp = stamp
        self._kept = kept
        self._folder = path.parent / ".history" / path.stem
        self.undone_file = self._folder / "undone.json"
        self._saved_file = self._folder / "last_saved"
        self._link_file = self._folder / "deleted_link"

    def read(self) -> bytes | None:
        """Returns the content of the file, or None if there is none."""
        try:
            return read_bytes(self.path, MAX_SETTINGS_BYTES)
        except FileNotFoundError:
            return None
        except OSError as error:
            raise _fail(self.path, "read", error) from None

    def save(
        self, content: bytes, *, over: bytes | None, keep: bool = True, begun: bytes | None = None
    ) -> None:
        """Puts the content in the file's place and keeps what stood there.

        Args:
            content: the new content.
            over: what the edit began with; None if there was no file.
            keep: whether what stood there becomes a version.
            begun: without a file, a content that becomes a version in its place.

        Raises:
            ProfileError: another program changes or has changed the file, or it cannot be written;
                then it is as it was.
        """
        with self._lock("written"):
            if self.read() != over:
                raise self._refuse()
            self._keep_saved(over)
            replaced = begun if over is None else over if keep else None
            if replaced is not None:
                self._keep(replaced, self._stamp())
            self._write(content)
            self._forget_shown()

    def versions(self) -> list[Version]:
        """Returns the versions before, newest first.

        Raises:
            ProfileError: their folder is there and cannot be looked into.
        """
        found = []
        for path in look_into(self._folder):
            parts = _VERSION_FILE.fullmatch(path.name)
            if parts is not None:
                found.append(Version(int(parts[1]), parts[2], path))
        return sorted(found, key=lambda version: version.number, reverse=True)

    def changes(self, kind: str) -> Iterator[tuple[bytes, bytes]]:
        """Gives the content before and after each change whose stamp ends so, newest first."""
        after = self._read_saved() or self.read() or b""
        for version in self.versions():
            before = version.read()
            if version.stamp.endswith(kind):
                yield before, after
            after = before

    def delete(self) -> None:
        """Deletes the file and keeps its content as the newest version.

        Raises:
            ProfileError: it cannot be deleted; then it is as it was.
        """
        with self._lock("deleted"):
            content = self.read()
            self._keep_saved(content)
            if content is not None:
                self._keep(content, self._stamp())
            self._link_file.unlink(missing_ok=True)
            if self.path.is_symlink():
                self._link_file.symlink_to(self.path.readlink())
            self.path.unlink(missing_ok=True)
            self._saved_file.unlink(missing_ok=True)

    def keep_replaced(self) -> None:
        """Keeps what was saved here last, if another program has put something in its place.

        Raises:
            ProfileError: it cannot be kept.
        """
        with self._lock("kept"):
            self._keep_saved(self.read())

    def undo(self) -> Version:
        """Takes the file back to the version before; again, to the one before that.

        What is there now stays among the versions, so nothing is lost.

        Raises:
            ProfileError: there is none, or it cannot be written.
        """
        with self._lock("written"):
            return self._undo()

    def can_undo(self) -> bool:
        """Returns whether there is a version before; changes nothing.

        Raises:
            ProfileError: the file or a version cannot be read.
        """
        content, saved = self.read(), self._read_saved()
        return saved not in (None, content) or self._find_before(content)[1] is not None

    def _undo(self) -> Version:
        content = self.read()
        self._keep_saved(content)
        undone = self._read_undone()[1]
        now, version = self._find_before(content)
        if version is None:
            raise ProfileError(
                f"There is nothing to undo: '{self.path.stem}' has no version before this one.",
                hint=f"See what is kept: neurotouch profile history {self.path.stem}",
            )
        self._put_back(version, content, keep=now is None)
        left = now if now is not None else self.versions()[0]
        if left.read() == content:
            undone.add(left.number)
        self._write_undone(version.number, undone)
        return version

    def _find_before(self, content: bytes | None) -> tuple[Version | None, Version | None]:
        """Returns the version to which the last undo went, if the file is still so.

        The second one is the version to which the next undo goes.
        """
        versions = self.versions()
        shown, undone = self._read_undone()
        now = next((v for v in versions if v.number == shown and v.read() == content), None)
        before = (
            version
            for version in versions
            if (now is None or version.number < now.number)
            and version.number not in undone
            and version.read() != content
        )
        return now, next(before, None)

    def restore(self, number: int) -> Version:
        """Takes the file back to a version.

        Raises:
            ProfileError: there is none of this number, or it cannot be written.
        """
        with self._lock("written"):
            content, versions = self.read(), self.versions()
            version = next((version for version in versions if version.number == number), None)
            if version is None:
                numbers = ", ".join(str(version.number) for version in versions) or "none"
                raise ProfileError(
                    f"'{self.path.stem}' has no version {number}.",
                    hint=f"Versions kept: {numbers}.",
                )
            self._put_back(version, content, keep=True)
            self._forget_shown()
            return version

    @contextmanager
    def _lock(self, what: str) -> Iterator[None]:
        """Lets no other process change the file or its versions in between.

        Raises:
            ProfileError: another process does just now, or the file cannot be changed.
        """
        flags = os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW | os.O_CLOEXEC
        try:
            self._folder.mkdir(parents=True, exist_ok=True)
            descriptor = os.open(self._folder / "lock", flags, 0o600)
            try:
                fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
                yield
            finally:
                os.close(descriptor)
        except BlockingIOError:
            raise self._refuse() from None
        except OSError as error:
            raise _fail(self.path, f"{what}; it is as it was", error) from None

    def _refuse(self) -> ProfileError:
        return ProfileError(
            f"'{make_printable(str(self.path))}' was changed by another program meanwhile.",
            hint="Do it once more.",
        )

    def _put_back(self, version: Version, content: bytes | None, *, keep: bool) -> None:
        """Writes a version into the file's place, and keeps a content that is no version yet."""
        back = version.read()
        if keep:
            self._keep_saved(content)
        if keep and content is not None:
            self._keep(content, self._stamp())
        if content is None:
            self._put_link_back(back)
        self._write(back)

    def _put_link_back(self, content: bytes) -> None:
        """Makes the link again that was deleted, if its target still has this content.

        A target that has changed meanwhile is another's: it is never written.
        """
        with suppress(OSError):  # it was no link, or its target is gone: then it becomes a file
            target = self._link_file.readlink()
            if read_bytes(self.path.parent / target, MAX_SETTINGS_BYTES) == content:
                self.path.symlink_to(target)
        with suppress(OSError):
            self._link_file.unlink(missing_ok=True)

    def _write(self, content: bytes) -> None:
        write_whole(self.path, content)
        with suppress(OSError):  # what another program changes next is then no version of its own
            write_whole(self._saved_file, content)

    def _keep(self, content: bytes, stamp: str) -> None:
        """Keeps a content as the newest version, without touching the file."""
        versions = self.versions()
        if versions and versions[0].read() == content:
            return
        number = versions[0].number + 1 if versions else 1
        write_whole(self._folder / f"{number:06d}-{stamp}.yaml", content)
        for version in versions[self._kept - 1 :]:
            version.path.unlink(missing_ok=True)

    def _keep_saved(self, content: bytes | None) -> None:
        """Keeps what was saved last, if another program has put this content in its place."""
        saved = self._read_saved()
        if saved is None or saved == content:
            return
        stamp = self._stamp()
        if content is not None:
            changed = datetime.fromtimestamp(self.path.stat().st_mtime)
            stamp = changed.strftime("%Y-%m-%d_%H-%M-%S_text_editor")
        self._keep(saved, stamp)

    def _read_saved(self) -> bytes | None:
        try:
            return read_bytes(self._saved_file, MAX_SETTINGS_BYTES)
        except OSError:
            return None

    def _read_undone(self) -> tuple[int, set[int]]:
        """Returns the version to which the last undo went, 0 if unknown, and those it left."""
        try:
            read = json.loads(read_bytes(self.undone_file, MAX_SETTINGS_BYTES))
            return int(read["shown"]), {int(number) for number in read["undone"]}
        except (OSError, ValueError, TypeError, KeyError, RecursionError):
            return 0, set()

    def _forget_shown(self) -> None:
        """Lets the next undo begin at the newest version, because the file has changed since."""
        shown, undone = self._read_undone()
        if shown:
            self._write_undone(0, undone)

    def _write_undone(self, shown: int, undone: Iterable[int]) -> None:
        kept = {version.number for version in self.versions()}
        marks = {"shown": shown, "undone": sorted(kept.intersection(undone))}
        with suppress(OSError):  # the next undo then only goes to the newest version
            write_whole(self.undone_file, json.dumps(marks).encode())


def _fail(path: Path, what: str, error: OSError) -> ProfileError:
    reason = error.strerror or str(error)
    hint = suggest_reading(error) if what == "read" else suggest_fix(error)
    return ProfileError(f"'{make_printable(str(path))}' cannot be {what}: {reason}.", hint=hint)
