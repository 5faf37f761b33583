"""A client declares balloons, bakes them, has them judged and looks at them. Run by `test_balloons.py` in a copy of the tree that has them."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import worldagent
from worldagent.rendering.preview import PreviewRenderer
from worldagent.rendering.views import camera_for
from worldagent.server.capabilities import capabilities
from worldagent.testing.worlds.small_balloons import BALLOON_PROMPT, balloon_spec  # type: ignore[import-not-found]
from worldagent.tests.stories.conftest import Agent
from worldagent.tests.stories.inline_jobs import run_jobs_inline
from worldagent.verifiers.register.assemble import approximations
from worldagent.worlds.candidate import Candidate, open_candidate
from worldagent.worlds.errors import LimitError
from worldagent.worlds.folder import WorldFolder
from worldagent.worlds.limits import check_limits, estimate_counts
from worldagent.worlds.patch import parse_spec

FRAMES = 16
RISE = {
    "text": "three balloons rise from the floor", "owner": "air", "subject": "balloons", "frames": [0, FRAMES - 1],
    "predicate": {"kind": "ascends", "entity": "balloons", "min": 0.2},
}  # fmt: skip
SHOT = {
    "covers": ["rise"],
    "frames": [0, FRAMES - 1],
    "keys": {"k0": {"frame": 0, "position": [0, -3.5, 0.8], "target": [0, 0, 0.5], "fov_deg": 45}},
}
STORY = {"story": {"beats": {"rise": RISE}}, "shots": {"wide": SHOT}}
PARTS = " ".join(f"/entities/balloons/parts/{side}" for side in ("left", "middle", "right"))
CLAIMS = f"[Three](count {PARTS}) [balloons](thing balloons {PARTS}) [rise](event rise) from the [floor](thing floor)."


@pytest.fixture(scope="module")
def loop(tmp_path_factory: pytest.TempPathFactory) -> tuple[dict[str, Any], list[dict[str, Any]], Candidate]:
    """The answer to the specification, the matrix after the bake, and what was baked."""
    assert (Path(worldagent.__file__).parent / "worlds/categories/balloons").is_dir()
    workspace = tmp_path_factory.mktemp("air")
    with pytest.MonkeyPatch.context() as patch, Agent(workspace) as agent:
        run_jobs_inline(patch)
        created = agent.call(
            "edit_spec", world="w", prompt=BALLOON_PROMPT, spec=balloon_spec(frames=FRAMES, **STORY), claims=CLAIMS
        )
        assert created["audit"]["passed"], created["audit"]
        agent.call("place_object", world="w")
        agent.call("probe_sim", world="w")
        agent.call("bake_sim", world="w")
        rows = agent.pages("rows", part="matrix")
        created["schema"] = agent.read("worldagent://schema/world").text
    folder = WorldFolder.at(workspace / "w")
    (made,) = (folder.root / "candidates").iterdir()
    freeze = str(json.loads((made / "candidate.json").read_text())["freeze"])
    return created, rows, open_candidate(folder, freeze, "full")


def test_balloons_are_judged_by_rows_of_their_own_in_the_matrix(loop: Any) -> None:
    _, rows, _ = loop
    status = {row["id"]: row["status"] for row in rows}
    for row in (
        "category:balloons:ledger:air",
        "category:balloons:balance:air",
        "numerical:digest:air",
        "beat:rise",
        "audit:balloons",
    ):
        assert status[row] == "pass", row
    own = {i: s for i, s in status.items() if i.endswith(":air") or "balloons" in i or ":rise" in i}
    assert {i: s for i, s in own.items() if s not in ("pass", "not_applicable")} == {}


def test_balloons_stand_in_the_register_the_schema_the_capabilities_and_the_caps(loop: Any) -> None:
    created, _, candidate = loop
    assert created["bake_order"] == ["bodies", "air"]
    assert any("balloons of 'balloons'" in line["what"] for line in approximations(candidate))
    assert all(f'"{name}"' in created["schema"] for name in ("BalloonPhysics", "BalloonInstance", "Ascends"))
    assert capabilities()["categories"]["balloons"] == {
        "available": True, "engine": "aerostat", "covers": "balloons that rise through still air",
    }  # fmt: skip
    spec = parse_spec({**balloon_spec(), "prompt": BALLOON_PROMPT})
    assert estimate_counts(spec)["particles"] == 3
    many = spec.model_copy(update={"simulation": spec.simulation.model_copy(update={"frames": 20_000_000_000})})
    with pytest.raises(LimitError):
        check_limits(many)


def test_balloons_rise_as_the_law_says(loop: Any) -> None:
    """The height of a sphere under a constant lift and a linear drag."""
    _, _, candidate = loop
    volume = 4.0 / 3.0 * np.pi * 0.15**3
    mass, drag, lift = 0.6 * volume, 0.05, 0.6 * volume * 9.81
    time = (FRAMES - 1) / 24
    height = lift / drag * (time - mass / drag * (1.0 - np.exp(-drag * time / mass)))
    data = candidate.caches["air"].read(FRAMES - 1)
    assert data["origin"][2] + data["particle/position"][:, 2] == pytest.approx([0.2 + height] * 3, rel=1e-6)


def test_balloons_are_seen_where_they_are(loop: Any) -> None:
    _, _, candidate = loop
    drawn = PreviewRenderer(candidate)
    camera = camera_for(candidate, 0, width=96, height=54)
    seen = [drawn.mask(frame, camera, "balloons") for frame in (0, FRAMES - 1)]
    low, high = (np.flatnonzero(mask.any(axis=1)).mean() for mask in seen)
    assert min(mask.sum() for mask in seen) > 20
    assert high < low - 2
    assert len(np.unique(drawn.preview(0, camera).reshape(-1, 3), axis=0)) > 10
