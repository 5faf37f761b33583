"""Landscapes as Mitsuba shapes: the land with its ground materials, sea, lakes and rivers, plants.

The part of the land that an entity carries (the ground that bodies stand on) is left out here: that entity is drawn itself.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ...worlds.arrays import F64
from ...worlds.candidate import Candidate
from ...worlds.categories.loose import domain_box
from ...worlds.errors import EvidenceError
from ...worlds.landscape import SavedLandscape, open_landscape
from ...worlds.spec import HeightField, StemField
from ..tracer.meshes import mesh_of
from .ground_look import ground_bsdf, ground_image
from .planting import eyes_of, plant_shapes
from .triangles import grid_faces, grid_uv, top_of
from .waters import water_shapes

__all__ = ["cut_from", "drawn_land", "is_stems", "landscapes_of", "patches", "scenery_shapes"]

LAND_VERTICES = 600_000
"""Most corners of the land; finer landscapes are drawn coarser."""


def landscapes_of(candidate: Candidate) -> dict[str, SavedLandscape]:
    """Built landscapes of a candidate, by id; those that are not built from the present specification are left out."""
    found = {}
    for name in candidate.spec.terrains:
        try:
            found[name] = open_landscape(candidate.folder, candidate.spec, name)
        except EvidenceError:
            continue
    return found


def scenery_shapes(mi: Any, candidate: Candidate, eyes: Sequence[F64] = ()) -> dict[str, Any]:
    """Mitsuba objects of all built landscapes, by name.

    Args:
        mi: Mitsuba.
        candidate: what to draw.
        eyes: places of cameras besides those of the shot plan [m].
    """
    shapes: dict[str, Any] = {}
    seen_from = eyes_of(candidate, eyes)
    for name, land in landscapes_of(candidate).items():
        bsdf = ground_bsdf(mi, ground_image(candidate, land), land)
        drawn = drawn_land(land)
        shapes |= _land(mi, candidate, name, land, bsdf, drawn)
        shapes |= _grounds(mi, candidate, name, land, bsdf)
        simulated = [domain_box(instance) for instance in candidate.spec.simulation.liquid.values()]
        fields = ground_fields(candidate, name)
        shapes |= water_shapes(mi, name, land, candidate.spec.terrains[name].sea_level, [drawn, *fields], simulated)
        shapes |= plant_shapes(mi, candidate, name, land, seen_from, fields)
    return shapes


def drawn_land(land: SavedLandscape, most: int = LAND_VERTICES) -> tuple[F64, F64, F64]:
    """Columns, rows and heights of the corners of the drawn land [m]; no height where there is no land."""
    rows, cols = land.shape
    step = max(1, int(np.ceil(np.sqrt(rows * cols / most))))
    x = (np.arange(0, cols, step) - 0.5 * (cols - 1)) * land.cell
    y = (np.arange(0, rows, step) - 0.5 * (rows - 1)) * land.cell
    return x.astype(np.float64), y.astype(np.float64), land.field("height")[::step, ::step]


def _land(
    mi: Any, candidate: Candidate, name: str, land: SavedLandscape, bsdf: Any, drawn: tuple[F64, F64, F64]
) -> dict[str, Any]:
    x, y, height = drawn
    known = np.isfinite(height)
    keep = known[:-1, :-1] & known[1:, :-1] & known[:-1, 1:] & known[1:, 1:]
    for west, east, south, north in patches(candidate, name):
        inside = ((x > west) & (x < east))[None] & ((y > south) & (y < north))[:, None]
        keep &= ~(inside[:-1, :-1] & inside[1:, :-1] & inside[:-1, 1:] & inside[1:, 1:])
    if not keep.any():
        return {}
    xx, yy = np.meshgrid(x, y)
    vertices = np.stack([xx, yy, np.nan_to_num(height)], axis=-1).reshape(-1, 3)
    used, faces = np.unique(grid_faces(len(y), len(x), keep), return_inverse=True)
    vertices = vertices[used]
    key = f"land-{name}"
    return {key: mesh_of(mi, key, (vertices, faces.reshape(-1, 3)), bsdf, uv=grid_uv(land, vertices), normals="smooth")}


def cut_from(candidate: Candidate, entity: str) -> str | None:
    """Id of the landscape that an entity is the ground of; None for other entities."""
    for part in candidate.spec.entities[entity].parts.values():
        if isinstance(part.shape, HeightField) and part.shape.file is not None:
            return next((n for n in candidate.spec.terrains if part.shape.file.startswith(f"{n}-")), None)
    return None


def is_stems(candidate: Candidate, entity: str, part: str) -> bool:
    """True if a part is the trunks and boulders of a landscape."""
    declared = candidate.spec.entities[entity].parts.get(part)
    return declared is not None and isinstance(declared.shape, StemField)


def _grounds(mi: Any, candidate: Candidate, name: str, land: SavedLandscape, bsdf: Any) -> dict[str, Any]:
    """The ground that bodies stand on: its own surface, in the landscape's colours."""
    found = {}
    for entity in sorted(candidate.built):
        if cut_from(candidate, entity) != name:
            continue
        for part in candidate.built[entity].parts:
            if is_stems(candidate, entity, part.part):  # its plants are drawn themselves
                continue
            vertices, faces = top_of(candidate.pose(entity, 0, part.body).apply(part.render.vertices), part.render.faces)
            key = f"ground-{entity}-{part.part}"
            found[key] = mesh_of(mi, key, (vertices, faces), bsdf, uv=grid_uv(land, vertices), normals="smooth")
    return found


def ground_fields(candidate: Candidate, name: str) -> list[tuple[F64, F64, F64]]:
    """Columns, rows and heights [m] of the grounds cut from a landscape, as their files hold them."""
    found = []
    for entity in sorted(candidate.built):
        for part in candidate.spec.entities[entity].parts.values():
            if cut_from(candidate, entity) == name and isinstance(part.shape, HeightField) and part.shape.file is not None:
                heights = np.load(candidate.folder / "assets" / part.shape.file, allow_pickle=False).astype(np.float64)
                cx, cy = candidate.spec.entities[entity].pose.position[:2]
                wide, deep = 0.5 * part.shape.size[0], 0.5 * part.shape.size[1]
                rows, cols = heights.shape
                found.append((np.linspace(cx - wide, cx + wide, cols), np.linspace(cy - deep, cy + deep, rows), heights))
    return found


def patches(candidate: Candidate, name: str) -> list[tuple[float, float, float, float]]:
    """Rectangles (west, east, south, north) of the ground entities cut from a landscape [m]."""
    found = []
    for contract in candidate.spec.entities.values():
        for part in contract.parts.values():
            if isinstance(part.shape, HeightField) and part.shape.file is not None and part.shape.file.startswith(f"{name}-"):
                cx, cy = contract.pose.position[:2]
                wide, deep = part.shape.size
                found.append((cx - wide / 2, cx + wide / 2, cy - deep / 2, cy + deep / 2))
    return found
