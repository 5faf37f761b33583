"""Things of streets and gardens: lamps, benches, signposts, cones, bollards."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
from pydantic import Field

from .generator import Generator, Parameters, material
from .made import Body, Made, Place
from .profiles import mitred
from .railings import spindle
from .turning import TRIM, drawn

__all__ = ["GENERATORS"]


class LampPostParameters(Parameters):
    """A street lamp: turned foot and shaft, a cross bar, a lantern with panes."""

    height: float = Field(default=3.4, ge=2.0, le=6.0, description="over all [m]")
    lantern: float = Field(default=0.42, ge=0.25, le=0.7, description="height of the lantern's panes [m]")
    panes: int = Field(default=6, ge=4, le=8, description="panes of the lantern")
    bar: bool = Field(default=True, description="a ladder bar with balls under the lantern")
    glass: str = material("soda_lime_glass", "acrylic", of="panes")
    bulb: str = material("porcelain", "soda_lime_glass", of="burner")
    material: str = material("cast_iron", "bronze", "mild_steel")


def _lamp_post(p: LampPostParameters, rng: np.random.Generator) -> Made:
    body = Body("street lamp", p.material)
    g = min(p.lantern, 0.16 * p.height)
    top = p.height - 1.75 * g
    r = 0.016 * p.height + 0.018
    foot = 0.22 * p.height
    body.turned("plinth", [(0, 0), (3.2 * r, 0), (3.2 * r, 0.05), (2.9 * r, 0.07), (0, 0.07)], segments=8)
    outline = [
        (2.4 * r, 0.07), (2.4 * r, 0.11), (1.7 * r, 0.16), (1.6 * r, 0.7 * foot), (2.0 * r, 0.75 * foot), (2.0 * r, 0.8 * foot),
        (1.25 * r, 0.9 * foot), (1.2 * r, foot), (1.6 * r, foot + 0.02), (1.6 * r, foot + 0.05), (1.05 * r, foot + 0.09),
        (0.75 * r, top - 0.16), (1.2 * r, top - 0.13), (1.2 * r, top - 0.11), (0.75 * r, top - 0.09), (1.5 * r, top),
    ]  # fmt: skip
    spindle(body, "shaft", outline, (0, 0, 0), segments=24)
    if p.bar:
        z = top - 0.12
        for s, side in ((-1, "left"), (1, "right")):
            start, end = s * 1.2 * r, s * (1.2 * r + 0.22)
            body.cylinder(f"bar_{side}", (start, 0, z), (end, 0, z), 0.009)
            body.sphere(f"ball_{side}", (end + s * 0.022, 0, z), 0.022)
    _lantern(body, p, top, g)
    return Made.of(body)


def _lantern(body: Body, p: LampPostParameters, z: float, g: float) -> None:
    """A tray, panes between bars that widen upwards, a roof with a vent and a finial."""
    n, low, wide = p.panes, 0.28 * g, 0.5 * g
    tray, rim = 0.05 * g, 0.06 * g

    def ring(radius: float, height: float) -> list[tuple[float, float, float]]:
        return [
            (
                radius * math.cos(2 * math.pi * (k + 0.5) / n - math.pi / 2),
                radius * math.sin(2 * math.pi * (k + 0.5) / n - math.pi / 2),
                height,
            )
            for k in range(n)
        ]

    body.hull("tray", [*ring(0.8 * low, z), *ring(1.1 * low, z + tray)])
    foot, head = z + tray, z + tray + g
    inside = 0.93
    bottom, top = ring(low, foot), ring(wide, head)
    b_in, t_in = ring(low * inside, foot), ring(wide * inside, head)
    for k in range(n):
        j = (k + 1) % n
        share = 0.1

        def mix(a: tuple[float, float, float], b: tuple[float, float, float], t: float) -> tuple[float, float, float]:
            return (a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), a[2])

        rings = (bottom, b_in, top, t_in)
        body.hull(f"pane_{k + 1}", [mix(line[k], line[j], t) for line in rings for t in (share, 1 - share)], material=p.glass)
        for side, other in (("a", j), ("b", k - 1)):
            body.hull(f"glazing_bar_{k + 1}{side}", [q for line in rings for q in (line[k], mix(line[k], line[other], share))])
    body.hull("frame", [*ring(1.12 * wide, head), *ring(1.12 * wide, head + rim)])
    roof = head + rim
    body.hull("roof", [*ring(1.2 * wide, roof), *ring(1.2 * wide, roof + 0.02 * g), *ring(0.4 * wide, roof + 0.32 * g)])
    _vent(body, wide, roof + 0.32 * g, g)
    _burner(body, p, low, foot, g)


def _vent(body: Body, wide: float, vent: float, g: float) -> None:
    """The vent of a lantern's roof with its finial."""
    spindle(
        body,
        "vent",
        [
            (0.3 * wide, vent),
            (0.3 * wide, vent + 0.08 * g),
            (0.42 * wide, vent + 0.09 * g),
            (0.1 * wide, vent + 0.2 * g),
            (0.06 * wide, vent + 0.22 * g),
            (0.12 * wide, vent + 0.27 * g),
            (0.01 * g, vent + 0.32 * g),
        ],
        (0, 0, 0),
        segments=16,
    )


def _burner(body: Body, p: LampPostParameters, low: float, foot: float, g: float) -> None:
    """The burner of a lantern, which shines."""
    spindle(
        body,
        "burner",
        [
            (0.2 * low, foot),
            (0.12 * low, foot + 0.1 * g),
            (0.12 * low, foot + 0.25 * g),
            (0.35 * low, foot + 0.4 * g),
            (0.35 * low, foot + 0.55 * g),
            (0.05 * low, foot + 0.7 * g),
        ],
        (0, 0, 0),
        segments=16,
        material=p.bulb,
    )


class ParkBenchParameters(Parameters):
    """A bench of slats on cast ends with arms."""

    width: float = Field(default=1.5, ge=1.0, le=2.4, description="along x [m]")
    seat: float = Field(default=0.43, ge=0.38, le=0.48, description="height of the seat [m]")
    depth: float = Field(default=0.44, ge=0.36, le=0.52, description="of the seat [m]")
    height: float = Field(default=0.85, ge=0.75, le=1.0, description="over all [m]")
    slats: int = Field(default=5, ge=3, le=7, description="of the seat; the back has one less")
    arms: bool = Field(default=True, description="arm rests")
    metal: str = material("cast_iron", "mild_steel", of="ends")
    material: str = material("oak", "teak", "larch", "ash")


def _park_bench(p: ParkBenchParameters, rng: np.random.Generator) -> Made:
    body = Body("park bench", p.metal)
    thick, half, y = 0.03, p.width / 2, p.depth / 2
    under, lean = p.seat - thick, math.tan(math.radians(14))
    ends = [(-half + 0.06, "left"), (half - 0.06, "right")] + ([(0.0, "middle")] if p.width > 1.7 else [])
    rise = p.height - p.seat
    slope = (rise * lean + 0.015) / (p.height - under)
    for x, side in ends:
        _bench_end(body, p, x, side, slope)
    wide = (p.depth - 0.06 - 0.012 * (p.slats - 1)) / p.slats
    for k in range(p.slats):
        v = -y + k * (wide + 0.012)
        body.box(
            f"slat_{k + 1}",
            (-half + 0.04, v, under),
            (half - 0.04, v + wide, p.seat),
            material=p.material,
        )
    count = max(2, p.slats - 1)
    begin = 0.1 * rise + 0.03
    tall = (rise - begin - 0.015 * (count - 1) + thick) / count
    for k in range(count):
        z = under + begin + k * (tall + 0.015)
        face = [(y - 0.045 + slope * (h - under) - t, h) for h in (z, z + tall) for t in (0.0, 0.024)]
        body.hull(f"back_{k + 1}", [(u, w, h) for u in (-half + 0.04, half - 0.04) for w, h in face], material=p.material)
    made = Made.of(body)
    first = -y + (p.slats // 2) * (wide + 0.012) + wide / 2
    made.places["seat"] = Place((0, first, p.seat), (p.width - 0.35, 0.7 * p.depth), rise)
    return made


def _bench_end(body: Body, p: ParkBenchParameters, x: float, side: str, slope: float) -> None:
    """Legs, a rail, a stay of the back that leans by `slope`, and an arm beside them."""
    y, half, under = p.depth / 2, p.width / 2, p.seat - 0.03
    rise = p.height - p.seat
    lean = math.tan(math.radians(14))
    a, b = x - 0.02, x + 0.02
    body.box(f"rail_{side}", (a, -y, under - 0.045), (b, y, under))
    for s, v, name in ((-1, -y, "front"), (1, y, "back")):
        body.hull(
            f"leg_{side}_{name}",
            [
                (u, w, h)
                for u in (a, b)
                for w, h in ((v, under - 0.045), (v - s * 0.05, under - 0.045), (v + s * 0.03, 0.02), (v - s * 0.012, 0.02))
            ],
        )
        body.hull(
            f"foot_{side}_{name}",
            [
                (x + g * 0.032, w, h)
                for g in (-1, 1)
                for w, h in ((v - s * 0.035, 0.0), (v + s * 0.05, 0.0), (v - s * 0.03, 0.02), (v + s * 0.045, 0.02))
            ],
        )
    back = [(y - 0.045, under), (y, under), (y + rise * lean, p.height), (y + rise * lean - 0.03, p.height)]
    body.hull(f"stay_{side}", [(u, w, h) for u in (a, b) for w, h in back])
    if p.arms and side != "middle":
        z, out = p.seat + 0.2, sorted((math.copysign(half - 0.04, x), math.copysign(half - 0.005, x)))
        body.hull(
            f"arm_post_{side}",
            [
                (u, w, h)
                for u in out
                for w, h in ((-y, under - 0.04), (-y + 0.045, under - 0.04), (-y + 0.03, z), (-y - 0.005, z))
            ],
        )
        rest = y - 0.045 + slope * (z - under)
        body.hull(
            f"arm_{side}",
            [
                (u, w, h)
                for u in out
                for w, h in (
                    (-y - 0.035, z),
                    (-y - 0.035, z + 0.015),
                    (-y - 0.02, z + 0.024),
                    (rest + 0.03, z),
                    (rest + 0.03, z + 0.024),
                )
            ],
        )


class SignpostParameters(Parameters):
    """A post with arrow boards to both sides."""

    height: float = Field(default=2.3, ge=1.2, le=3.5, description="of the post [m]")
    boards: int = Field(default=3, ge=1, le=5, description="boards")
    board: float = Field(default=0.75, ge=0.4, le=1.2, description="length of a board at most [m]")
    post: float = Field(default=0.1, ge=0.07, le=0.16, description="side of the post [m]")
    foot: str = material("granite", "limestone", "concrete_c30", of="foot")
    material: str = material("oak", "larch", "pine")


def _signpost(p: SignpostParameters, rng: np.random.Generator) -> Made:
    body = Body("signpost", p.material)
    h, base = p.post / 2, 0.2
    body.hull(
        "foot",
        [(s * g, t * g, z) for s in (-1, 1) for t in (-1, 1) for g, z in ((0.34, 0.0), (0.34, 0.12), (0.24, base))],
        material=p.foot,
    )
    body.box("post", (-h, -h, base), (h, h, p.height))
    body.hull(
        "cap",
        [
            (s * g * h, t * g * h, z)
            for s in (-1, 1)
            for t in (-1, 1)
            for g, z in ((1.35, p.height), (1.35, p.height + 0.02), (0.15, p.height + 0.09))
        ],
    )
    for k in range(p.boards):
        z = p.height - 0.16 - k * min(0.24, 0.8 * (p.height - base) / p.boards)
        way = 1 if (k + int(rng.integers(2))) % 2 else -1
        long, tall = p.board * float(rng.uniform(0.75, 1.0)), min(0.15, 0.6 * (p.height - base) / p.boards)
        tilt, begin = float(rng.uniform(-0.05, 0.05)), -0.18
        outline = [
            (begin, -tall / 2),
            (begin, tall / 2),
            (begin + long - 0.6 * tall, tall / 2),
            (begin + long, 0.0),
            (begin + long - 0.6 * tall, -tall / 2),
        ]
        c, s = math.cos(tilt), math.sin(tilt)
        body.hull(f"board_{k + 1}", [(way * (c * u - s * v), y, z + s * u + c * v) for u, v in outline for y in (-h - 0.024, -h)])
        for x, name in ((-0.6 * h, "a"), (0.6 * h, "b")):
            body.cylinder(
                f"nail_{k + 1}{name}",
                (x, -h - 0.024, z + s * x * way),
                (x, -h - 0.03, z + s * x * way),
                0.008,
                material="mild_steel",
            )
    return Made.of(body)


class ConeParameters(Parameters):
    """A hollow traffic cone on a square foot, with a band."""

    height: float = Field(default=0.5, ge=0.2, le=1.0, description="[m]")
    slender: float = Field(default=0.38, ge=0.3, le=0.5, description="diameter at the foot over the height")
    wall: float = Field(default=0.004, ge=0.003, le=0.008, description="thickness [m]")
    bands: int = Field(default=1, ge=0, le=2, description="bands")
    band: str = material("polyester", "pvc", of="bands")
    material: str = material("natural_rubber", "pvc", "polyethylene")


def _cone(p: ConeParameters, rng: np.random.Generator) -> Made:
    body = Body("traffic cone", p.material)
    r, foot, top = p.slender * p.height / 2, 0.05 * p.height, 0.13 * p.slender * p.height
    half, n, t = 1.25 * r, 24, p.wall
    # A frame about the hole: four pieces, mitred.
    hole = 0.68 * (r - p.wall)
    lip = (-half, -half, half, half)
    for side, points in mitred(lip, lip, (0.0, foot), half - hole).items():
        body.hull(f"foot_{side}", points)

    def radius(z: float) -> float:
        return r + (top - r) * (z - foot) / (p.height - foot)

    body.turned("cone", [(r, foot), (top, p.height), (top - t, p.height), (r - t, foot)], segments=n)
    for k in range(p.bands):
        a = foot + (p.height - foot) * (0.42 + 0.26 * k)
        b = a + 0.16 * (p.height - foot)
        body.turned(
            f"band_{k + 1}",
            [(radius(a), a), (radius(a) + TRIM, a), (radius(b) + TRIM, b), (radius(b), b)],
            segments=n,
            material=p.band,
        )
        drawn(body, f"band_{k + 1}")
    return Made.of(body)


class BollardParameters(Parameters):
    """A turned bollard with a ring or a mooring head."""

    height: float = Field(default=0.9, ge=0.3, le=1.3, description="[m]")
    diameter: float = Field(default=0.2, ge=0.12, le=0.4, description="of the shaft at its foot [m]")
    style: Literal["street", "mooring", "stone"] = Field(
        default="street", description="post with mouldings, mooring head with a lip, or a plain round stone"
    )
    material: str = material("cast_iron", "mild_steel", "granite", "oak")


def _bollard(p: BollardParameters, rng: np.random.Generator) -> Made:
    body = Body("bollard", p.material)
    h, r = p.height, min(p.diameter / 2, 0.3 * p.height)
    if p.style == "street":
        outline = [
            (1.35 * r, 0),
            (1.35 * r, 0.05 * h),
            (1.05 * r, 0.1 * h),
            (r, 0.13 * h),
            (0.78 * r, 0.74 * h),
            (0.98 * r, 0.76 * h),
            (0.98 * r, 0.79 * h),
            (0.7 * r, 0.81 * h),
            (0.72 * r, 0.85 * h),
            (0.9 * r, 0.87 * h),
            (0.95 * r, 0.93 * h),
            (0.7 * r, 0.98 * h),
            (0.2 * r, h),
        ]
    elif p.style == "mooring":
        outline = [
            (1.7 * r, 0),
            (1.7 * r, 0.06 * h),
            (1.15 * r, 0.06 * h),
            (1.1 * r, 0.12 * h),
            (0.9 * r, 0.2 * h),
            (0.85 * r, 0.66 * h),
            (1.35 * r, 0.76 * h),
            (1.45 * r, 0.84 * h),
            (1.2 * r, 0.93 * h),
            (0.5 * r, h),
        ]
    else:
        rough = float(rng.uniform(0.82, 0.95))
        outline = [
            (1.15 * r, 0),
            (1.15 * r, 0.06 * h),
            (1.05 * r, 0.3 * h),
            (rough * r, 0.8 * h),
            (0.85 * rough * r, 0.92 * h),
            (0.5 * r, 0.985 * h),
            (0.1 * r, h),
        ]
    spindle(body, "bollard", outline, (0, 0, 0), segments=28)
    if p.style == "mooring":
        for k in range(6):
            a = 2 * math.pi * k / 6
            x, y = 1.42 * r * math.cos(a), 1.42 * r * math.sin(a)
            body.cylinder(f"bolt_{k + 1}", (x, y, 0.06 * h), (x, y, 0.06 * h + 0.015), 0.1 * r)
    return Made.of(body)


GENERATORS = (
    Generator("lamp_post", "street lamp with a turned shaft and a lantern of panes", LampPostParameters, _lamp_post,
              ("street", "lantern", "light", "village", "park", "victorian")),
    Generator("park_bench", "park bench of slats on cast ends with arms", ParkBenchParameters, _park_bench, ("seat", "garden", "street", "park", "furniture")),
    Generator("signpost", "signpost with arrow boards", SignpostParameters, _signpost, ("sign", "crossroads", "village", "path", "direction")),
    Generator("marker_cone", "hollow traffic cone with a band", ConeParameters, _cone, ("traffic", "road", "cone", "pylon", "site", "sport")),
    Generator("bollard", "turned bollard of a street or a quay", BollardParameters, _bollard, ("street", "harbour", "mooring", "quay", "post")),
)  # fmt: skip
