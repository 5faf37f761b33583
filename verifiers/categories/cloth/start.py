"""Sheets at frame 0 against what was declared: places and velocities of their vertices."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from ....worlds.categories.cloth.facts import release_time
from ....worlds.settled import settling
from ...rows.findings import Finding
from ...scene.bounds import ROUNDING
from ...scene.initial_state import Opened, moved_vertices, of_places, of_speeds, speeds_of_vertices
from ..questions import PLACED, STARTED

if TYPE_CHECKING:
    from ....worlds.cache import Cache
    from ....worlds.candidate import Candidate
    from ...rows.questions import Question
    from ..container import Function

__all__ = ["STARTS"]


def _placed(candidate: Candidate, solver: str, cache: Cache) -> Finding:
    found, free = [], candidate.spec.simulation.preroll > 0 and release_time(candidate.spec, solver) == -np.inf
    settles = settling(candidate.spec)
    for entity in dict.fromkeys(n.split("/", 1)[0] for n in cache.index.deformables):
        if entity in settles:
            continue
        for moved, _, _, _ in moved_vertices(candidate, entity):
            found.append(Opened(entity, moved, np.inf if free else ROUNDING, settled=free))
    return of_places(found)


def _started(candidate: Candidate, solver: str, cache: Cache) -> Finding:
    return of_speeds(list(speeds_of_vertices(candidate, cache)))


STARTS: Mapping[Question, Function] = {PLACED: _placed, STARTED: _started}
"""By question about frame 0."""
