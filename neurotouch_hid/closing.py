"""Makes an object with ``close`` a context manager."""

from typing import Self


class Closing:
    """Base of every object that holds something which must be released."""

    def close(self) -> None:
        """Releases what the object holds; harmless when repeated."""
        raise TypeError(f"{type(self).__name__} does not say how it is closed")

    def __enter__(self) -> Self:
        """Returns the object itself."""
        return self

    def __exit__(self, *_: object) -> None:
        """Closes the object, whatever has happened."""
        self.close()
