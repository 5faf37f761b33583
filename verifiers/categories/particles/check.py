"""Grains and flying particles (R65-R68, R101-R105): one pass over the frames of an instance, seen by one watch per family of questions.

Rows: `category:particles:<question>:<solver>` and `numerical:<question>:<solver>`. Nothing here knows a solver: particles, what was exchanged
and recorded, and the solids of the candidate are all there is.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import numpy as np

from ....worlds.errors import EvidenceError, NotFiniteError
from ...rows.corrections import halve_step
from ...rows.findings import Finding
from ...rows.watches import Watch, Watching
from ..container import rows_about
from .contacts import Contacts
from .flight import Flight
from .frames import matched, swarm_of
from .ledger import Books, Identity
from .questions import NUMBERS
from .rows import emitted_slower, stiffer
from .start import STARTS
from .walls import Walls

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ....worlds.candidate import Candidate
    from ....worlds.requirements import Correction, Row, Status
    from ...rows.questions import Question
    from .frames import Swarm, SwarmFrame

__all__ = ["WATCHES", "category_rows", "numerical_rows"]


class Numbers:
    """Speeds and ways."""

    questions: ClassVar[Mapping[str, Question]] = NUMBERS

    def __init__(self, swarm: Swarm) -> None:
        self.swarm = swarm
        self.speed = self.way = 0.0
        self.fast: tuple[int, float] | None = None
        self.far: tuple[int, float] | None = None

    def see(self, now: SwarmFrame, before: SwarmFrame | None) -> None:
        """Look at one frame."""
        limit = self.swarm.candidate.spec.simulation.limits.max_speed
        speed = max(
            float(np.linalg.norm(now.velocity, axis=1).max(initial=0.0)), float(self.swarm.record("max_speed")[now.index])
        )
        self.speed = max(self.speed, speed)
        if speed > limit and self.fast is None:
            self.fast = (now.index, speed)
        if before is None:
            return
        here, there = matched(now, before)
        way = float(np.linalg.norm(now.position[here] - before.position[there], axis=1).max(initial=0.0))
        self.way = max(self.way, way)
        if way > (limit + 1.0) * self.swarm.duration and self.far is None:
            self.far = (now.index, way)

    def findings(self) -> dict[str, Finding]:
        """Findings on the three questions by name; a frame that is not finite cannot be read at all."""
        limit = self.swarm.candidate.spec.simulation.limits.max_speed
        reach = (limit + 1.0) * self.swarm.duration
        hints: tuple[Correction, ...] = (
            halve_step(self.swarm.candidate, self.swarm.solver, "forces are too strong for the step"),
        )
        if self.swarm.granular:
            hints = (*hints, stiffer(self.swarm, "grains start overlapping, or are too soft", 2.0))
        else:
            hints = (*emitted_slower(self.swarm), *hints)
        speed = Finding("pass", f"largest speed is {self.speed:.4g} m/s", self.speed, limit, "m/s")
        if self.fast is not None:
            speed = Finding(
                "fail",
                f"a particle has {self.fast[1]:.4g} m/s in frame {self.fast[0]}",
                self.speed,
                limit,
                "m/s",
                frame=self.fast[0],
                hints=hints,
            )
        travel = Finding("pass", f"largest way in a frame is {self.way:.4g} m", self.way, reach, "m")
        if self.far is not None:
            travel = Finding(
                "fail",
                f"a particle travels {self.far[1]:.4g} m in frame {self.far[0]}",
                self.way,
                reach,
                "m",
                frame=self.far[0],
                hints=hints,
            )
        return {"finite": Finding("pass", "every frame was read, and all of it is finite"), "speed": speed, "travel": travel}


WATCHES: tuple[type[Watch], ...] = (Numbers, Identity, Books, Contacts, Walls, Flight)
"""All families, in the order of their rows. `Books` and `Contacts` share what they find of a frame's contacts."""


def _unread(kind: type[Watch], name: str, error: EvidenceError) -> Status:
    """Frames that hold numbers that are not finite cannot be read: that alone is a failure, of `finite`."""
    return "fail" if kind is Numbers and name == "finite" and isinstance(error, NotFiniteError) else "unverified"


_WATCHING = Watching(WATCHES, Numbers, swarm_of, lambda swarm: swarm.steps(), _unread)
category_rows = _WATCHING.category_rows


def numerical_rows(candidate: Candidate, solver: str) -> list[Row]:
    """Rows of frame 0, of the cache and of counters of one instance."""
    return [*rows_about(candidate, solver, STARTS), *_WATCHING.numerical_rows(candidate, solver)]
