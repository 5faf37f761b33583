"""Carts and wheelbarrows with wheels that turn."""

from __future__ import annotations

from typing import Literal

import numpy as np
from pydantic import Field

from .generator import Generator, Parameters, material
from .made import Body, Joint, Made, Place
from .profiles import mitred
from .wheels import Axle, spoked

__all__ = ["GENERATORS"]


class CartParameters(Parameters):
    """A cart of wood that faces the front (-y), with shafts and props, or with four wheels and a pole."""

    length: float = Field(default=1.8, ge=1.0, le=3.0, description="of the bed along y [m]")
    width: float = Field(default=1.0, ge=0.7, le=1.6, description="of the bed along x [m]")
    wheels: Literal["two", "four"] = Field(default="two", description="wheels")
    wheel: float = Field(default=0.48, ge=0.3, le=0.7, description="radius of a wheel, less where four would touch [m]")
    spokes: int = Field(default=10, ge=6, le=12, description="of a wheel")
    sides: float = Field(default=0.32, ge=0.1, le=0.6, description="height of the side boards [m]")
    tyre: str = material("mild_steel", "cast_iron", of="tyres")
    material: str = material("oak", "ash", "pine", "beech")


def _cart(p: CartParameters, rng: np.random.Generator) -> Made:
    body = Body("cart", p.material)
    made = Made.of(body)
    two, half, wide = p.wheels == "two", p.length / 2, 0.07
    if not two:
        p = p.model_copy(update={"wheel": min(p.wheel, 0.32 * p.length - 0.02)})
    lift = _wheel_height(p)
    x = p.width / 2 + 0.03 + 0.75 * wide
    beam, sill, board = 0.09, 0.08, 0.028
    ys = {"axle": 0.0} if two else {"front": -0.32 * p.length, "back": 0.32 * p.length}
    reach = x - 0.75 * wide - 0.004
    for name, y in ys.items():
        body.box(f"beam_{name}", (-reach, y - beam / 2, lift - beam / 2), (reach, y + beam / 2, lift + beam / 2))
        for s, side in ((-1, "left"), (1, "right")):
            wheel = Body("wheel", p.material)
            spoked(wheel, Axle((s * x, y, lift)), p.wheel, wide, p.spokes, wood=p.material, tyre=p.tyre)
            key = f"wheel_{side}" if two else f"wheel_{name}_{side}"
            made.bodies[key] = wheel
            made.joints[key] = Joint(key, "hinge", (s * x, y, lift), axis=(1, 0, 0), damping=0.005, friction=0.01)
    shift = -0.06 if two else 0.0
    z = lift + beam / 2
    front, back = shift - half, shift + half
    for s, side in ((-1, "left"), (1, "right")):
        u = s * 0.3 * p.width
        body.box(f"sill_{side}", (u - 0.035, front, z), (u + 0.035, back, z + sill))
    deck = z + sill
    count = max(5, round(p.length / 0.16))
    worn = [float(v) for v in rng.uniform(0.001, 0.004, count)]  # off their edges: tops are flush, so that loads stand on several
    for k in range(count):
        a, b = front + p.length * k / count, front + p.length * (k + 1) / count
        high = (p.width / 2, b - worn[k] * (k < count - 1), deck + board)
        body.box(f"floor_{k + 1}", (-p.width / 2, a + worn[k] * (k > 0), deck), high)
    _sides(body, p, (front, back), deck, board)
    if two:
        _shafts(body, p, front, z, sill)
    else:
        tip = front - 1.1
        body.hull(
            "pole",
            [
                (w, v, h)
                for v, r, m in ((front, 0.035, z + 0.04), (tip, 0.025, z - 0.06))
                for w in (-r, r)
                for h in (m - r, m + r)
            ],
        )
        body.box("crossbar", (-0.3 * p.width + 0.035, front, z), (0.3 * p.width - 0.035, front + 0.06, z + sill))
        body.box("swingletree", (-0.4, tip - 0.045, z - 0.085), (0.4, tip, z - 0.035))
    middle = front + (count // 2 + 0.5) * p.length / count  # of a board
    made.places["bed"] = Place((0, middle, deck + board), (p.width - 0.1, p.length - 0.1))
    return made


def _wheel_height(p: CartParameters) -> float:
    probe = Body("", p.material)
    return spoked(probe, Axle((0, 0, 0)), p.wheel, 0.07, p.spokes, wood=p.material, tyre=p.tyre)


def _sides(body: Body, p: CartParameters, ends: tuple[float, float], deck: float, board: float) -> None:
    """Stakes at the outer edges of the bed, boards on their inside, a board at the front, a tailboard."""
    front, back = ends
    x, top = p.width / 2, deck + p.sides + 0.03
    stakes = 4
    rows = max(1, round(p.sides / 0.16))
    for s, side in ((-1, "left"), (1, "right")):
        for k in range(stakes):
            y = front + 0.05 + (p.length - 0.1) * k / (stakes - 1)
            a, b = sorted((s * x, s * (x + 0.024)))
            body.box(f"stake_{side}_{k + 1}", (a, y - 0.03, deck - 0.06), (b, y + 0.03, top + 0.03))
        for j in range(rows):
            a, b = sorted((s * x, s * (x - 0.022)))
            low = deck + board + 0.004 * (j > 0) + p.sides * j / rows
            body.box(f"side_{side}_{j + 1}", (a, front, low), (b, back, deck + board + p.sides * (j + 1) / rows))
    inner = x - 0.022
    for end, (a, b) in {"front": (front, front + 0.022), "tail": (back - 0.022, back)}.items():
        body.box(f"{end}board", (-inner, a, deck + board), (inner, b, deck + board + p.sides))
        for k, share in enumerate((0.25, 0.75), start=1):
            u = -inner + 2 * inner * share
            c, d = (a - 0.02, a) if end == "front" else (b, b + 0.02)
            body.box(f"{end}cleat_{k}", (u - 0.035, c, deck), (u + 0.035, d, deck + board + p.sides))


def _shafts(body: Body, p: CartParameters, front: float, z: float, sill: float) -> None:
    """Two shafts in front of the sills, tied by a bar, on props that keep the bed level."""
    long = 0.9 + 0.35 * p.length
    tip = front - long
    for s, side in ((-1, "left"), (1, "right")):
        u = s * 0.3 * p.width
        points = [
            (u + w, y, h)
            for y, r, m in ((front, 0.035, z + sill / 2), (tip, 0.024, z + sill / 2))
            for w in (-r, r)
            for h in (m - r, m + r)
        ]
        body.hull(f"shaft_{side}", points)
        y = front - 0.55 * long
        spread = 0.03
        heads = [
            (u + w, v, z + sill / 2 - 0.035 + (0.011) * (front - v) / long)
            for w in (-0.02, 0.02)
            for v in (y - spread, y + spread)
        ]
        feet = [(u + w, v, 0.0) for w in (-0.02, 0.02) for v in (y - spread - 0.05, y + spread - 0.05)]
        body.hull(f"prop_{side}", [*heads, *feet])
    inner = 0.3 * p.width - 0.035
    body.box("tie", (-inner, front - 0.06, z + 0.01), (inner, front, z + sill - 0.01))
    y = front - 0.3 * long
    rest = z + sill / 2 + 0.035 - 0.011 * (0.3 * long - 0.05) / long
    body.box("singletree", (-0.3 * p.width - 0.06, y, rest), (0.3 * p.width + 0.06, y + 0.05, rest + 0.04))


class WheelbarrowParameters(Parameters):
    """A barrow with a wheel at the front (-y), a flared tray, legs and handles."""

    length: float = Field(default=0.85, ge=0.6, le=1.1, description="of the tray at its rim [m]")
    width: float = Field(default=0.62, ge=0.45, le=0.8, description="of the tray at its rim [m]")
    depth: float = Field(default=0.26, ge=0.15, le=0.4, description="of the tray [m]")
    wheel: float = Field(default=0.2, ge=0.16, le=0.26, description="radius of the wheel [m]")
    frame: str = material("ash", "beech", "oak", "mild_steel", of="frame and wheel")
    tyre: str = material("natural_rubber", "mild_steel", of="tyre")
    material: str = material("mild_steel", "pine", "oak", "polyethylene")


def _wheelbarrow(p: WheelbarrowParameters, rng: np.random.Generator) -> Made:
    body = Body("wheelbarrow", p.frame)
    made = Made.of(body)
    wheel = made.bodies["wheel"] = Body("wheel", p.frame)
    wide = 0.05
    probe = spoked(Body("", p.frame), Axle((0, 0, 0)), p.wheel, wide, 8, wood=p.frame, tyre=p.tyre)
    rail, tray = probe + 0.12, 0.02 if p.material in ("pine", "oak") else 0.005
    floor = (0.62 * p.length, 0.6 * p.width)
    y0 = -floor[0] / 2
    y = y0 - 0.12 - p.wheel
    spoked(wheel, Axle((0, y, probe)), p.wheel, wide, 8, wood=p.frame, tyre=p.tyre)
    made.joints["wheel"] = Joint("wheel", "hinge", (0, y, probe), axis=(1, 0, 0), damping=0.002, friction=0.005)
    front, back = y - 0.1, floor[0] / 2 + 0.45
    near, far, h = 0.085, 0.27, 0.022

    def at(v: float) -> float:
        return near + (far - near) * (v - front) / (back - front)

    for s, side in ((-1, "left"), (1, "right")):
        body.hull(f"rail_{side}", [(s * at(v) + w, v, z) for v in (front, back) for w in (-h, h) for z in (rail - 0.05, rail)])
        points = [(s * at(v) + w * r, v, rail - 0.025 + u * r) for v, r in ((back, 0.016), (back + 0.02, 0.02), (back + 0.12, 0.018), (back + 0.13, 0.012))
                  for w, u in ((1, 0), (0.7, 0.7), (0, 1), (-0.7, 0.7), (-1, 0), (-0.7, -0.7), (0, -1), (0.7, -0.7))]  # fmt: skip
        body.hull(f"grip_{side}", points)
        c = at(y)
        body.hull(
            f"fork_{side}",
            [
                (s * c + w, y + v, z)
                for w in (-0.012, 0.012)
                for v, z in ((-0.05, rail - 0.05), (0.05, rail - 0.05), (-0.025, probe - 0.03), (0.025, probe - 0.03))
            ],
        )
        body.cylinder(f"axle_{side}", (s * (c - 0.012), y, probe), (s * (0.75 * wide + 0.001), y, probe), 0.01)
        leg = floor[0] / 2 + 0.02
        body.hull(
            f"leg_{side}",
            [
                (s * (at(leg) + e) + w, v, z)
                for z, e, vs in ((rail - 0.09, 0.0, (leg - 0.03, leg + 0.03)), (0.0, 0.04, (leg + 0.01, leg + 0.045)))
                for w in (-0.018, 0.018)
                for v in vs
            ],
        )
    for k, v in enumerate((y0 + 0.03, floor[0] / 2 - 0.01), start=1):
        reach = at(v) + 0.03
        body.box(f"bar_{k}", (-reach, v, rail - 0.09), (reach, v + 0.06, rail - 0.05))
    low = (-floor[1] / 2, y0, floor[1] / 2, floor[0] / 2)
    top = (-p.width / 2, y0 - 0.3 * p.length, p.width / 2, floor[0] / 2 + 0.08 * p.length)
    body.box("tray_floor", (low[0], low[1], rail), (low[2], low[3], rail + tray), material=p.material)
    for side, points in mitred(low, top, (rail + tray, rail + tray + p.depth), tray * 1.4).items():
        body.hull(f"tray_{side}", points, material=p.material)
    z, r = rail + tray + p.depth, tray * 1.4 + 0.012
    outer = (top[0] - 0.012, top[1] - 0.012, top[2] + 0.012, top[3] + 0.012)
    for side, points in mitred(outer, outer, (z, z + 0.016), r).items():
        body.hull(f"rim_{side}", points, material=p.material)
    made.places["tray"] = Place((0, 0, rail + tray), (floor[1] - 0.06, floor[0] - 0.06))
    return made


GENERATORS = (
    Generator("cart", "cart with two or four spoked wheels that turn, side boards, shafts or a pole", CartParameters, _cart,
              ("wagon", "farm", "village", "market", "vehicle", "wood", "handcart")),
    Generator("wheelbarrow", "wheelbarrow with a wheel that turns, a flared tray, legs and handles", WheelbarrowParameters, _wheelbarrow,
              ("garden", "farm", "building", "barrow", "vehicle")),
)  # fmt: skip
