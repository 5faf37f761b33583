"""Modules outside the folders of a category know no category of matter: they ask the registries, so that a new one is one line there.

`category_names.json` lists those that do not yet, with a reason. The list may only get shorter: an entry that is no longer needed fails.
"""

from __future__ import annotations

import ast
import json
from collections.abc import Iterator
from itertools import pairwise
from pathlib import PurePosixPath
from typing import Any

import pytest
from worldagent.tests import habits
from worldagent.worlds.categories.registry import CATEGORIES

LISTED: dict[str, dict[str, dict[str, str]]] = json.loads((habits.ROOT / "tests" / "category_names.json").read_text())
"""By measure, by module: which categories it knows, and why."""
FOLDERS = {"categories", *CATEGORIES}
"""Names of the folders of the registries and of what belongs to one category: `verifiers/categories/`, `simulation/rigid/`."""
FLOORS = ("categories", "construction", "simulation")
"""Folders in which categories have one of their own."""
OWN = ("construction/soft/",)
"""Folders that belong to one category under another name."""


def strings(tree: ast.Module) -> Iterator[str]:
    """Categories that stand in a module as a string."""
    return (str(n.value) for n in ast.walk(tree) if isinstance(n, ast.Constant) and n.value in CATEGORIES)


def imports(tree: ast.Module) -> Iterator[str]:
    """Categories from whose folders a module imports."""
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom):
            places = [[*(node.module or "").split("."), alias.name] for alias in node.names]
        elif isinstance(node, ast.Import):
            places = [alias.name.split(".") for alias in node.names]
        else:
            continue
        for place in places:
            # A relative import may begin with the folder itself: `from .rigid.solver import ...`.
            start = "simulation" if getattr(node, "level", 0) else ""
            yield from (name for above, name in pairwise([start, *place]) if name in CATEGORIES and above in FLOORS)


MEASURES: dict[str, Any] = {"strings": strings, "imports": imports}


def known(measure: str) -> dict[str, str]:
    """Categories that modules outside the folders of categories know, by module."""
    found = {}
    for path, tree in habits.modules().items():
        if FOLDERS & set(PurePosixPath(path).parent.parts) or path.startswith(OWN):
            continue
        names = sorted(set(MEASURES[measure](tree)))
        if names:
            found[path] = " ".join(names)
    return found


@pytest.mark.parametrize("measure", MEASURES)
def test_modules_outside_the_folders_of_categories_know_none_but_what_is_listed_with_a_reason(measure: str) -> None:
    found, listed = known(measure), {path: entry["categories"] for path, entry in LISTED[measure].items()}
    more = {path: names for path, names in found.items() if set(names.split()) - set(listed.get(path, "").split())}
    assert not more, f"ask a registry ({measure}), rather than listing them in tests/category_names.json"
    gone = {path: names for path, names in listed.items() if set(names.split()) - set(found.get(path, "").split())}
    assert not gone, f"take these out of tests/category_names.json: the modules know them no more ({measure})"


def test_every_exception_has_a_reason() -> None:
    assert set(LISTED) == set(MEASURES)
    assert [path for listed in LISTED.values() for path, entry in listed.items() if len(entry["reason"]) < 12] == []


@pytest.mark.parametrize(
    ("code", "measure", "names"),
    [
        ("a = b == 'cloth'", "strings", ["cloth"]),
        ('"""Cloth."""\na = "cloth_of"', "strings", []),
        ("from ..categories.liquid.frames import liquid_of", "imports", ["liquid"]),
        ("from ..categories.cloth import flutter", "imports", ["cloth"]),
        ("from ..categories import rigid", "imports", ["rigid"]),
        ("from .rigid.solver import SolverRigid", "imports", ["rigid"]),
        ("import worldagent.simulation.rigid.solver", "imports", ["rigid"]),
        ("from ..worlds.categories.registry import CATEGORIES", "imports", []),
        ("from .testing import cloth", "imports", []),
    ],
)
def test_the_measures_see_strings_and_imports(code: str, measure: str, names: list[str]) -> None:
    assert list(MEASURES[measure](ast.parse(code))) == names
