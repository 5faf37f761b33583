"""Spiral stairs, railings and balustrades."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
from pydantic import Field

from .generator import Generator, Parameters, material
from .made import Body, Made, Place
from .profiles import circle, rounded

__all__ = ["GENERATORS", "spindle"]

HEADROOM = 2.05
"""Over the treads of a spiral [m]."""


def spindle(
    body: Body,
    name: str,
    outline: list[tuple[float, float]],
    at: tuple[float, float, float],
    *,
    segments: int = 16,
    material: str | None = None,
) -> None:
    """Add a turned piece from its outline (r, z) upwards: one part for each stretch between necks, each convex and so one piece."""
    start, number = 0, 1
    for k in range(1, len(outline)):
        end = k == len(outline) - 1
        if not end:
            (r0, z0), (r1, z1), (r2, z2) = outline[k - 1 : k + 2]
            end = (r1 - r0) * (z2 - z1) - (z1 - z0) * (r2 - r1) < -1e-12
        if end:
            stretch = outline[start : k + 1]
            profile = [(0.0, stretch[0][1]), *stretch, (0.0, stretch[-1][1])]
            body.turned(f"{name}_{number}", profile, at, segments=segments, material=material)
            start, number = k, number + 1


class SpiralStairsParameters(Parameters):
    """Winding treads about a pole, with a helical handrail; the last tread is level with the floor above."""

    rise: float = Field(default=2.8, ge=2.0, le=3.6, description="height of the floor above [m]")
    diameter: float = Field(default=1.7, ge=1.4, le=2.6, description="over the treads [m]")
    riser: float = Field(default=0.19, ge=0.16, le=0.2, description="height of a step at most [m]")
    per_turn: int = Field(default=13, ge=11, le=16, description="treads of a full turn, more where headroom asks for it")
    pole: float = Field(default=0.14, ge=0.1, le=0.25, description="diameter of the pole [m]")
    turn: Literal["left", "right"] = Field(default="left", description="side to which it winds on the way up")
    railing: bool = Field(default=True, description="handrail and balusters")
    metal: str = material("mild_steel", "cast_iron", "stainless_steel", of="pole and railing")
    material: str = material("oak", "beech", "mild_steel", "ash", "teak")


def _spiral_stairs(p: SpiralStairsParameters, rng: np.random.Generator) -> Made:
    body = Body("spiral stairs", p.material)
    made = Made.of(body)
    steps = math.ceil(p.rise / p.riser - 1e-9)
    rise = p.rise / steps
    turn = max(p.per_turn, math.ceil(HEADROOM / rise))
    step, sign = 2 * math.pi / turn, 1 if p.turn == "left" else -1
    pole, outer, plate = p.pole / 2, p.diameter / 2, 0.02
    top = p.rise + 1.0

    def at(radius: float, k: float, z: float) -> tuple[float, float, float]:
        a = sign * k * step - math.pi / 2
        return (radius * math.cos(a), radius * math.sin(a), z)

    quarter = sign * math.pi / 2
    body.turned("plate", [(0, 0), (0.24 * p.diameter, 0), (0.22 * p.diameter, plate), (0, plate)], segments=32, material=p.metal)
    start = -math.pi / 2 if sign > 0 else math.pi - quarter
    body.turned("pole", [(0, plate), (pole, plate), (pole, top), (0, top)], euler=(0, 0, start), segments=turn, material=p.metal)
    body.turned(
        "finial",
        [(0, top), (0.7 * pole, top), (1.2 * pole, top + 0.6 * pole), (1.1 * pole, top + 1.4 * pole), (0, top + 2 * pole)],
        material=p.metal,
    )
    for k in range(steps):
        z, thick = (k + 1) * rise, 0.042
        rim = [at(outer, k + c, 0)[:2] for c in (-0.12, 0.15, 0.4, 0.7, 1.0)]
        plan = [at(pole, k, 0)[:2], *rim, at(pole, k + 1, 0)[:2]]
        body.hull(f"tread_{k + 1}", [(x, y, h) for x, y in plan for h in (z - thick, z)])
        mid = at(0.55 * (outer + pole), k + 0.5, z)
        made.places[f"tread_{k + 1}"] = Place(mid, (0.2 * outer, 0.2 * outer), HEADROOM)
    if p.railing:
        for k in range(steps):
            z, high = (k + 1) * rise, (k + 1) * rise + 0.9
            x, y, _ = at(outer - 0.05, k + 0.5, 0)
            foot = [(x + a, y + b, h) for a in (-0.009, 0.009) for b in (-0.009, 0.009) for h in (z, high - 0.016)]
            body.hull(f"baluster_{k + 1}", [*foot, (x, y, high)], material=p.metal)
            if k < steps - 1:
                section = ((-0.072, 0.0), (-0.028, 0.0), (-0.02, 0.02), (-0.035, 0.04), (-0.065, 0.04), (-0.08, 0.02))
                body.hull(
                    f"handrail_{k + 1}", [at(outer + r, k + 0.5 + d, high + d * rise + h) for d in (0, 1) for r, h in section]
                )
    return made


class RailingParameters(Parameters):
    """A level railing along x: posts, a handrail, balusters or bars."""

    length: float = Field(default=2.4, ge=0.8, le=8.0, description="along x [m]")
    height: float = Field(default=1.0, ge=0.85, le=1.2, description="to the upper side of the handrail [m]")
    style: Literal["iron", "wood", "glass"] = Field(
        default="iron", description="bent tube with bars, posts of wood with balusters, or panes between posts"
    )
    gap: float = Field(
        default=0.11, ge=0.08, le=0.16, description="between balusters at most, more where they would be too many [m]"
    )
    metal: str = material("mild_steel", "cast_iron", "stainless_steel", "brass", of="tube and bars")
    material: str = material("oak", "beech", "pine", "teak")


def _railing(p: RailingParameters, rng: np.random.Generator) -> Made:
    made = Made.of(Body("railing", p.material if p.style == "wood" else p.metal))
    {"iron": _iron, "wood": _wood, "glass": _glass}[p.style](made.main, p)
    return made


def _iron(body: Body, p: RailingParameters) -> None:
    """A tube bent down at both ends, with plates under its feet, a lower bar and upright bars with knobs."""
    r, x, bend, low = 0.021, p.length / 2 - 0.021, 0.12, 0.1
    profile = circle(r, 12)
    half = max(v for _, v in profile)
    top = p.height - half
    left = [(-x + bend - bend * math.cos(a), 0, top - bend + bend * math.sin(a)) for a in np.linspace(0, math.pi / 2, 6)]
    path = [(-x, 0, 0.012), *left, *((-q[0], q[1], q[2]) for q in reversed(left)), (x, 0, 0.012)]
    body.sweep("tube", path, profile)
    for sign, name in ((-1, "left"), (1, "right")):
        body.cylinder(f"flange_{name}", (sign * x, 0, 0), (sign * x, 0, 0.012), 0.055)
    inner = x - half
    body.box("lower_bar", (-inner, -0.008, low), (inner, 0.008, low + 0.03))
    span = 2 * (x - bend) - 0.02
    count = max(1, min(45, math.ceil(span / p.gap) - 1))
    for k in range(count):
        c = -span / 2 + span * (k + 0.5) / count
        w = 0.006
        body.box(f"bar_{k + 1}", (c - w, -w / 2, low + 0.03), (c + w, w / 2, top - half))
    for k in range(1, max(2, round(p.length / 1.5))):
        c = -inner + 2 * inner * k / max(2, round(p.length / 1.5))
        body.box(f"foot_{k}", (c - 0.015, -0.015, 0), (c + 0.015, 0.015, low))


def _wood(body: Body, p: RailingParameters) -> None:
    """Newels with caps, a moulded handrail carried along, a bottom rail and square balusters with chamfered shafts."""
    bays = max(1, math.ceil(p.length / 2.2))
    half, low, rail = 0.045, 0.1, 0.055
    pitch = (p.length - 2 * half) / bays
    section = [(-0.03, 0), (0.03, 0), (0.036, 0.03), (0.022, rail), (-0.022, rail), (-0.036, 0.03)]
    for k in range(bays + 1):
        x = -p.length / 2 + half + k * pitch
        top = p.height + 0.06
        body.box(f"newel_{k + 1}", (x - half, -half, 0), (x + half, half, top))
        rim = [(x + a * 1.2 * half, b * 1.2 * half, h) for a in (-1, 1) for b in (-1, 1) for h in (top, top + 0.015)]
        body.hull(f"cap_{k + 1}", [*rim, (x, 0, top + 0.05)])
        if k == bays:
            break
        a, b = x + half, x + pitch - half
        body.sweep(f"handrail_{k + 1}", [(a, 0, p.height - rail), (b, 0, p.height - rail)], section)
        body.box(f"rail_{k + 1}", (a, -0.022, low), (b, 0.022, low + 0.045))
        count = max(1, min(math.ceil((b - a) / (p.gap + 0.035)) - 1, 90 // bays))
        for j in range(count):
            c = a + (b - a) * (j + 1) / (count + 1)
            body.prism(
                f"baluster_{k + 1}_{j + 1}",
                [(c + u, v) for u, v in rounded(0.035, 0.035, 0.009, 1)],
                low + 0.045,
                p.height - rail,
            )


def _glass(body: Body, p: RailingParameters) -> None:
    """Panes held by clamps between slim posts, a round handrail over them."""
    bays, r = max(1, math.ceil(p.length / 1.4)), 0.02
    profile = circle(r, 12)
    half = max(v for _, v in profile)
    pitch = (p.length - 0.1) / bays
    body.sweep("handrail", [(-p.length / 2, 0, p.height - half), (p.length / 2, 0, p.height - half)], profile)
    for k in range(bays + 1):
        x = -p.length / 2 + 0.05 + k * pitch
        body.box(f"plate_{k + 1}", (x - 0.05, -0.05, 0), (x + 0.05, 0.05, 0.012))
        body.box(f"post_{k + 1}", (x - 0.02, -0.005, 0.012), (x + 0.02, 0.005, p.height - 2 * half))
        if k == bays:
            break
        a, b = x + 0.055, x + pitch - 0.055
        body.box(f"pane_{k + 1}", (a, -0.005, 0.08), (b, 0.005, p.height - 0.12), material="soda_lime_glass")
        for j, z in enumerate((0.2, p.height - 0.3), start=1):
            body.box(f"clamp_{k + 1}_{j}a", (x + 0.02, -0.006, z), (a, 0.006, z + 0.05))
            body.box(f"clamp_{k + 1}_{j}b", (b, -0.006, z), (x + pitch - 0.02, 0.006, z + 0.05))


class BalustradeParameters(Parameters):
    """Turned balusters between a plinth and a coping, with piers at the ends."""

    length: float = Field(default=2.6, ge=1.0, le=6.0, description="along x, over the piers [m]")
    height: float = Field(default=0.95, ge=0.6, le=1.2, description="to the top of the coping [m]")
    pier: float = Field(default=0.3, ge=0.2, le=0.5, description="side of a pier [m]")
    baluster: float = Field(default=0.13, ge=0.09, le=0.18, description="greatest diameter of a baluster [m]")
    balls: bool = Field(default=True, description="balls on the piers")
    material: str = material("limestone", "sandstone", "marble", "terracotta", "granite")


def _balustrade(p: BalustradeParameters, rng: np.random.Generator) -> Made:
    body = Body("balustrade", p.material)
    plinth, coping, pier = 0.13 * p.height, 0.11 * p.height, min(p.pier, 0.25 * p.length)
    inner, deep = p.length / 2 - pier, 0.75 * pier
    body.box("plinth", (-inner, -deep / 2, 0), (inner, deep / 2, plinth))
    under = p.height - coping
    section = [
        (-deep / 2, under),
        (deep / 2, under),
        (deep / 2 + 0.02, under + 0.4 * coping),
        (deep / 2 + 0.02, under + 0.7 * coping),
        (deep / 2 - 0.02, p.height),
    ]
    outline = [*section, *((-y, z) for y, z in reversed(section[2:]))]
    body.prism("coping", outline, -inner, inner, axis="x")
    for sign, name in ((-1, "left"), (1, "right")):
        x = sign * (p.length / 2 - pier / 2)
        for part, grow, low, high in (("base", 0.0, 0.0, plinth), ("die", -0.025, plinth, under), ("cap", 0.0, under, p.height)):
            h = pier / 2 + grow
            toward = -sign * 0.025 if part == "die" else 0.0
            a, b = sorted((x - sign * -h, x - sign * (h + abs(toward))))
            body.box(f"pier_{name}_{part}", (a, -h, low), (b, h, high))
        if p.balls:
            r = 0.3 * pier
            spindle(
                body, f"foot_{name}", [(0.8 * r, p.height), (0.8 * r, p.height + 0.03), (0.4 * r, p.height + 0.06)], (x, 0, 0)
            )
            body.sphere(f"ball_{name}", (x, 0, p.height + 0.06 + r), r)
    tall, r = under - plinth, p.baluster / 2
    count = max(1, min(15, int(2 * inner / (1.45 * p.baluster))))
    belly = float(rng.uniform(0.25, 0.36))
    base = 0.09 * tall
    shape = [
        (0.62 * r, base), (0.62 * r, 0.13 * tall), (0.42 * r, 0.16 * tall), (0.9 * r, (belly - 0.07) * tall + 0.02 * tall), (r, belly * tall + 0.02 * tall),
        (0.85 * r, (belly + 0.13) * tall), (0.38 * r, 0.78 * tall), (0.62 * r, 0.84 * tall), (0.62 * r, tall - base),
    ]  # fmt: skip
    for k in range(count):
        x = -inner + 2 * inner * (k + 0.5) / count
        w = 0.72 * r
        body.box(f"foot_{k + 1}", (x - w, -w, plinth), (x + w, w, plinth + base))
        spindle(body, f"baluster_{k + 1}", [(a, plinth + z) for a, z in shape], (x, 0, 0))
        body.box(f"head_{k + 1}", (x - w, -w, under - base), (x + w, w, under))
    made = Made.of(body)
    made.places["coping"] = Place((0, 0, p.height), (2 * inner, deep - 0.04))
    return made


GENERATORS = (
    Generator("spiral_stairs", "spiral stairs of winding treads about a pole with a helical handrail", SpiralStairsParameters, _spiral_stairs,
              ("staircase", "steps", "helical", "winding", "tower", "library", "building"), motion="static"),
    Generator("railing", "level railing of iron, wood or glass with a handrail", RailingParameters, _railing,
              ("balcony", "handrail", "guard", "banister", "terrace", "fence"), motion="static"),
    Generator("balustrade", "stone balustrade of turned balusters between piers", BalustradeParameters, _balustrade,
              ("terrace", "palace", "garden", "villa", "balcony", "parapet", "stone"), motion="static"),
)  # fmt: skip
