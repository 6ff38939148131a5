"""The labels that a person makes: each change can be undone."""

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from neurotouch_hid.errors import NeuroTouchError
from neurotouch_hid.labelling.look_through import Moments
from neurotouch_hid.labelling.track import UNLABELLED, Run, Track, is_gesture
from neurotouch_hid.messages import GestureKind
from neurotouch_hid.recording.labels import MAX_CONTACTS

_MOST_CHANGES: Final = 1000


@dataclass(frozen=True, slots=True, eq=False)
class _Change:
    first: int
    before: Track
    pinned: NDArray[np.bool_]
    about: str


class Sheet:
    """A person's labels of one recording.

    Args:
        moments: the recording.

    Attributes:
        labels: the labels; change them by the methods only.
    """

    def __init__(self, moments: Moments) -> None:
        self.labels = Track.of_size(len(moments))
        self._moments = moments
        self._pinned = np.zeros(len(moments), bool)
        """A person has put a contact of this moment to its place."""
        self._done: list[_Change] = []
        self._undone: list[_Change] = []

    @property
    def can_undo(self) -> bool:
        """True if there is a change."""
        return bool(self._done)

    @property
    def can_redo(self) -> bool:
        """True if a change was undone last."""
        return bool(self._undone)

    def accept(self, first: int, last: int) -> str:
        """Labels moments as proposed; returns what was done.

        Raises:
            NeuroTouchError: there are no such moments.
        """
        self._begin(first, last, "Confirmed")
        self.labels.put(first, self._moments.proposals.part(first, last))
        return "Confirmed"

    def accept_rest(self) -> str:
        """Labels all moments that have no label as proposed."""
        last = len(self.labels.kind) - 1
        self._begin(0, last, "Confirmed all that was left")
        proposals = self._moments.proposals
        for run in list(self.labels.runs()):
            if run.kind == UNLABELLED:
                self.labels.put(run.first, proposals.part(run.first, run.last))
        return "Confirmed all that was left"

    def set_kind(self, first: int, last: int, kind: GestureKind) -> str:
        """Gives moments a type.

        Intensity and contacts are those of the label or the proposal. Where both know of no
        gesture, they are those of the dot that is displaced most.

        Raises:
            NeuroTouchError: there are no such moments.
        """
        about = "No gesture" if kind is GestureKind.NONE else kind.label
        self._begin(first, last, about)
        for k in range(first, last + 1):
            if kind is GestureKind.NONE:
                self.labels.set(k, kind, 0.0, np.zeros((0, 2)))
            else:
                self.labels.set(k, kind, *self._guess(k))
        return about

    def clear(self, first: int, last: int) -> str:
        """Takes the labels of moments away.

        Raises:
            NeuroTouchError: there are no such moments.
        """
        self._begin(first, last, "Removed")
        self.labels.put(first, Track.of_size(last - first + 1))
        return "Removed"

    def move_contact(self, k: int, index: int, x_px: float, y_px: float) -> str:
        """Moves a contact of a moment, and with it the same contact of its gesture.

        The contact is moved as far everywhere in the gesture; but where a person has put contacts
        of another moment to their place, those stay, and between two such moments the shift changes
        evenly. A moment without a label is confirmed with its gesture first.

        Raises:
            NeuroTouchError: there is no such contact.
        """
        if not 0 <= index < self._count_shown(k):
            raise NeuroTouchError("There is no such contact.")
        run = self._begin_run(k, f"Contact {index + 1} moved")
        points = self.labels.contacts_px
        shift = np.array([x_px, y_px], np.float32) - points[k, index]
        share = self._measure_shares(run, k)
        self.labels.contacts_px[k, index] += shift
        for direction, end in ((-1, run.first - 1), (1, run.last + 1)):
            before = points[k, index] - shift
            for j in range(k + direction, end, direction):
                n = int(self.labels.counts[j])
                if not n:
                    break
                nearest = int(np.argmin(((points[j, :n] - before) ** 2).sum(axis=1)))
                before = points[j, nearest].copy()
                points[j, nearest] += share[j - run.first] * shift
        self._pinned[k] = True
        return f"Contact {index + 1} moved"

    def add_contact(self, k: int, x_px: float, y_px: float) -> str:
        """Adds a contact to a gesture, at all its moments with as many contacts as this one.

        Raises:
            NeuroTouchError: it has three already, or no gesture is labelled or proposed there.
        """
        n = self._count_shown(k)
        if n == MAX_CONTACTS:
            raise NeuroTouchError(f"A gesture has at most {MAX_CONTACTS} contacts.")
        if not n:
            raise NeuroTouchError("Here is no gesture. Choose its type first.")
        run = self._begin_run(k, "Contact added")
        for j in range(run.first, run.last + 1):
            if self.labels.counts[j] == n:
                self.labels.contacts_px[j, n] = x_px, y_px
        return "Contact added"

    def remove_contact(self, k: int, index: int) -> str:
        """Removes a contact of a gesture, at all its moments with as many contacts as this one.

        Raises:
            NeuroTouchError: there is no such contact, or it is the last one.
        """
        n = self._count_shown(k)
        if not 0 <= index < n:
            raise NeuroTouchError("There is no such contact.")
        if n == 1:
            raise NeuroTouchError("A gesture has a contact. If there is none, choose No gesture.")
        run = self._begin_run(k, "Contact removed")
        place = self.labels.contacts_px[k, index].copy()
        for j in range(run.first, run.last + 1):
            if self.labels.counts[j] != n:
                continue
            points = self.labels.points(j)
            nearest = int(np.argmin(((points - place) ** 2).sum(axis=1)))
            self.labels.contacts_px[j] = np.nan
            self.labels.contacts_px[j, : n - 1] = np.delete(points, nearest, axis=0)
        return "Contact removed"

    def undo(self) -> str:
        """Takes the last change back; returns what it was.

        Raises:
            NeuroTouchError: there is none.
        """
        return f"Undone: {self._swap('undo', self._done, self._undone)}"

    def redo(self) -> str:
        """Makes the change again that was undone last; returns what it was.

        Raises:
            NeuroTouchError: there is none.
        """
        return f"Done again: {self._swap('redo', self._undone, self._done)}"

    def _swap(self, verb: str, source: list[_Change], target: list[_Change]) -> str:
        if not source:
            raise NeuroTouchError(f"There is nothing to {verb}.")
        change = source.pop()
        last = change.first + len(change.before.kind) - 1
        target.append(self._note(change.first, last, change.about))
        self.labels.put(change.first, change.before)
        self._pinned[change.first : last + 1] = change.pinned
        return change.about

    def _begin(self, first: int, last: int, about: str) -> None:
        if not 0 <= first <= last < len(self.labels.kind):
            raise NeuroTouchError("There is no such moment.")
        self._done.append(self._note(first, last, about))
        del self._done[:-_MOST_CHANGES]
        self._undone.clear()
        self._pinned[first : last + 1] = False

    def _note(self, first: int, last: int, about: str) -> _Change:
        pinned = self._pinned[first : last + 1].copy()
        return _Change(first, self.labels.part(first, last), pinned, about)

    def _count_shown(self, k: int) -> int:
        """Returns the number of contacts of a moment: those of its label, or those proposed.

        Raises:
            NeuroTouchError: there is no such moment.
        """
        if not 0 <= k < len(self.labels.kind):
            raise NeuroTouchError("There is no such moment.")
        is_labelled = self.labels.kind[k] != UNLABELLED
        track = self.labels if is_labelled else self._moments.proposals
        return int(track.counts[k])

    def _begin_run(self, k: int, about: str) -> Run:
        """Begins a change of the whole gesture around a moment, confirming it if need be."""
        if self.labels.kind[k] == UNLABELLED:
            proposed = self._moments.proposals.run_at(k)
            free = self.labels.run_at(k)
            first, last = max(proposed.first, free.first), min(proposed.last, free.last)
            self._begin(first, last, about)
            self.labels.put(first, self._moments.proposals.part(first, last))
            return Run(first, last, proposed.kind)
        run = self.labels.run_at(k)
        pinned = self._pinned[run.first : run.last + 1].copy()
        self._begin(run.first, run.last, about)
        self._pinned[run.first : run.last + 1] = pinned
        return run

    def _guess(self, k: int) -> tuple[float, NDArray[np.float64]]:
        for track in (self.labels, self._moments.proposals):
            if is_gesture(int(track.kind[k])):
                return float(track.intensity_mm[k]), track.points(k)
        place = self._moments.peak_px[k].astype(np.float64)
        return float(self._moments.peak_mm[k]), place.reshape(1, 2)

    def _measure_shares(self, run: Run, k: int) -> NDArray[np.float32]:
        """Returns for each moment of a run how much of a shift at ``k`` it takes, 0 to 1."""
        share = np.ones(run.last - run.first + 1, np.float32)
        pins = run.first + np.flatnonzero(self._pinned[run.first : run.last + 1])
        before, after = pins[pins < k], pins[pins > k]
        if len(before):
            pin = int(before[-1])
            share[: pin - run.first + 1] = 0.0
            share[pin - run.first : k - run.first + 1] = np.linspace(0.0, 1.0, k - pin + 1)
        if len(after):
            pin = int(after[0])
            share[pin - run.first :] = 0.0
            share[k - run.first : pin - run.first + 1] = np.linspace(1.0, 0.0, pin - k + 1)
        return share
