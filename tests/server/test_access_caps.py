"""Every declared cap holds: work beyond it is refused before it begins, with the cap, the estimate and the knob."""

from __future__ import annotations

import json
import re
from collections import namedtuple
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from anyio.from_thread import BlockingPortal, start_blocking_portal
from mcp import Client
from worldagent.construction.primitives import build_shape
from worldagent.execution import JobStore
from worldagent.server.app import create_server
from worldagent.server.capabilities import all_caps
from worldagent.tests.stories.small_run import PROMPT, small_spec
from worldagent.worlds.errors import LimitError
from worldagent.worlds.limits import CAPS, estimate_counts
from worldagent.worlds.patch import parse_spec
from worldagent.worlds.shapes import Box, Capsule, Cylinder, Extrusion, HeightField, Revolution, Sphere, Wedge
from worldagent.worlds.spec import WorldSpec

CREATE = ("edit_spec", {"world": "new", "prompt": PROMPT, "spec": small_spec()})
EDIT = ("edit_spec", {"world": "w", "patch": [{"op": "replace", "path": "/title", "value": "Other"}], "hypothesis": "why not"})
PROBE = ("probe_sim", {"world": "w", "wait_s": 0})

THROUGH_A_TOOL: dict[str, tuple[str, dict[str, Any]]] = {
    **dict.fromkeys(
        [
            "spec_values", "spec_depth", "entities", "bodies", "parts", "frames", "steps", "body_steps", "rerun_body_steps", "width",
            "height", "samples", "cells", "triangles", "cache_bytes", "worlds", "workspace_bytes", "particles", "particle_steps", "vertices",
            "vertex_steps", "cell_steps",
        ],
        CREATE,
    ),
    **dict.fromkeys(["patch_operations", "patch_values", "text_characters"], EDIT),
    "still_samples": ("render_shot", {"world": "w", "kind": "still", "stage": "static"}),
    "film_samples": ("render_shot", {"world": "w", "kind": "final"}),
}  # fmt: skip
"""Calls that are within every cap but the one that is set to nothing."""
ELSEWHERE = {
    "job_seconds": "tests/server/test_access_caps.py::test_a_job_carries_its_caps_of_time_and_memory",
    "job_memory_bytes": "tests/server/test_access_caps.py::test_a_job_carries_its_caps_of_time_and_memory",
    "bundle_bytes": "tests/worlds/test_bundle.py::test_a_bundle_above_its_caps_is_not_written",
    "bundle_members": "tests/server/test_access_caps.py::test_a_bundle_of_too_many_members_is_neither_written_nor_opened",
    **dict.fromkeys(
        ["mesh_bytes", "mesh_triangles", "dem_bytes"], "tests/server/test_access_caps.py::test_files_of_assets_are_capped"
    ),
    "pieces": "tests/worlds/categories/fracture/test_fracture.py::test_too_many_pieces_are_refused",
    "stems": "tests/construction/terrain/test_stems.py::test_too_many_stems_are_refused_and_none_are_no_part",
    "crowded_pairs": "tests/hostile/test_numbers.py::test_a_thousand_bodies_in_one_place_are_refused_before_their_pairs_are_measured",
    "world_files": "tests/worlds/test_foreign.py::test_a_folder_of_very_many_files_is_refused",
    "queued_jobs": "tests/server/test_access_caps.py::test_jobs_that_wait_are_counted",
    "running_jobs": "tests/execution/test_jobs.py::test_many_cores_do_not_mean_as_many_jobs",
    "queued_jobs_per_world": "tests/server/test_access_caps.py::test_jobs_that_wait_are_counted",
    "message_bytes": "tests/hostile/test_messages.py::test_http_survives_a_thousand_malformed_messages",
    "resource_bytes": "tests/server/test_access_caps.py::test_a_large_file_is_not_sent",
    "connections": "tests/server/test_access_http.py::test_slow_and_idle_connections_are_closed_and_keep_nobody_out",
    "sessions": "tests/server/test_access_http.py::test_sessions_are_counted",
    "tokens": "tests/server/test_access_tokens.py::test_tokens_are_counted",
}
"""Caps whose test is another one."""
ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def portal() -> Iterator[BlockingPortal]:
    with start_blocking_portal("asyncio") as running:
        yield running


@pytest.fixture(scope="module")
def client(portal: BlockingPortal, tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[Client, Path]]:
    """A client of a workspace with one world `w` whose static rows pass."""
    workspace = tmp_path_factory.mktemp("caps")
    with portal.wrap_async_context_manager(Client(create_server(workspace))) as connected:
        made = portal.call(connected.call_tool, "edit_spec", {"world": "w", "prompt": PROMPT, "spec": small_spec()})
        assert not made.is_error, made.content[0].text
        placed = portal.call(connected.call_tool, "place_object", {"world": "w"})
        assert json.loads(placed.content[0].text)["static_passed"]
        yield connected, workspace


def test_every_cap_is_shown_and_has_its_test() -> None:
    names = [cap.name for cap in all_caps()]
    assert len(set(names)) == len(names)
    assert set(CAPS) <= set(names)
    assert set(names) == {*THROUGH_A_TOOL, *ELSEWHERE}
    for place in ELSEWHERE.values():
        file, _, test = place.partition("::")
        assert re.search(rf"^(async )?def {test}\(", (ROOT / file).read_text(), re.MULTILINE), place
    for cap in all_caps():
        assert cap.value > 0
        assert cap.unit
        assert cap.knob


@pytest.mark.parametrize("name", sorted(THROUGH_A_TOOL))
def test_a_cap_is_held_before_the_work(
    client: tuple[Client, Path], portal: BlockingPortal, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    connected, workspace = client
    monkeypatch.setattr("worldagent.workflow.gates.require_acceptance", lambda *_: {})  # a film of a world that is not baked
    monkeypatch.setitem(CAPS, name, replace(CAPS[name], value=-1))
    before = sorted(str(p) for p in workspace.rglob("*") if "jobs.db" not in p.name)
    tool, arguments = THROUGH_A_TOOL[name]
    answer = portal.call(connected.call_tool, tool, arguments)
    assert answer.is_error
    text = answer.content[0].text
    assert text.startswith(f"over the limit: {name}: estimated "), text
    assert CAPS[name].unit in text
    assert f"Knob: {CAPS[name].knob}" in text
    assert sorted(str(p) for p in workspace.rglob("*") if "jobs.db" not in p.name) == before, "nothing was made"


@pytest.mark.parametrize("tool", ["probe_sim", "bake_sim", "render_shot"])
def test_work_that_does_not_fit_on_the_disk_is_refused_with_its_estimate(
    client: tuple[Client, Path], portal: BlockingPortal, monkeypatch: pytest.MonkeyPatch, tool: str
) -> None:
    connected, _ = client
    usage = namedtuple("usage", ("total", "used", "free"))  # noqa: PYI024
    monkeypatch.setattr("shutil.disk_usage", lambda _: usage(10**9, 10**9 - 1000, 1000))
    monkeypatch.setattr("worldagent.workflow.gates.require_acceptance", lambda *_: {})
    monkeypatch.setattr("worldagent.worlds.ledger.Ledger.freeze", lambda *_: {"passed": True, "detail": {}})
    monkeypatch.setattr("worldagent.workflow.gates.require_probe", lambda *_: {"passed": True, "detail": {}})
    monkeypatch.setattr("worldagent.workflow.measurements.is_whole", lambda *_: False)
    answer = portal.call(connected.call_tool, tool, {"world": "w", **({"kind": "final"} if tool == "render_shot" else {})})
    assert answer.is_error
    assert answer.content[0].text.startswith("over the limit: disk: estimated ")
    assert "free 1,000" in answer.content[0].text


def test_a_job_carries_its_caps_of_time_and_memory(client: tuple[Client, Path], portal: BlockingPortal) -> None:
    """That they end the job is tested with the jobs themselves."""
    connected, workspace = client
    started = portal.call(connected.call_tool, *PROBE)
    assert not started.is_error, started.content[0].text
    job_id = json.loads(started.content[0].text)["job_id"]
    store = JobStore(workspace)
    job = store.get(job_id)
    assert 0 < job.wall_s <= CAPS["job_seconds"].value
    assert 0 < job.memory_bytes <= CAPS["job_memory_bytes"].value
    portal.call(connected.call_tool, "job", {"action": "cancel", "job_id": job_id})
    assert store.wait(job_id, 60).ended


@pytest.mark.parametrize("name", ["mesh_bytes", "mesh_triangles", "dem_bytes"])
def test_files_of_assets_are_capped(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    import trimesh
    from worldagent.construction.imports import load_mesh
    from worldagent.construction.outside import arrays_of
    from worldagent.worlds.shapes import Mesh

    trimesh.creation.box().export(tmp_path / "box.stl")
    shape = Mesh(file="box.stl", collision="hull")
    load_mesh(shape, tmp_path)
    monkeypatch.setitem(CAPS, name, replace(CAPS[name], value=11))
    with pytest.raises(LimitError, match=f"{name}: estimated .* cap 11. Knob: "):
        arrays_of("dem", tmp_path, "box.stl", "dem_bytes") if name == "dem_bytes" else load_mesh(shape, tmp_path)


def test_jobs_that_wait_are_counted(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("worldagent.execution.jobs.start", lambda table, job, slots: job)
    monkeypatch.setattr("worldagent.execution.queue.QUEUED_PER_WORLD", 2)
    monkeypatch.setattr("worldagent.execution.queue.QUEUED_PER_WORKSPACE", 3)
    store = JobStore(tmp_path)

    def submit(world: str) -> None:
        store.submit("probe", world, {}, entry="worldagent.workflow.jobs:probe")

    submit("a")
    submit("a")
    with pytest.raises(LimitError, match="queued_jobs_per_world"):
        submit("a")
    submit("b")
    with pytest.raises(LimitError, match="queued_jobs:"):
        submit("c")


def test_a_bundle_of_too_many_members_is_neither_written_nor_opened(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from worldagent.worlds.bundle import open_bundle, write_bundle
    from worldagent.worlds.errors import EvidenceError

    members = {"verdict.json": b"{}", "history.json": b"{}", "events.json": b"{}", "world/world.json": b"{}"}
    path = write_bundle(tmp_path / "a.zip", {}, members).path
    monkeypatch.setitem(CAPS, "bundle_members", replace(CAPS["bundle_members"], value=2))
    with pytest.raises(LimitError, match="bundle_members"):
        write_bundle(tmp_path / "b.zip", {}, members)
    with pytest.raises(EvidenceError, match="bundle_members"):
        open_bundle(path)


def test_a_large_file_is_not_sent(client: tuple[Client, Path], portal: BlockingPortal, monkeypatch: pytest.MonkeyPatch) -> None:
    connected, workspace = client
    monkeypatch.setattr("worldagent.server.resources.MAX_FILE_BYTES", 10)
    film = workspace / "w" / "candidates" / "x" / "final" / "final.webm"
    film.parent.mkdir(parents=True)
    film.write_bytes(b"x" * 11)
    try:
        for uri in ("worldagent://worlds/w/spec", "worldagent://worlds/w/film"):
            with pytest.raises(Exception, match="at most 10 are sent"):
                portal.call(connected.read_resource, uri)
    finally:
        film.unlink()


@pytest.mark.parametrize(
    "shape",
    [
        Box(size=(1, 1, 1)), Sphere(radius=1), Cylinder(radius=1, height=1), Capsule(radius=1, length=1), Wedge(size=(1, 1, 1)),
        Extrusion(polygon=[(0, 0), (2, 0), (2, 2), (1, 1), (0, 2)], height=1),
        Revolution(profile=[(0.5, 0), (1, 0), (1, 1), (0.5, 1)], segments=20),
        HeightField(size=(1, 1), heights=[[0, 1, 0, 0], [0, 0, 0, 1], [0, 0, 0, 1]]),
    ],
)  # fmt: skip
def test_the_estimate_of_triangles_is_no_less_than_what_is_built(shape: Any) -> None:
    spec = small_spec()
    spec["entities"] = {"a": {**spec["entities"]["floor"], "parts": {"p": {"shape": shape.model_dump()}}}}
    spec |= {"graph": {}, "story": {}, "claims": {}, "shots": {}}
    spec["simulation"]["solvers"]["rigid"]["members"] = ["a"]
    estimated = estimate_counts(WorldSpec.model_validate({**spec, "prompt": "p"}))["triangles"]
    built = len(build_shape(shape, Path()).render.faces)
    assert built <= estimated <= 2 * built + 100


def test_the_small_world_is_within_every_cap() -> None:
    estimates = estimate_counts(parse_spec({**small_spec(), "prompt": PROMPT}))
    assert estimates
    for name, estimate in estimates.items():
        assert 0 <= estimate <= CAPS[name].value
