"""A grid pool that holds its level while a drain empties it, as a whole world, judged by all checks of liquids (R57, R99)."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.construction.build import build_entity
from worldagent.simulation.schedule import run_frames
from worldagent.testing.worlds.small_liquids import PROMPT, tank_spec
from worldagent.verifiers.categories.liquid.check import findings_of
from worldagent.worlds.cache import Cache
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.patch import parse_spec

FRAMES, DEPTH, RATE = 30, 0.2, 6e-3
TAP = {"kind": "inflow", "entity": "water", "pose": {"position": [-0.1, 0.0, 0.27], "quaternion": [0, 1, 0, 0]},
       "size": [0.12, 0.3], "rate": RATE}  # fmt: skip
"""A shower over the tank's left part."""
DRAIN = {
    "kind": "outflow",
    "entity": "water",
    "pose": {"position": [0.13, 0.0, 0.04]},
    "size": [0.08, 0.08, 0.08],
    "level": 0.15,
    "gauge": [0.0, -0.12],
}


def world(folder: Path, *, tap: dict[str, Any] | None = None, drain: dict[str, Any] | None = None) -> Candidate:
    """The tank of water on a grid with a tap, a drain, or both."""
    made = tank_spec(engine="flip", spacing=0.03, frames=FRAMES, crate_at=None, depth=DEPTH)
    made["simulation"]["drivers"] = {k: v for k, v in (("tap", tap), ("drain", drain)) if v is not None}
    spec = parse_spec({**made, "prompt": PROMPT})
    built = {n: build_entity(spec, n, Path()) for n in spec.entities}
    return Candidate(folder, spec, built, "full", run_frames(spec, built, folder / "a" / "bake", frames=FRAMES))


def series(cache: Cache, name: str) -> list[float]:
    return [float(v) for v in np.asarray(cache.series(f"record/{name}"), dtype=np.float64)]


@pytest.mark.parametrize("holding", [True, False])
def test_a_tap_that_holds_a_level_stops_there_and_one_that_does_not_goes_on(tmp_path: Path, *, holding: bool) -> None:
    """1.2 s at most 6 l/s over 0.16 m^2 would raise the water by 4.5 cm; it is to rise by 1.5 cm, half a cell."""
    tap = {**TAP, "level": DEPTH + 0.015, "gauge": [0.1, 0.1]} if holding else TAP
    candidate = world(tmp_path, tap=tap)
    came = series(candidate.liquid_caches["water"], "inflow_mass")[-1] / 1000 / 0.16
    assert came == pytest.approx(0.015 if holding else RATE * 29 / 24 / 0.16, abs=0.012 if holding else 0.002)
    found = {name: f for watch in findings_of(candidate, "water").values() for name, (_, f) in watch.items()}
    assert [(found[n].status, found[n].text) for n in ("mass", "identity", "energy", "source") if found[n].status != "pass"] == []


def test_a_drain_stops_at_its_level_and_the_books_close(tmp_path: Path) -> None:
    """From 0.2 m to 0.15 m, within a cell, though the wave that the drain makes opens it once more."""
    candidate = world(tmp_path, drain=DRAIN)
    went = series(candidate.liquid_caches["water"], "outflow_mass")
    assert went[-1] / 1000 / 0.16 == pytest.approx(0.05, abs=0.03)
    assert went[-1] == pytest.approx(went[-8], rel=0.1)
    found = {name: f for watch in findings_of(candidate, "water").values() for name, (_, f) in watch.items()}
    assert [(found[n].status, found[n].text) for n in ("mass", "identity", "energy") if found[n].status != "pass"] == []
