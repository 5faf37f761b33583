"""State at a frame and over frames: orientation, spin, contact forces, loose matter by region, stretch of cloth by place."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from worldagent.construction import build_entity
from worldagent.simulation.schedule import run_frames
from worldagent.testing.worlds.small_cloth import catch_spec
from worldagent.testing.worlds.small_grains import sand_spec
from worldagent.testing.worlds.small_liquids import PROMPT, tank_spec
from worldagent.testing.worlds.small_worlds import ball, box, ground, world
from worldagent.workflow import measurements
from worldagent.workflow.answers import PAGE_CHARACTERS, size_of
from worldagent.worlds.candidate import Candidate, cache_digest
from worldagent.worlds.patch import parse_spec
from worldagent.worlds.spec import Pose, RigidPhysics, WorldSpec

G = 9.81


class World:
    """A simulated world whose state is asked for."""

    def __init__(self, spec: WorldSpec, folder: Path, frames: int, patcher: pytest.MonkeyPatch) -> None:
        built = {n: build_entity(spec, n, folder) for n in spec.entities}
        caches = run_frames(spec, built, folder / "run", frames=frames)
        self.candidate = Candidate(folder, spec, built, "probe", caches, "run", cache_digest(caches))
        self.session: Any = SimpleNamespace(folder=SimpleNamespace(id="w"), spec=spec, shown=lambda *_: "")
        patcher.setattr(measurements, "latest_candidate", lambda *_: self.candidate)

    def state(self, *entities: str, frames: tuple[int, int]) -> dict[str, Any]:
        """The whole answer."""
        return measurements.measured(self.session, "state", entities=list(entities), frames=frames, limit=40, offset=0)

    def of(self, entity: str, *frames: int) -> dict[str, Any]:
        """State of one entity as told, at a frame or from one to another."""
        told: dict[str, Any] = self.state(entity, frames=(frames[0], frames[-1]))["entities"][entity]
        return told

    def record(self, solver: str, name: str) -> Any:
        """A record over the frames."""
        return self.candidate.caches[solver].series(f"record/{name}")


def _regions(spec: dict[str, Any], **regions: Any) -> WorldSpec:
    graph = spec.get("graph", {})
    return parse_spec({"prompt": PROMPT, **spec, "graph": {**graph, "regions": {**graph.get("regions", {}), **regions}}})


def test_a_body_tells_its_orientation_and_spin_and_the_force_that_bears_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """At rest the floor bears the weight; a free body turns by its spin."""
    things = {
        "floor": ground(),
        "crate": box(0.2, 0.2, 0.2, motion="dynamic", at=(0, 0, 0.101)),
        "top": ball(0.1, motion="dynamic", at=(1, 0, 3.0), physics=RigidPhysics(angular_velocity=(0, 0, 2.0))),
    }
    found = World(world(things, frames=13), tmp_path, 13, monkeypatch)
    top = found.of("top", 0, 12)
    assert np.allclose(top["spin"], [[0, 0, 2.0]] * 13, atol=0.01)
    half = 0.5 * 2.0 * np.arange(13) / found.candidate.spec.simulation.fps
    assert np.allclose(top["quaternion"], np.stack([np.cos(half), 0 * half, 0 * half, np.sin(half)], axis=1), atol=0.005)
    assert "force" not in top, "nothing touches it"
    weight = 600.0 * 0.2**3 * G
    assert found.of("crate", 1)["forces"]["floor"][2] == pytest.approx(weight, rel=0.01)
    assert found.of("floor", 1)["forces"]["crate"][2] == pytest.approx(-weight, rel=0.01)
    over = found.of("crate", 0, 12)
    assert over["force"]["floor"][1] == pytest.approx(weight, rel=0.01)
    still = [k for k in range(13) if over["force"]["floor"][k] == 0.0 and k > 0]
    assert still
    assert set(still) <= set(over["asleep_at"]), "no contact is logged of what sleeps, which is said"
    assert found.of("crate", still[0])["asleep"]


def test_a_body_whose_position_is_not_its_middle_tells_its_centre_of_mass_too(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A marble whose position is its lowest point, as generators place it: rolling, that point goes up and down, the centre does not."""
    marble = ball(
        0.1, motion="dynamic", at=(0, 0, 0.0002), physics=RigidPhysics(angular_velocity=(0, 10.0, 0), linear_velocity=(1, 0, 0))
    )
    ((part, made),) = marble.parts.items()
    lifted = marble.model_copy(update={"parts": {part: made.model_copy(update={"pose": Pose(position=(0, 0, 0.1))})}})
    found = World(world({"floor": ground(), "marble": lifted}, frames=13), tmp_path, 13, monkeypatch)
    over = found.of("marble", 0, 12)
    assert np.ptp([z for _, _, z in over["position"]]) > 0.1
    assert np.allclose([z for _, _, z in over["centre"]], 0.1, atol=1e-3)
    assert found.of("marble", 6)["centre"] == pytest.approx(over["centre"][6], abs=1e-4)
    assert "centre" not in found.of("floor", 0)


def test_grains_tell_how_many_are_where_and_how_fast_and_what_they_push(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    all_of_it = {"kind": "box", "min": [-9, -9, -9], "max": [9, 9, 9]}
    nowhere = {"kind": "box", "min": [5, 5, 5], "max": [6, 6, 6]}
    frames = 9
    spec = _regions(sand_spec(radius=0.018, frames=frames), room=all_of_it, sky=nowhere)
    found = World(spec, tmp_path, frames, monkeypatch)
    solver = next(iter(spec.simulation.particles))
    sand = found.of("sand", 0, frames - 1)
    assert sand["count"] == found.record(solver, "particles").tolist()
    assert sand["regions"]["room"]["count"] == sand["count"]
    assert sand["regions"]["sky"] == {"count": [0] * frames, "mean_speed": [0.0] * frames}
    assert np.allclose(sand["mean_speed"], found.record(solver, "mean_speed"), atol=1e-4)
    now = found.of("sand", frames - 1)
    assert now["mass"] == pytest.approx(found.record(solver, "mass")[frames - 1], rel=1e-3)
    low, high, centre = (np.array(now[n]) for n in ("box_min", "box_max", "centre"))
    assert (low < centre).all()
    assert (centre < high).all()
    touched = found.of("ball", 0, frames - 1)["force"]
    assert max(touched["sand"]) > 0
    assert found.of("sand", 0, frames - 1)["max_speed"][frames - 1] < 3.0


def test_a_liquid_tells_the_same_and_its_front_goes_where_it_flows(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    frames = 6
    spec = parse_spec({"prompt": PROMPT, **tank_spec(frames=frames, spacing=0.05)})
    found = World(spec, tmp_path, frames, monkeypatch)
    water = next(n for n, e in spec.entities.items() if e.physics.category == "liquid")
    told = found.of(water, frames - 1)
    solver = next(iter(spec.simulation.liquid))
    assert told["count"] == found.record(solver, "particles")[frames - 1]
    assert told["mass"] == pytest.approx(found.record(solver, "mass")[frames - 1], rel=1e-3)
    if "front" in told:
        first, now = np.array(found.of(water, 0)["centre"]), np.array(told["centre"])
        assert (np.array(told["front"]) - now) @ (now - first) >= 0


def test_cloth_tells_where_it_is_stretched_most_and_the_body_what_it_feels(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    frames = 14
    spec = parse_spec({"prompt": PROMPT, **catch_spec(frames=frames, resolution=0.1)})
    found = World(spec, tmp_path, frames, monkeypatch)
    cloth = found.of("cloth", 0, frames - 1)
    assert np.allclose(cloth["stretch"], found.record("cloth", "stretch_max"), atol=2e-5), "the engine's own record"
    worst = cloth["most_stretched"]
    assert worst["frame"] == int(np.argmax(cloth["stretch"]))
    grid = worst["thirds_of_xy"]
    assert max(v for row in grid for v in row) == pytest.approx(worst["largest"])
    x, y, _ = worst["place_at_rest"]
    column, row = (min(2, int(3 * (c + 0.5))) for c in (x, y))
    assert grid[row][column] == pytest.approx(worst["largest"])
    ball_, sheet = found.of("ball", 0, frames - 1)["force"]["cloth"], cloth["force"]["ball"]
    assert ball_ == sheet, "each feels what the other gives"
    assert max(ball_) > 0.2 * float(found.candidate.body("ball").mass) * G
    assert np.array(found.of("ball", int(np.argmax(ball_)))["forces"]["cloth"])[2] > 0, "it is caught from below"


def test_a_page_of_motion_stays_within_what_clients_take(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    things = {f"b{k}": ball(0.1, motion="dynamic", at=(k, 0, 0.101)) for k in range(5)}
    found = World(world({"floor": ground(), **things}, frames=40), tmp_path, 40, monkeypatch)
    seen, offset = list[str](), 0
    while True:
        told = measurements.measured(found.session, "state", entities=None, frames=(0, 39), limit=40, offset=offset)
        assert size_of(told) < 1.6 * PAGE_CHARACTERS
        seen += told["entities"]
        if "next_offset" not in told:
            break
        offset = told["next_offset"]
    assert seen == ["floor", *things]
