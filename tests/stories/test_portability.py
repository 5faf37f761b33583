"""A world folder is whole: copied anywhere it gives the same verdict, is not written to, and can be made anew (R126, R158)."""

from __future__ import annotations

import hashlib
import json
import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest


def _tree(folder: Path) -> str:
    state = hashlib.sha256()
    for path in sorted(folder.rglob("*")):
        state.update(path.relative_to(folder).as_posix().encode())
        if path.is_file():
            state.update(str(path.stat().st_mtime_ns).encode())
            state.update(path.read_bytes())
    return state.hexdigest()


def _worldagent(*arguments: str, where: Path, **environment: str) -> tuple[int, Any]:
    command = [sys.executable, "-P", "-m", "worldagent.server", *arguments]
    variables = {**os.environ, **environment}
    done = subprocess.run(command, capture_output=True, text=True, cwd=where, env=variables, check=False, timeout=120)
    return done.returncode, json.loads(done.stdout) if done.stdout.strip() else done.stderr


@pytest.mark.slow
def test_a_copied_folder_is_verified_with_equal_digests_and_not_written_to(copy: Path, loop: Any, tmp_path: Path) -> None:
    away = copy.rename(tmp_path / "elsewhere and renamed")
    before = _tree(away)
    code, verdict = _worldagent("verify", str(away), "--replay", where=tmp_path)
    assert code == 0, verdict
    assert verdict["verdict"] == "accepted"
    assert verdict["replayed"]
    assert verdict["failing"] == []
    assert _tree(away) == before
    kept = json.loads(loop.answers["accept"].content[0].text)
    assert verdict["freeze"].startswith(kept["freeze"])
    assert verdict["approximations"] == kept["approximations"]
    assert verdict["cache_digest"].startswith(json.loads(loop.answers["bake"].content[0].text)["cache_digest"])


@pytest.mark.slow
def test_a_bundle_is_verified_by_the_command_alone(loop: Any, tmp_path: Path) -> None:
    (bundle,) = (loop.workspace / "w" / "acceptance").glob("*.zip")
    away = Path(shutil.copy(bundle, tmp_path / "proof.zip"))
    code, verdict = _worldagent(
        "verify", str(away), "--intervals", "all", "--report", str(tmp_path / "page.html"), where=tmp_path
    )
    assert code == 0, verdict
    assert verdict["verdict"] == "accepted"
    assert verdict["differences"] == verdict["problems"] == []
    assert [r["identical"] for r in verdict["replayed"]] == [True] * 4
    assert (tmp_path / "page.html").read_text().startswith("<!DOCTYPE html>")
    assert sorted(p.name for p in tmp_path.iterdir()) == ["page.html", "proof.zip"]


@pytest.mark.slow
def test_a_bundle_is_verified_where_pictures_are_made_by_another_variant(loop: Any, tmp_path: Path) -> None:
    (bundle,) = (loop.workspace / "w" / "acceptance").glob("*.zip")
    code, verdict = _worldagent("verify", str(bundle), where=tmp_path, WORLDAGENT_MITSUBA_VARIANT="scalar_rgb")
    assert (code, verdict["problems"]) == (0, []), verdict
    assert verdict["verdict"] == "accepted"


def _values(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """Status and measured value of every row but the replay's, whose intervals are random."""
    return {r["id"]: (r["status"], r["measured"]) for r in rows if r["id"] != "delivery:replay"}


@pytest.mark.slow
def test_a_folder_without_caches_is_recomputed_to_the_same_verdicts(copy: Path, tmp_path: Path) -> None:
    from worldagent.worlds.ledger import Ledger

    def verdicts(folder: Path) -> dict[str, Any]:
        rows = Ledger(folder / "ledger.sqlite").acceptance()
        assert rows is not None
        return _values(rows["record"]["rows"])

    (recorded,) = (copy / "candidates").glob("*/bake/rigid/digests.txt")
    digests, place = recorded.read_text(), recorded.relative_to(copy)
    shutil.rmtree(copy / "candidates")
    shutil.rmtree(copy / "built")
    code, verdict = _worldagent("recompute", str(copy), where=tmp_path)
    assert code == 0, verdict
    assert verdict["verdict"] == "accepted"
    assert (copy / place).read_text() == digests
    from worldagent.verifiers.acceptance import judge

    assert _values(judge(copy)["rows"]) == verdicts(copy)


@pytest.mark.parametrize("what", ["frame", "spec", "nothing baked"])
def test_a_tampered_copy_is_refused_with_a_code(copy: Path, tmp_path: Path, what: str) -> None:
    if what == "frame":
        (frame,) = copy.glob("candidates/*/bake/rigid/frame_000010.npz")
        frame.write_bytes(frame.with_name("frame_000011.npz").read_bytes())
    elif what == "spec":
        path = copy / "world.json"
        path.write_text(path.read_text().replace('"friction": 0.3', '"friction": 0.2', 1))
    else:
        for bake in copy.glob("candidates/*/bake"):
            shutil.rmtree(bake)
    before = _tree(copy)
    code, verdict = _worldagent("verify", str(copy), where=tmp_path)
    assert code != 0
    if what == "frame":
        assert (code, verdict["verdict"]) == (1, "incomplete")
        assert {"delivery:digests:rigid"} <= {r["id"] for r in verdict["failing"]}
    else:
        assert code == 2
        assert "no candidate holds" in verdict or "bake" in verdict
    assert _tree(copy) == before
