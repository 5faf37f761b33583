"""Crossings on every written frame, in float64 and by another query than the solver's: edges through triangles."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ....geometry import pierced
from ....worlds.arrays import F64, I32
from ...rows.corrections import separate
from ...rows.findings import Finding
from .frames import at_most, halved

if TYPE_CHECKING:
    from .frames import ClothRun, Solid

__all__ = ["apart", "free_of_itself"]


def free_of_itself(run: ClothRun) -> Finding:
    """Sheets through themselves and each other."""
    if not any(p.physics.self_collision for p in run.pieces):
        return Finding(
            "not_applicable", "the contract lets every sheet of the instance pass through itself (self_collision false)"
        )
    edges = np.concatenate([p.edges for p in run.pieces])
    faces = np.concatenate([p.faces for p in run.pieces])
    owner = np.concatenate([np.full(len(p.edges), k) for k, p in enumerate(run.pieces)])
    total, first, entity, place = 0, None, None, None
    for k in range(run.candidate.frame_count):
        x, _ = run.frame(k)
        found = pierced(x, edges, faces)
        if run.kin is not None:
            shared = (run.kin[edges[found[:, 0]]][:, :, None] == run.kin[faces[found[:, 1]]][:, None, :]).any(axis=(1, 2))
            found = found[~shared]
        total += len(found)
        if len(found) and first is None:
            first, entity = k, run.pieces[int(owner[found[0, 0]])].entity
            place = x[edges[found[0, 0]]].mean(axis=0).round(5).tolist()
    text = f"{total} edges go through triangles, over all {run.candidate.frame_count} frames"
    return _finding(run, total, first, entity, text, place)


def apart(run: ClothRun) -> Finding:
    """Sheets through solids, but where they hang on them."""
    total, first, entity, place, other = 0, None, None, None, ""
    if not run.solids:
        return Finding("not_applicable", "there is no solid that the cloth could meet")
    sheets = [_free(run, solid) for solid in run.solids]
    for k in range(run.candidate.frame_count):
        x, _ = run.frame(k)
        low, high = x.min(axis=0), x.max(axis=0)
        for solid, (edges, faces) in zip(run.solids, sheets, strict=True):
            points = run.candidate.surface(solid.entity, solid.part, k)
            if (points.min(axis=0) > high).any() or (points.max(axis=0) < low).any():
                continue
            count, where = _through(x, edges, faces, points, solid, low, high)
            total += count
            if count and first is None:
                first, place, other = k, where, solid.entity
                entity = run.pieces[0].entity
    text = f"sheets and solids go through each other in {total} places, over all {run.candidate.frame_count} frames"
    return _finding(run, total, first, entity, text + (f", first {other}" if other else ""), place)


def _free(run: ClothRun, solid: Solid) -> tuple[I32, I32]:
    """Edges and triangles of all sheets that do not hang on the solid's entity."""
    rows = [h.rows for h in run.held if h.to == solid.entity]
    held = np.concatenate(rows) if rows else np.empty(0, dtype=np.int32)
    faces = np.concatenate([p.faces for p in run.pieces])
    faces = faces[~np.isin(faces, held).any(axis=1)]
    edges = np.unique(np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1), axis=0)
    return edges.astype(np.int32), faces


def _through(x: F64, edges: I32, faces: I32, points: F64, solid: Solid, low: F64, high: F64) -> tuple[int, list[float] | None]:
    corner = points[solid.faces]
    near = ((corner.min(axis=1) <= high) & (corner.max(axis=1) >= low)).all(axis=1)
    own = solid.faces[near]
    if len(own) == 0:
        return 0, None
    both = np.concatenate([x, points])
    theirs = (own + len(x)).astype(np.int32)
    sides = np.unique(np.sort(np.concatenate([theirs[:, [0, 1]], theirs[:, [1, 2]], theirs[:, [2, 0]]]), axis=1), axis=0)
    ours, others = pierced(both, edges, theirs), pierced(both, sides.astype(np.int32), faces)
    place = None
    if len(ours):
        place = both[edges[ours[0, 0]]].mean(axis=0).round(5).tolist()
    elif len(others):
        place = both[faces[others[0, 1]]].mean(axis=0).round(5).tolist()
    return len(ours) + len(others), place


def _finding(run: ClothRun, total: int, first: int | None, entity: str | None, text: str, place: list[float] | None) -> Finding:
    if first is None:
        return Finding("pass", text, 0.0, 0.0, "1")
    start, later = separate(entity), halved(run, "the step is too long for the motion")
    hints = (start, later) if first == 0 else (later, start)
    text = f"{text}; first at frame {first} near {place}"
    return replace(at_most(text, float(total), 0.0, "1", first, *hints), entity=entity, evidence={"point": place})
