"""Evaluators of predicates about cloth, but for `flutters`."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeVar

import numpy as np
from numpy.typing import NDArray

from ....worlds.arrays import F64, I32
from ....worlds.errors import EvidenceError
from ....worlds.predicates import Drape, Pinned, Torn
from ...predicates.outcome import Outcome, Series, band, judge
from .bounds import CELLS
from .frames import cloth_run
from .tears import TearingPiece, tearing_pieces

if TYPE_CHECKING:
    from ....worlds.candidate import Candidate
    from ....worlds.spec import SpecModel
    from ...predicates.scope import Scope
    from .frames import ClothRun

__all__ = ["drape", "instance_run", "opened_since", "pinned", "tearing_pieces_of", "torn"]

P = TypeVar("P")


def _typed(predicate: SpecModel, kind: type[P]) -> P:
    assert isinstance(predicate, kind)
    return predicate


def instance_run(candidate: Candidate, entity: str) -> ClothRun:
    """The run of the instance that moves a cloth.

    Raises:
        EvidenceError: it is no cloth, or nothing moves it.
    """
    contract = candidate.spec.entities.get(entity)
    if contract is None:
        raise EvidenceError(f"entity {entity!r} is not in the specification")
    if contract.physics.category != "cloth":
        raise EvidenceError(f"{entity!r} is {contract.physics.category}, not cloth")
    for solver, instance in candidate.spec.simulation.cloth.items():
        if entity in instance.members:
            return cloth_run(candidate, solver)
    raise EvidenceError(f"no cloth instance moves {entity!r}; add it to members")


# ---------------------------------------------------------------------- drape


def shadow(points: F64, faces: I32) -> float:
    """Area that triangles cover together, seen from above [m^2]: points (n, 3) or (n, 2), faces (t, 3)."""
    corner = points[faces][:, :, :2]
    low, high = corner.min(axis=(0, 1)), corner.max(axis=(0, 1))
    cell = float((high - low).max()) / CELLS
    if not cell > 0.0:
        return 0.0
    size = np.ceil((high - low) / cell).astype(int) + 1
    covered: NDArray[np.bool_] = np.zeros((size[0], size[1]), dtype=bool)
    first = np.clip(np.ceil((corner.min(axis=1) - low) / cell - 0.5).astype(int), 0, None)
    last = np.floor((corner.max(axis=1) - low) / cell - 0.5).astype(int)
    for (a, b, c), (i0, j0), (i1, j1) in zip(corner, first.tolist(), last.tolist(), strict=True):
        if i1 < i0 or j1 < j0:
            continue
        x = low[0] + (np.arange(i0, i1 + 1)[:, None] + 0.5) * cell
        y = low[1] + (np.arange(j0, j1 + 1)[None, :] + 0.5) * cell
        sides = [(q[0] - p[0]) * (y - p[1]) - (q[1] - p[1]) * (x - p[0]) for p, q in ((a, b), (b, c), (c, a))]
        inside = (sides[0] >= 0) & (sides[1] >= 0) & (sides[2] >= 0) | (sides[0] <= 0) & (sides[1] <= 0) & (sides[2] <= 0)
        covered[i0 : i1 + 1, j0 : j1 + 1] |= inside
    return float(covered.sum()) * cell * cell


def _shadow_of(candidate: Candidate, entity: str, frame: int) -> float:
    points, faces, start = [], [], 0
    for part in candidate.entity(entity).parts:
        points.append(candidate.surface(entity, part.part, frame))
        faces.append(part.render.faces + start)
        start += len(points[-1])
    return shadow(np.concatenate(points), np.concatenate(faces).astype(np.int32))


def drape(scope: Scope, predicate: SpecModel) -> Outcome:
    """Measured: the drape coefficient."""
    p = _typed(predicate, Drape)
    candidate = scope.candidate
    run = instance_run(candidate, p.entity)
    if p.over not in candidate.spec.entities or candidate.spec.entities[p.over].physics.category != "rigid":
        raise EvidenceError(f"{p.over!r} is no rigid entity that {p.entity!r} could drape over")
    flat = float(sum(piece.area.sum() for piece in run.pieces if piece.entity == p.entity))
    value: list[float] = []
    bodies: list[float] = []
    still = candidate.spec.entities[p.over].motion == "static"
    for frame in range(scope.frames[0], scope.frames[1] + 1):
        bodies.append(bodies[0] if still and bodies else _shadow_of(candidate, p.over, frame))
        value.append((_shadow_of(candidate, p.entity, frame) - bodies[-1]) / (flat - bodies[-1]))
    if max(bodies) >= flat:
        raise EvidenceError(f"{p.entity!r} is {flat:.4g} m^2, no larger than {p.over!r} seen from above, {max(bodies):.4g} m^2")
    found = np.array(value)
    margin, side = band(found, p.min, p.max)

    def tell(i: int) -> str:
        return f"the drape coefficient of {p.entity} over {p.over} was {found[i]:.3f} at frame {scope.frames[0] + i}"

    return judge(Series(scope.frames, found, margin, "1", p.entity, side, tell), p.when)


# ---------------------------------------------------------------------- tears and pins


def opened_since(piece: TearingPiece, frame: int, since: int, by: str | None, colliders: tuple[str, ...]) -> float:
    """Length of its edges that opened in the frames (since, frame] [m], by a cause that is asked for."""
    if by is None:
        return piece.open_length(frame) - piece.open_length(since)
    sides = [
        event.sides[:, 0]
        for k in range(since + 1, frame + 1)
        for event in piece.frames[k][2]
        if event.cause >= 0 and colliders[event.cause].split("/", 1)[0] == by
    ]
    return sum(piece.length_of(s) for s in sides)


def tearing_pieces_of(run: ClothRun, entity: str) -> list[TearingPiece]:
    """The parts of a cloth, which can tear.

    Raises:
        EvidenceError: it cannot.
    """
    pieces = [q for q in tearing_pieces(run) if q.entity == entity]
    if not pieces:
        raise EvidenceError(f"{entity!r} cannot tear; give its physics tear with a strength")
    return pieces


def torn(scope: Scope, predicate: SpecModel) -> Outcome:
    """Measured: length at rest of the edges that opened since the interval began."""
    p = _typed(predicate, Torn)
    run = instance_run(scope.candidate, p.entity)
    pieces = tearing_pieces_of(run, p.entity)
    first, last = scope.frames
    since, names = max(0, first - 1), run.cache.index.colliders
    value = np.array([sum(opened_since(q, f, since, p.by, names) for q in pieces) for f in range(first, last + 1)])
    margin, side = band(value, p.min, p.max)

    def tell(i: int) -> str:
        by = "" if p.by is None else f" by {p.by}"
        return f"{value[i]:.3g} m of {p.entity} were torn{by} at frame {first + i}"

    return judge(Series(scope.frames, value, margin, "m", p.entity, side, tell), p.when)


def pinned(scope: Scope, predicate: SpecModel) -> Outcome:
    """Measured: farthest that a held vertex is off the place where its holder takes it."""
    p = _typed(predicate, Pinned)
    run = instance_run(scope.candidate, p.entity)
    held = [h for h in run.held if h.entity == p.entity and p.pin in (None, h.pin)]
    if not held:
        raise EvidenceError(f"no pin {p.pin or ''!r} holds {p.entity!r}; give its physics pins")
    value = []
    for frame in range(scope.frames[0], scope.frames[1] + 1):
        x, slips = run.frame(frame)[0], [0.0]
        for each in held:
            place = run.led(each, frame)
            if place is None:
                raise EvidenceError(f"pin {each.pin!r} is held by {each.to!r}, which has several bodies")
            slips.append(float(np.linalg.norm(x[each.rows] - place, axis=1).max()))
        value.append(max(slips))
    found = np.array(value)
    margin, side = band(found, None, p.max_slip)

    def tell(i: int) -> str:
        return f"what pins hold of {p.entity} was at most {found[i]:.3g} m off its place at frame {scope.frames[0] + i}"

    return judge(Series(scope.frames, found, margin, "m", p.entity, side, tell), p.when)
