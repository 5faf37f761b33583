"""Glasses, bottles, jugs, jars, vases and flower pots."""

from __future__ import annotations

from typing import Literal

import numpy as np
from pydantic import Field

from .generator import Generator, Parameters, material
from .made import Body, Made, Place
from .profiles import rounded
from .turning import breaking, bulged, drawn, facet, grip, half, hollow, solid, vessel

__all__ = ["GENERATORS"]

BREAKABLE = Field(default=False, description="it shatters: pieces are cut beforehand")
CLEAR = 1.01e-3
"""[m] Between a loose lid or stopper and what it lies on."""


class GlassParameters(Parameters):
    """A drinking glass with a thick bottom."""

    height: float = Field(default=0.12, ge=0.07, le=0.18, description="[m]")
    diameter: float = Field(default=0.076, ge=0.055, le=0.1, description="of the rim [m]")
    taper: float = Field(default=0.82, ge=0.65, le=1.0, description="diameter of the foot over that of the rim")
    wall: float = Field(default=0.0022, ge=0.0015, le=0.004, description="thickness of the wall [m]")
    floor: float = Field(default=0.008, ge=0.003, le=0.015, description="thickness of the bottom [m]")
    breakable: bool = BREAKABLE
    material: str = material("soda_lime_glass", "borosilicate_glass", "polycarbonate", "stainless_steel")


def _glass(p: GlassParameters, rng: np.random.Generator) -> Made:
    rim = p.diameter / 2
    foot = p.taper * rim
    belly = (foot + (rim - foot) * float(rng.uniform(0.45, 0.6)), 0.45 * p.height)
    body = Body("drinking glass", p.material)
    outer = [(foot - 0.002, 0), (foot, 0.002), belly, (rim, p.height)]
    body.turned("glass", hollow(outer, p.wall, p.floor), segments=22)
    body.breakable = breaking(p.material, 14, int(rng.integers(1000)), p.wall) if p.breakable else None
    made = Made.of(body)
    made.places["inside"] = Place((0, 0, p.floor), (foot, foot), p.height - p.floor)
    return made


class WineGlassParameters(Parameters):
    """A wine glass: bowl, stem and foot."""

    height: float = Field(default=0.21, ge=0.14, le=0.26, description="[m]")
    diameter: float = Field(default=0.08, ge=0.05, le=0.1, description="of the bowl where it is widest [m]")
    bowl: float = Field(default=0.48, ge=0.4, le=0.6, description="height of the bowl over that of the glass")
    rim: float = Field(default=0.8, ge=0.65, le=1.0, description="diameter of the rim over the widest one")
    stem: float = Field(default=0.008, ge=0.006, le=0.012, description="diameter of the stem [m]")
    breakable: bool = BREAKABLE
    material: str = material("soda_lime_glass", "borosilicate_glass", "polycarbonate")


def _wine_glass(p: WineGlassParameters, rng: np.random.Generator) -> Made:
    wide, stem, under = p.diameter / 2, p.stem / 2, (1 - p.bowl) * p.height
    foot = float(rng.uniform(0.84, 0.94)) * wide
    wall, deep = 0.0026 if p.breakable else 0.0016, p.bowl * p.height
    body = Body("wine glass", p.material)
    body.turned("foot", solid([(foot, 0), (foot, 0.0018), (1.15 * stem, 0.009)]), segments=40)
    body.turned("stem", solid([(stem, 0.009), (0.85 * stem, 0.6 * under), (stem, under)]), segments=20)
    full = float(rng.uniform(0.34, 0.46))
    outer = [(stem, under), (0.78 * wide, under + 0.16 * deep), (wide, under + full * deep), (p.rim * wide, p.height)]
    body.turned("bowl", hollow(outer, wall, 0.005, fine=bulged(outer, 3)), segments=14)
    body.breakable = breaking(p.material, 11, int(rng.integers(1000)), wall) if p.breakable else None
    return Made.of(body)


class BottleParameters(Parameters):
    """A bottle with a shoulder, a neck and a label."""

    height: float = Field(default=0.3, ge=0.15, le=0.36, description="[m]")
    diameter: float = Field(default=0.076, ge=0.055, le=0.11, description="of the body [m]")
    neck: float = Field(default=0.028, ge=0.024, le=0.036, description="outer diameter of the neck [m]")
    shoulder: float = Field(default=0.6, ge=0.45, le=0.7, description="height of the body over that of the bottle")
    label: bool = Field(default=True, description="a paper label around the body")
    stopper: Literal["none", "cork"] = Field(default="cork", description="a loose cork in the neck")
    breakable: bool = BREAKABLE
    material: str = material("soda_lime_glass", "borosilicate_glass", "polyethylene", "terracotta")


def _bottle(p: BottleParameters, rng: np.random.Generator) -> Made:
    segments, wall = 16, 0.003
    wide, neck, top = p.diameter / 2, p.neck / 2, p.height
    high = p.shoulder * top
    slope = (top - high) * float(rng.uniform(0.32, 0.5))
    body = Body("bottle", p.material)
    outer = [(wide, 0), (wide, high), (neck, high + slope), (neck, top)]
    fine = [(wide - 0.004, 0), (wide, 0.004), (wide, high), (wide + 0.03 * (neck - wide), high + 0.14 * slope)]
    fine += [(wide + 0.16 * (neck - wide), high + 0.34 * slope), *outer[2:]]
    body.turned("bottle", hollow(outer, wall, 0.006, fine=fine), segments=segments)
    if p.label and not p.breakable:
        low, width = 0.2 * high, 0.6 * high
        own = [(wide, low), (wide + 0.0003, low), (wide + 0.0003, low + width), (wide, low + width)]
        body.turned("label", own, segments=segments, material="cardboard")
        drawn(body, "label")
    body.breakable = breaking(p.material, 18, int(rng.integers(1000)), wall) if p.breakable else None
    made = Made.of(body)
    if p.stopper == "cork":
        cork, inner = Body("cork", "cork"), neck - wall
        plug = inner * 0.97 - CLEAR
        cork.turned("plug", solid([(0.9 * plug, top - 0.018), (plug, top + CLEAR)]), segments=20)
        cork.turned("head", solid([(neck, top + CLEAR), (neck, top + 0.009), (0.9 * neck, top + 0.011)]), segments=20)
        made.bodies["cork"] = cork
        made.carries.append(("", "cork"))
    return made


class JugParameters(Parameters):
    """A jug with a belly, a beak and a swept handle; a breakable one has no handle."""

    height: float = Field(default=0.22, ge=0.12, le=0.32, description="[m]")
    diameter: float = Field(default=0.14, ge=0.09, le=0.2, description="of the belly [m]")
    neck: float = Field(default=0.7, ge=0.55, le=0.95, description="diameter of the neck over that of the belly")
    wall: float = Field(default=0.005, ge=0.003, le=0.008, description="thickness of the wall [m]")
    breakable: bool = BREAKABLE
    material: str = material("porcelain", "terracotta", "stainless_steel", "copper", "soda_lime_glass")


def _jug(p: JugParameters, rng: np.random.Generator) -> Made:
    segments, wide, top = 14, p.diameter / 2, p.height
    neck = p.neck * wide
    belly = float(rng.uniform(0.28, 0.36)) * top
    coarse = [(0.66 * wide, 0), (wide, belly), (neck, 0.74 * top), (1.08 * neck, top)]
    outer = bulged(coarse, 4)
    body = Body("jug", p.material)
    body.turned("jug", hollow(coarse, p.wall, 1.4 * p.wall, fine=outer), segments=segments, euler=half(segments))
    if p.breakable:
        body.breakable = breaking(p.material, 18, int(rng.integers(1000)), p.wall)
        return Made.of(body)
    low, high = facet(outer, 0.45 * top, segments), facet(outer, 0.9 * top, segments)
    broad = min(0.022, 0.9 * 2 * neck * np.tan(np.pi / segments))
    body.sweep("handle", grip(low, high, 0.2 * top), rounded(broad, 0.4 * broad, 0.15 * broad, 2))
    rim, under = facet(outer, top, segments), facet(outer, 0.86 * top, segments)
    w, out = 0.9 * rim.x * np.tan(np.pi / segments), 0.3 * neck
    body.hull("beak", [(-rim.x, -w, top), (-rim.x, w, top), (-under.x, 0, under.z), (-rim.x - out, 0, top + 0.1 * out)])
    return Made.of(body)


class VaseParameters(Parameters):
    """A vase of one of four forms."""

    form: Literal["classic", "cylinder", "flared", "bulb"] = Field(default="classic", description="its outline")
    height: float = Field(default=0.28, ge=0.1, le=0.6, description="[m]")
    slimness: float = Field(default=1.9, ge=1.3, le=3.0, description="height over the largest diameter")
    wall: float = Field(default=0.005, ge=0.003, le=0.01, description="thickness of the wall [m]")
    breakable: bool = BREAKABLE
    material: str = material("porcelain", "terracotta", "soda_lime_glass", "brass", "marble")


FORMS = {
    "classic": [(0.5, 0.0), (0.96, 0.38), (0.96, 0.58), (0.52, 0.82), (0.66, 1.0)],
    "cylinder": [(0.94, 0.0), (1.0, 0.03), (1.0, 0.97), (0.96, 1.0)],
    "flared": [(0.62, 0.0), (0.45, 0.16), (0.6, 0.62), (1.0, 1.0)],
    "bulb": [(0.6, 0.0), (1.0, 0.28), (0.72, 0.52), (0.3, 0.64), (0.36, 1.0)],
}
"""Radius over the largest one, height over the whole one."""


def _vase(p: VaseParameters, rng: np.random.Generator) -> Made:
    wide = p.height / p.slimness / 2
    wall = min(p.wall, 0.12 * wide)
    shift = float(rng.uniform(-0.04, 0.04))
    outer = [(r * wide, (z + (shift if 0.1 < z < 0.9 else 0.0)) * p.height) for r, z in FORMS[p.form]]
    body = Body("vase", p.material)
    body.turned("vase", hollow(outer, wall, 1.5 * wall, fine=bulged(outer, 4)), segments=20 if len(outer) < 5 else 16)
    body.breakable = breaking(p.material, 20, int(rng.integers(1000)), wall) if p.breakable else None
    return Made.of(body)


class JarParameters(Parameters):
    """A jar with a lid that lies on it loosely, its rim around the neck."""

    height: float = Field(default=0.14, ge=0.07, le=0.26, description="without the lid [m]")
    diameter: float = Field(default=0.085, ge=0.05, le=0.14, description="of the body [m]")
    mouth: float = Field(default=0.85, ge=0.65, le=0.95, description="diameter of the mouth over that of the body")
    wall: float = Field(default=0.003, ge=0.002, le=0.005, description="thickness of the wall [m]")
    knob: bool = Field(default=False, description="a knob on the lid")
    breakable: bool = Field(default=False, description="the jar shatters, the lid does not: pieces are cut beforehand")
    lid: str = material("tin", "oak", "cork", "porcelain", of="the lid")
    material: str = material("soda_lime_glass", "porcelain", "terracotta")


def _jar(p: JarParameters, rng: np.random.Generator) -> Made:
    wide, top = p.diameter / 2, p.height
    mouth, segments = p.mouth * wide, 16
    outer = [(wide, 0), (wide, top - 0.022 - 0.4 * (wide - mouth)), (mouth, top - 0.016), (mouth, top)]
    body = Body("jar", p.material)
    fine = [(wide - 0.003, 0), (wide, 0.003), *outer[1:]]
    body.turned("jar", hollow(outer, p.wall, 1.6 * p.wall, fine=fine), segments=segments)
    body.breakable = breaking(p.material, 14, int(rng.integers(1000)), p.wall) if p.breakable else None
    lid = Body("lid", p.lid)
    inner, low, high = (mouth + CLEAR) / 0.985, top - 0.012, top + CLEAR
    outside = inner + 0.003
    lid.turned("rim", [(inner, low), (outside, low), (outside, high), (inner, high)], segments=segments)
    lid.turned("top", solid([(outside, high), (outside, high + 0.002), (0.9 * outside, high + 0.004)]), segments=36)
    if p.knob:
        size = float(rng.uniform(0.16, 0.22)) * wide
        up = high + 0.004
        lid.turned("stem", solid([(0.6 * size, up), (0.6 * size, up + 0.5 * size)]), segments=20)
        lid.sphere("knob", (0, 0, up + 0.5 * size + 0.79 * size), 0.79 * size)
    made = Made({"": body, "lid": lid})
    made.carries.append(("", "lid"))
    return made


class FlowerPotParameters(Parameters):
    """A tapered pot with a band around its rim, with soil in it; a breakable one is empty."""

    height: float = Field(default=0.16, ge=0.08, le=0.5, description="[m]")
    diameter: float = Field(default=0.18, ge=0.08, le=0.55, description="of the rim [m]")
    taper: float = Field(default=0.68, ge=0.55, le=0.9, description="diameter of the foot over that of the rim")
    soil: bool = Field(default=True, description="filled with soil to below the rim")
    breakable: bool = BREAKABLE
    material: str = material("terracotta", "porcelain", "concrete_c30", "polypropylene")


def _flower_pot(p: FlowerPotParameters, rng: np.random.Generator) -> Made:
    segments, top = 22, p.height
    wall, foot = max(0.035 * p.diameter, 0.004), p.taper * p.diameter / 2
    band = top * float(rng.uniform(0.16, 0.24))
    low, reach = top - band, p.diameter / 2 - 0.6 * wall
    slim = foot + (reach - foot) * low / top
    body = Body("flower pot", p.material)
    profile = vessel([(foot, 0), (reach, top)], wall, 1.4 * wall)
    body.turned("pot", profile, segments=segments)
    body.turned("band", [(slim, low), (slim + 0.6 * wall, low), (reach + 0.6 * wall, top), (reach, top)], segments=segments)
    if p.breakable:
        body.breakable = breaking(p.material, 16, int(rng.integers(1000)), wall)
        return Made.of(body)
    made = Made.of(body)
    if p.soil:
        (r0, z0), (r1, z1) = profile[-2], profile[-3]
        full = low
        wide = r0 + (r1 - r0) * (full - z0) / (z1 - z0)
        body.turned("soil", solid([(r0, z0), (wide, full)]), segments=segments, material="clay_soil")
        made.places["soil"] = Place((0, 0, full), (wide, wide), top - full)
    return made


GENERATORS = (
    Generator("glass", "drinking glass; may shatter", GlassParameters, _glass, ("tumbler", "drinking", "cup", "vessel", "kitchen")),
    Generator(
        "wine_glass", "wine glass with stem and foot; may shatter", WineGlassParameters, _wine_glass,
        ("goblet", "stemware", "vessel", "kitchen", "party"),
    ),
    Generator(
        "bottle", "bottle with neck and label, a loose cork in it; may shatter", BottleParameters, _bottle,
        ("wine", "beer", "flask", "vessel", "kitchen", "cellar"),
    ),
    Generator(
        "jug", "jug with a beak and a handle; a breakable one has no handle", JugParameters, _jug,
        ("pitcher", "ewer", "carafe", "vessel", "kitchen"),
    ),
    Generator("vase", "vase of one of four forms; may shatter", VaseParameters, _vase, ("urn", "flowers", "vessel", "decoration", "amphora")),
    Generator(
        "jar", "jar with a loose lid; may shatter", JarParameters, _jar, ("preserve", "jam", "canister", "vessel", "kitchen", "pantry"),
    ),
    Generator(
        "flower_pot", "tapered flower pot with a band, filled with soil; may shatter, then empty", FlowerPotParameters, _flower_pot,
        ("planter", "plant", "garden", "terracotta", "vessel"),
    ),
)  # fmt: skip
