"""The compiled model says what the specification says: collision shapes where the visible ones are, contact parameters."""

import numpy as np
import pytest
from worldagent.geometry import Solid, signed_clearance
from worldagent.simulation.rigid.distances import collide_all
from worldagent.tests.physics.rigid_world import ball, box, entity, floor, solver, world
from worldagent.worlds.arrays import RigidPose, compose, pose_of

L = [(0, 0), (0.4, 0), (0.4, 0.1), (0.1, 0.1), (0.1, 0.3), (0, 0.3)]
SHAPES = {
    "box": {"kind": "box", "size": (0.3, 0.2, 0.1)},
    "wedge": {"kind": "wedge", "size": (0.4, 0.2, 0.2)},
    "extrusion": {"kind": "extrusion", "polygon": L, "height": 0.2},
    "revolution": {"kind": "revolution", "profile": [(0, 0), (0.2, 0), (0.3, 0.15), (0.28, 0.15), (0.18, 0.02), (0, 0.02)]},
    "cylinder": {"kind": "cylinder", "radius": 0.1, "height": 0.3},
    "capsule": {"kind": "capsule", "radius": 0.1, "length": 0.3},
}
FACET = 4e-4
"""[m] Facet error of the visible cylinder, capsule and probe."""
SPARSE = 1e-6
"""Relative difference of accelerations between sparse and dense Jacobians; measured 3e-7."""


@pytest.mark.parametrize("motion", ["static", "dynamic", "kinematic"])
@pytest.mark.parametrize("kind", SHAPES)
def test_collision_pieces_are_where_the_visible_surface_is(kind, motion):
    import mujoco

    thing = entity(SHAPES[kind], at=(0.3, -0.2, 1.0), euler=(0.4, -0.7, 1.1), motion=motion)
    thing["parts"]["p"]["pose"] = {"position": (0.05, 0.1, -0.1), "euler": (0.2, 0.1, 0.5)}
    # A second part moves the centre of mass away from everything.
    thing["parts"]["q"] = {"shape": {"kind": "box", "size": (0.05, 0.05, 0.05)}, "pose": {"position": (0.6, 0.5, 0.4)}}
    made = solver(world({"thing": thing, "probe": ball(0.02, at=(0, 0, 5))}))
    model, data = made.model, made.data
    own = np.flatnonzero(made.rigid.geom_collider == 0)
    probe = int(np.flatnonzero(made.rigid.geom_collider == 1)[0])
    parts = [Solid.from_mesh(p.render, closed=True) for p in made.built["thing"].parts]
    small = Solid.from_mesh(made.built["probe"].parts[0].render, closed=True)
    rng, place = np.random.default_rng(1), pose_of(made.spec.entities["thing"].pose)
    if motion != "static":
        row = made.rigid.bodies.index("thing/body")
        assert made.frame_data()["position"][row] == pytest.approx(place.position, abs=1e-12)
        assert np.abs(made.frame_data()["quaternion"][row] @ place.quaternion) == pytest.approx(1.0)
    apart = 0
    for _ in range(12):
        at = compose(place, RigidPose(rng.uniform(-0.5, 0.7, 3), np.array([1.0, 0, 0, 0])))
        data.qpos[-7:] = [*at.position, 1, 0, 0, 0]
        mujoco.mj_kinematics(model, data)
        witness = np.zeros(6)
        engine = min(mujoco.mj_geomDistance(model, data, int(g), probe, 10.0, witness) for g in own)
        still = RigidPose(at.position, np.array([1.0, 0, 0, 0]))
        visible = min(signed_clearance(s, place, small, still).distance for s in parts)
        if visible > 0.001:
            apart += 1
            assert engine == pytest.approx(visible, abs=FACET)
    assert apart > 0


def test_inertia_in_the_engine_is_that_of_the_built_body():
    thing = entity(SHAPES["extrusion"], euler=(0.3, 0.2, 0.1))
    made = solver(world({"thing": thing}))
    import mujoco

    body = made.built["thing"].bodies[0]
    turn = np.zeros(9)
    mujoco.mju_quat2Mat(turn, made.model.body_iquat[1])
    turn = turn.reshape(3, 3)
    assert turn @ np.diag(made.model.body_inertia[1]) @ turn.T == pytest.approx(body.inertia, rel=1e-9, abs=1e-12)
    assert made.model.body_mass[1] == pytest.approx(body.mass)


def test_contacts_take_the_larger_friction_and_pairs_their_own():
    materials = {
        "slick": {"density": 1000.0, "friction": 0.1},
        "grippy": {"density": 1000.0, "friction": 0.9, "rolling_friction": 0.01},
    }
    entities = {
        "ground": floor(material="slick"),
        "a": box(0.1, 0.1, 0.1, at=(0, 0, 0.05), material="grippy"),
        "b": box(0.1, 0.1, 0.1, at=(1, 0, 0.05), material="slick"),
        "c": box(0.1, 0.1, 0.1, at=(2, 0, 0.05), material="grippy"),
    }
    made = solver(world(entities, materials=materials, contacts={"x": {"a": "c", "b": "ground", "friction": 0.33}}))
    made.advance(1)
    collide_all(made.model, made.data)
    contact = made.data.contact
    found = {}
    for i in range(made.data.ncon):
        names = {made.rigid.colliders[k] for k in made.rigid.geom_collider[contact.geom[i]]}
        found[(names - {"ground"}).pop()] = (contact.friction[i].tolist(), int(contact.dim[i]))
    assert found["a"] == ([0.9, 0.9, 0.01, 0.01, 0.01], 6)
    assert found["b"][0][:2] == [0.1, 0.1]
    assert found["b"][1] == 3
    assert found["c"] == ([0.33, 0.33, 0.01, 0.01, 0.01], 6)


def test_a_skin_grows_where_the_visible_surface_reaches_outside_the_pieces():
    import dataclasses

    from worldagent.simulation.rigid import SolverRigid

    made = solver(world({"ground": floor(), "a": box(0.1, 0.1, 0.1, at=(0, 0, 0.05))}), prepare=False)
    part = dataclasses.replace(made.built["a"].parts[0], deviation=(0.0, 0.004))
    built = {**made.built, "a": dataclasses.replace(made.built["a"], parts=(part,))}
    wide = SolverRigid(made.spec, built, "main")
    wide.prepare()
    assert wide.frame_data()["position"][0, 2] == pytest.approx(0.05 + 0.005, abs=1e-4)


@pytest.mark.parametrize("speculative", [False, True])
def test_a_fast_ball_does_not_pass_a_thin_plate_when_contacts_are_speculative(speculative):
    entities = {"plate": box(1, 1, 0.004, motion="static"), "b": ball(0.01, at=(0, 0, 0.53), v=(0, 0, -55.0))}
    made = solver(
        world(entities, seconds=0.1, gravity=(0, 0, 0), settings={"speculative": speculative, "refine": 0, "step": 1e-3})
    )
    for frame in (1, 2):
        made.advance(frame)
    through = made.frame_data()["position"][0, 2] < 0
    assert through != speculative


def test_sparse_and_dense_jacobians_give_the_same_accelerations():
    """Watches what is known of MuJoCo 4.0.0's sparse Newton Hessian (issue 3767)."""
    import mujoco

    rope = entity(generator={"kind": "rope", "points": [(-0.4, 0, 1.7), (0.4, 0, 1.7)], "radius": 0.01, "segments": 12})
    pile = {f"b{k}": box(0.1, 0.1, 0.1, at=(0.03 * (k % 3), 0.02 * (k % 2), 0.06 + 0.12 * k)) for k in range(12)}
    made = solver(world({"ground": floor(), **pile, "r": rope}, seconds=2, restitution=0.2))
    model, data = made.model, made.data
    assert model.opt.jacobian == int(mujoco.mjtJacobian.mjJAC_SPARSE)

    def accelerations(jacobian):
        other = mujoco.MjData(model)
        mujoco.mj_copyData(other, model, data)
        kept = model.opt.jacobian, model.opt.tolerance, model.opt.iterations
        model.opt.jacobian, model.opt.tolerance, model.opt.iterations = int(jacobian), 1e-14, 300
        mujoco.mj_step(model, other)
        model.opt.jacobian, model.opt.tolerance, model.opt.iterations = kept
        return other.qacc.copy()

    for frame in range(1, 25):
        made.advance(frame)
        dense, sparse = (accelerations(j) for j in (mujoco.mjtJacobian.mjJAC_DENSE, mujoco.mjtJacobian.mjJAC_SPARSE))
        assert np.abs(dense - sparse).max() <= SPARSE * max(1.0, np.abs(dense).max()), f"frame {frame}"


def test_many_pieces_that_come_near_at_once_have_room():
    """Six bodies of 170 pieces each whose bounds all meet: 433,500 pairs, for which 64 MB were too little (a bookcase tipped in a room)."""
    import mujoco

    def rack(number):
        made = entity({"kind": "box", "size": (0.01, 0.01, 0.01)}, at=(3.0 * number, 0, 0))
        piece = {"kind": "box", "size": (0.01, 0.01, 0.01)}
        made["parts"] = {f"s{k}": {"shape": piece, "pose": {"position": (0, 0, 0.012 * k)}} for k in range(170)}
        return made

    made = solver(world({f"rack{n}": rack(n) for n in range(6)}))
    made.model.geom_rbound[:] = 100.0
    made.model.geom_aabb[:, 3:] = 100.0
    made.model.bvh_aabb[:, 3:] = 100.0
    mujoco.mj_fwdPosition(made.model, made.data)
    assert made.data.maxuse_stack > 64 << 20
