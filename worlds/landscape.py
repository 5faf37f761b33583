"""A built landscape on disk: fields on one grid, water bodies, ground cover and plants. Written by construction, read by all.

One file per recipe, `terrain/<id>.<recipe>.npz`: arrays uncompressed under their names, everything else in `about`.
"""

from __future__ import annotations

import hashlib
import json
import zipfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from .arrays import F64
from .errors import EvidenceError
from .folder import temporary_name
from .provenance import landscape_digest
from .spec import WorldSpec

__all__ = ["FIELDS", "FieldInfo", "SavedLandscape", "landscape_path", "open_landscape", "save_landscape"]


@dataclass(frozen=True)
class FieldInfo:
    """One field of a landscape."""

    unit: str
    meaning: str
    palette: str = "viridis"
    """Colours of its picture: `terrain`, `water`, `wet`, `heat`, `slope`, `aspect`, `classes`, `diverging`, `viridis`."""
    log: bool = False
    """True if its values span decades."""


FIELDS: dict[str, FieldInfo] = {
    "height": FieldInfo("m", "ground as it is, river beds cut", "terrain"),
    "ground": FieldInfo("m", "ground before river beds were cut", "terrain"),
    "start": FieldInfo("m", "land before erosion", "terrain"),
    "uplift": FieldInfo("m", "raised while rivers cut", "heat"),
    "earthworks": FieldInfo("m", "raised or cut after erosion: roads, levelled ground, late layers", "diverging"),
    "bedrock": FieldInfo("m", "surface of the rock", "terrain"),
    "sediment": FieldInfo("m", "loose matter on the rock", "heat"),
    "wear": FieldInfo("m", "removed by erosion", "heat"),
    "deposit": FieldInfo("m", "laid down by erosion", "heat"),
    "filled": FieldInfo("m", "level of Priority-Flood: Surface Height", "terrain"),
    "basin_depth": FieldInfo("m", "depth of depressions: Basin Depth", "water"),
    "flow_direction": FieldInfo("1", "D8 code, powers of two clockwise from east", "classes"),
    "accumulation": FieldInfo("m^2", "area that drains through a cell: Flow Accumulation", "water", log=True),
    "discharge": FieldInfo("m^3/s", "mean annual discharge", "water", log=True),
    "basin": FieldInfo("1", "number of the watershed: Watershed Basins", "classes"),
    "lake": FieldInfo("1", "number of the lake", "classes"),
    "sea": FieldInfo("1", "sea", "water"),
    "wet": FieldInfo("1", "under water: sea, lakes, rivers, streams", "water"),
    "bed": FieldInfo("1", "beds of rivers and streams, banks included", "water"),
    "water_level": FieldInfo("m", "surface of the water, where there is any", "terrain"),
    "rain": FieldInfo("m/year", "precipitation", "wet"),
    "slope": FieldInfo("m/m", "tangent of the inclination", "slope"),
    "aspect": FieldInfo("rad", "direction of descent, from east towards north", "aspect"),
    "curvature": FieldInfo("1/m", "Laplacian: positive in hollows", "diverging"),
    "roughness": FieldInfo("m/m", "deviation of the slope around a cell", "slope"),
    "peak": FieldInfo("1", "local maxima", "classes"),
    "sun_hours": FieldInfo("h", "direct sun on one clear day", "heat"),
    "sunlight": FieldInfo("MJ/m^2", "clear-sky energy of one day", "heat"),
    "sky": FieldInfo("1", "visible part of the sky", "viridis"),
    "wind_exposure": FieldInfo("1", "0 in the lee, 1 open to the wind", "viridis"),
    "water_distance": FieldInfo("m", "to the nearest water", "wet"),
    "height_above_water": FieldInfo("m", "above the water that a cell drains to (HAND)", "wet"),
    "wetness": FieldInfo("1", "topographic wetness ln(a / tan b)", "wet"),
    "moisture": FieldInfo("1", "moisture of the ground, 0 to 1", "wet"),
    "temperature": FieldInfo("deg C", "mean annual", "heat"),
    "soil_depth": FieldInfo("m", "ground that roots can use", "heat"),
    "snow": FieldInfo("1", "cover of snow", "water"),
    "cover": FieldInfo("1", "ground material", "classes"),
    "tree_density": FieldInfo("1/m^2", "trees", "viridis"),
    "shrub_density": FieldInfo("1/m^2", "shrubs: Shrub Density", "viridis"),
    "grass_density": FieldInfo("1/m^2", "grass tufts", "viridis"),
    "rock_density": FieldInfo("1/m^2", "boulders", "viridis"),
    "pebble_density": FieldInfo("1/m^2", "stones", "viridis"),
}
"""Every field that a landscape can hold. Values at cell centres, row 0 south."""


def landscape_path(root: Path, name: str, recipe: str) -> Path:
    """File of a built landscape in a world folder."""
    return root / "terrain" / f"{name}.{recipe[:16]}.npz"


def save_landscape(path: Path, arrays: Mapping[str, Any], about: Mapping[str, Any]) -> None:
    """Write a landscape: first under a temporary name, then renamed."""
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary = temporary_name(path)
    text = json.dumps(about, sort_keys=True).encode()
    try:
        with temporary.open("wb") as file:
            np.savez(file, about=np.frombuffer(text, dtype=np.uint8), **arrays)
        temporary.replace(path)
    finally:
        temporary.unlink(missing_ok=True)


@dataclass(frozen=True)
class SavedLandscape:
    """A landscape read from its file; arrays are loaded when they are asked for."""

    path: Path

    @cached_property
    def about(self) -> dict[str, Any]:
        """Grid, lakes, reaches, figures, names of materials and species.

        Raises:
            EvidenceError: the file is missing or damaged.
        """
        found: dict[str, Any] = json.loads(self._array("about").tobytes())
        return found

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Names of the arrays."""
        with self._open() as file:
            return tuple(n for n in file.files if n != "about")

    @property
    def shape(self) -> tuple[int, int]:
        """(rows, cols) of every field."""
        return int(self.about["rows"]), int(self.about["cols"])

    @property
    def cell(self) -> float:
        """Side of a cell [m]."""
        return float(self.about["cell"])

    def field(self, name: str) -> F64:
        """A field, shape (rows, cols), float64.

        Raises:
            EvidenceError: there is no such field, or the file is damaged.
        """
        values = self._array(name)
        if values.shape != self.shape:
            raise EvidenceError(
                f"{name!r} of {self.path.name} has shape {values.shape}, not {self.shape}; call build_terrain again"
            )
        return values.astype(np.float64)

    def raw(self, name: str) -> np.ndarray:
        """An array as it is stored: classes, masks, plants."""
        return self._array(name)

    def digest(self) -> str:
        """SHA-256 over all arrays and the description, hex."""
        total = hashlib.sha256()
        for name in sorted([*self.names, "about"]):
            values = self._array(name)
            total.update(f"{name}:{values.dtype.str}:{values.shape}".encode())
            total.update(np.ascontiguousarray(values).tobytes())
        return total.hexdigest()

    @contextmanager
    def _open(self) -> Iterator[Any]:
        try:
            with self.path.open("rb") as file, np.load(file, allow_pickle=False) as found:
                yield found
        except (OSError, ValueError, EOFError, zipfile.BadZipFile) as error:
            raise EvidenceError(f"{self.path.name} is missing or damaged ({error}); call build_terrain again") from error

    def _array(self, name: str) -> np.ndarray:
        with self._open() as file:
            if name not in file.files:
                raise EvidenceError(f"{self.path.name} holds no {name!r}; it has {', '.join(sorted(file.files))}")
            return np.asarray(file[name])


def open_landscape(root: Path, spec: WorldSpec, name: str) -> SavedLandscape:
    """The landscape built from exactly this terrain.

    Raises:
        EvidenceError: there is none.
    """
    wanted = landscape_digest(spec, name)
    for path in sorted((root / "terrain").glob(f"{name}.*.npz"), key=lambda p: -p.stat().st_mtime):
        saved = SavedLandscape(path)
        if saved.about.get("terrain") == wanted:
            return saved
    raise EvidenceError(f"terrain {name!r} is not built from its present specification; call build_terrain(terrain={name!r})")
