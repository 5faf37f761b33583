"""Files of a world and of the workspace that were cut off or hold a flipped bit: told in words, never passed, mended by the loop."""

from __future__ import annotations

import json
import random
import shutil
import sqlite3
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from mcp.shared.exceptions import MCPError
from worldagent.tests.stories.inline_jobs import run_jobs_inline
from worldagent.worlds.bundle import open_bundle
from worldagent.worlds.cache import Cache, digest_arrays, read_container
from worldagent.worlds.candidate import open_candidate
from worldagent.worlds.errors import EvidenceError, WorldAgentError
from worldagent.worlds.folder import WorldFolder
from worldagent.worlds.ledger import Ledger

SEED = 20261121
PARTS = ("overview", "spec", "matrix", "state", "events", "records", "acceptance", "revisions", "iterations")
RESOURCES = ("spec", "matrix", "report", "revisions")
DERIVED = {
    "built": "w/built/ball.*.zip",
    "record": "w/candidates/*/candidate.json",
    "frame": "w/candidates/*/bake/rigid/frame_000010.npz",
    "index": "w/candidates/*/bake/rigid/index.json",
    "digests": "w/candidates/*/bake/rigid/digests.txt",
    "checkpoint": "w/candidates/*/bake/rigid/checkpoints/000012.bin",
    "probe frame": "w/candidates/*/probe/rigid/frame_000003.npz",
    "probe index": "w/candidates/*/probe/rigid/index.json",
}
"""Files that the loop makes again from the specification."""
HELD = {"specification": "w/world.json", "ledger": "w/ledger.sqlite", "jobs": ".worldagent/jobs.db"}
pytestmark = pytest.mark.filterwarnings("ignore::ResourceWarning")


def _damaged(data: bytes, how: str, rng: random.Random) -> bytes:
    if how == "empty":
        return b""
    if how == "half":
        return data[: len(data) // 2]
    if how == "text":
        return b"nothing to see here\n" * 40
    flipped = bytearray(data)
    flipped[rng.randrange(len(flipped))] ^= 1 << rng.randrange(8)
    return bytes(flipped)


@pytest.fixture
def agent(accepted_folder: Path, tmp_path: Path, agent_of: Any, monkeypatch: pytest.MonkeyPatch) -> Iterator[Any]:
    """A client of a workspace that holds the accepted world and the list of its jobs."""
    run_jobs_inline(monkeypatch)
    shutil.copytree(accepted_folder, tmp_path / "w")
    shutil.copytree(accepted_folder.parent / ".worldagent", tmp_path / ".worldagent")
    with agent_of(tmp_path) as made:
        yield made


def _everything(agent: Any, parts: tuple[str, ...] = PARTS, resources: tuple[str, ...] = RESOURCES) -> list[str]:
    """Texts of the refusals of every call that reads, and of what it costs nothing to ask."""
    asked: list[tuple[str, dict[str, Any]]] = [("inspect_world", {"world": "w", "part": part}) for part in parts]
    asked += [("job", {"action": "list"}), ("run_checks", {"world": "w", "scope": "audit"})]
    refusals = []
    for tool, arguments in asked:
        answer = agent.result(tool, **arguments)
        text = answer.content[0].text
        assert not text.startswith("internal error"), (tool, arguments, text)
        assert "Traceback" not in text
        if answer.is_error:
            refusals.append(text)
    for name in resources:
        told = ""
        try:
            agent._portal.call(agent._client.read_resource, f"worldagent://worlds/w/{name}")
        except MCPError as error:
            told = str(error)
        assert "nternal" not in told, (name, told)
        refusals += [told] if told else []
    assert agent.call("inspect_world", part="worlds")["worlds"] == ["w"]
    return refusals


def _verdict(agent: Any) -> str:
    """The verdict of acceptance, or the text of its refusal."""
    answer = agent.result("run_checks", world="w", scope="acceptance")
    text = answer.content[0].text
    assert not text.startswith("internal error"), text
    return text if answer.is_error else str(json.loads(text)["verdict"])


def _meaning(folder: Path) -> Any:
    """Content of the bake's caches, whatever their bytes."""
    (bake,) = folder.glob("candidates/*/bake/rigid")
    (record,) = folder.glob("candidates/*/candidate.json")
    cache = Cache(bake)
    marks = [p.read_bytes() for p in sorted(bake.glob("checkpoints/*.bin"))]
    frames = [digest_arrays(read_container(cache.path(k))) for k in range(cache.index.frames)]
    return json.loads(record.read_text())["spec"], cache.index, cache.digests(), frames, marks


@pytest.mark.parametrize("kind", DERIVED)
def test_damage_to_what_is_derived_is_told(kind: str, agent: Any) -> None:
    (path,) = agent.workspace.glob(DERIVED[kind])
    before, rng = path.read_bytes(), random.Random(SEED)
    for how in ("empty", "half", "flip", "flip"):
        path.write_bytes(_damaged(before, how, rng))
        _everything(agent, ("state", "events", "acceptance"), ())
        path.write_bytes(before)


@pytest.mark.slow
@pytest.mark.parametrize(("kind", "how"), [("frame", "flip"), ("checkpoint", "half"), ("index", "empty")])
def test_damage_to_a_bake_is_refused_and_baked_again(kind: str, how: str, agent: Any) -> None:
    _derived(kind, how, agent, SEED, steps=("bake_sim",))


@pytest.mark.slow
@pytest.mark.parametrize("how", ["empty", "half", "text", "flip"])
@pytest.mark.parametrize("kind", DERIVED)
def test_every_damage_to_what_is_derived_can_be_mended(kind: str, how: str, agent: Any) -> None:
    _derived(kind, how, agent, SEED + 1, steps=("place_object", "probe_sim", "bake_sim"))


def _derived(kind: str, how: str, agent: Any, seed: int, *, steps: tuple[str, ...]) -> None:
    folder = agent.workspace / "w"
    (path,) = agent.workspace.glob(DERIVED[kind])
    meaning = _meaning(folder)
    path.write_bytes(_damaged(path.read_bytes(), how, random.Random(f"{seed}{kind}{how}")))
    verdict = _verdict(agent)
    if verdict == "accepted":  # only where nothing depends on what was damaged
        assert "probe" in kind or kind == "built" or _meaning(folder) == meaning
    for tool in steps:
        answer = agent.result(tool, world="w")
        assert not answer.is_error, answer.content[0].text
    assert _verdict(agent) == "accepted"


@pytest.mark.parametrize("how", ["empty", "half", "text"])
def test_a_damaged_specification_is_refused_and_restored_from_the_ledger(how: str, agent: Any) -> None:
    path = agent.workspace / HELD["specification"]
    before = path.read_bytes()
    path.write_bytes(_damaged(before, how, random.Random(SEED)))
    assert any("restore" in text for text in _everything(agent))
    assert "restore" in _verdict(agent)
    assert agent.call("edit_spec", world="w", on_hand_edit="restore")["restored"]
    assert path.read_bytes() == before


def test_a_flipped_bit_of_the_specification_is_no_edit(agent: Any) -> None:
    path = agent.workspace / HELD["specification"]
    before, rng = path.read_bytes(), random.Random(SEED)
    for _ in range(12):
        path.write_bytes(_damaged(before, "flip", rng))
        answer = agent.result("inspect_world", world="w")
        text = answer.content[0].text
        assert answer.is_error
        assert "restore" in text
        agent.call("edit_spec", world="w", on_hand_edit="restore")
        assert path.read_bytes() == before


@pytest.mark.parametrize("how", ["empty", "half", "text"])
def test_a_damaged_ledger_opens_nothing_and_harms_nothing_beside_it(how: str, agent: Any) -> None:
    path = agent.workspace / HELD["ledger"]
    beside = {p: p.read_bytes() for p in (agent.workspace / "w").rglob("*") if p.is_file() and not p.name.startswith("ledger")}
    spec = json.loads((agent.workspace / "w" / "world.json").read_text())
    path.write_bytes(_damaged(path.read_bytes(), how, random.Random(SEED)))
    refusals = _everything(agent)
    assert refusals
    assert all("ledger" in text for text in refusals if not text.startswith("invalid"))
    for tool, more in (
        ("run_checks", {"scope": "acceptance"}),
        ("bake_sim", {}),
        ("render_shot", {"kind": "final"}),
        ("edit_spec", {"patch": [{"op": "add", "path": "/title", "value": "x"}]}),
        ("edit_spec", {"on_hand_edit": "restore"}),
        ("edit_spec", {"on_hand_edit": "adopt"}),
    ):
        answer = agent.result(tool, world="w", **more)
        text = answer.content[0].text
        assert answer.is_error
        assert "ledger" in text
        assert "put back a copy" in text
    assert {p: p.read_bytes() for p in beside} == beside
    prompt = spec.pop("prompt")
    agent.call("edit_spec", world="w2", prompt=prompt, spec=spec)
    with sqlite3.connect(agent.workspace / "w2" / "ledger.sqlite") as db:
        ((weakenings,),) = db.execute("SELECT weakenings FROM revisions").fetchall()
    db.close()
    assert how == "empty" or "ledger is damaged" in weakenings


def _flips(agent: Any, count: int, seed: int) -> dict[str, int]:
    """Flip one bit of the ledger after another; what was written is read, or nothing is."""
    path = agent.workspace / HELD["ledger"]
    before, rng = path.read_bytes(), random.Random(seed)
    good = [agent.call("inspect_world", world="w", part=part) for part in ("matrix", "acceptance", "spec")]
    found = {"same": 0, "told": 0}
    for _ in range(count):
        path.write_bytes(_damaged(before, "flip", rng))
        for part, known in zip(("matrix", "acceptance", "spec"), good, strict=True):
            answer = agent.result("inspect_world", world="w", part=part)
            text = answer.content[0].text
            assert not text.startswith("internal error"), text
            if answer.is_error:
                assert "ledger" in text
            else:
                assert (
                    json.loads(text)[{"matrix": "rows"}.get(part, part if part == "acceptance" else "value")]
                    == known[{"matrix": "rows"}.get(part, part if part == "acceptance" else "value")]
                )
            found["told" if answer.is_error else "same"] += 1
        path.with_name("ledger.sqlite-journal").unlink(missing_ok=True)
    path.write_bytes(before)
    assert agent.call("inspect_world", world="w", part="matrix") == good[0]
    return found


def test_a_flipped_bit_of_the_ledger_changes_no_verdict(agent: Any) -> None:
    found = _flips(agent, 30, SEED)
    assert found["told"]
    assert found["same"]


@pytest.mark.slow
def test_no_flipped_bit_of_the_ledger_changes_a_verdict(agent: Any) -> None:
    assert all(_flips(agent, 2000, SEED + 1).values())


@pytest.mark.parametrize("how", ["empty", "half", "text"])
def test_a_damaged_list_of_jobs_is_set_aside_and_work_goes_on(how: str, agent: Any, agent_of: Any) -> None:
    path = agent.workspace / HELD["jobs"]
    agent.call("job", action="list")  # opened while it was whole
    path.with_name("jobs.db-journal").unlink(missing_ok=True)
    path.write_bytes(_damaged(path.read_bytes(), how, random.Random(SEED)))
    with agent_of(agent.workspace) as fresh:
        for client in (agent, fresh):
            told = [client.result("job", action="list") for _ in range(2)]
            assert not told[0].content[0].text.startswith("internal error"), told[0].content[0].text
            if told[0].is_error:
                assert "empty list of jobs begins" in told[0].content[0].text
            assert not told[1].is_error, told[1].content[0].text
        _everything(fresh)
    assert how == "empty" or list(path.parent.glob("jobs.damaged-*.db"))


@pytest.mark.parametrize("what", ["frame", "built", "index", "record", "bundle"])
def test_readers_tell_every_flipped_bit_and_every_cut(what: str, copy: Path) -> None:
    _read_damaged(what, copy, 60, SEED)


@pytest.mark.slow
@pytest.mark.parametrize("what", ["frame", "built", "index", "record", "bundle"])
def test_readers_tell_thousands_of_flipped_bits_and_cuts(what: str, copy: Path) -> None:
    _read_damaged(what, copy, 5000, SEED + 1)


def test_a_record_that_builds_what_is_no_entity_is_damaged(copy: Path) -> None:
    (path,) = copy.glob("candidates/*/candidate.json")
    record = json.loads(path.read_text())
    record["built"]["banl"] = record["built"].pop("ball")
    path.write_text(json.dumps(record))
    with pytest.raises(EvidenceError, match="names what is no entity"):
        open_candidate(WorldFolder(copy), record["freeze"], "full")


def _read_damaged(what: str, folder: Path, count: int, seed: int) -> None:
    """Whatever is read from a damaged file is what was written, or an error of ours, never another exception."""
    pattern = "acceptance/*.zip" if what == "bundle" else DERIVED[what].removeprefix("w/")
    (path,) = folder.glob(pattern)
    (record,) = folder.glob("candidates/*/candidate.json")
    freeze = json.loads(record.read_text())["freeze"]
    before, rng = path.read_bytes(), random.Random(seed)

    def read() -> Any:
        if what == "bundle":
            return open_bundle(path).digest
        if what == "frame":
            return digest_arrays(read_container(path))
        found = open_candidate(WorldFolder(folder), freeze, "full")
        return found.spec, found.digest, sorted((n, b.digest()) for n, b in found.built.items())

    good, told = read(), 0
    for k in range(count):
        data = before[: rng.randrange(len(before))] if k % 4 == 3 else _damaged(before, "flip", rng)
        path.write_bytes(data)
        try:
            found = read()
        except WorldAgentError:
            told += 1
        else:
            assert found == good or what == "index", k  # another index has another digest: acceptance compares it
    assert told > count // 3


def test_a_ledger_without_seals_is_of_an_earlier_version_and_still_read(agent: Any) -> None:
    with sqlite3.connect(agent.workspace / HELD["ledger"]) as db:
        db.execute("DELETE FROM meta")
    db.close()
    assert agent.call("inspect_world", world="w")["last_verdict"]["verdict"] == "accepted"
    assert Ledger(agent.workspace / HELD["ledger"]).rows()
