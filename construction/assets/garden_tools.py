"""Shovels, brooms, rakes and ladders: long things that lie, lean or stand astride."""

from __future__ import annotations

import math

import numpy as np
from pydantic import Field

from .generator import Generator, Parameters, material
from .made import Body, Joint, Made, Place
from .profiles import rounded
from .turning import lying, solid

__all__ = ["GENERATORS"]


class ShovelParameters(Parameters):
    """A shovel with a dished blade and a D-shaped or plain grip, lying along x."""

    length: float = Field(default=1.05, ge=0.6, le=1.5, description="[m]")
    blade: float = Field(default=0.28, ge=0.2, le=0.36, description="length of the blade [m]")
    width: float = Field(default=0.22, ge=0.15, le=0.32, description="of the blade [m]")
    grip: bool = Field(default=True, description="a D-shaped grip at the end")
    handle: str = material("ash", "beech", "oak", of="the shaft")
    material: str = material("mild_steel", "stainless_steel", "aluminium_alloy")


def _shovel(p: ShovelParameters, rng: np.random.Generator) -> Made:
    body, t, r = Body("shovel", p.material), 0.003, 0.016
    right = p.length / 2
    back, w = right - p.blade, p.width / 2
    tip, rise = float(rng.uniform(0.12, 0.3)) * p.blade, 0.22 * w
    body.prism(
        "blade",
        [(back, -0.45 * w), (right - 0.3 * tip, -0.45 * w), (right, 0), (right - 0.3 * tip, 0.45 * w), (back, 0.45 * w)],
        0,
        t,
    )
    for name, s in (("left", 1), ("right", -1)):
        rows = ((back, 0.45 * w, 0.0), (right - 0.3 * tip, 0.45 * w, 0.0), (back, w, rise), (right - tip, w, rise))
        body.hull(f"side_{name}", [(x, s * y, z + h) for x, y, z in rows for h in (0, t)])
    body.hull(
        "socket",
        [
            (x, y, z)
            for x, half, high in (
                (back - 0.1, 0.8 * r, 2 * r),
                (back, 0.9 * r, 2 * r),
                (back + 0.35 * p.blade, 0.25 * r, t + 0.002),
            )
            for y in (-half, half)
            for z in (t if x > back - 0.01 else 0.2 * r, high)
        ],
    )
    middle = r * math.cos(math.pi / 16)
    end = -right + (0.1 if p.grip else 0.0)
    long = back - 0.1 - end
    body.turned(
        "shaft",
        solid([(0.94 * r, 0), (r, 0.1 * long), (r, 0.8 * long), (0.9 * r, long)]),
        (end, 0, middle),
        segments=16,
        euler=lying(16),
        material=p.handle,
    )
    if p.grip:
        body.hull(
            "fork",
            [
                (x, y, middle + z)
                for x, half in ((end, 0.5 * r), (end - 0.035, 0.045))
                for y in (-half, half)
                for z in (-0.7 * r, 0.7 * r)
            ],
            material=p.handle,
        )
        for name, s in (("left", 1), ("right", -1)):
            ys = sorted((s * 0.045, s * 0.06))
            body.box(
                f"arm_{name}", (end - 0.1, ys[0], middle - 0.7 * r), (end - 0.035, ys[1], middle + 0.7 * r), material=p.handle
            )
        body.cylinder("bar", (end - 0.085, -0.045, middle), (end - 0.085, 0.045, middle), 0.8 * r, material=p.handle)
    return Made.of(body)


class BroomParameters(Parameters):
    """A broom, a head of bristles on a pole, lying along x."""

    length: float = Field(default=1.35, ge=0.8, le=1.7, description="[m]")
    width: float = Field(default=0.32, ge=0.2, le=0.6, description="of the head along y [m]")
    tufts: int = Field(default=9, ge=5, le=15, description="tufts of bristles")
    bristles: str = material("bamboo", "nylon", "pvc", "linen", of="the bristles")
    material: str = material("beech", "pine", "ash", "aluminium_alloy")


def _broom(p: BroomParameters, rng: np.random.Generator) -> Made:
    body, r, thick = Body("broom", p.material), 0.0125, 0.05
    right = p.length / 2
    head, hair = right - 0.13, 0.1
    body.prism("head", [(x + head - 0.018, y) for x, y in rounded(0.036, p.width, 0.012, 3)], 0, thick, material="beech")
    each = (p.width - 0.02) / p.tufts
    for k in range(p.tufts):
        y = -p.width / 2 + 0.01 + each * (k + 0.5)
        lean = 0.35 * (y / p.width) * 0.04 + 0.03 * each * float(rng.uniform(-1, 1))
        root, end = 0.4 * each, 0.44 * each
        long = hair * float(rng.uniform(0.94, 1.0))
        for row, (low, high) in enumerate(((0.004, 0.023), (0.027, 0.046)), start=1):
            points = [(head, y + s * root, z) for s in (-1, 1) for z in (low, high)]
            points += [
                (head + long, y + lean + s * end, z)
                for s in (-1, 1)
                for z in ((0.0, 0.025) if row == 1 else (0.025, high + 0.002))
            ]
            body.hull(f"tuft_{k + 1}_{row}", points, material=p.bristles)
    end = -right
    middle = r * math.cos(math.pi / 16)
    long = head - 0.036 - end
    pole = [(0.8 * r, 0.0), (r, 0.01), (r, long - 0.06), (r, long)]
    body.turned("pole", solid(pole), (end, 0, middle), segments=16, euler=lying(16))
    return Made.of(body)


class RakeParameters(Parameters):
    """A rake with bent tines, lying along x with its tines up."""

    length: float = Field(default=1.5, ge=0.9, le=1.8, description="[m]")
    width: float = Field(default=0.38, ge=0.25, le=0.6, description="of the head along y [m]")
    tines: int = Field(default=12, ge=6, le=18, description="tines")
    handle: str = material("ash", "beech", "pine", of="the shaft")
    material: str = material("mild_steel", "stainless_steel", "beech")


def _rake(p: RakeParameters, rng: np.random.Generator) -> Made:
    body, r, bar = Body("rake", p.material), 0.014, 0.022
    right = p.length / 2
    head = right - 0.022
    body.prism("bar", [(x + right - 0.011, y) for x, y in rounded(0.022, p.width, 0.004, 1)], 0, bar)
    up = float(rng.uniform(0.06, 0.08))
    for k in range(p.tines):
        y = (p.width - 0.03) * ((k + 0.5) / p.tines - 0.5)
        x = right - 0.011
        body.sweep(
            f"tine_{k + 1}",
            [(x, y, bar), (x, y, bar + 0.5 * up), (x - 0.012, y, bar + up)],
            rounded(0.008, 0.006, 0.002, 1),
            scales=[1, 0.9, 0.4],
        )
    end, middle = -right, r * math.cos(math.pi / 16)
    long = head - end
    body.turned(
        "shaft",
        solid([(0.8 * r, 0), (r, 0.01), (r, 0.85 * long), (0.75 * r, long)]),
        (end, 0, middle),
        segments=16,
        euler=lying(16),
        material=p.handle,
    )
    return Made.of(body)


class LadderParameters(Parameters):
    """A straight ladder that leans against the plane y = 0."""

    length: float = Field(default=2.6, ge=1.2, le=5.0, description="of the rails [m]")
    width: float = Field(default=0.42, ge=0.3, le=0.6, description="over the rails along x [m]")
    lean_deg: float = Field(default=15.0, ge=5.0, le=25.0, description="from upright [degrees]")
    spacing: float = Field(default=0.28, ge=0.23, le=0.32, description="of the rungs [m]")
    material: str = material("pine", "ash", "aluminium_alloy", "bamboo")


def _ladder(p: LadderParameters, rng: np.random.Generator) -> Made:
    body, deep, thick = Body("ladder", p.material), 0.06, 0.024
    lean = math.radians(p.lean_deg)
    way = np.array([0, math.sin(lean), math.cos(lean)])
    out = np.array([0, -math.cos(lean), math.sin(lean)])
    top = -deep / 2 * abs(out[1])
    foot = np.array([0, top - p.length * way[1], 0]) + np.array([0, 0, deep / 2 * abs(out[2])])
    narrow = float(rng.uniform(0.82, 1.0))
    for name, s in (("left", -1), ("right", 1)):
        points = []
        for along, share in ((0.0, 1.0), (p.length, narrow)):
            for x in (share * p.width / 2, share * p.width / 2 - thick):
                points += [foot + along * way + h * out + np.array([s * x, 0, 0]) for h in (-deep / 2, deep / 2)]
        body.hull(f"rail_{name}", points)
    count = int((p.length - 0.2) / p.spacing)
    start = (p.length - (count - 1) * p.spacing) / 2
    for k in range(count):
        along = start + k * p.spacing
        inner = (1 + (narrow - 1) * along / p.length) * p.width / 2 - thick
        slope = (1 - narrow) * p.width / 2 / p.length
        ends = []
        for s in (-1, 1):
            ends += [
                foot + (along + u) * way + h * out + np.array([s * (inner - u * slope), 0, 0])
                for u, h in ((0.015 * math.cos(a), 0.015 * math.sin(a)) for a in np.linspace(0, 2 * math.pi, 10, endpoint=False))
            ]
        body.hull(f"rung_{k + 1}", ends)
    return Made.of(body)


class StepladderParameters(Parameters):
    """A stepladder astride, its back frame on a hinge at the top, with treads and a platform."""

    height: float = Field(default=1.2, ge=0.6, le=2.2, description="to the platform [m]")
    width: float = Field(default=0.44, ge=0.34, le=0.6, description="at the foot along x [m]")
    spread_deg: float = Field(default=17.0, ge=12.0, le=22.0, description="of each frame from upright [degrees]")
    treads: int = Field(default=4, ge=2, le=8, description="treads under the platform")
    material: str = material("aluminium_alloy", "pine", "beech")


def _frame(body: Body, p: StepladderParameters, way: int, wide: tuple[float, float], head: tuple[float, float]) -> float:
    """Two rails from the ground to a head (y, z), leaning; `way` -1 for the front. Returns their run per height.

    Args:
        wide: half width at the foot and at the head, over the rails [m].
        head: y and z of the middle of their upper ends [m].
    """
    run, thick, deep = math.tan(math.radians(p.spread_deg)), 0.022, 0.034 / math.cos(math.radians(p.spread_deg))
    for name, s in (("left", -1), ("right", 1)):
        points = []
        for z, half in ((0.0, wide[0]), (head[1], wide[1])):
            y = head[0] + way * run * (head[1] - z)
            points += [(s * x, y + h, z) for x in (half, half - thick) for h in (-deep / 2, deep / 2)]
        body.hull(f"rail_{name}", points)
    return run


def _stepladder(p: StepladderParameters, rng: np.random.Generator) -> Made:
    front, back = Body("stepladder", p.material), Body("back frame of the stepladder", p.material)
    top, half = p.height - 0.022, p.width / 2
    slim = half * float(rng.uniform(0.7, 0.78))
    run = _frame(front, p, -1, (half, slim), (-0.05, top))
    front.box("platform", (-slim - 0.01, -0.16, top), (slim + 0.01, 0.045, p.height))
    for k in range(p.treads):
        z = top * (k + 1) / (p.treads + 1)
        y = -0.05 - run * (top - z)
        inner = half + (slim - half) * z / top - 0.022
        front.hull(
            f"tread_{k + 1}",
            [
                (s * (inner - h * (half - slim) / top), y + d + h * run, z + h)
                for s in (-1, 1)
                for d in (-0.045, 0.017)
                for h in (-0.01, 0.01)
            ],
        )
    pivot = (0.022, top - 0.03)
    _frame(back, p, 1, (half - 0.004, slim - 0.004), (pivot[0], top - 0.012))
    for number, share in enumerate((0.25, 0.7), start=1):
        z = top * share
        y = pivot[0] + run * (top - 0.012 - z)
        inner = half - 0.004 + (slim - half) * z / (top - 0.012) - 0.022
        lean = (half - slim) / (top - 0.012)
        back.hull(
            f"rail_{number + 2}",
            [(s * (inner - h * lean), y + d - h * run, z + h) for s in (-1, 1) for d in (-0.008, 0.008) for h in (-0.016, 0.016)],
        )
    for name, s in (("left", -1), ("right", 1)):
        xs = sorted((s * (slim - 0.027), s * (slim - 0.039)))
        front.box(f"knuckle_{name}", (xs[0], pivot[0] - 0.01, pivot[1] - 0.012), (xs[1], pivot[0] + 0.01, top))
    made = Made({"": front, "back": back})
    shut = 2 * math.atan(run) * 0.7
    made.joints["back"] = Joint("back", "hinge", (0, *pivot), axis=(-1, 0, 0), range=(0.0, shut), damping=0.3, friction=0.5)
    made.places["platform"] = Place((0, -0.06, p.height), (2 * slim, 0.2))
    return made


GENERATORS = (
    Generator("shovel", "shovel with a dished blade", ShovelParameters, _shovel, ("spade", "tool", "garden", "dig", "snow")),
    Generator("broom", "broom with tufts of bristles", BroomParameters, _broom, ("brush", "sweep", "cleaning", "tool")),
    Generator("rake", "rake with bent tines", RakeParameters, _rake, ("tool", "garden", "leaves", "farm")),
    Generator(
        "ladder", "straight ladder that leans on a wall, whose plane is y = 0", LadderParameters, _ladder,
        ("climb", "rungs", "workshop", "garden", "barn"), stands=False,
    ),
    Generator(
        "stepladder", "stepladder astride, its back frame folds on a hinge", StepladderParameters, _stepladder,
        ("ladder", "steps", "climb", "workshop", "library"),
    ),
)  # fmt: skip
