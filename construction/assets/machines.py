"""Machines: pulleys, gears, conveyors, hoppers."""

from __future__ import annotations

import math

import numpy as np
from pydantic import Field

from .generator import Generator, Parameters, material
from .made import Body, Joint, Made, Place
from .profiles import arc, circle, mitred
from .wheels import Axle

__all__ = ["GENERATORS"]

PLAY = 1.2e-3
"""Between what turns and its bearing [m]."""
PRESSURE = math.radians(20)
"""Pressure angle of teeth."""


class PulleyParameters(Parameters):
    """A pulley block with a grooved wheel on a hinge (axis along y) and a hook over it; it hangs."""

    diameter: float = Field(default=0.16, ge=0.05, le=0.4, description="of the wheel [m]")
    rope: float = Field(default=0.02, ge=0.008, le=0.04, description="diameter of the rope that its groove takes [m]")
    hook: bool = Field(default=True, description="a hook over the block, or an eye")
    wheel: str = material("bronze", "cast_iron", "oak", "nylon", of="wheel")
    metal: str = material("mild_steel", "cast_iron", of="hook and pins")
    material: str = material("oak", "ash", "mild_steel", "cast_iron")


def _pulley(p: PulleyParameters, rng: np.random.Generator) -> Made:
    body = Body("pulley block", p.material)
    made = Made.of(body)
    r, rope = p.diameter / 2, min(p.rope, 0.25 * p.diameter)
    half, cheek, low = 0.75 * rope, max(0.008, 0.07 * p.diameter), 0.35 * r
    z = low + 1.25 * r
    axle = Axle((0, 0, z), "y")
    sheave = made.bodies["wheel"] = Body("pulley wheel", p.wheel)
    depth = 0.8 * rope
    for s, side in ((-1, "front"), (1, "back")):
        outline = [(0, 0), (r - depth, 0), (r - 0.15 * depth, s * 0.75 * half), (r, s * 0.8 * half), (r, s * half), (0, s * half)]
        axle.ring(sheave, f"flange_{side}", outline if s > 0 else outline[::-1], segments=32)
        boss = [(0, s * half), (0.3 * r, s * half), (0.25 * r, s * (half + 0.002)), (0, s * (half + 0.002))]
        axle.ring(sheave, f"boss_{side}", boss if s > 0 else boss[::-1], segments=16)
        inner = s * (half + 0.002 + PLAY)
        a, b = sorted((inner, inner + s * cheek))
        plate = [*((0.8 * r * math.cos(t), z + 1.16 * r * math.sin(t)) for t in np.linspace(math.pi, 2 * math.pi, 11)), *((e * 0.75 * r, z + 0.5 * r) for e in (-1, 1)),
                 (0.4 * r, z + 1.75 * r), (-0.4 * r, z + 1.75 * r)]  # fmt: skip
        body.hull(f"cheek_{side}", [(x, y, h) for x, h in plate for y in (a, b)])
        edge = inner + s * cheek
        body.cylinder(f"pin_{side}", (0, edge, z), (0, edge + s * 0.005, z), 0.16 * r, material=p.metal)
    wide = half + 0.002 + PLAY
    body.box("head", (-0.4 * r, -wide, z + 1.25 * r), (0.4 * r, wide, z + 1.75 * r))
    body.box("tail", (-0.15 * r, -wide, z - 1.14 * r), (0.15 * r, wide, z - 1.06 * r), material=p.metal)
    bar = max(0.005, 0.11 * r)
    top = z + 1.75 * r
    body.turned(
        "swivel", [(0, top), (0.3 * r, top), (0.2 * r, top + 0.25 * r), (0, top + 0.25 * r)], segments=20, material=p.metal
    )
    start, bow = top + 0.25 * r, 0.42 * r
    center = (0.0, start + 0.2 * r + bow)
    points = arc(center, bow, -0.5 * math.pi + 0.35, -0.5 * math.pi + 0.35 + (1.45 * math.pi if p.hook else 1.62 * math.pi), 14)
    path = [(0.0, 0.0, start), (0.0, 0.0, start + 0.12 * r), *((x, 0.0, h) for x, h in points)]
    scales = [1.0] * (len(path) - 3) + ([0.85, 0.7, 0.5] if p.hook else [1.0] * 3)
    body.sweep("hook", path, circle(bar, 10), scales=scales, material=p.metal)
    made.joints["wheel"] = Joint("wheel", "hinge", (0, 0, z), axis=(0, 1, 0), damping=0.001, friction=0.003)
    return made


class GearPairParameters(Parameters):
    """Two meshing spur gears on a stand; numbers of teeth are multiples of 8. The joints are free: contact of the teeth drives."""

    module: float = Field(default=0.016, ge=0.012, le=0.03, description="pitch diameter over number of teeth [m]")
    eighths: int = Field(default=2, ge=2, le=4, description="teeth of the driver, over 8")
    eighths_driven: int = Field(default=3, ge=2, le=4, description="teeth of the driven gear, over 8")
    width: float = Field(default=0.035, ge=0.02, le=0.08, description="of the teeth along y [m]")
    crank: bool = Field(default=True, description="a handle on the driver")
    stand: str = material("oak", "pine", "mild_steel", of="stand")
    material: str = material("cast_iron", "brass", "bronze", "nylon", "beech")


def _tooth(module: float, teeth: int, thin: float) -> list[tuple[float, float]]:
    """Half outline (radius, angle from the middle) of an involute tooth from its root to its tip, thinner by `thin` on each side [m]."""
    pitch = module * teeth / 2
    base = pitch * math.cos(PRESSURE)
    root, tip = pitch - 1.25 * module, pitch + module

    def involute(radius: float) -> float:
        a = math.acos(min(1.0, base / radius))
        return math.tan(a) - a

    half = math.pi / (2 * teeth) - thin / pitch + involute(pitch)
    steps = [max(base, root), *np.linspace(max(base, root), tip, 4)[1:]]
    found = [(float(r), half - involute(float(r))) for r in steps]
    return [(root, found[0][1]), *found] if root < base else found


def _gear(body: Body, axle: Axle, module: float, teeth: int, width: float, phase: float) -> None:
    """Rim with teeth, spokes and a hub; a tooth points to the angle `phase`."""
    half = width / 2
    flank = _tooth(module, teeth, 0.00075)
    root = flank[0][0]
    inner = root - 1.6 * module
    step = 2 * math.pi / teeth
    for k in range(teeth):
        a = phase + k * step
        points = [axle.at(r, a + s * t, w) for r, t in flank for s in (-1, 1) for w in (-half, half)]
        chord = root * math.cos(step / 2) / math.cos(flank[0][1])
        points += [axle.at(min(chord, root), a + s * flank[0][1], w) for s in (-1, 1) for w in (-half, half)]
        body.hull(f"tooth_{k + 1}", points)
        ring = [axle.at(r, a + s * step / 2, w) for r in (inner, root) for s in (-1, 1) for w in (-half, half)]
        body.hull(f"rim_{k + 1}", ring)
    spokes = 4 if teeth < 24 else 8 if teeth % 16 == 0 else 6 if teeth % 6 == 0 else 4
    hub = max(0.3 * inner, 1.2 * module)
    axle.ring(
        body,
        "hub",
        [(0, -0.7 * width), (hub, -0.7 * width), (hub, half), (0, half)],
        segments=spokes * 2,
        spin=phase + math.pi / (2 * spokes),
    )
    flat_hub, flat_rim = hub * math.cos(math.pi / (2 * spokes)), inner * math.cos(step / 2)
    wide = min(0.85 * 2 * hub * math.sin(math.pi / (2 * spokes)), 0.85 * 2 * inner * math.sin(step / 2))
    for k in range(spokes):
        axle.bar(
            body,
            f"spoke_{k + 1}",
            (flat_hub, flat_rim),
            phase + 2 * math.pi * k / spokes,
            (wide, 0.8 * wide),
            (-0.35 * width, 0.35 * width),
        )


def _gear_pair(p: GearPairParameters, rng: np.random.Generator) -> Made:
    teeth = (8 * p.eighths, 8 * p.eighths_driven)
    radii = [p.module * t / 2 for t in teeth]
    apart = sum(radii) + 3e-4
    tip = max(radii) + p.module
    foot, plate = 0.05, 0.03
    z = foot + tip + 0.05
    centers = (-apart / 2, apart / 2)
    body = Body("stand", p.stand)
    made = Made.of(body)
    back = p.width / 2 + PLAY + 0.012
    ends = (centers[0] - radii[0] - p.module, centers[1] + radii[1] + p.module)
    body.box("base", (ends[0] - 0.03, -0.12 - p.width, 0), (ends[1] + 0.03, back + plate + 0.1, foot))
    for k, x in enumerate(centers):
        name = ("driver", "driven")[k]
        wide = 0.5 * radii[k]
        body.hull(
            f"post_{name}",
            [
                (x + s * w, y, h)
                for w, h in ((wide, foot), (0.45 * wide, z + 0.3 * wide), (0.8 * wide, z - 0.3 * wide))
                for s in (-1, 1)
                for y in (back, back + plate)
            ],
        )
        body.hull(
            f"knee_{name}",
            [
                (x + s * 0.012, y, h)
                for s in (-1, 1)
                for y, h in ((back + plate, foot), (back + plate + 0.09, foot), (back + plate, foot + 0.7 * (z - foot)))
            ],
        )
        boss = 0.3 * radii[k]
        body.cylinder(f"boss_{name}", (x, back, z), (x, back - 0.012, z), 0.7 * boss, material="mild_steel")
        gear = made.bodies[name] = Body("gear", p.material)
        axle = Axle((x, 0, z), "y")
        phase = 0.0 if k == 0 else math.pi + math.pi / teeth[1]
        _gear(gear, axle, p.module, teeth[k], p.width, phase)
        made.joints[name] = Joint(name, "hinge", (x, 0, z), axis=(0, 1, 0), damping=0.005, friction=0.005)
    if p.crank:
        x = centers[0]
        front = -0.7 * p.width
        made.bodies["driver"].box("arm", (x - 0.01, front - 0.012, z - 0.01), (x + 0.01, front, z + 0.75 * radii[0]))
        made.bodies["driver"].cylinder(
            "handle", (x, front - 0.012, z + 0.7 * radii[0]), (x, front - 0.09, z + 0.7 * radii[0]), 0.011, material="beech"
        )
    return made


class ConveyorParameters(Parameters):
    """A roller conveyor along x on legs; every roller turns on a hinge."""

    length: float = Field(default=2.0, ge=0.8, le=4.0, description="along x [m]")
    width: float = Field(default=0.5, ge=0.25, le=1.0, description="over the rollers along y [m]")
    height: float = Field(default=0.7, ge=0.3, le=1.1, description="to the top of the rollers [m]")
    rollers: int = Field(default=14, ge=5, le=24, description="rollers, fewer where they would touch")
    radius: float = Field(default=0.03, ge=0.02, le=0.05, description="of a roller [m]")
    stop: bool = Field(default=True, description="a stop at the right end")
    roller: str = material("stainless_steel", "pvc", "aluminium_alloy", of="rollers")
    material: str = material("mild_steel", "aluminium_alloy")


def _conveyor(p: ConveyorParameters, rng: np.random.Generator) -> Made:
    body = Body("conveyor", p.material)
    made = Made.of(body)
    half, y = p.length / 2, p.width / 2
    count = max(3, min(p.rollers, int((p.length - 0.06) / (2 * p.radius + 0.01))))
    step = (p.length - 0.06) / count
    axis, rail = p.height - p.radius, 0.09
    low, high = axis - 0.6 * rail, axis + 0.4 * rail
    if high > p.height - 0.004:
        low, high = p.height - 0.004 - rail, p.height - 0.004
    for s, side in ((-1, "front"), (1, "back")):
        a, b = sorted((s * (y + PLAY), s * (y + PLAY + 0.006)))
        body.box(f"rail_{side}", (-half, a, low), (half, b, high))
        for name, z in (("low", low), ("high", high - 0.006)):
            c, d = sorted((s * (y + PLAY + 0.006), s * (y + PLAY + 0.035)))
            body.box(f"flange_{name}_{side}", (-half, c, z), (half, d, z + 0.006))
        for t, end in ((-1, "left"), (1, "right")):
            x = t * (half - 0.15)
            c, d = sorted((s * (y + PLAY - 0.04), s * (y + PLAY + 0.006)))
            body.box(f"leg_{side}_{end}", (x - 0.02, c, 0.008), (x + 0.02, d, low))
            body.box(f"foot_{side}_{end}", (x - 0.045, min(c, d) - 0.02, 0), (x + 0.045, max(c, d) + 0.02, 0.008))
    inner = y + PLAY - 0.04
    for t, end in ((-1, "left"), (1, "right")):
        x = t * (half - 0.15)
        body.box(f"tie_{end}", (x - 0.015, -inner, 0.3 * low), (x + 0.015, inner, 0.3 * low + 0.03))
        body.box(f"spreader_{end}", (x - 0.015, -inner, low - 0.04), (x + 0.015, inner, low - 0.01))
    body.box("stringer", (-half + 0.165, -0.015, 0.3 * low), (half - 0.165, 0.015, 0.3 * low + 0.03))
    for k in range(count):
        x = -half + 0.03 + (k + 0.5) * step
        name = f"roller_{k + 1}"
        roller = made.bodies[name] = Body("roller", p.roller)
        roller.cylinder("roller", (x, -y, axis), (x, y, axis), p.radius)
        for s, side in ((-1, "front"), (1, "back")):
            edge = s * (y + PLAY + 0.006)
            body.cylinder(f"nut_{side}_{k + 1}", (x, edge, (low + high) / 2), (x, edge + s * 0.006, (low + high) / 2), 0.008)
        made.joints[name] = Joint(name, "hinge", (x, 0, axis), axis=(0, 1, 0), damping=0.0005, friction=0.002)
    if p.stop:
        x = half - 0.03 + 0.005
        body.box("stop", (x, -y - PLAY, p.height + 0.004), (x + 0.012, y + PLAY, p.height + 0.05))
        for s, side in ((-1, "front"), (1, "back")):
            a, b = sorted((s * (y + PLAY), s * (y + PLAY + 0.006)))
            body.box(f"ear_{side}", (x - 0.015, a, high), (x + 0.015, b, p.height + 0.05))
    middle = count // 2
    made.places["rollers"] = Place(
        (-half + 0.03 + (middle + 0.5) * step, 0, p.height), (p.length - 0.2, p.width - 0.04), body=f"roller_{middle + 1}"
    )
    return made


class HopperParameters(Parameters):
    """A funnel on four legs with a spout and a gate that slides to the right."""

    width: float = Field(default=0.9, ge=0.4, le=2.0, description="of the mouth along x [m]")
    depth: float = Field(default=0.9, ge=0.4, le=2.0, description="of the mouth along y [m]")
    height: float = Field(default=1.5, ge=0.8, le=3.0, description="over all [m]")
    outlet: float = Field(default=0.16, ge=0.08, le=0.3, description="side of the outlet [m]")
    slope_deg: float = Field(
        default=50.0, ge=35.0, le=65.0, description="of the steeper walls, where the height allows [degrees]"
    )
    wall: float = Field(default=0.008, ge=0.004, le=0.02, description="thickness, measured level [m]")
    material: str = material("mild_steel", "stainless_steel", "oak", "aluminium_alloy")


def _hopper(p: HopperParameters, rng: np.random.Generator) -> Made:
    body = Body("hopper", p.material)
    made = Made.of(body)
    out = min(p.outlet, 0.4 * min(p.width, p.depth)) / 2 + p.wall
    x, y = p.width / 2, p.depth / 2
    rim = 0.04
    collar = 0.1 * p.height
    fall = min((min(x, y) - out) * math.tan(math.radians(p.slope_deg)), 0.5 * p.height)
    knee, spout = p.height - rim - collar, 0.08
    neck = knee - fall
    plates = {
        "collar": ((-x, -y, x, y), (-x, -y, x, y), (knee, p.height - rim)),
        "funnel": ((-out, -out, out, out), (-x, -y, x, y), (neck, knee)),
        "spout": ((-out, -out, out, out), (-out, -out, out, out), (neck - spout, neck)),
    }
    for name, (low, high, levels) in plates.items():
        for side, points in mitred(low, high, levels, p.wall).items():
            body.hull(f"{name}_{side}", points)
    lip = (-x - rim, -y - rim, x + rim, y + rim)
    for side, points in mitred(lip, lip, (p.height - rim, p.height), rim + p.wall).items():
        body.hull(f"rim_{side}", points)
    for s, a in ((-1, "left"), (1, "right")):
        for t, b in ((-1, "front"), (1, "back")):
            u, v = s * (x + rim / 2), t * (y + rim / 2)
            body.taper(f"leg_{a}_{b}", (u, v, 0.008), (u, v, p.height - rim), (rim, rim), (rim, rim))
            body.box(f"foot_{a}_{b}", (u - 0.06, v - 0.06, 0), (u + 0.06, v + 0.06, 0.008))
    z = 0.18 * p.height
    for t, b in ((-1, "front"), (1, "back")):
        body.box(f"tie_{b}", (-x, t * (y + rim / 2) - 0.01, z), (x, t * (y + rim / 2) + 0.01, z + 0.03))
    for s, a in ((-1, "left"), (1, "right")):
        body.box(f"tie_{a}", (s * (x + rim / 2) - 0.01, -y, z), (s * (x + rim / 2) + 0.01, y, z + 0.03))
    _gate(made, out, neck - spout, p)
    return made


def _gate(made: Made, out: float, z: float, p: HopperParameters) -> None:
    """A plate under the spout in two guides."""
    plate, lip = 0.006, 0.012
    for t, b in ((-1, "front"), (1, "back")):
        a, c = sorted((t * out, t * (out + lip)))
        made.main.box(f"guide_{b}", (-out, a, z - plate - 3 * PLAY - 0.004), (out + 0.06, c, z + 0.03))
        a, c = sorted((t * out, t * (out - lip)))
        made.main.box(f"ledge_{b}", (-out, a, z - plate - 3 * PLAY - 0.004), (out + 0.06, c, z - plate - 3 * PLAY))
    gate = made.bodies["gate"] = Body("gate of a hopper", p.material)
    high, w = z - PLAY, out - PLAY
    gate.box("plate", (-out, -w, high - plate), (out + 0.12, w, high))
    gate.box("grip", (out + 0.12, -0.5 * w, high - plate - 0.02), (out + 0.132, 0.5 * w, high + 0.02))
    made.joints["gate"] = Joint(
        "gate", "slide", (0.0, out - PLAY / 2, high - plate / 2), axis=(1, 0, 0), range=(0.0, 2 * out), damping=10.0, friction=6.0
    )


GENERATORS = (
    Generator("pulley", "pulley block with a grooved wheel on a hinge and a hook; it hangs", PulleyParameters, _pulley,
              ("rope", "crane", "hoist", "block", "tackle", "sheave"), stands=False),
    Generator("gear_pair", "two meshing gears on hinges on a stand, with a crank", GearPairParameters, _gear_pair,
              ("cog", "cogwheel", "transmission", "clockwork", "mill", "teeth")),
    Generator("conveyor", "roller conveyor on legs whose rollers turn on hinges", ConveyorParameters, _conveyor,
              ("belt", "rollers", "factory", "warehouse", "packages", "machine")),
    Generator("hopper", "funnel on legs with a spout and a sliding gate", HopperParameters, _hopper,
              ("funnel", "silo", "grain", "feed", "factory", "machine", "chute")),
)  # fmt: skip
