"""Points spread over a box measure what solids that stand along its sides take of it."""

from __future__ import annotations

import numpy as np
import pytest
from worldagent.verifiers.categories.liquid.samples import spread


@pytest.mark.parametrize("seed", range(4))
def test_the_share_of_boxes_along_the_sides_is_theirs(seed: int) -> None:
    """A grid of as many points errs by up to 1 % there, as much as the start of a liquid may."""
    rng = np.random.default_rng(seed)
    low, size = np.array([-0.3, 0.1, 2.0]), np.array([0.4, 0.25, 0.12])
    points = spread(low, low + size, 100_000)
    assert ((points > low) & (points < low + size)).all()
    for _ in range(25):
        start = rng.uniform(0.0, 0.6, 3)
        end = start + rng.uniform(0.1, 0.4, 3)
        place = (points - low) / size
        share = float(((place > start) & (place < end)).all(axis=1).mean())
        assert share == pytest.approx(np.prod(end - start), abs=4e-4)
