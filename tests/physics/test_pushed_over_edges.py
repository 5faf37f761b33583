"""A thing that pushes another over an edge: whether it stops before it or drops after it, by the way that friction takes."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from worldagent.tests.physics import rigid_world
from worldagent.tests.physics.fracture_world import simulate

MATTER = {"wood": {"density": 600.0, "friction": 0.4}}
HALF = 0.05
"""Half of the edge of both blocks [m]."""


def heights(folder: Path, speed: float) -> tuple[float, float]:
    """Heights at the end of a block that slides at a speed when the one before it leaves the shelf, and of that one [m].

    The shelf ends at x = 0; both slide in touch from the start, where the middle of the first is 20 mm before the edge.
    """
    start = math.sqrt(speed**2 + 2 * 0.4 * 9.81 * 0.02)
    one, two = (
        rigid_world.box(2 * HALF, 2 * HALF, 2 * HALF, at=(x, 0, 1.0 + HALF + 0.0011), v=(start, 0, 0), material="wood")
        for x in (-0.02, -0.02 - 2 * HALF - 0.0011)
    )
    shelf = rigid_world.box(2.0, 0.4, 0.05, at=(-1.0, 0, 0.975), motion="static", material="wood")
    entities = {"floor": rigid_world.floor(material="wood"), "shelf": shelf, "pushed": one, "pusher": two}
    candidate = simulate(folder, rigid_world.world(entities, seconds=1.0, materials=MATTER, settings={"step": 5e-4}))
    last = candidate.last_frame
    return float(candidate.center("pusher", last)[2]), float(candidate.center("pushed", last)[2])


@pytest.mark.parametrize(("speed", "drops"), [(0.6, False), (1.2, True)])
def test_a_pusher_drops_after_what_it_pushed_where_its_way_is_longer_than_its_room(
    tmp_path: Path, speed: float, drops: bool
) -> None:
    """At 0.6 m/s it slides 46 mm on, and its middle is 100 mm from the edge; at 1.2 m/s it would slide 183 mm."""
    way = speed**2 / (2 * 0.4 * 9.81)
    assert (way > 2 * HALF) == drops
    pusher, pushed = heights(tmp_path, speed)
    assert pushed < 0.5, "the pushed one falls"
    assert (pusher < 0.5) == drops
