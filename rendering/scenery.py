"""Landscapes as Mitsuba shapes: the land with its ground materials, sea, lakes and rivers, plants.

The part of the land that an entity carries (the ground that bodies stand on) is left out here: that entity is drawn itself.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ..worlds.arrays import F64
from ..worlds.candidate import Candidate
from ..worlds.errors import EvidenceError
from ..worlds.landscape import SavedLandscape, open_landscape
from ..worlds.spec import HeightField
from .plants import form_of, placed

__all__ = ["cut_from", "ground_image", "landscapes_of", "scenery_shapes"]

LAND_VERTICES = 600_000
"""Most corners of the land; finer landscapes are drawn coarser."""
NEAR_M = 70.0
"""Plants nearer than this to a camera have branches and leaves [m]."""
NEAR_PLANTS = 400
SHOWN_PLANTS = 60_000
"""Most plants of one landscape in a picture: the nearest to the cameras."""
DEFAULT_LOOK: dict[str, tuple[float, float, float]] = {
    "bare-rock": (0.23, 0.21, 0.19),
    "river-sediment": (0.33, 0.29, 0.23),
    "soil": (0.16, 0.14, 0.07),
}
"""Linear colours of ground that no rule covers."""
GRASS = (0.10, 0.16, 0.035)
SNOW = (0.85, 0.87, 0.9)
FOLIAGE = {"broad": (0.07, 0.13, 0.03), "cone": (0.03, 0.075, 0.03), "palm": (0.09, 0.16, 0.035), "bush": (0.10, 0.14, 0.04),
           "tuft": (0.16, 0.20, 0.06), "column": (0.10, 0.17, 0.07), "rock": (0.24, 0.22, 0.2)}  # fmt: skip
BARK = (0.13, 0.09, 0.06)
WATER: dict[str, Any] = {
    "type": "principled",
    "base_color": {"type": "rgb", "value": [0.015, 0.05, 0.06]},
    "roughness": 0.06,
    "specular": 0.6,
}
SEA_BEYOND = 2000.0
"""Half side of the sea over that of the land: to the horizon of a camera as high as the land is wide."""


def landscapes_of(candidate: Candidate) -> dict[str, SavedLandscape]:
    """Built landscapes of a candidate, by id; those that are not built from the present specification are left out."""
    found = {}
    for name in candidate.spec.terrains:
        try:
            found[name] = open_landscape(candidate.folder, candidate.spec, name)
        except EvidenceError:
            continue
    return found


def scenery_shapes(mi: Any, candidate: Candidate) -> dict[str, Any]:
    """Mitsuba objects of all built landscapes, by name."""
    shapes: dict[str, Any] = {}
    for name, land in landscapes_of(candidate).items():
        picture = ground_image(candidate, land)
        shapes |= _land(mi, candidate, name, land, picture)
        shapes |= _grounds(mi, candidate, name, land, picture)
        shapes |= _water(mi, candidate, name, land)
        shapes |= _plants(mi, candidate, name, land)
    return shapes


def ground_image(candidate: Candidate, land: SavedLandscape) -> np.ndarray:
    """Colours of the ground, linear RGB, shape (rows, cols, 3), row 0 south: materials, grass where it is moist, snow, wet banks."""
    names = land.about["cover"]
    looks = np.array([_look(candidate, n) for n in names], dtype=np.float32)
    index = land.raw("cover")
    image = looks[index]
    green = np.clip((land.field("moisture") - 0.2) / 0.45, 0, 1) * np.clip(land.field("soil_depth") / 0.3, 0, 1)
    green *= index == names.index("soil")
    image += (green[..., None] * 0.85 * (np.array(GRASS) - image)).astype(np.float32)
    wet = np.exp(-np.nan_to_num(land.field("water_distance"), posinf=1e6) / (2.0 * land.cell)) * 0.4
    image *= (1 - wet)[..., None].astype(np.float32)
    snow = land.field("snow")
    image += (snow[..., None] * (np.array(SNOW) - image)).astype(np.float32)
    rng = np.random.default_rng(3)
    return np.asarray(np.clip(image * rng.normal(1.0, 0.06, (*index.shape, 1)), 0, 1), dtype=np.float32)


def _look(candidate: Candidate, name: str) -> tuple[float, float, float]:
    if name in DEFAULT_LOOK:
        return DEFAULT_LOOK[name]
    return candidate.spec.materials[name].appearance.color if name in candidate.spec.materials else (0.3, 0.3, 0.3)


def _mesh(mi: Any, name: str, vertices: F64, faces: np.ndarray, bsdf: Any, *, uv: F64 | None = None, smooth: bool = False) -> Any:
    properties = mi.Properties()
    properties["mesh_bsdf"] = bsdf
    properties["face_normals"] = not smooth
    mesh = mi.Mesh(
        name, len(vertices), len(faces), props=properties, has_vertex_normals=smooth, has_vertex_texcoords=uv is not None
    )
    parameters = mi.traverse(mesh)
    parameters["vertex_positions"] = vertices.astype(np.float32).ravel()
    parameters["faces"] = faces.astype(np.uint32).ravel()
    if uv is not None:
        parameters["vertex_texcoords"] = uv.astype(np.float32).ravel()
    parameters.update()
    if smooth:
        mesh.recompute_vertex_normals()
    return mesh


def _grid_faces(rows: int, cols: int, keep: np.ndarray) -> np.ndarray:
    """Two triangles for every cell of corners that `keep`, shape (rows - 1, cols - 1), lets stand."""
    index = np.arange(rows * cols).reshape(rows, cols)
    a, b, c, d = (x[keep] for x in (index[:-1, :-1], index[:-1, 1:], index[1:, :-1], index[1:, 1:]))
    return np.concatenate([np.stack([a, b, d], 1), np.stack([a, d, c], 1)])


def _corners(land: SavedLandscape) -> tuple[F64, F64, int]:
    """Coordinates of the drawn columns and rows [m], and every how many cells they come."""
    rows, cols = land.shape
    step = max(1, int(np.ceil(np.sqrt(rows * cols / LAND_VERTICES))))
    x = (np.arange(0, cols, step) - 0.5 * (cols - 1)) * land.cell
    y = (np.arange(0, rows, step) - 0.5 * (rows - 1)) * land.cell
    return x.astype(np.float64), y.astype(np.float64), step


def _land(mi: Any, candidate: Candidate, name: str, land: SavedLandscape, picture: np.ndarray) -> dict[str, Any]:
    x, y, step = _corners(land)
    height = land.field("height")[::step, ::step]
    known = np.isfinite(height)
    keep = known[:-1, :-1] & known[1:, :-1] & known[:-1, 1:] & known[1:, 1:]
    for west, east, south, north in _patches(candidate, name):
        inside = ((x > west) & (x < east))[None] & ((y > south) & (y < north))[:, None]
        keep &= ~(inside[:-1, :-1] & inside[1:, :-1] & inside[:-1, 1:] & inside[1:, 1:])
    xx, yy = np.meshgrid(x, y)
    vertices = np.stack([xx, yy, np.nan_to_num(height)], axis=-1).reshape(-1, 3)
    mesh = _mesh(
        mi,
        f"land-{name}",
        vertices,
        _grid_faces(len(y), len(x), keep),
        _ground_bsdf(mi, picture),
        uv=_ground_uv(land, vertices),
        smooth=True,
    )
    return {f"land-{name}": mesh}


def _ground_bsdf(mi: Any, picture: np.ndarray) -> Any:
    """Matt ground coloured by a picture whose row 0 lies south: v grows northwards, as Mitsuba flips bitmaps."""
    bitmap = mi.Bitmap(np.ascontiguousarray(np.flipud(picture)))
    texture = {"type": "bitmap", "bitmap": bitmap, "raw": True, "wrap_mode": "clamp"}
    return mi.load_dict({"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": texture}})


def _ground_uv(land: SavedLandscape, vertices: F64) -> F64:
    extent = np.array([land.shape[1], land.shape[0]]) * land.cell
    return np.asarray(vertices[:, :2] / extent + 0.5)


def cut_from(candidate: Candidate, entity: str) -> str | None:
    """Id of the landscape that an entity is the ground of; None for other entities."""
    for part in candidate.spec.entities[entity].parts.values():
        if isinstance(part.shape, HeightField) and part.shape.file is not None:
            return next((n for n in candidate.spec.terrains if part.shape.file.startswith(f"{n}-")), None)
    return None


def _grounds(mi: Any, candidate: Candidate, name: str, land: SavedLandscape, picture: np.ndarray) -> dict[str, Any]:
    """The ground that bodies stand on: its own surface, in the landscape's colours."""
    found = {}
    for entity in sorted(candidate.built):
        if cut_from(candidate, entity) != name:
            continue
        for part in candidate.built[entity].parts:
            vertices = candidate.pose(entity, 0, part.body).apply(part.render.vertices)
            key = f"ground-{entity}-{part.part}"
            found[key] = _mesh(
                mi, key, vertices, part.render.faces, _ground_bsdf(mi, picture), uv=_ground_uv(land, vertices), smooth=False
            )
    return found


def _patches(candidate: Candidate, name: str) -> list[tuple[float, float, float, float]]:
    """Rectangles (west, east, south, north) of the ground entities cut from a landscape [m]."""
    found = []
    for contract in candidate.spec.entities.values():
        for part in contract.parts.values():
            if isinstance(part.shape, HeightField) and part.shape.file is not None and part.shape.file.startswith(f"{name}-"):
                cx, cy = contract.pose.position[:2]
                wide, deep = part.shape.size
                found.append((cx - wide / 2, cx + wide / 2, cy - deep / 2, cy + deep / 2))
    return found


def _water(mi: Any, candidate: Candidate, name: str, land: SavedLandscape) -> dict[str, Any]:
    from scipy import ndimage

    bsdf = mi.load_dict({"type": "twosided", "bsdf": WATER})
    shapes: dict[str, Any] = {}
    terrain = candidate.spec.terrains[name]
    half = 0.5 * max(land.shape) * land.cell
    if terrain.sea_level is not None and land.raw("sea").any():
        side = SEA_BEYOND * half
        corners = np.array([[-side, -side], [side, -side], [side, side], [-side, side]])
        vertices = np.column_stack([corners, np.full(4, terrain.sea_level)])
        shapes[f"sea-{name}"] = _mesh(mi, f"sea-{name}", vertices, np.array([[0, 1, 2], [0, 2, 3]]), bsdf)
    rows, cols = land.shape
    x = (np.arange(cols) - 0.5 * (cols - 1)) * land.cell
    y = (np.arange(rows) - 0.5 * (rows - 1)) * land.cell
    lake, level = land.raw("lake"), land.field("water_level")
    flowing = np.isfinite(level) & (lake == 0)
    for part, mask in (("lakes", lake > 0), ("rivers", flowing)):
        if not mask.any():
            continue
        # One cell wider: the bank cuts the surface off where it meets the ground.
        near = ndimage.distance_transform_edt(~mask, return_distances=False, return_indices=True)
        wide = ndimage.binary_dilation(mask, iterations=1)
        surface = level[tuple(near)]
        keep = wide[:-1, :-1] & wide[1:, :-1] & wide[:-1, 1:] & wide[1:, 1:]
        if not keep.any():
            continue
        faces = _grid_faces(rows, cols, keep)
        used, faces = np.unique(faces, return_inverse=True)
        xx, yy = np.meshgrid(x, y)
        vertices = np.stack([xx, yy, np.nan_to_num(surface)], axis=-1).reshape(-1, 3)[used]
        shapes[f"{part}-{name}"] = _mesh(mi, f"{part}-{name}", vertices, faces.reshape(-1, 3), bsdf)
    return shapes


def _eyes(candidate: Candidate) -> F64:
    """Places that cameras look from [m], shape (n, 3)."""
    places = [key.position for shot in candidate.spec.shots.values() for key in shot.keys.values()]
    return np.array(places, dtype=np.float64).reshape(-1, 3)


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


def _plants(mi: Any, candidate: Candidate, name: str, land: SavedLandscape) -> dict[str, Any]:
    if "plant_position" not in land.names:
        return {}
    position, height, yaw = (
        land.raw("plant_position"),
        land.raw("plant_height").astype(float),
        land.raw("plant_yaw").astype(float),
    )
    kind, radius = land.raw("plant_kind"), land.raw("plant_radius").astype(float)
    free = np.ones(len(position), dtype=bool)
    for center, reach in _footprints(candidate):
        free &= np.hypot(*(position[:, :2] - center).T) > reach + radius
    eyes = _eyes(candidate)
    away = np.full(len(position), np.inf)
    for eye in eyes:
        away = np.minimum(away, np.linalg.norm(position - eye, axis=1))
    shown = np.flatnonzero(free)
    if len(shown) > SHOWN_PLANTS:
        shown = shown[np.argsort(away[shown], kind="stable")[:SHOWN_PLANTS]]
    near = np.zeros(len(position), dtype=bool)
    close = shown[away[shown] < NEAR_M]
    near[close[np.argsort(away[close], kind="stable")[:NEAR_PLANTS]]] = True
    meshes: dict[tuple[float, float, float], list[tuple[F64, np.ndarray]]] = {}
    for number, shape in enumerate(land.about["plant_shapes"]):
        for detailed in (False, True):
            chosen = shown[(kind[shown] == number) & (near[shown] == detailed)]
            if not len(chosen):
                continue
            form = form_of(shape, near=detailed, seed=number)
            for leafy in (False, True):
                faces = form.faces[form.foliage == leafy]
                if not len(faces):
                    continue
                color = FOLIAGE[shape] if leafy or shape == "rock" else BARK
                used, numbers = np.unique(faces, return_inverse=True)
                part = form._replace(
                    vertices=form.vertices[used], faces=numbers.reshape(-1, 3), foliage=form.foliage[form.foliage == leafy]
                )
                meshes.setdefault(color, []).append(placed(part, position[chosen], height[chosen], yaw[chosen]))
    shapes = {}
    for count, (color, pieces) in enumerate(sorted(meshes.items())):
        starts = np.cumsum([0, *(len(v) for v, _ in pieces)])
        vertices = np.concatenate([v for v, _ in pieces])
        faces = np.concatenate([f + s for (_, f), s in zip(pieces, starts, strict=False)])
        bsdf = mi.load_dict(
            {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": {"type": "rgb", "value": list(color)}}}
        )
        shapes[f"plants{count}-{name}"] = _mesh(mi, f"plants{count}-{name}", vertices, faces, bsdf)
    return shapes
