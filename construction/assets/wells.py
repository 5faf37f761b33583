"""Wells."""

from __future__ import annotations

import math

import numpy as np
from pydantic import Field

from .generator import Generator, Parameters, material
from .made import MAIN, Body, Joint, Made
from .profiles import circle
from .wheels import pierced

__all__ = ["GENERATORS"]


class WellParameters(Parameters):
    """A well: ring wall, posts with a roof, a windlass that turns and a bucket on the rim."""

    diameter: float = Field(default=1.3, ge=0.9, le=2.0, description="of the wall outside [m]")
    wall: float = Field(default=0.75, ge=0.4, le=1.0, description="height of the wall with its coping [m]")
    courses: int = Field(default=3, ge=2, le=5, description="of stones under the coping")
    roof: bool = Field(default=True, description="a gable roof of boards over the posts")
    wood: str = material("oak", "pine", "larch", of="posts, roof and windlass")
    metal: str = material("cast_iron", "mild_steel", of="axle and crank")
    material: str = material("limestone", "sandstone", "granite", "brick_masonry")


def _well(p: WellParameters, rng: np.random.Generator) -> Made:
    made = Made.of(Body("well", p.material))
    body, outer, thick, coping = made.main, p.diameter / 2, 0.2, 0.09
    n, top = 12, p.wall
    high = (top - coping) / p.courses
    for k in range(p.courses + 1):
        lid = k == p.courses
        z0, z1 = (top - coping, top) if lid else (k * high, (k + 1) * high)
        shift = 0.5 * (k % 2)
        for j in range(n):
            angles = [2 * math.pi * (j + shift + d) / n for d in (0, 1)]
            proud = 0.05 if lid else float(rng.uniform(0, 0.012))
            r0, r1, c = outer - thick, outer + proud, 0.01
            rings = ((r0, r1 - c, z0), (r0, r1, z0 + c), (r0, r1, z1 - c), (r0, r1 - c, z1))
            body.hull(
                f"stone_{k + 1}_{j + 1}",
                [(r * math.cos(a), r * math.sin(a), z) for a0, a1, z in rings for r in (a0, a1) for a in angles],
            )
    x, side, axle = (outer - 0.5 * thick) * math.cos(math.pi / n), 0.11, top + 0.75
    post = axle + 0.35
    for sign, name in ((-1, "left"), (1, "right")):
        a, b = sorted((sign * (x - side / 2), sign * (x + side / 2)))
        pierced(body, f"post_{name}", (a, -side / 2, top), (b, side / 2, post), (0, axle), 0.026, material=p.wood)
    if p.roof:
        _well_roof(body, x + side / 2, post, p)
    _windlass(made, x - side / 2, x + side / 2, axle, p)
    pail = made.bodies["bucket"] = Body("bucket", p.wood)
    _bucket(pail, (0, -(outer - 0.5 * thick) * math.cos(math.pi / n), top + 1.1e-3), 0.5 * thick)
    made.carries.append((MAIN, "bucket"))
    return made


def _well_roof(body: Body, reach: float, post: float, p: WellParameters) -> None:
    """A beam over the posts, gables and lapped boards."""
    wide, out, slope = 0.62 * p.diameter, reach + 0.15, 0.85
    body.box("tie", (-reach, -0.055, post), (reach, 0.055, post + 0.09), material=p.wood)
    low = post + 0.09
    ridge = low + wide * slope
    for sign, side in ((-1, "left"), (1, "right")):
        a, b = sorted((sign * reach, sign * (reach - 0.05)))
        body.hull(
            f"gable_{side}", [(x, y, z) for x in (a, b) for y, z in ((-wide, low), (wide, low), (0, ridge))], material=p.wood
        )
    rows = 6
    for s, side in ((-1, "front"), (1, "back")):
        for k in range(rows):
            a, b = wide * 1.12 * (1 - k / rows), wide * 1.12 * (1 - (k + 1) / rows)
            za, zb = ridge - a * slope, ridge - b * slope
            outline = ((a, za), (b, zb), (a, za + 0.045), (b, zb + 0.02))
            body.hull(f"roof_{side}_{k + 1}", [(x, s * y, z) for x in (-out, out) for y, z in outline], material=p.wood)


def _windlass(made: Made, inner: float, outer: float, z: float, p: WellParameters) -> None:
    """Drum with rope, axle in the posts, with a bearing on the left and a crank on the right."""
    body = made.bodies["windlass"] = Body("windlass", p.wood)
    end, r = inner - 0.02, 0.085
    body.turned("drum", [(0, -end), (r, -end), (r, end), (0, end)], (0, 0, z), segments=16, euler=(math.pi / 2, 0, math.pi / 2))
    for k, x in enumerate((-end, end - 0.03)):
        body.turned(
            f"flange_{k + 1}",
            [(r, x), (r + 0.04, x), (r + 0.04, x + 0.03), (r, x + 0.03)],
            (0, 0, z),
            segments=16,
            euler=(math.pi / 2, 0, math.pi / 2),
        )
    ax = 0.022
    body.cylinder("axle_left", (-outer + 0.003, 0, z), (-end, 0, z), ax, material=p.metal)
    made.main.box("bearing", (-outer - 0.04, -0.05, z - 0.05), (-outer, 0.05, z + 0.05), material=p.metal)
    body.cylinder("axle_right", (end, 0, z), (outer + 0.05, 0, z), ax, material=p.metal)
    path = [
        (outer + 0.05, 0, z),
        (outer + 0.075, 0, z),
        (outer + 0.085, 0, z - 0.015),
        (outer + 0.085, 0, z - 0.24),
        (outer + 0.095, 0, z - 0.255),
        (outer + 0.25, 0, z - 0.255),
    ]
    body.sweep("crank", path, circle(0.014, 8), material=p.metal)
    made.joints["windlass"] = Joint("windlass", "hinge", (0, 0, z), axis=(1, 0, 0), damping=0.2, friction=1.0)


def _bucket(body: Body, foot: tuple[float, float, float], radius: float) -> None:
    """A pail of staves with two hoops."""
    r, t, tall = radius, 0.008, 2.2 * radius
    body.turned("pail", [(0, 0), (0.8 * r, 0), (r, tall), (r - t, tall), (0.8 * r - t, 0.015), (0, 0.015)], foot, segments=16)
    for k, z in enumerate((0.15, 0.75)):
        a, b = (0.8 + 0.2 * z) * r, (0.8 + 0.2 * (z + 0.08)) * r
        body.turned(
            f"hoop_{k + 1}",
            [(a, z * tall), (a + 0.002, z * tall), (b + 0.002, (z + 0.08) * tall), (b, (z + 0.08) * tall)],
            foot,
            segments=16,
            material="mild_steel",
        )


GENERATORS = (
    Generator("well", "stone well with a roof, a windlass that turns on a hinge and a bucket", WellParameters, _well,
              ("village", "garden", "water", "bucket", "crank"), motion="static"),
)  # fmt: skip
