"""Balls that roll and bounce down stairs, as the skill of rigid bodies tells: times, level speeds and how high they bounce at the foot."""

from __future__ import annotations

import numpy as np
import pytest
from worldagent.testing.defects._films import film_of
from worldagent.testing.worlds.small_worlds import ball, entity, pose, world
from worldagent.worlds.spec import Box, Material, Part, RigidPhysics, RigidSettings

RISE, RUN, STEPS = 0.17, 0.28, 6
FPS, FRAMES = 24, 120


def _stairs() -> list[Part]:
    """A landing, treads and a floor, each a slab whose top is a rise below the one before."""
    found = []
    for k in range(STEPS + 1):
        wide = RUN if 0 < k < STEPS else 3.0
        middle = (k - 0.5) * RUN if 0 < k < STEPS else (-1.5 if k == 0 else (STEPS - 1) * RUN + 1.5)
        found.append(Part(shape=Box(size=(wide, 1.5, 0.2)), pose=pose((middle, 0.0, -k * RISE - 0.1))))
    return found


@pytest.mark.parametrize(
    ("radius", "density", "restitution", "speed", "seconds", "level", "bounce"),
    [
        (0.12, 83.0, 0.8, 1.0, (1.4, 2.1), (0.7, 1.5), (0.5, 0.75)),
        (0.05, 600.0, 0.5, 1.5, (1.1, 1.5), (0.7, 1.6), (0.02, 0.08)),
        (0.05, 600.0, 0.5, 0.3, (3.0, 4.6), (0.5, 0.8), (0.02, 0.08)),
        (0.1, 300.0, 0.2, 1.0, (1.6, 2.2), (0.7, 1.3), (0.0, 0.08)),
    ],
)
def test_a_ball_goes_down_stairs_as_the_skill_says(
    radius: float,
    density: float,
    restitution: float,
    speed: float,
    seconds: tuple[float, float],
    level: tuple[float, float],
    bounce: tuple[float, float],
) -> None:
    thing = ball(radius, motion="dynamic", at=(-0.5, 0.0, radius + 0.0011), material="ball")
    rolling = RigidPhysics(linear_velocity=(speed, 0.0, 0.0), angular_velocity=(0.0, speed / radius, 0.0))
    surface = {"friction": 0.5, "restitution": restitution}
    film = film_of(
        world(
            {"stairs": entity(*_stairs(), material="stone"), "ball": thing.model_copy(update={"physics": rolling})},
            frames=FRAMES,
            settings=RigidSettings(step=2e-4),
            materials={"stone": Material(density=2500.0, **surface), "ball": Material(density=density, **surface)},
        )
    )
    row = next(k for k, name in enumerate(film.index.bodies) if name.startswith("ball"))
    place = np.array([frame["position"][row] for frame in film.frames])
    foot = int(np.argmax(place[:, 0] > (STEPS - 1) * RUN))
    assert seconds[0] < foot / FPS < seconds[1]
    gone = (place[min(foot + 6, FRAMES - 1), 0] - place[foot, 0]) / (min(foot + 6, FRAMES - 1) - foot) * FPS
    assert level[0] < gone < level[1]
    landed = foot + int(np.argmin(place[foot : foot + 12, 2]))
    high = place[landed : landed + FPS, 2].max() + STEPS * RISE - radius
    assert bounce[0] <= high < bounce[1]
