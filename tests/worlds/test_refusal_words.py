"""Words of refusals: what was given, and what to give instead."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from worldagent.tests.stories.small_run import PROMPT, small_spec
from worldagent.workflow import gates
from worldagent.workflow.gates import _edited_since
from worldagent.workflow.measurements import _span
from worldagent.workflow.parts import _coming, _of_another
from worldagent.worlds.documents import text_of
from worldagent.worlds.errors import InputError, RefusedError, SpecError
from worldagent.worlds.folder import WorldFolder
from worldagent.worlds.patch import apply_patch, parse_spec
from worldagent.worlds.spec import WorldSpec


def changed(pointer: str, value: Any) -> WorldSpec:
    base = parse_spec({**small_spec(), "prompt": PROMPT})
    return apply_patch(base, [{"op": "add", "path": pointer, "value": value}])


@pytest.mark.parametrize("file", ["../../../etc/x.obj", "/etc/x.obj", "a/../../x.obj", "../x.npy"])
def test_a_file_outside_of_assets_is_refused_before_anything_is_built(file: str) -> None:
    kind = {"kind": "heightfield", "size": [1, 1], "digest": "0" * 64} if file.endswith("npy") else {"kind": "mesh"}
    with pytest.raises(SpecError) as refused:
        changed("/entities/b1/parts/body/shape", {**kind, "file": file})
    assert f"path {file!r} leads out of 'assets'; give a relative path inside it" in str(refused.value)


def test_a_file_inside_of_assets_is_none_of_the_validation() -> None:
    shape = (
        changed("/entities/b1/parts/body/shape", {"kind": "mesh", "file": "a/../b..c/x.obj"}).entities["b1"].parts["body"].shape
    )
    assert shape.kind == "mesh"


def test_null_is_told_as_what_clients_write_for_nan() -> None:
    with pytest.raises(SpecError, match="got null, as which JSON gives NaN and infinity, too"):
        changed("/materials/wood/density", None)


def test_of_many_worlds_a_refusal_says_how_many_more_there_are(tmp_path: Path) -> None:
    for k in range(23):
        (tmp_path / f"w{k:02}").mkdir()
        (tmp_path / f"w{k:02}" / "world.json").write_text("{}")
    with pytest.raises(InputError, match=r"'w19'\] and 3 more \(inspect_world\(part='worlds'\) lists all\)"):
        WorldFolder.of(tmp_path, "x")


def test_frames_that_run_backwards_are_told_so() -> None:
    candidate: Any = SimpleNamespace(last_frame=35, stage="full")
    assert _span(candidate, (3, 30)) == (3, 30)
    with pytest.raises(InputError, match=r"frames \[30, 3\] run backwards; give the first frame before the last: \[3, 30\]"):
        _span(candidate, (30, 3))


def test_a_verdict_about_another_specification_is_told_in_whole_sentences() -> None:
    spec = changed("/title", "Another")
    text = text_of(spec).decode()
    session: Any = SimpleNamespace(spec=spec, ledger=SimpleNamespace(revision_spec=lambda _: (text, "")))
    assert _edited_since(session, {"revision": 1}) == (
        ", but its record is about another specification than this ledger has under that number"
    )
    session.spec = changed("/title", "A third")
    assert _edited_since(session, {"revision": 1}) == ", and there changed since /title"
    assert "filed under revision 1, at which the world is, but its record is about another specification" in _of_another(1, 1)
    assert _of_another(1, 2).startswith("this verdict is about revision 1, and the world is at revision 2 now")


@pytest.mark.parametrize(
    ("frozen", "gate", "following"),
    [
        ("done", None, "bake_sim"),
        ("done", RefusedError("rows are open"), "probe_sim"),
        ("done", InputError("a file is missing"), "probe_sim"),
        ("stale", None, "probe_sim"),
    ],
    ids=["it opens", "rows were deleted", "a file changed", "the motion was edited"],
)
def test_the_step_after_a_probe_is_a_bake_only_where_its_gate_opens(
    monkeypatch: pytest.MonkeyPatch, frozen: str, gate: Exception | None, following: str
) -> None:
    def require(*_: Any) -> dict[str, Any]:
        if gate is not None:
            raise gate
        return {}

    step = SimpleNamespace(step=lambda _: SimpleNamespace(state=frozen))
    monkeypatch.setattr("worldagent.workflow.standing.standing", lambda *_: step)
    monkeypatch.setattr(gates, "require_probe", require)
    ledger = SimpleNamespace(stages=lambda: {"beat:fall": "probe", "scale:b1": "static"})
    session: Any = SimpleNamespace(folder=SimpleNamespace(id="w"), ledger=ledger, freeze=lambda: "f")
    assert _coming(session) == f"{following}(world='w')"
