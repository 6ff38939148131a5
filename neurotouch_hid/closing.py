"""Makes an object with ``close`` a context manager."""

from typing import Self


class Closing:
    """Base class of every object with something to release."""

    def close(self) -> None:
        """Releases the object's resources; a second call does nothing."""
        raise TypeError(f"{type(self).__name__} does not say how it is closed")

    def __enter__(self) -> Self:
        """Returns the object itself."""
        return self

    def __exit__(self, *_: object) -> None:
        """Closes the object, even after an error."""
        self.close()
