"""A client declares a ball over a tray of sand probes it, and sees it."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

import pytest
from worldagent.rendering.preview import PreviewRenderer
from worldagent.rendering.views import camera_for
from worldagent.simulation.bake import run_bake
from worldagent.simulation.probe import replay
from worldagent.testing.worlds.small_grains import SAND_PROMPT, sand_spec
from worldagent.tests.stories.inline_jobs import run_jobs_inline
from worldagent.worlds.candidate import Candidate, open_candidate
from worldagent.worlds.folder import WorldFolder

FRAMES = 14
SHOT = {
    "covers": ["lands"],
    "frames": [0, FRAMES - 1],
    "keys": {"k0": {"frame": 0, "position": [0.42, -0.45, 0.4], "target": [0, 0, 0.04], "fov_deg": 45}},
}
CLAIMS = "A [steel](property ball) [ball](thing ball) [drops](event lands) into a [tray](thing tray) of [sand](thing sand)."
SAND_STORY = {
    "graph": {"regions": {"bed": {"kind": "box", "min": [-0.12, -0.12, 0.0], "max": [0.12, 0.12, 0.08]}}},
    "story": {
        "beats": {
            "lands": {
                "text": "the ball drops into the sand", "owner": "hold", "subject": "ball", "frames": [0, FRAMES - 1],
                "predicate": {"kind": "and", "of": [{"kind": "falls", "entity": "ball"}, {"kind": "reaches", "entity": "ball", "region": "bed"}]},
            }
        },
        "requirements": {
            "stays": {"text": "the sand stays in the tray", "predicate": {"kind": "particle_count_in", "entity": "sand", "region": "bed", "min": 80, "when": "always"}},
            "flat": {"text": "it stays a bed", "predicate": {"kind": "pile_height", "entity": "sand", "min": 0.02, "max": 0.08}},
            "reach": {"text": "within the tray", "predicate": {"kind": "run_out", "entity": "sand", "center": [0, 0], "max": 0.18}},
            "calm": {"text": "it comes to rest", "predicate": {"kind": "particles_settled", "entity": "sand", "max_speed": 0.2}},
            "much": {"text": "as much as there is", "predicate": {"kind": "particle_volume_in", "entity": "sand", "region": "bed", "min": 5e-4}},
        },
    },
    "shots": {"wide": SHOT},
}  # fmt: skip


@pytest.fixture(scope="module")
def probed(agent_of: Any, tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[dict[str, str], Candidate]]:
    """Statuses of the matrix after a probe, and its caches."""
    workspace = tmp_path_factory.mktemp("sand")
    with pytest.MonkeyPatch.context() as patch, agent_of(workspace) as agent:
        run_jobs_inline(patch)
        spec = sand_spec(radius=0.012, depth=0.05, frames=FRAMES, ball_at=0.12, young=1e7, preroll=0.1, **SAND_STORY)
        created = agent.call("edit_spec", world="w", prompt=SAND_PROMPT, spec=spec, claims=CLAIMS)
        assert created["audit"]["passed"], created["audit"]
        assert created["bake_order"] == ["bodies", "grains"]
        agent.call("place_object", world="w")
        agent.call("probe_sim", world="w")
        rows = {r["id"]: r["status"] for r in agent.pages("rows", part="matrix")}
        folder = WorldFolder.at(workspace / "w")
        yield rows, open_candidate(folder, _freeze(folder), "probe")


def _freeze(folder: WorldFolder) -> str:
    (made,) = (folder.root / "candidates").iterdir()
    return str(json.loads((made / "candidate.json").read_text())["freeze"])


def test_every_row_about_the_sand_and_what_is_asked_of_it_passes(probed: Any) -> None:
    rows, _ = probed
    own = {n: s for n, s in rows.items() if n.endswith(":grains") or n.startswith("requirement") or ":lands" in n}
    assert len(own) > 15
    assert {n: s for n, s in own.items() if s not in ("pass", "not_applicable")} == {}


def test_the_bake_gives_the_bytes_of_the_probe_and_of_its_replay(probed: Any) -> None:
    _, candidate = probed
    baked = run_bake(WorldFolder.at(candidate.folder), _freeze(WorldFolder.at(candidate.folder)))
    for name, cache in baked.caches.items():
        assert cache.digests()[:FRAMES] == candidate.caches[name].digests()[:FRAMES], name
    assert all(r["identical"] for r in replay(baked, intervals=2, seed=2))


def test_the_preview_shows_sand_in_the_tray(probed: Any) -> None:
    _, candidate = probed
    renderer = PreviewRenderer(candidate)
    camera = camera_for(candidate, 0, shot="wide", width=480, height=320)
    seen = renderer.entity_ids(renderer.cast(0, camera))
    share = {n: float((seen == k).mean()) for k, n in enumerate(renderer.entities)}
    assert share["sand"] > 0.005
    assert share["ball"] > 0.002
    picture = renderer.preview(0, camera).astype(float)
    sand = picture[seen == renderer.entities.index("sand")].mean(axis=0)
    assert sand[0] > sand[2] + 20  # its own colour, not that of wood
