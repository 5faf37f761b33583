"""Things that swing: seesaws, swings, pendulums, Newton's cradles."""

from __future__ import annotations

import math

import numpy as np
from pydantic import Field

from .generator import Generator, Parameters, material
from .made import Body, Joint, Made, Place
from .profiles import circle
from .wheels import Axle

__all__ = ["GENERATORS"]

LIFTED = 2.5
"""Balls that one which is lifted by 45 degrees is aside: half between two, so that none meets the rods of another."""


class SeesawParameters(Parameters):
    """A plank along x that rocks on a hinge between two cheeks."""

    length: float = Field(default=2.6, ge=1.0, le=4.5, description="of the plank [m]")
    width: float = Field(default=0.24, ge=0.12, le=0.4, description="of the plank along y [m]")
    height: float = Field(default=0.5, ge=0.25, le=0.8, description="of the hinge; at most a fourth of the length [m]")
    seats: bool = Field(default=True, description="seats and handles at both ends")
    metal: str = material("mild_steel", "stainless_steel", of="handles and pins")
    material: str = material("oak", "larch", "pine", "ash")


def _seesaw(p: SeesawParameters, rng: np.random.Generator) -> Made:
    body = Body("seesaw stand", p.material)
    made = Made.of(body)
    half, y, z = p.length / 2, p.width / 2, min(p.height, 0.25 * p.length)
    thick, block, base = 0.045, 0.08, 0.05
    cheek, inner = 0.04, y + 0.004
    for s, side in ((-1, "front"), (1, "back")):
        a, b = sorted((s * inner, s * (inner + cheek)))
        outline = [(-0.5 * z, base), (0.5 * z, base), (0.09, z + 0.07), (-0.09, z + 0.07), (0.05, z + 0.1), (-0.05, z + 0.1)]
        body.hull(f"cheek_{side}", [(u, v, h) for u, h in outline for v in (a, b)])
        edge = s * (inner + cheek)
        body.cylinder(f"pin_{side}", (0, edge, z), (0, edge + s * 0.012, z), 0.028, material=p.metal)
    for t, side in ((-1, "left"), (1, "right")):
        a, b = sorted((t * 0.5 * z, t * (0.5 * z - 0.12)))
        body.box(f"sleeper_{side}", (a, -inner - cheek - 0.12, 0), (b, inner + cheek + 0.12, base))
    rest = 0.5 * z - 0.12
    body.box("tie", (-rest, -inner - cheek, 0), (rest, inner + cheek, 0.8 * base))
    plank = made.bodies["plank"] = Body("seesaw plank", p.material)
    axle = Axle((0, 0, z), "y")
    axle.ring(
        plank, "barrel", [(0, -y), (0.03, -y), (0.03, y), (0, y)], segments=16, spin=math.pi / 16 + math.pi / 2, material=p.metal
    )
    low = z + 0.03 * math.cos(math.pi / 16)
    plank.box("cradle_left", (-block, -0.8 * y, z - 0.02), (-0.03, 0.8 * y, low))
    plank.box("cradle_right", (0.03, -0.8 * y, z - 0.02), (block, 0.8 * y, low))
    c = 0.006
    section = [
        (-y + c, low),
        (y - c, low),
        (y, low + c),
        (y, low + thick - c),
        (y - c, low + thick),
        (-y + c, low + thick),
        (-y, low + thick - c),
        (-y, low + c),
    ]
    plank.prism("plank", section, -half, half, axis="x")
    top = low + thick
    if p.seats:
        for t, side in ((-1, "left"), (1, "right")):
            a, b = sorted((t * (half - 0.02), t * (half - 0.02 - 0.1 * p.length)))
            plank.box(f"seat_{side}", (a, -0.95 * y, top), (b, 0.95 * y, top + 0.025))
            x = t * (half - 0.05 - 0.17 * p.length)
            plank.cylinder(f"stem_{side}", (x, 0, top), (x, 0, top + 0.2), 0.014, material=p.metal)
            plank.cylinder(f"handle_{side}", (x, -0.16, top + 0.2 + 0.013), (x, 0.16, top + 0.2 + 0.013), 0.013, material=p.metal)
    limit = 0.85 * math.asin(min(0.9, (low - 0.02) / math.hypot(half, 0.1)))
    made.joints["plank"] = Joint("plank", "hinge", (0, 0, z), axis=(0, 1, 0), range=(-limit, limit), damping=0.5, friction=0.5)
    for t, side in ((-1, "left"), (1, "right")):
        wide = 0.1 * p.length
        made.places[side] = Place((t * (half - 0.02 - wide / 2), 0, top + 0.025 * p.seats), (0.8 * wide, 1.6 * y), body="plank")
    return made


class SwingParameters(Parameters):
    """A frame of a beam on splayed legs with a seat that hangs on two rods and swings along y."""

    height: float = Field(default=2.2, ge=1.2, le=3.5, description="of the beam [m]")
    width: float = Field(default=1.6, ge=1.0, le=2.5, description="between the legs [m]")
    seat: float = Field(default=0.45, ge=0.3, le=0.6, description="height of the seat [m]")
    board: float = Field(default=0.5, ge=0.35, le=0.8, description="width of the seat along x [m]")
    metal: str = material("mild_steel", "stainless_steel", of="rods and lugs")
    material: str = material("larch", "oak", "pine", "spruce")


def _swing(p: SwingParameters, rng: np.random.Generator) -> Made:
    body = Body("swing frame", p.material)
    made = Made.of(body)
    x, beam, spread, under = p.width / 2, 0.1, 0.36 * p.height, p.height - 0.14
    body.hull(
        "beam",
        [
            (u, v, z)
            for u in (-x - 0.2, x + 0.2)
            for v, z in (
                (-0.05, under),
                (0.05, under),
                (-0.05, p.height - 0.02),
                (0.05, p.height - 0.02),
                (-0.03, p.height),
                (0.03, p.height),
            )
        ],
    )
    for s, side in ((-1, "left"), (1, "right")):
        for t, end in ((-1, "front"), (1, "back")):
            body.taper(f"leg_{side}_{end}", (s * (x + 0.08), t * spread, 0), (s * x, t * 0.03, under), (beam, beam), (beam, 0.06))
        z = 0.42 * p.height
        share = z / under
        u, v = s * (x + 0.08 * (1 - share)), (spread - (spread - 0.03) * share) - (beam - (beam - 0.06) * share) / 2
        up = (z + 0.08) / under
        w = (spread - (spread - 0.03) * up) - (beam - (beam - 0.06) * up) / 2
        body.hull(f"tie_{side}", [(u + e, d * g, h) for e in (-0.02, 0.02) for d in (-1, 1) for g, h in ((v, z), (w, z + 0.08))])
    rod, pivot, reach = 0.008, under - 0.035, p.board / 2 - 0.03
    seat = made.bodies["seat"] = Body("swing seat", p.material)
    height = min(p.seat, 0.5 * p.height)
    deep, thick = 0.09, 0.028
    edge = [
        (-deep, height - thick + 0.008),
        (-deep + 0.008, height - thick),
        (deep - 0.008, height - thick),
        (deep, height - thick + 0.008),
        (deep, height - 0.008),
        (deep - 0.008, height),
        (-deep + 0.008, height),
        (-deep, height - 0.008),
    ]
    seat.prism("board", edge, -p.board / 2, p.board / 2, axis="x")
    for s, side in ((-1, "left"), (1, "right")):
        u = s * reach
        seat.cylinder(f"rod_{side}", (u, 0, height), (u, 0, pivot - 0.012), rod, material=p.metal)
        seat.cylinder(f"eye_{side}", (u - 0.008, 0, pivot), (u + 0.008, 0, pivot), 0.012, material=p.metal)
        for t, end in ((-1, "a"), (1, "b")):
            a, b = sorted((u + t * 0.01, u + t * 0.06))
            body.box(f"lug_{side}_{end}", (a, -0.02, pivot - 0.015), (b, 0.02, under), material=p.metal)
    made.joints["seat"] = Joint("seat", "hinge", (0, 0, pivot), axis=(1, 0, 0), range=(-1.0, 1.0), damping=0.1, friction=0.05)
    made.places["seat"] = Place((0, 0, height), (2 * reach - 0.05, 2 * deep - 0.03), pivot - height, body="seat")
    return made


class PendulumParameters(Parameters):
    """A bob on a rod that swings in x and z before a stand."""

    length: float = Field(default=0.8, ge=0.15, le=3.0, description="from the hinge to the middle of the bob [m]")
    bob: float = Field(default=0.14, ge=0.06, le=0.25, description="diameter of the bob over the length")
    start_deg: float = Field(
        default=0.0, ge=-60.0, le=60.0, description="angle at which it hangs at first, to the right [degrees]"
    )
    lens: bool = Field(default=False, description="a lens-shaped bob, as of a clock, instead of a ball")
    weight: str = material("brass", "lead", "mild_steel", "cast_iron", of="bob")
    metal: str = material("stainless_steel", "mild_steel", of="rod")
    material: str = material("walnut", "oak", "mahogany", "mild_steel")


def _pendulum(p: PendulumParameters, rng: np.random.Generator) -> Made:
    body = Body("pendulum stand", p.material)
    made = Made.of(body)
    r = p.bob * p.length / 2
    base, post = 0.03 + 0.02 * p.length, 0.03 + 0.03 * p.length
    z = base + p.length + 1.6 * r
    reach, back = max(0.42, abs(math.sin(math.radians(p.start_deg)))) * p.length + r, 1.4 * r + 0.03
    rim = 0.006
    body.hull(
        "base",
        [
            (s * (reach - e), y, h)
            for s in (-1, 1)
            for e, h in ((0.0, 0.0), (0.0, base - rim), (rim, base))
            for y in (-2.2 * r - 0.03 + e, back + post + 0.06 - e)
        ],
    )
    top = z + 0.06 + 0.03 * p.length
    body.taper("post", (0, back + post / 2, base), (0, back + post / 2, top), (1.3 * post, post), (post, post))
    body.hull(
        "cap",
        [
            (s * 0.7 * post * g, back + post / 2 + t * 0.7 * post * g, h)
            for s in (-1, 1)
            for t in (-1, 1)
            for g, h in ((1.0, top), (1.0, top + 0.01), (0.5, top + 0.03))
        ],
    )
    u = 0.004 + 0.006 * p.length
    arm = z + 3.2 * u
    body.box("arm", (-1.5 * u, -2.5 * u, arm), (1.5 * u, back, arm + 0.02 + 0.01 * p.length))
    rod = made.bodies["bob"] = Body("pendulum", p.metal)
    swing = math.radians(p.start_deg)
    way = np.array([math.sin(swing), 0.0, -math.cos(swing)])
    pivot = np.array([0.0, 0.0, z])
    for s, side in ((-1, "front"), (1, "back")):
        a, b = sorted((s * (u + 0.001), s * (1.8 * u + 0.001)))
        body.box(f"lug_{side}", (-1.2 * u, a, z - 1.2 * u), (1.2 * u, b, arm), material=p.metal)
    rod.cylinder("eye", (0, -u, z), (0, u, z), 1.2 * u)
    thin = 0.55 * u
    start, end = pivot + 1.2 * u * way, pivot + (p.length - 0.9992 * r) * way
    rod.cylinder("rod", start, end, thin)
    center = pivot + p.length * way
    if p.lens:
        edge = 0.06 * r
        shape = [(0, -0.32 * r), (0.55 * r, -0.22 * r), (r, -edge), (r, edge), (0.55 * r, 0.22 * r), (0, 0.32 * r)]
        rod.turned("bob", shape, center, segments=32, euler=(math.pi / 2, math.pi / 2 - swing, 0), material=p.weight)
    else:
        rod.sphere("bob", center, r, material=p.weight)
    made.joints["bob"] = Joint(
        "bob",
        "hinge",
        (0, 0, z),
        axis=(0, -1, 0),
        range=(math.radians(-70) - swing, math.radians(70) - swing),
        damping=0.0005,
        friction=0.0,
    )
    return made


class CradleParameters(Parameters):
    """Newton's cradle: balls in a row, each on two rods, that knock against each other."""

    balls: int = Field(default=5, ge=3, le=7, description="balls")
    diameter: float = Field(default=0.05, ge=0.02, le=0.15, description="of a ball [m]")
    lifted: bool = Field(default=True, description="the ball at the left is lifted by 45 degrees at first")
    ball: str = material("stainless_steel", "brass", "mild_steel", of="balls")
    metal: str = material("stainless_steel", "brass", of="frame and rods")
    material: str = material("walnut", "oak", "mahogany")


def _cradle(p: CradleParameters, rng: np.random.Generator) -> Made:
    body = Body("cradle", p.material)
    made = Made.of(body)
    d = p.diameter
    pitch, base, wire = d + 1.1e-3, 0.4 * d, 0.03 * d
    z = base + 0.9 * d
    top, y, bar = z + LIFTED * pitch / math.sin(math.pi / 4), 1.1 * d, 0.12 * d
    edge = (p.balls - 1) / 2 * pitch
    reach = edge + 1.6 * d
    rail = y + 0.001 + bar
    c = 0.1 * d
    corners = [
        (s * (reach + 0.5 * d - e), t * (rail + 0.5 * d - e), h)
        for s in (-1, 1)
        for t in (-1, 1)
        for e, h in ((0.0, 0.0), (0.0, base - c), (c, base))
    ]
    body.hull("base", corners)
    for t, side in ((-1, "front"), (1, "back")):
        bend = 3 * bar
        up = [
            (-reach, base),
            *((-reach + bend - bend * math.cos(a), top - bend + bend * math.sin(a)) for a in np.linspace(0, math.pi / 2, 5)),
        ]
        path = [(u, t * rail, h) for u, h in up] + [(-u, t * rail, h) for u, h in reversed(up)]
        body.sweep(f"rail_{side}", path, circle(bar, 12), material=p.metal)
    for k in range(p.balls):
        name = f"ball_{k + 1}"
        x = (k - (p.balls - 1) / 2) * pitch
        hang = math.pi / 4 if p.lifted and k == 0 else 0.0
        ball = made.bodies[name] = Body("ball of a cradle", p.ball)
        cos, sin = math.cos(hang), math.sin(hang)

        def at(u: float, v: float, w: float, x: float = x, cos: float = cos, sin: float = sin) -> tuple[float, float, float]:
            """A point of the ball that hangs straight, turned about its hinge; w from the rails downwards."""
            return (x + cos * u - sin * w, v, top - cos * w - sin * u)

        ball.sphere("ball", at(0, 0, top - z), d / 2)
        eye, deep = 0.08 * d, top - z - d / 2
        ball.hull(
            "eye", [at(u, v, w) for u in (-eye, eye) for v in (-eye, eye) for w in (deep - 2 * eye, deep)], material=p.metal
        )
        for t, side in ((-1, "front"), (1, "back")):
            points = [
                at(u, t * v, w + g)
                for v, w, hs in ((eye, deep - eye, 0.5 * wire), (y, 0.0, 0.5 * wire))
                for u in (-0.5 * wire, 0.5 * wire)
                for g in (-hs, hs)
            ]
            ball.hull(f"rod_{side}", points, material=p.metal)
        made.joints[name] = Joint(name, "hinge", (x, 0, top), axis=(0, 1, 0), damping=0.0, friction=0.0)
    return made


GENERATORS = (
    Generator("seesaw", "seesaw: a plank with seats that rocks on a hinge", SeesawParameters, _seesaw,
              ("playground", "balance", "lever", "teeter", "garden", "children")),
    Generator("swing", "swing: a frame with a seat that hangs on rods and swings", SwingParameters, _swing,
              ("playground", "garden", "children", "pendulum")),
    Generator("pendulum", "pendulum: a bob on a rod that swings before a stand", PendulumParameters, _pendulum,
              ("clock", "physics", "science", "bob", "oscillation")),
    Generator("newtons_cradle", "Newton's cradle: balls in a row that hang on hinged rods and knock", CradleParameters, _cradle,
              ("newton", "cradle", "desk", "toy", "physics", "balls", "collision")),
)  # fmt: skip
