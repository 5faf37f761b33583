"""Grains and flying particles at frame 0 against what was declared: their number and velocities."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ....geometry import Solid, contains, distance_to_surface
from ....worlds.arrays import F64, pose_of
from ...rows.corrections import EACH_OTHER, bake_again, out_of_solids
from ...rows.findings import Finding
from ...scene.bounds import FEW, FILLED, PARTICLE_SPEED
from ..liquid.samples import spread
from ..liquid.solids import pieces_of
from ..questions import AMOUNT, STARTED
from .frames import swarm_of

if TYPE_CHECKING:
    from ....worlds.cache import Cache
    from ....worlds.candidate import Candidate
    from ...rows.questions import Question
    from ..container import Function
    from .frames import Swarm

__all__ = ["STARTS"]

GRAIN_POINTS = 8000
"""Points in a part's box at which it is asked whether the middle of a grain may be there: 1 % of a half-filled box."""


def _amounts(candidate: Candidate, solver: str, cache: Cache) -> Finding:
    """True where there are as many particles as declared: in number, or by the share of the volume that grains take."""
    swarm = swarm_of(candidate, solver)
    if candidate.spec.simulation.preroll > 0 and not swarm.granular:
        return Finding("not_applicable", "particles come and go during the preroll, which no frame holds")
    frame = swarm.read(0)
    worst, text, bound, culprit, told = -1.0, "", 0.0, swarm.members[0], {}
    for row, member in enumerate(swarm.members):
        have = int((frame.member == row).sum())
        wanted = _grains(swarm, row) if swarm.granular else float(swarm.physics(row).count)
        allowed = FILLED * wanted + FEW * np.sqrt(wanted) if swarm.granular else 0.0
        told[member] = {"declared": wanted, "there": have}
        off = abs(have - wanted)
        if off - allowed > worst or not text:
            worst, bound, culprit = off - allowed, allowed, member
            text = f"{have} particles of {member!r} are there, {wanted:.4g} were declared"
    off = worst + bound
    hints = (
        bake_again(),
        out_of_solids((culprit,), "solids or other grains take much of its volume", EACH_OTHER),
    )
    return Finding("pass" if worst <= 0.0 else "fail", text, float(off), float(bound), "particles", culprit, 0, hints, told)


def _grains(swarm: Swarm, row: int) -> float:
    """Number of grains that fit a member's volume: their middles lie a radius inside it and outside solids and the parts before it."""
    candidate, physics, total = swarm.candidate, swarm.physics(row), 0.0
    member = swarm.members[row]
    mean = 4.0 / 3.0 * np.pi * physics.radius**3 * (1.0 + physics.radius_spread**2)  # the mean of r^3, r even about its mean
    before = list(swarm.members[:row])
    for part in candidate.entity(member).parts:
        solid, pose = Solid.from_mesh(part.render, closed=part.closed), pose_of(candidate.spec.entities[member].pose)
        grid = spread(solid.lower, solid.upper, GRAIN_POINTS)
        whole = float(np.prod(solid.upper - solid.lower))
        inside = grid[contains(solid, grid)]
        inside = inside[distance_to_surface(solid, inside).distance >= physics.radius] if len(inside) else inside
        free = _free(swarm, pose.apply(inside), physics.radius, before)
        total += physics.packing * whole * float(free.sum()) / max(len(grid), 1) / mean
    return total


def _free(swarm: Swarm, points: F64, radius: float, before: list[str]) -> NDArray[np.bool_]:
    """True for each point that is at least a radius outside every solid, and outside the volumes of the members before."""
    candidate, free = swarm.candidate, np.ones(len(points), dtype=bool)
    if not len(points):
        return free
    for piece in pieces_of(candidate):
        low, high = piece.box(0)
        near = np.flatnonzero(free & ((points >= low - radius) & (points <= high + radius)).all(axis=1))
        if len(near) and piece.solid_through:
            local = piece.local(points[near], 0)
            free[near] = ~contains(piece.solid, local) & (distance_to_surface(piece.solid, local).distance >= radius)
    for member in before:
        pose = pose_of(candidate.spec.entities[member].pose)
        for part in candidate.entity(member).parts:
            solid = Solid.from_mesh(part.render, closed=part.closed)
            local = pose.inverse().apply(points)
            free &= ~(contains(solid, local) | (distance_to_surface(solid, local).distance < radius))
    return free


def _started(candidate: Candidate, solver: str, cache: Cache) -> Finding:
    """True where every particle has its declared velocity."""
    if candidate.spec.simulation.preroll > 0:
        return Finding("not_applicable", "declared velocities are added to what the preroll left, which no frame holds")
    swarm = swarm_of(candidate, solver)
    frame = swarm.read(0)
    if not frame.count:
        return Finding("not_applicable", "there are no particles at frame 0")
    wanted = np.array([swarm.physics(k).linear_velocity for k in range(len(swarm.members))], dtype=np.float64)
    off = np.linalg.norm(frame.velocity - wanted[frame.member], axis=1)
    row = int(off.argmax())
    culprit = swarm.members[int(frame.member[row])]
    text = f"particles of {culprit!r} have another velocity than declared, by at most {off[row]:.3g} m/s"
    return Finding(
        "pass" if off[row] <= PARTICLE_SPEED else "fail",
        text,
        float(off[row]),
        PARTICLE_SPEED,
        "m/s",
        culprit,
        0,
        (bake_again(),),
    )


STARTS: Mapping[Question, Function] = {AMOUNT: _amounts, STARTED: _started}
"""By question about frame 0."""
