"""A tank of five boxes, one cell thick, with a crate afloat on the grid engine, judged by all checks of liquids (R57, R66, R99)."""

from __future__ import annotations

from pathlib import Path

from worldagent.construction.build import build_entity
from worldagent.simulation.schedule import run_frames
from worldagent.testing.worlds.small_liquids import PROMPT, tank_spec
from worldagent.verifiers.categories.liquid.check import findings_of
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.patch import parse_spec

FRAMES = 10


def test_no_row_of_a_floating_crate_on_the_grid_fails(tmp_path: Path) -> None:
    """Two-way; once 174 particles leaked through its walls and the crate's edges, and the water rose by 5 % of its energy."""
    spec = parse_spec({**tank_spec(engine="flip", spacing=0.03, frames=FRAMES, crate_at=0.2), "prompt": PROMPT})
    built = {n: build_entity(spec, n, Path()) for n in spec.entities}
    candidate = Candidate(tmp_path, spec, built, "full", run_frames(spec, built, tmp_path / "a" / "bake", frames=FRAMES))
    found = {name: finding for watch in findings_of(candidate, "water").values() for name, (_, finding) in watch.items()}
    assert [f"{name}: {f.text}" for name, f in found.items() if f.status in ("fail", "unverified")] == []
    told = {name: found[name].measured for name in ("exchange", "momentum", "energy", "leak")}
    assert told["exchange"] is not None
    assert told["exchange"] <= 1e-6
    assert told["momentum"] is not None
    assert told["momentum"] <= 0.01
    assert told["energy"] is not None
    assert told["energy"] <= 0.01
    assert told["leak"] == 0.0
