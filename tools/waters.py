"""Operations that make a liquid of a landscape's water: its volume, its domain, and rivers that come in."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ..worlds.folder import WorldFolder
    from ..worlds.landscape import SavedLandscape
    from ..worlds.spec import WorldSpec

__all__ = ["water_operations"]

ABOVE = 2.0
"""Air over the highest water in a domain [m], at least; also a fifth of its depth."""
MANY = 100_000
"""Own choice: with more particles the water runs on a grid."""


def water_operations(
    folder: WorldFolder,
    spec: WorldSpec,
    land: SavedLandscape,
    *,
    file: str,
    center: tuple[float, float],
    size: tuple[float, float],
    liquid: str,
    spacing: float,
) -> tuple[list[dict[str, Any]], dict[str, Any]]:
    """Operations for a liquid entity that holds the water over a cut ground, and figures for the reply.

    Args:
        folder: the world.
        spec: its specification, before the ground is added.
        land: the landscape.
        file: heights of the cut ground, in `assets/`.
        center: of the cut [m].
        size: of the cut x, y [m].
        liquid: entity id.
        spacing: particle spacing or cell size [m].

    Raises:
        InputError: the ground holds no water, or the entity is something else.
    """
    import numpy as np
    from scipy.spatial.transform import Rotation

    from ..construction.terrain.waters import river_entries, water_body
    from ..worlds.errors import InputError
    from ..worlds.liquids import LEAST_SPACINGS

    known = spec.entities.get(liquid)
    if known is not None and known.physics.category != "liquid":
        raise InputError(f"entity {liquid!r} exists and is no liquid; choose another id")
    ground = np.load(folder.assets / file, allow_pickle=False)
    x, y = (c + np.linspace(-s / 2, s / 2, n) for c, s, n in zip(center, size, ground.shape[::-1], strict=True))
    body = water_body(land, x, y, ground)
    points = body.mesh.vertices
    low, high = points.min(axis=0), points.max(axis=0)
    count = body.volume / spacing**3
    deep = float(high[2] - low[2])
    domain_low = np.array([x[0], y[0], ground.min() - 2 * spacing])
    domain_high = np.array([x[-1], y[-1], high[2] + max(ABOVE, 0.2 * deep)])
    local = np.round(points - [center[0], center[1], 0.0], 6)
    material = next((k for k, m in spec.materials.items() if m.substance == "water"), "water")
    engine = "flip" if count > MANY else "dfsph"
    found = river_entries(land, body, inset=2 * spacing)
    entries = [e for e in found if min(e.size) >= LEAST_SPACINGS * spacing]
    operations: list[dict[str, Any]] = []
    if material not in spec.materials:
        look = {"color": [0.75, 0.87, 0.9], "transmission": 1.0, "roughness": 0.05}
        operations.append(_add(f"/materials/{material}", {"density": 1000, "substance": "water", "appearance": look}))
    shape = {"kind": "mesh", "vertices": local.tolist(), "faces": body.mesh.faces.tolist(), "collision": "hull"}
    operations.append(
        _add(
            f"/entities/{liquid}",
            {
                "role": "water of the landscape",
                "motion": "dynamic",
                "material": material,
                "physics": {"category": "liquid", "resolution": spacing},
                "dimensions": {"size": [round(float(v), 6) for v in high - low]},
                "pose": {"position": [center[0], center[1], 0.0]},
                "parts": {"body": {"shape": shape}},
            },
        )
    )
    domain = {
        "center": [round(float(v), 6) for v in 0.5 * (domain_low + domain_high)],
        "size": [round(float(v), 6) for v in domain_high - domain_low],
    }
    owner = next((k for k, s in spec.simulation.liquid.items() if liquid in s.members), None)
    if owner is None:
        instance = {"engine": engine, "members": [liquid], "settings": {"domain": domain}}
        operations.append(_add(f"/simulation/solvers/{liquid}", instance))
    else:
        operations.append(_add(f"/simulation/solvers/{owner}/settings/domain", domain))
    prefix = f"{liquid}_in_"
    operations += [{"op": "remove", "path": f"/simulation/drivers/{k}"} for k in spec.simulation.drivers if k.startswith(prefix)]
    for number, entry in enumerate(entries):
        along = np.array([*entry.direction, 0.0])
        up = np.array([0.0, 0.0, 1.0])
        quaternion = Rotation.from_matrix(np.column_stack([np.cross(up, along), up, along])).as_quat()[[3, 0, 1, 2]]
        opening = {
            "kind": "inflow",
            "entity": liquid,
            "pose": {
                "position": [round(v, 6) for v in entry.center],
                "quaternion": [round(float(v), 9) for v in quaternion],
            },
            "size": [round(v, 6) for v in entry.size],
            "rate": entry.discharge,
        }
        operations.append(_add(f"/simulation/drivers/{prefix}{number}", opening))
    told = {
        "entity": liquid,
        "volume_m3": round(body.volume, 3),
        "deepest_m": round(float(np.nanmax(body.level - ground)), 3),
        "particles": round(count),
        "engine": engine,
        "inflows": [
            {"reach": e.reach, "rate_m3_s": round(e.discharge, 4), "size_m": [round(v, 3) for v in e.size]} for e in entries
        ],
        **(
            {
                "too_small_for_the_spacing": [
                    {"reach": e.reach, "size_m": [round(v, 3) for v in e.size]} for e in found if e not in entries
                ]
            }
            if len(found) > len(entries)
            else {}
        ),
    }
    return operations, told


def _add(path: str, value: Any) -> dict[str, Any]:
    return {"op": "add", "path": path, "value": value}
