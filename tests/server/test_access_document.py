"""SECURITY.md promises what tests show: every test it names exists, and every line names one."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
TEXT = (ROOT / "SECURITY.md").read_text()
NAMED = sorted(set(re.findall(r"`(tests/[\w/]+\.py)::(\w+)`", TEXT)))
ACTORS = re.findall(r"^\| ([A-Z]): ", TEXT, re.MULTILINE)


def lines_of(heading: str) -> list[list[str]]:
    """Cells of the table below a heading."""
    section = TEXT.split(f"## {heading}\n")[1].split("\n## ")[0]
    rows = [line for line in section.splitlines() if line.startswith(("| ", "|-"))]
    return [[cell.strip() for cell in line.strip("|").split(" | ")] for line in rows[2:]]


@pytest.mark.parametrize(("file", "test"), NAMED)
def test_a_named_test_exists(file: str, test: str) -> None:
    assert re.search(rf"^(async )?def {test}\(", (ROOT / file).read_text(), re.MULTILINE)


def test_every_line_names_an_actor_a_defence_and_a_test() -> None:
    defended = lines_of("What is defended")
    assert len(defended) >= 25
    for against, attack, defence, tests in defended:
        assert set(against.split(", ")) <= set(ACTORS), against
        assert attack
        assert defence
        assert re.findall(r"tests/[\w/]+\.py::\w+", tests), attack
    assert {actor for line in defended for actor in line[0].split(", ")} == set(ACTORS), "nobody is named without a defence"


def test_no_other_name_looks_like_a_test() -> None:
    assert len(re.findall(r"tests/", TEXT)) == len(re.findall(r"`tests/[\w/]+\.py::\w+`", TEXT))


def test_the_two_threat_models_know_of_each_other() -> None:
    assert "docs/threat-model.md" in TEXT
    assert "SECURITY.md" in (ROOT / "docs" / "threat-model.md").read_text()


def test_numbers_in_the_text_are_those_of_the_code() -> None:
    from worldagent.server.connections import MOST_CONNECTIONS
    from worldagent.server.guard import ATTEMPT_SECONDS, ATTEMPTS

    assert f"503 above {MOST_CONNECTIONS}" in TEXT
    assert ATTEMPTS == 10
    assert f"one per {ATTEMPT_SECONDS:g} s" in TEXT
