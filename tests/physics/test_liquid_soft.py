"""The particle engine beside surfaces that deform: momentum of both, what held ones feel, equal bytes; and jellies that float."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import trimesh
from worldagent.construction.build import build_entity
from worldagent.simulation.boundaries import Boundary
from worldagent.simulation.liquid.dfsph import Dfsph, DfsphSettings
from worldagent.simulation.runs import make_run
from worldagent.testing.worlds.small_liquids import PROMPT, jelly_tank_spec, tank_spec
from worldagent.testing.worlds.small_soft import HAMMOCK_PROMPT, HIGH, hammock_spec
from worldagent.tests.physics.liquid_column import G, bodies, liquid, momentum
from worldagent.worlds.bake_plan import groups_of
from worldagent.worlds.built import TriangleMesh
from worldagent.worlds.patch import parse_spec


class Shell:
    """A cube whose vertices carry its mass and move by what they get alone; `light` 0: held."""

    def __init__(self, side, middle, mass, *, held=False):
        made = trimesh.creation.box((side,) * 3).subdivide().subdivide()
        self.boundary = Boundary(
            "jelly/body",
            TriangleMesh(np.array(made.vertices) + middle, np.array(made.faces, dtype=np.int32)),
            "dynamic",
            deforming=True,
        )
        self.x = self.boundary.mesh.vertices.copy()
        self.v = np.zeros_like(self.x)
        self.mass = np.full(len(self.x), mass / len(self.x))
        self.light = np.zeros(len(self.x)) if held else 1.0 / self.mass

    def state(self):
        share = self.mass / self.mass.sum()
        found = bodies((share @ self.x, share @ self.v, 0.0, np.zeros((3, 3)), (0, 0, 0)))
        found.position = np.zeros((1, 3))
        found.vertices[0], found.vertex_lightness[0] = (self.x, self.v), self.light
        return found

    def take(self, report):
        """Move by what the step gave."""
        given = report.vertex_impulse[0]
        arm = self.x - self.mass @ self.x / self.mass.sum()
        assert np.allclose(given.sum(axis=0), report.impulse[0, :3], atol=1e-8)
        if self.light.any():
            assert np.allclose(np.cross(arm, given).sum(axis=0), report.impulse[0, 3:], atol=1e-9)
        self.v = self.v + self.light[:, None] * given
        self.x = self.x + report.dt * self.v


def drop(shell):
    """A cube of water that flies towards the shell."""
    setup = liquid(
        0.04, (0.16, 0.16, 0.16), (2, 2, 2), gravity=0.0, sides=("open",) * 6, velocity=lambda x: np.tile([1.0, 0.2, 0.0], (len(x), 1)),
        boundaries=(shell.boundary,),
    )  # fmt: skip
    return replace(setup, position=setup.position + np.array([0.8, 0.9, 0.95]))


@pytest.mark.parametrize("mass", [0.2, 8.0])
def test_water_that_hits_what_deforms_gives_it_the_momentum_that_it_loses(mass):
    """Law: momentum of both together stays to 1e-5 of what there is, lighter and heavier than the water; every step gives the vertices
    just the moment that the water loses. Angular momentum of water alone drifts by the second solve's ways: 2e-4."""
    shell = Shell(0.16, np.array([1.06, 1.0, 1.0]), mass)
    engine = Dfsph(drop(shell), DfsphSettings(max_step=2e-3))
    before, speed = momentum(engine), float(np.linalg.norm([1.0, 0.2]))
    scale = speed * engine.setup.volume.sum() * 1000.0
    while engine.time < 0.15:
        shell.take(engine.step(1.0, shell.state()))
    after = momentum(engine)
    own = shell.mass[:, None] * shell.v
    assert own.sum(axis=0)[0] > 0.02 * scale
    assert np.abs(after[0] + own.sum(axis=0) - before[0]).max() < 1e-5 * scale
    assert np.abs(after[1] + np.cross(shell.x, own).sum(axis=0) - before[1]).max() < 5e-4 * scale
    assert np.abs(shell.v).max() < 3.0


def test_equal_runs_beside_what_deforms_have_equal_bytes_and_continue_equally():
    """Law: what is remembered of the surface is in the checkpoint."""
    ends = []
    for resumed in (False, False, True):
        shell = Shell(0.16, np.array([1.06, 1.0, 1.0]), 2.0)
        engine = Dfsph(drop(shell), DfsphSettings(max_step=2e-3))
        for step in range(45):
            if resumed and step == 40:
                state, engine = engine.checkpoint(), Dfsph(engine.setup, engine.settings)
                engine.restore(state)
            shell.take(engine.step(1.0, shell.state()))
        ends.append((engine.checkpoint(), shell.v.tobytes()))
    assert np.abs(shell.v).max() > 0.1
    assert ends[0] == ends[1] == ends[2]


def test_a_held_surface_that_could_deform_feels_the_weight_of_what_it_displaces():
    """Box of six spacings: +-5 % at this resolution, as of a rigid one."""
    side, s, middle = 0.24, 0.04, np.array([0.28, 0.28, 0.24])
    shell = Shell(side, middle, 1.0, held=True)
    setup = liquid(
        s, (0.56, 0.56, 0.48), (0.56, 0.56, 0.8), keep=lambda x: (np.abs(x - middle) > side / 2).any(axis=1),
        boundaries=(shell.boundary,),
    )  # fmt: skip
    engine, reports = Dfsph(setup, DfsphSettings()), []
    while engine.time < 0.5:
        reports.append(engine.step(1.0, shell.state()))
    late = reports[len(reports) // 2 :]
    push = sum(r.impulse[0, 2] for r in late) / sum(r.dt for r in late)
    assert push == pytest.approx(1000.0 * G * side**3, rel=0.05)


def course(frames, **elastic):
    """Height of the crate's middle at every frame, and its exchange with the water."""
    plan = tank_spec(frames=frames)
    if elastic:
        plan["entities"]["crate"]["physics"] = {"category": "elastic", "poisson_ratio": 0.4, "damping": 0.003, **elastic}
    spec = parse_spec({**plan, "prompt": PROMPT})
    built = {n: build_entity(spec, n, Path()) for n in spec.entities}
    (group,) = groups_of(spec)
    run = make_run(spec, built, group)
    run.prepare()
    bodies_of, water = (run.solvers[n] for n in group)
    row, height = next(k for k, n in enumerate(water.index().colliders) if n.startswith("crate/")), []
    for k in range(1, frames):
        run.advance(k)
        found, told = bodies_of.frame_data(), water.frame_data()
        if elastic:
            height.append(found["vertex/position"][:, 2].mean())
            assert told["exchange/impulse"][row, :3] == pytest.approx(found["exchange/soft"][0, :3], abs=1e-12)
            assert told["exchange/impulse"][row] == pytest.approx(-told["exchange/reaction"][row], abs=1e-6)
        else:
            held = next(k for k, n in enumerate(bodies_of.index().bodies) if n.startswith("crate/"))
            height.append(found["position"][held, 2])
    return np.array(height)


@pytest.mark.slow
@pytest.mark.parametrize("young", [3e4, 1e6])
def test_a_jelly_bobs_like_a_crate_of_its_density(young):
    """Law: what deforms little moves as what does not; within a quarter of a spacing (25 mm) over a second. Measured: 2.2 mm."""
    rigid, soft = course(24), course(24, young_modulus=young, resolution=0.06)
    assert np.ptp(rigid[8:]) > 0.02
    assert np.abs(soft - rigid).max() < 0.25 * 0.025


@pytest.mark.slow
def test_a_resumed_run_beside_a_jelly_equals_an_unbroken_one():
    """Law: equal bytes of both instances."""
    spec = parse_spec({**jelly_tank_spec(frames=5, spacing=0.04, crate_at=0.245), "prompt": PROMPT})
    built = {n: build_entity(spec, n, Path()) for n in spec.entities}
    (group,) = groups_of(spec)
    whole, rest = (make_run(spec, built, group) for _ in range(2))
    whole.prepare()
    for k in (1, 2, 3):
        whole.advance(k)
    rest.prepare(resumed=True)
    rest.restore({n: s.checkpoint() for n, s in whole.solvers.items()}, 3)
    for run in (whole, rest):
        run.advance(4)
    assert np.abs(whole.solvers["rigid"].frame_data()["exchange/soft"]).max() > 0.01
    assert all(whole.solvers[n].checkpoint() == rest.solvers[n].checkpoint() for n in group)


def hung(frames, size, at, domain, *, spacing, sides=("open",) * 6, stiffness=6000.0):
    """A cloth between four posts and water, coupled; the run of both and what the cloth weighs."""
    spec = hammock_spec(frames=frames, edge=0.055, radius=None)
    spec["entities"]["cloth"]["physics"]["stretch_stiffness"] = stiffness
    for gone in ("jelly", "tray"):
        del spec["entities"][gone]
    spec["simulation"]["drivers"] = {}
    spec["simulation"]["solvers"]["bodies"]["members"] = ["ground", "posts"]
    spec["materials"]["water"] = {"density": 1000, "substance": "water"}
    spec["entities"]["water"] = {
        "role": "water", "motion": "dynamic", "material": "water", "dimensions": {"size": size}, "pose": {"position": at},
        "parts": {"body": {"shape": {"kind": "box", "size": size}}}, "physics": {"category": "liquid", "resolution": spacing},
    }  # fmt: skip
    settings = {"domain": {**domain, "sides": list(sides)}}
    spec["simulation"]["solvers"]["water"] = {"engine": "dfsph", "members": ["water"], "settings": settings}
    spec["simulation"]["couplings"]["wet"] = {
        "source": "cloth", "target": "water", "direction": "two_way", "variables": ["motion", "wrench"],
    }  # fmt: skip
    made = parse_spec({**spec, "prompt": HAMMOCK_PROMPT})
    built = {n: build_entity(made, n, Path()) for n in made.entities}
    (group,) = groups_of(made)
    run = make_run(made, built, group)
    run.prepare()
    return run, built["cloth"].bodies[0].mass


def energy(water, cloth):
    """Energy of water and cloth together [J]."""
    names = ("kinetic_energy", "potential_energy")
    found = sum(float(one[f"record/{n}"]) for one in (water, cloth) for n in names)
    return found + float(cloth["record/stretch_energy"]) + float(cloth["record/bending_energy"])


@pytest.mark.slow
def test_a_cloth_catches_water_and_its_pins_carry_both():
    """Law: what the pins give is weight and momentum of water and cloth; nothing passes, and energy of both only falls."""
    frames, s = 7, 0.03
    run, mass = hung(frames, [0.18, 0.18, 0.06], [0, 0, HIGH + 0.05], {"center": [0, 0, 0.3], "size": [0.6, 0.6, 0.8]}, spacing=s)
    water, cloth = run.solvers["water"], run.solvers["cloth"]
    energies = []
    for k in range(1, frames):
        run.advance(k)
        wet, sheet = water.frame_data(), cloth.frame_data()
        energies.append(energy(wet, sheet))
        below = wet["particle/position"][:, 2] + wet["origin"][2] < sheet["vertex/position"][:, 2].min() - 0.5 * s
        assert not below.any()
    weight = (float(wet["record/mass"]) + mass) * G * (frames - 1) / 24
    pins = float(sheet["record/hold_impulse_z"])
    gained = float(wet["record/momentum_z"]) + float(sheet["record/momentum_z"])
    assert pins > 0.2 * weight
    assert pins - weight + float(sheet["record/solid_impulse_z"]) == pytest.approx(gained, abs=1e-3 * weight)
    assert max(np.diff(energies)) < 0.01 * np.ptp(energies) + 1e-3
    assert float(sheet["record/max_speed"]) < 15.0


@pytest.mark.slow
def test_a_soft_cloth_throws_water_up_and_catches_it_again_without_gain():
    """Law: the energy of both only falls. Known gap: two layers of particles in place of three gain on the second landing, at any step."""
    frames, s = 20, 0.02
    run, _ = hung(
        frames,
        [0.18, 0.18, 0.06],
        [0, 0, HIGH + 0.05],
        {"center": [0, 0, 0.3], "size": [0.6, 0.6, 0.8]},
        spacing=s,
        stiffness=1000.0,
    )
    water, cloth = run.solvers["water"], run.solvers["cloth"]
    energies, heights = [], []
    for k in range(1, frames):
        run.advance(k)
        energies.append(energy(water.frame_data(), cloth.frame_data()))
        heights.append(float(water.frame_data()["record/potential_energy"]))
    lowest = int(np.argmin(heights[:10]))
    assert max(heights[lowest:]) - heights[lowest] > 0.8 * (heights[0] - heights[lowest])
    assert max(np.diff(energies)) < 1e-3 * np.ptp(heights)


@pytest.mark.slow
def test_a_cloth_in_still_water_feels_no_net_force_and_keeps_both_sides_apart():
    """Law: pressure on both sides of a sheet is the same; it stays where it is, and the water on its sides."""
    frames, s, side = 4, 0.04, 0.24
    run, _ = hung(
        frames, [side, side, 0.24], [0, 0, HIGH], {"center": [0, 0, HIGH + 0.1], "size": [side, side, 0.44]}, spacing=s,
        sides=("closed",) * 5 + ("open",),
    )  # fmt: skip
    water, cloth = run.solvers["water"], run.solvers["cloth"]
    row = next(k for k, n in enumerate(water.index().colliders) if n.startswith("cloth/"))
    start = water.frame_data()["particle/position"][:, 2] + water.origin[2] > HIGH
    order = water.frame_data()["particle/id"]
    above = dict(zip(order.tolist(), start.tolist(), strict=True))
    for k in range(1, frames):
        run.advance(k)
        wet = water.frame_data()
        weight = float(wet["record/mass"]) * G / 24
        assert np.abs(wet["exchange/impulse"][row, :3]).max() < 0.02 * weight
    heights = wet["particle/position"][:, 2] + wet["origin"][2]
    assert [above[i] for i in wet["particle/id"].tolist()] == (heights > HIGH).tolist()
    assert np.abs(cloth.frame_data()["vertex/position"][:, 2] - HIGH).max() < 0.5 * s
