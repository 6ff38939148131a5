"""Judges whether what was read can be a camera's stream, or is out of step."""

from typing import Final

from neurotouch_hid.errors import CameraError

MAX_SHARE: Final = 0.001
"""Share of words with an impossible meaning that is tolerated for ever. Of a stream that lacks one
byte, every word is made of halves of two, and 0.6 % of them are impossible at the very least."""
MAX_IMPOSSIBLE: Final = 32
"""Impossible words beyond that share: so many are no stray ones. A camera that sees nothing sends
as many in a second if its stream lacks a byte, and any other in a few milliseconds."""
MAX_JUMP_US: Final = 1_000_000
"""The camera's clock may gain so much on the host's at once. Words out of step make it jump by a
minute each."""


class OutOfStepError(CameraError):
    """The stream makes no sense: bytes of it are missing or wrong."""


class StreamCheck:
    """Compares the impossible words with all words, and the camera's clock with the host's.

    The words are counted as a cumulative sum, so stray ones are forgotten.

    Args:
        clock_us: the camera's clock.
        host_s: the host's, at the same time.
    """

    def __init__(self, clock_us: int, host_s: float) -> None:
        self._lead_us = clock_us - 1e6 * host_s
        self._n_impossible = 0
        self._doubt = 0.0

    def check(self, n_words: int, n_impossible: int, clock_us: int, host_s: float) -> None:
        """Takes what has just been decoded.

        Args:
            n_words: words in it.
            n_impossible: impossible words since the start.
            clock_us: the camera's clock at its last word.
            host_s: the host's.

        Raises:
            OutOfStepError: it is no camera's stream.
        """
        # The camera's clock lags while data waits, so it is compared with its greatest lead.
        gained_us = clock_us - 1e6 * host_s - self._lead_us
        if gained_us > MAX_JUMP_US:
            raise OutOfStepError(
                f"The camera's clock jumped ahead by {1e-6 * gained_us:.0f} s, so its data is out "
                "of step; the camera is started again."
            )
        self._lead_us += max(0.0, gained_us)
        n_new, self._n_impossible = n_impossible - self._n_impossible, n_impossible
        self._doubt = max(0.0, self._doubt + n_new - MAX_SHARE * n_words)
        if self._doubt >= MAX_IMPOSSIBLE:
            raise OutOfStepError(
                "The camera's data makes no sense, so bytes of it are missing or wrong; the camera "
                "is started again."
            )
