"""Laws of motion on the ledgers of a rigid instance: what moves has a reason, between every two frames.

- `momentum`: linear momentum changes by gravity, drivers, drag, springs, liquids and logged contacts, and by nothing else (Newton's
  second law; what a contact gives one body it takes from the other, his third).
- `motion`: centres of mass move by their velocities, and no faster than the fastest step that was recorded.
- `spin`, `turning`: free bodies turn by Euler's equations; in contact, angular momentum changes by at most the logged
  impulses times the body's reach.
- `driven`: bodies on paths are where the path says, held ones stay.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ....worlds.arrays import F64, pose_of, rotation_matrix
from ....worlds.fields import lifted_members
from ....worlds.spec import PathDriver
from ...ledgers.balance import Books, Flags
from ...ledgers.sleep_impulses import rests_of, strangest
from ...ledgers.tumbling import tumble
from .bounds import BUDGET_NOISE, FASTER, HELD, IMPULSE, JOINTED, PLACE, SPIN, TURN, UNSTEADY
from .corrections import declare_source
from .rows import Law
from .speeds import angle_of, most_of_bodies, surface_speeds

if TYPE_CHECKING:
    from ...rows.findings import Finding

__all__ = [
    "driven",
    "momentum",
    "motion",
    "spin",
    "turning",
    "unexplained",
]


class Unexplained(NamedTuple):
    """Velocity without a source per interval and entity [m/s], shape (F - 1, E), and where it could be judged."""

    value: F64
    judged: Flags


Labels = NDArray[np.int64]


class _Groups(NamedTuple):
    """Sums over groups of entities, per label: shape (K,) or (K, 3)."""

    mass: F64
    residual: F64
    given: F64
    """By contacts."""
    budget: F64
    doubt: F64
    open: Flags


def _summed(label: Labels, values: F64) -> F64:
    """Sums of values of intervals and entities, shape (F - 1, E, ...), over the groups that labels name, shape (K, ...)."""
    result = np.zeros((int(label.max(initial=-1)) + 1, *values.shape[2:]))
    np.add.at(result, label, values)
    return result


def _grouped(books: Books, label: Labels, opened: Flags) -> _Groups:
    rests = rests_of(books)
    return _Groups(
        _summed(label, np.broadcast_to(books.mass, label.shape)),
        _summed(label, books.residual - rests.held),
        _summed(label, books.contact_given),
        _summed(label, books.contact_budget + rests.passed_on),
        _summed(label, books.spring_impulse[1] + books.let_go_doubt[0]),
        _summed(label, opened.astype(np.float64)) > 0.0,
    )


def _lag(books: Books, label: Labels) -> F64:
    """Velocity that the engine's scheme may add per group [m/s], shape (K,): zero where nothing of it is jointed."""
    speed = surface_speeds(books)
    count = int(label.max(initial=-1)) + 1
    fastest, jointed = np.zeros(count), np.zeros(count, dtype=bool)
    np.maximum.at(fastest, label, np.maximum(speed[:-1], speed[1:]))
    np.logical_or.at(jointed, label, np.broadcast_to(~books.single | books.jointed, label.shape))
    return np.where(jointed, JOINTED * fastest, 0.0)


def unexplained(books: Books) -> Unexplained:
    """Velocity without a source, of every assembly: what is left when all that is known to push it, and its contacts, are taken off."""
    label, anchored = books.assemblies
    groups = _grouped(books, label, anchored | (books.free_time <= 0))
    rests = rests_of(books)
    unlogged = _summed(label, rests.unlogged + rests.passed_on)
    size = np.linalg.norm(groups.residual - groups.given, axis=1)
    excess = (size - unlogged * (1 + BUDGET_NOISE) - BUDGET_NOISE * groups.budget - groups.doubt) / groups.mass
    judged = ~groups.open & np.isfinite(groups.doubt)
    return Unexplained((excess - _lag(books, label))[label], judged[label])


def momentum(books: Books) -> Finding:
    """Velocity without a source."""
    found = unexplained(books)
    law = Law(
        IMPULSE,
        "m/s",
        "change of velocity without a source",
        "every moving body is held, on a path or fixed by joints in this interval",
        lambda entity: declare_source(f"something pushed {entity} that the specification does not know"),
    )
    return law.judge(books.entities, found.value, found.judged, proof=lambda entity, frame: strangest(books, entity, frame))


# ---------------------------------------------------------------- places


def _drift(books: Books) -> tuple[F64, Flags]:
    """Displacement of assemblies beyond what velocities at both frames and contacts between them explain [m]."""
    label, anchored = books.assemblies
    time, h = books.free_time, books.duration
    trapezoid = 0.5 * (books.velocities[:-1] + books.velocities[1:]) * time[:, :, None]
    groups = _grouped(books, label, anchored | (time <= 0))
    off = _summed(label, (np.diff(books.centers, axis=0) - trapezoid) * books.mass[:, None]) / groups.mass[:, None]
    known, change = _summed(label, books.known_impulse), _summed(label, _uneven(books))
    unlogged = _summed(label, rests_of(books).unlogged)
    # An impulse at any moment of the frame shifts the body by at most half the frame times its speed against the trapezoid.
    allowed = 0.5 * h * (groups.budget + groups.doubt + unlogged + change) * (1 + BUDGET_NOISE) / groups.mass
    allowed += np.linalg.norm(known, axis=1) / groups.mass * books.step
    value = np.linalg.norm(off, axis=1) - allowed
    return (value - h * _lag(books, label))[label], ~groups.open[label] & np.isfinite(groups.doubt)[label]


def _uneven(books: Books) -> F64:
    """Largest change of the known forces within an interval, as an impulse [N s], shape (F - 1, E)."""
    drag = books.drag * np.linalg.norm(np.diff(books.velocities, axis=0), axis=2) * books.duration / 3.0
    spring = np.linalg.norm(books.spring_impulse[0], axis=2)
    force = np.linalg.norm(books.driver_wrench[0], axis=2)
    weight = books.mass * float(np.linalg.norm(books.gravity)) * books.duration
    # What differs so much from one interval to the next may change as much within either.
    swing, gusts = (_swing(e.linear) for e in (books.liquid, books.fields))
    liquid = np.linalg.norm(books.liquid.linear, axis=2) + np.where(books.liquid.wet, UNSTEADY * weight + swing, 0.0)
    # Lift turns round with the body.
    turned = lifted_members(books.candidate.spec, books.cache.index.solver)
    field = np.linalg.norm(books.fields.linear, axis=2) + np.where([n in turned for n in books.entities], gusts, 0.0)
    result: F64 = drag + spring + liquid + field + np.where(books.switching, force, 0.0)
    return result


def _swing(given: F64) -> F64:
    """Largest difference of each interval's impulse from those of its neighbours [N s], shape (F - 1, E)."""
    change = np.linalg.norm(np.diff(given, axis=0), axis=2)
    return np.asarray(np.maximum(np.pad(change, ((1, 0), (0, 0))), np.pad(change, ((0, 1), (0, 0)))))


def motion(books: Books) -> Finding:
    """Displacement that no velocity explains."""
    value, judged = _drift(books)
    peak = books.record("max_speed")[1:, None]
    way = np.linalg.norm(np.diff(books.body_centers, axis=0), axis=2) - FASTER * books.duration * peak
    both = np.maximum(np.where(judged, value, -np.inf), most_of_bodies(books, way))
    return Law(PLACE, "m", "displacement that no velocity explains").judge(books.entities, both)


# ---------------------------------------------------------------- turning


def _flights(books: Books) -> Flags:
    """Where a lone body is free for the whole interval and nothing touches it, shape (F - 1, E)."""
    return (
        books.lone
        & (books.free_time > books.duration - 1e-9)
        & ~books.touched
        & ~books.dozing
        & ~books.switching
        & ~books.outside.wet
    )


def _in_contact(books: Books) -> tuple[F64, Flags]:
    """Change of angular momentum beyond the logged impulses times the reach, over the least inertia [rad/s]."""
    angular = np.linalg.norm(np.diff(books.angular_momentum, axis=0) - books.driver_wrench[1] - books.outside.angular, axis=2)
    torques = np.where(books.dozing | books.switching, np.linalg.norm(books.driver_wrench[1], axis=2), 0.0)
    lever = books.reach + books.rolling
    allowed = (
        books.contact_budget * lever * (1 + BUDGET_NOISE) + rests_of(books).unlogged * lever + torques + books.let_go_doubt[1]
    )
    inertia = np.linalg.eigvalsh(books.inertia[books.first])
    speed = np.linalg.norm(books.spin[:, books.first], axis=2)
    gyration = np.maximum(speed[:-1], speed[1:]) ** 2 * books.step * inertia[:, 2]
    value = (angular - allowed - gyration) / inertia[:, 0]
    return value, books.lone & (books.free_time > 0) & ~_flights(books)


class _Turned(NamedTuple):
    """Free flights: error of angular velocity [rad/s] and of orientation [rad] less the scheme's; shape (F - 1, E)."""

    spin: F64
    turn: F64
    judged: Flags


def _tumbled(books: Books) -> _Turned:
    judged = _flights(books)
    spin_off, turn_off = np.full((2, *judged.shape), -np.inf)
    interval, entity = np.nonzero(judged)
    if len(interval):
        body = books.first[entity]
        start = books.turns[interval, body], books.spin[interval, body]
        torque = books.driver_wrench[1][interval, entity] / books.duration
        turned, spun = tumble(*start, books.inertia[body], torque, books.duration)
        end, after = books.turns[interval + 1, body], books.spin[interval + 1, body]
        between = np.einsum("nji,njk->nik", turned, end)
        speed = np.maximum(np.linalg.norm(start[1], axis=1), np.linalg.norm(after, axis=1))
        change = speed**2 + np.linalg.norm(torque, axis=1) / np.linalg.eigvalsh(books.inertia[body])[:, 0]
        spin_off[interval, entity] = np.linalg.norm(spun - after, axis=1) - change * books.step
        turn_off[interval, entity] = angle_of(between) - change * books.step * books.duration
    return _Turned(spin_off, turn_off, judged)


def spin(books: Books) -> Finding:
    """Change of angular velocity without a torque."""
    flown, (touched, other) = _tumbled(books), _in_contact(books)
    value = np.where(flown.judged, flown.spin, touched)
    law = Law(
        SPIN,
        "rad/s",
        "change of angular velocity without a torque",
        "no free body of one piece without joints and springs",
        lambda entity: declare_source(f"something turned {entity} that the specification does not know", "torque"),
    )
    return law.judge(books.entities, value, flown.judged | other)


def turning(books: Books) -> Finding:
    """Turn that no angular velocity explains."""
    flown = _tumbled(books)
    steps = books.record("step")[1:, None]
    surface = books.record("max_travel_per_step")[1:, None] / np.maximum(steps, 1e-12)
    between = np.einsum("fnji,fnjk->fnik", books.turns[:-1], books.turns[1:])
    turned = angle_of(between) - FASTER * books.duration * surface / books.body_reach
    both = np.maximum(np.where(flown.judged, flown.turn, -np.inf), most_of_bodies(books, turned))
    return Law(TURN, "rad", "turn that no angular velocity explains").judge(books.entities, both)


# ---------------------------------------------------------------- drivers


def _path(driver: PathDriver, times: F64) -> tuple[F64, F64]:
    """Positions (n, 3) and quaternions (n, 4) of a path: shape-preserving cubic and slerp between keys (R18)."""
    from scipy.interpolate import PchipInterpolator
    from scipy.spatial.transform import Rotation, Slerp

    keys = sorted(driver.keys.values(), key=lambda k: k.time)
    at = np.array([k.time for k in keys])
    poses = [pose_of(k.pose) for k in keys]
    inside = np.clip(times, at[0], at[-1])
    position: F64 = PchipInterpolator(at, np.array([p.position for p in poses]))(inside)
    turns = Slerp(at, Rotation.from_quat(np.array([p.quaternion for p in poses])[:, [1, 2, 3, 0]]))(inside)
    return position, turns.as_quat()[:, [3, 0, 1, 2]]


def driven(books: Books) -> Finding:
    """Distance of bodies on paths and held ones from where their drivers put them."""
    paths = {d.entity: d for d in books.candidate.spec.simulation.drivers.values() if isinstance(d, PathDriver)}
    off = np.full((books.frames, len(books.entities)), -np.inf)
    for body, owner in enumerate(books.owner):
        name = books.entities[owner]
        position, quaternion = books.position[:, body], books.quaternion[:, body]
        fixed = books.kinematic[owner] | (books.times <= books.released[owner] + 1e-9)
        if not np.any(fixed) or (not books.kinematic[owner] and books.released[owner] <= 0):
            continue
        if name in paths and books.kinematic[owner]:
            wanted, turned = _path(paths[name], books.times)
        else:
            wanted, turned = (np.repeat(x[:1], books.frames, axis=0) for x in (position, quaternion))
            if books.kinematic[owner]:
                start = pose_of(books.candidate.spec.entities[name].pose)
                wanted, turned = (np.repeat(x[None], books.frames, axis=0) for x in (start.position, start.quaternion))
        apart = np.linalg.norm(position - wanted, axis=1)
        twist = np.linalg.norm(rotation_matrix(quaternion) - rotation_matrix(turned), axis=(1, 2)) / np.sqrt(2.0)
        value = apart + twist * (books.body_reach[body] + float(np.linalg.norm(books.offset[body])))
        off[:, owner] = np.maximum(off[:, owner], np.where(fixed, value, -np.inf))
    law = Law(HELD, "m", "distance from where the driver puts it", "nothing in this instance is held or on a path")
    return law.judge(books.entities, off, shift=0)
