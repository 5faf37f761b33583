"""What holds of every engine: it writes what is declared, goes on from its checkpoints to the byte, and refuses other bytes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from worldagent.simulation.schedule import run_frames
from worldagent.tests.physics import rigid_world
from worldagent.tests.simulation.engine_worlds import WORLDS, built_world
from worldagent.worlds.built import BuiltEntity
from worldagent.worlds.cache import Cache
from worldagent.worlds.channels import CHANNELS, names_written
from worldagent.worlds.spec import WorldSpec
from worldagent.worlds.writers import writers_of

FREE_FALL = (
    "2e706bd573abf3fa674795a1346f2b74b27786fb91c9a67209509a770709defc",
    "679e29f9684894f0b90b00a0e79c621e4e50d5aee9302f84eab2be0c42438e5e",
    "660e4fbdb6e18fadad016474dcdb9f8e4a56443bc80a48cad18a706c3efb9a45",
)
"""Digests of the frames of a ball in free fall, as written before channels were declared in one place."""


@dataclass(frozen=True)
class Baked:
    """A world of the table, simulated."""

    spec: WorldSpec
    built: Mapping[str, BuiltEntity]
    caches: Mapping[str, Cache]


@pytest.fixture(scope="module", params=WORLDS)
def baked(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Baked:
    spec, built = built_world(request.param)
    return Baked(spec, built, run_frames(spec, built, tmp_path_factory.mktemp("run"), frames=spec.simulation.frames))


def test_the_worlds_have_every_writer_that_is_an_instance() -> None:
    specs = [make() for make in WORLDS.values()]
    found = {w for s in specs for n in s.simulation.solvers for w in writers_of(s, n)}
    assert found == {w for c in CHANNELS.values() for w in c.of} - {"surface", "surface heat", "wet"}


def test_every_declared_channel_is_written_and_every_written_one_declared(baked: Baked) -> None:
    for name, cache in baked.caches.items():
        for frame in range(cache.index.frames):
            data = cache.read(frame)
            assert set(data) == names_written(writers_of(baked.spec, name))
            for channel, values in data.items():
                assert CHANNELS[channel].sign != "+" or np.min(values, initial=0.0) >= 0.0, channel


def test_a_body_in_free_fall_is_written_to_the_same_bytes_as_ever(tmp_path: Path) -> None:
    """Choice: caches of an earlier version stay readable and comparable; nothing but arithmetic without rounding choices is in this run."""
    ball = rigid_world.ball(0.125, at=(0, 0, 4), v=(0.5, 0, 0))
    spec = rigid_world.world({"ball": ball}, seconds=2 / 24, gravity=(0, 0, -8.0), settings={"step": 1 / 960})
    built = {n: rigid_world.build_entity(spec, n, rigid_world.NO_ASSETS) for n in spec.entities}
    assert tuple(run_frames(spec, built, tmp_path, frames=3)["main"].digests()) == FREE_FALL
