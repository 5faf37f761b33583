"""Seeded defects of the numerical check: damaged caches, impossible counters, runs that blow up, bodies that sleep in the air."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from ...worlds.arrays import F64
from ...worlds.spec import HingeJoint, Limits, RigidSettings
from ..worlds.small_worlds import ball, box, ground, world
from . import _contact_log as contact_log
from . import _scenes as scenes
from ._films import Film, film_of, frame_of_walls, free_body, still
from ._starts import START_MECHANISMS
from ._step_travel import at_the_arm, at_the_foot, coarse_travel, past_the_pane, thin_and_slow, through_the_pane
from .cases import Mechanism, Suite, World

__all__ = ["SUITE"]

Maker = Callable[[Path, float, np.random.Generator], World]
SOLVER = "rigid"
"""Rows of an instance that name no entity name it."""


def _film(rng: np.random.Generator, *makes: Callable[[int], Film]) -> Film:
    chosen = makes or (scenes.flight, scenes.bounce, scenes.stack, scenes.pushed, scenes.welded)
    return chosen[int(rng.integers(len(chosen)))](int(rng.integers(scenes.VARIANTS)))


def _frame(film: Film, rng: np.random.Generator, first: int = 1) -> int:
    """A frame anywhere, one time in three the last one."""
    return film.count - 1 if rng.random() < 1 / 3 else int(rng.integers(first, film.count))


def _way(rng: np.random.Generator) -> F64:
    way = rng.normal(size=3)
    result: F64 = way / np.linalg.norm(way)
    return result


def _judged(film: Film, folder: Path, *culprits: str) -> World:
    return World(film.candidate(folder), culprits or (SOLVER,))


# ---------------------------------------------------------------- numbers


def not_finite(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """`magnitude` numbers of one channel at one frame are not finite."""
    film = _film(rng)
    frame = film.frames[_frame(film, rng, 0)]
    names = [n for n, v in frame.items() if np.asarray(v).dtype.kind == "f" and np.asarray(v).size and np.asarray(v).ndim]
    name = str(rng.choice(names))
    values = np.array(frame[name])
    spots = rng.choice(values.size, min(values.size, int(magnitude)), replace=False)
    values.reshape(-1)[spots] = rng.choice([np.nan, np.inf, -np.inf])
    frame[name] = values
    return _judged(film, folder, SOLVER)


def off_unit(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    film = _film(rng)
    name, k = free_body(film, rng), _frame(film, rng, 0)
    film.put("quaternion", film.series("quaternion", name) * (1 + magnitude * (np.arange(film.count) == k))[:, None], name)
    return _judged(film, folder, name)


def too_fast(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A body is too fast at one frame only."""
    film = _film(rng)
    name, k = free_body(film, rng), _frame(film, rng, 0)
    speed = film.series("velocity", name)
    speed[k] = magnitude * _way(rng)
    film.put("velocity", speed, name)
    return _judged(film, folder, name)


def too_fast_between(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A body is too fast within a frame, and as slow as before at its end: only the record of the steps shows it."""
    film = _film(rng)
    peak = film.series("record/max_speed")
    peak[_frame(film, rng)] = magnitude
    film.set_record("max_speed", peak)
    return _judged(film, folder)


def spike(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """An explosion below the limit of speed, hidden within a frame: `magnitude` times what frames show."""
    film = _film(rng, scenes.slide, scenes.cradle)
    k = int(rng.integers(3, film.count))
    speed = np.linalg.norm(film.series("velocity"), axis=2).max(axis=1)
    centers = film.series("position")
    way = np.linalg.norm(np.diff(centers, axis=0), axis=2).max(axis=1) / film.duration
    shown = max(speed[k - 1], speed[k], way[k - 1]) + 9.81 * film.duration + 0.05
    peak = film.series("record/max_speed")
    peak[k] = magnitude * shown
    film.set_record("max_speed", peak)
    film.spec = film.spec.model_copy(
        update={"simulation": film.spec.simulation.model_copy(update={"limits": Limits(max_speed=1500.0)})}
    )
    return _judged(film, folder)


def teleport(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A body jumps by `magnitude` times the greatest travel, and back at the next frame or not."""
    film = _film(rng)
    name, k = free_body(film, rng), _frame(film, rng)
    limit = (film.spec.simulation.limits.max_speed + 1.0) * film.duration
    own = np.linalg.norm(np.diff(film.series("position", name), axis=0), axis=1).max()
    frames = np.arange(film.count)
    hit = frames == k if rng.random() < 0.5 else frames >= k
    film.add("position", name, hit[:, None] * (magnitude * limit + own) * _way(rng))
    return _judged(film, folder, name)


def blows_up(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A body gets `magnitude` times faster in one frame and takes the energy from nowhere."""
    film = _film(rng, scenes.bounce)
    k = int(rng.integers(2, film.count))
    speed = film.series("velocity", "other")
    film.put("asleep", np.zeros(film.count), "other")
    speed[k] = magnitude * max(0.05, float(np.linalg.norm(speed[k - 1]))) * _way(rng)
    film.put("velocity", speed, "other")
    gain = 0.5 * film.built["other"].bodies[0].mass * float(speed[k] @ speed[k])
    kinetic, potential = film.series("record/kinetic_energy"), film.series("record/potential_energy")
    # The ball's own losses in that frame must not hide what the other one gains.
    lost = max(0.0, float((kinetic + potential)[k - 1] - (kinetic + potential)[k]))
    scale = float(kinetic.max() + np.ptp(potential))
    film.set_record("kinetic_energy", kinetic + (lost + max(gain, 0.1 * scale)) * (np.arange(film.count) >= k))
    return _judged(film, folder, "other")


# ---------------------------------------------------------------- the container


def gone(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """The last frames are missing, or one in the middle."""
    film, count = _film(rng), int(magnitude)
    last = film.count - 1
    frames = [int(rng.integers(1, last))] if count == 1 and rng.random() < 0.5 else list(range(last, last - count, -1))

    def damage(place: Path) -> None:
        for k in frames:
            (place / f"frame_{k:06d}.npz").unlink()

    film.damage.append(damage)
    return _judged(film, folder)


def short(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """The index itself says that there are fewer frames than planned; nothing is missing by it."""
    film, count = _film(rng), int(magnitude)
    film.frames = film.frames[:-count]
    film.index = dataclasses.replace(film.index, frames=len(film.frames))
    return _judged(film, folder)


def flipped_bit(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """Bytes of a frame's file are other ones than were written."""
    film = _film(rng)
    k, seed = _frame(film, rng, 0), int(rng.integers(2**31))

    def damage(place: Path) -> None:
        path = place / f"frame_{k:06d}.npz"
        data, own = bytearray(path.read_bytes()), np.random.default_rng(seed)
        inside = data.find(b"NUMPY") + 128  # past the first member's header: into its numbers
        for _ in range(int(magnitude)):
            data[inside + int(own.integers(0, 16))] ^= 1 << int(own.integers(8))
        path.write_bytes(bytes(data))

    film.damage.append(damage)
    return _judged(film, folder)


def swapped(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """The files of two frames, `magnitude` apart, have changed places."""
    film = _film(rng)
    a = int(rng.integers(0, film.count - int(magnitude)))
    one, two = f"frame_{a:06d}.npz", f"frame_{a + int(magnitude):06d}.npz"

    def damage(place: Path) -> None:
        first, second = (place / one).read_bytes(), (place / two).read_bytes()
        (place / one).write_bytes(second)
        (place / two).write_bytes(first)

    film.damage.append(damage)
    return _judged(film, folder)


def wrong_index(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """The index disagrees with the plan: rate, names, order, engine."""
    film = _film(rng)
    index = film.index
    changes: list[dict[str, Any]] = [
        {"fps": index.fps + int(magnitude)},
        {"solver": "other"},
        {"engine": "none"},
        {"colliders": index.colliders[:-1]},
        {"colliders": (*index.colliders, "ghost")},
        {"bodies": (*index.bodies[:-1], "ghost/body")},
        {"joints": (*index.joints, "ghost")},
    ]
    film.index = dataclasses.replace(index, **changes[int(rng.integers(len(changes)))])
    return _judged(film, folder, SOLVER)


def wrong_rows(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A channel has rows too few or too many at one frame."""
    film = _film(rng)
    frame = film.frames[_frame(film, rng, 0)]
    name = str(rng.choice(["position", "quaternion", "velocity", "angular_velocity", "asleep"]))
    more = np.repeat(frame[name][:1], int(magnitude), axis=0)
    frame[name] = frame[name][:-1] if rng.random() < 0.5 else np.concatenate([frame[name], more])
    return _judged(film, folder)


def lost_channel(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A record is not there at one frame: no evidence, no pass."""
    film = _film(rng)
    name = str(rng.choice(["overflows", "steps", "max_speed", "max_travel_per_step", "iterations_capped", "contacts_max"]))
    for k in rng.choice(film.count, int(magnitude), replace=False):
        del film.frames[int(k)][f"record/{name}"]
    return _judged(film, folder)


# ---------------------------------------------------------------- counters and logs


def warned(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    film = _film(rng)
    film.set_record("overflows", float(int(magnitude)) * (np.arange(film.count) >= _frame(film, rng)))
    return _judged(film, folder)


def capped(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A share of the steps ended at the iteration cap, all of them in a few frames or spread."""
    film = _film(rng)
    steps = film.series("record/steps")
    total, most = np.ceil(magnitude * steps.sum()), np.zeros(film.count)
    for k in rng.permutation(film.count):
        most[k] = min(steps[k], total - most.sum())
    film.set_record("iterations_capped", most)
    return _judged(film, folder)


def coarse(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """Some frames were run with a step `magnitude` times the planned one, and the record of their number says so."""
    film = _film(rng)
    k = _frame(film, rng)
    step, steps = film.series("record/step"), film.series("record/steps")
    step[k] *= magnitude
    steps[k] = np.ceil(film.duration / step[k])
    film.set_record("step", step)
    film.set_record("steps", steps)
    return _judged(film, folder)


def skipped_steps(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A frame has fewer steps than its step takes to cover it."""
    film = _film(rng)
    steps = film.series("record/steps")
    steps[_frame(film, rng)] -= int(magnitude) + 2 * len(film.spec.simulation.drivers)
    film.set_record("steps", steps)
    return _judged(film, folder)


def late_event(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """An event is dated outside its frame by `magnitude` [s], names nobody, or pushes backwards."""
    film = _film(rng, scenes.bounce, scenes.pile, scenes.cradle)
    k = next(k for k, f in enumerate(film.frames) if len(f["event/time"]))
    frame, kind = film.frames[k], int(rng.integers(4))
    if kind == 0:
        frame["event/time"] = frame["event/time"] + film.duration + magnitude
    elif kind == 1:
        frame["event/time"] = frame["event/time"] - film.duration - magnitude
    elif kind == 2:
        frame["contact/pair"] = frame["contact/pair"] + np.int32(len(film.index.colliders))
    else:
        frame["event/impulse"] = -frame["event/impulse"] - magnitude
    return _judged(film, folder, SOLVER)


# ---------------------------------------------------------------- repeats and sleep


def repeated(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A frame is there twice in a moving sequence, with what follows late or not (magnitude: how often)."""
    film = _film(rng, scenes.flight, scenes.slide, scenes.thrown_pair)
    k, times = int(rng.integers(1, film.count - int(magnitude))), int(magnitude)
    for j in range(1, times + 1):
        film.frames[k + j] = dict(film.frames[k])
    moving = [b.split("/")[0] for b in film.index.bodies]
    return _judged(film, folder, *moving)


def sleeps_aloft(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A sleeping body is `magnitude` above what carries it; one of its sides may overlap a wall's box."""
    film = _resting(rng, gap=magnitude)
    return _judged(film, folder, "sleeper")


def sleeps_over_a_bowl(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A body sleeps in the middle of a frame of walls, whose box it is inside of, and touches none (magnitude: gap)."""
    half = 0.1 + magnitude
    entities = {
        "frame": frame_of_walls(half),
        "sleeper": box(0.2, 0.2, 0.2, motion="dynamic", at=(0, 0, 0.3)),
        "other": ball(0.05, motion="dynamic", at=(2, 0, 1.0)),
    }
    film = film_of(world(entities, frames=6, settings=RigidSettings(step=2e-3)))
    still(film, "sleeper", np.array([0, 0, 0.3]))
    return _judged(film, folder, "sleeper")


def _resting(rng: np.random.Generator, *, gap: float) -> Film:
    """A body that sleeps with a gap below it, on a slab, a table or another sleeper."""
    height = float(rng.choice([0.0, 0.7]))
    at = np.array([50.0, 0, 0]) * int(rng.integers(2))
    size = float(rng.uniform(0.05, 0.4))
    entities = {
        "floor": box(8, 8, 0.2, at=at + np.array([0, 0, -0.1])),
        "table": box(1, 1, max(height, 0.05), at=at + np.array([3.0 if height == 0 else 0.0, 0, max(height, 0.05) / 2])),
        "sleeper": box(size, size, size, motion="dynamic", at=at + np.array([0, 0, height + size / 2 + 0.001])),
        "other": ball(0.05, motion="dynamic", at=at + np.array([2, 2, 1.0])),
    }
    film = film_of(world(entities, frames=6, settings=RigidSettings(step=2e-3)))
    still(film, "sleeper", at + np.array([0, 0, height + size / 2 + gap]))
    return film


def creeps(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A sleeping body creeps by `magnitude` per frame."""
    film = _resting(rng, gap=0.001)
    film.add("position", "sleeper", magnitude * np.arange(film.count)[:, None] * np.array([1.0, 0, 0]))
    return _judged(film, folder, "sleeper")


# ---------------------------------------------------------------- sound worlds


def _sound(make: Callable[[int], Film]) -> Maker:
    def build(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
        return World(make(int(magnitude) % scenes.VARIANTS).candidate(folder))

    return build


def fast(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A bullet just below the limit of speed."""
    way = _way(rng) * magnitude
    entities = {"floor": ground(40.0), "bullet": ball(0.2, motion="dynamic", at=(0, 0, 30.0), velocity=tuple(way))}
    return World(film_of(world(entities, frames=6, gravity=(0, 0, 0), settings=RigidSettings(step=1e-3))).candidate(folder))


def nearly_capped(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A share of steps below the bound ends at the cap, all of them in one frame."""
    film = _film(rng)
    steps = film.series("record/steps")
    film.set_record("iterations_capped", (np.arange(film.count) == 2) * min(np.floor(magnitude * steps.sum()), steps[2]))
    return World(film.candidate(folder))


def nearly_unit(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    film = _film(rng)
    film.put("quaternion", film.series("quaternion") * (1 + magnitude))
    return World(film.candidate(folder))


def kicked(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A resting ball gets far faster in one frame because another one hits it: no energy is new."""
    speed = float(magnitude)
    entities = {
        "left": ball(0.1, motion="dynamic", at=(-1.0, 0, 1), velocity=(speed, 0, 0)),
        "right": ball(0.1, motion="dynamic", at=(0.3, 0, 1)),
    }
    film = film_of(world(entities, frames=14, gravity=(0, 0, 0), settings=RigidSettings(step=1e-3)))
    return World(film.candidate(folder))


def rests_near(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A body sleeps with a gap below it that still counts as contact."""
    return World(_resting(rng, gap=magnitude).candidate(folder))


def sleeps_hanging(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A pendulum hangs asleep: nothing touches it, its joint holds it."""
    size = float(magnitude)
    entities = {"floor": ground(), "bob": box(size, size, size, motion="dynamic", at=(0, 0, 2.0))}
    joints = {"pivot": HingeJoint(child="bob", anchor=(0, 0, 2.5), axis=(0, 1, 0))}
    film = film_of(world(entities, joints=joints, frames=6, settings=RigidSettings(step=2e-3)))
    film.put("asleep", np.ones(film.count), "bob")
    return World(film.candidate(folder))


def sleeps_weightless(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """Without gravity a body may sleep anywhere, and frames repeat to the last bit."""
    entities = {"floor": ground(), "bob": ball(float(magnitude), motion="dynamic", at=(0, 0, 2.0))}
    film = film_of(world(entities, gravity=(0, 0, 0), frames=6, settings=RigidSettings(step=2e-3)))
    film.put("asleep", np.ones(film.count), "bob")
    return World(film.candidate(folder))


def one_turn_per_frame(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A disk spins in place so that every frame shows the same picture."""
    turns = int(magnitude)
    entities = {"floor": ground(), "disk": ball(0.2, motion="dynamic", at=(0, 0, 2.0))}
    entities["disk"] = scenes._moving(entities["disk"], spin=(0, 0, 2 * np.pi * 24 * turns))
    film = film_of(world(entities, gravity=(0, 0, 0), frames=6, settings=RigidSettings(step=2e-4)))
    return World(film.candidate(folder))


def _defect(
    name: str, text: str, build: Maker, low: float, high: float, unit: str, bound: float | None = None, **more: Any
) -> Mechanism:
    return Mechanism(name, text, True, build, low, high, unit, bound, **more)


def _clean(name: str, text: str, make: Callable[[int], Film]) -> Mechanism:
    return Mechanism(name, text, False, _sound(make), 1.0, float(scenes.VARIANTS), "variant", named=(1.0, 3.0))


SUITE = Suite(
    "numerical",
    (
        _defect("not_finite", "numbers are not finite at one frame", not_finite, 1.0, 10.0, "numbers"),
        _defect("off_unit", "a quaternion is no rotation", off_unit, 1.05e-6, 0.5, "1", 1e-6),
        _defect("too_fast", "a body is too fast at one frame", too_fast, 60.1, 5000.0, "m/s", 60.0),
        _defect("too_fast_between", "a body is too fast between two frames", too_fast_between, 60.1, 5000.0, "m/s", 60.0),
        _defect("spike", "an explosion within a frame that its ends do not show", spike, 20.2, 200.0, "1", 20.0),
        _defect("teleport", "a body jumps", teleport, 1.05, 20.0, "bounds", 1.0),
        _defect("blows_up", "a body gets far faster in one frame, with energy from nowhere", blows_up, 20.2, 400.0, "1", 20.0),
        _defect("gone", "frames are missing", gone, 1.0, 5.0, "frames"),
        _defect("short", "the index says less than the plan", short, 1.0, 5.0, "frames"),
        _defect("flipped_bit", "bytes of a frame changed", flipped_bit, 1.0, 1.0, "bits", named=(1.0, 1.0)),
        _defect("swapped", "two frames changed places", swapped, 1.0, 8.0, "frames"),
        _defect("wrong_index", "the index names other things than the plan", wrong_index, 1.0, 30.0, "1"),
        _defect("wrong_rows", "a channel has rows too few or too many", wrong_rows, 1.0, 3.0, "rows"),
        _defect("lost_channel", "a record is missing", lost_channel, 1.0, 5.0, "frames", finds=("unverified",)),
        _defect("warned", "the engine warned of full buffers", warned, 1.0, 50.0, "warnings"),
        _defect("capped", "steps end at the iteration cap", capped, 0.0505, 1.0, "1", 0.05),
        _defect("coarse", "a frame was run with too long a step", coarse, 1.01, 5.0, "1", 1.0),
        _defect("skipped_steps", "a frame has too few steps", skipped_steps, 1.0, 20.0, "steps"),
        _defect(
            "through_the_pane", "a ball is too fast for the pane that it flies at", through_the_pane, 1.05, 6.0, "bounds", 1.0
        ),
        _defect(
            "at_the_arm", "a ball is too fast for the thin arm of a lamp that it flies at", at_the_arm, 1.1, 6.0, "bounds", 1.0
        ),
        _defect("coarse_travel", "a body travels too far in a step", coarse_travel, 1.02, 10.0, "bounds", 1.0),
        _defect("late_event", "an event outside its frame, with nobody, or backwards", late_event, 1e-3, 10.0, "s"),
        _defect("repeated", "a frame is there twice", repeated, 1.0, 4.0, "frames"),
        _defect("sleeps_aloft", "a body sleeps in the air", sleeps_aloft, 3.1e-3, 0.5, "m", 3e-3),
        _defect("sleeps_over_a_bowl", "a body sleeps among walls it does not touch", sleeps_over_a_bowl, 3.2e-3, 0.2, "m", 3e-3),
        _defect("creeps", "a sleeping body creeps", creeps, 1.05e-6, 0.01, "m", 1e-6),
        *contact_log.MECHANISMS,
        _clean("flight", "thrown bodies that tumble fast", scenes.flight),
        _clean("bounce", "bounces between two frames: fastest where no frame shows it", scenes.bounce),
        _clean("stack", "bodies that sleep, wake and sleep again", scenes.stack),
        _clean("pushed", "drivers that switch between frames: more steps than planned, short ones", scenes.pushed),
        _clean("welded", "joints under load", scenes.welded),
        _clean("pile", "many contacts at once", scenes.pile),
        _clean("roped", "a rope snaps taut", scenes.roped),
        Mechanism("fast", "a bullet below the limit of speed", False, fast, 20.0, 59.9, "m/s", named=(59.9,)),
        Mechanism("nearly_capped", "as many capped steps as allowed", False, nearly_capped, 0.01, 0.0499, "1", named=(0.0499,)),
        Mechanism("nearly_unit", "quaternions off by rounding", False, nearly_unit, 1e-9, 9e-7, "1", named=(9e-7,)),
        Mechanism("kicked", "a resting ball is hit: a thousand times faster in one frame", False, kicked, 2.0, 30.0, "m/s"),
        Mechanism("rests_near", "a gap below a sleeper that still counts as contact", False, rests_near, 1e-4, 2.9e-3, "m"),
        Mechanism("sleeps_hanging", "a pendulum hangs asleep", False, sleeps_hanging, 0.05, 0.5, "m", named=(0.2,)),
        Mechanism(
            "sleeps_weightless", "a body floats asleep without gravity", False, sleeps_weightless, 0.05, 0.5, "m", named=(0.2,)
        ),
        Mechanism(
            "one_turn_per_frame",
            "every frame shows the same picture of a spinning disk",
            False,
            one_turn_per_frame,
            1.0,
            3.0,
            "turns",
        ),
        Mechanism("past_the_pane", "a ball flies past a pane, too fast to meet it", False, past_the_pane, 0.01, 3.0, "m"),
        Mechanism(
            "at_the_foot",
            "a ball strikes a lamp's foot, far below an arm that it is too fast for",
            False,
            at_the_foot,
            0.3,
            2.0,
            "m",
        ),
        Mechanism("thin_and_slow", "a card thinner than paper", False, thin_and_slow, 1.2e-4, 1e-3, "m"),
        *START_MECHANISMS,
    ),
)
