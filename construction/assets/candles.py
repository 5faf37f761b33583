"""Candles, candlesticks and lanterns."""

from __future__ import annotations

import numpy as np
from pydantic import Field

from .generator import Generator, Parameters, material
from .made import Body, Joint, Made
from .profiles import circle
from .turning import curve, ring, solid, stacked

__all__ = ["GENERATORS"]

GAP = 1.01e-3
"""[m] Between bodies."""


def _candle_parts(body: Body, radius: float, low: float, high: float, rng: np.random.Generator) -> None:
    """A candle that has burned a little: wax, a rim of it, a wick."""
    stacked(body, "wax", [(radius, low), (radius, high - 0.004), (0.9 * radius, high)])
    lean = float(rng.uniform(-1, 1)) * 0.003
    wick = [(0, 0, high), (0, 0, high + 0.005), (lean, 0.5 * lean, high + 0.011)]
    body.sweep("wick", wick, circle(0.0008, 6), material="cotton")


class CandleParameters(Parameters):
    """A candle that stands by itself."""

    height: float = Field(default=0.12, ge=0.03, le=0.25, description="[m]")
    diameter: float = Field(default=0.06, ge=0.035, le=0.1, description="[m]")
    material: str = material("polyethylene", "polypropylene", "nylon")


def _candle(p: CandleParameters, rng: np.random.Generator) -> Made:
    body = Body("candle", p.material)
    _candle_parts(body, p.diameter / 2, 0.0, p.height, rng)
    return Made.of(body)


class CandlestickParameters(Parameters):
    """A turned candlestick with a loose candle in its socket."""

    height: float = Field(default=0.2, ge=0.1, le=0.4, description="without the candle [m]")
    foot: float = Field(default=0.11, ge=0.08, le=0.16, description="diameter of the foot [m]")
    candle: float = Field(default=0.2, ge=0.0, le=0.3, description="length of the candle, 0: none [m]")
    wax: str = material("polyethylene", "polypropylene", "nylon", of="the candle")
    material: str = material("brass", "silver", "cast_iron", "walnut", "porcelain")


def _candlestick(p: CandlestickParameters, rng: np.random.Generator) -> Made:
    body, foot, top = Body("candlestick", p.material), p.foot / 2, p.height
    socket, deep = 0.0125, 0.02
    knob = float(rng.uniform(0.4, 0.6))
    pan = top - deep - 0.006
    span = pan - 0.2 * foot
    low = 0.2 * foot
    outer = [(foot, 0), (foot, 0.004), (0.5 * foot, 0.12 * foot), (0.009, low), (0.007, low + 0.3 * knob * span)]
    outer += [(0.014, low + (knob - 0.05) * span), (0.016, low + knob * span), (0.014, low + (knob + 0.05) * span)]
    outer += [(0.007, low + (knob + 0.12) * span), (0.008, pan - 0.012), (0.5 * foot, pan), (0.52 * foot, pan + 0.003)]
    stacked(body, "stem", outer)
    wall = 0.003
    body.turned("bottom", solid([(socket + wall, pan + 0.003), (socket + wall, pan + 0.006)]), segments=20)
    body.turned("socket", ring(socket, pan + 0.006, pan + 0.006 + deep, wall), segments=20)
    made = Made.of(body)
    if p.candle > 0.04:
        candle = Body("candle", p.wax)
        _candle_parts(candle, 0.0112, pan + 0.006 + GAP, pan + 0.006 + p.candle, rng)
        made.bodies["candle"] = candle
        made.carries.append(("", "candle"))
    return made


class LanternParameters(Parameters):
    """A lantern with panes of glass, a door on hinges, a roof, a bow and a candle in it."""

    width: float = Field(default=0.15, ge=0.1, le=0.3, description="along x and y [m]")
    height: float = Field(default=0.24, ge=0.16, le=0.5, description="to the eaves [m]")
    glass: str = material("soda_lime_glass", "borosilicate_glass", "polycarbonate", of="the panes")
    material: str = material("cast_iron", "brass", "copper", "mild_steel", "pine")


def _lantern(p: LanternParameters, rng: np.random.Generator) -> Made:
    body, x, post, base = Body("lantern", p.material), p.width / 2, 0.012, 0.014
    top, pane = p.height, 0.003
    for number, (sx, sy) in enumerate(((-1, -1), (1, -1), (1, 1), (-1, 1)), start=1):
        a, b = np.array([sx * x, sy * x]), np.array([sx * (x - post), sy * (x - post)])
        low, high = np.minimum(a, b), np.maximum(a, b)
        body.box(f"foot_{number}", (*low, 0), (*high, 0.008))
        body.box(f"post_{number}", (*low, 0.008 + base), (*high, top))
    body.box("base", (-x, -x, 0.008), (x, x, 0.008 + base))
    sill = 0.008 + base
    inner = x - post
    for name, s in (("left", -1), ("right", 1)):
        xs = sorted((s * (x - 0.0045), s * (x - 0.0045 - pane)))
        body.box(f"pane_{name}", (xs[0], -inner, sill), (xs[1], inner, top), material=p.glass)
    body.box("pane_back", (-inner, x - 0.0045 - pane, sill), (inner, x - 0.0045, top), material=p.glass)
    eave, rise = x + 0.012, float(rng.uniform(0.5, 0.8)) * x
    square = [(s * 1.0, t * 1.0) for s in (-1, 1) for t in (-1, 1)]
    body.hull(
        "roof",
        [(eave * s, eave * t, top + h) for s, t in square for h in (0, 0.005)]
        + [(0.3 * x * s, 0.3 * x * t, top + rise) for s, t in square],
    )
    body.turned("vent", solid([(0.28 * x, top + rise), (0.28 * x, top + rise + 0.02)]), segments=24)
    cap = top + rise + 0.02
    body.turned("cap", solid([(0.42 * x, cap), (0.1 * x, cap + 0.015)]), segments=24)
    reach = 0.26 * x
    keys = [(s * reach, 0, cap + z * x) for s, z in ((-1.2, 0.4), (0, 0.75), (1.2, 0.4))]
    steep = (rise - 0.005) / (eave - 0.3 * x)
    foot = np.array([0.62 * x, 0, top + 0.005 + steep * (eave - 0.62 * x)])
    lead = foot + 0.012 * np.array([steep, 0, 1]) / np.hypot(steep, 1)
    flip = np.array([-1, 1, 1])
    path = [foot * flip, *(np.array(q) for q in curve([lead * flip, *keys, lead], 2)), foot]
    body.sweep("bow", path, circle(0.0025, 8))
    _candle_parts(body, min(0.022, 0.4 * inner), sill, sill + 0.45 * (top - sill), rng)
    door = Body("door of the lantern", p.material)
    d0, d1, frame, deep = -inner + GAP, inner - GAP, 0.009, 0.007
    low, high = sill + GAP, top - GAP
    ys = (-x + 0.001, -x + 0.001 + deep)
    door.box("stile_left", (d0, ys[0], low), (d0 + frame, ys[1], high))
    door.box("stile_right", (d1 - frame, ys[0], low), (d1, ys[1], high))
    door.box("rail_low", (d0 + frame, ys[0], low), (d1 - frame, ys[1], low + frame))
    door.box("rail_high", (d0 + frame, ys[0], high - frame), (d1 - frame, ys[1], high))
    middle = sum(ys) / 2
    door.box("pane", (d0 + frame, middle - 0.0015, low + frame), (d1 - frame, middle + 0.0015, high - frame), material=p.glass)
    door.sphere("knob", (d1 - frame / 2, ys[0] - 0.004, (low + high) / 2), 0.004)
    made = Made({"": body, "door": door})
    made.joints["door"] = Joint(
        "door", "hinge", (d0, ys[0], (low + high) / 2), axis=(0, 0, -1), range=(0.0, 1.5), damping=0.002, friction=0.005
    )
    return made


GENERATORS = (
    Generator("candle", "candle with a wick", CandleParameters, _candle, ("light", "wax", "flame", "church", "table")),
    Generator("candlestick", "turned candlestick with a loose candle", CandlestickParameters, _candlestick, ("candle", "light", "holder", "church", "table")),
    Generator("lantern", "lantern with panes, a door on hinges and a candle", LanternParameters, _lantern, ("lamp", "light", "candle", "garden", "porch")),
)  # fmt: skip
