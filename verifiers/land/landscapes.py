"""Landscapes against truths of their own: fill by morphological reconstruction, routing link by link, ledgers cell by cell.

Nothing here shares code with construction: the file of the built landscape is all that both know.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from scipy import ndimage
from scipy.spatial import cKDTree

from ...worlds.arrays import F64
from ...worlds.landscape import SavedLandscape
from ...worlds.spec.terrain import Terrain
from .bounds import LEVEL_M
from .clearings import in_clearings, line_distance

__all__ = [
    "Measurement",
    "drainage_finding",
    "fill_finding",
    "ledger_finding",
    "plant_finding",
    "water_finding",
]

D8 = {1: (0, 1), 2: (-1, 1), 4: (-1, 0), 8: (-1, -1), 16: (0, -1), 32: (1, -1), 64: (1, 0), 128: (1, 1)}
"""Code -> (row step, column step); row 0 is south."""
OUTLET, NO_LAND = 0, 247


class Measurement(NamedTuple):
    """Result of one measurement of a landscape."""

    measured: float
    text: str
    place: tuple[float, float] | None = None
    """Where it is worst, x and y [m]."""


def _place(land: SavedLandscape, index: int) -> tuple[float, float]:
    rows, cols = land.shape
    row, col = divmod(int(index), cols)
    return (col - 0.5 * (cols - 1)) * land.cell, (row - 0.5 * (rows - 1)) * land.cell


def fill_finding(land: SavedLandscape) -> Measurement:
    """Difference between the kept fill and greyscale reconstruction (Soille & Gratin 1994) of the ground [m]."""
    from skimage.morphology import reconstruction

    ground, filled = land.field("ground"), land.field("filled")
    valid = np.isfinite(ground)
    top = float(np.nanmax(ground))
    solid = np.where(valid, ground, float(np.nanmin(ground)) - 1.0)  # water leaves into what is no land
    seed = np.full(solid.shape, top)
    edge = np.ones(solid.shape, dtype=bool)
    edge[1:-1, 1:-1] = False
    seed[edge | ~valid] = solid[edge | ~valid]
    truth = reconstruction(seed, solid, method="erosion", footprint=np.ones((3, 3)))
    error = np.where(valid, np.abs(truth - np.where(valid, filled, truth)), 0.0)
    error = np.where(np.isfinite(error), error, np.inf)
    worst = int(error.argmax())
    return Measurement(
        float(error.max()), f"fill differs from reconstruction by at most {error.max():.3g} m", _place(land, worst)
    )


def drainage_finding(land: SavedLandscape) -> Measurement:
    """Cells whose link is not the steepest way down, runs in a circle, or whose area is not that of all upstream."""
    code, filled = land.raw("flow_direction"), land.field("filled")
    rows, cols = land.shape
    here = np.arange(rows * cols).reshape(rows, cols)
    land_cells = code != NO_LAND
    receiver = here.copy()
    known = (code == OUTLET) | ~land_cells
    own = np.zeros((rows, cols))
    steepest = np.zeros((rows, cols))
    level = np.where(np.isfinite(filled), filled, np.inf)
    padded = np.pad(level, 1, constant_values=np.inf)
    for value, (dr, dc) in D8.items():
        there = padded[1 + dr : 1 + dr + rows, 1 + dc : 1 + dc + cols]
        with np.errstate(invalid="ignore"):
            fall = (level - there) / np.hypot(dr, dc)
        fall = np.where(np.isfinite(there) & np.isfinite(level), fall, -np.inf)
        steepest = np.maximum(steepest, fall)
        chosen = code == value
        own = np.where(chosen, fall, own)
        known |= chosen
        inside = chosen & np.isfinite(there)
        receiver[inside] = (here + dr * cols + dc)[inside]
    bad = land_cells & (~known | (own < steepest))
    # Following all links at once, twice as far each time: whoever has not left after n cells runs in a circle.
    end = receiver.ravel().copy()
    for _ in range(int(np.ceil(np.log2(rows * cols))) + 1):
        end = end[end]
    bad |= land_cells & (receiver.ravel()[end] != end).reshape(rows, cols)
    area, cell = land.field("accumulation"), land.cell**2
    gathered = np.full(rows * cols, cell)
    links = land_cells.ravel() & (receiver.ravel() != here.ravel())
    np.add.at(gathered, receiver.ravel()[links], area.ravel()[links])
    wrong = land_cells & (np.abs(gathered.reshape(rows, cols) - area) > 1e-9 * np.maximum(area, cell))
    bad |= wrong
    count = int(bad.sum())
    text = f"{count:,} of {int(land_cells.sum()):,} cells drain otherwise than steepest descent, in circles, or lose area"
    return Measurement(float(count), text, _place(land, int(bad.argmax())) if count else None)


def water_finding(land: SavedLandscape, terrain: Terrain) -> Measurement:
    """Water that does not lie as water does: lakes with two levels or over dry ground, reaches that rise or end nowhere."""
    problems: list[tuple[str, int]] = []
    ground, filled, lake = land.field("ground"), land.field("filled"), land.raw("lake")
    sea, wet = land.raw("sea").astype(bool), land.raw("wet").astype(bool)
    for entry in land.about["lakes"]:
        inside = lake == entry["number"]
        if not inside.any():
            problems.append((f"lake {entry['number']} has no cells", 0))
            continue
        at = int(inside.argmax())
        if np.abs(filled[inside] - entry["level"]).max() > LEVEL_M:
            problems.append((f"lake {entry['number']} is not level", at))
        volume = float((entry["level"] - ground[inside]).sum()) * land.cell**2
        if abs(volume - entry["volume"]) > 1e-6 * max(volume, 1.0) or (entry["level"] <= ground[inside]).any():
            problems.append((f"lake {entry['number']} of {entry['volume']:.4g} m^3 holds {volume:.4g} m^3", at))
        if ndimage.label(inside, np.ones((3, 3)))[1] != 1:
            problems.append((f"lake {entry['number']} is in pieces", at))
    if terrain.sea_level is not None and sea.any() and (ground[sea] >= terrain.sea_level).any():
        problems.append(("sea above sea level", int((sea & (ground >= terrain.sea_level)).argmax())))
    channel = np.zeros(land.shape, dtype=bool)
    for reach in land.about["reaches"]:
        channel.flat[reach["cells"]] = True
    for reach in land.about["reaches"]:
        problems += _reach_problems(land, reach, filled, lake, sea, channel)
    if not (wet[sea].all() and wet[lake > 0].all()):
        problems.append(("the water mask leaves out standing water", int(((sea | (lake > 0)) & ~wet).argmax())))
    text = (
        "; ".join(t for t, _ in problems[:4])
        or f"{len(land.about['lakes'])} lakes and {len(land.about['reaches'])} reaches lie as water does"
    )
    return Measurement(float(len(problems)), text, _place(land, problems[0][1]) if problems else None)


def _reach_problems(
    land: SavedLandscape, reach: dict[str, object], filled: F64, lake: np.ndarray, sea: np.ndarray, channel: np.ndarray
) -> list[tuple[str, int]]:
    rows, cols = land.shape
    cells = np.asarray(reach["cells"], dtype=np.int64)
    name = f"{reach['kind']} {reach['number']}"
    step = np.maximum(np.abs(np.diff(cells // cols)), np.abs(np.diff(cells % cols)))
    if len(step) and step.max() > 1:
        return [(f"{name} has a gap", int(cells[int(step.argmax())]))]
    level = filled.ravel()[cells]
    if (np.diff(level) > 0).any():
        return [(f"{name} flows uphill", int(cells[int(np.diff(level).argmax())]))]
    end = int(cells[-1])
    row, col = divmod(end, cols)
    edge = row in (0, rows - 1) or col in (0, cols - 1)
    met = {"lake": bool(lake.flat[end] > 0), "sea": bool(sea.flat[end]), "river": bool(channel.flat[end]), "edge": edge}
    if not met.get(str(reach["ends_in"]), False) or (reach["kind"] == "stream" and reach["ends_in"] == "edge"):
        return [(f"{name} ends nowhere", end)]
    return []


def ledger_finding(land: SavedLandscape) -> Measurement:
    """Mass that erosion lost or made, relative to what it moved: ground = start + uplift + works - wear + deposit in every cell."""
    ground, start = land.field("ground"), land.field("start")
    wear, deposit, uplift, works = (land.field(n) for n in ("wear", "deposit", "uplift", "earthworks"))
    valid = np.isfinite(start) & np.isfinite(ground)
    gap = np.where(valid, np.abs(ground - start - uplift - works + wear - deposit), 0.0)
    figures = land.about["figures"]
    ledgers = [figures[k] for k in ("river_erosion", "hydraulic_erosion") if k in figures]
    moved = float(wear[valid].sum() + deposit[valid].sum()) * land.cell**2
    lost = float(gap.sum()) * land.cell**2 / max(moved, 1e-9)
    text = f"cells miss {lost:.2g} of what was moved ({moved:.4g} m^3)"
    if ledgers:
        written, worn = (sum(ledger[k] for ledger in ledgers) for k in ("exported", "worn"))
        exported = float((wear - deposit)[valid].sum()) * land.cell**2
        lost = max(lost, abs(exported - written) / max(abs(worn), 1e-9))
        text += f"; {exported:.6g} m^3 left the land, the ledger says {written:.6g}"
    return Measurement(lost if np.isfinite(lost) else float("inf"), text, _place(land, int(gap.argmax())))


def plant_finding(land: SavedLandscape, terrain: Terrain, outlines: Mapping[str, F64]) -> Measurement:
    """Plants in water, on beds or roads, off the ground, nearer to each other than both need, or in a clearing.

    Args:
        land: as built.
        terrain: what it is built from.
        outlines: corners (n, 2) [m], in order, of what entities cover in plan.
    """
    if "plant_position" not in land.names:
        return Measurement(0.0, "nothing is planted")
    position, radius = land.raw("plant_position"), land.raw("plant_radius").astype(np.float64)
    rows, cols = land.shape
    col = np.clip(np.round(position[:, 0] / land.cell + 0.5 * (cols - 1)), 0, cols - 1).astype(int)
    row = np.clip(np.round(position[:, 1] / land.cell + 0.5 * (rows - 1)), 0, rows - 1).astype(int)
    drowned = (land.raw("wet").astype(bool) | land.raw("bed").astype(bool))[row, col]
    height = land.field("height")
    v, u = position[:, 1] / land.cell + 0.5 * (rows - 1), position[:, 0] / land.cell + 0.5 * (cols - 1)
    ground = ndimage.map_coordinates(height, np.stack([v, u]), order=1, mode="nearest")
    floating = np.abs(position[:, 2] - ground) > 0.01
    paved = np.zeros(len(position), dtype=bool)
    for layer in terrain.layers.values():
        if layer.kind == "road":
            paved |= line_distance(position[:, :2], np.array(layer.line)) <= 0.5 * layer.width
    crowded = np.zeros(len(position), dtype=bool)
    if len(position) > 1:
        pairs = cKDTree(position[:, :2]).query_pairs(2.0 * float(radius.max()), output_type="ndarray")
        apart = np.hypot(*(position[pairs[:, 0], :2] - position[pairs[:, 1], :2]).T)
        near = pairs[apart < (radius[pairs[:, 0]] + radius[pairs[:, 1]]) * (1 - 1e-5)]
        crowded[near[:, 1]] = True
    trespassing = in_clearings(position[:, :2], terrain, outlines)
    counts = {
        "in water or a bed": drowned,
        "on a road": paved,
        "off the ground": floating,
        "too near to another": crowded,
        "in a clearing or its margin": trespassing,
    }
    bad = drowned | paved | floating | crowded | trespassing
    text = (
        ", ".join(f"{int(v.sum())} {k}" for k, v in counts.items() if v.any()) or f"{len(position):,} plants stand where they may"
    )
    place = (float(position[bad.argmax(), 0]), float(position[bad.argmax(), 1])) if bad.any() else None
    return Measurement(float(bad.sum()), text, place)
