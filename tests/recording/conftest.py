from pathlib import Path

import pytest

SAMPLE = Path(__file__).parents[3] / "shared" / "data" / "davis346-sample.aedat4"


@pytest.fixture
def sample() -> Path:
    if not SAMPLE.exists():
        pytest.skip("the real camera's file ../shared/data/davis346-sample.aedat4 is not here")
    return SAMPLE
