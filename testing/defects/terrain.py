"""Seeded defects of landscapes: wrong fills, water, ledgers, plants and grounds, and landscapes that only look wrong."""

from __future__ import annotations

import copy
import tempfile
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from ...construction.store import build_world
from ...construction.terrain.store import build_terrain_file, cut_patch
from ...verifiers.land.bounds import LEDGER, LEVEL_M, PATCH_M, SEAM
from ...verifiers.land.landscapes import D8
from ...worlds.arrays import F64
from ...worlds.built import TriangleMesh
from ...worlds.candidate import Candidate
from ...worlds.folder import WorldFolder
from ...worlds.landscape import SavedLandscape, save_landscape
from ...worlds.spec import WorldSpec
from .cases import Mechanism, Suite, World

__all__ = ["SUITE"]

RNG = np.random.Generator
CELLS, CELL, VARIANTS = 72, 12.0, 3
FLOATING_M = 0.01
ROAD = 10.0
"""Width of the road [m]."""


def _spec(variant: int, entities: dict[str, Any] | None = None) -> WorldSpec:
    """An island with a crater lake, rivers, a road and plants."""
    side = CELLS * CELL
    land = {
        "extent": [side, side],
        "cell": CELL,
        "datum": -40,
        "sea_level": 0,
        "seed": variant,
        "layers": {
            "hill": {"kind": "cone", "radius": 0.45 * side, "height": 240 + 20 * variant, "order": 1, "seed": variant},
            "rough": {
                "kind": "noise",
                "style": "ridged",
                "amplitude": 30,
                "wavelength": 250,
                "order": 2,
                "seed": variant,
            },
            "crater": {"kind": "crater", "radius": 90, "depth": 50, "order": 3},
            "way": {"kind": "road", "line": [[-180, -190], [180, -180]], "width": ROAD, "order": 4},
        },
        "erosion": {"years": 10000, "steps": 3},
        "hydrology": {"required": ["sea", "lake", "river"], "density": 2},
        "climate": {"biome": "volcanic-island"},
        "vegetation": {"density": 1.0},
    }
    return WorldSpec.model_validate(
        {
            "title": "t",
            "prompt": "p",
            "materials": {"rock": {"density": 2600, "substance": "stone"}},
            "terrains": {"land": land},
            "entities": entities or {},
            "simulation": {"frames": 2},
        }
    )


@cache
def _built(variant: int) -> tuple[str, dict[str, Any], dict[str, Any]]:
    """File name, arrays and description of a landscape, built once per process."""
    with tempfile.TemporaryDirectory(prefix="worldagent-land-") as folder:
        saved, _ = build_terrain_file(WorldFolder(Path(folder)), _spec(variant), "land")
        return saved.path.name, {n: saved.raw(n) for n in saved.names}, saved.about


class _Land:
    """A copy of a built landscape, to be changed."""

    def __init__(self, rng: RNG) -> None:
        self.rng, self.variant = rng, int(rng.integers(VARIANTS))
        self.file, arrays, about = _built(self.variant)
        self.a = {n: v.copy() for n, v in arrays.items()}
        self.about = copy.deepcopy(about)
        self.entities: dict[str, Any] = {}

    def cell(self, mask: Any = None) -> tuple[int, int]:
        """A cell drawn from a mask, or from all but the outermost three."""
        inner = np.zeros((CELLS, CELLS), dtype=bool)
        inner[3:-3, 3:-3] = True
        found = np.argwhere(inner if mask is None else inner & mask)
        row, col = found[self.rng.integers(len(found))]
        return int(row), int(col)

    def middle(self, row: int, col: int) -> F64:
        """Middle of a cell, x and y [m]."""
        return (np.array([col, row]) - 0.5 * (CELLS - 1)) * CELL

    def reach(self) -> dict[str, Any]:
        """A reach that falls over at least eight cells."""
        level = self.a["filled"].ravel()
        fit = [r for r in self.about["reaches"] if len(r["cells"]) >= 8 and level[r["cells"][0]] > level[r["cells"][-1]] + 0.1]
        found: dict[str, Any] = fit[self.rng.integers(len(fit))]
        return found

    def plant(self, at: F64) -> int:
        """Move a plant to a place on the ground, where no other stands near; its number."""
        keep = np.hypot(*(self.a["plant_position"][:, :2] - at).T) > 12.0
        keep[int(np.argmax(keep))] = True
        for name in [n for n in self.a if n.startswith("plant_")]:
            self.a[name] = self.a[name][keep]
        number = int(self.rng.integers(len(self.a["plant_kind"])))
        self.a["plant_position"][number, :2] = at
        self.ground(number)
        return number

    def ground(self, number: int) -> None:
        """Put a plant on the ground."""
        from scipy import ndimage

        place = self.a["plant_position"][number]
        at = (place[1::-1] / CELL + 0.5 * (CELLS - 1))[:, None]
        place[2] = ndimage.map_coordinates(self.a["height"], at, order=1, mode="nearest")[0]

    def world(self, folder: Path, *claims: str, torn: tuple[str, int] | None = None) -> World:
        """Write it and judge what is built on it; a defect must be found by one of the claims."""
        save_landscape(folder / "terrain" / self.file, self.a, self.about)
        place, spec = WorldFolder(folder), _spec(self.variant, self.entities)
        entities = dict(build_world(place, spec)[0])
        if torn is not None:
            name, count = torn
            whole = entities[name].parts[0]
            gone = self.rng.choice(len(whole.render.faces), count, replace=False)
            part = replace(whole, render=TriangleMesh(whole.render.vertices, np.delete(whole.render.faces, gone, axis=0)))
            entities[name] = replace(entities[name], parts=(part,))
        return World(Candidate(folder, spec, entities, "static"), (*claims, *(f"terrain:{claim}" for claim in claims)))

    def grounds(self, folder: Path, gap: float, *, lift: float = 0.0) -> None:
        """Two grounds beside each other, `gap` apart, the second raised."""
        saved = SavedLandscape(folder / "terrain" / self.file)
        save_landscape(saved.path, self.a, self.about)
        turned = bool(self.rng.random() < 0.5)
        for name, along, z in (("west", -60.0 - gap / 2, 0.0), ("east", 60.0 + gap / 2, lift)):
            center, size = ((0.0, along), (100.0, 120.0)) if turned else ((along, 0.0), (120.0, 100.0))
            cells = int(self.rng.integers(8, 30))
            patch = cut_patch(WorldFolder(folder), "land", saved, center=center, size=size, cells=cells)
            shape = {"kind": "heightfield", "size": list(size), "file": patch.file, "digest": patch.digest, "base": 2.0}
            self.entities[name] = {
                "role": "ground",
                "motion": "static",
                "material": "rock",
                "dimensions": {"size": [*size, patch.high - patch.low + 2.0]},
                "pose": {"position": [*center, z]},
                "parts": {"land": {"shape": shape}},
            }


# ---------------------------------------------------------------- broken


def _wrong_fill(folder: Path, m: float, rng: RNG) -> World:
    land = _Land(rng)
    land.a["filled"][land.cell()] += m * rng.choice([-1.0, 1.0])
    return land.world(folder, "fill")


def _tilted_lake(folder: Path, m: float, rng: RNG) -> World:
    """The level of a lake is not that of its cells."""
    land = _Land(rng)
    land.about["lakes"][rng.integers(len(land.about["lakes"]))]["level"] += m
    return land.world(folder, "water")


def _leaky_lake(folder: Path, m: float, rng: RNG) -> World:
    land = _Land(rng)
    land.about["lakes"][rng.integers(len(land.about["lakes"]))]["volume"] *= 1.0 - m
    return land.world(folder, "water")


def _dry_lake(folder: Path, m: float, rng: RNG) -> World:
    """Cells of a lake that the mask of water leaves out."""
    land = _Land(rng)
    cells = np.argwhere(land.a["lake"] > 0)
    some = cells[rng.choice(len(cells), min(len(cells), round(m)), replace=False)]
    land.a["wet"][some[:, 0], some[:, 1]] = False
    return land.world(folder, "water")


def _uphill(folder: Path, m: float, rng: RNG) -> World:
    land = _Land(rng)
    cells = land.reach()["cells"]
    count = min(len(cells), round(m))
    level = land.a["filled"].ravel()[cells]
    falls = np.flatnonzero(np.diff(level) < 0)
    at = int(falls[rng.integers(len(falls))])
    start = min(max(0, at - count // 2), len(cells) - count)
    cells[start : start + count] = cells[start : start + count][::-1]
    return land.world(folder, "water")


def _gap_in_reach(folder: Path, m: float, rng: RNG) -> World:
    land = _Land(rng)
    cells = land.reach()["cells"]
    start = len(cells) // 2 - 1
    del cells[start : start + round(m)]
    return land.world(folder, "water")


def _turned_flow(folder: Path, m: float, rng: RNG) -> World:
    """Cells that drain otherwise than by the steepest way."""
    land = _Land(rng)
    for _ in range(round(m)):
        row, col = land.cell((land.a["sea"] == 0) & (land.a["lake"] == 0))
        fall = {
            v: (land.a["filled"][row, col] - land.a["filled"][row + dr, col + dc]) / np.hypot(dr, dc)
            for v, (dr, dc) in D8.items()
        }
        worse = [v for v in fall if fall[v] < max(fall.values()) - 1e-6]
        land.a["flow_direction"][row, col] = worse[rng.integers(len(worse))]
    return land.world(folder, "drainage")


def _circle(folder: Path, m: float, rng: RNG) -> World:
    """Two level cells that drain into each other."""
    land = _Land(rng)
    sea = land.a["sea"].astype(bool)
    row, col = land.cell(sea & np.roll(sea, -1, axis=1))
    land.a["flow_direction"][row, col], land.a["flow_direction"][row, col + 1] = 1, 16
    return land.world(folder, "drainage")


def _lost_area(folder: Path, m: float, rng: RNG) -> World:
    land = _Land(rng)
    land.a["accumulation"][land.cell()] += m * CELL**2
    return land.world(folder, "drainage")


def _cooked_ledger(folder: Path, m: float, rng: RNG) -> World:
    """The ledger's volume that has left the land differs from what the cells lost."""
    land = _Land(rng)
    balance = land.about["figures"]["river_erosion"]
    balance["exported"] += m * balance["worn"] * rng.choice([-1.0, 1.0])
    return land.world(folder, "ledger")


def _lost_matter(folder: Path, m: float, rng: RNG) -> World:
    land = _Land(rng)
    moved = float(land.a["wear"].sum() + land.a["deposit"].sum())
    land.a["deposit"][land.cell()] += m * moved
    return land.world(folder, "ledger")


def _drowned_plant(folder: Path, m: float, rng: RNG) -> World:
    land = _Land(rng)
    for _ in range(round(m)):
        land.plant(land.middle(*land.cell(land.a["wet"].astype(bool))) + rng.uniform(-0.4, 0.4, 2) * CELL)
    return land.world(folder, "plants")


def _road_side(m: float, rng: RNG) -> F64:
    """A place m beyond the edge of the road [m]; inside where m is negative."""
    a, b = np.array([-180.0, -190.0]), np.array([180.0, -180.0])
    along = (b - a) / np.linalg.norm(b - a)
    across = np.array([-along[1], along[0]]) * rng.choice([-1.0, 1.0])
    return np.asarray(a + rng.uniform(0.1, 0.9) * (b - a) + across * (0.5 * ROAD + m))


def _plant_on_road(folder: Path, m: float, rng: RNG) -> World:
    land = _Land(rng)
    land.plant(_road_side(-m, rng))
    return land.world(folder, "plants")


def _floating_tree(folder: Path, m: float, rng: RNG) -> World:
    land = _Land(rng)
    land.a["plant_position"][rng.integers(len(land.a["plant_kind"])), 2] += m * rng.choice([-1.0, 1.0])
    return land.world(folder, "plants")


def _crowded(folder: Path, m: float, rng: RNG) -> World:
    """Two plants nearer than both need, by a share m."""
    land = _Land(rng)
    one, two = (int(k) for k in rng.choice(len(land.a["plant_kind"]), 2, replace=False))
    apart = float(land.a["plant_radius"][one]) + float(land.a["plant_radius"][two])
    angle = rng.uniform(0, 2 * np.pi)
    land.a["plant_position"][two, :2] = land.a["plant_position"][one, :2] + apart * (1 - m) * np.array(
        [np.cos(angle), np.sin(angle)]
    )
    land.ground(two)
    return land.world(folder, "plants")


def _hole(folder: Path, m: float, rng: RNG) -> World:
    land = _Land(rng)
    row, col = land.cell()
    size = max(1, round(np.sqrt(m)))
    land.a["height"][row : min(row + size, CELLS - 1), col : min(col + size, CELLS - 1)] = np.nan
    return land.world(folder, "tight")


def _gap_of_grounds(folder: Path, m: float, rng: RNG) -> World:
    land = _Land(rng)
    land.grounds(folder, m)
    return land.world(folder, "tight")


def _torn_ground(folder: Path, m: float, rng: RNG) -> World:
    land = _Land(rng)
    land.grounds(folder, 0.0)
    return land.world(folder, "tight", torn=(str(rng.choice(["west", "east"])), round(m)))


def _raised_ground(folder: Path, m: float, rng: RNG) -> World:
    land = _Land(rng)
    land.grounds(folder, 0.0, lift=m * rng.choice([-1.0, 1.0]))
    return land.world(folder, "east")


# ---------------------------------------------------------------- sound


def _as_built(folder: Path, m: float, rng: RNG) -> World:
    return _Land(rng).world(folder)


def _nearly_level(folder: Path, m: float, rng: RNG) -> World:
    land = _Land(rng)
    for lake in land.about["lakes"]:
        lake["level"] += m
        lake["volume"] += m * float((land.a["lake"] == lake["number"]).sum()) * CELL**2
    return land.world(folder)


def _rounded_ledger(folder: Path, m: float, rng: RNG) -> World:
    land = _Land(rng)
    balance = land.about["figures"]["river_erosion"]
    balance["exported"] += m * balance["worn"] * rng.choice([-1.0, 1.0])
    return land.world(folder)


def _by_the_water(folder: Path, m: float, rng: RNG) -> World:
    """A plant in a dry cell beside water."""
    from scipy import ndimage

    land = _Land(rng)
    wet = (land.a["wet"] | land.a["bed"]).astype(bool)
    shore = ndimage.binary_dilation(wet, np.ones((3, 3))) & ~wet
    land.plant(land.middle(*land.cell(shore)))
    return land.world(folder)


def _by_the_road(folder: Path, m: float, rng: RNG) -> World:
    land, tries = _Land(rng), 0
    wet = (land.a["wet"] | land.a["bed"]).astype(bool)
    at = _road_side(m, rng)
    while tries < 50:
        row, col = np.round(at[::-1] / CELL + 0.5 * (CELLS - 1)).astype(int)
        if not wet[row, col]:
            break
        at, tries = _road_side(m, rng), tries + 1
    land.plant(at)
    return land.world(folder)


def _rooted(folder: Path, m: float, rng: RNG) -> World:
    land = _Land(rng)
    land.a["plant_position"][rng.integers(len(land.a["plant_kind"])), 2] += m * rng.choice([-1.0, 1.0])
    return land.world(folder)


def _side_by_side(folder: Path, m: float, rng: RNG) -> World:
    """Grounds of different resolution that adjoin exactly, or within a rounding, or stand apart."""
    land = _Land(rng)
    land.grounds(folder, float(rng.choice([0.0, 0.5 * SEAM, CELL + m])))
    return land.world(folder)


def _nearly_in_place(folder: Path, m: float, rng: RNG) -> World:
    land = _Land(rng)
    land.grounds(folder, 0.0, lift=m * rng.choice([-1.0, 1.0]))
    return land.world(folder)


def _ragged_edge(folder: Path, m: float, rng: RNG) -> World:
    """No land at the edge of a DEM, as after a turn of its grid."""
    land = _Land(rng)
    count = max(1, round(m))
    land.a["height"][:count, : 3 * count] = np.nan
    land.a["height"][-count:, -3 * count :] = np.nan
    return land.world(folder)


SUITE = Suite(
    "terrain",
    (
        Mechanism("wrong fill", "a cell is filled too high or too low", True, _wrong_fill, 1e-6, 10.0, "m", bound=0.0),
        Mechanism(
            "tilted lake", "its level is not that of its cells", True, _tilted_lake, 1.1 * LEVEL_M, 5.0, "m", bound=LEVEL_M
        ),
        Mechanism("leaky lake", "it holds less than its basin", True, _leaky_lake, 2e-6, 0.5, "1", bound=1e-6),
        Mechanism("dry lake", "cells that nothing calls wet", True, _dry_lake, 1.0, 20.0, "cells"),
        Mechanism("uphill", "a stretch of a river runs upwards", True, _uphill, 3.0, 8.0, "cells"),
        Mechanism("broken river", "a gap in its bed", True, _gap_in_reach, 2.0, 5.0, "cells"),
        Mechanism("turned flow", "drains beside the steepest way", True, _turned_flow, 1.0, 20.0, "cells"),
        Mechanism("circle", "water runs in a circle", True, _circle, 1.0, 2.0, "1"),
        Mechanism("lost area", "more area than drains there", True, _lost_area, 1e-3, 100.0, "cells"),
        Mechanism("cooked ledger", "the books of erosion are wrong", True, _cooked_ledger, 1.1 * LEDGER, 0.5, "1", bound=LEDGER),
        Mechanism("lost matter", "a cell has more than was laid down", True, _lost_matter, 1.1 * LEDGER, 0.1, "1", bound=LEDGER),
        Mechanism("drowned plant", "stands in water", True, _drowned_plant, 1.0, 10.0, "plants"),
        Mechanism("plant on road", "stands on the road", True, _plant_on_road, 1e-4, 4.9, "m", bound=0.0),
        Mechanism("floating tree", "off the ground", True, _floating_tree, 1.05 * FLOATING_M, 3.0, "m", bound=FLOATING_M),
        Mechanism("crowded", "nearer than both need", True, _crowded, 1e-4, 0.9, "1", bound=1e-5),
        Mechanism("hole", "cells without land inside it", True, _hole, 1.0, 30.0, "cells"),
        Mechanism("gap of grounds", "a slit between two grounds", True, _gap_of_grounds, 1.1 * SEAM, 11.0, "m", bound=SEAM),
        Mechanism("torn ground", "triangles are missing", True, _torn_ground, 1.0, 50.0, "triangles"),
        Mechanism("raised ground", "off the landscape", True, _raised_ground, 1.1 * PATCH_M, 5.0, "m", bound=PATCH_M),
        Mechanism("as built", "nothing is wrong", False, _as_built, 1.0, 2.0, "1"),
        Mechanism("nearly level", "lakes off by rounding", False, _nearly_level, 1e-7, 0.9 * LEVEL_M, "m"),
        Mechanism("rounded ledger", "off by rounding", False, _rounded_ledger, 1e-9, 0.9 * LEDGER, "1"),
        Mechanism("by the water", "a plant on the shore", False, _by_the_water, 1.0, 2.0, "1"),
        Mechanism("by the road", "a plant at its edge", False, _by_the_road, 0.001, 3.0, "m"),
        Mechanism("rooted", "feet a little in the ground", False, _rooted, 1e-5, 0.95 * FLOATING_M, "m"),
        Mechanism("side by side", "grounds that adjoin, or stand apart", False, _side_by_side, 0.01, 60.0, "m"),
        Mechanism("nearly in place", "a ground off by rounding", False, _nearly_in_place, 1e-6, 0.9 * PATCH_M, "m"),
        Mechanism("ragged edge", "no land at the edge", False, _ragged_edge, 1.0, 4.0, "cells"),
    ),
)
"""Worlds of the check `terrain`."""
