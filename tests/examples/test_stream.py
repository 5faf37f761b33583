"""A stream of the landscape that carries beams and a log: its reach, that the grid bears them, and that painted water does not count."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy import ndimage
from worldagent.construction.build import build_entity
from worldagent.construction.terrain.grid import Grid
from worldagent.construction.terrain.store import build_terrain_file, cut_patch
from worldagent.examples import stream
from worldagent.examples.stream import BEAM, BEAM_DENSITY, BEAMS, CLAIMS, LOG, PROMPT, Course, land_spec, options_of, run
from worldagent.server.skill_files import SKILLS
from worldagent.simulation.boundaries import Boundary
from worldagent.simulation.liquid.flip.engine import Flip
from worldagent.simulation.liquid.scene import build_scene
from worldagent.tests.physics.test_flip import box_mesh, one_body
from worldagent.tests.simulation.liquid.flip_setup import block, tank
from worldagent.workflow.waters import water_operations
from worldagent.worlds.audits.audit import audit
from worldagent.worlds.claim_marks import with_claims
from worldagent.worlds.folder import WorldFolder
from worldagent.worlds.patch import apply_patch, parse_spec
from worldagent.worlds.prompts.marks import parse_marks

SPACING = 0.8
RECORDED = json.loads((SKILLS / "coupled-systems" / "stream.json").read_text())
"""Calls of the example, as the skill shows them."""
SIZE = (230.0, 52.0)


def river_of(
    folder: WorldFolder,
    *,
    size: tuple[float, float] = SIZE,
    center: tuple[float, float] = (0.0, 0.0),
    spacing: float = SPACING,
) -> tuple[Any, Any, dict[str, Any]]:
    """Specification with the long reach, the landscape, and the figures of the reply."""
    seconds = 20.0 if size == SIZE else options_of([]).seconds
    spec = parse_spec({"prompt": PROMPT, **land_spec(seconds, 12)})
    land, _ = build_terrain_file(folder, spec, "valley")
    patch = cut_patch(folder, "valley", land, center=center, size=size, cells=round(size[0]))
    made, told = water_operations(folder, spec, land, file=patch.file, center=center, size=size, liquid="river", spacing=spacing)
    return apply_patch(spec, made), land, told


@pytest.mark.slow
def test_the_long_reach_agrees_with_the_mask_of_hydrology_within_one_cell(tmp_path: Path) -> None:
    spec, land, told = river_of(WorldFolder.at(tmp_path))
    course = Course(spec.entities["river"].model_dump(mode="json"))
    assert course.length > 200
    assert told["currents"][0]["length_m"] == pytest.approx(course.length, abs=1)
    setup = build_scene(spec, {"river": build_entity(spec, "river", tmp_path)}, "river").setup
    rows, cols = land.shape
    grid = Grid(rows, cols, land.cell)
    have = np.zeros(grid.shape, dtype=bool)
    have[grid.indices(setup.position[:, 0], setup.position[:, 1])] = True
    east, north = grid.axes()
    low, high = setup.lower, setup.upper
    assert (high[:2] - low[:2] > np.array(SIZE) - 8 * SPACING).all()
    inside = ((east > low[0]) & (east < high[0]))[None] & ((north > low[1]) & (north < high[1]))[:, None]
    wet = land.raw("wet").astype(bool) & inside
    near = np.ones((3, 3), dtype=bool)
    assert wet.sum() > 1500
    assert not (have & ~ndimage.binary_dilation(wet, near)).any()
    assert not (wet & ~ndimage.binary_dilation(have, near)).any()
    speed = np.linalg.norm(setup.velocity, axis=1)
    assert (speed > 0.5).mean() > 0.995
    assert speed.max() < 2.5


def test_the_shown_reach_is_forty_metres_long_and_runs_eight_seconds(tmp_path: Path) -> None:
    """The command line shows by default the stream of the cut ground, with frames for 8 s and as long a story."""
    options = options_of([])
    assert options.seconds >= 8.0
    assert options.told == options.seconds
    folder = WorldFolder.at(tmp_path)
    spec, _, told = river_of(folder, size=options.size, center=options.center, spacing=options.spacing)
    assert Course(spec.entities["river"].model_dump(mode="json")).length >= 40.0
    assert spec.simulation.frames == round(options.seconds * options.fps) + 1
    assert told["engine"] == "flip"


def test_what_drifts_weighs_what_it_is_called_and_is_resolved() -> None:
    """A squared timber of 0.3 x 0.3 x 2.4 m of air-dry pine; it is at least a cell thick, the log two cells."""
    mass = BEAM_DENSITY * float(np.prod(BEAM))
    assert 450 <= BEAM_DENSITY <= 650
    assert 95 <= mass <= 140
    spacing = options_of([]).spacing
    assert min(BEAM) >= spacing
    assert 2 * LOG[0] >= 2 * spacing
    assert "lea" not in PROMPT.replace("a log", "")


def test_the_grid_bears_a_beam_at_its_draft() -> None:
    """One beam in still water of the stream's depth and cells, for 4 s: the mean draft of the last two is its density's, within 5 %."""
    cell, ratio = options_of([]).spacing, BEAM_DENSITY / 1000
    depth, side = 3 * cell, 18 * cell
    height = depth + (0.5 - ratio) * BEAM[2] + 0.005
    at, speed, turn = np.array([side / 2, side / 2, height]), np.zeros(3), np.zeros(3)
    water = block((0, 0, 0), (side, side, depth), cell / 2)
    water = water[(np.abs(water - at) > np.array(BEAM) / 2).any(axis=1)]
    body = Boundary("beam", box_mesh(BEAM), "dynamic")
    engine = Flip(replace(tank((side, side, 3 * depth), water, cell / 2, boundaries=(body,)), spacing=cell))
    heights = []
    for _ in range(96):
        state = one_body(at, mass=1000 * ratio * float(np.prod(BEAM)), size=BEAM, velocity=speed, spin=turn)
        report = engine.step(1 / 24, state)
        speed = speed + report.dt * state.acceleration[0] + report.impulse[0, :3] * state.inverse_mass[0]
        turn = turn + state.inverse_inertia[0] @ report.impulse[0, 3:]
        at = at + report.dt * speed
        heights.append(at[2])
    level = (engine.particles().volume.sum() + ratio * float(np.prod(BEAM))) / side**2
    draft = level - (np.mean(heights[-48:]) - BEAM[2] / 2)
    assert draft == pytest.approx(ratio * BEAM[2], abs=0.05 * BEAM[2])


def test_the_course_bends_smoothly(tmp_path: Path) -> None:
    """Between stations of a metre it turns by less than a sixth of a right angle, where links of cells turn by a half."""
    spec, _, _ = river_of(WorldFolder.at(tmp_path))
    line = Course(spec.entities["river"].model_dump(mode="json")).line[:, :2]
    way = np.unwrap(np.arctan2(*np.diff(line, axis=0).T[::-1]))
    assert np.abs(np.diff(way)).max() < np.pi / 12


def test_painted_water_carries_no_log() -> None:
    """The stream is a blue slab: nothing that flows, and nothing that bears a log, so no evidence."""
    world = land_spec(1.0, 12)
    box = {"shape": {"kind": "box", "size": [20, 6, 0.1]}}
    slab = {"role": "blue water of the stream", "motion": "static", "material": "water", "dimensions": {"size": [20, 6, 0.1]}, "parts": {"body": box}}  # fmt: skip
    log = {"shape": {"kind": "cylinder", "radius": 0.3, "height": 3}}
    world["entities"] = {
        "river": slab,
        "log": {"role": "log", "motion": "dynamic", "material": "wood", "dimensions": {"size": [0.6, 0.6, 3]}, "parts": {"body": log},
                "pose": {"position": [0, 0, 2]}},
    }  # fmt: skip
    world["simulation"]["solvers"] = {"bodies": {"engine": "mujoco", "members": ["river", "log"]}}
    carries = {"kind": "floats", "entity": "log", "other": "river"}
    flows = {"kind": "liquid_flux_through", "entity": "river", "point": [0, 0, 0], "normal": [1, 0, 0], "radius": 2, "min": 1}
    beats = {"carries": ("log", carries), "flows": ("river", flows)}
    world["story"] = {"semantics": "s", "beats": {
        n: {"text": n, "owner": "bodies", "subject": subject, "frames": [0, 11], "predicate": p} for n, (subject, p) in beats.items()
    }}  # fmt: skip
    marked = "A [stream](thing river) [carries](event carries flows) beams and a [log](thing log) under a footbridge."
    row = next(
        r for r in audit(parse_spec({"prompt": PROMPT, **with_claims(world, PROMPT, marked)})).rows if r.id == "audit:evidence"
    )
    assert row.status == "fail"
    for name in beats:
        assert f"/story/beats/{name}/predicate: no engine in use writes" in " ".join(row.evidence["problems"])


def test_the_marks_of_the_prompt_name_all_beams() -> None:
    told = parse_marks(CLAIMS.format(" ".join(f"beam_{n}" for n in range(len(BEAMS)))), PROMPT)
    assert next(m.targets for m in told if m.quote == "beams") == tuple(f"beam_{n}" for n in range(len(BEAMS)))


def test_the_skill_shows_the_land_of_the_example_and_cuts_it_so() -> None:
    options = options_of([])
    land, cut, things = (c["arguments"] for c in RECORDED["calls"])
    assert land["prompt"] == PROMPT
    assert land["spec"] == json.loads(json.dumps(land_spec(options.seconds, options.fps)))
    assert (tuple(cut["size"]), tuple(cut["center"]), cut["spacing"]) == (options.size, options.center, options.spacing)
    assert things["claims"] == CLAIMS.format(" ".join(f"beam_{n}" for n in range(options.beams)))


@pytest.mark.slow
def test_the_stream_is_accepted(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Its water is five spacings deep, as what floats in it asks; a quarter of an hour on two cores."""
    sent = []
    call = stream.Ranger.call

    async def kept(self: Any, name: str, **arguments: Any) -> Any:
        if name in ("edit_spec", "build_terrain"):
            sent.append((name, {k: v for k, v in arguments.items() if k != "wait_s"}))
        return await call(self, name, **arguments)

    monkeypatch.setattr(stream.Ranger, "call", kept)
    assert run(options_of(["--out", str(tmp_path), "--no-render"]))["accepted"]
    recorded = [(c["tool"], {k: v for k, v in c["arguments"].items() if k != "world"}) for c in RECORDED["calls"]]
    assert json.loads(json.dumps(sent)) == json.loads(json.dumps(recorded)), "what the skill shows is what was accepted"
