"""Things carpentered or put up outdoors: plank bridges, scaffolds, tents, market stalls."""

from __future__ import annotations

import math

import numpy as np
from pydantic import Field

from .generator import Generator, Parameters, material
from .made import Body, Made, Place

__all__ = ["GENERATORS"]


class PlankBridgeParameters(Parameters):
    """A footbridge along x: two beams on sills, planks across them, railings with braces."""

    length: float = Field(default=3.6, ge=1.5, le=8.0, description="along x [m]")
    width: float = Field(default=1.1, ge=0.6, le=2.0, description="of the planks along y [m]")
    railings: bool = Field(default=True, description="posts and rails on both sides")
    plank: float = Field(default=0.17, ge=0.1, le=0.3, description="width of a plank, more where they would be too many [m]")
    sag: float = Field(default=0.008, ge=0.0, le=0.02, description="unevenness of the ends of planks [m]")
    material: str = material("oak", "larch", "spruce", "pine")


def _plank_bridge(p: PlankBridgeParameters, rng: np.random.Generator) -> Made:
    body = Body("footbridge", p.material)
    sill, thick, half = 0.12, 0.045, p.length / 2
    deep = 0.1 + 0.02 * p.length
    for s, side in ((-1, "left"), (1, "right")):
        a, b = sorted((s * half, s * (half - 0.2)))
        body.box(f"sill_{side}", (a, -p.width / 2 - 0.1, 0), (b, p.width / 2 + 0.1, sill))
    y, z = p.width / 2 - 0.16, sill + deep
    for s, side in ((-1, "front"), (1, "back")):
        body.box(f"beam_{side}", (-half, s * y - 0.07, sill), (half, s * y + 0.07, z))
    number = min(56, round(p.length / (p.plank + 0.012)))
    step = p.length / number
    rises = [float(v) for v in rng.uniform(0, 0.004, number)]
    for k, rise in enumerate(rises):
        x = -half + k * step
        ends = [p.width / 2 + float(rng.uniform(-1, 1)) * p.sag for _ in range(2)]
        c = 0.004
        points = [(u, v, h) for u, h in ((x + 0.006, z), (x + step - 0.006, z), (x + 0.006, z + thick - c + rise), (x + step - 0.006, z + thick - c + rise),
                  (x + 0.006 + c, z + thick + rise), (x + step - 0.006 - c, z + thick + rise)) for v in (-ends[0], ends[1])]  # fmt: skip
        body.hull(f"plank_{k + 1}", points)
    if p.railings:
        bays = max(1, round(p.length / 1.3))
        out, low = y + 0.07, sill + 0.01
        for s, side in ((-1, "front"), (1, "back")):
            for k in range(bays + 1):
                x = -half + 0.25 + (p.length - 0.5) * k / bays
                a, b = sorted((s * (p.width / 2 + 0.03), s * (p.width / 2 + 0.11)))
                body.box(f"post_{side}_{k + 1}", (x - 0.04, a, low), (x + 0.04, b, z + 1.0))
                inner = sorted((s * out, s * (p.width / 2 + 0.03)))
                body.box(f"bearer_{side}_{k + 1}", (x - 0.04, inner[0], low + 0.02), (x + 0.04, inner[1], z - 0.02))
            a, b = sorted((s * (p.width / 2 + 0.02), s * (p.width / 2 + 0.12)))
            body.box(f"handrail_{side}", (-half + 0.1, a, z + 1.0), (half - 0.1, b, z + 1.05))
            a, b = sorted((s * (p.width / 2 + 0.005), s * (p.width / 2 + 0.03)))
            body.box(f"rail_{side}", (-half + 0.1, a, z + 0.5), (half - 0.1, b, z + 0.6))
    made = Made.of(body)
    x = -half + (number // 2 + 0.5) * step
    made.places["deck"] = Place((x, 0, z + thick + rises[number // 2]), (p.length - 0.4, p.width - 0.1))
    return made


class ScaffoldParameters(Parameters):
    """Scaffold of tubes along x: standards on base plates, ledgers, transoms, decks of planks, braces."""

    length: float = Field(default=4.0, ge=2.0, le=8.0, description="along x [m]")
    depth: float = Field(default=0.9, ge=0.7, le=1.5, description="along y [m]")
    levels: int = Field(default=2, ge=1, le=3, description="decks")
    lift: float = Field(default=2.0, ge=1.6, le=2.2, description="height between decks [m]")
    wood: str = material("spruce", "pine", "plywood", of="decks")
    material: str = material("mild_steel", "aluminium_alloy")


def _scaffold(p: ScaffoldParameters, rng: np.random.Generator) -> Made:
    body = Body("scaffold", p.material)
    r = 0.024
    bays = max(1, math.ceil(p.length / 2.4))
    pitch, y, top = (p.length - 0.1) / bays, p.depth / 2, p.levels * p.lift + 1.05
    xs = [-p.length / 2 + 0.05 + k * pitch for k in range(bays + 1)]
    end = p.length / 2
    for s, side in ((-1, "front"), (1, "back")):
        for k, x in enumerate(xs, start=1):
            body.box(f"base_{side}_{k}", (x - 0.075, s * y - 0.075, 0), (x + 0.075, s * y + 0.075, 0.01))
            body.cylinder(f"standard_{side}_{k}", (x, s * y, 0.01), (x, s * y, top), r)
        for level in range(1, p.levels + 1):
            z = level * p.lift - 0.12
            body.cylinder(f"ledger_{side}_{level}", (-end, s * (y + 2 * r), z), (end, s * (y + 2 * r), z), r)
            for j, up in enumerate((0.55, 1.0) if s < 0 or level == p.levels else (), start=1):
                body.cylinder(
                    f"guard_{side}_{level}_{j}", (-end, s * (y - 2 * r), z + 0.12 + up), (end, s * (y - 2 * r), z + 0.12 + up), r
                )
    for level in range(1, p.levels + 1):
        z = level * p.lift - 0.12 + 2 * r
        for k, x in enumerate(xs, start=1):
            by = 2 * r if k < len(xs) else -2 * r
            body.cylinder(f"transom_{level}_{k}", (x + by, -y - 0.12, z), (x + by, y + 0.12, z), r)
        wide = p.depth - 2 * r - 0.12
        count = max(2, round(wide / 0.22))
        step = wide / count
        for j in range(count):
            v = -wide / 2 + j * step
            rough = float(rng.uniform(0, 0.05))
            body.box(
                f"plank_{level}_{j + 1}",
                (-end + rough, v + 0.003, z + r),
                (end - rough, v + step - 0.003, z + r + 0.038),
                material=p.wood,
            )
    for level in range(p.levels):
        low, high = level * p.lift + 0.25, (level + 1) * p.lift - 0.35
        a, b = (xs[0], xs[1]) if level % 2 == 0 else (xs[1], xs[0])
        body.cylinder(f"brace_{level + 1}", (a, y + 2 * r, low), (b, y + 2 * r, high), r)
    made = Made.of(body)
    for level in range(1, p.levels + 1):
        z = level * p.lift - 0.12 + 3 * r + 0.038
        made.places[f"deck_{level}"] = Place(
            (0, step / 2 if count % 2 == 0 else 0, z),
            (p.length - 0.4, p.depth - 0.4),
            p.lift - 0.3 if level < p.levels else math.inf,
        )
    return made


class TentFrameParameters(Parameters):
    """A ridge tent: crossed poles at both ends, a ridge pole, sheets of cloth as stiff panels, pegs at its foot."""

    length: float = Field(default=2.4, ge=1.4, le=5.0, description="along y [m]")
    width: float = Field(default=1.9, ge=1.2, le=3.5, description="along x [m]")
    height: float = Field(default=1.5, ge=0.9, le=2.6, description="of the ridge pole [m]")
    cover: bool = Field(default=True, description="panels of cloth on both slopes; without them the bare frame")
    cloth: str = material("cotton", "linen", "nylon_fabric", "wool", of="cover")
    material: str = material("ash", "pine", "bamboo", "aluminium_alloy")


def _tent_frame(p: TentFrameParameters, rng: np.random.Generator) -> Made:
    body = Body("tent", p.material)
    r, half, long = 0.022, p.width / 2, p.length / 2
    body.cylinder("ridge", (0, -long - 0.12, p.height), (0, long + 0.12, p.height), r)
    slope = math.atan2(p.height, half)
    # A pole leans against the ridge from either side; one passes before the other.
    for s, name in ((-1, "left"), (1, "right")):
        for t, end in ((-1, "front"), (1, "back")):
            y = t * (long - (0.0 if s < 0 else 2 * r + 0.002))
            along = np.array([-s * math.cos(slope), 0.0, math.sin(slope)])
            out = np.array([s * math.sin(slope), 0.0, math.cos(slope)])
            head = np.array([0.0, y, p.height]) + 2 * r * out
            low = head - along * (float(head[2]) / math.sin(slope))
            top = head + along * 0.12
            ring = [np.array([0, math.cos(u), 0]) * r + out * (math.sin(u) * r) for u in np.linspace(0, 2 * math.pi, 13)[:-1]]
            foot = [low + d + along * (-(low + d)[2] / math.sin(slope)) for d in ring]
            body.hull(f"pole_{name}_{end}", [*foot, *(top + d for d in ring)])
    if p.cover:
        _cover(body, p, slope, r)
    return Made.of(body)


def _cover(body: Body, p: TentFrameParameters, slope: float, r: float) -> None:
    """Sheets that lie on the poles, with a hem, and pegs along it."""
    long, thick = p.length / 2 + 0.06, 0.006
    for s, name in ((-1, "left"), (1, "right")):
        along = np.array([-s * math.cos(slope), 0.0, math.sin(slope)])
        out = np.array([s * math.sin(slope), 0.0, math.cos(slope)])
        head = np.array([0.0, 0.0, p.height]) + 3 * r * out
        start, end = 0.02, float(head[2]) / math.sin(slope) - 0.1
        folds = 6
        for k in range(folds):
            a, b = start + (end - start) * k / folds, start + (end - start) * (k + 1) / folds
            points = [
                head - along * d + out * t + np.array([0, y, 0]) for d in (a, b) for t in (0.0, thick) for y in (-long, long)
            ]
            body.hull(f"sheet_{name}_{k + 1}", points, material=p.cloth)


class MarketStallParameters(Parameters):
    """A counter with a shelf under it, posts and a sloping striped awning."""

    width: float = Field(default=2.2, ge=1.4, le=4.0, description="along x [m]")
    depth: float = Field(default=0.9, ge=0.6, le=1.4, description="of the counter [m]")
    counter: float = Field(default=0.85, ge=0.7, le=1.0, description="height of the counter [m]")
    height: float = Field(default=2.35, ge=2.0, le=2.8, description="of the awning at the back [m]")
    stripes: int = Field(default=9, ge=5, le=15, description="of the awning")
    cloth: str = material("cotton", "linen", "polyester", of="awning")
    stripe: str = material("leather", "felt", "wool", of="every other stripe")
    material: str = material("pine", "spruce", "oak", "beech")


def _market_stall(p: MarketStallParameters, rng: np.random.Generator) -> Made:
    body = Body("market stall", p.material)
    made = Made.of(body)
    x, y, post, top = p.width / 2, p.depth / 2, 0.06, 0.03
    levels = {"front": p.height - 0.5, "back": p.height - 0.06}
    for s, side in ((-1, "left"), (1, "right")):
        for t, end in ((-1, "front"), (1, "back")):
            a, b = sorted((s * x, s * (x - post)))
            c, d = sorted((t * y, t * (y - post)))
            body.box(f"post_{side}_{end}", (a, c, 0), (b, d, levels[end]))
    inner, deep = x - post, y - post
    boards = max(3, round(p.depth / 0.16))
    for k in range(boards):
        c, d = -y + p.depth * k / boards, -y + p.depth * (k + 1) / boards
        outer = inner if k in (0, boards - 1) or c < -deep - 1e-9 or d > deep + 1e-9 else x
        body.box(f"counter_{k + 1}", (-outer, c, p.counter - top), (outer, d, p.counter))
    body.box("apron_front", (-inner, -y, p.counter - top - 0.14), (inner, -y + 0.022, p.counter - top))
    body.box("apron_back", (-inner, y - 0.022, p.counter - top - 0.14), (inner, y, p.counter - top))
    for s, side in ((-1, "left"), (1, "right")):
        a, b = sorted((s * x, s * (x - 0.03)))
        body.box(f"rail_{side}", (a, -deep, 0.16), (b, deep, 0.21))
        body.box(f"bearer_{side}", (a, -deep, p.counter - top - 0.1), (b, deep, p.counter - top))
    for k in range(3):
        c, d = -deep + 2 * deep * k / 3 + 0.01, -deep + 2 * deep * (k + 1) / 3 - 0.01
        body.box(f"shelf_{k + 1}", (-x, c, 0.21), (x, d, 0.235))
    _awning(body, p, (x, y), levels)
    made.places["counter"] = Place(
        (0, (0.5 / boards) * p.depth if boards % 2 == 0 else 0, p.counter),
        (2 * inner - 0.1, 2 * deep - 0.1),
        levels["front"] - p.counter - 0.1,
    )
    made.places["shelf"] = Place((0, 0, 0.235), (2 * inner - 0.1, 0.6 * deep), p.counter - 0.45)
    return made


def _awning(body: Body, p: MarketStallParameters, half: tuple[float, float], levels: dict[str, float]) -> None:
    """Bars on the posts, stripes on the bars down to a scalloped hem at the front."""
    x, y = half
    fall = (levels["back"] - levels["front"]) / (2 * y)
    out, thick = 0.3, 0.008

    def line(v: float) -> float:
        return levels["back"] + 0.05 + (v - y) * fall

    for t, end in ((-1, "front"), (1, "back")):
        c, d = sorted((t * y, t * (y - 0.06)))
        body.hull(f"bar_{end}", [(a, v, z) for a in (-x, x) for v in (c, d) for z in (levels[end], line(v))])
    reach = x + 0.06
    for k in range(p.stripes):
        a, b = -reach + 2 * reach * k / p.stripes, -reach + 2 * reach * (k + 1) / p.stripes
        cloth = p.cloth if k % 2 == 0 else p.stripe
        body.hull(
            f"stripe_{k + 1}",
            [(u, v, line(v) + t) for u in (a, b) for v in (-y - out, y + 0.06) for t in (0.0, thick)],
            material=cloth,
        )
        edge, z = -y - out, line(-y - out)
        hem = [
            (a, z),
            (b, z),
            (b, z - 0.1),
            ((3 * b + a) / 4, z - 0.14),
            ((a + b) / 2, z - 0.15),
            ((3 * a + b) / 4, z - 0.14),
            (a, z - 0.1),
        ]
        body.hull(f"hem_{k + 1}", [(u, v, h) for u, h in hem for v in (edge, edge + 0.005)], material=cloth)


GENERATORS = (
    Generator("plank_bridge", "footbridge of planks on two beams with railings", PlankBridgeParameters, _plank_bridge,
              ("stream", "wood", "walkway", "jetty", "crossing"), motion="static"),
    Generator("scaffold", "scaffold of tubes with decks of planks, guard rails and braces", ScaffoldParameters, _scaffold,
              ("construction", "building", "site", "tubes", "platform"), motion="static"),
    Generator("tent_frame", "ridge tent: leaning poles, a ridge pole and a cover", TentFrameParameters, _tent_frame,
              ("camp", "camping", "shelter", "canvas", "ridge", "tent")),
    Generator("market_stall", "market stall with a counter, a shelf and a striped awning", MarketStallParameters, _market_stall,
              ("shop", "street", "village", "fair", "booth", "awning", "fruit")),
)  # fmt: skip
