"""Liquids at frame 0 against what was declared: their middles and velocities."""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ....worlds.arrays import F64, pose_of
from ....worlds.settled import settling
from ...rows.corrections import EACH_OTHER, bake_again, out_of_solids
from ...rows.findings import Finding
from ...scene.bounds import LIQUID_MIDDLE, PARTICLE_SPEED
from ..questions import PLACED, STARTED
from .frames import liquid_of
from .ledger import declared_filling

if TYPE_CHECKING:
    from ....worlds.cache import Cache
    from ....worlds.candidate import Candidate
    from ....worlds.spec import LiquidPhysics
    from ...rows.questions import Question
    from ..container import Function
    from .frames import Liquid

__all__ = ["STARTS"]


def _placed(candidate: Candidate, solver: str, cache: Cache) -> Finding:
    """True where every liquid's middle is that of its declared volume."""
    liquid, frame = liquid_of(candidate, solver), liquid_of(candidate, solver).read(0)
    bound = LIQUID_MIDDLE * liquid.spacing
    worst, culprit, told = -1.0, liquid.members[0], {}
    for row, (member, (volume, middle)) in enumerate(declared_filling(liquid).items()):
        mine = frame.fluid == row
        if not mine.any() or volume <= 0.0:
            continue
        weight = frame.volume[mine] / frame.volume[mine].sum()
        off = float(np.linalg.norm(weight @ frame.position[mine] - middle))
        told[member] = off
        if off > worst:
            worst, culprit = off, member
    if not told:
        return Finding("not_applicable", "there is no liquid at frame 0")
    text = f"the middle of {culprit!r} is {worst:.3g} m from that of its declared volume"
    if candidate.spec.simulation.preroll > 0 or set(liquid.members) <= set(settling(candidate.spec)):
        return Finding("pass", text + ", after it settled", evidence={"moved_m": told})
    hints = (
        bake_again(),
        out_of_solids((culprit,), "its parts overlap solids, the domain's sides or each other", EACH_OTHER),
    )
    return Finding("pass" if worst <= bound else "fail", text, worst, bound, "m", culprit, 0, hints, {"moved_m": told})


def _started(candidate: Candidate, solver: str, cache: Cache) -> Finding:
    """True where every particle has its declared velocity, in a current at most that of its fastest place."""
    if candidate.spec.simulation.preroll > 0:
        return Finding("not_applicable", "its velocity is declared for the begin of the preroll, which no frame holds")
    liquid = liquid_of(candidate, solver)
    frame = liquid.read(0)
    worst, culprit = 0.0, liquid.members[0]
    for row, member in enumerate(liquid.members):
        mine = np.flatnonzero(frame.fluid == row)
        physics = liquid.physics(member)
        off = np.linalg.norm(frame.velocity[mine] - np.array(physics.linear_velocity), axis=1)
        fastest = max((max(c.speeds) for c in physics.currents.values()), default=0.0)
        running = _in_currents(liquid, member, physics, frame.position[mine])
        off[running] = np.minimum(off[running], np.maximum(frame.speed[mine][running] - fastest, 0.0))
        if len(off) and off.max() > worst:
            worst, culprit = float(off.max()), member
    text = f"particles of {culprit!r} have another velocity than declared, by at most {worst:.3g} m/s"
    return Finding("pass" if worst <= PARTICLE_SPEED else "fail", text, worst, PARTICLE_SPEED, "m/s", culprit, 0, (bake_again(),))


def _in_currents(liquid: Liquid, member: str, physics: LiquidPhysics, points: F64) -> NDArray[np.bool_]:
    """True for each point that may lie in a declared current, as seen from above."""
    pose, found = pose_of(liquid.candidate.spec.entities[member].pose), np.zeros(len(points), dtype=bool)
    for current in physics.currents.values():
        line = pose.apply(np.array(current.line, dtype=np.float64))[:, :2]
        for a, b in itertools.pairwise(line):
            along = b - a
            share = np.clip((points[:, :2] - a) @ along / max(float(along @ along), 1e-300), 0.0, 1.0)
            found |= np.linalg.norm(points[:, :2] - a - share[:, None] * along, axis=1) <= 0.5 * current.width + liquid.spacing
    return found


STARTS: Mapping[Question, Function] = {PLACED: _placed, STARTED: _started}
"""By question about frame 0."""
