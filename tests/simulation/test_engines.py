"""Rules that hold for every engine: it writes what is declared, goes on from its checkpoints to the byte, and refuses other bytes."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, get_args

import numpy as np
import pytest
from worldagent.simulation.engines import ENGINES, solver_class
from worldagent.simulation.runs import Run, make_run
from worldagent.simulation.schedule import run_frames
from worldagent.simulation.sealed import Stamp, seal, to_bytes, unseal
from worldagent.tests.physics import rigid_world
from worldagent.tests.simulation.engine_worlds import WORLDS, built_world
from worldagent.worlds.bake_plan import groups_of
from worldagent.worlds.built import BuiltEntity
from worldagent.worlds.cache import Cache, digest_arrays
from worldagent.worlds.channels import CHANNELS, names_written
from worldagent.worlds.errors import EngineError
from worldagent.worlds.spec import SolverInstance, WorldSpec
from worldagent.worlds.writers import writers_of

FREE_FALL = (
    "8f56c80ddbdbad1d606773234e6271ff4ba9fa2320adc5ed88e27bdd9bf9a85a",
    "978f2f39bf4b73adc987639f77315c1106cda4e377432992c33318c91efc3e3f",
    "25bab6b0e41bf2b2ab7e14b46e25683e03d36427e6ea1d81f9e99055bee8dd78",
)
"""Digests of the frames of a ball in free fall, as written since impacts are recorded one by one (channels `impact/*`)."""


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


def test_every_engine_that_an_instance_can_name_has_one_solver_and_a_world() -> None:
    models = get_args(get_args(SolverInstance)[0])
    named = [e for m in models for e in get_args(m.model_fields["engine"].annotation)]
    assert sorted(named) == sorted(ENGINES)
    specs = [make() for make in WORLDS.values()]
    assert {i.engine for s in specs for i in s.simulation.solvers.values()} == set(ENGINES)
    for spec in specs:
        for name, instance in spec.simulation.solvers.items():
            assert solver_class(spec, name).__name__ == ENGINES[instance.engine][1]


def test_the_worlds_have_every_writer_that_is_an_instance() -> None:
    specs = [make() for make in WORLDS.values()]
    found = {w for s in specs for n in s.simulation.solvers for w in writers_of(s, n)}
    assert found == {w for c in CHANNELS.values() for w in c.of} - {"surface", "surface heat", "wet"}


def test_every_declared_channel_is_written_and_every_written_one_declared(baked: Baked) -> None:
    assert set(baked.caches) == set(baked.spec.simulation.solvers)
    for name, cache in baked.caches.items():
        for frame in range(cache.index.frames):
            data = cache.read(frame)
            assert set(data) == names_written(writers_of(baked.spec, name))
            for channel, values in data.items():
                assert CHANNELS[channel].sign != "+" or np.min(values, initial=0.0) >= 0.0, channel


LAST = 3
"""Frame to which runs go that are continued from the frame before."""


@dataclass(frozen=True)
class Continued:
    """Groups of a world as they stand at the last frame, and their checkpoints of the frame before."""

    baked: Baked
    runs: Mapping[tuple[str, ...], Run]
    states: Mapping[str, bytes]

    def fresh(self, names: tuple[str, ...]) -> Run:
        """A run of a group to restore a checkpoint into."""
        run = make_run(self.baked.spec, self.baked.built, names, caches=self.baked.caches)
        run.prepare(resumed=True)
        return run


@pytest.fixture(scope="module")
def continued(baked: Baked) -> Continued:
    runs, states = {}, {}
    for names in groups_of(baked.spec):
        run = make_run(baked.spec, baked.built, names, caches=baked.caches)
        run.prepare()
        for frame in range(1, LAST):
            run.advance(frame)
        states |= {n: s.checkpoint() for n, s in run.solvers.items()}
        run.advance(LAST)
        runs[names] = run
    return Continued(baked, runs, states)


def test_a_run_goes_on_from_its_checkpoint_to_the_byte(continued: Continued) -> None:
    assert {n for names in continued.runs for n in names} == set(continued.states)
    for names, whole in continued.runs.items():
        rest = continued.fresh(names)
        rest.restore(continued.states, LAST - 1)
        rest.advance(LAST)
        for name in names:
            one, two = whole.solvers[name], rest.solvers[name]
            assert digest_arrays(one.frame_data()) == digest_arrays(two.frame_data()), name
            assert one.index() == two.index()
            assert one.checkpoint() == two.checkpoint(), name


def _resealed(
    state: bytes, stamp: Stamp, *, ledger: dict[str, Any] | None = None, held: bytes | None = None, **other: Any
) -> bytes:
    """The checkpoint with another stamp, ledger or state, under a seal that fits."""
    sums, arrays = unseal(stamp, state)
    return seal(dataclasses.replace(stamp, **other), sums if ledger is None else ledger, arrays if held is None else held)


OTHERS: dict[str, tuple[Callable[[bytes, Stamp], bytes], str]] = {
    "nothing": (lambda state, stamp: b"", "no checkpoint of this version"),
    "one of an earlier version": (lambda state, stamp: b"WARS3" + state[5:], "no checkpoint of this version"),
    "one cut short": (lambda state, stamp: state[: len(state) // 2], "damaged"),
    "one with a flipped bit": (lambda state, stamp: state[:-1] + bytes([state[-1] ^ 1]), "damaged"),
    "one of another engine": (lambda state, stamp: _resealed(state, stamp, engine="other"), "engine='other'"),
    "one of another instance": (lambda state, stamp: _resealed(state, stamp, instance="x"), "instance='x'"),
    "one of another frame": (lambda state, stamp: _resealed(state, stamp, frame=9), "frame=9"),
    "one with other sums": (lambda state, stamp: _resealed(state, stamp, ledger={}), "is not of"),
    "one with other bytes": (lambda state, stamp: _resealed(state, stamp, held=bytes(800)), "bake again"),
    "one with other arrays": (lambda state, stamp: _resealed(state, stamp, held=to_bytes({"x": np.zeros((1, 3))})), "bake again"),
}


@pytest.mark.parametrize("kind", OTHERS)
def test_a_checkpoint_that_is_not_its_own_is_refused(kind: str, continued: Continued) -> None:
    change, told = OTHERS[kind]
    assert continued.runs
    for names in continued.runs:
        for name, solver in continued.fresh(names).solvers.items():
            stamp = Stamp(continued.baked.spec.simulation.solvers[name].engine, name, LAST - 1)
            with pytest.raises(EngineError, match=told):
                solver.restore(change(continued.states[name], stamp), LAST - 1)


def test_a_body_in_free_fall_is_written_to_the_same_bytes_as_ever(tmp_path: Path) -> None:
    """Choice: caches of an earlier version stay readable and comparable; nothing but arithmetic without rounding choices is in this run."""
    ball = rigid_world.ball(0.125, at=(0, 0, 4), v=(0.5, 0, 0))
    spec = rigid_world.world({"ball": ball}, seconds=2 / 24, gravity=(0, 0, -8.0), settings={"step": 1 / 960})
    built = {n: rigid_world.build_entity(spec, n, rigid_world.NO_ASSETS) for n in spec.entities}
    assert tuple(run_frames(spec, built, tmp_path, frames=3)["main"].digests()) == FREE_FALL
