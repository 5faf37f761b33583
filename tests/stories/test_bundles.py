"""Portable proof: an acceptance bundle is judged anew anywhere, and no tampered one verifies (R117-R123)."""

from __future__ import annotations

import hashlib
import io
import json
import shutil
import stat
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.server.cli import main
from worldagent.tests.stories.bundle_forgery import Forgery, forged
from worldagent.workflow.bundles import bundle_world
from worldagent.workflow.verify_folder import verify_folder
from worldagent.worlds.cache import digest_arrays, read_container, write_container
from worldagent.worlds.limits import CAPS, Cap
from worldagent.worlds.verdicts import verdict_words

pytestmark = pytest.mark.slow


@pytest.fixture(scope="session")
def bundle(loop: Any) -> Path:
    """The bundle that acceptance of the small world wrote."""
    answer = json.loads(loop.answers["accept"].content[0].text)
    return Path(loop.workspace / "w" / answer["bundle"])


@pytest.fixture(scope="session")
def judged() -> dict[Any, Any]:
    """Records by what was judged."""
    return {}


@pytest.fixture(autouse=True)
def in_this_process(monkeypatch: pytest.MonkeyPatch, judged: dict[Any, Any]) -> None:
    """Judge in this process, and equal folders once: most forgeries leave the world itself alone. `test_portability` runs the command."""
    from worldagent.verifiers import acceptance

    def judge(root: Path, **options: Any) -> dict[str, Any]:
        state = hashlib.sha256(repr(sorted(options.items())).encode())
        for path in sorted(p for p in root.rglob("*") if p.is_file()):
            state.update(path.relative_to(root).as_posix().encode() + b"\0" + path.read_bytes())
        if state.digest() not in judged:
            judged[state.digest()] = json.dumps(acceptance.judge(root, **options))
        return json.loads(judged[state.digest()])

    monkeypatch.setattr(acceptance, "judge_fresh", judge)


def _verify(path: Path, **options: Any) -> dict[str, Any]:
    return verify_folder(path, replay=True, seed=7, **options)


# ---------------------------------------------------------------- what is true


def test_a_bundle_is_accepted_elsewhere_with_every_row_equal(bundle: Path, tmp_path: Path, loop: Any) -> None:
    away = Path(shutil.copy(bundle, tmp_path / "proof of something.zip"))
    found = _verify(away, report=tmp_path / "page.html")
    assert found["verdict"] == found["own_verdict"] == found["bundled_verdict"] == "accepted"
    assert found["problems"] == found["differences"] == found["other_environment"] == []
    assert found["seed"] == 7
    assert [r["frames"] for r in found["replayed"]] == [[0, 0], [0, 12], [12, 24], [24, 35]]
    assert found["digest"] == json.loads(loop.answers["accept"].content[0].text)["bundle_digest"]
    assert "accepted" in (tmp_path / "page.html").read_text()


def test_the_manifest_tells_what_the_bundle_is_about(bundle: Path) -> None:
    made = Forgery(bundle)
    head = made.manifest
    assert (head["format"], head["format_version"], head["verdict"], head["caches"]) == (
        "worldagent-bundle", 1, "accepted", "included",
    )  # fmt: skip
    assert head["says"] == verdict_words(json.loads(made.members["verdict.json"]))
    assert hashlib.sha256(made.members["world/world.json"]).hexdigest() == head["spec_digest"]
    assert {"python", "device", "worldagent"} <= set(head["environment"])
    assert head["versions"]["mujoco"]
    verdict = json.loads(made.members["verdict.json"])
    assert verdict["approximations"]
    assert {"rows", "prompt", "weakenings", "seed", "verifier_source"} <= set(verdict)
    events = json.loads(made.members["events.json"])
    assert events["beats"]["strike"] is not None
    assert {"ball", "b1"} in [set(e["pair"]) for e in events["contacts"]]
    (revision,) = json.loads(made.members["history.json"])["revisions"]
    assert revision["digest"] == head["spec_digest"]


def test_equal_content_gives_equal_bytes(copy: Path, tmp_path: Path) -> None:
    first = bundle_world(copy, out=tmp_path / "a.zip", seed=3)
    second = bundle_world(copy, out=tmp_path / "b.zip", seed=3)
    assert first["digest"] == second["digest"]
    assert (tmp_path / "a.zip").read_bytes() == (tmp_path / "b.zip").read_bytes()


def test_without_caches_the_whole_motion_is_simulated_again(copy: Path, bundle: Path, tmp_path: Path) -> None:
    path = tmp_path / "small.zip"
    assert bundle_world(copy, out=path, with_caches=False)["verdict"] == "accepted"
    assert not [n for n in Forgery(path).members if n.endswith(".npz") and "/plates/" not in n]
    assert path.stat().st_size < bundle.stat().st_size
    assert _verify(path)["verdict"] == "accepted"

    def other_motion(made: Forgery) -> None:
        name = made.name("digests.txt")
        lines = made.members[name].decode().split()
        made.members[name] = "\n".join([*lines[:20], "0" * 64, *lines[21:]]).encode()

    found = _verify(forged(path, tmp_path / "bad.zip", other_motion))
    assert found["verdict"] == "refused"
    assert any("frame 20 of 'rigid', simulated again" in p for p in found["problems"])


def test_an_incomplete_candidate_is_bundled_with_its_diagnostics_and_never_accepted(failed_folder: Path, tmp_path: Path) -> None:
    shutil.copytree(failed_folder, tmp_path / "w")
    path = tmp_path / "open.zip"
    made = bundle_world(tmp_path / "w", out=path)
    assert made["verdict"] == "incomplete"
    assert str(tmp_path) not in made["reason"]
    verdict = json.loads(Forgery(path).members["verdict.json"])
    row = next(r for r in verdict["rows"] if r["id"] == "beat:fall")
    assert row["status"] == "fail"
    assert row["corrections"]
    found = _verify(path)
    assert found["verdict"] == "incomplete"
    assert "beat:fall" in found["bundled_failing"]

    def claim(made: Forgery) -> None:
        made.manifest["verdict"] = "accepted"
        made.edit("verdict.json", lambda v: v.update(verdict="accepted", rows=[{**r, "status": "pass"} for r in v["rows"]]))

    assert _verify(forged(path, tmp_path / "claim.zip", claim))["verdict"] != "accepted"


def test_history_owns_up_to_weakenings(accepted: Any, tmp_path: Path) -> None:
    accepted.edit(("/story/beats/fall/frames", [4, 26]))
    accepted.call("run_checks", world="w", scope="full")
    path = tmp_path / "w.zip"
    bundle_world(accepted.workspace / "w", out=path)
    first, second = json.loads(Forgery(path).members["history.json"])["revisions"]
    assert first["weakenings"] == []
    assert any("frames" in w for w in second["weakenings"])

    def hide(made: Forgery) -> None:
        made.edit("history.json", lambda h: h["revisions"][1].update(weakenings=[]))
        made.edit("verdict.json", lambda v: v.update(weakenings=[]))

    found = _verify(forged(path, tmp_path / "hidden.zip", hide))
    assert found["verdict"] == "refused"
    assert any("revision 2 hides weakenings" in p for p in found["problems"])


# ---------------------------------------------------------------- another machine


@pytest.fixture
def elsewhere(monkeypatch: pytest.MonkeyPatch) -> None:
    """Another class of machines, as far as this program can tell."""
    there = {"worldagent": "9.9", "python": "CPython 3.99.0", "device": "plan9-riscv64"}
    monkeypatch.setattr("worldagent.workflow.verify_bundle.environment", lambda: there)


@pytest.mark.usefixtures("elsewhere")
def test_on_another_machine_the_world_is_made_anew_and_rows_agree_within_tolerance(bundle: Path) -> None:
    found = _verify(bundle)
    assert found["verdict"] == "accepted", found
    assert any("device: linux" in line for line in found["other_environment"])


@pytest.mark.usefixtures("elsewhere")
@pytest.mark.parametrize(("shift", "verdict"), [(1e-9, "accepted"), (0.01, "refused")])
def test_on_another_machine_rounding_passes_and_invention_does_not(
    bundle: Path, tmp_path: Path, shift: float, verdict: str
) -> None:
    found = _verify(forged(bundle, tmp_path / "f.zip", lambda f: _shift_frame(f, 30, shift)))
    assert found["verdict"] == verdict, found["problems"] + found["differences"]


# ---------------------------------------------------------------- what is forged


def _shift_frame(made: Forgery, frame: int, by: float) -> None:
    """Lower the last body of one frame [m] and record the digests of the forged frame."""
    import tempfile

    name = made.name(f"frame_{frame:06d}.npz")
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "a.npz"
        path.write_bytes(made.members[name])
        data = read_container(path)
        data["position"][-1, 2] -= by
        write_container(path, data)
        made.members[name] = path.read_bytes()
    digests = made.name("digests.txt")
    lines = made.members[digests].decode().split()
    lines[frame] = digest_arrays(data)
    made.members[digests] = "\n".join(lines).encode()


def _swap_checkpoints(made: Forgery) -> None:
    a, b = made.name("checkpoints/000012.bin"), made.name("checkpoints/000024.bin")
    made.members[a], made.members[b] = made.members[b], made.members[a]


def _edit_spec(made: Forgery, change: Callable[[Any], None]) -> None:
    """A specification that agrees with itself everywhere: document, candidate, history and digests."""
    from worldagent.worlds.canonical import canonical_json
    from worldagent.worlds.patch import parse_spec

    document = json.loads(made.members["world/world.json"])
    change(document)
    text = canonical_json(parse_spec(document))
    digest = hashlib.sha256(text).hexdigest()
    made.members["world/world.json"] = text
    made.edit(made.name("candidate.json"), lambda c: c.update(spec=document))
    made.edit("history.json", lambda h: h["revisions"][-1].update(spec=document, digest=digest))
    made.edit("verdict.json", lambda v: v.update(spec_digest=digest))
    made.manifest["spec_digest"] = digest


def _easier_beat(document: Any) -> None:
    document["story"]["beats"]["fall"]["predicate"]["min"] = 0.05


def _lighter_ball(document: Any) -> None:
    document["materials"]["steel"]["density"] = 7800


def _versions(made: Forgery) -> None:
    made.edit("verdict.json", lambda v: v["versions"].update(mujoco="3.9.0"))
    made.edit(made.name("candidate.json"), lambda c: c["versions"].update(mujoco="3.9.0"))
    made.manifest["versions"]["mujoco"] = "3.9.0"


def _heavier_ball(made: Forgery) -> None:
    """Built geometry that the specification does not give, with its digest recorded."""
    import tempfile

    from worldagent.worlds.built import BuiltBody, BuiltEntity, load_built, save_built

    (name,) = [n for n in made.members if n.startswith("world/built/ball.")]
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "ball.zip"
        path.write_bytes(made.members[name])
        found = load_built(path)
        (body,) = found.bodies
        other = BuiltEntity(
            found.entity,
            (BuiltBody(body.name, body.pose, body.mass * 3, body.center, body.inertia * 3, body.volume),),
            found.parts,
            found.recipe,
        )
        save_built(other, path)
        made.members[name] = path.read_bytes()
    made.edit(made.name("candidate.json"), lambda c: c["built"]["ball"].__setitem__(1, other.digest()))


FORGERIES: dict[str, Callable[[Forgery], None]] = {
    "a measured value": lambda f: f.row("beat:fall")(lambda r: r.update(measured=0.2)),
    "a bound": lambda f: f.row("beat:fall")(lambda r: r.update(bound=0.1)),
    "a status": lambda f: f.row("beat:fall")(lambda r: r.update(status="not_applicable")),
    "a predicate": lambda f: f.row("beat:fall")(lambda r: r.update(predicate="the block flies away")),
    "a mandatory row made optional": lambda f: f.row("beat:fall")(lambda r: r.update(mandatory=False)),
    "evidence": lambda f: f.row("beat:fall")(lambda r: r["evidence"].update(invented=1)),
    "a row deleted": lambda f: f.edit("verdict.json", lambda v: v["rows"].pop()),
    "all rows deleted": lambda f: f.edit("verdict.json", lambda v: v["rows"].clear()),
    "a row added": lambda f: f.edit("verdict.json", lambda v: v["rows"].append({**v["rows"][0], "id": "beat:miracle"})),
    "a row doubled": lambda f: f.edit("verdict.json", lambda v: v["rows"].append(v["rows"][0])),
    "a row that is none": lambda f: f.edit("verdict.json", lambda v: v["rows"].append(None)),
    "what is said of the prompt": lambda f: f.edit("verdict.json", lambda v: v["prompt"].update(filler=0.0)),
    "a span of the prompt": lambda f: f.edit("verdict.json", lambda v: v["prompt"]["spans"][1].update(text="wooden")),
    "an approximation": lambda f: f.edit("verdict.json", lambda v: v["approximations"].clear()),
    "an event": lambda f: f.edit("events.json", lambda e: e["contacts"][0].update(impulse=9.0)),
    "a forged frame with its digest": lambda f: _shift_frame(f, 18, 1e-3),
    "swapped checkpoints": _swap_checkpoints,
    "an easier beat": lambda f: _edit_spec(f, _easier_beat),
    "a lighter ball": lambda f: _edit_spec(f, _lighter_ball),
    "engine versions": _versions,
    "built geometry": _heavier_ball,
    "the verdict of the manifest": lambda f: f.manifest.update(verdict="incomplete"),
    "the environment of the manifest": lambda f: f.manifest["environment"].update(python="CPython 2.7"),
    "a missing revision": lambda f: f.edit("history.json", lambda h: h["revisions"].clear()),
    "a history of another kind": lambda f: f.members.update({"history.json": b"[1]"}),
    "a verdict of another kind": lambda f: f.members.update({"verdict.json": b"[]"}),
    "endless nesting": lambda f: f.members.update({"verdict.json": b"[" * 200_000}),
    "frames missing": lambda f: f.members.pop(f.name("frame_000030.npz")) and None,
    "a checkpoint missing": lambda f: f.members.pop(f.name("000024.bin")) and None,
    "a further frame": lambda f: f.members.update({f.name("frame_000035.npz").replace("35.npz", "36.npz"): b"x"}),
    "a further mesh": lambda f: f.members.update({"world/assets/extra.obj": b"x"}),
    "another specification": lambda f: f.members.update({"world/world.json": b"{}"}),
}  # fmt: skip


@pytest.mark.parametrize("what", FORGERIES)
def test_no_forged_bundle_verifies(bundle: Path, tmp_path: Path, what: str) -> None:
    """The forger makes the manifest agree with what he changed."""
    found = _verify(forged(bundle, tmp_path / "f.zip", FORGERIES[what]))
    assert found["verdict"] in ("refused", "incomplete")
    assert found["problems"] or found["differences"] or found["failing"]


def test_an_edited_row_is_named_with_both_values(bundle: Path, tmp_path: Path) -> None:
    found = _verify(forged(bundle, tmp_path / "f.zip", FORGERIES["a measured value"]))
    (difference,) = found["differences"]
    assert (difference["row"], difference["differs"], difference["bundled"]) == ("beat:fall", "measured", 0.2)
    assert difference["here"] > 0.25
    assert found["own_verdict"] == "accepted"


def test_a_forged_frame_is_found_by_simulating_it_again(bundle: Path, tmp_path: Path) -> None:
    found = _verify(forged(bundle, tmp_path / "f.zip", FORGERIES["a forged frame with its digest"]))
    assert "delivery:replay" in found["failing"]


def _bytes(made: Forgery) -> None:
    name = made.name("frame_000018.npz")
    data = bytearray(made.members[name])
    data[len(data) // 2] ^= 1
    made.members[name] = bytes(data)


def _link(made: Forgery) -> None:
    info = zipfile.ZipInfo("world/assets/link.obj")
    info.external_attr = (stat.S_IFLNK | 0o777) << 16
    made.extra.append((info, b"/etc/passwd"))


UNSEALED: dict[str, Callable[[Forgery], None]] = {
    "a flipped byte": _bytes,
    "a member left out": lambda f: f.members.pop("events.json") and None,
    "a member added": lambda f: f.extra.append(("world/assets/a.obj", b"x")),
    "a member twice": lambda f: f.extra.append(("verdict.json", f.members["verdict.json"])),
    "a path that climbs": lambda f: f.extra.append(("world/assets/../../../../escaped.obj", b"x")),
    "an absolute path": lambda f: f.extra.append(("/tmp/escaped.obj", b"x")),
    "a path of another system": lambda f: f.extra.append(("world\\assets\\..\\..\\escaped.obj", b"x")),
    "a link": _link,
    "a folder": lambda f: f.extra.append(("world/assets/", b"")),
    "code": lambda f: f.extra.append(("world/sitecustomize.py", b"raise SystemExit(0)")),
    "another format": lambda f: f.manifest.update(format="zip"),
    "a later version": lambda f: f.manifest.update(format_version=2),
    "no members": lambda f: f.manifest.pop("members"),
    "members of another kind": lambda f: f.manifest.update(members=[1]),
}


@pytest.mark.parametrize("what", UNSEALED)
@pytest.mark.filterwarnings("ignore:Duplicate name")
def test_a_bundle_unlike_its_manifest_is_refused_before_anything_is_unpacked(
    bundle: Path, tmp_path: Path, what: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("worldagent.worlds.bundle.Bundle.extract", lambda *_: pytest.fail("unpacked"))
    found = _verify(forged(bundle, tmp_path / "f.zip", UNSEALED[what], sealed=False))
    assert found["verdict"] == "refused"
    assert len(found["problems"]) == 1
    assert not list(tmp_path.parent.rglob("escaped*"))


@pytest.mark.filterwarnings("ignore:Duplicate name")
def test_bombs_are_refused_by_their_declared_size(bundle: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(CAPS, "bundle_bytes", Cap("bundle_bytes", 10_000_000, "bytes", "-"))
    bomb = forged(bundle, tmp_path / "f.zip", lambda f: f.extra.append(("world/assets/b.obj", bytes(20_000_000))), sealed=False)
    assert bomb.stat().st_size < 1_000_000
    assert "bundle_bytes" in _verify(bomb)["problems"][0]
    monkeypatch.setitem(CAPS, "bundle_members", Cap("bundle_members", 10, "members", "-"))
    assert "bundle_members" in _verify(bundle)["problems"][0]


def test_a_bomb_inside_a_frame_is_refused(bundle: Path, tmp_path: Path) -> None:
    def bomb(made: Forgery) -> None:
        raw, stream = io.BytesIO(), io.BytesIO()
        np.lib.format.write_array(raw, np.zeros(1_000_000))
        with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
            archive.writestr("position.npy", raw.getvalue())
        made.members[made.name("frame_000003.npz")] = stream.getvalue()

    found = _verify(forged(bundle, tmp_path / "f.zip", bomb))
    assert found["verdict"] != "accepted"
    assert "compressed" in json.dumps(found["problems"])


# ---------------------------------------------------------------- the command


def test_exit_codes_tell_accepted_from_not_and_from_misuse(
    bundle: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["verify", str(bundle), "--seed", "5", "--intervals", "all"]) == 0
    assert json.loads(capsys.readouterr().out)["seed"] == 5
    bad = forged(bundle, tmp_path / "f.zip", FORGERIES["a status"])
    assert main(["verify", str(bad)]) == 1
    (tmp_path / "text.zip").write_text("no zip")
    for absent in (tmp_path / "absent", tmp_path / "text.zip", tmp_path):
        assert main(["verify", str(absent)]) == 2
        assert "bundle" in capsys.readouterr().err


def test_a_folder_whose_geometry_was_replaced_is_not_accepted(copy: Path) -> None:
    """The digests agree with each other: only building it again tells."""
    (record,) = copy.glob("candidates/*/candidate.json")
    data = json.loads(record.read_text())
    data["built"]["b1"][0] = data["built"]["b2"][0]
    data["built"]["b1"][1] = data["built"]["b2"][1]
    record.write_text(json.dumps(data))
    found = verify_folder(copy, replay=False)
    assert found["verdict"] == "incomplete"
    assert any("'b1'" in p for p in found["problems"])


def test_a_ledger_that_tells_otherwise_is_reported_and_decides_nothing(copy: Path) -> None:
    import sqlite3

    with sqlite3.connect(copy / "ledger.sqlite") as db:
        (text,) = db.execute("SELECT record FROM acceptances").fetchone()
        record = json.loads(text)
        record["rows"][0]["predicate"] = "otherwise"
        db.execute("UPDATE acceptances SET record=?", (json.dumps(record),))
        db.execute("DELETE FROM meta WHERE key LIKE 'seal:acceptance:%'")
    db.close()
    found = verify_folder(copy, replay=False)
    assert found["verdict"] == "accepted"
    assert [d["differs"] for d in found["differences"]] == ["predicate"]
