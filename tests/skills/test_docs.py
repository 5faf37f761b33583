"""Documents do not go stale: the tools page, paths in the coverage table, numbers of choices, sizes of folder READMEs."""

from __future__ import annotations

import importlib.util
import re
from pathlib import Path
from types import ModuleType
from typing import get_args

import pytest
from worldagent.worlds.predicates.models import Atom, Combinator

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
NUMBERS = [f"R{i}" for i in range(1, 159)] + [f"S{i}" for i in range(1, 20)]
FOLDERS = (
    "bench", "construction", "construction/terrain", "docs", "examples", "execution", "geometry", "rendering", "server", "simulation",
    "simulation/cloth", "simulation/elastic", "simulation/fracture", "simulation/liquid", "simulation/liquid/flip",
    "simulation/particles", "simulation/rigid", "server/page", "packaging", "physics", "skills", "tests", "tools", "verifiers", "worlds",
)  # fmt: skip
README_LINES = 40
LINK = re.compile(r"\]\((?!\w+:)([^)#]+)")
"""A link of a page to a file, from the page's folder."""
PATH = re.compile(r"`([\w\-./]+/[\w\-./]*|[\w\-]+\.(?:md|toml))(?:::(\w+))?`")


def _generator(name: str) -> ModuleType:
    spec = importlib.util.spec_from_file_location(f"generate_{name}", DOCS / f"generate_{name}.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize("name", ["tools", "rows", "choices"])
def test_a_generated_page_is_fresh(name: str) -> None:
    assert (DOCS / f"{name}.md").read_text() == _generator(name).page(), f"run: python docs/generate_{name}.py"


def test_a_bound_without_unit_or_reason_is_refused(tmp_path: Path) -> None:
    read = _generator("choices").bounds_of
    module = tmp_path / "bounds.py"
    module.write_text('"""Bounds."""\n\nGAP = 0.003\n"""[m] Own choice: two skins."""\n')
    assert list(read(module)) == [("GAP", "0.003", "m", "Own choice: two skins.")]
    for wrong in ('GAP = 0.003\n"""Own choice."""', 'GAP = 0.003\n"""[m]"""', "GAP = 0.003", 'import os\n"""[m] Why."""'):
        module.write_text(f'"""Bounds."""\n\n{wrong}\n')
        with pytest.raises(ValueError, match=r"bounds\.py:3"):
            list(read(module))


def test_every_requirement_stands_in_the_coverage_table_once() -> None:
    found = re.findall(r"^\| ([RS]\d+) \|", (DOCS / "coverage.md").read_text(), re.MULTILINE)
    assert found == NUMBERS


def test_every_path_and_test_of_the_coverage_table_exists() -> None:
    missing = []
    for path, function in PATH.findall((DOCS / "coverage.md").read_text()):
        if not (ROOT / path).exists():
            missing.append(path)
        elif function and not re.search(rf"^(?:async )?def {function}\(", (ROOT / path).read_text(), re.MULTILINE):
            missing.append(f"{path}::{function}")
    assert missing == []


def test_every_silent_point_has_a_choice() -> None:
    assert re.findall(r"^## (S\d+)", (DOCS / "choices.md").read_text(), re.MULTILINE) == NUMBERS[158:]


@pytest.mark.parametrize("name", ["README.md", "CONTRIBUTING.md", "SECURITY.md", "docs/choices.md", "docs/threat-model.md"])
def test_paths_in_documents_exist(name: str) -> None:
    text = (ROOT / name).read_text()
    named = [path for path, _ in PATH.findall(text)]
    linked = [str((ROOT / name).parent.relative_to(ROOT) / path) for path in LINK.findall(text)]
    assert named or linked
    for path in (*named, *linked):
        assert (ROOT / path).exists() or path.startswith(("demo-out/", "dist/", "candidates/")), (name, path)


def test_the_grammar_of_choices_has_as_many_atoms_and_combinators_as_the_models() -> None:
    kinds = [len(get_args(get_args(union)[0]) or get_args(union)) for union in (Atom, Combinator)]
    (stated,) = re.findall(r"(\d+) atoms and (\d+) combinators", (DOCS / "choices.md").read_text())
    assert [int(n) for n in stated] == kinds


@pytest.mark.parametrize("folder", FOLDERS)
def test_every_folder_says_what_lives_in_it(folder: str) -> None:
    lines = (ROOT / folder / "README.md").read_text().splitlines()
    assert lines[0].startswith("# ")
    assert len(lines) <= README_LINES


def test_the_licence_is_whole() -> None:
    text = (ROOT / "LICENSE").read_text()
    assert "Apache License" in text[:300]
    assert text.rstrip().endswith("limitations under the License.")
