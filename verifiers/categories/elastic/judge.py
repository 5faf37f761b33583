"""Elastic bodies as the other verifiers ask for them; rigid instances move them and log their contacts."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import numpy as np

from ...ledgers import motion
from ...ledgers.exchanged import partners
from ...ledgers.origins import Origin
from ..judge import STILL_SPEED, STILL_SPIN, Flags, Judge
from .bounds import SHIVER_SPEED, SHIVER_SPIN
from .check import category_rows
from .exchange import soft_impulses
from .register import elastic_lines

if TYPE_CHECKING:
    from ....worlds.arrays import F64
    from ....worlds.candidate import Candidate
    from ....worlds.requirements import Row

__all__ = ["ElasticJudge"]


class ElasticJudge(Judge):
    """Elastic bodies."""

    name: ClassVar[str] = "elastic"
    noun: ClassVar[str] = "soft body"
    goes_on: ClassVar[str] = "wobbles on"
    in_fields: ClassVar[tuple[str, str] | None] = (
        "field {0!r} presses on the faces of elastic bodies that face it",
        "drag by the area that they show, without lift and without suction behind",
    )

    def category_rows(self, candidate: Candidate, solver: str) -> list[Row]:
        """Rows of one instance and of its elastic members."""
        return category_rows(candidate, solver)

    def moving(self, candidate: Candidate, entity: str) -> Flags:
        """True where it is not still, shape (frames,): by its ways from frame to frame.

        What lies on nodes shivers on, by micrometres and faster than frames: its speed at a frame tells of that, its way does not.
        """
        fps, count = candidate.spec.simulation.fps, candidate.frame_count
        speed = np.linalg.norm(self.velocities(candidate, entity), axis=1)
        fast = (speed > SHIVER_SPEED) | (motion.spins(candidate, entity) > SHIVER_SPIN)
        ways = np.linalg.norm(np.diff(self.centers(candidate, entity), axis=0), axis=1) * fps
        _, turns = candidate.track(entity)
        cosines = np.abs(np.sum(turns[:-1] * turns[1:], axis=1))
        turned = 2.0 * np.arccos(np.minimum(cosines, 1.0)) * fps
        goes = (ways > STILL_SPEED) | (turned > STILL_SPIN)
        moved = np.zeros(count, dtype=bool)
        moved[:-1] |= goes
        moved[1:] |= goes
        return np.asarray(fast | moved)

    def givers(self, candidate: Candidate, entity: str) -> dict[Origin, F64]:
        """Impulses of the matter of coupled instances; contacts of bodies stay in the rest."""
        for name, cache in self.caches(candidate).items():
            owners = [n.split("/", 1)[0] for n in cache.index.deformables]
            others = partners(candidate.spec, name)
            if entity in owners and others:
                given = soft_impulses(candidate, cache)[1 : candidate.frame_count, owners.index(entity), :3]
                return {Origin("matter", ", ".join(others)): given}
        return {}

    def lines(self, candidate: Candidate) -> list[dict[str, str]]:
        """Lines of the approximation register."""
        return elastic_lines(candidate)
