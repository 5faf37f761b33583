"""Operations that make a liquid of a landscape's water: its volume, its domain, rivers that run in it, come in and leave."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ..construction.terrain.rivers import Course, Gate
    from ..construction.terrain.waters import WaterBody
    from ..worlds.folder import WorldFolder
    from ..worlds.landscape import SavedLandscape
    from ..worlds.spec import WorldSpec

__all__ = ["water_operations"]

ABOVE = 2.0
"""Air over the highest water in a domain [m], at least; also a fifth of its depth."""
MANY = 100_000
"""Own choice: with more particles, or with rivers, the water runs on a grid."""
RIM = 2.0
"""Ground beyond the sides of a domain, in spacings, at least."""
LEAST_ROWS = 3
"""Least number of rows of the ground's heights that a domain spans."""
DRAIN = 2.0
"""Length along the flow of the box in which a river leaves, in spacings, besides its width: no film stays behind it."""
OVER = 0.5
"""Distance that the box reaches beyond the water, beside, below and above it, in its depths."""


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
    from ..construction.terrain.rivers import river_courses, river_gates
    from ..worlds.categories.liquid.facts import LEAST_MOUTH
    from ..worlds.errors import InputError

    known = spec.entities.get(liquid)
    if known is not None and known.physics.category != "liquid":
        raise InputError(f"entity {liquid!r} exists and is no liquid; choose another id")
    body = _body(folder, land, file, center, size, spacing)
    _check_corners(body, size)
    courses, count = river_courses(land, body), body.volume / spacing**3
    owner = next((k for k, s in spec.simulation.liquid.items() if liquid in s.members), None)
    engine = spec.simulation.liquid[owner].engine if owner is not None else "flip" if courses or count > MANY else "dfsph"
    gates = river_gates(land, body, inset=2 * spacing, flush=engine == "flip")
    fits = [g for g in gates if not g.enters or min(g.size) >= LEAST_MOUTH[engine] * spacing]
    operations = [*_material(spec), *_entity(spec, body, courses, liquid, center, spacing)]
    operations += [*_instance(body, gates, liquid, owner, engine, spacing), *_drivers(spec, fits, liquid, spacing)]
    told = {"entity": liquid, **_figures(body, courses), "particles": round(count), "engine": engine}
    told |= {"inflows": [_told(g) for g in fits if g.enters], "outflows": [_told(g) for g in fits if not g.enters]}
    small = [_told(g) for g in gates if g not in fits]
    return operations, told | ({"too_small_for_the_spacing": small} if small else {})


def _body(
    folder: WorldFolder,
    land: SavedLandscape,
    file: str,
    center: tuple[float, float],
    size: tuple[float, float],
    spacing: float,
) -> WaterBody:
    """The water over the inner part of a cut ground: beyond the domain the ground goes on, or liquid would slip down its side."""
    import math

    import numpy as np

    from ..construction.terrain.waters import water_body
    from ..worlds.errors import InputError

    ground = np.load(folder.assets / file, allow_pickle=False)
    x, y = (c + np.linspace(-s / 2, s / 2, n) for c, s, n in zip(center, size, ground.shape[::-1], strict=True))
    inner = [slice(k, -k) for k in (math.ceil(RIM * spacing / float(a[1] - a[0])) for a in (x, y))]
    if min(len(x[inner[0]]), len(y[inner[1]])) < LEAST_ROWS:
        raise InputError(
            f"a ground of {size[0]:g} x {size[1]:g} m is too small for a liquid of spacing {spacing:g} m; cut more of it"
        )
    return water_body(land, x[inner[0]], y[inner[1]], ground[inner[1], inner[0]])


def _check_corners(body: WaterBody, size: tuple[float, float]) -> None:
    """Refuse a surface with more corners or triangles than a specification holds, before the ground is cut.

    Raises:
        LimitError: names both counts, the caps and what keeps below them.
    """
    import math

    from ..worlds.errors import LimitError
    from ..worlds.shapes import MESH_FACES, MESH_VERTICES

    corners, faces = len(body.mesh.vertices), len(body.mesh.faces)
    share = min(MESH_VERTICES / corners, MESH_FACES / faces)
    if share < 1.0:
        cells = max(len(body.x), len(body.y)) - 1
        raise LimitError(
            f"the surface of the water in {size[0]:g} x {size[1]:g} m has {corners:,} corners and {faces:,} triangles, caps {MESH_VERTICES:,} and "
            f"{MESH_FACES:,}. Knob: about {math.floor(0.95 * cells * math.sqrt(share))} cells instead of {cells}, or a smaller size of the ground"
        )


def _drivers(spec: WorldSpec, gates: list[Gate], liquid: str, spacing: float) -> list[dict[str, Any]]:
    """Operations that put an inflow or an outflow at every gate, in place of those of an earlier cut."""
    prefixes = (f"{liquid}_in_", f"{liquid}_out_")
    operations: list[dict[str, Any]] = [
        {"op": "remove", "path": f"/simulation/drivers/{k}"} for k in spec.simulation.drivers if k.startswith(prefixes)
    ]
    numbers = {True: 0, False: 0}
    for gate in gates:
        name = f"{prefixes[0 if gate.enters else 1]}{numbers[gate.enters]}"
        numbers[gate.enters] += 1
        operations.append(_add(f"/simulation/drivers/{name}", (_mouth if gate.enters else _drain)(gate, liquid, spacing)))
    return operations


def _figures(body: WaterBody, courses: list[Course]) -> dict[str, Any]:
    import numpy as np

    return {
        "volume_m3": round(body.volume, 3),
        "deepest_m": round(float(np.nanmax(body.level - body.ground)), 3),
        "currents": [
            {
                "reach": c.reach,
                "length_m": round(float(np.linalg.norm(np.diff(c.points[:, :2], axis=0), axis=1).sum()), 1),
                "speed_m_s": [round(float(c.speeds.min()), 3), round(float(c.speeds.max()), 3)],
            }
            for c in courses
        ],
    }


def _told(gate: Gate) -> dict[str, Any]:
    return {"reach": gate.reach, "rate_m3_s": round(gate.discharge, 4), "size_m": [round(v, 3) for v in gate.size]}


def _water(spec: WorldSpec) -> str:
    return next((k for k, m in spec.materials.items() if m.substance == "water"), "water")


def _material(spec: WorldSpec) -> list[dict[str, Any]]:
    material = _water(spec)
    if material in spec.materials:
        return []
    look = {"color": [0.75, 0.87, 0.9], "transmission": 1.0, "roughness": 0.05}
    return [_add(f"/materials/{material}", {"density": 1000, "substance": "water", "appearance": look})]


def _entity(
    spec: WorldSpec, body: WaterBody, courses: list[Course], liquid: str, center: tuple[float, float], spacing: float
) -> list[dict[str, Any]]:
    """The water with its volume and its currents, in the frame of the cut."""
    import numpy as np

    points = body.mesh.vertices
    origin = np.array([center[0], center[1], 0.0])
    shape = {
        "kind": "mesh",
        "vertices": np.round(points - origin, 6).tolist(),
        "faces": body.mesh.faces.tolist(),
        "collision": "hull",
    }
    currents = {
        f"reach_{n}": {
            "line": np.round(c.points - origin, 3).tolist(),
            "speeds": np.round(c.speeds, 4).tolist(),
            "width": round(c.width, 3),
        }
        for n, c in enumerate(courses)
    }
    extent = points.max(axis=0) - points.min(axis=0)
    value = {
        "role": "water of the landscape",
        "motion": "dynamic",
        "material": _water(spec),
        "physics": {"category": "liquid", "resolution": spacing, **({"currents": currents} if currents else {})},
        "dimensions": {"size": [round(float(v), 6) for v in extent]},
        "pose": {"position": [center[0], center[1], 0.0]},
        "parts": {"body": {"shape": shape}},
    }
    return [_add(f"/entities/{liquid}", value)]


def _instance(
    body: WaterBody, gates: list[Gate], liquid: str, owner: str | None, engine: str, spacing: float
) -> list[dict[str, Any]]:
    """The solver instance, or the domain of the one that is there: closed where rivers enter, open elsewhere."""
    import numpy as np

    from ..construction.terrain.rivers import BED_ROUGHNESS

    points = body.mesh.vertices
    top, deep = float(points[:, 2].max()), float(np.ptp(points[:, 2]))
    low = np.array([body.x[0], body.y[0], body.ground.min() - 2 * spacing])
    high = np.array([body.x[-1], body.y[-1], top + max(ABOVE, 0.2 * deep)])
    sides = ["open"] * 6
    for gate in gates:
        if gate.enters:
            near = [abs(gate.center[k // 2] - (low, high)[k % 2][k // 2]) for k in range(4)]
            sides[int(np.argmin(near))] = "closed"
    domain = {
        "center": [round(float(v), 6) for v in 0.5 * (low + high)],
        "size": [round(float(v), 6) for v in high - low],
        "sides": sides,
    }
    if owner is not None:
        return [_add(f"/simulation/solvers/{owner}/settings/domain", domain)]
    settings = {"domain": domain, **({"roughness": round(BED_ROUGHNESS, 4)} if engine == "flip" and gates else {})}
    return [_add(f"/simulation/solvers/{liquid}", {"engine": engine, "members": [liquid], "settings": settings})]


def _pose(gate: Gate, position: tuple[float, ...]) -> dict[str, Any]:
    """Local z along the flow, y up."""
    import numpy as np
    from scipy.spatial.transform import Rotation

    along, up = np.array([*gate.direction, 0.0]), np.array([0.0, 0.0, 1.0])
    turn = Rotation.from_matrix(np.column_stack([np.cross(up, along), up, along])).as_quat()[[3, 0, 1, 2]]
    return {"position": [round(float(v), 6) for v in position], "quaternion": [round(float(v), 9) for v in turn]}


def _mouth(gate: Gate, liquid: str, spacing: float) -> dict[str, Any]:
    size = [round(v, 6) for v in gate.size]
    return {"kind": "inflow", "entity": liquid, "pose": _pose(gate, gate.center), "size": size, "rate": gate.discharge}


def _drain(gate: Gate, liquid: str, spacing: float) -> dict[str, Any]:
    width, deep = gate.size
    size = [round(v, 6) for v in (width + 2 * OVER * deep, (1 + 2 * OVER) * deep, DRAIN * spacing + width)]
    x, y, z = gate.center
    center = (x + 0.5 * width * gate.direction[0], y + 0.5 * width * gate.direction[1], z)
    return {"kind": "outflow", "entity": liquid, "pose": _pose(gate, center), "size": size}


def _add(path: str, value: Any) -> dict[str, Any]:
    return {"op": "add", "path": path, "value": value}
