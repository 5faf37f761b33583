"""Course of one entity over a run: how far it falls, moves, tips and turns, when, and how it ends."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from ...worlds.arrays import F64, rotation_matrix
from ...worlds.errors import EvidenceError
from ..categories.registry import judge_of
from ..ledgers import motion

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate

__all__ = ["TIPPED", "Course", "course_of"]

SEEN = 0.05
"""Own choice: a change of place by this share of a thing's size, or more, is told."""
LEAST = 1e-3
"""[m] Own choice: what moves by less is told as still, however small it is."""
TURNED = np.radians(10.0)
"""[rad] Own choice: a change of the upright by more is told."""
TIPPED = np.radians(45.0)
"""[rad] Own choice: from here on a thing counts as tipped over: a block that has passed its edge falls on by itself."""
MOVING = 0.01
"""[m/s] Own choice: centimetre per second, the least speed of something that is seen to move at an end."""


@dataclass(frozen=True)
class Course:
    """Motion of one entity. Of matter, of its centre of mass; nothing is told of what is not there."""

    first: float | None = None
    """When it has first left its place, or started to tip [s]; None where it stays."""
    rest: float | None = None
    """Since when it moves no more [s]; None where it moves at the end."""
    fall: float = 0.0
    """Greatest loss of height from a point of time to a later one [m]."""
    rise: float = 0.0
    """Greatest gain of height [m]."""
    way: F64 = field(default_factory=lambda: np.zeros(3))
    """Greatest displacement across the vertical [m]."""
    angle: float = 0.0
    """Greatest angle of the upright at frame 0 to the vertical [rad]."""
    end_angle: float = 0.0
    turns: float = 0.0
    """Whole rotation over the run [turns]."""
    speed: float = 0.0
    """Greatest [m/s]."""
    start_speed: float = 0.0
    """At frame 0 [m/s]."""
    start_way: F64 = field(default_factory=lambda: np.zeros(3))
    """Velocity at frame 0 [m/s]."""
    end_speed: float = 0.0
    start: F64 = field(default_factory=lambda: np.zeros(3))
    """Centre of mass at the first frame at which it is there [m]."""
    end: F64 = field(default_factory=lambda: np.zeros(3))
    energy: float = 0.0
    """Greatest kinetic energy of translation [J]: how the account ranks it."""


def course_of(candidate: Candidate, entity: str, size: float) -> Course:
    """Motion of an entity of a size [m]; at rest where nothing is simulated or recorded of it.

    Raises:
        EvidenceError: a channel is missing or damaged.
    """
    judge = judge_of(candidate.spec, entity)
    centers = judge.centers(candidate, entity)
    there = np.flatnonzero(np.isfinite(centers).all(axis=1))
    if not len(there):
        return Course()
    start, end = centers[there[0]], centers[there[-1]]
    if candidate.stage == "static" or not judge.known(candidate, entity):
        return Course(start=start, end=end)
    up = -np.array(candidate.spec.simulation.gravity, dtype=np.float64)
    up = up / np.linalg.norm(up) if np.linalg.norm(up) > 0.0 else np.array([0.0, 0.0, 1.0])
    moved = centers[there] - start
    height = moved @ up
    across = moved - np.outer(height, up)
    far = np.linalg.norm(across, axis=1)
    velocity = np.nan_to_num(judge.velocities(candidate, entity))
    speed = np.linalg.norm(velocity, axis=1)
    angle, turns = _turning(candidate, entity, up)
    left = np.linalg.norm(moved, axis=1) > max(LEAST, SEEN * size)
    tilted = angle[there] > TURNED
    active = np.flatnonzero(left | tilted)
    fps, mass = candidate.spec.simulation.fps, judge.mass(candidate, entity)
    moving = np.flatnonzero(speed > MOVING)
    stops = None if speed[-1] > MOVING else float(moving[-1] + 1) / fps if len(moving) else 0.0
    return Course(
        first=float(there[active[0]]) / fps if len(active) else None,
        rest=stops,
        fall=float((np.maximum.accumulate(height) - height).max()),
        rise=float((height - np.minimum.accumulate(height)).max()),
        way=across[int(np.argmax(far))],
        angle=float(angle.max()),
        end_angle=float(angle[-1]),
        turns=turns,
        speed=float(speed.max()),
        start_speed=float(speed[0]),
        start_way=velocity[0],
        end_speed=float(speed[-1]),
        start=start,
        end=end,
        energy=float((0.5 * mass * speed**2).max()),
    )


def _turning(candidate: Candidate, entity: str, up: F64) -> tuple[F64, float]:
    """Angle of what was upright at frame 0 [rad], shape (frames,), and the whole rotation [turns]; zeros for what has no one pose."""
    still = np.zeros(candidate.frame_count), 0.0
    if candidate.spec.entities[entity].physics.shape == "loose" or len(candidate.entity(entity).bodies) != 1:
        return still
    try:
        _, quaternions = motion.entity_poses(candidate, entity)
    except EvidenceError:
        return still
    angle = motion.angles(candidate, entity, rotation_matrix(quaternions[0]).T @ up)
    same = np.clip(np.abs(np.sum(quaternions[1:] * quaternions[:-1], axis=1)), 0.0, 1.0)
    return angle, float(np.sum(2.0 * np.arccos(same)) / (2.0 * np.pi))
