"""Boats of planks on lines, hollow, and rafts of logs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from pydantic import Field

from ...worlds.arrays import F64
from .generator import Generator, Parameters, material
from .made import MAIN, Body, Made, Place
from .profiles import circle

__all__ = ["GENERATORS"]

SEGMENTS, STRAKES = 9, 4
Line = Callable[[float], float]


@dataclass(frozen=True)
class _Lines:
    """Lines of a hull over s from the bow (-1) to the stern (1) [m]."""

    length: float
    breadth: Line
    """Half breadth at the gunwale."""
    bottom: Line
    """Half breadth at the bottom."""
    rise: Line
    """Height of the bottom."""
    sheer: Line
    """Height of the gunwale."""
    thick: float
    lap: float
    """By how much the lower edge of a strake stands out over the one below it."""
    stations: tuple[float, ...]
    level: tuple[int, ...]
    """Segments of even section, where thwarts are."""

    def at(self, k: int) -> float:
        """s of the section at station k: that of the segment's middle at both ends of a level segment."""
        for j in self.level:
            if k in (j, j + 1):
                return (self.stations[j] + self.stations[j + 1]) / 2
        return self.stations[k]

    def outer(self, k: int, j: int) -> F64:
        """Point (x, y, z) of line j at station k, on the left side of x >= 0."""
        s, share = self.at(k), j / STRAKES
        b, w = self.breadth(s), self.bottom(s)
        z0, z1 = self.rise(s), self.sheer(s)
        return np.array([w + (b - w) * share**0.65, 0.5 * self.length * self.stations[k], z0 + (z1 - z0) * share**1.25])

    def inward(self, j: int) -> F64:
        """Direction from the outer to the inner side along line j."""
        angle = np.deg2rad((58, 40, 25, 10, 0)[j])
        return self.thick * np.array([-np.cos(angle), 0.0, np.sin(angle)])

    def edges(self, k: int, j: int) -> tuple[F64, F64, F64, F64]:
        """Lower outer, lower inner, upper outer and upper inner point of strake j at station k."""
        low, up = self.outer(k, j), self.outer(k, j + 1)
        d, e = self.inward(j), self.inward(j + 1)
        shift = self.lap if j else 0.0
        return low - shift * d / self.thick, low + d * (1 - shift / self.thick), up, up + e


def _shell(body: Body, lines: _Lines) -> None:
    """Bottom, strakes and gunwales."""
    mirror = np.array([-1.0, 1.0, 1.0])
    for k in range(SEGMENTS):
        bottom = [q for n in (k, k + 1) for q in lines.edges(n, 0)[:2]]
        body.hull(f"bottom_{k + 1}", [*bottom, *(q * mirror for q in bottom)])
        for side, flip in (("left", mirror), ("right", np.ones(3))):
            for j in range(STRAKES):
                body.hull(f"strake_{side}_{j + 1}_{k + 1}", [q * flip for n in (k, k + 1) for q in lines.edges(n, j)])
            rail = []
            for n in (k, k + 1):
                top = lines.outer(n, STRAKES)
                inner = max(top[0] - lines.thick - 0.014, 0.004)
                rail += [np.array([x, top[1], top[2] + h]) * flip for x in (top[0] + 0.014, inner) for h in (0.0, 0.024)]
            body.hull(f"gunwale_{side}_{k + 1}", rail)


def _stem(body: Body, lines: _Lines, end: int) -> None:
    """Post before the last section, of both sides' planks."""
    k, out = (0, -1) if end < 0 else (SEGMENTS, 1)
    points = []
    for j in range(STRAKES + 1):
        q = lines.outer(k, j)
        points += [(s * (q[0] + 0.004), q[1], q[2] + 0.05 * (j == STRAKES)) for s in (-1, 1)]
        points += [(s * 0.012, q[1] + out * 0.055, q[2] + 0.03 + 0.045 * (j == STRAKES)) for s in (-1, 1)]
    body.hull("stem" if end < 0 else "sternpost", points)


def _thwart(body: Body, name: str, lines: _Lines, k: int, z: float, *, share: float = 0.8) -> float:
    """A seat between the inner faces of a strake in a level segment; returns the height of its upper side [m]."""
    thick = 0.028
    for j in range(STRAKES):
        _, low, _, up = lines.edges(k, j)
        if low[2] < z - thick and up[2] > z:
            break
    else:
        j = STRAKES - 2
        _, low, _, up = lines.edges(k, j)
        z = min(max(z, float(low[2]) + thick + 0.002), float(up[2]) - 0.002)
    points = []
    y0, y1 = lines.outer(k, 0)[1], lines.outer(k + 1, 0)[1]
    middle, half = (y0 + y1) / 2, share * (y1 - y0) / 2
    for h in (z - thick, z):
        t = (h - low[2]) / (up[2] - low[2])
        x = float(low[0] + t * (up[0] - low[0]))
        points += [(s * x, middle + e * half, h) for s in (-1, 1) for e in (-1, 1)]
    body.hull(name, points)
    return z


class RowingBoatParameters(Parameters):
    """A clinker-built rowing boat with a flat bottom, its bow to the front (-y)."""

    length: float = Field(default=3.4, ge=2.4, le=5.5, description="along y [m]")
    beam: float = Field(default=1.3, ge=1.0, le=1.8, description="greatest breadth [m]")
    depth: float = Field(default=0.48, ge=0.35, le=0.7, description="of the side amidships [m]")
    plank: float = Field(default=0.016, ge=0.012, le=0.025, description="thickness of the planks [m]")
    oars: bool = Field(default=True, description="two loose oars on the thwarts")
    oar: str = material("spruce", "ash", of="oars")
    material: str = material("larch", "oak", "mahogany", "pine", "cedar")


def _rowing_boat(p: RowingBoatParameters, rng: np.random.Generator) -> Made:
    made = Made.of(Body("rowing boat", p.material))
    half, fine = p.beam / 2, float(rng.uniform(2.0, 2.6))

    def breadth(s: float) -> float:
        if s < 0.1:
            return float(0.035 + (half - 0.035) * (1 - ((0.1 - s) / 1.1) ** fine))
        return half * (1 - 0.28 * ((s - 0.1) / 0.9) ** 2)

    def bottom(s: float) -> float:
        return max(0.02, 0.58 * breadth(s) - 0.02) if s > -0.98 else 0.02

    def rise(s: float) -> float:
        ends = max(0.0, -s - 0.3) / 0.7 if s < 0 else max(0.0, s - 0.6) / 0.4
        return float(ends**2.2 * p.depth * (0.38 if s < 0 else 0.1))

    stations = tuple(np.linspace(-1, 1, SEGMENTS + 1))
    lines = _Lines(
        p.length,
        breadth,
        bottom,
        rise,
        lambda s: p.depth * (1 + (0.32 if s < 0 else 0.14) * s * s),
        p.plank,
        0.4 * p.plank,
        stations,
        (2, 4, 7),
    )
    body = made.main
    _shell(body, lines)
    _stem(body, lines, -1)
    points = []
    for j in range(STRAKES + 1):
        q = lines.outer(SEGMENTS, j)
        points += [(s * (q[0] + 0.006), q[1] + t, q[2] + 0.03 * (j == STRAKES)) for s in (-1, 1) for t in (0.0, 0.026)]
    body.hull("transom", points)
    seat = 0.62 * p.depth
    tops = [_thwart(body, f"thwart_{n}", lines, k, seat) for n, k in enumerate(lines.level, start=1)]
    for s, side in ((-1, "left"), (1, "right")):
        q = (lines.outer(4, STRAKES) + lines.outer(5, STRAKES)) / 2
        for t in (-0.03, 0.03):
            body.cylinder(
                f"thole_{side}_{'a' if t < 0 else 'b'}",
                (s * (q[0] - 0.004), q[1] + t, q[2] + 0.024),
                (s * (q[0] - 0.004), q[1] + t, q[2] + 0.11),
                0.009,
            )
    if p.oars:
        _oars(made, p, lines, max(tops))
    y = (lines.outer(4, 0)[1] + lines.outer(5, 0)[1]) / 2
    made.places["thwart"] = Place((0, y, tops[1]), (0.3 * p.beam, 0.12), 1.0)
    return made


def _oars(made: Made, p: RowingBoatParameters, lines: _Lines, high: float) -> None:
    """Oars that lie across the thwarts, blades towards the stern."""
    r = 0.019
    a, b = lines.outer(2, 0)[1] - 0.1, lines.outer(SEGMENTS, 0)[1] - 0.12
    for s, side in ((-1, "left"), (1, "right")):
        oar = made.bodies[f"oar_{side}"] = Body("oar", p.oar)
        x, z = s * 0.13 * p.beam, high + 1.1e-3 + r
        blade = min(0.55, 0.25 * (b - a))
        oar.sweep("shaft", [(x, a + 0.12, z), (x, b - blade, z)], circle(r, 12))
        oar.sweep("handle", [(x, a, z), (x, a + 0.12, z)], circle(0.8 * r, 12))
        wide = 0.055
        oar.hull(
            "blade",
            [
                (x + w, y, z + h)
                for y, ws in ((b - blade, r), (b - 0.6 * blade, wide), (b, wide))
                for w in (-ws, ws)
                for h in (-0.008, 0.008)
            ],
        )
        made.carries.append((MAIN, f"oar_{side}"))


class CanoeParameters(Parameters):
    """An open canoe with thwarts and seats, pointed at both ends, along y."""

    length: float = Field(default=4.6, ge=3.0, le=6.0, description="along y [m]")
    beam: float = Field(default=0.88, ge=0.7, le=1.1, description="greatest breadth [m]")
    depth: float = Field(default=0.36, ge=0.28, le=0.45, description="of the side amidships [m]")
    upsweep: float = Field(default=0.5, ge=0.2, le=0.8, description="rise of the ends over the depth")
    skin: float = Field(default=0.012, ge=0.008, le=0.02, description="thickness of the shell [m]")
    material: str = material("cedar", "birch", "aluminium_alloy", "abs", "polyethylene")


def _canoe(p: CanoeParameters, rng: np.random.Generator) -> Made:
    made = Made.of(Body("canoe", p.material))
    half, fine = p.beam / 2, float(rng.uniform(2.0, 2.5))

    def breadth(s: float) -> float:
        return float(0.026 + (half - 0.026) * (1 - abs(s) ** fine))

    def rise(s: float) -> float:
        return float((max(0.0, abs(s) - 0.45) / 0.55) ** 3 * 0.3 * p.depth)

    stations = tuple(np.linspace(-1, 1, SEGMENTS + 1))
    lines = _Lines(
        p.length,
        breadth,
        lambda s: max(0.018, 0.66 * breadth(s) - 0.02),
        rise,
        lambda s: p.depth * (1 + p.upsweep * abs(s) ** 3),
        p.skin,
        0.0,
        stations,
        (2, 4, 6),
    )
    _shell(made.main, lines)
    _stem(made.main, lines, -1)
    _stem(made.main, lines, 1)
    for n, (k, share, z) in enumerate(((2, 0.5, 0.7), (4, 0.16, 0.86), (6, 0.5, 0.7)), start=1):
        _thwart(made.main, "yoke" if n == 2 else f"seat_{n}", lines, k, z * p.depth, share=share)
    return made


class RaftParameters(Parameters):
    """Logs side by side under cross beams with lashings."""

    length: float = Field(default=2.6, ge=1.0, le=6.0, description="of the logs along y [m]")
    logs: int = Field(default=7, ge=3, le=14, description="logs")
    diameter: float = Field(default=0.22, ge=0.1, le=0.4, description="of a log [m]")
    beams: int = Field(default=3, ge=2, le=4, description="cross beams")
    uneven: float = Field(default=0.12, ge=0.0, le=0.3, description="by how much the ends of logs differ [m]")
    rope: str = material("cotton", "linen", of="lashings")
    material: str = material("spruce", "pine", "balsa", "bamboo")


def _raft(p: RaftParameters, rng: np.random.Generator) -> Made:
    body = Body("raft", p.material)
    r, half = p.diameter / 2, p.length / 2
    for k in range(p.logs):
        x = (k - (p.logs - 1) / 2) * p.diameter
        a, b = (half - float(rng.uniform(0, min(p.uneven, 0.1 * p.length))) for _ in range(2))
        body.cylinder(f"log_{k + 1}", (x, -a, r), (x, b, r), r)
    reach, beam = (p.logs - 1) / 2 * p.diameter + 0.6 * r, 0.35 * p.diameter
    for j in range(p.beams):
        y = (-0.38 + 0.76 * j / (p.beams - 1)) * p.length
        z = p.diameter
        body.hull(
            f"beam_{j + 1}",
            [
                (x, y + w, h)
                for x in (-reach, reach)
                for w, h in (
                    (-0.8 * beam, z),
                    (0.8 * beam, z),
                    (-0.8 * beam, z + 0.7 * beam),
                    (0.8 * beam, z + 0.7 * beam),
                    (-0.4 * beam, z + beam),
                    (0.4 * beam, z + beam),
                )
            ],
        )
        t = 0.09 * p.diameter
        profile = circle(t / 2, 8)
        flat = max(v for _, v in profile)
        w = 0.8 * beam + flat
        for k in range(p.logs):
            if (k + j) % 2 and p.logs > 8:
                continue
            x = (k - (p.logs - 1) / 2) * p.diameter
            side, top = z + 0.7 * beam + 0.5 * flat, z + beam + flat
            up = [(x, y - w, z), (x, y - w, side), (x, y - 0.4 * beam - flat / 3, top)]
            path = [*up, *((a, 2 * y - b, c) for a, b, c in reversed(up))]
            body.sweep(f"lashing_{j + 1}_{k + 1}", path, profile, material=p.rope)
    return Made.of(body)


GENERATORS = (
    Generator("rowing_boat", "clinker-built rowing boat, hollow, with thwarts and loose oars", RowingBoatParameters, _rowing_boat,
              ("dinghy", "lake", "harbour", "float", "skiff", "vessel", "water")),
    Generator("canoe", "open canoe, hollow, with seats and a yoke", CanoeParameters, _canoe, ("kayak", "lake", "river", "float", "boat", "water")),
    Generator("raft", "raft of logs under lashed cross beams", RaftParameters, _raft, ("float", "logs", "river", "castaway", "boat", "water")),
)  # fmt: skip
