"""Things on walls: shelves, mirrors, pictures, clocks, curtain rods. Their back plane is y = 0, their lowest point z = 0."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
from pydantic import Field

from .cabinetry import pick
from .generator import Generator, Parameters, material
from .made import MAIN, Body, Joint, Made, Place
from .profiles import circle, inset, oval

__all__ = ["GENERATORS"]

Flat = list[tuple[float, float]]
WOODS = ("oak", "walnut", "pine", "birch", "mahogany")


def _moulding(kind: str, wide: float, deep: float) -> Flat:
    """Profile of a frame: u to the front from its back, v inwards from its outer edge [m]."""
    if kind == "flat":
        return [(0.0, 0.0), (0.0, wide), (0.8 * deep, wide), (deep, wide - 0.2 * deep), (deep, 0.1 * deep), (0.9 * deep, 0.0)]
    if kind == "cove":
        curve = [
            (deep * (1 - 0.55 * s), 0.25 * wide + 0.75 * wide * t) for s, t in ((0.0, 0.0), (0.6, 0.2), (0.9, 0.55), (1.0, 1.0))
        ]
        return [(0.0, 0.0), (0.0, wide), *curve[::-1], (deep, 0.06 * wide), (0.8 * deep, 0.0)]
    step = [
        (0.5 * deep, wide),
        (0.62 * deep, 0.8 * wide),
        (0.62 * deep, 0.66 * wide),
        (deep, 0.42 * wide),
        (deep, 0.24 * wide),
        (0.72 * deep, 0.1 * wide),
    ]
    return [(0.0, 0.0), (0.0, wide), *step, (0.72 * deep, 0.0)]


def _frame(body: Body, outline: Flat, profile: Flat, y: float) -> None:
    """A frame whose outer edge is an outline (x, z), walked counter-clockwise as seen from the front from its lower left corner on."""
    body.sweep("frame", [(x, y, z) for x, z in outline], profile, closed=True)


class PictureFrameParameters(Parameters):
    """A picture in a frame with a mount, which hangs on a hook and may swing."""

    width: float = Field(default=0.5, ge=0.15, le=1.5, description="along x with the frame [m]")
    height: float = Field(default=0.4, ge=0.15, le=1.2, description="along z with the frame [m]")
    frame: float = Field(default=0.035, ge=0.015, le=0.08, description="width of the frame [m]")
    mount: float = Field(default=0.05, ge=0.0, le=0.1, description="width of the mount between the frame and the picture [m]")
    moulding: Literal["varied", "flat", "cove", "stepped"] = Field(default="varied", description="profile of the frame")
    material: str = material("walnut", "oak", "brass", "mahogany", "pine", "abs")


def _picture_frame(p: PictureFrameParameters, rng: np.random.Generator) -> Made:
    body, hook = Body("picture", p.material), Body("hook", "mild_steel", motion="static")
    made = Made({MAIN: body, "hook": hook})
    x, tall, least = p.width / 2, p.height, min(p.width, p.height)
    wide, deep, back = min(p.frame, 0.16 * least), 0.024, -0.0015
    profile = _moulding(pick(p.moulding, rng, "flat", "cove", "stepped"), wide, deep)
    _frame(body, [(-x, 0.0), (x, 0.0), (x, tall), (-x, tall)], profile, back)
    inner, low, high, face = x - wide, wide, tall - wide, back - 0.0105
    body.box("panel", (-inner, back - 0.0095, low), (inner, back - 0.0075, high), material="cardboard")
    mount = min(p.mount, 0.16 * least)
    front = back - 0.0095
    if mount > 0.004:
        far = [(-inner, low), (inner, low), (inner, high), (-inner, high)]
        near = [
            (-inner + mount, low + mount),
            (inner - mount, low + mount),
            (inner - mount, high - mount),
            (-inner + mount, high - mount),
        ]
        for number in range(4):
            quad = [far[number - 1], far[number], near[number], near[number - 1]]
            body.prism(f"mount_{number + 1}", quad, face - 0.0005, front, axis="y", material="cotton")
        inner, low, high = inner - mount, low + mount, high - mount
    _landscape(body, (-inner, inner, low, high), (face, front), rng)
    z = tall - wide - 0.02
    hook.box("plate", (-0.012, -0.004, z - 0.01), (0.012, 0.0, z + 0.01))
    hook.box("lip", (-0.008, -0.0065, z - 0.01), (0.008, -0.004, z - 0.007))
    made.joints["hanging"] = Joint(
        MAIN, "hinge", (0, -0.003, z), "hook", axis=(0, 1, 0), range=(-0.5, 0.5), damping=0.003, friction=0.002
    )
    return made


def _landscape(
    body: Body, rect: tuple[float, float, float, float], depths: tuple[float, float], rng: np.random.Generator
) -> None:
    """A picture of hills before each other under a sky, of pieces of cloth and paper."""
    x0, x1, z0, z1 = rect
    count, points = int(rng.integers(2, 5)), 9
    across = np.linspace(x0, x1, points)
    lower = [(x0, z0), (x1, z0)]
    levels = np.sort(rng.uniform(0.15, 0.75, count)) + 0.02 * np.arange(count)
    stuffs = [str(s) for s in rng.permutation(["felt", "leather", "carpet", "cardboard", "wool", "books"])]
    for number, level in enumerate(levels):
        wave = 0.05 * np.sin(rng.uniform(0, 6) + np.linspace(0, rng.uniform(2, 7), points)) + rng.uniform(-0.012, 0.012, points)
        heights = z0 + (z1 - z0) * np.clip(level + wave, 0.05, 0.93)
        before = np.interp(across, [a for a, _ in lower], [b for _, b in lower])
        heights = np.maximum(heights, before + 0.004 * (z1 - z0))
        upper = [
            (float(a), float(min(z, z1 - 0.002 * (z1 - z0) * (count - number)))) for a, z in zip(across, heights, strict=True)
        ]
        body.prism(f"hill_{number + 1}", [*lower, *upper[::-1]], *depths, axis="y", material=stuffs[number])
        lower = upper
    body.prism("sky", [*lower, (x1, z1), (x0, z1)], *depths, axis="y", material=("linen", "cotton", "silk")[int(rng.integers(3))])


class WallMirrorParameters(Parameters):
    """A mirror: silvered glass in a frame, with straight, arched or round outline."""

    width: float = Field(default=0.6, ge=0.25, le=1.2, description="along x with the frame [m]")
    height: float = Field(default=0.9, ge=0.3, le=1.9, description="along z with the frame [m]; a round one is as high as wide")
    frame: float = Field(default=0.045, ge=0.015, le=0.09, description="width of the frame [m]")
    outline: Literal["varied", "square", "arched", "oval", "round"] = Field(default="varied", description="of the mirror")
    moulding: Literal["varied", "flat", "cove", "stepped"] = Field(default="varied", description="profile of the frame")
    material: str = material("walnut", "oak", "brass", "mahogany", "stainless_steel", "pine")


def _wall_mirror(p: WallMirrorParameters, rng: np.random.Generator) -> Made:
    body, kind = Body("mirror", p.material), pick(p.outline, rng, "square", "arched", "oval", "round")
    x, tall = p.width / 2, p.height if kind != "round" else p.width
    wide, deep = min(p.frame, 0.12 * min(p.width, tall)), 0.026
    profile = _moulding(pick(p.moulding, rng, "flat", "cove", "stepped"), wide, deep)
    if kind == "square":
        outline = [(-x, 0.0), (x, 0.0), (x, tall), (-x, tall)]
    elif kind == "arched":
        rise = min(0.9 * x, 0.4 * tall)
        outline = [
            (-x, 0.0),
            (x, 0.0),
            *((x * math.cos(a), tall - rise + rise * math.sin(a)) for a in np.linspace(0, math.pi, 17)),
        ]
    else:
        turn = oval(p.width, tall, 28, middle=tall / 2)
        first = min(range(28), key=lambda k: (round(turn[k][1], 6), turn[k][0]))
        outline = turn[first:] + turn[:first]
    _frame(body, outline, profile, 0.0)
    pane = inset(outline, wide)
    body.prism("silvering", pane, -0.007, -0.006, axis="y", material="aluminium_alloy")
    body.prism("glass", pane, -0.011, -0.007, axis="y", material="soda_lime_glass")
    body.prism("back", pane, -0.006, 0.0, axis="y", material="mdf")
    return Made.of(body)


class WallClockParameters(Parameters):
    """A wall clock: case, dial with marks, hands, and a case with a swinging pendulum below if wanted."""

    diameter: float = Field(default=0.3, ge=0.18, le=0.6, description="of the dial's case [m]")
    hours: float = Field(default=10.15, ge=0.0, le=12.0, description="time that the hands show [h]")
    pendulum: bool = Field(default=False, description="a long case with a pendulum under the dial")
    case: Literal["varied", "round", "octagon"] = Field(default="varied", description="outline about the dial")
    metal: str = material("brass", "stainless_steel", "bronze", of="pendulum and rim")
    hand: str = material("abs", "brass", "mild_steel", of="hands and marks")
    dial: str = material("porcelain", "polystyrene", "aluminium_alloy", "birch", of="the dial")
    material: str = material("oak", "walnut", "mahogany", "abs", "mild_steel")


def _wall_clock(p: WallClockParameters, rng: np.random.Generator) -> Made:
    body, made = (own := Body("wall clock", p.material)), Made.of(own)
    radius, deep = p.diameter / 2, 0.05
    segments = 8 if pick(p.case, rng, "round", "octagon") == "octagon" else 32
    lowest = radius * (math.cos(math.pi / 8) if segments == 8 else 1.0)
    drop = 0.85 * p.diameter if p.pendulum else 0.0
    center = drop + lowest
    rim = max(0.016, 0.1 * radius)
    dial, at = radius - rim, (0, 0, center)
    ring = [(dial, 0.0), (radius, 0.0), (radius, deep - 0.012), (radius - 0.5 * rim, deep), (dial, deep - 0.006)]
    tilt = (math.pi / 2, math.pi / 8, 0) if segments == 8 else (math.pi / 2, 0, 0)
    body.turned("case", ring, at, segments=segments, euler=tilt)
    body.turned("dial", [(0, 0), (dial, 0), (dial, 0.02), (0, 0.02)], at, segments=segments, euler=tilt, material=p.dial)
    front = -0.02
    for number in range(12):
        a = math.tau * number / 12
        long, wide = (0.16, 0.05) if number % 3 == 0 else (0.09, 0.03)
        radial, side = (math.sin(a), math.cos(a)), (math.cos(a), -math.sin(a))
        reach = 0.86 * dial * (0.98 if segments == 8 else 1.0)
        quad = [
            (radial[0] * r + side[0] * w, center + radial[1] * r + side[1] * w)
            for r, w in ((reach - long * dial, -wide * dial / 2), (reach, -wide * dial / 2), (reach, wide * dial / 2), (reach - long * dial, wide * dial / 2))
        ]  # fmt: skip
        body.prism(f"mark_{number + 1}", quad, front - 0.0015, front, axis="y", material=p.hand)
    _hands(body, p, dial, center)
    if p.pendulum:
        start = math.pi / 8 if segments == 8 else 0.0
        corners = [
            (radius * math.sin(a), center - radius * math.cos(a)) for a in start + math.tau * np.arange(segments) / segments
        ]
        half = 0.93 * radius if segments == 8 else 0.71 * radius
        edge = sorted(q for q in corners if q[1] < center and abs(q[0]) < half)
        x, top = edge[-1][0], drop - 0.014
        body.prism("neck", [(-x, top), (x, top), *edge[::-1]], 0.012 - deep, 0.0, axis="y")
        _pendulum_case(made, p, (x, top, 0.02))
    return made


def _hands(body: Body, p: WallClockParameters, dial: float, center: float) -> None:
    """Hands at the time, the minute hand over the hour hand, on a pin."""
    y = -0.0205
    body.cylinder("pin", (0, -0.02, center), (0, -0.023, center), 0.03 * dial, material=p.hand)
    hands = (("hour", p.hours / 12, 0.5, 0.05, -0.023), ("minute", p.hours % 1.0, 0.8, 0.034, -0.025))
    for name, share, long, wide, y in hands:
        a = math.tau * share
        radial, side = (math.sin(a), math.cos(a)), (math.cos(a), -math.sin(a))
        shape = ((-0.14, -0.5), (0.0, -0.7), (0.75 * long, -0.4), (long, 0.0), (0.75 * long, 0.4), (0.0, 0.7), (-0.14, 0.5))
        points = [
            (dial * (radial[0] * r + side[0] * w * wide), center + dial * (radial[1] * r + side[1] * w * wide)) for r, w in shape
        ]
        body.prism(f"{name}_hand", points, y - 0.002, y, axis="y", material=p.hand)
    body.cylinder("cap", (0, -0.027, center), (0, -0.03, center), 0.035 * dial, material=p.hand)


def _pendulum_case(made: Made, p: WallClockParameters, extent: tuple[float, float, float]) -> None:
    """A case from half its width and the heights of its top and its floor [m], open to the front, with a pendulum on a hinge."""
    (x, top, low), body, deep, t = extent, made.main, 0.07, 0.012
    body.box("box_back", (-x, -0.008, low), (x, 0.0, top))
    for side, a in (("left", -x), ("right", x - t)):
        body.box(f"box_{side}", (a, -deep, low + t), (a + t, -0.008, top))
    body.box("box_floor", (-x, -deep, low), (x, -0.008, low + t))
    body.hull(
        "box_base",
        [(a, b, low) for a in (-x, x) for b in (-deep, 0.0)]
        + [(a, b, low - 0.02) for a in (-0.6 * x, 0.6 * x) for b in (-0.7 * deep, 0.0)],
    )
    body.box("box_head", (-x + t, -deep, top - t), (x - t, -0.008, top))
    bob = made.bodies["pendulum"] = Body("pendulum", p.metal)
    hang, radius = top - t - 0.004, min(0.5 * (x - t), 0.2 * (top - low))
    body.cylinder("suspension", (0, -0.008, hang), (0, -0.036, hang), 0.002, material=p.metal)
    foot = low + t + 0.012 + radius
    bob.cylinder("rod", (0, -0.04, hang), (0, -0.04, foot + radius), 0.0025)
    disc = [(0, -0.006), (0.6 * radius, -0.006), (radius, -0.0025), (radius, 0.0025), (0.6 * radius, 0.006), (0, 0.006)]
    bob.turned("bob", disc, (0, -0.04, foot), segments=32, euler=(math.pi / 2, 0, 0))
    swing = 0.6 * math.asin(min(0.9, (x - t - radius - 0.004) / (hang - foot)))
    made.joints["pendulum"] = Joint(
        "pendulum", "hinge", (0, -0.04, hang), MAIN, axis=(0, 1, 0), range=(-swing, swing), damping=0.0001
    )


class WallShelfParameters(Parameters):
    """A shelf on brackets."""

    width: float = Field(default=0.8, ge=0.3, le=1.8, description="along x [m]")
    depth: float = Field(default=0.22, ge=0.12, le=0.35, description="along y [m]")
    board: float = Field(default=0.024, ge=0.015, le=0.045, description="thickness of the board [m]")
    drop: float = Field(default=0.17, ge=0.1, le=0.26, description="height of the brackets [m]")
    brackets: Literal["varied", "iron", "wood", "scroll"] = Field(default="varied", description="kind of brackets")
    lip: bool = Field(default=False, description="a rail at the front edge")
    metal: str = material("mild_steel", "cast_iron", "brass", of="brackets of iron")
    material: str = material(*WOODS)


def _wall_shelf(p: WallShelfParameters, rng: np.random.Generator) -> Made:
    body, made = (own := Body("wall shelf", p.material)), Made.of(own)
    x, reach, kind = p.width / 2, 0.82 * p.depth, pick(p.brackets, rng, "iron", "wood", "scroll")
    top = p.drop + p.board
    edge = min(0.25 * p.board, 0.006)
    rim = [(-p.depth, p.drop), (0.0, p.drop), (0.0, top), (-p.depth + edge, top), (-p.depth, top - edge)]
    body.prism("board", rim, -x, x, axis="x")
    count = 2 if p.width < 1.1 else 3
    for number in range(count):
        a = (2 * number / (count - 1) - 1) * (x - 0.12 * p.width)
        if kind == "wood":
            angles = np.linspace(0.0, math.pi / 2, 8)[1:-1]
            curve = [(-0.86 * reach * math.cos(t), p.drop - 0.95 * p.drop * math.sin(t) - 0.02) for t in angles]
            shape = [(0.0, p.drop), (-reach, p.drop), (-reach, p.drop - 0.025)]
            shape += [*((b, c) for b, c in curve if b < -0.032 and c > 0.002), (-0.03, 0.0), (0.0, 0.0)]
            body.prism(f"bracket_{number + 1}", shape, a - 0.012, a + 0.012, axis="x")
            continue
        body.box(f"plate_{number + 1}", (a - 0.014, -0.004, 0.0), (a + 0.014, 0.0, p.drop), material=p.metal)
        body.box(f"arm_{number + 1}", (a - 0.014, -reach, p.drop - 0.004), (a + 0.014, -0.004, p.drop), material=p.metal)
        for spot, z in enumerate((0.25 * p.drop, 0.7 * p.drop), start=1):
            body.sphere(f"screw_{number + 1}_{spot}", (a + 0.008, -0.0075, z), 0.0035, material=p.metal)
        _brace(body, f"brace_{number + 1}", a - 0.004, (reach, p.drop), p.metal, curved=kind == "scroll")
    if p.lip:
        body.box("lip", (-x, -p.depth + edge, top), (x, -p.depth + edge + 0.01, top + 0.025))
    made.places["top"] = Place((0, -p.depth / 2, top), (p.width, p.depth - 0.03))
    return made


def _brace(body: Body, name: str, x: float, size: tuple[float, float], metal: str, *, curved: bool) -> None:
    """A strut from the foot of a bracket's plate to the end of its arm, straight or bent to an S, cut flush at both."""
    (reach, drop), bar = size, [(-0.004, -0.003), (0.004, -0.003), (0.004, 0.003), (-0.004, 0.003)]
    low, far = 0.022, -0.8 * reach
    way = [(-0.004, low), (-0.016, low)]
    if curved:
        way += [(0.45 * far, low + 0.06 * drop), (0.6 * far, 0.4 * drop), (0.72 * far, 0.74 * drop)]
    path = [(x, b, z) for b, z in (*way, (far, drop - 0.018), (far, drop - 0.004))]
    body.sweep(name, path, bar, material=metal)


class CurtainRodParameters(Parameters):
    """A curtain rod on brackets with finials, and rings that slide on it."""

    width: float = Field(default=1.6, ge=0.6, le=3.0, description="along x between the finials [m]")
    rod: float = Field(default=0.025, ge=0.016, le=0.035, description="diameter of the rod [m]")
    reach: float = Field(default=0.09, ge=0.06, le=0.15, description="of the rod before the wall [m]")
    rings: int = Field(default=6, ge=0, le=8, description="rings")
    ends: Literal["varied", "ball", "spear", "disc"] = Field(default="varied", description="finials")
    metal: str = material("brass", "mild_steel", "stainless_steel", of="brackets and rings")
    material: str = material("oak", "brass", "walnut", "mild_steel", "birch")


def _curtain_rod(p: CurtainRodParameters, rng: np.random.Generator) -> Made:
    body, made = (own := Body("curtain rod", p.material)), Made.of(own)
    radius, x, kind = p.rod / 2, p.width / 2, pick(p.ends, rng, "ball", "spear", "disc")
    big = 1.7 * radius
    z = max(0.05, big)
    body.cylinder("rod", (-x, -p.reach, z), (x, -p.reach, z), radius)
    for side, sign in (("left", -1), ("right", 1)):
        turn, end = (0, sign * math.pi / 2, 0), (sign * x, -p.reach, z)
        shape = {
            "ball": [
                (0, 0),
                (0.8 * radius, 0),
                *((big * math.sin(a), big * (1 - math.cos(a))) for a in (0.6, 1.0, 1.57, 2.1, 2.6)),
                (0, 2 * big),
            ],
            "spear": [(0, 0), (0.9 * big, 0), (big, 0.5 * big), (0.5 * big, 2.6 * big), (0, 3.6 * big)],
            "disc": [(0, 0), (1.2 * radius, 0), (big, 0.3 * big), (big, 0.6 * big), (0, 0.9 * big)],
        }[kind]
        body.turned(f"finial_{side}", shape, end, segments=28, euler=turn)
        _bracket(body, f"bracket_{side}", (sign * (x - 0.08), p.reach, z), radius, p.metal)
    if p.width > 2.0:
        _bracket(body, "bracket_middle", (0.0, p.reach, z), radius, p.metal)
    count = min(p.rings, int((p.width - 0.3) / 0.06))
    for number in range(count):
        pitch = (p.width - 0.26) / count
        a = -x + 0.13 + pitch * (number + 0.5)
        if p.width > 2.0 and abs(a) < 0.02:
            continue
        ring = made.bodies[f"ring_{number + 1}"] = Body("curtain ring", p.metal)
        inner, thick = radius + 0.007, 0.002
        at = z - ((inner + thick) * math.cos(math.pi / 12) - 1.15 * thick - radius - 0.001)
        path = [
            (a, -p.reach + (inner + thick) * math.cos(t), at + (inner + thick) * math.sin(t))
            for t in math.tau * np.arange(12) / 12
        ]
        ring.sweep("loop", path, circle(thick, 6), closed=True)
        way = 0.5 * pitch - 0.006 if not p.width > 2.0 else min(0.5 * pitch - 0.006, max(0.0, abs(a) - 0.02))
        made.joints[f"ring_{number + 1}"] = Joint(
            f"ring_{number + 1}",
            "slide",
            (a, -p.reach, z + radius + 0.0005),
            MAIN,
            axis=(1, 0, 0),
            range=(-way, way),
            damping=0.5,
            friction=0.3,
        )
    return made


def _bracket(body: Body, name: str, at: tuple[float, float, float], radius: float, metal: str) -> None:
    """A plate on the wall, and an arm that bends under the rod and bears it in a saddle; `at`: x, reach of the rod, its height [m]."""
    x, reach, z = at
    body.turned(
        f"{name}_plate",
        [(0, 0), (0.026, 0), (0.022, 0.006), (0, 0.006)],
        (x, 0, z - radius - 0.014),
        segments=24,
        euler=(math.pi / 2, 0, 0),
        material=metal,
    )
    body.cylinder(f"{name}_arm", (x, -0.006, z - radius - 0.014), (x, -reach - 0.006, z - radius - 0.014), 0.006, material=metal)
    body.box(
        f"{name}_saddle", (x - 0.006, -reach - 0.01, z - radius - 0.008), (x + 0.006, -reach + 0.01, z - radius), material=metal
    )


GENERATORS = (
    Generator(
        "picture_frame", "framed picture that hangs on a hook on a wall, its back plane is y = 0; it swings", PictureFrameParameters, _picture_frame,
        ("painting", "art", "photograph", "wall", "decoration"), stands=False,
    ),
    Generator(
        "wall_mirror", "mirror on a wall, its back plane is y = 0", WallMirrorParameters, _wall_mirror,
        ("looking", "glass", "bathroom", "hall", "decoration"), "static", stands=False,
    ),
    Generator(
        "wall_clock", "clock on a wall, its back plane is y = 0; a pendulum swings", WallClockParameters, _wall_clock,
        ("time", "regulator", "pendulum", "hall", "kitchen", "decoration"), "static", stands=False,
    ),
    Generator(
        "wall_shelf", "shelf on brackets on a wall, its back plane is y = 0", WallShelfParameters, _wall_shelf,
        ("shelves", "bracket", "board", "storage", "workshop", "kitchen", "furniture"), "static", stands=False,
    ),
    Generator(
        "curtain_rod", "curtain rod on a wall, its back plane is y = 0; rings slide on it", CurtainRodParameters, _curtain_rod,
        ("curtain", "pole", "window", "rail"), "static", stands=False,
    ),
)  # fmt: skip
