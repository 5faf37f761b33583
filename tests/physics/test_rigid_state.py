"""Determinism, checkpoints, conservation records, and visible surfaces of whole small worlds."""

import functools

import numpy as np
import pytest
from worldagent.tests.physics.rigid_world import Run, ball, box, entity, floor, solver, world, worst_clearance
from worldagent.worlds.cache import digest_arrays
from worldagent.worlds.errors import EngineError, InputError

RESUMES = 20
EVERY = 6
"""Frames between checkpoints."""
GROWTH = 1e-3
"""Energy that may appear without a driver, relative to the energy scale: half a step of free fall at a bounce."""
BOWL = [(0.0, 0.0), (0.15, 0.0), (0.3, 0.15), (0.28, 0.15), (0.14, 0.02), (0.0, 0.02)]


def _busy_world():
    """Everything that has state: stacks that sleep, joints, a motor, a path, holds, springs, a rope, a weld."""
    path = {"kind": "path", "entity": "pusher", "keys": {
        "a": {"time": 0.5, "pose": {"position": (-1, 2, 0.1)}},
        "b": {"time": 2.0, "pose": {"position": (0.2, 2, 0.1)}},
    }}  # fmt: skip
    entities = {
        "ground": floor(),
        **{f"s{k}": box(0.1, 0.1, 0.1, at=(0, 0, 0.05 + 0.1 * k)) for k in range(3)},
        "shot": ball(0.05, at=(-3.0, 0, 0.2), v=(2.5, 0, 0.5)),
        "hopper": ball(0.06, at=(1, 1, 0.8), material="rubber"),
        "pusher": box(0.1, 0.3, 0.1, at=(-1, 2, 0.1), motion="kinematic"),
        "pushed": box(0.1, 0.1, 0.1, at=(-0.5, 2, 0.05)),
        "bob": ball(0.05, at=(3.4, 0, 1)),
        "wheel": entity({"kind": "cylinder", "radius": 0.1, "height": 0.05}, at=(4, 0, 0.5)),
        "late": box(0.1, 0.1, 0.1, at=(2, 2, 0.6), euler=(0.3, 0.2, 0)),
        "pan": box(0.2, 0.2, 0.02, at=(2, -2, 0.5)),
        "tag": box(0.05, 0.05, 0.05, at=(2, -2, 0.45)),
        "r": entity(generator={"kind": "rope", "points": [(-2, -2, 0.6), (-1.2, -2, 0.6)], "radius": 0.01, "segments": 8, "attach_start": "world"}),
    }  # fmt: skip
    joints = {
        "swing": {"kind": "hinge", "child": "bob", "anchor": (3, 0, 1), "axis": (0, 1, 0), "damping": 0.01},
        "axle": {"kind": "hinge", "child": "wheel", "anchor": (4, 0, 0.5), "axis": (0, 0, 1)},
        "hang": {
            "kind": "spring", "child": "pan", "parent_point": (2, -2, 1), "child_point": (2, -2, 0.51), "stiffness": 400.0, "damping": 1.0,
        },
        "glue": {"kind": "weld", "parent": "pan", "child": "tag", "anchor": (2, -2, 0.48)},
    }  # fmt: skip
    drivers = {
        "p": path,
        "m": {"kind": "motor", "joint": "axle", "velocity": 8.0, "max_effort": 0.05, "start": 0.3, "end": 1.7},
        "f": {"kind": "force", "entity": "pushed", "force": (0, 1.0, 0), "start": 1.01, "end": 1.53},
        "r": {"kind": "release", "entity": "late", "time": 1.111},
        "d": {"kind": "detach", "joint": "glue", "time": 1.3},
    }
    rubber = {"rubber": {"density": 1100.0, "friction": 0.8, "restitution": 0.7}}
    return world(entities, seconds=3.0, joints=joints, drivers=drivers, materials=rubber, restitution=0.2)


@functools.lru_cache(maxsize=1)
def _unbroken():
    """Digest per frame of a run with checkpoints, and the checkpoints."""
    spec = _busy_world()
    running = solver(spec)
    digests, checkpoints, asleep = [digest_arrays(running.frame_data())], {}, 0
    for frame in range(1, spec.simulation.frames):
        if (frame - 1) % EVERY == 0:
            checkpoints[frame - 1] = running.checkpoint()
        running.advance(frame)
        digests.append(digest_arrays(running.frame_data()))
        asleep += int(np.count_nonzero(running.frame_data()["asleep"]))
    assert asleep > 50, "the world should make use of sleep"
    return digests, checkpoints


@pytest.mark.slow
def test_the_same_specification_gives_the_same_bytes():
    digests, checkpoints = _unbroken.__wrapped__()
    again, points = _unbroken()
    assert digests == again
    assert checkpoints == points


def test_every_resume_continues_byte_for_byte():
    digests, checkpoints = _unbroken()
    spec = _busy_world()
    rng = np.random.default_rng(0)
    starts = sorted(checkpoints)
    chosen = [*starts, *rng.choice(starts, max(0, RESUMES - len(starts)))]
    fresh = solver(spec)
    for number, start in enumerate(chosen):
        if number == 10:
            fresh = solver(spec)
        fresh.restore(checkpoints[int(start)], int(start))
        assert fresh.checkpoint() == checkpoints[int(start)], f"another checkpoint after resuming at {start}"
        for frame in range(int(start) + 1, min(int(start) + EVERY, spec.simulation.frames - 1) + 1):
            fresh.advance(frame)
            assert digest_arrays(fresh.frame_data()) == digests[frame], f"resumed at {start}, frame {frame} differs"


def test_a_checkpoint_of_another_model_is_refused():
    one, other = solver(world({"a": ball(0.1)})), solver(world({"a": ball(0.1), "b": ball(0.1, at=(1, 0, 0))}))
    with pytest.raises(EngineError, match="is not of 'main' as it is specified"):
        other.restore(one.checkpoint(), 0)


def test_frames_come_in_order():
    running = solver(world({"a": ball(0.1)}))
    with pytest.raises(InputError, match="next frame is 1"):
        running.advance(2)


def _scenes():
    dominoes = {f"d{k}": box(0.02, 0.1, 0.2, at=(0.08 * k, 0, 0.1), material="wood") for k in range(20)}
    wood = {"wood": {"density": 600.0, "friction": 0.4, "restitution": 0.1}}

    def row(speed, **more):
        shot = ball(0.05, at=(-0.2, 0, 0.06), v=(speed, 0, 0), mass=0.5)
        return world({"ground": floor(), "shot": shot, **dominoes}, seconds=2.5, materials=wood, **more)

    tower = {f"b{k}": box(0.1, 0.1, 0.1, at=(0, 0, 0.05 + 0.1 * k)) for k in range(5)}
    bowl = entity({"kind": "revolution", "profile": BOWL, "segments": 32}, motion="static")
    rope = entity(generator={"kind": "rope", "points": [(-0.4, 0, 0.3), (0.4, 0, 0.3)], "radius": 0.01, "segments": 16})
    return {
        "dominoes, slow": row(0.8),
        "dominoes, fast": row(2.0, restitution=0.5),
        "ball": world({"ground": floor(), "b": ball(0.1, at=(0, 0, 0.6))}, seconds=1.5),
        "tower": world(
            {"ground": floor(), **tower, "shot": ball(0.06, at=(-0.6, 0, 0.35), v=(4, 0, 0))}, seconds=2, restitution=0.2
        ),
        "bowl": world({"bowl": bowl, "c": box(0.06, 0.06, 0.06, at=(0.1, 0.02, 0.25), v=(0.8, 0.3, 0), w=(3, 5, 1))}, seconds=2),
        "rope": world({"ground": floor(), "block": box(0.2, 0.3, 0.2, at=(0, 0, 0.1)), "r": rope}, seconds=1.5),
        # Hits the floor a millisecond before frame 3.
        "fast ball": world({"ground": floor(), "b": ball(0.05, at=(0, 0, 1.2404), v=(3, 0, -9))}, seconds=0.5),
    }


SCENES = _scenes()


@pytest.mark.parametrize("name", [pytest.param(n, marks=pytest.mark.slow) if n == "rope" else n for n in SCENES])
def test_visible_surfaces_never_overlap_and_nothing_gains_energy(name):
    run = Run(SCENES[name])
    value, a, b, frame = worst_clearance(run)
    assert value >= 0, f"{a} and {b} overlap by {-value} m at frame {frame}"
    energy = run.record("kinetic_energy") + run.record("potential_energy")
    scale = max(run.record("kinetic_energy").max(), np.ptp(run.record("potential_energy")))
    assert (energy - np.minimum.accumulate(energy)).max() < GROWTH * scale
    assert np.all(run.record("mass") == run.record("mass")[0])
    assert run.record("overflows").max() == 0
    assert run.record("iterations_capped").sum() == 0


def test_a_frame_that_would_overlap_is_redone_finer_and_others_are_not():
    run = Run(SCENES["fast ball"])
    levels = np.log2(run.record("steps")[1:] / run.record("steps")[1:].min())
    assert levels.max() > 0.9
    assert (levels == 0).mean() > 0.7
    coarse = SCENES["fast ball"].simulation.solvers["main"].settings.model_copy(update={"refine": 0})
    members = SCENES["fast ball"].simulation.solvers["main"].model_copy(update={"settings": coarse})
    plan = SCENES["fast ball"].simulation.model_copy(update={"solvers": {"main": members}})
    assert np.all(Run(SCENES["fast ball"].model_copy(update={"simulation": plan})).record("steps")[1:] <= 85)


def test_the_largest_speed_within_a_frame_is_recorded():
    """A ball dropped 0.2 m hits at 1.98 m/s between frames 4 and 5, and is slower at both of them."""
    run = Run(world({"ground": floor(), "ball": ball(0.05, at=(0, 0, 0.25))}, seconds=0.3, restitution=0.5))
    written = np.linalg.norm(run.of("ball", "velocity"), axis=1)
    hit = np.sqrt(2 * 9.81 * 0.2)
    frame = int(np.ceil(np.sqrt(2 * 0.2 / 9.81) * 24))
    assert written.max() < 0.97 * hit
    assert run.record("max_speed")[frame] == pytest.approx(hit, rel=0.01)
    assert run.record("max_speed")[frame + 1] == pytest.approx(written[frame], rel=1e-6)


@pytest.mark.parametrize("steps", [255, 256, 257, 511])
def test_a_frame_whose_end_fills_a_batch_of_steps_is_recorded(steps):
    """The end of a frame is watched like a step: with 255 steps, or 511, it is that copy which fills a batch."""
    run = Run(world({"ball": ball(0.05, at=(0, 0, 5))}, seconds=0.1, settings={"step": 1 / 24 / steps}))
    assert run.record("steps")[1:] == pytest.approx(steps)
    assert run.record("max_speed") == pytest.approx(9.81 * run.time, rel=1e-6)
