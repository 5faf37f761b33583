"""Two states of skill and tool texts, and what moved between them."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from worldagent.bench.evaluation.commands import run_task
from worldagent.bench.evaluation.serving import ENV_SERVER
from worldagent.bench.evaluation.skill_states import HERE, compare_states, differing_texts, server_of_tree, this_server, tree_of
from worldagent.server.cli import main as command_line
from worldagent.tests.bench.evaluation.conftest import FAKE
from worldagent.worlds.errors import InputError, RefusedError

pytestmark = pytest.mark.filterwarnings(
    "ignore::pytest.PytestUnraisableExceptionWarning", "ignore::ResourceWarning", "ignore::DeprecationWarning"
)
PROMPTS = ("study", "seesaw")


def states(before: str, after: str) -> dict[str, str]:
    return {name: os.pathsep.join([sys.executable, str(FAKE), mode]) for name, mode in (("before", before), ("after", after))}


def test_a_state_that_refuses_more_is_told_from_one_that_does_not(tmp_path: Path, documents: Callable[..., Path]) -> None:
    folder = documents(**{name: [{}] for name in PROMPTS})
    seen = []

    def run(name: str) -> Any:
        seen.append((name, os.environ[ENV_SERVER].rpartition(os.pathsep)[2]))
        return run_task("small", "scripted", root=tmp_path / name, agent_args={"folder": str(folder)}, sample_id=list(PROMPTS))

    found = compare_states(states("", "strict"), run)
    assert seen == [("before", ""), ("after", "strict")]
    assert ENV_SERVER not in os.environ
    assert found["moved"] == ["refused_calls"]
    refused = found["figures"]["refused_calls"]
    assert (refused["first"], refused["second"], refused["low"], refused["high"], refused["prompts"]) == (0.0, 1.0, 1.0, 1.0, 2)
    assert found["says"][0].startswith("accepted: no movement seen: 0.000 -> 0.000")
    assert found["says"][2].startswith("refused calls: worse: 0.0 -> 1.0")
    assert found["states"]["after"]["outcomes"]["refused"] == 2


def test_a_state_whose_server_falls_over_gives_no_comparison(tmp_path: Path, documents: Callable[..., Path]) -> None:
    folder = documents(study=[{"do": "crash_once", "marker": str(tmp_path / "mark")}])

    def run(name: str) -> Any:
        return run_task(
            "small", "scripted", root=tmp_path / name, agent_args={"folder": str(folder)}, sample_id=["study"], retry_on_error=0
        )

    with pytest.raises(RefusedError, match=r"nothing can be compared.*study: died"):
        compare_states(states("", ""), run)


def test_files_that_differ_are_told_by_whether_an_agent_reads_them(tmp_path: Path) -> None:
    trees = [tmp_path / name for name in ("a", "b")]
    for k, tree in enumerate(trees):
        for name, text in (
            ("skills/x/SKILL.md", f"{k}"),
            ("tools/edit.py", "same"),
            ("simulation/step.py", f"{k}"),
            ("tests/t.py", f"{k}"),
        ):
            (tree / name).parent.mkdir(parents=True)
            (tree / name).write_text(text)
    (trees[1] / "tools" / "new.py").write_text("")
    assert differing_texts(*trees) == {"texts": ["skills/x/SKILL.md", "tools/new.py"], "else": ["simulation/step.py"]}


def test_the_server_of_another_tree_runs_that_trees_modules(tmp_path: Path) -> None:
    package = tmp_path / ".types"
    package.mkdir()
    (package / "worldagent").symlink_to("..")
    (tmp_path / "server").mkdir()
    (tmp_path / "__init__.py").write_text("")
    (tmp_path / "server" / "__init__.py").write_text("")
    (tmp_path / "server" / "__main__.py").write_text("import sys\nprint(__file__, *sys.argv[1:])\n")
    with tree_of(str(tmp_path)) as tree:
        words = [w.format(workspace="/w") for w in server_of_tree(tree).split(os.pathsep)]
    done = subprocess.run(words, capture_output=True, text=True, check=True)
    assert done.stdout.split() == [str(package / "worldagent" / "server" / "__main__.py"), "serve", "--workspace", "/w"]
    assert this_server() in server_of_tree(tree)


@pytest.mark.skipif(not (HERE / ".git").exists(), reason="this tree is no clone")
def test_a_revision_is_unpacked_for_as_long_as_it_is_needed() -> None:
    with tree_of("HEAD") as tree:
        assert (tree / ".types" / "worldagent" / "server" / "app.py").is_file()
    assert not tree.exists()


@pytest.mark.parametrize(
    ("against", "text"), [("no-such-revision", "neither a folder nor a revision"), ("/", "is no tree of worldagent")]
)
def test_what_is_no_state_is_refused(against: str, text: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(InputError, match=text), tree_of(against):
        pass
    assert command_line(["eval", "skills", "--agent", "scripted", "--against", against]) == 2
    assert text in capsys.readouterr().err
