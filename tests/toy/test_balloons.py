"""Adding a category of matter takes one folder per floor and one line per registry: balloons are added to a copy of the tree, and run there."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from worldagent.tests.toy.registries import LINES, NEW, add_balloons

ROOT = Path(__file__).resolve().parents[2]
COPIED = (
    *("physics", "worlds", "execution", "geometry", "construction", "simulation", "verifiers", "rendering", "workflow", "tools"),
    *("server", "testing", "skills", "tests/toy", "tests/stories", "tests/simulation", "tests/rendering/categories"),
    *("tests/worlds/categories", "tests/verifiers/categories", "tests/physics"),
)
FILES = ("__init__.py", "pyproject.toml", "tests/conftest.py", "tests/collected.py")
REGISTRY_TESTS = (
    "tests/worlds/categories/test_registry.py",
    "tests/simulation/test_engines.py",
    "tests/rendering/categories/test_layers.py",
    "tests/verifiers/categories/test_judges.py",
)
"""Tests that run over every category: in the copy, over the balloons."""
ASKED = "balloons or unions or every_engine or every_category_that"
"""Words in the names of the tests that run: those of balloons, and those that compare whole registries."""


def git(tree: Path, *arguments: str) -> str:
    named = ["-c", "user.name=test", "-c", "user.email=test@localhost", "-c", "core.autocrlf=false", "-c", "gc.auto=0"]
    done = subprocess.run(["git", *named, *arguments], cwd=tree, capture_output=True, text=True, check=True)
    return done.stdout


@pytest.fixture(scope="module")
def tree(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the package with balloons in it, its state before as the one commit of a repository."""
    root = tmp_path_factory.mktemp("tree") / "worldagent"
    root.mkdir()
    for folder in COPIED:
        shutil.copytree(ROOT / folder, root / folder, ignore=shutil.ignore_patterns("__pycache__"))
    for file in FILES:
        (root / file).parent.mkdir(exist_ok=True)
        shutil.copy2(ROOT / file, root / file)
    git(root, "init", "--quiet")
    git(root, "add", "--all")
    git(root, "commit", "--quiet", "--message", "as it is")
    add_balloons(root)
    git(root, "add", "--all")
    return root


def test_only_new_folders_and_lines_of_registries_are_touched(tree: Path) -> None:
    changed = {}
    for line in git(tree, "diff", "--cached", "--numstat").splitlines():
        added, removed, path = line.split("\t")
        assert removed == "0", path
        if not path.startswith(NEW):
            changed[path] = int(added)
    assert changed == {file: len(lines) for file, lines in LINES.items()}
    imports = {file: sum("import" in line for _, line in lines) for file, lines in LINES.items()}
    entries = {file: added - imports[file] for file, added in changed.items() if file != "pyproject.toml"}
    assert set(entries.values()) == {1}


def test_the_example_of_the_guide_is_this_one(tree: Path) -> None:
    told = (ROOT / "CONTRIBUTING.md").read_text()
    stat = git(tree, "diff", "--cached", "--stat=100")
    assert re.sub(r" +", " ", stat.strip()) in re.sub(r" +", " ", told), f"print this in CONTRIBUTING.md:\n{stat}"


@pytest.mark.slow
def test_balloons_are_specified_baked_judged_and_drawn(tree: Path) -> None:
    """Every test over a registry, for balloons, and the whole loop of a client; in a process of its own, which imports the copy."""
    environment = {**os.environ, "PYTHONPATH": str(tree.parent), "PYTHONSAFEPATH": "1", "PYTHONDONTWRITEBYTECODE": "1"}
    command = [
        sys.executable,
        "-m",
        "pytest",
        "-q",
        "-p",
        "no:cacheprovider",
        "--rootdir",
        str(tree),
        "-k",
        "balloons or aerostat",
    ]
    done = subprocess.run(
        [*command, "tests/toy/loop_with_balloons.py", *REGISTRY_TESTS],
        cwd=tree,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout[-6000:] + done.stderr[-2000:]
    passed = re.search(r"(\d+) passed", done.stdout)
    assert passed is not None
    assert int(passed[1]) >= 29
    assert "skipped" not in done.stdout
