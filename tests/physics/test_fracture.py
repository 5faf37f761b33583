"""Bodies that break: against beam theory, weight, momentum, and themselves."""

from __future__ import annotations

import numpy as np
import pytest
from worldagent.construction import build_entity
from worldagent.simulation.fracture.clusters import clusters_of
from worldagent.simulation.rigid import SolverRigid
from worldagent.testing.defects._fracture_scenes import KINDS
from worldagent.tests.physics import rigid_world
from worldagent.tests.physics.fracture_world import bond, bricks, cantilever, solver_of, struck_wall
from worldagent.worlds.categories.fracture.pieces import piece_overlap

G = rigid_world.G


def _broken(solver: object) -> int:
    return int(solver.frame_data()["bond/broken"].sum())  # type: ignore[attr-defined]


@pytest.mark.parametrize("pieces", [4, 10])
@pytest.mark.parametrize(("share", "breaks"), [(0.98, True), (1.02, False)])
def test_a_cantilever_breaks_where_its_section_says(pieces: int, share: float, breaks: bool) -> None:
    """sigma = 3 rho g L^2 / h at the wall; +-2 %, in any number of pieces."""
    stress = 3 * 1800.0 * G * 1.0**2 / 0.2
    solver = solver_of(cantilever(share * stress, pieces))
    solver.advance(1)
    assert (_broken(solver) > 0) is breaks
    if breaks:
        first = solver.frame_data()["break/point"][0]
        assert first[0] == pytest.approx(-0.5, abs=1e-9)


def test_a_cantilever_under_a_block_breaks_at_the_load_of_its_section() -> None:
    """A block that lies on the free end adds P a at the wall; the bonds break between 0.9 and 1.1 of the total moment."""
    own = 1800.0 * 0.1 * 0.2 * G * 0.5
    mass, arm = 20.0, 0.9
    modulus = 0.1 * 0.2**2 / 6
    stress = (own + mass * G * arm) / modulus
    for share, breaks in ((0.9, True), (1.1, False)):
        spec = cantilever(share * stress)
        entities = {k: e.model_dump() for k, e in spec.entities.items()}
        entities["block"] = rigid_world.box(0.1, 0.1, 0.1, at=(arm - 0.5, 0, 2.0 + 0.1 + 0.05 + 1e-3), mass=mass)
        again = rigid_world.world(entities, seconds=1.5, materials={k: m.model_dump() for k, m in spec.materials.items()})
        solver = solver_of(again)
        for frame in range(1, again.simulation.frames):
            solver.advance(frame)
        assert (_broken(solver) > 0) is breaks


def test_a_wall_stands_under_its_own_weight() -> None:
    solver = solver_of(struck_wall(0.0, seconds=0.2))
    for frame in (1, 2, 3):
        solver.advance(frame)
    assert _broken(solver) == 0


@pytest.mark.parametrize(("speed", "breaks"), [(0.2, False), (6.0, True)])
def test_a_blow_breaks_the_wall_only_above_a_threshold(speed: float, breaks: bool) -> None:
    solver = solver_of(struck_wall(speed, seconds=0.3 / max(speed, 1.5) + 0.1))
    moved = 0.0
    for frame in range(1, solver.spec.simulation.frames):
        solver.advance(frame)
        if solver.frame_data()["event/time"].size == 0 and moved == 0.0:
            assert _broken(solver) == 0
        moved += float(solver.frame_data()["event/time"].size)
    assert (_broken(solver) > 0) is breaks


def test_fragments_hold_the_mass_momentum_and_spin_of_the_whole() -> None:
    """A flying, tumbling slab whose bonds are cut goes on with the same P and L about its centre, to 1e-6."""
    broken = {"pattern": {"kind": "voronoi", "pieces": 12, "seed": 3}, "bond": bond()}
    slab = rigid_world.box(0.6, 0.4, 0.2, at=(0, 0, 5), v=(1, 2, 3), w=(4, -3, 2), material="m", breakable=broken)
    spec = rigid_world.world({"slab": slab}, seconds=0.2)
    solver = solver_of(spec)
    solver.advance(1)
    before = _momenta(solver)
    body = solver.breakage._bodies[0]
    body.whole[:] = False
    solver._split(solver.time)
    assert len(solver.breakage._bodies[0].clusters) == 12
    after = _momenta(solver)
    for old, new in zip(before, after, strict=True):
        assert np.abs(new - old).max() <= 1e-6 * np.abs(old).max()


def _momenta(solver: object) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Mass, momentum and angular momentum of the free clusters, from the engine's state."""
    model, data = solver.model, solver.data  # type: ignore[attr-defined]
    ids = np.unique(solver.rigid.body_ids)  # type: ignore[attr-defined]
    from worldagent.simulation.rigid.records import velocities

    linear, angular = velocities(model, data)
    mass = model.body_mass[ids]
    turn = data.ximat[ids].reshape(-1, 3, 3)
    spin = np.einsum("nij,nj->ni", turn, model.body_inertia[ids] * np.einsum("nji,nj->ni", turn, angular[ids]))
    moment = (np.cross(data.xipos[ids], linear[ids]) * mass[:, None] + spin).sum(axis=0)
    return np.array([mass.sum()]), (mass[:, None] * linear[ids]).sum(axis=0), moment


@pytest.mark.parametrize(
    "pattern",
    [
        bricks(),
        {"kind": "voronoi", "pieces": 30, "seed": 1},
        {"kind": "voronoi", "pieces": 30, "around": (0, 0, 0), "clustering": 0.8},
        {"kind": "wood", "pieces": 12, "grain": (1, 0, 0.2)},
        {"kind": "glass", "point": (0.1, 0, 0.05), "radial": 8, "rings": 3},
    ],
    ids=["bricks", "voronoi", "clustered", "wood", "glass"],
)
def test_pieces_tile_the_body_they_were_cut_from(pattern: dict[str, object]) -> None:
    """Volume, mass, centre and inertia of the pieces are the whole's to 1e-6; every piece is bonded to another."""
    size = np.array([1.0, 0.12, 0.6])
    broken = {"pattern": pattern, "bond": bond(), "fixed": ["z-"]}
    spec = rigid_world.world({"b": rigid_world.box(*size, breakable=broken)})
    built = build_entity(spec, "b", rigid_world.NO_ASSETS)
    mass = 1000.0 * size.prod()
    (whole,) = clusters_of(built, np.ones(len(built.bonds or ()), dtype=bool))
    assert whole.fixed
    assert sum(b.volume for b in built.bodies) == pytest.approx(size.prod(), rel=1e-6)
    assert whole.mass == pytest.approx(mass, rel=1e-6)
    assert np.abs(whole.center).max() < 1e-6
    wanted = mass / 12 * np.diag((size**2).sum() - size**2)
    assert np.abs(whole.inertia - wanted).max() < 1e-6 * wanted.max()


def test_bonds_over_a_cut_add_up_to_its_area() -> None:
    """Running bond: each bed joint is shared by several bricks, whose faces add up to the wall's section."""
    broken = {"pattern": bricks((0.19, 0.12, 0.09)), "bond": bond(), "fixed": ["z-", "x+"]}
    spec = rigid_world.world({"b": rigid_world.box(1.0, 0.12, 0.6, breakable=broken)})
    bonds = build_entity(spec, "b", rigid_world.NO_ASSETS).bonds
    assert bonds is not None
    level = np.abs(bonds.point[:, 2]) < 1e-9
    assert bonds.area[level].sum() == pytest.approx(0.12, rel=1e-9)
    foot = (bonds.pieces[:, 1] == -1) & (bonds.frame[:, 0, 2] < -0.5)
    assert bonds.area[foot].sum() == pytest.approx(0.12, rel=1e-9)


def test_a_run_that_is_taken_up_in_the_debris_goes_on_byte_for_byte() -> None:
    spec = struck_wall(6.0, seconds=0.3)
    one = solver_of(spec)
    states = {}
    for frame in range(1, 6):
        one.advance(frame)
        states[frame] = one.checkpoint()
    two = solver_of(spec)
    two.restore(states[3], 3)
    for frame in (4, 5):
        two.advance(frame)
        assert two.checkpoint() == states[frame]


def test_bricks_that_came_loose_do_not_burst() -> None:
    """Cutting every bond of a standing wall gives its bricks no speed to speak of: they rest on one another."""
    solver = solver_of(struck_wall(0.0, seconds=0.5))
    solver.breakage._bodies[0].whole[:] = False
    solver._split(0.0)
    rows = [k for k, b in enumerate(solver.rigid.bodies) if b.startswith("wall/")]
    start = solver.frame_data()["position"][rows].copy()
    for frame in range(1, 6):
        solver.advance(frame)
    assert np.linalg.norm(solver.frame_data()["position"][rows] - start, axis=1).max() < 2e-3


def test_loose_bricks_bear_what_stands_on_them() -> None:
    """A wall of 30 courses whose bonds are all cut stands, in long steps too: it settles by less than one of its joints and rests."""
    solver = solver_of(struck_wall(0.0, seconds=0.5, size=(0.3, 2.4), step=1e-3, refine=0))
    solver.breakage._bodies[0].whole[:] = False
    solver._split(0.0)
    rows = [k for k, b in enumerate(solver.rigid.bodies) if b.startswith("wall/")]
    start = solver.frame_data()["position"][rows].copy()
    sunk = []
    for frame in range(1, 7):
        solver.advance(frame)
        sunk.append(float((start - solver.frame_data()["position"][rows])[:, 2].max()))
    joint = 0.01
    assert 0.0 < sunk[-1] < 0.5 * joint
    assert abs(sunk[-1] - sunk[-3]) < 0.02 * joint


def test_what_jams_in_a_struck_wall_gives_no_more_than_the_blow() -> None:
    """Tight faces ask for what cannot all be had; they must not load the bonds with many times what the balls bring."""
    spec = KINDS["crossfire"](np.random.default_rng([1, 2]))
    solver = SolverRigid(spec, {n: build_entity(spec, n, rigid_world.NO_ASSETS) for n in spec.entities}, "rigid")
    solver.prepare()
    momentum = sum(
        float(solver.rigid.masses[k] * np.linalg.norm(solver.frame_data()["velocity"][k]))
        for k, name in enumerate(solver.rigid.bodies)
        if name in ("ball/body", "other/body")
    )
    most = 0.0
    for frame in range(1, spec.simulation.frames):
        solver.advance(frame)
        loads = solver.frame_data()["case/load"]
        most = max(most, float(np.linalg.norm(loads[:, :3] + loads[:, 6:9], axis=1).max(initial=0.0)))
    assert solver.frame_data()["bond/broken"].any()
    assert most < 5.0 * momentum / spec.entities["wall"].breakable.bond.contact_time


@pytest.mark.parametrize("speed", [6.0, 15.0])
def test_a_crumbling_face_gives_way_as_far_as_it_crumbles_and_no_farther(speed: float) -> None:
    """Two loose blocks that are driven at each other close over their face's mortar; then they meet as all bodies."""
    broken = {"pattern": bricks((0.2, 0.2, 0.2)), "bond": bond()}
    bar = rigid_world.box(0.4, 0.2, 0.2, at=(0, 0, 5), material="m", breakable=broken)
    solver = solver_of(rigid_world.world({"bar": bar}, seconds=0.3))
    solver.breakage._bodies[0].whole[:] = False
    solver._split(0.0)
    assert len(solver.breakage._bodies[0].clusters) == 2
    solver.data.qvel[[0, 6]] = 0.5 * speed, -0.5 * speed
    deepest = 0.0
    for frame in (1, 2, 3):
        solver.advance(frame)
        deepest = max(deepest, -float(solver.frame_data()["contact/min_gap"].min(initial=0.0)))
        assert solver.refined == 0, "what crumbles is no overlap to be resolved"
    allowed = piece_overlap(solver.spec.entities["bar"].breakable, solver.built["bar"])  # type: ignore[arg-type]
    assert 0.5 * allowed < deepest < allowed


@pytest.mark.parametrize("mass", [200.0, 2000.0])
def test_pieces_under_a_heavy_body_are_not_pressed_through_each_other(mass: float) -> None:
    """Two loose blocks of 6 kg, one on the other, under a block that falls on them: their face gives way as far as it crumbles."""
    broken = {"pattern": bricks((0.2, 0.2, 0.2)), "bond": bond(crumble=0.001)}
    pillar = rigid_world.box(0.2, 0.2, 0.4, at=(0, 0, 0.2 + 1e-3), material="m", breakable=broken)
    ram = rigid_world.box(0.4, 0.4, 0.4, at=(0, 0, 0.6 + 4e-3), mass=mass, v=(0, 0, -3.0))
    settings = {"refine": 0, "step": 1e-4}
    spec = rigid_world.world({"floor": rigid_world.floor(), "pillar": pillar, "ram": ram}, seconds=0.1, settings=settings)
    solver = solver_of(spec)
    solver.breakage._bodies[0].whole[:] = False
    solver._split(0.0)
    deepest = 0.0
    for frame in (1, 2):
        solver.advance(frame)
        deepest = max(deepest, -float(solver.frame_data()["contact/min_gap"].min(initial=0.0)))
    allowed = piece_overlap(spec.entities["pillar"].breakable, solver.built["pillar"])  # type: ignore[arg-type]
    assert 0.5 * allowed < deepest < allowed
