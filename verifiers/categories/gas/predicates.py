"""Evaluators of predicates about gases: from the cells that an engine moved, and nothing else."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from ....physics.gases import SIGN_DEPTH
from ....worlds.arrays import F64, rotation_matrix
from ....worlds.categories.gas.predicates import GasArrives, GasClears, GasDensityIn, GasTemperatureIn, LightThrough, PlumeHeight
from ....worlds.errors import EvidenceError
from ...ledgers import motion
from ...predicates.kinematic import region_offset
from ...predicates.outcome import Comparison, Outcome, Series, band, judge
from ..liquid.solids import pieces_of
from .bounds import ARRIVED, CUT, ENCLOSED
from .frames import box_of

if TYPE_CHECKING:
    from ....worlds.candidate import Candidate
    from ....worlds.spec import SpecModel
    from ...predicates.scope import Scope
    from .cells import GasFrame, Mask
    from .frames import GasBox

__all__ = [
    "banded",
    "gas_arrives",
    "gas_clears",
    "gas_density_in",
    "gas_temperature_in",
    "inside",
    "light_through",
    "moved_gas",
    "no_gas",
    "plume_height",
]

P = TypeVar("P")
TINY = 1e-30
Measure = Callable[["GasBox", "GasFrame"], float]


def _typed(predicate: SpecModel, kind: type[P]) -> P:
    assert isinstance(predicate, kind)
    return predicate


def moved_gas(candidate: Candidate, entity: str) -> GasBox | str:
    """The cells of a gas, or why there are none.

    Raises:
        EvidenceError: no such entity, or it has no cache.
    """
    known = candidate.spec.entities.get(entity)
    if known is None:
        raise EvidenceError(f"entity {entity!r} is not in the specification")
    solver = next((n for n, s in candidate.spec.simulation.gas.items() if entity in s.members), None)
    if known.physics.category != "gas" or solver is None:
        said = "no engine moves it" if known.physics.category == "gas" else f"it is {known.physics.category}"
        return f"{entity!r} is no evidence of a gas: {said}; make it a gas and the member of a gas instance"
    return box_of(candidate, solver)


def no_gas(scope: Scope, entity: str, unit: str, text: str) -> Outcome:
    """A predicate about a gas that is none: it fails."""
    first = scope.frames[0]
    return Outcome("fail", scope.frames, unit, text, first_failing_entity=entity, first_failing_frame=first, failing=(entity,))


def inside(candidate: Candidate, region_id: str | None, box: GasBox, frame: GasFrame) -> Mask:
    """Cells whose middles lie in a region; all where none is asked for; that next to its middle where it holds none.

    Raises:
        EvidenceError: there is no such region, or it lies outside the box.
    """
    if region_id is None:
        return np.ones(frame.soot.shape, dtype=bool)
    region = candidate.spec.graph.regions.get(region_id)
    if region is None:
        raise EvidenceError(f"region {region_id!r} is not in the scene graph")
    if region.relative_to is not None:
        return _within(candidate, region_id, box, frame)
    # A region that stands still holds the same cells at every frame of a box that does.
    key = ("cells in a region", box.solver, region_id, frame.corner.tobytes())
    return candidate.memo(key, lambda: _within(candidate, region_id, box, frame))


def _within(candidate: Candidate, region_id: str, box: GasBox, frame: GasFrame) -> Mask:
    """Cells whose middles lie in a region of the scene graph; that next to its middle where it holds none."""
    region = candidate.spec.graph.regions[region_id]
    points = frame.centers.reshape(-1, 3)
    if region.relative_to is not None:
        at, turn = (t[frame.index] for t in motion.entity_poses(candidate, region.relative_to))
        points = (points - at) @ rotation_matrix(turn)
    depth = region_offset(region, points)[0].reshape(frame.soot.shape)
    found = depth >= 0.0
    if not found.any() and float(depth.max()) >= -box.cell:
        found = depth == depth.max()
    if not found.any():
        raise EvidenceError(f"region {region_id!r} lies outside the box of the gas; extend the domain or move the region")
    return np.asarray(found)


def _measured(scope: Scope, entity: str, measure: Measure) -> F64 | str:
    """A number per frame from the cells; or why there are none."""
    box = moved_gas(scope.candidate, entity)
    if isinstance(box, str):
        return box
    return np.array([measure(box, box.read(k)) for k in range(scope.frames[0], scope.frames[1] + 1)])


def banded(
    scope: Scope, p: Any, unit: str, what: str, measure: Measure, detail: Callable[[float], dict[str, float]] = lambda v: {}
) -> Outcome:
    """Outcome of a predicate whose measure has to be within bounds at some frames."""
    value = _measured(scope, p.entity, measure)
    if isinstance(value, str):
        return no_gas(scope, p.entity, unit, value)
    margin, side = band(value, p.min, p.max)
    margin = np.where(np.isnan(value), -np.inf, margin)
    named = "" if unit == "1" else f" {unit}"

    def tell(i: int) -> str:
        if np.isnan(value[i]):
            return f"nothing of {p.entity} is there at frame {scope.frames[0] + i}"
        known = value[np.isfinite(value)]
        return f"{what} is {value[i]:.4g}{named} at frame {scope.frames[0] + i} (range {known.min():.4g} to {known.max():.4g}{named})"

    return judge(Series(scope.frames, value, margin, unit, p.entity, side, tell, lambda i: detail(float(value[i]))), p.when)


def gas_density_in(scope: Scope, predicate: SpecModel) -> Outcome:
    """Measured: mean of the soot by open volume, or the most in a cell."""
    p = _typed(predicate, GasDensityIn)

    def measure(box: GasBox, frame: GasFrame) -> float:
        there = inside(scope.candidate, p.region, box, frame)
        soot, room = frame.soot[there].astype(np.float64), frame.room[there].astype(np.float64)
        if p.measure == "largest":
            return float((soot * (room > 0.0)).max())
        return float((soot * room).sum() / max(float(room.sum()), TINY))

    return banded(scope, p, "kg/m^3", f"{p.measure} soot of {p.entity} in {p.region}", measure)


def gas_temperature_in(scope: Scope, predicate: SpecModel) -> Outcome:
    """Measured: mean of the temperature by open volume, or that of the coldest or hottest cell."""
    p = _typed(predicate, GasTemperatureIn)

    def measure(box: GasBox, frame: GasFrame) -> float:
        there = inside(scope.candidate, p.region, box, frame) & frame.open
        if not there.any():
            return float("nan")
        known = frame.temperature[there].astype(np.float64)
        if p.measure == "mean":
            return float(np.average(known, weights=frame.room[there]))
        return float(known.min() if p.measure == "lowest" else known.max())

    return banded(scope, p, "K", f"{p.measure} temperature of {p.entity}" + (f" in {p.region}" if p.region else ""), measure)


def plume_height(scope: Scope, predicate: SpecModel) -> Outcome:
    """Measured: height of the upper sides of cells below which 95 % of the soot is; none without soot."""
    p = _typed(predicate, PlumeHeight)

    def measure(box: GasBox, frame: GasFrame) -> float:
        return top_of(box, frame) - p.base

    return banded(scope, p, "m", f"height of {p.entity} over z = {p.base:g}", measure)


def top_of(box: GasBox, frame: GasFrame) -> float:
    """Height below which `ENCLOSED` of the soot is, within a layer of cells by its share [m]; NaN without soot."""
    layers = np.sum(frame.soot.astype(np.float64) * frame.room, axis=(0, 1))
    total = float(layers.sum())
    if total <= TINY:
        return float("nan")
    heights = np.concatenate([[0.0], np.cumsum(layers) / total])
    return float(frame.corner[2] + box.cell * np.interp(ENCLOSED, heights, np.arange(len(heights))))


def gas_arrives(scope: Scope, predicate: SpecModel) -> Outcome:
    """Measured: most soot in a cell there at any frame so far. First true: when it reaches `min_density`."""
    p = _typed(predicate, GasArrives)
    box = moved_gas(scope.candidate, p.entity)
    if isinstance(box, str):
        return no_gas(scope, p.entity, "kg/m^3", box)
    target = [q for q in pieces_of(scope.candidate) if q.entity == p.target]
    if p.target is not None and not target:
        raise EvidenceError(f"target {p.target!r} has no surface that a gas can reach; name a rigid entity or a region")
    reach = p.within if p.within is not None else box.cell

    def measure(box: GasBox, frame: GasFrame) -> float:
        there = inside(scope.candidate, p.region, box, frame) if p.target is None else _beside(box, frame, target, reach)
        return float((frame.soot * frame.open)[there].max(initial=0.0))

    found = _measured(scope, p.entity, measure)
    assert not isinstance(found, str)
    value = np.maximum.accumulate(found)
    least = p.min_density if p.min_density is not None else ARRIVED * box.dark(p.entity)
    if least <= 0.0:
        raise EvidenceError(
            f"{p.entity!r} carries no soot by which it could be told; give it soot_density, or ask gas_temperature_in"
        )
    where, side = p.region or p.target, (least, ">=")

    def tell(i: int) -> str:
        at = np.flatnonzero(value >= least)
        if len(at):
            return f"{least:.3g} kg/m^3 of {p.entity} are at {where} first at frame {scope.frames[0] + int(at[0])}, most {value[-1]:.4g} kg/m^3"
        return f"at most {value[-1]:.4g} kg/m^3 of {p.entity} are at {where}, needed {least:.3g} kg/m^3"

    def decided(i: int) -> tuple[float, Comparison]:
        return side[0], ">="

    return judge(Series(scope.frames, value, value - least, "kg/m^3", p.entity, decided, tell), "eventually")


def _beside(box: GasBox, frame: GasFrame, pieces: list[Any], reach: float) -> Mask:
    """Cells whose middles are within a reach of a surface [m], and half a cell."""
    from ....geometry import distance_to_surface

    points = frame.centers.reshape(-1, 3)
    found, reach = np.zeros(len(points), dtype=bool), reach + 0.5 * box.cell
    for piece in pieces:
        low, high = piece.box(frame.index)
        rows = np.flatnonzero(((points >= low - reach) & (points <= high + reach)).all(axis=1) & ~found)
        if len(rows):
            found[rows] = distance_to_surface(piece.solid, piece.local(points[rows], frame.index)).distance <= reach
    return found.reshape(frame.soot.shape)


def light_through(scope: Scope, predicate: SpecModel) -> Outcome:
    """Measured: exp(-optical depth) by Beer and Lambert; told with the visibility that this mean smoke leaves (Jin)."""
    p = _typed(predicate, LightThrough)
    start, end = np.array(p.start, dtype=np.float64), np.array(p.end, dtype=np.float64)
    length = float(np.linalg.norm(end - start))

    def detail(share: float) -> dict[str, float]:
        depth = -float(np.log(max(share, TINY)))
        return {"optical_depth": depth, **({"visibility_m": SIGN_DEPTH * length / depth} if depth > 1e-6 else {})}

    return banded(
        scope, p, "1", f"light that passes {p.entity} from {list(p.start)} to {list(p.end)}",
        lambda box, frame: float(np.exp(-optical_depth(box, frame, start, end))), detail,
    )  # fmt: skip


def optical_depth(box: GasBox, frame: GasFrame, start: F64, end: F64) -> float:
    """Optical depth along a straight line [1]: its way through each cell, exactly, times the soot there and its extinction."""
    low, way = (start - frame.corner) / box.cell, (end - start) / box.cell
    cuts = [np.array([0.0, 1.0])]
    for axis in range(3):
        if abs(way[axis]) > 1e-12:
            planes = (np.arange(frame.soot.shape[axis] + 1) - low[axis]) / way[axis]
            cuts.append(planes[(planes > 0.0) & (planes < 1.0)])
    at = np.unique(np.concatenate(cuts))
    middle = low + 0.5 * (at[1:] + at[:-1])[:, None] * way
    index = np.floor(middle).astype(np.int64)
    known = ((index >= 0) & (index < np.array(frame.soot.shape))).all(axis=1)
    soot = (frame.soot * frame.open)[tuple(index[known].T)].astype(np.float64)
    return float(box.extinction * np.linalg.norm(end - start) * (np.diff(at)[known] @ soot))


def gas_clears(scope: Scope, predicate: SpecModel) -> Outcome:
    """Measured: soot that is left of the most that was there at a frame of the interval so far."""
    p = _typed(predicate, GasClears)
    box = moved_gas(scope.candidate, p.entity)
    if isinstance(box, str):
        return no_gas(scope, p.entity, "1", box)
    mass, depth = np.zeros(scope.length), np.zeros(scope.length)
    for i, index in enumerate(range(scope.frames[0], scope.frames[1] + 1)):
        frame = box.read(index)
        soot = np.where(inside(scope.candidate, p.region, box, frame), frame.soot * frame.room, 0.0).astype(np.float64)
        mass[i] = box.volume * soot.sum()
        depth[i] = box.extinction * box.cell * max(float(soot.sum(axis=a).max()) for a in range(3))
    most, seen = np.maximum.accumulate(mass), np.maximum.accumulate(depth)
    share = np.where(seen >= CUT, mass / np.maximum(most, TINY), 1.0)

    def tell(i: int) -> str:
        if seen[i] < CUT:
            return f"no {p.entity} is seen there by frame {scope.frames[0] + i}: the optical depth is {seen[i]:.2g} at most"
        return f"{share[i]:.2%} of the most of {p.entity} there ({most[i]:.3g} kg) is left at frame {scope.frames[0] + i}, allowed {p.max_share:.2%}"

    def side(i: int) -> tuple[float, Comparison]:
        return p.max_share, "<="

    return judge(Series(scope.frames, share, p.max_share - share, "1", p.entity, side, tell), "eventually")
