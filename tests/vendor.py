"""The camera maker's own library, which needs a C library that few small systems have."""

import os

import pytest

if os.environ.get("NEUROTOUCH_REQUIRE_UMOCKDEV") == "1":  # where nothing may be skipped
    import dv_processing as dv
else:
    dv = pytest.importorskip(
        "dv_processing",
        reason="dv-processing needs libatomic (Debian: apt install libatomic1)",
        exc_type=ImportError,
    )

__all__ = ["dv"]
