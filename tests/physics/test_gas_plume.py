"""A plume against the similarity of Morton, Taylor and Turner: exponents, and the entrainment that a coarse box misses."""

from __future__ import annotations

import pytest
from worldagent.bench.gas_plume import plume


@pytest.mark.slow
def test_a_plume_widens_and_slows_with_its_height_and_carries_its_buoyancy() -> None:
    """32 cells a metre: exponents 1 and -1/3 within 0.1. Declared miss: alpha is 0.07, published 0.08 to 0.14, since at six cells across the
    eddies that entrain are not resolved near the source."""
    found = plume(32, 6.0, 2.5)
    assert found.width == pytest.approx(1.0, abs=0.1)
    assert found.speed == pytest.approx(-1.0 / 3.0, abs=0.1)
    assert found.buoyancy == pytest.approx(1.0, abs=0.1)
    assert 0.05 < found.entrainment < 0.08
