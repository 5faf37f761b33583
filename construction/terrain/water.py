"""Water bodies of a landscape: sea, lakes, rivers and streams (R35, R38-R40), found on its drainage.

Finding them changes nothing. `channels.carve` cuts the beds.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import ndimage

from ...worlds.arrays import F64
from .flood import Drainage
from .grid import Grid

__all__ = [
    "BANKFULL",
    "Lake",
    "River",
    "WaterBodies",
    "WaterLimits",
    "channel_depth",
    "channel_width",
    "find_lakes",
    "find_sea",
    "find_water",
]

YEAR_S = 365.25 * 86400
BANKFULL = 5.0
"""Bankfull over mean annual discharge. Own choice within the 2 to 10 usual for perennial rivers."""
GRAIN_M = 0.05
"""Median grain of a bed [m], coarse gravel; enters the depth with a power of -0.11."""
SOURCE_AREA = (2e3, 2e5)
"""Contributing area of the head of a stream [m^2]: Montgomery & Dietrich 1989 measured 2e2 to 2e5."""
SPACING = 4
"""Streams do not rise within so many cells of another."""
EIGHT = np.ones((3, 3), dtype=int)


def channel_width(discharge: F64) -> F64:
    """Width [m] of a channel with this mean discharge [m^3/s]: 3.33 Q_b^0.5 (Hey & Thorne 1986, thin bank vegetation)."""
    return np.asarray(3.33 * np.sqrt(BANKFULL * np.maximum(discharge, 0.0)))


def channel_depth(discharge: F64) -> F64:
    """Mean depth [m] of it: 0.22 Q_b^0.37 D_50^-0.11 (Hey & Thorne 1986)."""
    return np.asarray(0.22 * (BANKFULL * np.maximum(discharge, 0.0)) ** 0.37 * GRAIN_M**-0.11)


@dataclass(frozen=True)
class Lake:
    """A depression that holds water up to its outlet."""

    number: int
    """Its value in `WaterBodies.lake`."""
    level: float
    """[m]"""
    area: float
    """[m^2]"""
    volume: float
    """[m^3]"""
    depth: float
    """Largest depth [m]."""
    contributing_area: float
    """Area that drains into it, its own included [m^2]."""
    outlet: int
    """Flat index of the cell that its water leaves over."""


@dataclass(frozen=True)
class River:
    """One reach: from a source or a confluence to the next, to a lake, the sea or the edge. Arrays of shape (cells,)."""

    number: int
    kind: str
    """`river`, or `stream` for one from a source near a divide."""
    cells: np.ndarray
    """Flat indices, downstream; the last one belongs to what it flows into."""
    discharge: F64
    """Mean [m^3/s]."""
    order: int
    """Strahler order; 1 for streams."""
    ends_in: str
    """`river`, `lake`, `sea` or `edge`."""

    @property
    def width(self) -> F64:
        """[m]"""
        return channel_width(self.discharge)

    @property
    def depth(self) -> F64:
        """[m]"""
        return channel_depth(self.discharge)


@dataclass(frozen=True)
class WaterBodies:
    """All water of a landscape. Fields of shape (rows, cols)."""

    grid: Grid
    sea: np.ndarray
    """Below sea level and joined to the edge."""
    lake: np.ndarray
    """Number of the lake, 0 elsewhere."""
    lakes: tuple[Lake, ...]
    rivers: tuple[River, ...]
    discharge: F64
    """Mean annual discharge through every cell [m^3/s]."""
    threshold: float
    """Discharge from which a channel is a river [m^3/s]."""

    @property
    def standing(self) -> np.ndarray:
        """Sea and lakes."""
        return np.asarray(self.sea | (self.lake > 0))

    def channels(self, kind: str | None = None) -> np.ndarray:
        """Cells of the centre lines of rivers and streams, or of one kind."""
        found = np.zeros(self.grid.shape, dtype=bool)
        for river in self.rivers:
            if kind in (None, river.kind):
                found.flat[river.cells] = True
        return np.asarray(found & ~self.standing)


def find_sea(height: F64, sea_level: float | None, valid: np.ndarray) -> np.ndarray:
    """Cells below sea level that are joined to the edge of the grid by such cells."""
    if sea_level is None:
        return np.zeros(height.shape, dtype=bool)
    low = valid & (np.nan_to_num(height, nan=np.inf) < sea_level)
    label, _ = ndimage.label(low, EIGHT)
    edge = np.concatenate([label[0], label[-1], label[:, 0], label[:, -1]])
    return low & np.isin(label, np.unique(edge[edge > 0]))


def find_lakes(
    drainage: Drainage, sea: np.ndarray, *, least_area: float, least_depth: float
) -> tuple[np.ndarray, tuple[Lake, ...]]:
    """Lakes among the depressions: connected cells where the filled surface lies above the ground (R35).

    Args:
        drainage: of the ground.
        sea: cells that are no lake.
        least_area: smaller ones stay dry [m^2].
        least_depth: shallower ones stay dry [m].

    Returns:
        number of the lake per cell (largest volume first), and the lakes.
    """
    grid, area = drainage.grid, drainage.grid.cell_area
    depth = np.where(drainage.valid & ~sea, drainage.depth, 0.0)
    label, count = ndimage.label(depth > 0, EIGHT)
    if count == 0:
        return np.zeros(grid.shape, dtype=np.int32), ()
    flat, wet = label.ravel(), depth.ravel()
    cells = np.bincount(flat, minlength=count + 1)
    volume = np.bincount(flat, weights=wet, minlength=count + 1) * area
    below = np.flatnonzero(flat)
    deepest = np.zeros(count + 1)
    np.maximum.at(deepest, flat[below], wet[below])
    keep = (cells * area >= least_area) & (deepest >= least_depth)
    keep[0] = False
    kept = np.flatnonzero(keep)
    kept = kept[np.argsort(-volume[kept], kind="stable")]
    number = np.zeros(count + 1, dtype=np.int32)
    number[kept] = np.arange(1, len(kept) + 1)
    inside = np.flatnonzero(number[flat] > 0)
    target = drainage.receiver.ravel()[inside]
    leaving = inside[flat[target] != flat[inside]]
    through = drainage.accumulation().ravel()
    gathered = np.bincount(flat[leaving], weights=through[leaving], minlength=count + 1)
    outlet = np.full(count + 1, -1, dtype=np.int64)
    outlet[flat[leaving]] = drainage.receiver.ravel()[leaving]
    level = np.full(count + 1, -np.inf)
    level[flat[below]] = drainage.filled.ravel()[below]  # one level in each
    lakes = tuple(
        Lake(
            number=int(number[k]),
            level=float(level[k]),
            area=float(cells[k] * area),
            volume=float(volume[k]),
            depth=float(deepest[k]),
            contributing_area=float(gathered[k]),
            outlet=int(outlet[k]),
        )
        for k in kept
    )
    return number[label], lakes


@dataclass(frozen=True)
class WaterLimits:
    """Limits from which on land counts as under water."""

    sea_level: float | None
    """[m], None without a sea."""
    river_density: float
    """Length of rivers per area of land [m/m^2] that the channel threshold is chosen for (R38)."""
    stream_density: float
    """The same for streams above them."""
    least_lake_area: float
    """Smaller depressions stay dry [m^2]."""
    least_lake_depth: float
    """Shallower ones stay dry [m]."""


def find_water(
    drainage: Drainage, limits: WaterLimits, *, runoff: F64, inflow: F64 | None = None, rng: np.random.Generator
) -> WaterBodies:
    """Sea, lakes, rivers and streams.

    Args:
        drainage: of the ground.
        limits: from where on it is water.
        runoff: part of the rain that runs off [m/year], shape (rows, cols).
        inflow: water that enters from outside the grid [m^3/s], shape (rows, cols).
        rng: decides which sources are tried first.
    """
    sea = find_sea(drainage.height, limits.sea_level, drainage.valid)
    lake, lakes = find_lakes(drainage, sea, least_area=limits.least_lake_area, least_depth=limits.least_lake_depth)
    weight = runoff * (drainage.grid.cell_area / YEAR_S) + (0.0 if inflow is None else inflow)
    discharge = drainage.accumulation(weight)
    standing = sea | (lake > 0)
    channel, threshold = _channel(drainage, discharge, standing, limits.river_density, inflow)
    rivers = _reaches(drainage, channel, lake, sea, discharge)
    streams = _streams(drainage, channel, lake, sea, discharge, limits.stream_density, len(rivers), rng)
    return WaterBodies(
        grid=drainage.grid,
        sea=sea,
        lake=lake,
        lakes=lakes,
        rivers=(*rivers, *streams),
        discharge=discharge,
        threshold=threshold,
    )


def _steps(drainage: Drainage) -> F64:
    """Length of the way from each cell to its receiver [m], flat; 0 at outlets."""
    receiver = drainage.receiver.ravel()
    here, cols = np.arange(receiver.size), drainage.grid.cols
    rows = np.abs(receiver // cols - here // cols)
    across = np.abs(receiver % cols - here % cols)
    return np.where(receiver < 0, 0.0, np.hypot(rows, across) * drainage.grid.cell)


def _channel(
    drainage: Drainage, discharge: F64, standing: np.ndarray, density: float, inflow: F64 | None
) -> tuple[np.ndarray, float]:
    """Cells of rivers, closed downstream, and the discharge that made them so: the largest with the wanted length."""
    none = np.zeros(discharge.shape, dtype=bool)
    land = (drainage.valid & ~standing).ravel()
    wanted = density * land.sum() * drainage.grid.cell_area
    length = np.where(land, _steps(drainage), 0.0)
    flow = np.where(land, discharge.ravel(), 0.0)
    least = _least_flow(flow, length, wanted, drainage.grid.cell) if wanted > 0 else np.inf
    if inflow is not None and (inflow > 0).any():
        least = min(least, float(inflow[inflow > 0].min()))
    if not 0 < least < np.inf:
        return none, float("inf")
    return drainage.valid & (discharge >= least) & ~standing, least


def _least_flow(flow: F64, length: F64, wanted: float, cell: float) -> float:
    """The largest flow such that all ways [m] with at least as much add up to the wanted length."""
    # A way is at least a cell long, so that no more cells can be needed; those without a way come on top.
    most = min(int(wanted / cell) + int(((length == 0) & (flow > 0)).sum()) + 2, flow.size)
    if most < flow.size:
        top = np.flatnonzero(flow >= np.partition(flow, flow.size - most)[flow.size - most])
        flow, length = flow[top], length[top]
    order = np.argsort(-flow, kind="stable")
    reached = int(np.searchsorted(np.cumsum(length[order]), wanted))
    return float(flow[order[min(reached, order.size - 1)]])


def _reaches(drainage: Drainage, channel: np.ndarray, lake: np.ndarray, sea: np.ndarray, discharge: F64) -> list[River]:
    """Rivers cut at confluences, lakes and the sea."""
    from .flood_kernels import order_streams

    receiver, flat = drainage.receiver.ravel(), channel.ravel()
    members = np.flatnonzero(flat)
    if members.size == 0:
        return []
    # Lakes and sea carry the network on, so that orders do not start anew behind a lake.
    carried = (channel | (lake > 0) | sea).ravel()
    strahler = order_streams(carried & (discharge.ravel() >= discharge.ravel()[members].min()), receiver, drainage.order)
    target = receiver[members]
    onward = target != members
    feeders = np.bincount(target[onward & flat[target]], minlength=receiver.size)
    heads = [int(c) for c in members if feeders[c] != 1]
    found: list[River] = []
    for head in sorted(heads, key=lambda c: -discharge.ravel()[c]):
        cells = [head]
        while receiver[cells[-1]] != cells[-1]:
            cells.append(int(receiver[cells[-1]]))
            if not flat[cells[-1]] or feeders[cells[-1]] != 1:
                break
        found.append(_reach(len(found) + 1, "river", cells, int(strahler[head]), channel, lake, sea, discharge))
    return found


def _reach(
    number: int, kind: str, cells: list[int], order: int, channel: np.ndarray, lake: np.ndarray, sea: np.ndarray, discharge: F64
) -> River:
    end = cells[-1]
    into = "sea" if sea.flat[end] else "lake" if lake.flat[end] else "river" if channel.flat[end] else "edge"
    row, col = divmod(end, channel.shape[1])
    if into == "river" and kind == "river" and (row in (0, channel.shape[0] - 1) or col in (0, channel.shape[1] - 1)):
        into = "edge"  # its own last cell
    own = discharge.ravel()[np.array(cells)]
    if into in ("lake", "sea", "river") and len(cells) > 1:
        own[-1] = own[-2]  # the last cell carries what others bring, too
    return River(number, kind, np.array(cells), own, order, into)


def _streams(
    drainage: Drainage,
    channel: np.ndarray,
    lake: np.ndarray,
    sea: np.ndarray,
    discharge: F64,
    density: float,
    before: int,
    rng: np.random.Generator,
) -> list[River]:
    """Streams from sources near divides down to a river, a lake or the sea (R40), up to a length per area."""
    from .flood_kernels import inherit, trace

    grid, valid = drainage.grid, drainage.valid
    goal = channel | (lake > 0) | sea
    land = valid & ~goal
    if density <= 0 or not goal.any() or not land.any():
        return []
    receiver, order = drainage.receiver.ravel(), drainage.order
    area = drainage.accumulation().ravel()
    reachable = inherit(goal.ravel().astype(np.int8), goal.ravel(), receiver, order) > 0
    # A crest: nothing drains onto it. It parts two slopes, be they of one watershed or of two.
    crest = valid & (drainage.accumulation() < 1.5 * grid.cell_area)
    near = ndimage.distance_transform_edt(~(drainage.divides() | crest)) * grid.cell
    low = max(SOURCE_AREA[0], 2 * grid.cell_area)
    high = max(SOURCE_AREA[1], 8 * low)
    close = near.ravel() <= max(0.25 * np.sqrt(high), 3 * grid.cell)
    sources = np.flatnonzero(land.ravel() & reachable & close & (area >= low) & (area <= high))
    # High ground first, with some chance: the order of a draw without replacement, weighted by height.
    height = drainage.filled.ravel()[sources]
    rank = (height - height.min(initial=0.0)) / (np.ptp(height) + 1e-9) if sources.size else height
    sources = sources[np.argsort(-(rank + rng.uniform(0, 0.5, sources.size)), kind="stable")]
    joined, length = goal.copy(), 0.0
    blocked = ndimage.binary_dilation(channel, iterations=2)
    wanted = density * land.sum() * grid.cell_area
    steps = _steps(drainage)
    found: list[River] = []
    for source in sources:
        if length >= wanted:
            break
        if blocked.flat[source]:
            continue
        path = trace(source, joined.ravel(), receiver)
        if path.size < 4:
            continue
        found.append(_reach(before + len(found) + 1, "stream", [int(c) for c in path], 1, joined, lake, sea, discharge))
        joined.flat[path] = True
        length += float(steps[path[:-1]].sum())
        _mark(blocked, path, grid, SPACING)
    return found


def _mark(found: np.ndarray, path: np.ndarray, grid: Grid, reach: int) -> None:
    """Mark all cells within `reach` cells of a path."""
    row, col = path // grid.cols, path % grid.cols
    for dr in range(-reach, reach + 1):
        for dc in range(-reach, reach + 1):
            found[np.clip(row + dr, 0, grid.rows - 1), np.clip(col + dc, 0, grid.cols - 1)] = True
