"""The tables of READMEs name every module of the product, and no file that is gone."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
BESIDE = {"docs", "skills", "tests"}
"""Top folders that are no packages of the product."""
LINES = 40
"""A README is read in a hurry; the method of an engine stands in a `method.md` beside it."""


def _packages() -> list[str]:
    """Folders of the product with modules, new ones that are not yet tracked included."""
    command = ["git", "ls-files", "--cached", "--others", "--exclude-standard", "*.py"]
    names = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout.split()
    places = {Path(name).parent for name in names if not name.endswith("__init__.py") and (ROOT / name).exists()}
    return sorted(place.as_posix() for place in places if place.parts[0] not in BESIDE)


PACKAGES = _packages()
READMES = sorted(
    place.as_posix()
    for place in {p for name in PACKAGES for p in (Path(name), Path(name).parent)} - {Path()}
    if (ROOT / place / "README.md").exists()
)


def named(folder: Path) -> set[Path]:
    """Modules that the table of a folder's README names; names after the first of a cell lie beside it, and `<...>` stands for any."""
    found: set[Path] = set()
    for row in re.findall(r"^\| (`[^|]*) \|", (folder / "README.md").read_text(), re.MULTILINE):
        beside = ""
        for name in re.findall(r"`([^`]+)`", row):
            place = name if "/" in name else f"{beside}{name}"
            beside = f"{place.rpartition('/')[0]}/" if "/" in place else ""
            paths = set(folder.glob(re.sub(r"<\w+>", "[!_]*", place)))
            assert paths, f"{folder.name}/README.md names {name}, which is not there"
            found |= {p for p in paths if p.suffix == ".py"}
    return found


def unnamed(folder: Path, root: Path = ROOT) -> list[str]:
    """Modules of a folder that neither its own table names nor that of the folder above."""
    tables = [f for f in (folder, folder.parent) if f != root and (f / "README.md").exists()]
    there = {p for p in folder.glob("*.py") if p.name != "__init__.py"}
    return sorted(p.name for p in there.difference(*(named(f) for f in tables)))


def test_the_packages_of_the_product_are_found() -> None:
    assert {"server", "simulation/liquid/flip", "verifiers/categories/gas", "packaging/mcpb"} <= set(PACKAGES)
    assert len(PACKAGES) > 70


@pytest.mark.parametrize("name", PACKAGES)
def test_every_module_stands_in_the_table_of_its_package_or_of_the_one_above(name: str) -> None:
    assert unnamed(ROOT / name) == []


@pytest.mark.parametrize("name", READMES)
def test_the_readme_of_a_package_is_short_and_names_nothing_that_is_gone(name: str) -> None:
    assert named(ROOT / name)
    lines = (ROOT / name / "README.md").read_text().splitlines()
    assert lines[0].startswith("# ")
    assert len(lines) <= LINES


def test_a_module_that_no_table_names_is_found_and_so_is_a_name_without_a_file(tmp_path: Path) -> None:
    inner = tmp_path / "waves" / "deep"
    inner.mkdir(parents=True)
    for name in ("crests.py", "foam.py", "troughs.py", "__init__.py"):
        (inner / name).touch()
    readme = inner.parent / "README.md"
    readme.write_text("# waves\n\n| file | what it holds |\n|---|---|\n| `deep/crests.py`, `foam.py` | both |\n")
    assert unnamed(inner, tmp_path) == ["troughs.py"]
    (inner / "README.md").write_text("# deep\n\n| file | what it holds |\n|---|---|\n| `troughs.py` | low water |\n")
    assert unnamed(inner, tmp_path) == []
    (inner / "foam.py").unlink()
    with pytest.raises(AssertionError, match=r"names foam\.py, which is not there"):
        named(inner.parent)
