"""Declared caps, and the refusal of work that would exceed them before any of it is done."""

from __future__ import annotations

import contextlib
import math
import os
from pathlib import Path
from typing import TYPE_CHECKING

from .categories.caps import CATEGORY_CAPS, Cap
from .errors import InputError, LimitError

if TYPE_CHECKING:
    from .shapes import Shape
    from .spec import Entity, WorldSpec

__all__ = [
    "CAPS",
    "HEIGHT_ROWS",
    "Cap",
    "check_cap",
    "check_film",
    "check_limits",
    "check_workspace",
    "estimate_counts",
    "workspace_bytes",
]

HEIGHT_ROWS = 513
"""Rows and columns of a height file at most: half a million triangles."""
CACHE_BYTES_PER_BODY_FRAME = 160
"""Pose and velocity in float64 (13 numbers), and as much again of records and index, halved by compression [bytes]."""

FILM_BYTES_PER_PIXEL = 3.5
"""A picture file whose noise cannot be compressed, and its share of the film [bytes]."""
SMOOTH_TRIANGLES = {"box": 12, "sphere": 5120, "cylinder": 256, "capsule": 3072, "wedge": 8}
"""Triangles of shapes without a resolution of their own, as construction makes them."""


def _caps(*caps: Cap) -> dict[str, Cap]:
    return {cap.name: cap for cap in caps}


CAPS: dict[str, Cap] = _caps(
    Cap("spec_values", 2_000_000, "values", "fewer entities, smaller height fields and meshes, or mesh files in assets/"),
    Cap("spec_depth", 64, "levels", "predicates that are nested less deep"),
    Cap("patch_operations", 2_000, "operations", "split the patch: each part is a revision of its own"),
    Cap("patch_values", 500_000, "values added, copied or moved", "split the patch: each part is a revision of its own"),
    Cap("entities", 20_000, "entities", "fewer entities; many pieces that move together are parts of one entity"),
    Cap("bodies", 2_000, "bodies", "fewer entities with motion dynamic or kinematic, or fewer links of a rope generator"),
    Cap("parts", 20_000, "parts", "fewer entities or fewer parts per entity"),
    Cap("stems", 2_000, "trunks and boulders", "a smaller ground, fewer plants on it, or build_terrain without stems"),
    Cap("frames", 20_000, "frames", "/simulation/frames, /simulation/fps or /simulation/preroll"),
    Cap("steps", 50_000_000, "solver steps", "a larger /simulation/solvers/<id>/settings/step or fewer frames"),
    Cap("body_steps", 5_000_000_000, "body steps", "fewer bodies, fewer frames or a larger step"),
    Cap(
        "rerun_body_steps",
        1_000_000_000,
        "body steps",
        "fewer samples or beats in /story/robustness, fewer causes of beats, or a larger step",
    ),
    Cap("width", 1_920, "pixels", "/look/width"),
    Cap("height", 1_080, "pixels", "/look/height"),
    Cap("samples", 1_024, "samples per pixel", "/look/samples"),
    Cap("cells", 16_777_216, "cells", "a coarser resolution of the terrain or grid, or a smaller domain of the liquid or gas"),
    Cap("triangles", 5_000_000, "triangles", "coarser meshes or fewer of them"),
    Cap("crowded_pairs", 10_000, "pairs", "give the entities places of their own; place_object(on=...) finds the height"),
    Cap("mesh_bytes", 64_000_000, "bytes", "a simplified mesh, or a binary format (.glb, .ply, .stl)"),
    Cap("dem_bytes", 600_000_000, "bytes", "crop the file"),
    Cap("mesh_triangles", 200_000, "triangles", "simplify the mesh, or split it into several parts"),
    Cap("cache_bytes", 20_000_000_000, "bytes", "fewer bodies or frames"),
    Cap("bundle_bytes", 4_000_000_000, "bytes", "write the bundle without caches (worldagent bundle --no-caches)"),
    Cap("bundle_members", 200_000, "members", "write the bundle without caches (worldagent bundle --no-caches)"),
    Cap(
        "still_samples",
        250_000_000,
        "samples of pixels",
        "smaller width, height or samples; kind='preview' is quick, and kind='final' renders in a job",
    ),
    Cap("film_samples", 1_000_000_000_000, "samples of pixels", "smaller width, height or samples, or fewer frames"),
    Cap("text_characters", 4_000, "characters", "a shorter hypothesis or weakening_reason"),
    Cap("worlds", 1_000, "worlds", "another --workspace, or delete worlds from the workspace folder"),
    Cap("job_seconds", 172_800, "s", "fewer bodies, frames or samples, or a larger step"),
    Cap("job_memory_bytes", 64_000_000_000, "bytes", "fewer bodies, triangles or pixels"),
    Cap("running_jobs", 16, "jobs", "wait for running jobs or cancel some with the job tool"),
    Cap("workspace_bytes", 100_000_000_000, "bytes", "delete old candidates or worlds from the workspace folder"),
    *CATEGORY_CAPS,
)
"""All caps by name."""


def check_cap(name: str, estimate: float, *, what: str = "") -> None:
    """Refuse an amount above a cap.

    Args:
        name: Name of the cap.
        estimate: The amount that the work would take, in the cap's unit.
        what: Where the amount comes from, for the text.

    Raises:
        LimitError: The estimate exceeds the cap, or is no number.
    """
    cap = CAPS[name]
    if estimate <= cap.value:
        return
    of = f" for {what}" if what else ""
    raise LimitError(f"{name}: estimated {estimate:,.0f} {cap.unit}{of}, cap {cap.value:,}. Knob: {cap.knob}")


def estimate_counts(spec: WorldSpec) -> dict[str, float]:
    """Amounts that a specification would take, by name of the cap."""
    from .categories.registry import CATEGORIES

    plan, look = spec.simulation, spec.look
    made = {name: CATEGORIES[e.physics.category].bodies(e) for name, e in spec.entities.items()}
    bodies = sum(made[name] for name, e in spec.entities.items() if e.motion != "static")
    counts: dict[str, float] = {
        "bodies": bodies,
        "parts": sum(max(len(e.parts), made[name]) for name, e in spec.entities.items()),
        "stems": sum(p.shape.count for e in spec.entities.values() for p in e.parts.values() if p.shape.kind == "stems"),
        "frames": plan.frames + plan.lead * plan.fps,
        "width": look.width,
        "height": look.height,
        "samples": look.samples,
        "cache_bytes": bodies * plan.frames * CACHE_BYTES_PER_BODY_FRAME,
        "cells": sum(_cells(part.shape) for entity in spec.entities.values() for part in entity.parts.values())
        + sum(t.extent[0] * t.extent[1] / t.cell**2 for t in spec.terrains.values()),
        "triangles": sum(_triangles(entity) for entity in spec.entities.values()),
    }
    for category in CATEGORIES.values():
        for name, amount in category.estimate(spec).items():
            counts[name] = counts.get(name, 0.0) + amount
    return counts


def check_limits(spec: WorldSpec) -> dict[str, float]:
    """Refuse a specification that would exceed a cap; returns the estimates.

    Raises:
        LimitError: Names the cap, the estimate and the knob to turn.
    """
    counts = estimate_counts(spec)
    for name, estimate in sorted(counts.items(), key=lambda item: CAPS[item[0]].unit == "bytes"):  # what fills them comes first
        check_cap(name, estimate, what="this specification")
    return counts


def check_film(spec: WorldSpec, workspace: Path, *, width: int | None, height: int | None, samples: int | None) -> None:
    """Refuse a final sequence that would take too long or not fit on the disk.

    Raises:
        LimitError: Names the cap, the estimate and the knob to turn.
    """
    pixels = float((width or spec.look.width) * (height or spec.look.height) * spec.simulation.frames)
    check_cap("film_samples", pixels * (samples or spec.look.samples), what=f"a film of {spec.simulation.frames} frames")
    check_workspace(workspace, pixels * FILM_BYTES_PER_PIXEL)


def workspace_bytes(workspace: Path) -> int:
    """Bytes of all files under a workspace, links not followed."""
    total, folders = 0, [workspace]
    while folders:
        try:
            entries = list(os.scandir(folders.pop()))
        except OSError:
            continue
        for entry in entries:
            if entry.is_dir(follow_symlinks=False):
                folders.append(Path(entry.path))
            else:
                with contextlib.suppress(OSError):  # a temporary file that is gone by now
                    total += entry.stat(follow_symlinks=False).st_size
    return total


def check_workspace(workspace: Path, more: float) -> None:
    """Refuse `more` bytes that the workspace's cap or the free disk space does not hold.

    Raises:
        LimitError: Names what is used, what would be added and what is free.
        InputError: The workspace is gone.
    """
    import shutil

    if not workspace.is_dir():
        raise InputError(
            f"the workspace folder {workspace.name!r} is gone; create it again, or start the server with another one"
        )
    check_cap("workspace_bytes", workspace_bytes(workspace) + more, what=f"{workspace.name} with {more:,.0f} bytes more")
    free = shutil.disk_usage(workspace).free
    if more > 0.95 * free:
        raise LimitError(f"disk: estimated {more:,.0f} bytes, free {free:,}. Knob: free space, or fewer bodies or frames")


LETTER_TRIANGLES, MEMBER_TRIANGLES = 300, 400
"""Triangles of a letter and of a copy of a member of a boolean, about (measured on signs, drilled plates and gears)."""


def _cells(shape: Shape) -> int:
    rows, columns = _grid(shape)
    return (rows - 1) * (columns - 1)


def _grid(shape: Shape) -> tuple[int, int]:
    """Rows and columns of a height field; the most that a height file may have; 1 x 1 for other shapes."""
    if shape.kind != "heightfield":
        return 1, 1
    return (HEIGHT_ROWS, HEIGHT_ROWS) if shape.heights is None else (len(shape.heights), len(shape.heights[0]))


def _triangles(entity: Entity) -> int:
    """Triangles of an entity's visible surfaces; those of mesh files are counted when the file is read."""
    total = SMOOTH_TRIANGLES["capsule"] * entity.generator.segments if entity.generator is not None else 0
    for part in entity.parts.values():
        shape = part.shape
        if shape.kind == "heightfield":
            rows, columns = _grid(shape)
            total += 4 * (rows - 1) * (columns - 1) + 4 * (rows + columns)
        elif shape.kind == "stems":
            total += SMOOTH_TRIANGLES["cylinder"] * shape.count
        elif shape.kind == "sheet":
            x, y = (math.ceil(length / shape.resolution) for length in shape.size)
            total += 2 * x * y
        elif shape.kind == "mesh":
            total += len(shape.faces or ())
        elif shape.kind == "extrusion":
            total += 4 * len(shape.polygon)
        elif shape.kind == "revolution":
            total += 2 * len(shape.profile) * shape.segments
        elif shape.kind == "hull":
            total += 2 * len(shape.points)
        elif shape.kind == "sweep":
            total += 2 * len(shape.profile) * (len(shape.path) + 1)
        elif shape.kind == "loft":
            total += 4 * sum(len(s.polygon) for s in shape.sections)
        elif shape.kind == "text":
            total += LETTER_TRIANGLES * len(shape.text)
        elif shape.kind == "boolean":
            copies = sum((m.repeat.count if m.repeat else 1) * (2 if m.mirror else 1) for m in shape.of)
            total += MEMBER_TRIANGLES * copies
        else:
            total += SMOOTH_TRIANGLES[shape.kind]
    return total
