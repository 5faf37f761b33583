"""Documents do not go stale: the tools page, paths in the coverage table, numbers of choices, sizes of folder READMEs."""

from __future__ import annotations

import importlib.util
import re
import subprocess
from pathlib import Path
from types import ModuleType
from typing import get_args

import pytest
from worldagent.worlds.predicates.models import Atom, Combinator

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
NUMBERS = [f"R{i}" for i in range(1, 159)] + [f"S{i}" for i in range(1, 20)]
FOLDERS = ("docs", "skills", "tests")
"""Folders beside the packages, whose READMEs `tests/packaging/test_readmes.py` reads."""
README_LINES = 40
LINK = re.compile(r"\]\((?!\w+:)([^)#]+)")
"""A link of a page to a file, from the page's folder."""
CITED = re.compile(r"`([\w\-.]+(?:/[\w\-.]+)*/?)(?:::(\w+))?`")
"""A file or folder, perhaps with a function or class in it."""
FILES = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=True).stdout.split()
OURS = tuple(sorted({name.partition("/")[0] + "/" for name in FILES if "/" in name}))
PAGES = [
    name for name in FILES if name.endswith(".md") and name != "CHANGELOG.md" and not name.startswith(("docs/trials/", "skills/"))
]
"""Pages for people; a change log tells of files that are gone, and `tests/skills/test_skills.py` reads the skills."""


def _generator(name: str) -> ModuleType:
    spec = importlib.util.spec_from_file_location(f"generate_{name}", DOCS / f"generate_{name}.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize("name", ["assets", "tools", "rows", "choices"])
def test_a_generated_page_is_fresh(name: str) -> None:
    assert (DOCS / f"{name}.md").read_text() == _generator(name).page(), f"run: python docs/generate_{name}.py"


def test_the_page_of_events_of_the_skill_is_fresh() -> None:
    page = ROOT / "skills" / "world-building" / "reference" / "events.md"
    assert page.read_text() == _generator("events").page(), "run: python docs/generate_events.py"


def test_what_skills_show_of_the_table_of_materials_is_current() -> None:
    files = _generator("materials").files()
    assert len(files) == 4
    for path, text in files.items():
        assert path.read_text() == text, f"{path.name}; run: python docs/generate_materials.py"


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


def test_every_silent_point_has_a_choice() -> None:
    assert re.findall(r"^## (S\d+)", (DOCS / "choices.md").read_text(), re.MULTILINE) == NUMBERS[158:]


def _absent(page: Path) -> list[str]:
    """Files, folders, links, and functions or classes after `::` that a page cites and that are not there.

    Paths count from the root, from the page's folder or from one above it; a bare name may lie anywhere below that folder. Names
    without an ending are no paths of ours (`tools/list` is a method of the protocol), nor are files of worlds (`world.json`).
    """
    text, missing = page.read_text(), []
    places = [ROOT, *(p for p in page.parents if ROOT in (p, *p.parents))]
    for cited, name in CITED.findall(text):
        last = cited.rpartition("/")[2]
        if not (last.endswith((".py", ".md")) or name or (cited.startswith(OURS) and ("." in last or not last))):
            continue
        found = next((place / cited for place in places if (place / cited).exists()), None)
        if found is None and "/" not in cited:
            found = next(page.parent.rglob(cited), None)
        if found is None:
            missing.append(cited)
        elif name and not re.search(rf"^ *(?:async def|def|class) {name}\b", found.read_text(), re.MULTILINE):
            missing.append(f"{cited}::{name}")
    # With a blank it is a mark of a prompt, as `[ball](thing ball)`.
    return missing + [link for link in LINK.findall(text) if " " not in link and not (page.parent / link).exists()]


@pytest.mark.parametrize("page", PAGES)
def test_what_a_page_cites_exists(page: str) -> None:
    assert _absent(ROOT / page) == []


def test_a_page_that_cites_what_is_not_there_is_found(tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    page.write_text(
        "`worlds/cache.py::read_container` `worlds/cache.py::gone` `worlds/gone.py` `geometry/` `physics/gone/` `tools/list` "
        "`candidates/` [here](page.md) [there](gone.md)"
    )
    assert _absent(page) == ["worlds/cache.py::gone", "worlds/gone.py", "physics/gone/", "gone.md"]


def test_no_module_cites_a_document_that_is_not_here() -> None:
    known = {Path(name).name for name in FILES if name.endswith(".md")}
    modules = [name for name in FILES if name.endswith(".py") and not name.startswith("tests/")]
    assert len(modules) > 500
    cited = {(name, found) for name in modules for found in re.findall(r"[\w-]+\.md\b", (ROOT / name).read_text())}
    assert sorted(c for c in cited if c[1] not in known) == []


def test_the_grammar_of_choices_has_as_many_atoms_and_combinators_as_the_models() -> None:
    kinds = [
        sum(len(get_args(model.model_fields["kind"].annotation)) for model in get_args(union)) for union in (Atom, Combinator)
    ]
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
