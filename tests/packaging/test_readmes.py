"""The tables of READMEs name every module of their folder, and no other."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


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


@pytest.mark.parametrize("name", ["bench", "testing", "tools", "workflow"])
def test_the_table_of_a_readme_names_every_module_of_its_folder(name: str) -> None:
    folder = ROOT / name
    there = {p for p in folder.rglob("*.py") if p.name != "__init__.py"}
    assert sorted(p.name for p in there - named(folder)) == []
    assert len((folder / "README.md").read_text().splitlines()) <= 40
