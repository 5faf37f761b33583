"""The job behind build_terrain(terrain=...): a landscape from the specification, and the ground that bodies stand on."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..execution import JobContext
from ..worlds.errors import InputError
from ..worlds.folder import WorldFolder, write_atomically
from ..worlds.landscape import SavedLandscape
from ..worlds.limits import check_limits
from ..worlds.patch import apply_patch
from ..worlds.spec import WorldSpec
from .land_warnings import land_warnings
from .outdoor import after_building
from .rows import news, open_rows
from .session import Session

if TYPE_CHECKING:
    from ..construction.stems import StemCut
    from ..construction.terrain.store import GroundPatch

__all__ = ["OVERVIEW", "describe", "ground_material", "membership", "reach_line", "short", "terrain"]

OVERVIEW = ("hillshade", "accumulation", "cover", "moisture")
"""Fields on the overview sheet."""
SHOWN = 8
PATCH_SIZE = 256.0
"""Longest side of the ground that bodies stand on where none is asked for [m]."""


def ground_material(spec: WorldSpec, material: str | None) -> str:
    """The material of the ground: as asked, else the first stone, concrete or other one.

    Raises:
        InputError: it is not declared.
    """
    found = material or next((k for k, m in spec.materials.items() if m.substance in ("stone", "concrete", "other")), None)
    if found is None or found not in spec.materials:
        raise InputError(f"material {found!r} is not declared; the world has {sorted(spec.materials)}. Add one with edit_spec")
    return found


def membership(spec: WorldSpec, entity: str) -> list[dict[str, Any]]:
    """Operations that make an entity a member of a rigid instance: of the first; of a new one where there is none."""
    solvers = spec.simulation.solvers
    if any(entity in s.members for s in solvers.values()):
        return []
    if spec.simulation.rigid:
        return [{"op": "add", "path": f"/simulation/solvers/{next(iter(spec.simulation.rigid))}/members/-", "value": entity}]
    return [{"op": "add", "path": "/simulation/solvers/rigid", "value": {"engine": "mujoco", "members": [entity]}}]


def terrain(payload: dict[str, Any], context: JobContext) -> dict[str, Any]:
    """Build a landscape, cut the ground from it, make it the next revision, check it, and draw an overview."""
    from ..construction.stems import cut_stems
    from ..construction.terrain.store import build_terrain_file, cut_patch

    session = Session.at(WorldFolder.at(Path(payload["folder"])))
    name = payload["terrain"]
    before = {row.id: row for row in session.ledger.rows()}

    def say(done: float, text: str) -> None:
        context.check()
        context.progress(done, 1.0, text)

    land, fresh = build_terrain_file(session.folder, session.spec, name, say=say)
    context.check()
    extent = land.shape[1] * land.cell, land.shape[0] * land.cell
    size = payload.get("size") or [min(s, PATCH_SIZE) for s in extent]
    center = payload.get("center") or (0.0, 0.0)
    patch = cut_patch(session.folder, name, land, center=tuple(center), size=tuple(size), cells=payload["cells"])
    stems = cut_stems(session.folder, name, land, center=tuple(center), size=tuple(size)) if payload.get("stems") else None
    spec, entity = session.spec, payload["entity"]
    contract = _contract(name, patch, tuple(center), ground_material(spec, payload.get("material")), stems)
    operations: list[dict[str, Any]] = [{"op": "add", "path": f"/entities/{entity}", "value": contract}]
    operations += membership(spec, entity)
    more, water = _waters(session, land, patch, tuple(center), payload)
    operations += more
    after = apply_patch(spec, operations)
    data: dict[str, Any] = {}
    if after != spec:
        check_limits(after)
        derived = _follows(session, entity, contract, patch.file)
        data |= session.commit(after, patch=operations, hypothesis=payload.get("hypothesis", ""), derived=derived)
    report = session.audit()
    data |= {"built": fresh, **describe(land), "ground": {"entity": entity, "center": list(center), **patch._asdict()}}
    data |= {"stems": stems.number if stems is not None else 0} if payload.get("stems") else {}
    data |= {"water": water} if water else {}
    told = land_warnings(session.spec, name, land, water)
    data |= {"warnings": told} if told else {}
    static_open: list[str] = []
    if report.passed:
        rows, changed, _ = session.check_static()
        data |= {"changed_rows": len(changed), **news(rows, before, static=True)}
        static_open = [r.id for r in open_rows(rows, static=True) if r.mandatory]
    else:
        data |= {"audit": {"passed": False, **news(report.rows, before)}}
    data["then"] = after_building(session, entity, [r.id for r in open_rows(report.rows) if r.mandatory], static_open)
    say(0.99, "drawing an overview")
    data["picture"] = _overview(session.folder, name, land)
    return data


def _contract(name: str, patch: GroundPatch, center: tuple[float, float], material: str, stems: StemCut | None) -> dict[str, Any]:
    """The entity of a ground that is cut from a landscape, with its trunks and boulders where they are solid."""
    base = max(1.0, 0.02 * max(patch.size))
    half = [0.5 * s for s in patch.size]
    low, high = [-half[0], -half[1], patch.low - base], [half[0], half[1], patch.high]
    land = {"kind": "heightfield", "size": list(patch.size), "file": patch.file, "digest": patch.digest, "base": base}
    parts: dict[str, Any] = {"land": {"shape": land}}
    size = [patch.size[0], patch.size[1], patch.high - patch.low + base]
    if stems is not None:
        parts["stems"] = {"shape": {"kind": "stems", "file": stems.file, "digest": stems.digest, "count": stems.number}}
        size = [max(high[k], float(stems.high[k])) - min(low[k], float(stems.low[k])) for k in range(3)]
    return {
        "role": f"ground cut from the landscape {name!r}",
        "motion": "static",
        "material": material,
        "dimensions": {"size": size},
        "pose": {"position": [center[0], center[1], 0.0]},
        "parts": parts,
    }


def _waters(
    session: Session, land: SavedLandscape, patch: GroundPatch, center: tuple[float, float], payload: dict[str, Any]
) -> tuple[list[dict[str, Any]], dict[str, Any]]:
    """Operations for the liquid that is asked for, and figures of it; none where none is."""
    if not payload.get("liquid"):
        return [], {}
    from .waters import water_operations

    return water_operations(
        session.folder,
        session.spec,
        land,
        file=patch.file,
        center=center,
        size=patch.size,
        liquid=payload["liquid"],
        spacing=payload.get("spacing") or 0.25 * max(patch.size) / payload["cells"],
    )


def _follows(session: Session, entity: str, contract: dict[str, Any], file: str) -> bool:
    """True if a ground is the present one cut anew: the same place, size, material and number of cells from a landscape that changed."""
    import numpy as np

    known = session.spec.entities.get(entity)
    if known is None or "land" not in known.parts or set(known.parts) != set(contract["parts"]):
        return False
    shape, wanted = known.parts["land"].shape, contract["parts"]["land"]["shape"]
    if shape.kind != "heightfield" or shape.file is None or shape.file.rpartition("-")[0] != file.rpartition("-")[0]:
        return False
    old = session.folder.assets / shape.file
    sizes = [np.load(p, mmap_mode="r", allow_pickle=False).shape for p in (old, session.folder.assets / file) if p.is_file()]
    if len(sizes) < 2 or sizes[0] != sizes[1]:
        return False
    here = (list(known.pose.position), known.material, known.role, list(shape.size))
    return here == (contract["pose"]["position"], contract["material"], contract["role"], wanted["size"])


def describe(land: SavedLandscape) -> dict[str, Any]:
    """Numbers of a landscape for the model: its water, its heights, what grows."""
    import numpy as np

    about, height = land.about, land.field("height")
    reaches = sorted(about["reaches"], key=lambda r: -r["discharge"][1])
    rows, cols = land.shape

    return {
        "cells": [cols, rows],
        "height_range": [round(float(np.nanmin(height)), 3), round(float(np.nanmax(height)), 3)],
        "lakes": [{k: short(v) for k, v in lake.items()} for lake in about["lakes"][:SHOWN]],
        "rivers": [{"kind": r["kind"], **reach_line(land, r)} for r in reaches[:SHOWN]],
        "features": {k: about["figures"][k] for k in ("lakes", "rivers", "streams", "plants")},
        "relief": about["figures"].get("relief", {}),
        "erosion": {k: about["figures"][k] for k in ("river_erosion", "hydraulic_erosion", "slopes") if k in about["figures"]},
    }


def reach_line(land: SavedLandscape, reach: dict[str, Any]) -> dict[str, Any]:
    """A reach in numbers: where it begins and ends, and how large it is at both ends."""
    import numpy as np

    rows, cols = land.shape
    cells = np.array(reach["cells"])
    x, y = (cells % cols - 0.5 * (cols - 1)) * land.cell, (cells // cols - 0.5 * (rows - 1)) * land.cell
    return {
        "number": reach["number"],
        "from": [round(float(x[0]), 2), round(float(y[0]), 2)],
        "to": [round(float(x[-1]), 2), round(float(y[-1]), 2)],
        "length": round(float(np.hypot(np.diff(x), np.diff(y)).sum()), 1),
        "ends_in": reach["ends_in"],
        **{k: short(reach[k]) for k in ("order", "width", "depth", "discharge")},
    }


def short(value: Any) -> Any:
    """A value with five significant digits."""
    if isinstance(value, float):
        return float(f"{value:.5g}")
    return [short(v) for v in value] if isinstance(value, list) else value


def _overview(folder: WorldFolder, name: str, land: SavedLandscape) -> str:
    """Sheet of the main fields, kept in `pictures/`; its file name."""
    from ..rendering import contact_sheet, field_map

    images = [field_map(land, field, width=760, height=600) for field in OVERVIEW]
    file = f"terrain_{name}.jpg"
    write_atomically(folder.pictures / file, contact_sheet(images, [f"{name}: {field}" for field in OVERVIEW], columns=2))
    return file
