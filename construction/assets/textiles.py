"""Cushions, pillows, folded towels and blankets, as rigid things of fabric."""

from __future__ import annotations

import math

import numpy as np
from pydantic import Field

from .generator import Generator, Parameters, material
from .made import Body, Made, Place
from .profiles import circle

__all__ = ["GENERATORS"]

GAP = 1.01e-3
"""[m] Between two things that lie on each other."""


def _padded(body: Body, sizes: tuple[float, float, float], *, square: float, piping: float, trim: str) -> None:
    """A padded thing with a flat underside and a vertical seam all around, piped.

    Args:
        body: it is added to.
        sizes: width along x, depth along y, thickness [m].
        square: exponent of its outline, 2 an ellipse, larger squarer.
        piping: diameter of the cord along the seam [m]; 0: none.
        trim: material of the cord.
    """
    wide, deep, thick = sizes
    angles = np.linspace(0, 2 * math.pi, 20, endpoint=False) + math.pi / 20
    outline = [
        (
            math.copysign(abs(math.cos(a)) ** (2 / square), math.cos(a)),
            math.copysign(abs(math.sin(a)) ** (2 / square), math.sin(a)),
        )
        for a in angles
    ]
    seam, band = 0.42 * thick, max(piping, 0.06 * thick)
    rings = [(0.6, 0.0), (0.8, 0.08 * thick), (0.93, 0.2 * thick), (1.0, seam - band / 2), (1.0, seam + band / 2)]
    above = thick - seam - band / 2
    rings += [(k, seam + band / 2 + above * (1 - k**2.2) ** 0.75) for k in (0.95, 0.86, 0.74, 0.6, 0.42, 0.2)]
    rings.append((0.05, thick))
    points = [(0.5 * wide * k * u, 0.5 * deep * k * v, z) for k, z in rings for u, v in outline]
    body.hull("padding", points)
    if piping <= 0:
        return
    edge = [np.array([0.5 * wide * u, 0.5 * deep * v]) for u, v in outline]
    half = piping / 2
    offset = []
    for k, q in enumerate(edge):
        before, after = edge[k - 1], edge[(k + 1) % len(edge)]
        normals = [np.array([w[1], -w[0]]) / np.linalg.norm(w) for w in (q - before, after - q)]
        mean = normals[0] + normals[1]
        offset.append(q + half * 2 * mean / (mean @ mean))
    cord = [(-half, -half), (0.3 * half, -half), (half, -0.3 * half), (half, 0.3 * half), (0.3 * half, half), (-half, half)]
    body.sweep("piping", [(q[0], q[1], seam) for q in reversed(offset)], [(-u, v) for u, v in cord], closed=True, material=trim)


class CushionParameters(Parameters):
    """A square cushion with piping, lying."""

    side: float = Field(default=0.45, ge=0.25, le=0.7, description="along x and y [m]")
    thickness: float = Field(default=0.14, ge=0.06, le=0.22, description="[m]")
    piping: float = Field(default=0.01, ge=0.006, le=0.016, description="diameter of the cord along the seam [m]")
    trim: str = material("leather", "linen", "carpet", "felt", of="the piping")
    material: str = material("linen", "cotton", "wool", "carpet", "leather", "felt", "polyester")


def _cushion(p: CushionParameters, rng: np.random.Generator) -> Made:
    body = Body("cushion", p.material)
    stretch = float(rng.uniform(0.97, 1.03))
    _padded(
        body, (p.side * stretch, p.side / stretch, p.thickness), square=float(rng.uniform(6, 9)), piping=p.piping, trim=p.trim
    )
    button = 0.03 * p.side
    body.turned(
        "button",
        [(0, p.thickness), (button, p.thickness), (0.8 * button, p.thickness + 0.006), (0, p.thickness + 0.008)],
        material=p.trim,
    )
    return Made.of(body)


class PillowParameters(Parameters):
    """A bed pillow, lying."""

    width: float = Field(default=0.7, ge=0.4, le=0.9, description="along x [m]")
    depth: float = Field(default=0.48, ge=0.3, le=0.8, description="along y [m]")
    thickness: float = Field(default=0.15, ge=0.08, le=0.22, description="[m]")
    material: str = material("cotton", "linen", "silk", "polyester")


def _pillow(p: PillowParameters, rng: np.random.Generator) -> Made:
    body = Body("pillow", p.material)
    _padded(body, (p.width, p.depth, p.thickness), square=float(rng.uniform(4.5, 6.5)), piping=0.006, trim=p.material)
    return Made.of(body)


class TowelsParameters(Parameters):
    """Folded towels on each other, their folds in front."""

    count: int = Field(default=3, ge=1, le=8, description="towels")
    width: float = Field(default=0.36, ge=0.2, le=0.7, description="along x [m]")
    depth: float = Field(default=0.26, ge=0.15, le=0.5, description="along y [m]")
    layer: float = Field(default=0.013, ge=0.005, le=0.025, description="thickness of a layer [m]")
    layers: int = Field(default=3, ge=2, le=5, description="layers of each, folded")
    mixed: bool = Field(default=True, description="of several fabrics, else all of one")
    material: str = material("cotton", "linen", "wool", "polyester")


FABRICS = ("cotton", "linen", "wool", "polyester", "carpet", "felt", "nylon_fabric", "silk")


def _folded(body: Body, low: float, sizes: tuple[float, float, float], layers: int, rng: np.random.Generator) -> float:
    """Layers with round folds in front, uneven behind; returns the height of the top [m].

    Args:
        body: they are added to.
        low: height of the underside [m].
        sizes: width, depth, thickness of a layer [m].
        layers: how many.
        rng: of how uneven they are.
    """
    wide, deep, thick = sizes
    shift = float(rng.uniform(-0.01, 0.01)) * deep
    for k in range(layers):
        z, half = low + (k + 0.5) * thick, thick / 2
        front, back = (
            shift - deep / 2 + float(rng.uniform(0, 0.012)) * deep,
            shift + deep / 2 - float(rng.uniform(0, 0.03)) * deep,
        )
        bow = [(front + half - half * math.sin(a), z + half * math.cos(a)) for a in np.linspace(0, math.pi, 7)]
        side = wide / 2 - float(rng.uniform(0, 0.01)) * wide
        body.prism(f"layer_{k + 1}", [*bow, (back, z - half), (back + 0.004, z), (back, z + half)], -side, side, axis="x")
    return low + layers * thick


def _towels(p: TowelsParameters, rng: np.random.Generator) -> Made:
    made, z, before = Made({}), 0.0, None
    for number in range(p.count):
        row = FABRICS[int(rng.integers(len(FABRICS)))] if p.mixed and number else p.material
        body = Body("folded towel", row)
        name = "" if number == 0 else f"towel_{number + 1}"
        z = _folded(body, z, (p.width, p.depth, p.layer), p.layers, rng) + GAP
        made.bodies[name] = body
        if before is not None:
            made.carries.append((before, name))
        before = name
    made.places["top"] = Place((0, 0, z - GAP), (0.8 * p.width, 0.8 * p.depth), body=before or "")
    return made


class BlanketParameters(Parameters):
    """A folded blanket with fringes on both sides."""

    width: float = Field(default=0.6, ge=0.3, le=1.4, description="along x, without fringes [m]")
    depth: float = Field(default=0.45, ge=0.25, le=0.9, description="along y [m]")
    layer: float = Field(default=0.018, ge=0.008, le=0.04, description="thickness of a layer [m]")
    layers: int = Field(default=4, ge=2, le=8, description="layers")
    fringes: int = Field(default=14, ge=0, le=24, description="fringes on each side of the uppermost layer")
    material: str = material("wool", "cotton", "felt", "carpet")


def _blanket(p: BlanketParameters, rng: np.random.Generator) -> Made:
    body = Body("folded blanket", p.material)
    top = _folded(body, 0.0, (p.width, p.depth, p.layer), p.layers, np.random.default_rng(int(rng.integers(1 << 30))))
    made = Made.of(body)
    made.places["top"] = Place((0, 0, top), (0.8 * p.width, 0.8 * p.depth))
    if p.fringes == 0:
        return made
    last = body.parts[f"layer_{p.layers}"].shape
    side = last.height / 2 if last.kind == "extrusion" else p.width / 2
    beyond = p.width / 2 + 0.008
    z, long = top - 0.5 * p.layer, 0.035
    radius = min(0.003, 0.3 * p.layer, 0.3 * p.depth / p.fringes)
    profile = circle(radius, 6)
    for k in range(p.fringes):
        y = 0.84 * p.depth * ((k + 0.5) / p.fringes - 0.5)
        for name, s in (("left", -1), ("right", 1)):
            drop = float(rng.uniform(0.3, 0.8)) * min(long, max(z - 2 * radius, 0.0))
            path = [
                (s * side, y, z),
                (s * beyond, y, z),
                (s * (beyond + 0.008), y, z - 0.4 * drop),
                (s * (beyond + 0.012), y, z - drop),
            ]
            body.sweep(f"fringe_{name}_{k + 1}", path, profile)
    return made


GENERATORS = (
    Generator("cushion", "square cushion with piping and a button, rigid", CushionParameters, _cushion, ("pillow", "sofa", "textile", "fabric", "seat")),
    Generator("pillow", "bed pillow, rigid", PillowParameters, _pillow, ("cushion", "bed", "textile", "fabric", "bedroom")),
    Generator("towels", "folded towels that lie loosely on each other", TowelsParameters, _towels, ("towel", "linen", "folded", "textile", "bathroom", "stack", "clothes")),
    Generator("blanket", "folded blanket with fringes", BlanketParameters, _blanket, ("plaid", "rug", "folded", "textile", "bed", "sofa")),
)  # fmt: skip
