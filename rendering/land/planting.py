"""Plants of a landscape in a picture: which are drawn, in which detail by their distance to the cameras, and the turf at their feet.

Three forms of every kind: with branches and leaves near a camera, a low one, and one of a few triangles for the distance. All
instances of a form and colour are one mesh: a hundred thousand plants are a dozen shapes.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ...geometry.camera import camera_at
from ...worlds.arrays import F64
from ...worlds.candidate import Candidate
from ...worlds.landscape import SavedLandscape
from ...worlds.spec import HeightField, StemField
from ...worlds.stems import stems_from
from ..tracer.meshes import mesh_of
from .plants import Form, form_of, placed
from .waters import surface_height

__all__ = ["eyes_of", "free_plants", "nearest_eye", "plant_color", "plant_shapes"]

NEAR_M = 90.0
"""Plants nearer than this to a camera have branches and leaves [m]."""
MIDDLE_M = 900.0
"""Plants farther than this are a few triangles [m]."""
NEAR_PLANTS = 500
SHOWN_PLANTS = 150_000
"""Most plants of one landscape in a picture: the nearest to the cameras."""
VARIANTS = 3
"""Forms of a kind near a camera, and shades of its foliage."""
PATH_STEPS = 12
"""Places along a shot at which its camera is asked."""
FOLIAGE = {"broad": (0.045, 0.09, 0.02), "cone": (0.03, 0.075, 0.03), "palm": (0.07, 0.13, 0.03), "bush": (0.08, 0.11, 0.035),
           "tuft": (0.13, 0.17, 0.05), "column": (0.10, 0.17, 0.07), "rock": (0.16, 0.15, 0.14)}  # fmt: skip
BARK = (0.11, 0.08, 0.055)
TINTS = ((0.75, 0.85, 0.8), (1.0, 1.0, 1.0), (1.3, 1.15, 0.9))
TURF_M = 30.0
"""Grass grows in pictures so far around a camera near the ground [m]: blades are a texture of the ground, no instances of the world."""
TURF = 24_000


def eyes_of(candidate: Candidate, own: Sequence[F64] = ()) -> F64:
    """Places that cameras look from [m], shape (n, 3): along every shot, and own ones."""
    places = [np.asarray(p, dtype=np.float64) for p in own]
    for shot in map(candidate.aimed, candidate.spec.shots.values()):
        frames = np.linspace(shot.frames[0], shot.frames[1], PATH_STEPS if len(shot.keys) > 1 else 1)
        places += [camera_at(shot, round(k), 16, 9, np.zeros(3)).position for k in frames]
    return np.array(places, dtype=np.float64).reshape(-1, 3)


def nearest_eye(position: F64, eyes: F64) -> F64:
    """Distance of places to the nearest eye [m], shape (n,); infinite without one."""
    away = np.full(len(position), np.inf)
    for eye in np.unique(eyes, axis=0):
        away = np.minimum(away, np.linalg.norm(position - eye, axis=1))
    return away


def plant_color(shape: str) -> tuple[float, float, float]:
    """Linear colour of a kind as seen from afar."""
    return FOLIAGE[shape]


def free_plants(candidate: Candidate, land: SavedLandscape) -> np.ndarray:
    """Indices of the plants that nothing stands on, and of those that bodies bounce off."""
    position, radius = land.raw("plant_position"), land.raw("plant_radius").astype(float)
    free = np.ones(len(position), dtype=bool)
    for center, reach in _footprints(candidate):
        free &= np.hypot(*(position[:, :2] - center).T) > reach + radius
    free[_solid(candidate, land)] = True
    return np.flatnonzero(free)


def _solid(candidate: Candidate, land: SavedLandscape) -> np.ndarray:
    """Indices of the plants of a landscape that a ground has as solids."""
    name = land.path.name.split(".")[0]
    fields = [
        p.shape for n in candidate.built for p in candidate.spec.entities[n].parts.values() if isinstance(p.shape, StemField)
    ]
    files = [candidate.folder / "assets" / f.file for f in fields if f.file.startswith(f"{name}-stems-")]
    found = np.concatenate(
        [np.zeros(0, dtype=np.int64), *(stems_from(np.load(f, allow_pickle=False)).plant for f in files if f.is_file())]
    )
    return found[found < len(land.raw("plant_position"))]


def _footprints(candidate: Candidate) -> list[tuple[F64, float]]:
    """Centre and radius [m] of what stands on the land: nothing grows there."""
    found = []
    for name in candidate.built:
        contract = candidate.spec.entities[name]
        if any(isinstance(p.shape, HeightField) for p in contract.parts.values()):
            continue
        corners = candidate.vertices(name, 0)[:, :2]
        low, high = corners.min(0), corners.max(0)
        found.append((0.5 * (low + high), 0.5 * float(np.hypot(*(high - low)))))
    return found


Fields = Sequence[tuple[F64, F64, F64]]
"""Columns, rows and heights of grounds [m]."""
Meshes = dict[tuple[float, float, float], list[tuple[F64, np.ndarray]]]


def plant_shapes(mi: Any, candidate: Candidate, name: str, land: SavedLandscape, eyes: F64, fields: Fields) -> dict[str, Any]:
    """Mitsuba objects of the plants and stones of a landscape, and of the turf near its cameras."""
    meshes: Meshes = {}
    if "plant_position" in land.names:
        _stand(candidate, land, eyes, meshes)
    _turf(candidate, land, eyes, fields, meshes)
    shapes = {}
    for count, (color, pieces) in enumerate(sorted(meshes.items())):
        starts = np.cumsum([0, *(len(v) for v, _ in pieces)])
        vertices = np.concatenate([v for v, _ in pieces])
        faces = np.concatenate([f + s for (_, f), s in zip(pieces, starts, strict=False)])
        bsdf = mi.load_dict(
            {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": {"type": "rgb", "value": list(color)}}}
        )
        shapes[f"plants{count}-{name}"] = mesh_of(mi, f"plants{count}-{name}", (vertices, faces), bsdf)
    return shapes


def _stand(candidate: Candidate, land: SavedLandscape, eyes: F64, meshes: Meshes) -> None:
    position, kind = land.raw("plant_position"), land.raw("plant_kind")
    height, yaw = land.raw("plant_height").astype(float), land.raw("plant_yaw").astype(float)
    away = nearest_eye(position, eyes)
    shown = free_plants(candidate, land)
    if len(shown) > SHOWN_PLANTS:
        shown = shown[np.argsort(away[shown], kind="stable")[:SHOWN_PLANTS]]
    detail = np.where(away < MIDDLE_M, 1, 0)
    close = shown[away[shown] < NEAR_M]
    detail[close[np.argsort(away[close], kind="stable")[:NEAR_PLANTS]]] = 2
    variant = np.random.default_rng(9).integers(0, VARIANTS, len(position))
    for number, shape in enumerate(land.about["plant_shapes"]):
        own = shown[kind[shown] == number]
        for level in range(3):
            for tint in range(VARIANTS):
                chosen = own[(detail[own] == level) & (variant[own] == tint)]
                if len(chosen):
                    form = form_of(shape, detail=level, seed=number + 31 * tint * (level == 2))
                    _add(meshes, form, shape, tint, (position[chosen], height[chosen], yaw[chosen]))


def _add(meshes: Meshes, form: Form, shape: str, tint: int, where: tuple[F64, F64, F64]) -> None:
    for leafy in (False, True):
        faces = form.faces[form.foliage == leafy]
        if not len(faces):
            continue
        base = FOLIAGE[shape] if leafy or shape == "rock" else BARK
        red, green, blue = (b * t for b, t in zip(base, TINTS[tint] if leafy else (1.0, 1.0, 1.0), strict=True))
        used, numbers = np.unique(faces, return_inverse=True)
        part = Form(form.vertices[used], numbers.reshape(-1, 3), form.foliage[form.foliage == leafy])
        meshes.setdefault((red, green, blue), []).append(placed(part, *where))


def _turf(candidate: Candidate, land: SavedLandscape, eyes: F64, fields: Fields, meshes: Meshes) -> None:
    """Grass and stones on the ground near cameras that are near it, where the cover lets them be."""
    rows, cols = land.shape
    height, wet, bed = land.field("height"), land.raw("wet").astype(bool), land.raw("bed").astype(bool)
    moist, soil = land.field("moisture"), land.field("soil_depth")
    sand = np.isin(land.raw("cover"), [k for k, n in enumerate(land.about["cover"]) if n in ("bare-rock", "river-sediment")])
    bare = _footprints(candidate)
    rng = np.random.default_rng(13)
    for eye in np.unique(np.round(eyes, 0), axis=0):
        distance = TURF_M * np.sqrt(rng.uniform(0.002, 1, TURF))
        turn = rng.uniform(0, 2 * np.pi, TURF)
        at = eye[:2] + distance[:, None] * np.stack([np.cos(turn), np.sin(turn)], 1)
        u, v = at[:, 0] / land.cell + 0.5 * (cols - 1), at[:, 1] / land.cell + 0.5 * (rows - 1)
        inside = (u > 0) & (v > 0) & (u < cols - 1) & (v < rows - 1)
        if not inside.any():
            continue
        at, u, v = at[inside], u[inside], v[inside]
        r, c = np.round(v).astype(int), np.round(u).astype(int)
        z = _bilinear(height, u, v)
        if not np.isfinite(z).any() or eye[2] - np.nanmin(z) > TURF_M:
            continue
        z = _on_grounds(fields, at, z)
        free = ~wet[r, c] & ~bed[r, c] & np.isfinite(z)
        for center, reach in bare:
            free &= np.hypot(*(at - center).T) > reach
        grass = free & ~sand[r, c] & (soil[r, c] > 0.05) & (rng.uniform(size=len(at)) < np.clip((moist[r, c] - 0.15) / 0.3, 0, 1))
        stone = free & ~grass & (rng.uniform(size=len(at)) < 0.12)
        for shape, chosen, low, high in (("tuft", grass, 0.08, 0.4), ("rock", stone, 0.02, 0.16)):
            tint = rng.integers(0, VARIANTS, len(at))
            for k in range(VARIANTS):
                own = np.flatnonzero(chosen & (tint == k))
                if len(own):
                    size = low + (high - low) * rng.uniform(0, 1, len(own)) ** 2
                    where = np.column_stack([at[own], z[own]]), size, rng.uniform(0, 2 * np.pi, len(own))
                    _add(meshes, form_of(shape, detail=1, seed=k), shape, k, where)


def _bilinear(field: F64, u: F64, v: F64) -> F64:
    from scipy import ndimage

    return np.asarray(ndimage.map_coordinates(field, [v, u], order=1, mode="nearest"))


def _on_grounds(fields: Fields, at: F64, z: F64) -> F64:
    """Heights of the grounds that entities carry, where points lie over one."""
    for x, y, height in fields:
        inside = (at[:, 0] >= x[0]) & (at[:, 0] <= x[-1]) & (at[:, 1] >= y[0]) & (at[:, 1] <= y[-1])
        z[inside] = surface_height(x, y, height, at[inside])
    return z
