"""Books: one, a row of them, a pile of them."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

import numpy as np
from pydantic import Field

from ...worlds.spec import Pose
from .generator import Generator, Parameters, material
from .made import Body, Made, Place
from .profiles import arc

__all__ = ["GENERATORS"]

COVERS = ("leather", "carpet", "linen", "felt", "cardboard", "cotton", "polyester", "mahogany", "slate")
"""Rows whose colours a shelf of books shows, drawn by seed."""
GAP = 1.01e-3
"""[m] Between two books."""


class _Sizes:
    """One book: thickness, depth, height [m], bands over its spine."""

    def __init__(self, rng: np.random.Generator, thick: float, depth: float, height: float) -> None:
        self.thick, self.depth, self.height = thick, depth, height
        self.bands = int(rng.integers(0, 5))
        self.board = min(0.003, 0.14 * thick)
        self.bulge = float(rng.uniform(0.1, 0.25)) * thick


def _bind(body: Body, at: tuple[float, float], s: _Sizes, *, upright: bool, prefix: str = "") -> None:
    """Add a book: boards, a round spine with bands, a recessed block of pages.

    Args:
        body: it is added to.
        at: least x and y of its middle plane upright: x of its left board; lying: z of its lower board and 0.
        s: its sizes.
        upright: thickness along x and spine at the front, else thickness along z and spine to the left.
        prefix: of the names of its parts.
    """
    t0, c, edge = at[0], s.board, 0.0025
    back, front = at[1] + s.depth / 2, at[1] - s.depth / 2

    def box(name: str, low: tuple[float, float, float], high: tuple[float, float, float], of: str | None = None) -> None:
        order = (0, 1, 2) if upright else (1, 2, 0)
        body.box(prefix + name, [low[k] for k in order], [high[k] for k in order], material=of)

    h0, h1 = (0.0, s.height) if upright else (-s.height / 2, s.height / 2)
    spine = front + s.bulge + 0.0015
    box("board_1", (t0, spine, h0), (t0 + c, back, h1))
    box("board_2", (t0 + s.thick - c, spine, h0), (t0 + s.thick, back, h1))
    box("pages", (t0 + c, spine, h0 + edge), (t0 + s.thick - c, back - edge, h1 - edge), "books")
    levels = [(h0, h1, 0.0)]
    if s.bands:
        step, wide = s.height / (s.bands + 1), 0.006
        cuts = [h0 + step * (k + 1) for k in range(s.bands)]
        ends = [h0, *(e for q in cuts for e in (q - wide / 2, q + wide / 2)), h1]
        levels = [(a, b, 0.0012 * (k % 2)) for k, (a, b) in enumerate(itertools.pairwise(ends))]
    half = s.thick / 2
    for k, (a, b, proud) in enumerate(levels, start=1):
        rise = s.bulge + proud
        r = (half * half + rise * rise) / (2 * rise)
        spread = 2 * math.atan(rise / half)
        bow = arc((t0 + half, spine - rise + r), r, -math.pi / 2 - spread, -math.pi / 2 + spread, 6)
        outline = bow if upright else [(d, t) for t, d in bow]
        body.prism(f"{prefix}spine_{k}", outline, a, b, axis="z" if upright else "y")


class BookParameters(Parameters):
    """A closed book, lying or standing."""

    height: float = Field(default=0.22, ge=0.14, le=0.34, description="of the spine [m]")
    depth: float = Field(default=0.15, ge=0.1, le=0.24, description="from spine to fore edge [m]")
    thickness: float = Field(default=0.03, ge=0.012, le=0.07, description="[m]")
    upright: bool = Field(default=False, description="standing with its spine in front, else lying")
    material: str = material(*COVERS)


def _book(p: BookParameters, rng: np.random.Generator) -> Made:
    body = Body("book", p.material)
    sizes = _Sizes(rng, p.thickness, p.depth, p.height)
    _bind(body, (-p.thickness / 2 if p.upright else 0.0, 0.0), sizes, upright=p.upright)
    made = Made.of(body)
    if not p.upright:
        made.places["top"] = Place((0, 0, p.thickness), (0.8 * p.depth, 0.8 * p.height))
    return made


class RowOfBooksParameters(Parameters):
    """Books side by side, spines in front, fore edges behind; of various sizes and covers."""

    count: int = Field(default=9, ge=2, le=30, description="books")
    height: float = Field(default=0.24, ge=0.16, le=0.32, description="of the highest [m]")
    depth: float = Field(default=0.17, ge=0.11, le=0.24, description="of the deepest [m]")
    thickness: float = Field(default=0.032, ge=0.018, le=0.05, description="mean of them [m]")
    variety: float = Field(default=0.5, ge=0.0, le=1.0, description="of their sizes: 0 a set of equal volumes, 1 all sorts")
    leaning: int = Field(default=1, ge=0, le=3, description="of the last that lean on the others, at most a quarter of them")
    one_body: bool = Field(default=False, description="one body for all of them, with plain spines, else each may be moved")


def _various(rng: np.random.Generator, variety: float, thick: float, depth: float, height: float) -> _Sizes:
    less = 1 - variety * rng.uniform(0.0, 0.35)
    return _Sizes(
        rng,
        float(thick * (1 + variety * rng.uniform(-0.5, 0.5))),
        float(depth * (less + (1 - less) * rng.uniform(0, 0.5))),
        float(height * less),
    )


def _cover(rng: np.random.Generator) -> str:
    return COVERS[int(rng.integers(len(COVERS)))]


def _spots(sizes: Sequence[_Sizes], leaning: int, gap: float, rng: np.random.Generator) -> tuple[list[float], float]:
    """Places along x [m] of the lower left edges of books, about the middle of the row, and the lean of the last of them [rad]."""
    tilt = math.radians(float(rng.uniform(10.0, 15.0)))
    for own in sizes[len(sizes) - leaning :]:
        tilt = max(tilt, math.atan(1.3 * own.thick / own.height))
    first, x, found = len(sizes) - leaning, 0.0, []
    for number, own in enumerate(sizes):
        if number == first:
            before = sizes[number - 1].height
            x += (own.height * math.sin(tilt) if own.height * math.cos(tilt) <= before else before * math.tan(tilt)) + 0.1 * gap
        found.append(x)
        x += (own.thick + gap) / (math.cos(tilt) if number >= first else 1.0)
    last = sizes[-1].thick
    width = found[-1] + last * (math.cos(tilt) if leaning else 1.0)
    return [q - width / 2 for q in found], tilt


def _tilted(body: Body, x: float, tilt: float) -> None:
    """Turn parts that stand upright about the level edge (x, 0) along y, their tops to the left."""
    for key, part in body.parts.items():
        a, b, c = part.pose.position
        at = (x + (a - x) * math.cos(tilt) - c * math.sin(tilt), b, (a - x) * math.sin(tilt) + c * math.cos(tilt))
        body.parts[key] = part.model_copy(update={"pose": Pose(position=at, euler=(0.0, -tilt, 0.0))})


def _row_of_books(p: RowOfBooksParameters, rng: np.random.Generator) -> Made:
    sizes = [_various(rng, p.variety, p.thickness, p.depth, p.height) for _ in range(p.count)]
    leaning = min(p.leaning, p.count // 4)
    if any(own.thick > 0.3 * own.height for own in sizes[p.count - leaning :]):
        leaning = 0
    spots, tilt = _spots(sizes, leaning, 0.0 if p.one_body else GAP, rng)
    covers = [_cover(rng) for _ in sizes] if p.variety > 0 else [_cover(rng)] * p.count
    made = Made({})
    for number, (own, x, cover) in enumerate(zip(sizes, spots, covers, strict=True), start=1):
        body = Body("book", cover)
        own.bands = 0 if p.one_body else own.bands
        _bind(body, (x, (own.depth - p.depth) / 2), own, upright=True, prefix=f"book_{number}_" if p.one_body else "")
        if number > p.count - leaning:
            _tilted(body, x, tilt)
        name = f"book_{number}" if number > 1 else ""
        if not p.one_body:
            made.bodies[name] = body
            if number > p.count - leaning:
                made.carries.append((f"book_{number - 1}", name))
            continue
        whole = made.bodies.setdefault("", Body("row of books", cover))
        for key, part in body.parts.items():
            given = part.material or (None if cover == whole.material else cover)
            whole.parts[key] = part.model_copy(update={"material": given})
    return made


class PileOfBooksParameters(Parameters):
    """Books that lie loosely on each other, a little askew, larger ones below."""

    count: int = Field(default=5, ge=2, le=12, description="books")
    height: float = Field(default=0.26, ge=0.18, le=0.32, description="spine of the largest [m]")
    depth: float = Field(default=0.19, ge=0.12, le=0.24, description="of the largest [m]")
    thickness: float = Field(default=0.032, ge=0.018, le=0.05, description="mean of them [m]")
    variety: float = Field(default=0.6, ge=0.0, le=1.0, description="of their sizes and how far they lie askew")


def _pile_of_books(p: PileOfBooksParameters, rng: np.random.Generator) -> Made:
    sizes = [_various(rng, p.variety, p.thickness, p.depth, p.height) for _ in range(p.count)]
    sizes.sort(key=lambda s: -s.height)
    made, z, before = Made({}), 0.0, None
    for number, own in enumerate(sizes, start=1):
        body = Body("book", _cover(rng))
        _bind(body, (z, float(p.variety * rng.uniform(-0.006, 0.006))), own, upright=False)
        name = f"book_{number}" if number > 1 else ""
        made.bodies[name] = body
        if before is not None:
            made.carries.append((before, name))
        before, z = name, z + own.thick + GAP
    made.places["top"] = Place((0, 0, z - GAP), (0.7 * sizes[-1].depth, 0.7 * sizes[-1].height), body=before or "")
    return made


GENERATORS = (
    Generator("book", "closed book, lying or standing", BookParameters, _book, ("novel", "volume", "library", "reading", "shelf")),
    Generator(
        "row_of_books", "row of standing books, each loose or one body for all", RowOfBooksParameters, _row_of_books,
        ("library", "volumes", "bookcase", "shelf", "study", "clutter"),
    ),
    Generator(
        "pile_of_books", "books that lie loosely on each other", PileOfBooksParameters, _pile_of_books,
        ("stack", "library", "volumes", "desk", "study", "clutter"),
    ),
)  # fmt: skip
