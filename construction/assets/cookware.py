"""Cooking pots, pans, kettles, cans and watering cans."""

from __future__ import annotations

import math

import numpy as np
from pydantic import Field

from ...worlds.materials import row_named
from ...worlds.spec import RigidPhysics
from .generator import Generator, Parameters, material
from .made import Body, Made, Place
from .profiles import circle, rounded
from .turning import TRIM, curve, drawn, facet, grip, half, hollow, lying, ring, solid
from .vessels import CLEAR

__all__ = ["GENERATORS"]

SHEET = 0.0003
"""[m] Own choice: thickness of the sheet of a tin can; steel cans have 0.2 to 0.3 mm."""
CYLINDER_FACETS = 64
"""[1] As many as those of a cylinder, so that what is drawn around one touches it everywhere."""


class CookingPotParameters(Parameters):
    """A cooking pot with two handles and a loose lid with a knob."""

    diameter: float = Field(default=0.24, ge=0.14, le=0.4, description="[m]")
    height: float = Field(default=0.14, ge=0.08, le=0.3, description="without the lid [m]")
    wall: float = Field(default=0.003, ge=0.002, le=0.006, description="thickness of the wall [m]")
    lid: bool = Field(default=True, description="a loose lid on it")
    knob: str = material("abs", "brass", "oak", "stainless_steel", of="knob and grips")
    material: str = material("stainless_steel", "cast_iron", "copper", "aluminium_alloy")


def _cooking_pot(p: CookingPotParameters, rng: np.random.Generator) -> Made:
    segments, wide, top = 20, p.diameter / 2, p.height
    corner = 1.8 * p.wall
    outer = [(wide - corner, 0), (wide - 0.3 * corner, 0.3 * corner), (wide, corner), (wide, top)]
    body = Body("cooking pot", p.material)
    profile = hollow([(wide, 0), (wide, top)], p.wall, 2 * p.wall, fine=outer)
    body.turned("pot", profile, segments=segments, euler=half(segments))
    edge = wide + 0.004
    body.turned(
        "rim", [(wide, top - 0.006), (edge, top - 0.006), (edge, top), (wide, top)], segments=segments, euler=half(segments)
    )
    z, span = 0.72 * top, float(rng.uniform(0.3, 0.4)) * wide
    face = wide * math.cos(math.pi / segments)
    tilt = math.pi / segments * 2
    side = face * math.tan(tilt / 2) + 0.3 * span
    for name, turn in (("right", 1), ("left", -1)):
        x = turn * (face * math.cos(tilt) - (side - face * math.sin(tilt)) * math.tan(tilt))
        normal = np.array([turn * math.cos(tilt), math.sin(tilt), 0])
        root = np.array([x, side, z])
        far = np.array([turn * (face + 0.042), 0.6 * side, z + 0.012])
        one = [root, root + 0.012 * normal, far]
        path = [*one, *(q * (1, -1, 1) for q in reversed(one))]
        body.sweep(f"handle_{name}", path, circle(0.0055, 8))
    made = Made.of(body)
    if p.lid:
        made.bodies["lid"] = _lid("lid of the pot", p.material, p.knob, wide + 0.002, face - p.wall - 0.0015, top)
        made.carries.append(("", "lid"))
    else:
        made.places["inside"] = Place((0, 0, 2 * p.wall), (wide, wide), top - 2 * p.wall)
    return made


def _lid(role: str, metal: str, knob: str, wide: float, plug: float, top: float) -> Body:
    """A domed lid that lies on a rim of outer radius `wide` at z = `top`, with a plug within the wall and a knob [m]."""
    body, over = Body(role, metal), top + CLEAR
    rise = 0.12 * wide
    body.turned("plug", ring(plug - 0.004, over - 0.008, over, 0.004), segments=20)
    dome = [(wide, over), (wide, over + 0.003), (0.75 * wide, over + 0.003 + 0.6 * rise), (0.22 * wide, over + 0.003 + rise)]
    body.turned("dome", solid(dome), segments=40)
    up, size = over + 0.003 + rise, max(0.008, 0.13 * wide)
    shape = [
        (0.5 * size, up),
        (0.5 * size, up + 0.5 * size),
        (size, up + 0.9 * size),
        (size, up + 1.2 * size),
        (0.7 * size, up + 1.5 * size),
    ]
    body.turned("stem", solid(shape[:2]), segments=20, material=knob)
    body.turned("knob", solid(shape[1:]), segments=20, material=knob)
    return body


class FryingPanParameters(Parameters):
    """A frying pan with a long handle."""

    diameter: float = Field(default=0.26, ge=0.16, le=0.34, description="of the rim [m]")
    height: float = Field(default=0.045, ge=0.03, le=0.07, description="of the rim [m]")
    handle: float = Field(default=0.19, ge=0.12, le=0.24, description="length of the handle, 0.72 of the diameter at most [m]")
    grip: str = material("abs", "beech", "cast_iron", of="the handle")
    material: str = material("cast_iron", "aluminium_alloy", "stainless_steel", "copper")


def _frying_pan(p: FryingPanParameters, rng: np.random.Generator) -> Made:
    segments, rim, top = 24, p.diameter / 2, p.height
    foot = rim - float(rng.uniform(0.5, 0.8)) * top
    outer = [(foot, 0), (rim - 0.002, 0.7 * top), (rim, top)]
    body = Body("frying pan", p.material)
    wall = 0.0045
    profile = hollow([outer[0], outer[-1]], wall, wall, fine=outer)
    body.turned("pan", profile, segments=segments, euler=half(segments))
    root = facet(outer, 0.62 * top, segments)
    start = root.out(0.012)
    long = min(p.handle, 0.72 * p.diameter)
    end = np.array([root.x + long, 0, top + 0.18 * long])
    mid = start + 0.35 * (end - start) + (0, 0, 0.02)
    broad = min(0.026, 0.95 * 2 * root.x * math.tan(math.pi / segments))
    path = [root.out(0), start, *(np.array(q) for q in curve([start, mid, end], 3)[1:]), end + np.array([0.01, 0, 0])]
    scales = [0.9, 0.9, *np.linspace(0.75, 1.0, len(path) - 3), 0.7]
    body.sweep("handle", path, rounded(broad, 0.5 * broad, 0.18 * broad, 2), scales=scales, material=p.grip)
    made = Made.of(body)
    made.places["inside"] = Place((0, 0, wall), (1.2 * foot, 1.2 * foot))
    return made


class KettleParameters(Parameters):
    """A kettle with spout, loose lid and a handle that arches over it."""

    diameter: float = Field(default=0.2, ge=0.14, le=0.26, description="of the foot [m]")
    height: float = Field(default=0.15, ge=0.1, le=0.2, description="without lid and handle [m]")
    grip: str = material("abs", "oak", "beech", of="the handle's grip and the knob")
    material: str = material("stainless_steel", "copper", "cast_iron", "aluminium_alloy")


def _kettle(p: KettleParameters, rng: np.random.Generator) -> Made:
    segments, wide, top, wall = 16, p.diameter / 2, p.height, 0.002
    mouth = float(rng.uniform(0.42, 0.5)) * wide
    coarse = [(wide, 0), (0.98 * wide, 0.3 * top), (mouth, top)]
    outer = [
        (wide - 0.0035, 0),
        (wide, 0.0035),
        (0.98 * wide, 0.3 * top),
        (0.9 * wide, 0.56 * top),
        (0.76 * wide, 0.8 * top),
        (mouth, top),
    ]
    body = Body("kettle", p.material)
    body.turned("kettle", hollow(coarse, wall, 2 * wall, fine=outer), segments=segments, euler=half(segments))
    start = facet(outer, 0.45 * top, segments)
    r = 0.7 * start.x * math.tan(math.pi / segments)
    tip = np.array([1.6 * wide, 0, 1.02 * top])
    bend = [start.out(0.9 * r), tip - (0.25 * wide, 0, 0.18 * top), tip]
    path = [start.out(0), *(np.array(q) for q in curve(bend, 2))]
    body.sweep("spout", [q * (-1, 1, 1) for q in path], circle(r, 8), scales=list(np.linspace(1, 0.55, len(path))))
    root = facet(outer, 0.7 * top, segments)
    ends = [root.out(0), root.out(0.014)]
    arch = top + 0.62 * wide
    reach = 0.46 * wide
    side = [
        *ends,
        np.array([root.x + 0.012, 0, arch - 0.26 * wide]),
        np.array([reach + 0.03, 0, arch]),
        np.array([reach, 0, arch]),
    ]
    thin = rounded(0.014, 0.006, 0.0025, 2)
    body.sweep("bow_right", side, thin)
    body.sweep("bow_left", [q * (-1, 1, 1) for q in side], thin)
    shape = [(0.007, -reach), (0.0095, -0.7 * reach), (0.0095, 0.7 * reach), (0.007, reach)]
    body.turned("grip", solid(shape), (0, 0, arch), segments=20, euler=lying(20), material=p.grip)
    made = Made.of(body)
    made.bodies["lid"] = _lid("lid of the kettle", p.material, p.grip, mouth, mouth - wall - 0.008, top)
    made.carries.append(("", "lid"))
    return made


class TinCanParameters(Parameters):
    """A tin can, closed, with a paper label and rims."""

    diameter: float = Field(default=0.074, ge=0.05, le=0.16, description="[m]")
    height: float = Field(default=0.11, ge=0.04, le=0.2, description="[m]")
    label: bool = Field(default=True, description="a paper label around it")
    filled: str = material("potatoes", "soya_beans", "maize", "water", of="what is in it")
    material: str = material("tin", "mild_steel", "aluminium_alloy")


def _tin_can(p: TinCanParameters, rng: np.random.Generator) -> Made:
    """One exact cylinder collides, as thick as the can, of its sheet; rims and label are drawn within the skin around it.

    A ring of facets would brake a rolling one.
    """
    r, top, rim = p.diameter / 2, p.height, 0.003
    body = Body("tin can", p.material)
    weight = _filled_weight(p)
    if weight is not None:
        body.physics = RigidPhysics(mass=weight, hollow=True).model_dump(include={"category", "mass", "hollow"})
    body.cylinder("can", (0, 0, 0), (0, 0, top), r, material=None if weight is not None else p.filled)
    for name, low in (("foot", 0.0), ("top", top - rim)):
        body.turned(f"rim_{name}", ring(r, low, low + rim, TRIM), segments=CYLINDER_FACETS)
        drawn(body, f"rim_{name}")
    if p.label:
        low = rim + float(rng.uniform(0.03, 0.1)) * top
        body.turned("label", ring(r, low, top - low, 0.4 * TRIM), segments=CYLINDER_FACETS, material="cardboard")
        drawn(body, "label")
    made = Made.of(body)
    made.places["top"] = Place((0, 0, top), (r, r))
    return made


def _filled_weight(p: TinCanParameters) -> float | None:
    """Mass of a closed can of sheet and what fills it [kg]; None where the table does not know one of them."""
    rows = row_named(p.material), row_named(p.filled)
    if rows[0] is None or rows[1] is None:
        return None
    metal, content = (row[1].figures["density"].range[1] for row in rows if row is not None)
    r, top = p.diameter / 2, p.height
    whole, inside = math.pi * r**2 * top, math.pi * (r - SHEET) ** 2 * (top - 2 * SHEET)
    return round(content * inside + metal * (whole - inside), 6)


class WateringCanParameters(Parameters):
    """A watering can with a long spout, a rose, a side handle and a bow over the top."""

    diameter: float = Field(default=0.18, ge=0.12, le=0.26, description="of the foot [m]")
    height: float = Field(default=0.22, ge=0.15, le=0.3, description="of the body [m]")
    spout: float = Field(default=0.22, ge=0.14, le=0.32, description="reach of the spout [m]")
    material: str = material("zinc", "copper", "polypropylene", "mild_steel")


def _watering_can(p: WateringCanParameters, rng: np.random.Generator) -> Made:
    segments, wide, top = 20, p.diameter / 2, p.height
    slim = float(rng.uniform(0.86, 0.96)) * wide
    outer = [(wide, 0), (slim, top)]
    body = Body("watering can", p.material)
    body.turned("can", hollow(outer, 0.002, 0.003), segments=segments, euler=half(segments))
    band = [(wide, 0), (wide + 0.003, 0), (wide + 0.003, 0.012), (wide - (wide - slim) * 0.012 / top, 0.012)]
    body.turned("band", band, segments=segments, euler=half(segments))
    start = facet(outer, 0.22 * top, segments)
    r = 0.72 * start.x * math.tan(math.pi / segments)
    tip = np.array([start.x + p.spout, 0, 1.08 * top])
    way = (tip - start.out(0.03)) / np.linalg.norm(tip - start.out(0.03))
    path = [start.out(0), start.out(0.03), start.out(0.03) + 0.6 * (tip - start.out(0.03)), tip]
    body.sweep("spout", [q * (-1, 1, 1) for q in path], circle(r, 8), scales=[1.0, 0.95, 0.75, 0.6])
    lean = math.pi / 2 - math.atan2(way[2], way[0])
    rose = [(0.6 * r, 0), (2.4 * r, 0.03), (2.4 * r, 0.034), (0.8 * r, 0.038)]
    body.turned("rose", solid(rose), tip * (-1, 1, 1), segments=24, euler=(0, -lean, 0))
    low, high = facet(outer, 0.3 * top, segments), facet(outer, 0.85 * top, segments)
    broad = min(0.02, 0.9 * 2 * high.x * math.tan(math.pi / segments))
    body.sweep("handle", grip(low, high, 0.36 * top, steps=8), rounded(broad, 0.4 * broad, 0.15 * broad, 2))
    rim, rise = slim * math.cos(math.pi / segments) - 0.001, 0.35 * slim
    arch = [np.array([0, y * rim, top + z * rise]) for y, z in ((1, 0), (1, 0.4), (0.6, 1))]
    body.sweep("bow", [*arch, *(q * (1, -1, 1) for q in reversed(arch))], rounded(0.016, 0.002, 0.0008, 1))
    return Made.of(body)


GENERATORS = (
    Generator(
        "cooking_pot", "cooking pot with two handles and a loose lid", CookingPotParameters, _cooking_pot,
        ("saucepan", "casserole", "stockpot", "vessel", "kitchen", "stove"),
    ),
    Generator("frying_pan", "frying pan with a long handle", FryingPanParameters, _frying_pan, ("skillet", "pan", "kitchen", "stove")),
    Generator("kettle", "kettle with spout, arched handle and a loose lid", KettleParameters, _kettle, ("tea", "water", "kitchen", "stove", "vessel")),
    Generator("tin_can", "closed tin can with rims and a label", TinCanParameters, _tin_can, ("tin", "can", "food", "pantry", "shelf")),
    Generator(
        "watering_can", "watering can with a spout and a rose", WateringCanParameters, _watering_can, ("garden", "plants", "can", "vessel"),
    ),
)  # fmt: skip
