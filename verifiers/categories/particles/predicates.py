"""Evaluators of predicates about particles: from what an engine moved, and nothing else."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, TypeAlias, TypeVar

import numpy as np
from numpy.typing import NDArray

from ....worlds.arrays import F64
from ....worlds.errors import EvidenceError
from ....worlds.predicates import ParticleCountIn, ParticlesSettled, ParticleVolumeIn, PileHeight, RunOut
from ...predicates.kinematic import points_in_region
from ...predicates.outcome import Outcome, Series, band, judge
from .frames import Swarm, SwarmFrame, swarm_of

if TYPE_CHECKING:
    from ....worlds.candidate import Candidate
    from ....worlds.spec import SpecModel
    from ...predicates.scope import Scope

__all__ = ["particle_count_in", "particle_volume_in", "particles_settled", "pile_height", "run_out"]

MOST = 0.99
"""Share of the volume that a heap's height and reach enclose: single grains that bounce away do not count."""
LATELY = 0.25
"""[s] Over which what came into a region tells whether more is coming. Own choice."""
P = TypeVar("P")
Rows: TypeAlias = NDArray[np.intp]


def _typed(predicate: SpecModel, kind: type[P]) -> P:
    assert isinstance(predicate, kind)
    return predicate


def _swarm(candidate: Candidate, entity: str) -> tuple[Swarm, int] | str:
    """The instance that moves the particles and their row among its members, or why there is none."""
    known = candidate.spec.entities.get(entity)
    if known is None:
        raise EvidenceError(f"entity {entity!r} is not in the specification")
    solver = next((n for n, s in candidate.spec.simulation.particles.items() if entity in s.members), None)
    if known.physics.category != "particles" or solver is None:
        said = "no engine moves them" if known.physics.category == "particles" else f"it is {known.physics.category}"
        return f"{entity!r} is no evidence of particles: {said}; make it particles and a member of a dem or ballistic instance"
    swarm = swarm_of(candidate, solver)
    return swarm, swarm.members.index(entity)


def _measured(scope: Scope, entity: str, unit: str, measure: Callable[[SwarmFrame, Rows], float]) -> F64 | Outcome:
    """A number per frame from the entity's particles."""
    found = _swarm(scope.candidate, entity)
    if isinstance(found, str):
        return Outcome(
            "fail", scope.frames, unit, found, first_failing_entity=entity, first_failing_frame=scope.frames[0], failing=(entity,)
        )
    swarm, row = found
    value = np.full(scope.length, np.nan)
    for i, index in enumerate(range(scope.frames[0], scope.frames[1] + 1)):
        frame = swarm.read(index)
        value[i] = measure(frame, np.flatnonzero(frame.member == row))
    return value


def _banded(
    scope: Scope,
    p: ParticleCountIn | ParticleVolumeIn | PileHeight | RunOut,
    value: F64 | Outcome,
    unit: str,
    what: str,
    detail: Callable[[int], dict[str, float]] = lambda i: {},
) -> Outcome:
    if isinstance(value, Outcome):
        return value
    margin, side = band(value, p.min, p.max)
    margin = np.where(np.isnan(value), -np.inf, margin)
    named = "" if unit == "1" else f" {unit}"

    def tell(i: int) -> str:
        if np.isnan(value[i]):
            return _absent(scope, p.entity, i)
        known = value[np.isfinite(value)]
        span = f" (range {known.min():.4g} to {known.max():.4g}{named})" if len(known) else ""
        return f"{what} is {value[i]:.4g}{named} at frame {scope.frames[0] + i}{span}"

    return judge(Series(scope.frames, value, margin, unit, p.entity, side, tell, detail), p.when)


def _absent(scope: Scope, entity: str, i: int) -> str:
    return f"no particle of {entity} is there at frame {scope.frames[0] + i}"


def _within(candidate: Candidate, region_id: str | None, frame: SwarmFrame, rows: Rows) -> Rows:
    """Rows of particles whose middles lie in a region; all where none is asked for."""
    return rows[points_in_region(candidate, region_id, frame.position[rows], frame.index)]


def _elsewhere(
    scope: Scope, p: ParticleCountIn | ParticleVolumeIn, size: Callable[[SwarmFrame, Rows], float]
) -> Callable[[int], dict[str, float]]:
    """Function of a frame that tells where the particles are beside the region: `in_all`, `above` those in it, `gained` by it of late."""

    def detail(i: int) -> dict[str, float]:
        found = _swarm(scope.candidate, p.entity)
        if p.region is None or isinstance(found, str):
            return {}
        (swarm, row), index = found, scope.frames[0] + i
        now, then = (swarm.read(k) for k in (index, max(0, index - round(LATELY * scope.candidate.spec.simulation.fps))))
        own, before = (np.flatnonzero(f.member == row) for f in (now, then))
        inside = _within(scope.candidate, p.region, now, own)
        outside = np.setdiff1d(own, inside)
        top = _enclosing(now.position[inside, 2], _volumes(now, inside))
        above = outside[~(now.position[outside, 2] <= top)]
        came = size(now, inside) - size(then, _within(scope.candidate, p.region, then, before))
        return {"in_all": size(now, own), "above": size(now, above), "gained": came}

    return detail


def particle_count_in(scope: Scope, predicate: SpecModel) -> Outcome:
    """Measured: particles whose middles are in the region."""
    p = _typed(predicate, ParticleCountIn)
    value = _measured(scope, p.entity, "1", lambda f, own: float(len(_within(scope.candidate, p.region, f, own))))
    named = f"number of particles of {p.entity}{f' in {p.region}' if p.region else ''}"
    return _banded(scope, p, value, "1", named, _elsewhere(scope, p, lambda f, rows: float(len(rows))))


def particle_volume_in(scope: Scope, predicate: SpecModel) -> Outcome:
    """Measured: sum of the volumes of the particles whose middles are in the region."""
    p = _typed(predicate, ParticleVolumeIn)
    value = _measured(scope, p.entity, "m^3", lambda f, own: float(_volumes(f, _within(scope.candidate, p.region, f, own)).sum()))
    detail = _elsewhere(scope, p, lambda f, rows: float(_volumes(f, rows).sum()))
    return _banded(scope, p, value, "m^3", f"volume of {p.entity} in {p.region}", detail)


def _volumes(frame: SwarmFrame, rows: Rows) -> F64:
    result: F64 = 4.0 / 3.0 * np.pi * frame.radius[rows] ** 3
    return result


def _enclosing(values: F64, weight: F64) -> float:
    """Value below which `MOST` of the weight lies; NaN where there is nothing."""
    if not len(values):
        return float("nan")
    order = np.argsort(values)
    share = np.cumsum(weight[order]) / weight.sum()
    return float(values[order][int(np.searchsorted(share, MOST))])


def pile_height(scope: Scope, predicate: SpecModel) -> Outcome:
    """Measured: height of the tops of grains below which 99 % of the volume lies."""
    p = _typed(predicate, PileHeight)

    def height(frame: SwarmFrame, own: Rows) -> float:
        rows = own
        return _enclosing(frame.position[rows, 2] + frame.radius[rows] - p.base, _volumes(frame, own))

    return _banded(scope, p, _measured(scope, p.entity, "m", height), "m", f"height of {p.entity} over z = {p.base:g}")


def run_out(scope: Scope, predicate: SpecModel) -> Outcome:
    """Measured: level distance from the axis to the far sides of grains within which 99 % of the volume lies."""
    p = _typed(predicate, RunOut)

    def reach(frame: SwarmFrame, own: Rows) -> float:
        rows = own
        return _enclosing(np.hypot(*(frame.position[rows, :2] - p.center).T) + frame.radius[rows], _volumes(frame, own))

    return _banded(scope, p, _measured(scope, p.entity, "m", reach), "m", f"reach of {p.entity} from {p.center}")


def particles_settled(scope: Scope, predicate: SpecModel) -> Outcome:
    """Measured: mean speed."""
    p = _typed(predicate, ParticlesSettled)

    def speed(frame: SwarmFrame, own: Rows) -> float:
        found = np.linalg.norm(frame.velocity[own], axis=1)
        return float(found.mean()) if len(found) else float("nan")

    value = _measured(scope, p.entity, "m/s", speed)
    if isinstance(value, Outcome):
        return value
    margin, side = band(value, None, p.max_speed)
    margin = np.where(np.isnan(value), -np.inf, margin)

    def tell(i: int) -> str:
        if np.isnan(value[i]):
            return _absent(scope, p.entity, i)
        return f"mean speed of {p.entity} is {value[i]:.4g} m/s at frame {scope.frames[0] + i}, allowed {p.max_speed:g} m/s"

    return judge(Series(scope.frames, value, margin, "m/s", p.entity, side, tell), p.when)
