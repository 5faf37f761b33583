"""Small worlds in which hot matter meets water: a hot block in a tank, lava that slumps into a pond."""

from __future__ import annotations

from typing import Any

from .small_gas import smoke_spec

__all__ = ["LAVA_PROMPT", "QUENCH_PROMPT", "lava_spec", "quench_spec"]

QUENCH_PROMPT = "A red-hot block of iron lies in a tank of water, and steam rises."
LAVA_PROMPT = "Lava slumps into a pond, and steam rises."
SPACING, FINE = 0.04, 0.02
"""[m] Of the particles of lava and its water, and of those about a block."""
DEPTH = 0.16
"""[m] Of the water."""
WIDE = 0.4
"""[m] Of the tank."""


def _room(resolution: float, frames: int, solids: dict[str, Any], spacing: float, **changes: Any) -> dict[str, Any]:
    """The room of `smoke_spec` with a tank of water, whose walls are those of its domain, and steam over it."""
    spec = smoke_spec(frames=frames, resolution=resolution, **changes)
    del spec["entities"]["plate"], spec["entities"]["smoke"], spec["materials"]["smoke"]
    spec["materials"] |= {
        "water": {"density": 1000.0, "substance": "water"},
        "steam": {"density": 1.2, "substance": "water", "appearance": {"color": [0.95, 0.95, 0.95]}},
    }
    size = [WIDE, WIDE, DEPTH]
    spec["entities"] |= {
        "pool": {
            "role": "water in a tank",
            "motion": "dynamic",
            "material": "water",
            "dimensions": {"size": size},
            "pose": {"position": [0, 0, DEPTH / 2]},
            "physics": {"category": "liquid", "resolution": spacing, "surface_tension": 0.0},
            "parts": {"body": {"shape": {"kind": "box", "size": size}}},
        },
        "steam": {
            "role": "steam over the water",
            "motion": "dynamic",
            "material": "steam",
            "dimensions": {"size": [WIDE, WIDE, 0.12]},
            "pose": {"position": [0, 0, DEPTH + 0.06]},
            "physics": {"category": "gas", "temperature": 373.15, "soot_density": 0.08, "resolution": resolution},
            "parts": {"over": {"shape": {"kind": "box", "size": [WIDE, WIDE, 0.12]}}},
        },
        **solids,
    }
    solvers = spec["simulation"]["solvers"]
    solvers["bodies"]["members"] = ["floor", *(n for n, e in solids.items() if "physics" not in e)]
    solvers["air"]["members"] = ["steam"]
    domain = {"center": [0, 0, 0.35], "size": [WIDE, WIDE, 0.9], "sides": ["closed"] * 5 + ["open"]}
    members = ["pool", *(n for n, e in solids.items() if "physics" in e)]
    spec["simulation"]["preroll"] = 0.1
    solvers["liquid"] = {"engine": "dfsph", "members": members, "settings": {"domain": domain}}
    return spec


def quench_spec(
    *, frames: int = 25, temperature: float = 1000.0, side: float = 0.12, resolution: float = 0.05, **changes: Any
) -> dict[str, Any]:
    """A specification without its prompt; `changes` replace top-level members.

    Args:
        frames: at 24 per second.
        temperature: of the iron [K].
        side: of the block [m].
        resolution: of the steam [m].
    """
    block = {
        "role": "block of red-hot iron",
        "motion": "static",
        "material": "steel",
        "dimensions": {"size": [side] * 3},
        "pose": {"position": [0, 0, side / 2]},
        "parts": {"block": {"shape": {"kind": "box", "size": [side] * 3}}},
    }
    spec = _room(resolution, frames, {"block": block}, FINE, **changes)
    spec["title"] = "a hot block in water"
    steam = {"kind": "steam", "entity": "steam", "hot": ["block"], "water": ["pool"], "temperature": temperature}
    spec["simulation"]["drivers"] = {"boils": {**steam, "heat_capacity": 450.0, "radius": 2.0 * resolution}}
    return spec


def lava_spec(*, frames: int = 25, temperature: float = 1400.0, resolution: float = 0.05, **changes: Any) -> dict[str, Any]:
    """The same tank with lava in a half of it, which slumps.

    Args:
        frames: at 24 per second.
        temperature: of the lava [K].
        resolution: of the steam [m].
    """
    size = [WIDE / 2, WIDE, 2 * DEPTH]
    hot = {"viscosity": 60.0, "surface_tension": 0.0, "temperature": temperature, "heat_capacity": 1200.0, "activation": 20000.0}
    lava = {
        "role": "lava",
        "motion": "dynamic",
        "material": "lava",
        "dimensions": {"size": size},
        "pose": {"position": [-WIDE / 4, 0, DEPTH]},
        "physics": {"category": "liquid", "resolution": SPACING, **hot},
        "parts": {"body": {"shape": {"kind": "box", "size": size}}},
    }
    spec = _room(resolution, frames, {"lava": lava}, SPACING, **changes)
    spec["title"] = "lava that slumps into water"
    spec["materials"]["lava"] = {"density": 2600.0, "substance": "lava", "appearance": {"color": [0.05, 0.03, 0.02]}}
    half = [WIDE / 2, WIDE, DEPTH]
    spec["entities"]["pool"] |= {"dimensions": {"size": half}, "pose": {"position": [WIDE / 4, 0, DEPTH / 2]}}
    spec["entities"]["pool"]["parts"]["body"]["shape"]["size"] = half
    steam = {"kind": "steam", "entity": "steam", "hot": ["lava"], "water": ["pool"], "radius": 2.0 * resolution}
    spec["simulation"]["drivers"] = {"boils": steam}
    return spec
