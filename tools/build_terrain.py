"""Tool build_terrain: ground as a static height field."""

from __future__ import annotations

import re
from typing import Annotated, Any, Literal

from pydantic import Field

from ..worlds.errors import InputError
from ..worlds.vocabulary import ID_PATTERN
from .context import ToolContext, ToolReply

__all__ = ["build_terrain"]


def build_terrain(
    context: ToolContext,
    world: Annotated[str, Field(description="World id")],
    entity: Annotated[str, Field(description="Entity id of the ground; replaced if it is a terrain already")] = "ground",
    kind: Annotated[Literal["flat", "slope", "hills"], Field(description="Shape of the land")] = "flat",
    size: Annotated[tuple[float, float], Field(description="Extent x, y [m], 0.5 to 2000")] = (20.0, 20.0),
    cells: Annotated[int, Field(ge=2, le=200, description="Cells along the longer side")] = 48,
    relief: Annotated[float, Field(ge=0, le=200, description="slope: rise from -x to +x [m]; hills: height range [m]")] = 0.0,
    plain_radius: Annotated[
        float, Field(ge=0, le=2000, description="hills: level circle around the origin for things to stand on [m]")
    ] = 0.0,
    seed: Annotated[int, Field(ge=0, lt=2**31, description="hills: random seed")] = 0,
    material: Annotated[
        str | None, Field(description="Material id; default: the first stone, concrete or other material")
    ] = None,
    hypothesis: Annotated[str, Field(description="After a failed row: what causes it and why this cures it")] = "",
) -> ToolReply:
    """Make the ground of an outdoor world: a static height field, as a new revision, and check it.

    flat lies at z = 0; slope rises from z = 0 at -x towards +x; hills is noise that fades to z = 0 inside plain_radius.
    The ground becomes a member of the first solver instance. Lengths in m. Needs a solver instance and a material.
    Not for: floors, tables and other flat things, which a static box does better (edit_spec); rivers, erosion and
    vegetation are not in this build. Repeating it with the same entity replaces that ground.
    Returns: revision, height range, static rows that fail. Next: place_object.
    """
    from ..worlds.limits import check_limits
    from ..worlds.patch import apply_patch
    from .answers import answer, call, rows_answer
    from .rows import summary
    from .session import Session

    if re.match(ID_PATTERN, entity) is None:
        raise InputError(f"entity id {entity!r} must match {ID_PATTERN}, e.g. 'ground'")
    if not all(0.5 <= s <= 2000 for s in size):
        raise InputError(f"size {size} m is out of range; allowed 0.5 to 2000 m along each side")
    session = Session.open(context.workspace, world)
    spec = session.spec
    known = spec.entities.get(entity)
    if known is not None and not any(p.shape.kind == "heightfield" for p in known.parts.values()):
        raise InputError(f"entity {entity!r} exists and is no terrain; choose another id")
    if not spec.simulation.solvers:
        raise InputError("the world has no solver instance yet; add /simulation/solvers/rigid with edit_spec first")
    ground = material or next((k for k, m in spec.materials.items() if m.substance in ("stone", "concrete", "other")), None)
    if ground is None or ground not in spec.materials:
        raise InputError(f"material {ground!r} is not declared; the world has {sorted(spec.materials)}. Add one with edit_spec")
    heights = _heights(kind, size, cells, relief, plain_radius, seed)
    flat = [v for row in heights for v in row]
    base = 0.5
    contract = {
        "role": f"ground ({kind})",
        "motion": "static",
        "material": ground,
        "dimensions": {"size": [size[0], size[1], max(flat) - min(flat) + base]},
        "parts": {"land": {"shape": {"kind": "heightfield", "size": list(size), "heights": heights, "base": base}}},
    }
    patch: list[dict[str, Any]] = [{"op": "add", "path": f"/entities/{entity}", "value": contract}]
    solver = next((k for k, s in spec.simulation.solvers.items() if entity in s.members), None)
    if solver is None:
        solver = next(iter(spec.simulation.solvers))
        patch.append({"op": "add", "path": f"/simulation/solvers/{solver}/members/-", "value": entity})
    after = apply_patch(spec, patch)
    check_limits(after)
    outcome = session.commit(after, patch=patch, hypothesis=hypothesis)
    report = session.audit()
    data: dict[str, Any] = {
        "world": world,
        **outcome,
        "height_range": [min(flat), max(flat)],
        "cells": [len(heights[0]) - 1, len(heights) - 1],
    }
    text = f"{entity}: {kind} ground of {size[0]:g} x {size[1]:g} m, {len(heights[0]) - 1} x {len(heights) - 1} cells"
    if not report.passed:
        audit = rows_answer(world, summary(report.rows), "concise", "", "")
        data["audit"] = {k: v for k, v in audit.items() if k not in ("summary", "warnings", "next")}
        return ToolReply(answer(data, f"{text}; the audit leaves rows open", "edit_spec: mend the audit's open rows"))
    rows, changed, _ = session.check_static()
    data |= {"changed_rows": len(changed), **summary(rows, static=True)}
    return ToolReply(rows_answer(world, data, "concise", text, call("place_object", world=world)))


def _heights(kind: str, size: tuple[float, float], cells: int, relief: float, plain: float, seed: int) -> list[list[float]]:
    """Heights [m], rows from south to north."""
    import numpy as np

    longer = max(size)
    counts = [max(2, round(cells * s / longer)) for s in size]
    x = np.linspace(-size[0] / 2, size[0] / 2, counts[0] + 1)
    y = np.linspace(-size[1] / 2, size[1] / 2, counts[1] + 1)
    xx, yy = np.meshgrid(x, y)
    if kind == "flat" or relief == 0:
        z = np.zeros_like(xx)
    elif kind == "slope":
        z = relief * (xx + size[0] / 2) / size[0]
    else:
        rng = np.random.default_rng(seed)
        z = np.zeros_like(xx)
        # Sum of plane waves with amplitude falling as 1 / wave number: a landscape without ridges or steps.
        for octave in range(1, 6):
            for _ in range(4):
                angle, phase = rng.uniform(0, 2 * np.pi, 2)
                k = 2 * np.pi * octave / longer
                z += np.sin(k * (xx * np.cos(angle) + yy * np.sin(angle)) + phase) / octave
        z = (z - z.min()) / np.ptp(z) * relief
        distance = np.hypot(xx, yy)
        fade = np.clip((distance - plain) / max(plain, 0.2 * longer), 0, 1)
        z = z * fade * fade * (3 - 2 * fade)
    return [[round(float(v), 6) for v in row] for row in z]
