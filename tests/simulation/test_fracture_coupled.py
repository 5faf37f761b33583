"""A plank over a tank: bonded to the world at one end, broken off by a ball, its pieces float (both ways coupled)."""

from __future__ import annotations

import dataclasses
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.construction.build import build_entity
from worldagent.simulation.probe import replay
from worldagent.simulation.schedule import run_frames
from worldagent.testing.worlds.small_liquids import PROMPT, tank_spec
from worldagent.verifiers.categories.fracture import check as fracture
from worldagent.verifiers.categories.rigid import check as rigid
from worldagent.verifiers.categories.rigid import laws as rigid_laws
from worldagent.verifiers.ledgers.balance import books_of
from worldagent.worlds.cache import Cache, write_container
from worldagent.worlds.candidate import Candidate, cache_digest
from worldagent.worlds.patch import parse_spec

FRAMES = 20
SIZE = [0.32, 0.1, 0.04]
TENSION = 1e5

pytestmark = pytest.mark.slow


def plank_spec() -> dict[str, Any]:
    spec = tank_spec(spacing=0.04, frames=FRAMES, crate_at=None)
    spec["materials"]["iron"] = {"density": 7200, "friction": 0.4}
    spec["entities"]["plank"] = {
        "role": "plank",
        "motion": "dynamic",
        "material": "wood",
        "dimensions": {"size": SIZE},
        "pose": {"position": [-0.03, 0, 0.26]},
        "parts": {"body": {"shape": {"kind": "box", "size": SIZE}}},
        "breakable": {
            "pattern": {"kind": "bricks", "size": [0.08, 0.1, 0.04], "joint": 0.0},
            "bond": {"tension": TENSION, "shear": 2 * TENSION},
            "fixed": ["x-"],
        },
    }
    spec["entities"]["ball"] = {
        "role": "ball",
        "motion": "dynamic",
        "material": "iron",
        "dimensions": {"size": [0.06] * 3},
        "pose": {"position": [0.08, 0, 0.32]},
        "parts": {"body": {"shape": {"kind": "sphere", "radius": 0.03}}},
        "physics": {"category": "rigid", "linear_velocity": [0, 0, -2.0]},
    }
    spec["simulation"]["solvers"]["rigid"]["members"] = ["tank", "plank", "ball"]
    return {**spec, "prompt": PROMPT}


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Candidate:
    folder = tmp_path_factory.mktemp("plank")
    spec = parse_spec(plank_spec())
    built = {n: build_entity(spec, n, Path()) for n in spec.entities}
    caches = run_frames(spec, built, folder / "run", frames=FRAMES)
    return Candidate(folder, spec, built, "full", caches, "run", cache_digest(caches))


def _series(cache: Cache, name: str) -> Any:
    return np.array([cache.read(k, (name,))[name] for k in range(FRAMES)])


def test_some_bonds_break_and_the_loose_pieces_float(run: Candidate) -> None:
    cache = run.caches["rigid"]
    broken = cache.read(FRAMES - 1, ("bond/broken",))["bond/broken"]
    assert 0 < broken.sum() < len(broken)
    height = _series(cache, "position")[:, :4, 2]
    loose = np.flatnonzero(height[-1] < height[0] - 0.02)
    assert 2 <= len(loose) < 4, "the root stays at its wall"
    weight = 0.08 * 0.1 * 0.04 * 500 * 9.81 * len(loose) / 24
    carried = _series(cache, "exchange/impulse")[-8:, loose, 2].sum(axis=1).mean()
    assert carried == pytest.approx(weight, rel=0.5), "water carries them"
    assert (height[-1][loose] > 0.1).all()


def test_what_the_water_gave_each_piece_is_what_the_engine_integrated(run: Candidate) -> None:
    """Law: action and reaction, counted apart, to 1e-4; and the momentum of all changes by nothing else and weight."""
    cache, water = run.caches["rigid"], run.caches["water"]
    rows = [water.index.colliders.index(name) for name in cache.index.bodies]
    received, given = _series(cache, "exchange/impulse"), _series(water, "exchange/impulse")
    scale = np.abs(received[..., :3]).max()
    assert scale > 0.1
    assert np.abs(received - given[:, rows]).max() < 1e-4 * scale
    assert np.abs((given + _series(water, "exchange/reaction")).sum(axis=1)[:, :3]).max() < 1e-4 * scale
    momentum = np.stack([_series(cache, f"record/momentum_{axis}") for axis in "xyz"], axis=1)
    mass = float(cache.read(0)["record/mass"]) - run.built["plank"].bodies[0].mass  # the root is held
    tank = cache.index.colliders.index("tank")
    free = [k for k in range(2, FRAMES) if not (cache.read(k)["contact/pair"] == tank).any()]
    assert len(free) >= 4
    for k in free:
        change = momentum[k] - momentum[k - 1] - received[k, :, :3].sum(axis=0)
        assert change == pytest.approx([0, 0, -9.81 * mass / 24], abs=1e-4 * scale)


def test_checks_of_bonds_and_books_pass_over_the_fall(run: Candidate) -> None:
    rows = {r.id: r.status for r in (*fracture.category_rows(run, "rigid"), *rigid.category_rows(run, "rigid"))}
    names = [f"category:fracture:{n}:plank" for n in ("pieces", "bonded", "events", "cause", "standing")]
    names += [f"category:rigid:{n}:rigid" for n in ("mass", "energy", "momentum", "motion", "spin", "records", "contacts")]
    assert {rows[n] for n in names} == {"pass"}


def test_intervals_replay_from_their_checkpoints_by_the_byte(run: Candidate) -> None:
    results = replay(run, intervals=2, seed=1)
    assert {r["solver"] for r in results} == {"rigid", "water"}
    assert all(r["identical"] for r in results), results


def _lifted(run: Candidate, folder: Path, *, told: bool) -> Candidate:
    """The run, with its root asleep where it stood as if on a shelf, while something lifts a loose piece by the weight of the whole
    plank; `told` where water says that it did."""
    cache, frame = run.caches["rigid"], FRAMES - 3
    rows = [cache.body_row("plank", b.name) for b in run.entity("plank").bodies]
    mass = np.array([b.mass for b in run.entity("plank").bodies])
    root, loose = rows[0], rows[-1]
    given = cache.read(frame)["exchange/impulse"][rows, 2].sum()
    impulse = mass.sum() * 9.81 / run.spec.simulation.fps - given
    shutil.copytree(cache.folder, folder / "run" / "rigid")
    other = Cache(folder / "run" / "rigid")
    for k in range(FRAMES):
        data = other.read(k)
        data["bond/broken"][:] = 1
        data["asleep"][root] = 1
        if k >= frame:
            data["velocity"][loose, 2] += impulse / mass[-1]
        if told and k == frame:
            data["exchange/impulse"][loose, 2] += impulse
        write_container(other.path(k), data)
    return dataclasses.replace(run, folder=folder, caches={**run.caches, "rigid": other})


def test_water_that_lifts_some_pieces_does_not_hide_what_others_sleep_on(run: Candidate, tmp_path: Path) -> None:
    """It may carry some with as much as what others lie on bears of those: nothing is left of what is known to push them together."""
    lifted = _lifted(run, tmp_path, told=True)
    row = rigid_laws.momentum(books_of(lifted, lifted.caches["rigid"]))
    assert row.status == "pass", row.evidence


def test_a_lift_that_no_water_gave_is_found_and_names_the_piece(run: Candidate, tmp_path: Path) -> None:
    lifted = _lifted(run, tmp_path, told=False)
    row = rigid_laws.momentum(books_of(lifted, lifted.caches["rigid"]))
    assert (row.status, row.entity) == ("fail", "plank")
    assert str((row.evidence or {})["body"]).startswith("plank/")
