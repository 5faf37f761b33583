"""Do the numbers of `liquids` and `coupled-systems` help? Drawn vessels that must be resolved, and bodies that must float at rest.

Cases are data in the skills' `evals/cases.json`. Vessels: with, the resolution follows `resolution.json`; without, it is a fortieth of
the vessel, whatever its walls and slots. Counted: set-ups that the solver accepts. Bodies: with, they start at the draft of
`floating.json`; without, half submerged. Counted: bodies whose buoyancy, integrated over their shape, is their weight within a tenth.
"""

from __future__ import annotations

import json
import random
import sys
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ..construction import build_entity
from ..simulation.liquid.scene import build_scene
from ..worlds.errors import WorldAgentError
from ..worlds.patch import parse_spec

__all__ = ["cases", "measure_floating", "measure_resolution", "start_draft", "start_resolution", "submerged_share"]

SKILLS = Path(__file__).resolve().parent.parent / "skills"
FORTIETH = 1 / 40
AFLOAT = 0.1


def cases(skill: str) -> dict[str, Any]:
    """The cases of a skill's eval."""
    found: dict[str, Any] = json.loads((SKILLS / skill / "evals" / "cases.json").read_text())
    return found


def start_resolution(engine: str, sizes: Mapping[str, float]) -> float:
    """Resolution by the skill [m]: the smallest of its factors times the sizes that a vessel has."""
    factors = json.loads((SKILLS / "liquids" / "resolution.json").read_text())[engine]
    return float(min(factors[k] * v for k, v in sizes.items() if k in factors))


def _box(size: Sequence[float], at: Sequence[float]) -> dict[str, Any]:
    return {"shape": {"kind": "box", "size": [float(v) for v in size]}, "pose": {"position": [float(v) for v in at]}}


def _vessel(engine: str, sizes: Mapping[str, float], resolution: float) -> dict[str, Any]:
    """A square tank full of water; with an opening, a slot at the floor leads into an empty one of the same size."""
    side, depth, wall = sizes["side"], sizes["depth"], sizes["wall"]
    high, opening = depth * 1.5, sizes.get("opening")
    long = side if opening is None else 2 * side + wall
    middle = 0.5 * (long - side)
    parts = {
        "floor": _box((long + 2 * wall, side + 2 * wall, wall), (middle, 0, -wall / 2)),
        "west": _box((wall, side, high), (-(side + wall) / 2, 0, high / 2)),
        "east": _box((wall, side, high), (middle + (long + wall) / 2, 0, high / 2)),
        "south": _box((long + 2 * wall, wall, high), (middle, -(side + wall) / 2, high / 2)),
        "north": _box((long + 2 * wall, wall, high), (middle, (side + wall) / 2, high / 2)),
    }
    if opening is not None:
        parts["sluice"] = _box((wall, side, high - opening), ((side + wall) / 2, 0, (high + opening) / 2))
    thing = {"role": "vessel", "dimensions": {"size": [long + 2 * wall, side + 2 * wall, high + wall]}}
    domain = {"center": [middle, 0, high / 2], "size": [long + wall, side + wall, high + wall]}
    return {
        "title": "Vessel",
        "materials": {"glass": {"density": 2500, "substance": "glass"}, "water": {"density": 998, "substance": "water"}},
        "entities": {
            "vessel": {**thing, "motion": "static", "material": "glass", "parts": parts},
            "water": {
                "role": "water",
                "motion": "dynamic",
                "material": "water",
                "dimensions": {"size": [side, side, depth]},
                "pose": {"position": [0, 0, depth / 2]},
                "parts": {"body": _box((side, side, depth), (0, 0, 0))},
                "physics": {"category": "liquid", "resolution": resolution},
            },
        },
        "simulation": {
            "fps": 24,
            "frames": 24,
            "solvers": {
                "rigid": {"engine": "mujoco", "members": ["vessel"]},
                "water": {"engine": engine, "members": ["water"], "settings": {"domain": domain}},
            },
        },
    }


def _accepted(engine: str, sizes: Mapping[str, float], resolution: float, folder: Path) -> str:
    """Empty when the solver takes the vessel, else why not."""
    try:
        spec = parse_spec({"prompt": "Water stands in a vessel.", **_vessel(engine, sizes, resolution)})
        built = {n: build_entity(spec, n, folder) for n in spec.entities}
        scene = build_scene(spec, built, "water")
    except WorldAgentError as error:
        return str(error)
    layers = sizes["depth"] / scene.setup.spacing
    return "" if layers >= 4.0 else f"{layers:.1f} layers"


def _drawn(case: Mapping[str, Any], rng: random.Random) -> dict[str, float]:
    return {k: rng.uniform(*v) for k, v in case.items() if isinstance(v, list)}


def measure_resolution(seeds: Sequence[int]) -> dict[str, Any]:
    """Vessels accepted per arm."""
    totals: dict[str, dict[str, Any]] = {arm: {"vessels": 0, "accepted": 0, "refused": {}} for arm in ("with", "without")}
    with tempfile.TemporaryDirectory() as folder:
        for seed in seeds:
            for name, case in cases("liquids").items():
                sizes = _drawn(case, random.Random(f"{name} {seed}"))
                guess = FORTIETH * (2 * sizes["side"] if "opening" in sizes else sizes["side"])
                for arm, value in (("with", start_resolution(case["engine"], sizes)), ("without", guess)):
                    why = _accepted(case["engine"], sizes, value, Path(folder))
                    totals[arm]["vessels"] += 1
                    totals[arm]["accepted"] += not why
                    if why:
                        totals[arm]["refused"][f"{name} {seed}"] = why
                    print(f"{name} {arm} {seed}: {why or 'accepted'}", file=sys.stderr, flush=True)
    return totals


def start_draft(shape: str, ratio: float) -> float:
    """Draft over height by the skill."""
    table = json.loads((SKILLS / "coupled-systems" / "floating.json").read_text())
    return float(np.interp(ratio, table["density_ratio"], table[shape]))


def submerged_share(shape: str, draft: float) -> float:
    """Share of a body's volume below a level at `draft` of its height, by summing slices."""
    z = (np.arange(4000) + 0.5) / 4000
    width = {"box": np.ones_like(z), "sphere": z * (1 - z), "lying_cylinder": np.sqrt(z * (1 - z))}[shape]
    return float(width[z < draft].sum() / width.sum())


def measure_floating(seeds: Sequence[int]) -> dict[str, Any]:
    """Bodies that start at rest, per arm."""
    totals = {arm: {"bodies": 0, "at_rest": 0} for arm in ("with", "without")}
    for seed in seeds:
        for name, case in cases("coupled-systems").items():
            ratio = _drawn(case, random.Random(f"{name} {seed}"))["ratio"]
            for arm, draft in (("with", start_draft(case["shape"], ratio)), ("without", 0.5)):
                error = submerged_share(case["shape"], draft) / ratio - 1
                totals[arm]["bodies"] += 1
                totals[arm]["at_rest"] += abs(error) <= AFLOAT
                print(f"{name} {arm} {seed}: buoyancy off by {error:.1%} of the weight", file=sys.stderr, flush=True)
    return totals
