"""A soft gel with printed dots, seen by an event camera, becomes a standard game controller."""

import os

__version__ = "0.1.0"

# numba reads it when it is imported, by whichever module of ours that may be.
os.environ.setdefault(
    "NUMBA_CACHE_LOCATOR_CLASSES",
    ",".join(
        f"{__name__}.process.kernel_cache.{place}" for place in ("Chosen", "Beside", "Personal")
    ),
)
