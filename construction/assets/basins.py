"""Troughs and tanks."""

from __future__ import annotations

import numpy as np
from pydantic import Field

from .generator import Generator, Parameters, material
from .made import Body, Made, Place
from .profiles import mitred

__all__ = ["GENERATORS"]


class TroughParameters(Parameters):
    """A trough of leaning walls on two bearers, hollow."""

    length: float = Field(default=1.4, ge=0.5, le=3.0, description="at the rim along x [m]")
    width: float = Field(default=0.5, ge=0.3, le=0.9, description="at the rim along y [m]")
    height: float = Field(default=0.45, ge=0.25, le=0.8, description="over all [m]")
    wall: float = Field(default=0.05, ge=0.02, le=0.1, description="thickness, measured level [m]")
    lean: float = Field(default=0.12, ge=0.0, le=0.3, description="by how much the foot is narrower, over the height")
    material: str = material("limestone", "granite", "oak", "larch", "concrete_c30")


def _trough(p: TroughParameters, rng: np.random.Generator) -> Made:
    body = Body("trough", p.material)
    made = Made.of(body)
    x, y, bearer = p.length / 2, p.width / 2, 0.14 * p.height
    wall = min(p.wall, 0.16 * p.width)
    draw = min(p.lean * p.height, 0.25 * p.width - wall, 0.2 * p.length)
    floor = bearer + wall
    low = (-x + draw, -y + draw, x - draw, y - draw)
    body.box("floor", (low[0], low[1], bearer), (low[2], low[3], floor))
    rim = min(0.03, 0.1 * p.height)
    top = (-x, -y, x, y)
    for side, points in mitred(low, top, (floor, p.height - rim), wall).items():
        body.hull(f"wall_{side}", points)
    lip = (-x - 0.015, -y - 0.015, x + 0.015, y + 0.015)
    for side, points in mitred(lip, lip, (p.height - rim, p.height), wall + 0.015).items():
        body.hull(f"rim_{side}", points)
    for s, side in ((-1, "left"), (1, "right")):
        a, b = sorted((s * 0.55 * (x - draw), s * 0.8 * (x - draw)))
        body.hull(
            f"bearer_{side}",
            [(u, v * g, h) for u in (a, b) for v in (-1, 1) for g, h in ((0.9 * y, 0.0), (0.8 * (y - draw), bearer))],
        )
    made.places["inside"] = Place((0, 0, floor), (2 * (x - draw - wall), 2 * (y - draw - wall)), p.height - floor)
    return made


class TankParameters(Parameters):
    """An open tank of glass panes in a frame: an aquarium."""

    length: float = Field(default=0.8, ge=0.2, le=3.0, description="along x [m]")
    width: float = Field(default=0.4, ge=0.15, le=1.5, description="along y [m]")
    height: float = Field(default=0.45, ge=0.15, le=1.5, description="[m]")
    pane: float = Field(
        default=0.008, ge=0.004, le=0.025, description="thickness of the panes, more where the water asks for it [m]"
    )
    corners: bool = Field(default=True, description="angle irons at the upright edges")
    frame: str = material("aluminium_alloy", "abs", "stainless_steel", "brass", of="frame")
    material: str = material("soda_lime_glass", "acrylic", "borosilicate_glass")


def _tank(p: TankParameters, rng: np.random.Generator) -> Made:
    body = Body("tank", p.material)
    made = Made.of(body)
    x, y = p.length / 2, p.width / 2
    t = min(max(p.pane, 0.012 * p.height), 0.1 * p.width)
    rim, out = min(0.035, 0.1 * p.height), 0.006
    foot = 0.006
    body.box("foot", (-x - out, -y - out, 0), (x + out, y + out, foot), material=p.frame)
    floor = foot + t
    body.box("floor", (-x, -y, foot), (x, y, floor))
    box = (-x, -y, x, y)
    for side, points in mitred(box, box, (floor, p.height - out), t).items():
        body.hull(f"pane_{side}", points)
    skirt = (-x - out, -y - out, x + out, y + out)
    for name, levels in (("base", (foot, foot + rim)), ("rim", (p.height - rim, p.height - out))):
        for side, points in mitred(skirt, skirt, levels, out).items():
            body.hull(f"{name}_{side}", points, material=p.frame)
    for side, points in mitred(skirt, skirt, (p.height - out, p.height), out + 1.6 * t).items():
        body.hull(f"cap_{side}", points, material=p.frame)
    if p.corners:
        a, b, w = foot + rim, p.height - rim, min(0.02, 0.15 * p.width)
        for s, left in ((-1, "left"), (1, "right")):
            for q, end in ((-1, "front"), (1, "back")):
                c, d = sorted((s * (x + out), s * x))
                e, f = sorted((q * (y + out), q * (y - w)))
                body.box(f"angle_{left}_{end}_a", (c, e, a), (d, f, b), material=p.frame)
                c, d = sorted((s * x, s * (x - w)))
                e, f = sorted((q * (y + out), q * y))
                body.box(f"angle_{left}_{end}_b", (c, e, a), (d, f, b), material=p.frame)
    made.places["inside"] = Place((0, 0, floor), (2 * (x - 2 * t), 2 * (y - 2 * t)), p.height - floor)
    return made


GENERATORS = (
    Generator("trough", "hollow trough of stone or wood on bearers", TroughParameters, _trough, ("water", "animal", "farm", "planter", "basin", "fountain")),
    Generator("tank", "open glass tank in a frame, an aquarium", TankParameters, _tank, ("aquarium", "glass", "water", "fish", "flume", "basin")),
)  # fmt: skip
