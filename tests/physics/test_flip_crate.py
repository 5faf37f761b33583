"""A tank of five boxes, one cell thick, with a crate afloat on the grid engine, judged by all checks of liquids (R57, R66, R99)."""

from __future__ import annotations

from pathlib import Path

from worldagent.construction.build import build_entity
from worldagent.simulation.schedule import run_frames
from worldagent.testing.worlds.small_liquids import PROMPT, tank_spec
from worldagent.verifiers.categories.liquid.check import findings_of
from worldagent.verifiers.rows.findings import Finding
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.patch import parse_spec

FRAMES = 10


def judged(folder: Path, density: float, frames: int) -> tuple[Candidate, dict[str, Finding]]:
    """A crate on the tank's floor, eight cells under water, and all findings on the water."""
    made = tank_spec(engine="flip", spacing=0.03, frames=frames, crate_at=0.0605, density=density, depth=0.25)
    spec = parse_spec({**made, "prompt": PROMPT})
    built = {n: build_entity(spec, n, Path()) for n in spec.entities}
    candidate = Candidate(folder, spec, built, "full", run_frames(spec, built, folder / "a" / "bake", frames=frames))
    return candidate, {n: f for watch in findings_of(candidate, "water").values() for n, (_, f) in watch.items()}


def test_a_heavy_crate_on_the_floor_is_lifted_by_all_that_it_displaces(tmp_path: Path) -> None:
    """Before gaps had cells the lift was missing, and excused; water that went through the gap once crowded there."""
    _, found = judged(tmp_path, 1500.0, 20)
    assert [f"{name}: {f.text}" for name, f in found.items() if f.status in ("fail", "unverified")] == []
    assert "too narrow" not in found["buoyancy"].text
    assert found["buoyancy"].measured == 0.0


def test_a_light_crate_let_go_on_the_floor_floats_up(tmp_path: Path) -> None:
    """Once it stayed for good: contacts were taken to bear it whatever the water did."""
    candidate, found = judged(tmp_path, 500.0, 18)
    assert candidate.track("crate", "body")[0][-1, 2] > 0.2
    assert [f"{n}: {found[n].text}" for n in ("energy", "momentum", "exchange", "mass") if found[n].status != "pass"] == []


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
