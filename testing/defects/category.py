"""Seeded defects of the category check (rigid bodies): motion without a cause, contacts against their law, joints, records.

Every world is run by the engine first. A broken one is then changed in one way that physics rules out, and whatever an
adversary would change with it (records, the contact log) is changed too; or its specification is, so that what was run is no
longer what was declared.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from ...worlds.arrays import F64, quaternion_product
from ...worlds.spec import HingeJoint, SpringJoint, WorldSpec
from . import _scenes as scenes
from ._films import Film
from ._impacts import IMPACTS
from ._lifted import LIFTED
from .cases import Mechanism, Suite, World

__all__ = ["SUITE"]

Maker = Callable[[Path, float, np.random.Generator], World]


def _pick(make: Callable[[int], Film], rng: np.random.Generator) -> Film:
    return make(int(rng.integers(scenes.VARIANTS)))


def _direction(rng: np.random.Generator) -> F64:
    way = rng.normal(size=3)
    result: F64 = way / np.linalg.norm(way)
    return result


def _frame(film: Film, rng: np.random.Generator, first: int = 2) -> int:
    """A frame anywhere, one time in three the last one."""
    return film.count - 1 if rng.random() < 1 / 3 else int(rng.integers(first, film.count))


def _broken(film: Film, folder: Path, *culprits: str) -> World:
    return World(film.candidate(folder), culprits)


def _declare(film: Film, change: Callable[[dict[str, Any]], None]) -> Film:
    """The same motion under another specification."""
    data = film.spec.model_dump(mode="json")
    change(data)
    return dataclasses.replace(film, spec=WorldSpec.model_validate(data))


# ---------------------------------------------------------------- motion without a cause


def ghost_push(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    film = _pick(scenes.flight, rng)
    name = str(rng.choice(["thrown", "small"]))
    film.push(name, _frame(film, rng), magnitude * _direction(rng))
    film.settle_records()
    return _broken(film, folder, name)


def slow_fall(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """Gravity acts on one body with a share less than on the others, from a frame on."""
    film = _pick(scenes.flight, rng)
    name, start = str(rng.choice(["thrown", "small"])), int(rng.integers(0, film.count - 2))
    late = np.clip(np.arange(film.count) - start, 0, None)[:, None] * film.duration
    lift = -magnitude * np.array(film.spec.simulation.gravity)
    film.add("velocity", name, lift * late)
    film.add("position", name, 0.5 * lift * late**2)
    film.settle_records()
    return _broken(film, folder, name)


def stop(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A body hangs still for one frame (magnitude 1) or slows down for it, and flies on as if nothing had been."""
    film = _pick(scenes.flight, rng)
    name, k = str(rng.choice(["thrown", "small"])), _frame(film, rng)
    speed = film.series("velocity", name)
    change = np.zeros_like(speed)
    change[k] = -magnitude * speed[k]
    film.add("velocity", name, change)
    film.settle_records()
    return _broken(film, folder, name)


def jump(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A body is displaced at one frame, or from one on, with velocities as they were."""
    film = _pick(scenes.flight, rng)
    name, k = str(rng.choice(["thrown", "small"])), _frame(film, rng)
    frames = np.arange(film.count)
    hit = frames == k if rng.random() < 0.5 else frames >= k
    film.add("position", name, hit[:, None] * magnitude * _direction(rng))
    film.settle_records()
    return _broken(film, folder, name)


def spin_up(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """The small ball starts to spin, without a torque, and turns as it says."""
    film = _pick(scenes.flight, rng)
    k, axis = _frame(film, rng), _direction(rng)
    frames = np.arange(film.count)
    film.add("angular_velocity", "small", (frames >= k)[:, None] * magnitude * axis)
    angle = magnitude * film.duration * np.clip(frames - k + 0.5, 0, None)
    _turn(film, "small", axis, angle)
    film.settle_records()
    return _broken(film, folder, "small")


def _turn(film: Film, name: str, axis: F64, angle: F64) -> None:
    quaternion = np.concatenate([np.cos(angle / 2)[:, None], np.sin(angle / 2)[:, None] * axis], axis=1)
    film.put("quaternion", quaternion_product(quaternion, film.series("quaternion", name)), name)


def twist(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A ball is turned at one frame only, without turning: nobody sees it but the numbers."""
    film = _pick(scenes.flight, rng)
    k = _frame(film, rng)
    _turn(film, "small", _direction(rng), magnitude * (np.arange(film.count) == k))
    film.settle_records()
    return _broken(film, folder, "small")


def forged_contact(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A push in the air with a contact logged as its cause, whose partner is far below."""
    film = _pick(scenes.flight, rng)
    k = int(rng.integers(1, film.count - 2))
    body = film.built["small"].bodies[0]
    change = magnitude * _direction(rng)
    film.push("small", k, change)
    film.touch(k, "small", "floor", body.mass * change)
    film.settle_records()
    return _broken(film, folder, "small")


def unlogged_hit(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """Two bodies meet in the air; the meeting is not in the log, or only a share of its impulse (magnitude: share missing)."""
    film = _pick(scenes.thrown_pair, rng)
    for frame in film.frames:
        for name in ("contact/impulse", "contact/vector"):
            frame[name] = frame[name] * (1.0 - magnitude)
        if magnitude == 1.0:
            film.drop_contacts("left")
    return _broken(film, folder, "left", "right")


def third_law(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """After a hit in the air, one of the two leaves a little faster than the other's recoil allows."""
    film = _pick(scenes.thrown_pair, rng)
    hit = next(k for k, f in enumerate(film.frames) if len(f["contact/impulse"]))
    name = str(rng.choice(["left", "right"]))
    body = film.built[name].bodies[0].mass
    share = sum(e.bodies[0].mass for n, e in film.built.items() if n in ("left", "right")) / body
    film.push(name, hit, magnitude * share * _direction(rng))
    film.settle_records()
    return _broken(film, folder, "left", "right")


# ---------------------------------------------------------------- contacts against their law


def other_restitution(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A ball bounces by `magnitude` more or less than declared.

    One that does not bounce at all is left out: frames cannot tell whether it rests or hops for less than one of them.
    """
    film = scenes.bounce(int(rng.integers(1, scenes.VARIANTS)))

    def change(data: dict[str, Any]) -> None:
        kept = data["materials"]["wood"]["restitution"]
        ways = [w for w in (kept - magnitude, kept + magnitude) if 0 <= w <= 1]
        data["materials"]["wood"]["restitution"] = float(rng.choice(ways)) if ways else (0.0 if kept > 0.5 else 1.0)

    return _broken(_declare(film, change), folder, "ball")


def bounces_higher(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A ball leaves a hit with `magnitude` times its closing speed, log and records changed with it."""
    film = _pick(scenes.bounce, rng)
    hit = next(
        k for k, f in enumerate(film.frames) if len(f["event/time"]) and film.index.colliders.index("ball") in f["event/pair"]
    )
    data = film.frames[hit]
    which = int(np.flatnonzero((data["event/pair"] == film.index.colliders.index("ball")).any(axis=1))[0])
    mine = (data["contact/pair"] == film.index.colliders.index("ball")).any(axis=1)
    later = data["contact/pair"][:, 1] == film.index.colliders.index("ball")
    closing = float(data["event/speed"][which])
    declared = film.spec.materials["wood"].restitution
    more = max(magnitude - declared, 0.3) * closing
    data["contact/impulse"] = data["contact/impulse"] + mine * more * film.built["ball"].bodies[0].mass
    upward = np.where(later, 1.0, -1.0) * mine * more * film.built["ball"].bodies[0].mass
    data["contact/vector"] = data["contact/vector"] + upward[:, None] * np.array([0.0, 0.0, 1.0])
    late = np.clip(np.arange(film.count) / film.spec.simulation.fps - float(data["event/time"][which]), 0, None)
    film.add("velocity", "ball", (late > 0)[:, None] * np.array([0, 0, more]))
    film.add("position", "ball", late[:, None] * np.array([0, 0, more]))
    for frame in film.frames[hit + 1 :]:
        for kind in ("contact", "event"):
            keep = ~(frame[f"{kind}/pair"] == film.index.colliders.index("ball")).any(axis=1)
            for channel in [n for n in frame if n.startswith(f"{kind}/")]:
                frame[channel] = frame[channel][keep]
    film.settle_records()
    return _broken(film, folder, "ball")


def other_friction(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A box slides with a friction that is off the declared one by a share."""
    film = _pick(scenes.slide, rng)
    factor = float(rng.choice([1.0 + magnitude, 1.0 / (1.0 + magnitude)]))

    def change(data: dict[str, Any]) -> None:
        data["materials"]["wood"]["friction"] *= factor

    return _broken(_declare(film, change), folder, "box")


def rest_friction(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A box slides with the static friction, larger by a share, in place of that of motion."""
    film = _pick(scenes.slide, rng)

    def change(data: dict[str, Any]) -> None:
        wood = data["materials"]["wood"]
        wood["static_friction"], wood["friction"] = wood["friction"], wood["friction"] / (1.0 + magnitude)

    return _broken(_declare(film, change), folder, "box")


def brakes(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A sliding box loses `magnitude` times more speed in one frame than the cone of friction allows."""
    film = _pick(scenes.slide, rng)
    k = int(rng.integers(2, 8))
    speed = film.series("velocity", "box")
    lost = (1.0 + magnitude) * film.spec.materials["wood"].friction * 9.81 * film.duration
    film.push("box", k, -lost * speed[k] / np.linalg.norm(speed[k]))
    film.settle_records()
    return _broken(film, folder, "box")


# ---------------------------------------------------------------- joints, springs, drivers


def joint_gap(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A joint is open by `magnitude` times its bound, at one frame or from one on."""
    make, name, part = [
        (scenes.pendulum, "bob", "body"),
        (scenes.welded, "tail", "body"),
        (scenes.welded, "right", "body"),
        (scenes.roped, "rope", "s2"),
    ][int(rng.integers(4))]
    film = _pick(make, rng)
    parts = film.built[name].parts_of(part)
    size = float(np.linalg.norm(np.ptp(np.concatenate([p.render.vertices for p in parts]), axis=0)))
    frames, k = np.arange(film.count), _frame(film, rng)
    hit = frames == k if rng.random() < 0.5 else frames >= k
    film.add("position", name, hit[:, None] * magnitude * max(1e-3, 0.01 * size) * _direction(rng), part)
    return _broken(film, folder, name)


def weld_drift(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A welded part turns away slowly, by `magnitude` [rad] in the end."""
    film = _pick(scenes.welded, rng)
    _turn(film, "tail", _direction(rng), magnitude * np.linspace(0, 1, film.count))
    return _broken(film, folder, "tail")


def out_of_range(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A pendulum swings `magnitude` [rad] beyond a stop that is declared."""
    film = _pick(scenes.pendulum, rng)
    swing = film.series("joint")[:, film.index.joints.index("pivot")]
    largest = float(np.abs(swing).max())

    def change(data: dict[str, Any]) -> None:
        data["simulation"]["joints"]["pivot"]["range"] = (-largest + magnitude, largest - magnitude)

    assert isinstance(film.spec.simulation.joints["pivot"], HingeJoint)
    return _broken(_declare(film, change), folder, "bob")


def wrong_spring(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A spring pulls with another stiffness than declared (share)."""
    film = _pick(scenes.sprung, rng)
    name = str(rng.choice(["hang", "pull"]))
    joint = film.spec.simulation.joints[name]
    assert isinstance(joint, SpringJoint)

    def change(data: dict[str, Any]) -> None:
        data["simulation"]["joints"][name]["stiffness"] *= 1.0 + magnitude * float(rng.choice([-0.9, 1.0]))

    return _broken(_declare(film, change), folder, joint.child, joint.parent or joint.child)


def off_path(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A driven body is `magnitude` beside its path at one frame."""
    film = _pick(scenes.pushed, rng)
    film.add("position", "pusher", (np.arange(film.count) == _frame(film, rng))[:, None] * magnitude * _direction(rng))
    return _broken(film, folder, "pusher")


def creeping_hold(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A body that is held until its release moves before it."""
    film = _pick(scenes.pushed, rng)
    film.add("position", "late", (np.arange(film.count) >= 1)[:, None] * magnitude * _direction(rng))
    return _broken(film, folder, "late")


def other_force(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A force driver pushed with another force than declared (share)."""
    film = _pick(scenes.pushed, rng)

    def change(data: dict[str, Any]) -> None:
        force = data["simulation"]["drivers"]["burn"]["force"]
        data["simulation"]["drivers"]["burn"]["force"] = [f * (1.0 + magnitude) for f in force]

    return _broken(_declare(film, change), folder, "rocket")


# ---------------------------------------------------------------- records


def cooked_records(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A recorded energy or momentum is off by a share of what is in play."""
    film = _pick(scenes.flight, rng)
    name = str(rng.choice(["kinetic_energy", "potential_energy", "momentum_x", "momentum_z"]))
    k = _frame(film, rng)
    values = film.series(f"record/{name}")
    energy = film.series("record/kinetic_energy")
    scale = float(energy.max() + np.ptp(film.series("record/potential_energy")))
    if name.startswith("momentum"):
        masses = [film.built[n].bodies[0].mass for n in ("thrown", "small")]
        scale = max(
            sum(
                m * float(np.linalg.norm(film.series("velocity", n)[j])) for m, n in zip(masses, ("thrown", "small"), strict=True)
            )
            for j in range(film.count)
        )
    values[k] += magnitude * scale
    film.set_record(name, values)
    return _broken(film, folder, "thrown", "small")


def energy_gain(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """Energy appears in a swinging pendulum, `magnitude` of what is in play, where joints hide the force."""
    film = _pick(scenes.pendulum, rng)
    kinetic = film.series("record/kinetic_energy")
    scale = float(kinetic.max() + np.ptp(film.series("record/potential_energy")))
    k = int(np.argmax(kinetic[2:])) + 2
    # From the fastest frame on: no later loss can hide it, nor can damping before.
    own = _kinetic(film, "bob")
    factor = np.ones(film.count)
    factor[k] = np.sqrt(1.0 + (magnitude * scale + max(0.0, float(_lost(film, k)))) / max(own[k], 1e-12))
    for channel in ("velocity", "angular_velocity"):
        film.put(channel, film.series(channel, "bob") * factor[:, None], "bob")
    film.settle_records()
    return _broken(film, folder, "bob", "block")


def _kinetic(film: Film, name: str) -> F64:
    body = film.built[name].bodies[0]
    from ...worlds.arrays import rotation_matrix

    local = np.einsum("fji,fj->fi", rotation_matrix(film.series("quaternion", name)), film.series("angular_velocity", name))
    linear = film.series("velocity", name)
    result: F64 = 0.5 * body.mass * (linear**2).sum(axis=1) + 0.5 * np.einsum("fi,ij,fj->f", local, body.inertia, local)
    return result


def _lost(film: Film, k: int) -> float:
    """Energy lost from the lowest point so far to frame k [J], which a gain has to make up for before it is one."""
    energy = film.series("record/kinetic_energy") + film.series("record/potential_energy") - film.series("record/driver_work")
    return float(energy[:k].min() - energy[k])


def forged_work(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """Work is recorded in one frame although no driver acts, as an excuse for energy (share of what is in play)."""
    film = _pick(scenes.bounce, rng)
    k = _frame(film, rng)
    scale = float(film.series("record/kinetic_energy").max() + np.ptp(film.series("record/potential_energy")))
    film.set_record("driver_work", (np.arange(film.count) >= k) * magnitude * scale)
    return _broken(film, folder, "ball", "other")


def other_mass(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """The bodies that were run are heavier than the built ones by a share."""
    film = _pick(scenes.flight, rng)
    body = film.built["thrown"].bodies[0]
    lighter = dataclasses.replace(body, mass=body.mass / (1 + magnitude), inertia=body.inertia / (1 + magnitude))
    film.built["thrown"] = dataclasses.replace(film.built["thrown"], bodies=(lighter,))
    return _broken(film, folder, "thrown", "small")


def static_moves(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """The cache moves what is declared static, with counts to match."""
    film = _pick(scenes.flight, rng)
    film.index = dataclasses.replace(film.index, bodies=(*film.index.bodies, "floor/body"))
    start = np.array(film.spec.entities["floor"].pose.position)
    for k, frame in enumerate(film.frames):
        more = {
            "position": start + magnitude * k * np.array([1.0, 0.0, 0.0]),
            "quaternion": [1, 0, 0, 0],
            "velocity": [magnitude / film.duration, 0, 0],
        }
        for channel, value in (more | {"angular_velocity": [0, 0, 0]}).items():
            frame[channel] = np.concatenate([frame[channel], np.array([value], dtype=np.float64)])
        frame["asleep"] = np.append(frame["asleep"], np.uint8(0))
        frame["record/body_count"] = np.float64(3)
    return _broken(film, folder, "floor")


# ---------------------------------------------------------------- sound worlds


def _sound(make: Callable[[int], Film]) -> Maker:
    def build(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
        return World(make(int(magnitude) % scenes.VARIANTS).candidate(folder))

    return build


def almost_pushed(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """Rounding: velocities that are off by a little less than the bound."""
    film = _pick(scenes.flight, rng)
    film.push("thrown", _frame(film, rng), magnitude * _direction(rng))
    film.settle_records()
    return World(film.candidate(folder))


def other_sign(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A quaternion and its negative are the same orientation; writers flip it as they please."""
    film = _pick(scenes.flight, rng)
    sign = np.where(rng.random(film.count) < 0.5, -1.0, 1.0)[:, None]
    film.put("quaternion", sign * film.series("quaternion", "thrown"), "thrown")
    return World(film.candidate(folder))


_COUNT = float(scenes.VARIANTS)
G_FRAME = 9.81 / 30.0
"""[m/s] What gravity gives in a frame of the fastest of the flights."""


def _defect(name: str, text: str, build: Maker, low: float, high: float, unit: str, bound: float | None = None) -> Mechanism:
    return Mechanism(name, text, True, build, low, high, unit, bound)


def _clean(name: str, text: str, make: Callable[[int], Film]) -> Mechanism:
    return Mechanism(name, text, False, _sound(make), 1.0, _COUNT, "variant", named=(1.0, 3.0))


SUITE = Suite(
    "category",
    (
        _defect("ghost_push", "a body in flight changes its velocity without a contact", ghost_push, 2.1e-3, 5.0, "m/s", 2e-3),
        _defect(
            "slow_fall",
            "a body falls more slowly than the others: it hovers",
            slow_fall,
            1.05 * 2e-3 / G_FRAME,
            1.0,
            "1",
            2e-3 / G_FRAME,
        ),
        _defect("stop", "a body hangs still in the air for one frame", stop, 0.01, 1.0, "1"),
        _defect("jump", "a body is displaced beside what its velocity says", jump, 8e-4, 0.5, "m", 6e-4),
        _defect("spin_up", "a ball starts to spin without a torque", spin_up, 6e-3, 50.0, "rad/s", 5e-3),
        _defect("twist", "a ball is turned at one frame only", twist, 2.1e-3, 3.0, "rad", 2e-3),
        _defect(
            "forged_contact",
            "a push in the air, with a contact logged whose partner is far away",
            forged_contact,
            2.1e-3,
            2.0,
            "m/s",
        ),
        _defect("unlogged_hit", "two bodies meet and the log misses a share of the impulse", unlogged_hit, 0.2, 1.0, "1"),
        _defect("third_law", "of two that meet in the air one leaves too fast", third_law, 2.1e-3, 1.0, "m/s", 2e-3),
        _defect("other_restitution", "a ball bounces otherwise than declared", other_restitution, 0.07, 0.5, "1", 0.05),
        _defect("bounces_higher", "a ball leaves a hit faster than it came", bounces_higher, 1.1, 2.0, "1"),
        _defect("other_friction", "a box slides with another friction than declared", other_friction, 0.06, 0.5, "1", 0.05),
        _defect("rest_friction", "a box slides with the friction of rest", rest_friction, 0.06, 0.9, "1", 0.05),
        _defect("brakes", "a sliding box brakes more than friction can", brakes, 0.06, 3.0, "1"),
        _defect("joint_gap", "a joint is open", joint_gap, 1.05, 50.0, "bounds", 1.0),
        _defect("weld_drift", "a weld turns away slowly", weld_drift, 0.011, 0.5, "rad", 0.01),
        _defect("out_of_range", "a hinge turns beyond its stop", out_of_range, 0.05, 0.5, "rad"),
        _defect("wrong_spring", "a spring pulls with another stiffness than declared", wrong_spring, 0.1, 1.0, "1"),
        _defect("off_path", "a driven body is beside its path", off_path, 1.05e-5, 0.3, "m", 1e-5),
        _defect("creeping_hold", "a held body moves before its release", creeping_hold, 1.05e-5, 0.3, "m", 1e-5),
        _defect("other_force", "a force driver pushed otherwise than declared", other_force, 0.02, 1.0, "1"),
        _defect(
            "cooked_records", "recorded energy or momentum is not that of the motion", cooked_records, 1.05e-3, 0.5, "1", 1e-3
        ),
        _defect("energy_gain", "a pendulum gains energy from nowhere", energy_gain, 0.021, 0.5, "1", 0.02),
        _defect("forged_work", "work is recorded where no driver acts", forged_work, 0.0105, 0.5, "1", 0.01),
        _defect("other_mass", "bodies are heavier than built", other_mass, 1e-6, 0.5, "1"),
        _defect("static_moves", "the cache moves a static entity", static_moves, 1e-6, 0.1, "m"),
        _clean("flight", "fast tumbling of rods and plates: angular velocity changes, angular momentum does not", scenes.flight),
        _clean("bounce", "bounces from none to perfect restitution", scenes.bounce),
        _clean("slide", "boxes slide down and along, at the cone of friction all the time", scenes.slide),
        _clean("gripped", "on a ramp between the angles of motion and of rest one box stays and one slides", scenes.gripped),
        _clean("pendulum", "damped pendulum and a sliding block with dry friction lose energy", scenes.pendulum),
        _clean("welded", "two bodies move as one; a thrown knee flaps", scenes.welded),
        _clean("roped", "a rope falls and snaps taut", scenes.roped),
        _clean("sprung", "springs exchange energy and momentum", scenes.sprung),
        _clean("pushed", "path, motor, force and release add energy legally, switched between frames", scenes.pushed),
        _clean("stack", "a stack jitters to rest, sleeps, and is woken by a late ball", scenes.stack),
        _clean("cradle", "momentum travels through a row of balls within a frame", scenes.cradle),
        _clean("thrown_pair", "two bodies, up to 20 times unlike, bounce off each other in the air", scenes.thrown_pair),
        _clean("pile", "boxes fall on each other and keep nothing of their speed", scenes.pile),
        *IMPACTS,
        *LIFTED,
        Mechanism("almost_pushed", "velocities off by less than the bound", False, almost_pushed, 1e-6, 1.5e-3, "m/s"),
        Mechanism("other_sign", "quaternions flip their sign", False, other_sign, 1.0, 6.0, "variant", named=(1.0, 3.0)),
    ),
)
