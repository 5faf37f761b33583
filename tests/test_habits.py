"""Modules, functions and parameter lists stay below their ceilings, docstrings name a thing, and modules import in one direction.

`habits.json` lists what does not yet, with a reason. The list may only get shorter: an entry that is no longer needed fails.
"""

from __future__ import annotations

import ast
import json
import tomllib

import pytest
from worldagent.tests import habits

ALLOWED: dict[str, dict[str, str]] = json.loads((habits.ROOT / "tests" / "habits.json").read_text())
"""By measure: what is over its ceiling -> why."""
UNCHECKED = 49
"""Test modules in which `make types-tests` passes over wrong types of arguments; lower it with every one that is mended."""


def found(kind: str) -> list[str]:
    if kind == "docstrings":
        return habits.riddles()
    if kind == "cycles":
        return [" ".join(group) for group in habits.cycles()]
    return habits.over_ceiling().get(kind, [])


@pytest.mark.parametrize("kind", ["module", "function", "parameters", "docstrings", "cycles"])
def test_nothing_is_over_its_ceiling_but_what_is_listed_with_a_reason(kind: str) -> None:
    over, listed = set(found(kind)), set(ALLOWED[kind])
    assert not over - listed, f"cut these better ({kind}), rather than listing them in tests/habits.json"
    assert not listed - over, f"take these out of tests/habits.json: they are within the ceiling ({kind})"


def test_every_module_can_be_the_first_that_is_imported() -> None:
    """A module that runs the `__init__` of a package, which imports it, is half made there."""
    assert habits.cycles(loaded=True) == []


def test_every_exception_has_a_reason() -> None:
    assert set(ALLOWED) == {"module", "function", "parameters", "docstrings", "cycles"}
    short = [name for names in ALLOWED.values() for name, reason in names.items() if len(reason) < 12]
    assert short == []


def test_the_measures_see_what_is_too_long() -> None:
    """A method with nine parameters of its own and 61 lines, and one with eight and 60."""
    body = "\n".join("        a = 1" for _ in range(60))
    for count, lines in ((9, body), (8, body.rpartition("\n")[0])):
        names = ", ".join(f"p{k}" for k in range(count))
        (made,) = habits.functions(ast.parse(f"class C:\n    def f(self, {names}):\n{lines}\n"))
        assert habits.parameter_count(made) == count
        assert (made.end_lineno or 0) - made.lineno + 1 == (61 if count == 9 else 60)


def test_the_measures_see_docstrings_of_modules_classes_functions_and_attributes() -> None:
    tree = ast.parse(
        '"""What a."""\nclass C:\n    """b"""\n    x: int\n    """Of c."""\n    def f(self):\n        """d"""\n        self.y = 1\n        """e"""\n'
    )
    assert sorted(habits.docstrings(tree)) == [("", "What a."), ("C", "b"), ("f", "d"), ("self.y", "e"), ("x", "Of c.")]
    folders = {path.partition("/")[0] for path in habits.modules(habits.WRITTEN)}
    assert folders == set(habits.WRITTEN)


def test_the_test_modules_without_checked_arguments_are_real_and_get_fewer() -> None:
    mypy = tomllib.loads((habits.ROOT / "pyproject.toml").read_text())["tool"]["mypy"]
    (listed,) = [section["module"] for section in mypy["overrides"] if "arg-type" in section.get("disable_error_code", ())]
    gone = [name for name in listed if not (habits.ROOT.joinpath(*name.split(".")[1:]).with_suffix(".py")).exists()]
    assert gone == []
    assert len(listed) == UNCHECKED
    assert not [section for section in mypy["overrides"] if section.get("ignore_errors")]
