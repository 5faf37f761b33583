"""No test passes without having asserted anything (`asserting.py` says what counts)."""

from __future__ import annotations

from pathlib import Path

import pytest
from worldagent.tests.asserting import unsure_tests

ROOT = Path(__file__).resolve().parents[1]
EXCUSED: dict[str, str] = {}
"""`path::name` of a test that may pass without asserting, and why it may."""
UNSURE = {
    "nothing asserted": "run()",
    "within a loop over what may be empty": "for row in rows(): assert row",
    "within a loop over an empty list": "for row in []: assert row",
    "within a loop over an empty range": "for k in range(0): assert k",
    "within a loop over a filtered list": "for row in [r for r in LITERAL if r]: assert row",
    "within an if": "if found(): assert found() == 1",
    "within one of two branches": "if found():\n    assert found() == 1\nelse:\n    found()",
    "after an early return": "if found():\n    return\nassert found() == 1",
    "after an early continue": "for k in LITERAL:\n    if found(k):\n        continue\n    assert k",
    "after a return within a loop": "for k in rows():\n    if k:\n        return\nassert rows()",
    "within a suppressed error": "with contextlib.suppress(ValueError):\n    run()\n    assert found()",
    "after an error that is caught": "try:\n    run()\n    assert found()\nexcept ValueError:\n    pass",
    "or True": "assert found() or True",
    "a tuple": "assert (found() == 1, 'one is found')",
    "a constant": "assert True",
    "a thing equal to itself": "a = found()\nassert a == a",
    "all of what may be empty": "assert all(r > 0 for r in rows())",
    "a subset that may be empty": "assert {r.status for r in rows()} <= {'pass'}",
    "by a helper that may not assert": "may(rows())",
    "within a function that nobody calls": "def inner():\n    assert found()\nrun()",
}
SURE = {
    "plainly": "assert found() == 1",
    "raised": "with pytest.raises(ValueError):\n    run()",
    "within a loop over a literal": "for k in (1, 2): assert k",
    "within a loop over a constant": "for name, value in LITERAL.items(): assert value",
    "within a loop over a range": "for k in range(3): assert found(k)",
    "in both branches": "if found():\n    assert found() == 1\nelse:\n    assert run()",
    "before an early return": "if found():\n    assert found() == 1\n    return\nassert run()",
    "or skipped": "if found():\n    pytest.skip('nothing to see')\nassert run()",
    "in the branch without an error and in the other": "try:\n    run()\nexcept ValueError as error:\n    assert str(error)\nelse:\n    assert found()",
    "by a helper": "must(1)",
    "by a helper within an argument": "run(must)",
    "all of a literal": "assert all(found(k) for k in (1, 2))",
    "some of what may be empty": "assert any(r > 0 for r in rows())",
    "failed where it must not come": "for k in LITERAL:\n    if found(k):\n        pytest.fail('found')",
    "the same call twice": "assert found() == found()",
    "by numpy": "np.testing.assert_allclose(found(), 1.0)",
    "within a function that is handed on": "def inner():\n    assert found()\nrun(inner)",
}
HEAD = """
import contextlib
import numpy as np
import pytest
from worldagent.tests.helper import must
LITERAL = {"a": 1, "b": 2}
def may(rows):
    for r in rows:
        assert r
"""


def found(tmp_path: Path, body: str) -> list[str]:
    tests = tmp_path / "tests"
    tests.mkdir()
    (tests / "helper.py").write_text("def must(n):\n    again(n)\ndef again(n):\n    assert n > 0\n")
    lines = "\n".join(f"    {line}" for line in body.splitlines())
    (tests / "test_one.py").write_text(f"{HEAD}def test_it():\n{lines}\n")
    return unsure_tests(tmp_path)


@pytest.mark.parametrize("name", UNSURE)
def test_a_test_that_can_pass_without_asserting_is_found(tmp_path: Path, name: str) -> None:
    assert found(tmp_path, UNSURE[name]) == ["tests/test_one.py::test_it"]


@pytest.mark.parametrize("name", SURE)
def test_a_test_that_asserts_whatever_the_data_is_not(tmp_path: Path, name: str) -> None:
    assert found(tmp_path, SURE[name]) == []


def test_every_test_asserts_whatever_the_data() -> None:
    assert len(list((ROOT / "tests").rglob("test_*.py"))) > 200, "the tests were not found"
    assert sorted(set(unsure_tests(ROOT)) ^ set(EXCUSED)) == [], (
        "assert that what is looped over is there, or that the branch was taken"
    )
