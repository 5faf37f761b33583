"""Elastic bodies against beam theory, the tensile bar, constant strain, and the balances."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from worldagent.construction.build import build_entity
from worldagent.simulation.rigid import SolverRigid
from worldagent.testing.worlds.small_worlds import box, ground, world
from worldagent.verifiers.categories.elastic.register import LOST
from worldagent.worlds.spec import ElasticPhysics, Material, Pin, RigidSettings

G = 9.81
STIFF, DENSE = 5e7, 1000.0
LONG, HIGH = 1.0, 0.1
EULER = DENSE * G * HIGH * HIGH * LONG**4 / (8 * STIFF * HIGH**4 / 12)
"""Tip deflection of the cantilever under its weight by Euler and Bernoulli [m]."""
MATERIALS = {
    "wood": Material(density=DENSE, friction=0.6),
    "light": Material(density=1.0, friction=0.6),
}


def made(things, *, frames=24, fps=24, step=1e-3, skin=5e-4, gravity=(0, 0, -G)) -> tuple[SolverRigid, dict]:
    spec = world(
        things, frames=frames, fps=fps, materials=MATERIALS, settings=RigidSettings(step=step, skin=skin), gravity=gravity
    )
    built = {n: build_entity(spec, n, Path()) for n in things}
    solver = SolverRigid(spec, built, "rigid")
    solver.prepare()
    return solver, built


def beam(cells, **physics):
    pins = {"wall": Pin(center=(-LONG / 2, 0, 0), size=(1e-3, 1, 1))}
    soft = ElasticPhysics(young_modulus=STIFF, resolution=LONG / cells, pins=pins, **physics)
    return {"beam": box(LONG, HIGH, HIGH, motion="dynamic", at=(0, 0, 1), physics=soft)}


def vertices(solver) -> np.ndarray:
    return solver.frame_data()["vertex/position"]


def energy(solver) -> float:
    data = solver.frame_data()
    names = ("elastic_kinetic_energy", "elastic_potential_energy", "strain_energy", "kinetic_energy", "potential_energy")
    return sum(float(data[f"record/{n}"]) for n in names)


@pytest.mark.parametrize(("cells", "error"), [(4, 0.05), pytest.param(8, 0.02, marks=pytest.mark.slow)])
def test_a_cantilever_sags_as_beam_theory_says(cells, error):
    """Law: rho g A L^4 / (8 E I) within 5 % at four cells (measured 0.962) and 2 % at eight (0.989), Poisson's ratio 0.3.

    Almost undamped it swings about its sag: the mean over two periods of 0.277 s is that.
    """
    fps, frames = 87, 49
    solver, built = made(beam(cells, poisson_ratio=0.3, damping=5e-4), frames=frames, fps=fps)
    mesh = built["beam"].parts[0].simulation
    tip, sags, residual = mesh.vertices[:, 0] > LONG / 2 - 1e-9, [], 0.0
    for frame in range(1, frames):
        solver.advance(frame)
        sags.append(1.0 - float(vertices(solver)[tip, 2].mean()))
        residual = max(residual, float(solver.frame_data()["record/solve_residual"]))
    assert np.mean(sags) == pytest.approx(EULER, rel=error)
    assert residual < 1e-3


def test_a_hanging_bar_stretches_and_thins_by_hooke():
    """Law: F L / (A E) and -nu of it across, each within 2 %, between sections away from the clamped ends."""
    load, side, high, young = 40.0, 0.05, 0.5, 1e6
    pins = {
        "top": Pin(center=(0, 0, high / 2), size=(1, 1, 1e-3)),
        "bottom": Pin(center=(0, 0, -high / 2), size=(1, 1, 1e-3), to="weight"),
    }
    soft = ElasticPhysics(young_modulus=young, poisson_ratio=0.3, damping=0.05, pins=pins, resolution=0.05)
    block = 0.1
    things = {
        "bar": box(side, side, high, motion="dynamic", at=(0, 0, 1), physics=soft).model_copy(update={"material": "light"}),
        "weight": box(block, block, block, motion="dynamic", at=(0, 0, 1 - high / 2 - block / 2 - 0.01)),
    }
    weight = DENSE * block**3 * G
    assert load > weight  # the load is the block's weight
    solver, built = made(things, frames=14)
    mesh = built["bar"].parts[0].simulation
    for frame in range(1, 14):
        solver.advance(frame)
    now, rest = vertices(solver), mesh.vertices
    upper, lower = (np.isclose(rest[:, 2], z) for z in (0.1, -0.1))
    strain = (now[upper, 2].mean() - now[lower, 2].mean()) / 0.2 - 1
    assert strain == pytest.approx(weight / (side**2 * young), rel=0.02)
    middle = np.isclose(rest[:, 2], 0.0) & np.isclose(np.abs(rest[:, 0]), side / 2)
    across = np.abs(now[middle, 0]).mean() / (side / 2) - 1
    assert across == pytest.approx(-0.3 * strain, rel=0.02)


@pytest.mark.parametrize("turn", [0.0, 0.7])
def test_constant_strain_is_met_exactly(turn):
    """Law (patch test): under an affine displacement no inner node feels a force; 1e-6 of the forces at the surface."""
    import mujoco

    soft = ElasticPhysics(young_modulus=1e5, poisson_ratio=0.3, resolution=0.1)
    solver, _ = made(
        {"b": box(0.3, 0.2, 0.2, motion="dynamic", at=(0, 0, 1), euler=(0, 0, turn), physics=soft)}, gravity=(0, 0, 0)
    )
    flex = solver.rigid.flexes[0]
    places = flex.pose.apply(flex.lattice.nodes)
    shear = np.array([[0, 0.01, 0], [0, 0, 0.005], [0, 0, 0.002]])
    moved = (places - places.mean(0)) @ shear.T
    dofs = solver.model.body_dofadr[flex.body_ids]
    for axis in range(3):
        solver.data.qpos[dofs + axis] = moved[:, axis]
    mujoco.mj_forward(solver.model, solver.data)
    force = np.stack([solver.data.qfrc_passive[dofs + k] for k in range(3)], axis=1)
    low, high = flex.lattice.nodes.min(0), flex.lattice.nodes.max(0)
    inner = ((flex.lattice.nodes > low + 1e-9) & (flex.lattice.nodes < high - 1e-9)).all(axis=1)
    assert np.abs(force[~inner]).max() > 0.1
    assert np.abs(force[inner]).max() < 1e-6 * np.abs(force[~inner]).max()


def test_undamped_energy_never_grows_and_shorter_steps_lose_less():
    """Law: no growth. The implicit scheme loses energy; half the step loses about half of it (first order)."""
    lost = []
    for step in (1e-3, 5e-4):
        solver, _ = made(beam(4, poisson_ratio=0.3), frames=9, step=step)
        series = [energy(solver)]
        for frame in range(1, 9):
            solver.advance(frame)
            series.append(energy(solver))
        play = DENSE * HIGH * HIGH * LONG * G * EULER
        assert np.diff(series).max() <= 1e-3 * play
        lost.append((series[0] - series[-1]) / play)
    assert 0 < lost[1] < 0.7 * lost[0]


def test_implicit_steps_take_of_a_swing_what_the_register_says():
    """Law of the scheme: a swing of angular frequency w loses w^2 h / 2 of its amplitude in a second at steps of h."""
    fps, step = 200, 1e-3
    solver, built = made(beam(4, poisson_ratio=0.3), frames=90, fps=fps, step=step, gravity=(0, 0, -0.5))
    tip = built["beam"].parts[0].simulation.vertices[:, 0] > LONG / 2 - 1e-9
    height = []
    for frame in range(1, 90):
        solver.advance(frame)
        height.append(float(vertices(solver)[tip, 2].mean()))
    low, high, lower = (height[a:b] for a, b in ((0, 40), (40, 70), (65, 89)))
    ends = min(low), max(high), min(lower)
    period = (height.index(ends[2]) - height.index(ends[0])) / fps
    kept = (ends[1] - ends[2]) / (ends[1] - ends[0])
    told = LOST * step / period**2
    assert -math.log(kept) / (period / 2) == pytest.approx(told, rel=0.1)


@pytest.fixture(scope="module")
def dropped():
    """A soft block that falls on the floor, and a crate on it: every frame, and a checkpoint in flight and in contact."""
    soft = ElasticPhysics(young_modulus=3e4, poisson_ratio=0.4, damping=0.004)
    things = {
        "floor": ground(),
        "jelly": box(0.1, 0.1, 0.1, motion="dynamic", at=(0, 0, 0.06), physics=soft),
        "crate": box(0.04, 0.04, 0.04, motion="dynamic", at=(0.01, 0, 0.14)),
    }
    solver, built = made(things, frames=10, skin=1e-3)
    frames, states = [dict(solver.frame_data())], {}
    for frame in range(1, 10):
        solver.advance(frame)
        if frame == 4:
            states[frame] = solver.checkpoint()
        frames.append(dict(solver.frame_data()))
    return things, solver, built, frames, states


def test_repeats_and_resumed_runs_are_byte_identical(dropped):
    things, _, _, frames, states = dropped
    again, _ = made(things, frames=10, skin=1e-3)
    for frame in range(1, 5):
        again.advance(frame)
    assert again.checkpoint() == states[4]
    resumed, _ = made(things, frames=10, skin=1e-3)
    resumed.restore(states[4], 4)
    for frame in range(5, 8):
        resumed.advance(frame)
        for name, value in resumed.frame_data().items():
            assert np.array_equal(value, frames[frame][name]), (frame, name)


def test_the_floor_carries_what_lies_on_it(dropped):
    """Law: impulse of the floor = change of momentum of jelly and crate + their weight, over all frames; 1 %."""
    _, solver, built, frames, _ = dropped
    mass = sum(built[n].bodies[0].mass for n in ("jelly", "crate"))
    names = list(solver.rigid.colliders)
    floor = names.index("floor")

    def momentum(data):
        return float(data["record/momentum_z"] + data["record/elastic_momentum_z"])

    given = 0.0
    for data in frames[1:]:
        pairs = data["contact/pair"]
        given += float(data["contact/impulse"][(pairs == floor).any(axis=1)].sum())
    wanted = momentum(frames[-1]) - momentum(frames[0]) + mass * G * (len(frames) - 1) / 24
    assert given == pytest.approx(wanted, rel=0.01)


def test_surfaces_keep_apart_at_every_frame(dropped):
    """The block's lowest vertex stays above the floor, and the crate above the block's dent."""
    _, _, _, frames, _ = dropped
    assert len(frames) > 1
    for data in frames:
        assert data["vertex/position"][:, 2].min() > 0
    assert all(float(d["record/overflows"]) == 0 for d in frames)


@pytest.mark.slow
def test_what_yields_keeps_its_new_shape():
    """A weight is set on two blocks in a row; the one that yields stays lower when nothing but its weight is left."""
    sags = []
    for limit in (0.0, 0.02):
        soft = ElasticPhysics(young_modulus=2e4, damping=0.02, yield_strain=limit, resolution=0.1, linear_velocity=(0, 0, -3))
        solver, _ = made(
            {"floor": ground(), "b": box(0.1, 0.1, 0.1, motion="dynamic", at=(0, 0, 0.055), physics=soft)}, frames=20, skin=2e-3
        )
        for frame in range(1, 20):
            solver.advance(frame)
        sags.append(0.1 - float(np.ptp(vertices(solver)[:, 2])))
    assert sags[1] > sags[0] + 0.005
