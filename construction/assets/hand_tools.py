"""Hammers, saws, screwdrivers, spanners, axes, anvils: hand tools, lying on their side with the handle to the left."""

from __future__ import annotations

import itertools
import math
from typing import Literal

import numpy as np
from pydantic import Field

from .generator import Generator, Parameters, material
from .made import Body, Made, Place
from .profiles import circle, rounded
from .turning import curve, lying, moved, solid

__all__ = ["GENERATORS"]


class HammerParameters(Parameters):
    """A hammer: a head with a face and a claw or a peen, and a wooden handle."""

    length: float = Field(default=0.32, ge=0.22, le=0.42, description="[m]")
    head: float = Field(default=0.115, ge=0.08, le=0.14, description="length of the head [m]")
    form: Literal["claw", "peen", "sledge"] = Field(default="claw", description="what is opposite the face")
    handle: str = material("ash", "beech", "oak", "abs", of="the handle")
    material: str = material("mild_steel", "cast_iron", "stainless_steel")


def _hammer(p: HammerParameters, rng: np.random.Generator) -> Made:
    body = Body("hammer", p.material)
    thick = 0.026 if p.form != "sledge" else 0.044
    z, eye = thick / 2, 0.2 * p.head
    right = p.length / 2
    left, reach = right - 1.1 * eye, max(0.6 * eye, 0.0128)
    body.prism("eye", [(x + (left + right) / 2, y) for x, y in rounded(right - left, 2 * reach, 0.004, 2)], 0, thick)
    r = 0.46 * thick
    if p.form == "sledge":
        for name, s in (("front", -1), ("back", 1)):
            ends = [(reach, 0.85 * z), (p.head / 2 - 0.006, 0.98 * z), (p.head / 2, 0.8 * z)]
            outline = [(w, s * y) for y, w in ends]
            body.turned(
                f"face_{name}",
                solid(outline if s > 0 else outline[::-1]),
                ((left + right) / 2, 0, z),
                segments=8,
                euler=(-math.pi / 2, math.pi / 8, 0),
            )
    else:
        middle = (left + right) / 2
        neck, face = 0.62 * r, 0.45 * p.head
        outline = [
            (neck, reach),
            (neck, reach + 0.3 * (face - reach)),
            (r, reach + 0.45 * (face - reach)),
            (r, face - 0.002),
            (0.85 * r, face),
        ]
        body.turned("face", solid(outline[:2]), (middle, 0, z), segments=24, euler=(-math.pi / 2, 0, 0))
        body.turned("poll", solid(outline[1:]), (middle, 0, z), segments=24, euler=(-math.pi / 2, 0, 0))
        _back(body, p, (left, right), reach, thick)
    wide, end = 0.022, -p.length / 2
    path = [(left, 0, 0.012), (left - 0.2 * p.length, 0, 0.012), (end + 0.12, 0, 0.012), (end + 0.03, 0, 0.012), (end, 0, 0.012)]
    scale = float(rng.uniform(0.78, 0.92))
    rows = [(1.0, path[0][0]), (scale, path[1][0]), (1.15, path[2][0]), (1.3, path[3][0]), (1.15, path[4][0])]
    for number, ((s0, x0), (s1, x1)) in enumerate(itertools.pairwise(rows), start=1):
        points = [(x, y * s, q * 0.85 + 0.011) for x, s in ((x0, s0), (x1, s1)) for y, q in rounded(wide, 0.024, 0.008, 2)]
        body.hull(f"handle_{number}", [(x, y, zz - 0.0008) for x, y, zz in points], material=p.handle)
    return Made.of(body)


def _back(body: Body, p: HammerParameters, eye: tuple[float, float], reach: float, thick: float) -> None:
    """Two claws with a slot between them, or a wedge."""
    left, right = eye
    tip = -0.55 * p.head
    if p.form == "peen":
        middle = (left + right) / 2
        points = [(x, -reach, z) for x in (left + 0.002, right - 0.002) for z in (0.001, thick - 0.001)]
        points += [(middle + s * 0.002, tip, z) for s in (-1, 1) for z in (0.001, thick - 0.001)]
        body.hull("peen", points)
        return
    bend = -reach - 0.45 * (-tip - reach)
    rows = ((-reach, left + 0.002, right - 0.002), (bend, left - 0.001, right - 0.009), (tip, left - 0.019, left - 0.016))
    for side, (low, high) in enumerate(((0.001, 0.46 * thick), (0.54 * thick, thick - 0.001)), start=1):
        for number, (a, b) in enumerate(itertools.pairwise(rows), start=1):
            body.hull(f"claw_{side}_{number}", [(x, y, z) for y, *xs in (a, b) for x in xs for z in (low, high)])


class SawParameters(Parameters):
    """A handsaw with a toothed blade and a closed handle, lying."""

    length: float = Field(default=0.5, ge=0.3, le=0.7, description="of the blade [m]")
    width: float = Field(default=0.11, ge=0.07, le=0.15, description="of the blade at the handle [m]")
    teeth: int = Field(default=24, ge=12, le=40, description="teeth")
    handle: str = material("beech", "walnut", "abs", "cherry_wood", of="the handle")
    material: str = material("mild_steel", "stainless_steel")


def _saw(p: SawParameters, rng: np.random.Generator) -> Made:
    body, t = Body("saw", p.material), 0.0014
    x0, x1, w = -p.length / 2, p.length / 2, p.width
    toe = float(rng.uniform(0.4, 0.55)) * w
    pitch, deep = p.length / p.teeth, min(0.005, 0.6 * p.length / p.teeth)
    body.prism("blade", [(x0, deep), (x1, deep), (x1, toe), (x1 - 0.02, toe + 0.01), (x0, w)], 0, t)
    for k in range(p.teeth):
        x = x0 + k * pitch
        body.prism(f"tooth_{k + 1}", [(x + 1e-5, deep), (x + 0.5 * pitch, 0), (x + pitch - 1e-5, deep)], 0, t)
    thick, wide = 0.022, 0.026
    loop = [
        (x0 - 0.013, 0.14 * w),
        (x0 - 0.013, 0.86 * w),
        (x0 - 0.045, 1.02 * w),
        (x0 - 0.1, 0.92 * w),
        (x0 - 0.088, 0.5 * w),
        (x0 - 0.1, 0.08 * w),
        (x0 - 0.05, 0.0),
    ]
    middle = thick / 2
    u, v, cut = wide / 2, thick / 2, 0.005
    profile = [(-u, -v), (u, -v), (u, v - cut), (u - cut, v), (cut - u, v), (-u, v - cut)]
    body.sweep("handle", [(x, y, middle) for x, y in loop], profile, closed=True, material=p.handle)
    for number, share in enumerate((0.3, 0.7), start=1):
        at = (x0 - 0.013, share * w)
        body.cylinder(f"screw_{number}", (*at, thick), (*at, thick + 0.002), 0.005, material="brass")
    return Made.of(body)


class ScrewdriverParameters(Parameters):
    """A screwdriver with a fluted handle, lying."""

    length: float = Field(default=0.22, ge=0.12, le=0.32, description="[m]")
    handle: float = Field(default=0.46, ge=0.38, le=0.55, description="length of the handle over the whole length")
    diameter: float = Field(default=0.03, ge=0.02, le=0.038, description="of the handle [m]")
    tip: Literal["flat", "cross"] = Field(default="flat", description="form of the tip")
    grip: str = material("abs", "beech", "pvc", "polypropylene", of="the handle")
    material: str = material("mild_steel", "stainless_steel")


def _screwdriver(p: ScrewdriverParameters, rng: np.random.Generator) -> Made:
    body, sides = Body("screwdriver", p.material), 8
    r, long, end = p.diameter / 2, p.handle * p.length, -p.length / 2
    z = r * math.cos(math.pi / sides)
    waist = float(rng.uniform(0.72, 0.85))
    shape = [(0.7, 0.0), (1.0, 0.06), (1.0, 0.55), (0.62, 1.0)]
    body.turned(
        "handle",
        solid([(r * w, long * s) for w, s in shape[:3]]),
        (end, 0, z),
        segments=sides,
        euler=lying(sides),
        material=p.grip,
    )
    collar = [
        (r * w, long * s) for w, s in ((1.0, 0.55), (waist, 0.7), (waist * 0.9, 0.85), (1.0, 0.93), (1.0, 0.96), (0.6, 1.0))
    ]
    body.turned("neck", solid(collar[:2]), (end, 0, z), segments=sides, euler=lying(sides), material=p.grip)
    body.turned("waist", solid(collar[1:3]), (end, 0, z), segments=sides, euler=lying(sides), material=p.grip)
    body.turned("collar", solid(collar[2:]), (end, 0, z), segments=sides, euler=lying(sides), material=p.grip)
    rod, flare = 0.16 * r, p.length / 2 - 0.016
    body.cylinder("shaft", (end + long, 0, z), (flare, 0, z), rod)
    if p.tip == "flat":
        side = 0.7 * rod
        points = [(flare, y, z + h) for y in (-side, side) for h in (-side, side)]
        points += [(p.length / 2 - 0.006, y, z + h) for y in (-1.3 * rod, 1.3 * rod) for h in (-0.5 * rod, 0.5 * rod)]
        body.hull("tip", [*points, *((p.length / 2, y, z + h) for y in (-1.2 * rod, 1.2 * rod) for h in (-0.0005, 0.0005))])
    else:
        cone = [(rod, 0), (rod, 0.006), (0.3 * rod, 0.016)]
        body.turned("tip", solid(cone), (flare, 0, z), segments=8, euler=lying(8))
    return Made.of(body)


class SpannerParameters(Parameters):
    """A combination spanner, an open jaw at one end and a ring at the other, lying."""

    length: float = Field(default=0.2, ge=0.1, le=0.36, description="[m]")
    thickness: float = Field(default=0.007, ge=0.004, le=0.012, description="[m]")
    jaw: float = Field(default=0.1, ge=0.07, le=0.12, description="width of the jaw's opening over the length")
    material: str = material("stainless_steel", "mild_steel")


def _spanner(p: SpannerParameters, rng: np.random.Generator) -> Made:
    body, t, n = Body("spanner", p.material), p.thickness, 16
    gap = p.jaw * p.length
    ring, hole = 0.85 * gap, 0.52 * gap
    right, left = p.length / 2 - ring, -p.length / 2 + gap
    body.turned(
        "ring", [(hole, 0), (ring, 0), (ring, t), (hole, t)], (right, 0, 0), segments=12, euler=(0, 0, math.pi + math.pi / 12)
    )
    turn = math.radians(float(rng.choice([-15, 15])))
    outer, depth = 1.12 * gap, 0.55 * gap
    arch = [(outer * math.cos(a), outer * math.sin(a)) for a in np.linspace(math.radians(-142), math.radians(142), n)]
    mouth = [
        (-outer * 0.95, 0.5 * gap),
        (depth - 0.4 * gap, 0.5 * gap),
        (depth - 0.15 * gap, 0.0),
        (depth - 0.4 * gap, -0.5 * gap),
        (-outer * 0.95, -0.5 * gap),
    ]
    outline = [(x, y) for x, y, _ in moved([(x, y, 0) for x, y in [*arch, *mouth]], (left, 0, 0), turn)]
    body.prism("jaw", outline, 0, t)
    end = right - ring * math.cos(math.pi / 12)
    broad = 0.3 * gap
    edge = next((a, b) for a, b in itertools.pairwise(outline[:n]) if a[1] <= 0 < b[1] and a[0] > left)
    body.hull(
        "shaft",
        [(x, y, z) for x, y in (*edge, (end, -broad), (end, broad)) for z in (0.15 * t, 0.85 * t)],
    )
    return Made.of(body)


class AxeParameters(Parameters):
    """An axe with a wedge of a blade on a curved handle, lying."""

    length: float = Field(default=0.62, ge=0.35, le=0.9, description="[m]")
    blade: float = Field(default=0.12, ge=0.08, le=0.17, description="length of the edge, 0.19 of the length at most [m]")
    handle: str = material("ash", "beech", "oak", of="the handle")
    material: str = material("mild_steel", "cast_iron")


def _axe(p: AxeParameters, rng: np.random.Generator) -> Made:
    body, thick = Body("axe", p.material), 0.03
    blade = min(p.blade, 0.19 * p.length)
    right, eye = p.length / 2, 0.34 * blade
    left = right - 2 * eye
    poll, cheek, edge = 0.03, -0.028, -0.028 - 0.95 * blade
    body.box("eye", (left, cheek, 0), (right, poll, thick))
    wide = blade / 2
    centre = (left + right) / 2
    body.hull(
        "cheek",
        [(x, cheek, z) for x in (left, right) for z in (0.0, thick)]
        + [(centre + s * 0.8 * eye, cheek - 0.35 * blade, 0.01 + h) for s in (-1, 1) for h in (-0.006, 0.006)],
    )
    bit = [(centre + s * 0.8 * eye, cheek - 0.35 * blade, 0.01 + h) for s in (-1, 1) for h in (-0.006, 0.006)]
    rim = [(centre + wide * s, edge + 0.12 * blade * s * s, h) for s in (-1, -0.5, 0, 0.5, 1) for h in (0.0, 0.0014)]
    body.hull("bit", [*bit, *rim], material="stainless_steel")
    bow = float(rng.uniform(0.01, 0.03)) * p.length
    z = 0.012
    keys = [(left, 0, z), (left - 0.25 * p.length, bow, z), (-0.25 * p.length, -bow, z), (-p.length / 2, -0.2 * bow, z)]
    path = [(left, 0, z), (left - 0.02, 0, z), *curve([(left - 0.03, 0.0005, z), *keys[1:]], 3)]
    scales = [1.0, 1.0, *np.linspace(0.95, 0.88, len(path) - 4), 1.0, 1.25]
    for number in range(len(path) - 1):
        a, b = path[number], path[number + 1]
        ends = ((a, scales[number]), (b, scales[number + 1]))
        body.hull(
            f"handle_{number + 1}",
            [(q[0], q[1] + y * s, h + z) for q, s in ends for y, h in rounded(0.034, 0.024, 0.009, 2)],
            material=p.handle,
        )
    return Made.of(body)


class AnvilParameters(Parameters):
    """An anvil with a horn, a heel and a waist."""

    length: float = Field(default=0.5, ge=0.25, le=0.8, description="from horn to heel along x [m]")
    height: float = Field(default=0.26, ge=0.14, le=0.4, description="[m]")
    width: float = Field(default=0.11, ge=0.07, le=0.18, description="of the face along y [m]")
    material: str = material("cast_iron", "mild_steel")


def _anvil(p: AnvilParameters, rng: np.random.Generator) -> Made:
    body, long, top, w = Body("anvil", p.material), p.length, p.height, p.width / 2
    base, waist, face = 0.16 * top, 0.55 * top, 0.66 * top
    foot, slim = 0.24 * long, float(rng.uniform(0.12, 0.15)) * long
    body.hull(
        "foot",
        [
            (s * x, t * y, z)
            for x, y, z in ((foot, 1.25 * w, 0), (foot, 1.25 * w, 0.6 * base), (0.8 * foot, w, base))
            for s in (-1, 1)
            for t in (-1, 1)
        ],
    )
    body.hull(
        "waist_low",
        [
            (s * x, t * y, z)
            for x, y, z in ((0.8 * foot, w, base), (slim, 0.7 * w, 0.5 * (base + waist)))
            for s in (-1, 1)
            for t in (-1, 1)
        ],
    )
    body.hull(
        "waist_high",
        [
            (s * x, t * y, z)
            for x, y, z in ((slim, 0.7 * w, 0.5 * (base + waist)), (0.2 * long, w, face))
            for s in (-1, 1)
            for t in (-1, 1)
        ],
    )
    left, right = -0.2 * long, 0.2 * long
    body.box("face", (left, -w, face), (right, w, top))
    body.hull(
        "heel",
        [(right, t * w, z) for t in (-1, 1) for z in (face, top)]
        + [(long / 2, t * w, z) for t in (-1, 1) for z in (top - 0.12 * top, top)],
    )
    step = 0.04 * top
    body.box("table", (left - 0.06 * long, -0.8 * w, face + 0.02 * top), (left, 0.8 * w, top - step))
    start, tip = left - 0.06 * long, -long / 2
    middle, r = (face + top - step) / 2, (top - step - face) / 2 - 0.01 * top
    sections = (
        (start, 1.0, 0.0),
        (0.55 * start + 0.45 * tip, 0.78, 0.1 * r),
        (0.15 * start + 0.85 * tip, 0.35, 0.4 * r),
        (tip, 0.08, 0.7 * r),
    )
    for number, ends in enumerate(itertools.pairwise(sections), start=1):
        body.hull(f"horn_{number}", [(x, y * s, middle + lift + z * s) for x, s, lift in ends for y, z in circle(0.98 * r, 12)])
    made = Made.of(body)
    made.places["top"] = Place(((left + right) / 2, 0, top), (right - left, 2 * w))
    return made


GENERATORS = (
    Generator("hammer", "hammer with claw, peen or as a sledge", HammerParameters, _hammer, ("tool", "workshop", "mallet", "nails")),
    Generator("saw", "handsaw with teeth and a closed handle", SawParameters, _saw, ("tool", "workshop", "handsaw", "wood")),
    Generator("screwdriver", "screwdriver with a fluted handle", ScrewdriverParameters, _screwdriver, ("tool", "workshop", "screw")),
    Generator("spanner", "combination spanner", SpannerParameters, _spanner, ("tool", "workshop", "wrench", "bolt", "nut")),
    Generator("axe", "axe with a curved handle", AxeParameters, _axe, ("tool", "hatchet", "wood", "chop", "forest")),
    Generator("anvil", "anvil with horn and heel", AnvilParameters, _anvil, ("smith", "forge", "workshop", "heavy", "iron")),
)  # fmt: skip
