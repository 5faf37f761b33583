"""Towers, chimneys and stone bridges."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
from pydantic import Field

from .generator import Generator, Parameters, material
from .made import Body, Made, Place
from .masonry import block

__all__ = ["GENERATORS", "TowerParameters", "clipped", "ring", "tower"]

SIDES = 24
"""Sides of round towers."""
Plan = list[tuple[float, float]]


def clipped(plan: Plan, a: float, b: float, limit: float) -> Plan:
    """Part of a convex polygon where a x + b y <= limit."""
    found: Plan = []
    for (x0, y0), (x1, y1) in zip(plan, [*plan[1:], plan[0]], strict=True):
        s0, s1 = a * x0 + b * y0 - limit, a * x1 + b * y1 - limit
        if s0 <= 0:
            found.append((x0, y0))
        if s0 * s1 < 0:
            t = s0 / (s0 - s1)
            found.append((x0 + t * (x1 - x0), y0 + t * (y1 - y0)))
    return found


class TowerParameters(Parameters):
    """A round tower that leans inwards: courses, a doorway and loopholes at the front, corbels, crenels or a pointed roof."""

    diameter: float = Field(default=3.6, ge=2.0, le=8.0, description="at the foot [m]")
    height: float = Field(default=7.0, ge=4.0, le=15.0, description="of the platform [m]")
    batter: float = Field(default=0.04, ge=0.0, le=0.1, description="inward lean of the wall, run over rise")
    top: Literal["crenels", "cone"] = Field(default="crenels", description="battlements about a platform, or a pointed roof")
    door: bool = Field(default=True, description="a doorway with a door of planks at the front")
    tiles: str = material("slate", "roof_tile", "copper", of="roof")
    wood: str = material("oak", "larch", of="door")
    material: str = material("limestone", "sandstone", "granite", "gneiss", "basalt")


def ring(radius: float) -> Plan:
    """Plan of a drum with a side to the front."""
    turn = math.pi / SIDES
    return [
        (radius * math.cos(2 * math.pi * k / SIDES + turn), radius * math.sin(2 * math.pi * k / SIDES + turn))
        for k in range(SIDES)
    ]


def _drum(body: Body, name: str, outline: list[tuple[float, float]], slot: tuple[float, float] | None = None) -> None:
    """A course from its outline (r, z) upwards; with a slot of a width, open at the front as far as y = -reach."""
    if slot is None:
        body.hull(name, [(x, y, z) for r, z in outline for x, y in ring(r)])
        return
    half, reach = slot[0] / 2, slot[1]
    cuts = {
        "left": ((1.0, 0.0, -half),),
        "right": ((-1.0, 0.0, -half),),
        "back": ((1.0, 0.0, half), (-1.0, 0.0, half), (0.0, -1.0, reach)),
    }
    for side, planes in cuts.items():
        points = []
        for r, z in outline:
            plan = ring(r)
            for plane in planes:
                plan = clipped(plan, *plane)
            points += [(x, y, z) for x, y in plan]
        body.hull(f"{name}_{side}", points)


def tower(p: TowerParameters, rng: np.random.Generator) -> Made:
    """A round tower, see `TowerParameters`."""
    body = Body("tower", p.material)
    made = Made.of(body)
    foot = p.diameter / 2
    batter = min(p.batter, 0.3 * foot / p.height)
    neck = p.height - 0.85
    courses = max(5, min(22, round(neck / 0.5)))
    high, c = neck / courses, 0.02

    def radius(z: float) -> float:
        return foot - batter * z

    doorway = math.ceil(1.9 / high) if p.door else 0
    width = min(1.0, 0.3 * p.diameter)
    reach = foot - batter * doorway * high - 0.4
    loop = round(0.62 * courses)
    for k in range(courses):
        a, b = k * high, (k + 1) * high
        plinth = 0.08 * (k == 0)
        rough = float(rng.uniform(0, 0.02))
        outline = [
            (radius(a) + plinth + rough - c, a),
            (radius(a) + plinth + rough, a + c),
            (radius(b) + plinth + rough, b - c),
            (radius(b) + plinth / 2 - c, b),
        ]
        slot = (width, reach) if k < doorway else (0.14, radius(b) - 0.45) if k in (loop, loop + 1) and k >= doorway else None
        _drum(body, f"course_{k + 1}", outline, slot)
    if p.door:
        for j in range(5):
            x = -width / 2 + width * j / 5
            body.box(
                f"plank_{j + 1}",
                (x, -reach - 0.05 - 0.006 * (j % 2), 0),
                (x + width / 5, -reach, doorway * high),
                material=p.wood,
            )
    _crown(made, radius(neck), neck, p)
    return made


def _crown(made: Made, r: float, z: float, p: TowerParameters) -> None:
    """Corbels with a platform and crenels, or with a pointed roof."""
    body, out, top = made.main, 0.28, p.height
    body.hull("neck", [(x, y, h) for h in (z, top - 0.25) for x, y in ring(r - 0.02)])
    flat = (r - 0.02) * math.cos(math.pi / SIDES)
    for k in range(SIDES):
        a, w = 2 * math.pi * k / SIDES - math.pi / 2, 0.28 * (2 * math.pi * r / SIDES)
        line = [(flat, z + 0.05), (flat, top - 0.25), (flat + out, top - 0.25), (flat + out, top - 0.42)]
        body.hull(
            f"corbel_{k + 1}",
            [(d * math.cos(a) - s * w * math.sin(a), d * math.sin(a) + s * w * math.cos(a), h) for d, h in line for s in (-1, 1)],
        )
    wide = r + out + 0.06
    body.hull("platform", [(x, y, h) for d, h in ((wide - 0.03, top - 0.25), (wide, top - 0.2), (wide, top)) for x, y in ring(d)])
    if p.top == "cone":
        tiers, tall = 9, 1.5 * wide
        for k in range(tiers):
            a, b = top + tall * k / tiers, top + tall * (k + 1) / tiers
            low, high = (wide + 0.12) * (1 - k / tiers), (wide + 0.12) * (1 - (k + 1) / tiers)
            body.hull(
                f"tier_{k + 1}",
                [(x, y, h) for d, h in ((low, a), (low, a + 0.05), (max(high - 0.05, 0.03), b)) for x, y in ring(d)],
                material=p.tiles,
            )
        body.turned(
            "finial",
            [(0, top + tall), (0.05, top + tall), (0.02, top + tall + 0.5), (0, top + tall + 0.6)],
            segments=12,
            material="copper",
        )
        return
    thick, breast, merlon = 0.35, top + 0.55, top + 1.25
    outer, inner = ring(wide - 0.05), ring(wide - 0.05 - thick)
    for k in range(SIDES):
        j = (k + 1) % SIDES
        plan = [outer[k], outer[j], inner[j], inner[k]]
        body.hull(f"parapet_{k + 1}", [(x, y, h) for x, y in plan for h in (top, merlon if k % 3 != 1 else breast)])
    made.places["platform"] = Place((0, 0, top), (1.2 * (r - 0.2), 1.2 * (r - 0.2)))


class ChimneyParameters(Parameters):
    """A chimney stack of brick courses about a flue, with a corbelled head and pots."""

    width: float = Field(default=0.75, ge=0.45, le=1.6, description="along x [m]")
    depth: float = Field(default=0.55, ge=0.4, le=1.0, description="along y [m]")
    height: float = Field(default=1.6, ge=0.6, le=4.0, description="without the pots [m]")
    pots: int = Field(default=2, ge=1, le=4, description="pots on the head")
    pot: str = material("terracotta", "roof_tile", of="pots")
    material: str = material("brick_masonry", "limestone", "granite")


def _pinwheel(body: Body, name: str, half: tuple[float, float], wall: float, levels: tuple[float, float], mirrored: bool) -> None:
    """Four stones about a flue."""
    w, d = half
    s = -1 if mirrored else 1
    plans = {
        "front": (-w, w - wall, -d, -d + wall),
        "right": (w - wall, w, -d, d - wall),
        "back": (-w + wall, w, d - wall, d),
        "left": (-w, -w + wall, -d + wall, d),
    }
    for side, (x0, x1, y0, y1) in plans.items():
        a, b = sorted((s * x0, s * x1))
        block(body, f"{name}_{side}", (a, y0, levels[0]), (b, y1, levels[1]), chamfer=0.006)


def _chimney(p: ChimneyParameters, rng: np.random.Generator) -> Made:
    body = Body("chimney", p.material)
    head = min(0.3, 0.3 * p.height)
    courses = max(3, min(22, round((p.height - head) / 0.12)))
    high, wall = (p.height - head) / courses, 0.11
    for k in range(courses):
        _pinwheel(body, f"course_{k + 1}", (p.width / 2, p.depth / 2), wall, (k * high, (k + 1) * high), k % 2 == 1)
    z = p.height - head
    for k, out in enumerate((0.03, 0.06, 0.03)):
        step = head / 4
        _pinwheel(body, f"head_{k + 1}", (p.width / 2 + out, p.depth / 2 + out), wall + out, (z, z + step), k % 2 == courses % 2)
        z += step
    w, d = p.width / 2, p.depth / 2
    body.hull(
        "flaunching",
        [(s * a, t * b, h) for s in (-1, 1) for t in (-1, 1) for a, b, h in ((w, d, z), (w - 0.06, d - 0.06, p.height))],
        material="cement_mortar",
    )
    count = min(p.pots, max(1, int((p.width - 0.12) / 0.24)))
    r = min(0.115, 0.3 * (p.depth - 0.12))
    for k in range(count):
        x = -w + 0.06 + (p.width - 0.12) * (k + 0.5) / count
        tall = float(rng.uniform(0.35, 0.6))
        outline = [(r, 0), (0.8 * r, 0.8 * tall), (r, 0.86 * tall), (r, tall), (0.72 * r, tall), (0.72 * r, 0)]
        body.turned(f"pot_{k + 1}", outline, (x, 0, p.height), segments=20, material=p.pot)
    return Made.of(body)


class ArchBridgeParameters(Parameters):
    """A stone bridge along x with an arch of voussoirs, a humped deck and parapets."""

    span: float = Field(default=4.0, ge=1.5, le=10.0, description="clear width of the arch [m]")
    width: float = Field(default=2.0, ge=1.0, le=4.0, description="of the bridge along y [m]")
    opening_deg: float = Field(default=130.0, ge=80.0, le=180.0, description="angle of the arch; 180 is a half circle [degrees]")
    spring: float = Field(default=0.4, ge=0.1, le=2.0, description="height of the springing [m]")
    hump: float = Field(default=0.5, ge=0.0, le=1.2, description="fall of the deck towards its ends [m]")
    parapet: float = Field(default=0.7, ge=0.3, le=1.1, description="height of the parapets [m]")
    material: str = material("limestone", "sandstone", "granite", "gneiss")


def _arch_bridge(p: ArchBridgeParameters, rng: np.random.Generator) -> Made:
    body, n = Body("bridge", p.material), 15
    opening, half = math.radians(p.opening_deg), p.span / 2
    radius, deep = half / math.sin(opening / 2), max(0.22, 0.09 * p.span)
    middle = np.array([0.0, p.spring - radius * math.cos(opening / 2)])
    ways = [np.array([math.cos(a), math.sin(a)]) for a in (math.pi / 2 + opening * (0.5 - k / n) for k in range(n + 1))]
    inner, outer = [middle + radius * w for w in ways], [middle + (radius + deep) * w for w in ways]
    crown = float(middle[1]) + radius + deep + 0.22
    end = half + deep + 0.5 + 0.12 * p.span
    hump = min(p.hump, crown - float(outer[0][1]) - 0.2)

    def deck(x: float) -> float:
        return crown - hump * (x / end) ** 2

    y, wall = p.width / 2, min(0.3, 0.15 * p.width)
    for k in range(n):
        proud = y + 0.03 + 0.025 * (k % 2) + float(rng.uniform(0, 0.02)) + 0.04 * (k == n // 2)
        body.hull(
            f"voussoir_{k + 1}",
            [(q[0], s * proud, q[1]) for q in (inner[k], outer[k], inner[k + 1], outer[k + 1]) for s in (-1, 1)],
        )
    xs = [-end, *(float(o[0]) for o in outer), end]
    left = float(outer[0][1])
    for sign, side in ((-1, "left"), (1, "right")):
        lower = [(-end, 0.0), (-half, 0.0), (-half, p.spring), (xs[1], left), (-end, left)]
        upper = [(-end, left), (xs[1], left), (xs[1], deck(xs[1])), (-end, deck(end))]
        for name, outline in (("abutment", lower), ("shoulder", upper)):
            body.hull(f"{name}_{side}", [(-sign * x, s * y, z) for x, z in outline for s in (-1, 1)])
    slab = 0.09
    for k in range(n + 2):
        a, b = xs[k], xs[k + 1]
        if 0 < k <= n:
            points = [(q[0], q[1]) for q in (outer[k - 1], outer[k])]
            body.hull(f"spandrel_{k}", [(x, s * y, z) for x, z in [*points, (a, deck(a)), (b, deck(b))] for s in (-1, 1)])
        body.hull(f"paving_{k + 1}", [(x, s * (y + 0.06), deck(x) + h) for x in (a, b) for s in (-1, 1) for h in (0, slab)])
        for s, side in ((-1, "front"), (1, "back")):
            ys = (s * y, s * (y - wall))
            top = slab + p.parapet
            body.hull(f"parapet_{side}_{k + 1}", [(x, e, deck(x) + h) for x in (a, b) for e in ys for h in (slab, top)])
            cap = (
                (s * (y + 0.05), top),
                (s * (y - wall - 0.05), top),
                (s * (y + 0.03), top + 0.1),
                (s * (y - wall - 0.03), top + 0.1),
            )
            body.hull(f"coping_{side}_{k + 1}", [(x, e, deck(x) + h) for x in (a, b) for e, h in cap])
    made = Made.of(body)
    made.places["deck"] = Place((0, 0, deck(xs[n // 2 + 1]) + slab), (0.2 * p.span, p.width - 2 * wall - 0.1))
    return made


GENERATORS = (
    Generator("tower", "round stone tower with a doorway, corbels and crenels or a pointed roof", TowerParameters, tower,
              ("castle", "keep", "turret", "fortress", "battlement", "medieval"), motion="static"),
    Generator("chimney", "brick chimney stack with a corbelled head and pots", ChimneyParameters, _chimney,
              ("roof", "house", "brick", "smoke", "stack")),
    Generator("arch_bridge", "stone bridge with an arch of voussoirs, a humped deck and parapets", ArchBridgeParameters, _arch_bridge,
              ("stream", "river", "stone", "road", "crossing"), motion="static"),
)  # fmt: skip
