"""Fences, gates and pergolas."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
from pydantic import Field

from .generator import Generator, Parameters, material
from .made import Body, Joint, Made
from .profiles import circle

__all__ = ["GENERATORS"]


def _picket(body: Body, name: str, x: tuple[float, float], y: tuple[float, float], z: tuple[float, float], head: str) -> None:
    """An upright board with a pointed, round or level head."""
    a, b = x
    w, (low, high) = b - a, z
    if head == "level":
        body.box(name, (a, y[0], low), (b, y[1], high))
        return
    shoulder = high - (0.7 * w if head == "pointed" else 0.5 * w)
    if head == "pointed":
        outline = [(a, low), (b, low), (b, shoulder), ((a + b) / 2, high), (a, shoulder)]
    else:
        arc = [((a + b) / 2 + w / 2 * math.cos(t), shoulder + w / 2 * math.sin(t)) for t in np.linspace(0, math.pi, 7)]
        outline = [(a, low), (b, low), *arc]
    body.hull(name, [(u, v, h) for u, h in outline for v in y])


def _post(body: Body, name: str, at: tuple[float, float], side: float, height: float, *, cap: bool = True) -> None:
    """A post with a pyramid on its head."""
    x, y, h = *at, side / 2
    body.box(name, (x - h, y - h, 0), (x + h, y + h, height))
    if cap:
        rim = [(x + a * 1.2 * h, y + b * 1.2 * h, z) for a in (-1, 1) for b in (-1, 1) for z in (height, height + 0.02)]
        body.hull(f"{name}_cap", [*rim, (x, y, height + 0.02 + 0.8 * h)])


class FenceParameters(Parameters):
    """A straight fence along x: posts, rails and what is nailed to their front."""

    length: float = Field(default=3.0, ge=1.0, le=10.0, description="along x [m]")
    height: float = Field(default=1.0, ge=0.6, le=2.0, description="of pickets or boards [m]")
    style: Literal["picket", "rails", "boards"] = Field(
        default="picket", description="pickets with gaps, rails only, or closed boards"
    )
    head: Literal["pointed", "round", "level"] = Field(default="pointed", description="of pickets")
    bay: float = Field(default=1.8, ge=1.0, le=2.5, description="distance between posts at most [m]")
    post: float = Field(default=0.1, ge=0.07, le=0.16, description="side of a post [m]")
    uneven: float = Field(default=0.01, ge=0.0, le=0.05, description="by how much heights differ [m]")
    material: str = material("larch", "pine", "oak", "spruce", "cedar")


def _fence(p: FenceParameters, rng: np.random.Generator) -> Made:
    body = Body("fence", p.material)
    bays = max(1, math.ceil((p.length - p.post) / p.bay - 1e-9))
    pitch, half = (p.length - p.post) / bays, p.post / 2
    rails = (
        [0.18 * p.height, 0.5 * p.height, 0.85 * p.height]
        if p.style == "rails" or p.height > 1.4
        else [0.22 * p.height, 0.78 * p.height]
    )
    top = p.height + 0.06 if p.style != "rails" else p.height
    posts = [-p.length / 2 + half + k * pitch for k in range(bays + 1)]
    for k, x in enumerate(posts):
        _post(body, f"post_{k + 1}", (x, 0), p.post, top)
        if k == bays:
            break
        for j, z in enumerate(rails, start=1):
            deep = 0.02 if p.style != "rails" else 0.025
            tilt = float(rng.uniform(-1, 1)) * p.uneven if p.style == "rails" else 0.0
            a, b = x + half, x + pitch - half
            body.hull(
                f"rail_{k + 1}_{j}",
                [(u, s * deep, z + d + v) for u, d in ((a, tilt), (b, -tilt)) for s in (-1, 1) for v in (-0.045, 0.045)],
            )
    if p.style == "rails":
        return Made.of(body)
    budget = 120 - len(body.parts)
    wide, gap = (0.075, 0.05) if p.style == "picket" else (0.14, 0.0)
    clear = pitch - p.post
    number = max(2, min(round(clear / (wide + gap)), budget // bays))
    step = clear / number
    board = step - (gap * step / (wide + gap))
    for k in range(bays):
        for j in range(number):
            middle = posts[k] + half + step * (j + 0.5)
            high = p.height + float(rng.uniform(-1, 0)) * p.uneven
            front = -0.04 - 0.002 * (j % 2 if p.style == "boards" else 0)
            _picket(
                body,
                f"picket_{k + 1}_{j + 1}",
                (middle - board / 2, middle + board / 2),
                (front, -0.02),
                (0.05, high),
                p.head if p.style == "picket" else "level",
            )
    return Made.of(body)


class GardenGateParameters(Parameters):
    """Two posts on a sill with a leaf of pickets that swings towards the front (-y)."""

    width: float = Field(default=1.0, ge=0.7, le=1.6, description="of the leaf [m]")
    height: float = Field(default=1.05, ge=0.7, le=1.7, description="of the leaf at its sides [m]")
    crown: Literal["arched", "dipped", "level"] = Field(default="arched", description="line of its heads")
    head: Literal["pointed", "round", "level"] = Field(default="round", description="of pickets")
    post: float = Field(default=0.13, ge=0.09, le=0.3, description="side of a post [m]")
    open_deg: float = Field(default=95.0, ge=60.0, le=110.0, description="how far it opens [degrees]")
    sill: str = material("limestone", "granite", "concrete_c30", of="sill")
    metal: str = material("cast_iron", "mild_steel", of="hinges and latch")
    material: str = material("oak", "larch", "pine", "cedar")


def _garden_gate(p: GardenGateParameters, rng: np.random.Generator) -> Made:
    made = Made.of(Body("gate posts", p.material, "static"))
    body, half, base = made.main, p.post / 2, 0.06
    gap = 0.02
    x = p.width / 2 + gap + half
    body.box("sill", (-x - half, -0.16, 0), (x + half, 0.16, base), material=p.sill)
    for sign, name in ((-1, "left"), (1, "right")):
        a = sign * x
        body.box(f"post_{name}", (a - half, -half, base), (a + half, half, p.height + 0.2))
        rim = [
            (a + s * 1.15 * half, t * 1.15 * half, z)
            for s in (-1, 1)
            for t in (-1, 1)
            for z in (p.height + 0.2, p.height + 0.225)
        ]
        body.hull(f"cap_{name}", [*rim, (a, 0, p.height + 0.225 + 0.7 * half)])
    _gate_leaf(made, p, base, gap)
    return made


def _gate_leaf(made: Made, p: GardenGateParameters, base: float, gap: float) -> None:
    """Pickets before rails with a brace, straps with knuckles, a latch with a ring."""
    half, thick, back = p.post / 2, 0.045, 0.02
    leaf = made.bodies["leaf"] = Body("gate", p.material)
    low, w = base + 0.05, p.width / 2
    rails = (low + 0.1, low + 0.1 + 0.6 * (p.height - low))
    for j, z in enumerate(rails, start=1):
        leaf.box(f"rail_{j}", (-w, -half, z), (w, -half + thick, z + 0.09))
    a, b = rails[0] + 0.09, rails[1]
    leaf.hull(
        "brace",
        [(u, v, z) for u, z in ((-w + 0.04, a), (-w + 0.13, a), (w - 0.04, b), (w - 0.13, b)) for v in (-half, -half + thick)],
    )
    number = max(4, round(p.width / 0.13))
    step = p.width / number
    for k in range(number):
        middle = -w + step * (k + 0.5)
        share = 1 - (middle / w) ** 2
        high = p.height + {"arched": 0.14, "dipped": -0.16, "level": 0.0}[p.crown] * share
        _picket(
            leaf,
            f"picket_{k + 1}",
            (middle - 0.38 * step, middle + 0.38 * step),
            (-half - back, -half),
            (low, max(high, rails[1] + 0.14)),
            p.head,
        )
    face = -half - back
    y, axis = face - 0.0025, -w - gap / 2
    for j, z in enumerate(rails, start=1):
        leaf.cylinder(f"knuckle_{j}", (axis, y, z), (axis, y, z + 0.09), 0.0065, material=p.metal)
        a, b, c = axis + 0.0065, 0.15 * w, z + 0.045
        strap = [(a, c - 0.02), (a, c + 0.02), (b - 0.05, c + 0.013), (b - 0.05, c - 0.013), (b, c)]
        leaf.hull(f"strap_{j}", [(u, v, h) for u, h in strap for v in (face - 0.005, face)], material=p.metal)
        made.main.box(
            f"pintle_{j}", (-w - gap - 0.02, y - 0.0065, z + 0.091), (axis + 0.0065, -half, z + 0.103), material=p.metal
        )
    z = rails[1] + 0.045
    leaf.cylinder("latch", (w - 0.1, -half + thick, z), (w - 0.1, -half + thick + 0.03, z), 0.018, material=p.metal)
    tube = circle(0.007, 8)
    ring = [
        (w - 0.1 + 0.045 * math.cos(t), -half + thick + 0.03 + max(v for _, v in tube), z - 0.03 + 0.045 * math.sin(t))
        for t in np.linspace(0, 2 * math.pi, 13)[:-1]
    ]
    leaf.sweep("ring", ring, tube, closed=True, material=p.metal)
    made.joints["leaf"] = Joint(
        "leaf",
        "hinge",
        (axis, y, p.height / 2),
        axis=(0, 0, -1),
        range=(0.0, math.radians(p.open_deg)),
        damping=0.5,
        friction=0.6,
    )


class PergolaParameters(Parameters):
    """Posts with beams, rafters with shaped ends and knee braces."""

    length: float = Field(default=3.4, ge=2.0, le=7.0, description="along x [m]")
    depth: float = Field(default=2.4, ge=1.5, le=4.0, description="along y [m]")
    height: float = Field(default=2.4, ge=2.1, le=3.2, description="over all [m]")
    rafters: int = Field(default=9, ge=4, le=16, description="across the beams")
    laths: bool = Field(default=True, description="laths over the rafters")
    post: float = Field(default=0.12, ge=0.09, le=0.2, description="side of a post [m]")
    material: str = material("larch", "oak", "cedar", "pine")


def _pergola(p: PergolaParameters, rng: np.random.Generator) -> Made:
    body = Body("pergola", p.material)
    half, beam, rafter, lath = p.post / 2, 0.16, 0.14, 0.03
    under = p.height - (lath if p.laths else 0.0) - rafter - beam
    bays = max(1, math.ceil(p.length / 3.4))
    out = 0.3
    xs = [-p.length / 2 + out + (p.length - 2 * out) * k / bays for k in range(bays + 1)]
    y = p.depth / 2 - 0.25
    for s, side in ((-1, "front"), (1, "back")):
        for k, x in enumerate(xs, start=1):
            body.hull(
                f"foot_{side}_{k}",
                [
                    (x + a * 1.4 * half * g, s * y + b * 1.4 * half * g, z)
                    for a in (-1, 1)
                    for b in (-1, 1)
                    for g, z in ((1.15, 0.0), (1.0, 0.08))
                ],
                material="concrete_c30",
            )
            body.box(f"post_{side}_{k}", (x - half, s * y - half, 0.08), (x + half, s * y + half, under))
            for t in (-1, 1):
                if (k == 1 and t < 0) or (k == len(xs) and t > 0):
                    continue
                ends = [
                    (x + t * half, under - 0.45),
                    (x + t * half, under - 0.36),
                    (x + t * (half + 0.45), under),
                    (x + t * (half + 0.36), under),
                ]
                body.hull(
                    f"brace_{side}_{k}_{'left' if t < 0 else 'right'}",
                    [(a, s * y + w, z) for a, z in ends for w in (-0.03, 0.03)],
                )
        tip = [(-p.length / 2, under + beam), (-p.length / 2, under + 0.6 * beam), (-p.length / 2 + 0.12, under)]
        outline = [*tip, *((-a, z) for a, z in tip)]
        body.hull(f"beam_{side}", [(a, s * y + w, z) for a, z in outline for w in (-0.8 * half, 0.8 * half)])
    for k in range(p.rafters):
        x = -p.length / 2 + 0.12 + (p.length - 0.24) * k / (p.rafters - 1)
        z = under + beam
        tip = [(-p.depth / 2, z + rafter), (-p.depth / 2, z + 0.65 * rafter), (-p.depth / 2 + 0.1, z)]
        body.hull(f"rafter_{k + 1}", [(x + w, s * a, h) for a, h in tip for s in (-1, 1) for w in (-0.025, 0.025)])
    if p.laths:
        count = max(3, round(p.depth / 0.25))
        for k in range(count):
            v = -p.depth / 2 + 0.15 + (p.depth - 0.3) * k / (count - 1)
            body.box(f"lath_{k + 1}", (-p.length / 2, v - 0.02, p.height - lath), (p.length / 2, v + 0.02, p.height))
    return Made.of(body)


GENERATORS = (
    Generator("fence", "fence with posts, rails and pickets or boards", FenceParameters, _fence,
              ("picket", "garden", "farm", "paling", "paddock", "yard"), motion="static"),
    Generator("garden_gate", "garden gate: two posts and a leaf of pickets on a hinge", GardenGateParameters, _garden_gate,
              ("fence", "entrance", "picket", "farm", "yard"), motion="static"),
    Generator("pergola", "pergola of posts, beams with braces, rafters and laths", PergolaParameters, _pergola,
              ("garden", "terrace", "arbour", "trellis", "patio"), motion="static"),
)  # fmt: skip
