"""Tricks on honest worlds: each differs from its honest world, and is given away by the row or line that its case names."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import pytest
from worldagent.bench.dishonest import dishonest_figures, wilson
from worldagent.testing.dishonest import MECHANISMS, Case, Twin
from worldagent.testing.dishonest.agent import Agent, Walk
from worldagent.testing.dishonest.cases import GONE, changed, without_marks
from worldagent.testing.dishonest.judging import given_away, groups
from worldagent.worlds.errors import InputError

CASES = [(mechanism, case) for mechanism, cases in MECHANISMS.items() for case in cases]
TWINS = {case.twin.name: case.twin for _, case in CASES}
AT_CREATION = (
    "no claims, in Chinese",
    "nunca",
    "seven",
    "after",
    "everything but the things",
    "two things, one body",
    "falls, by a level shift",
    "ein Amboss aus Stahl ist aus Holz",
    "five for three",
    "inches",
    "without never",
    "a crate of a milligram",
)
"""Tricks that the audit gives away when the world is created."""


def audited(workspace: Path, case: Case | Twin) -> Walk:
    """Outcome of the creation of a world."""
    workspace.mkdir()
    agent = Agent(workspace)
    given = case.given() if isinstance(case, Case) else (case.prompt, case.marked, case.document())
    prompt, marked, document = given
    answer = agent.call("edit_spec", prompt=prompt, spec=document, **({} if marked is None else {"claims": marked}))
    return Walk("audited" if answer["audit"]["passed"] else "edit_spec", agent.open_rows())


def test_there_are_a_hundred_and_fifty_tricks_in_thirty_mechanisms() -> None:
    assert len(CASES) >= 150
    assert len(MECHANISMS) >= 30
    assert min(map(len, MECHANISMS.values())) >= 3
    assert [n for n, k in Counter(case.id for _, case in CASES).items() if k > 1] == []


@pytest.mark.parametrize(("mechanism", "case"), CASES, ids=lambda v: v.id if isinstance(v, Case) else str(v))
def test_a_trick_names_what_gives_it_away_and_differs_from_its_honest_world(mechanism: str, case: Case) -> None:
    assert case.row or case.says, mechanism
    twin = case.twin
    assert case.act is not None or case.given() != (twin.prompt, twin.marked, twin.document())


def test_a_row_counts_where_the_pattern_and_the_words_are_met_and_a_line_where_the_twin_lacks_it() -> None:
    twin = TWINS["push"]
    open_rows = (("beat:fall", "it went 3 mm down"),)
    walk = Walk("probe_sim", open_rows, ("waived: gently", "gravity"))
    honest = Walk("accepted", (), ("gravity",))
    assert given_away(Case("a", twin, "beat:*|audit:*", "3 mm"), walk, honest) == "beat:fall: it went 3 mm down"
    assert given_away(Case("b", twin, "beat:roll"), walk, honest) == ""
    assert given_away(Case("c", twin, "beat:*", "4 mm"), walk, honest) == ""
    assert given_away(Case("d", twin, says="waived"), walk, honest) == "waived: gently"
    assert given_away(Case("e", twin, says="gravity"), walk, honest) == ""


def test_marks_and_changes_are_read_as_they_are_written() -> None:
    assert without_marks("A [ball](thing ball) [rolls off](event /story/beats/b).") == "A ball rolls off."
    before = {"a": {"b": [1, 2]}, "c": 3}
    assert changed(before, {"/a/b/1": 5, "/c": GONE, "/d/e": 6}) == {"a": {"b": [1, 5]}, "d": {"e": 6}}
    assert before == {"a": {"b": [1, 2]}, "c": 3}


@pytest.mark.parametrize("name", sorted(TWINS))
def test_an_honest_world_passes_the_audit(name: str, tmp_path: Path) -> None:
    assert audited(tmp_path / "w", TWINS[name]).rows == ()


@pytest.mark.parametrize("name", AT_CREATION)
def test_a_trick_is_given_away_at_creation(name: str, tmp_path: Path) -> None:
    case = next(case for _, case in CASES if case.id == name)
    assert given_away(case, audited(tmp_path / "w", case), Walk("accepted")), name


def test_an_interval_is_that_of_wilson_and_an_unknown_mechanism_is_refused() -> None:
    assert wilson(8, 10) == pytest.approx((0.4902, 0.9433), abs=1e-4)
    assert wilson(0, 0) == (0.0, 1.0)
    with pytest.raises(InputError, match="there is no mechanism 'witchcraft'"):
        dishonest_figures(["witchcraft"])


def test_where_no_scene_is_judged_nothing_is_counted() -> None:
    found = dishonest_figures(scenes=())
    assert (found["dishonest"], found["accepted_unmarked"], found["holes"]) == (0, 0, [])


@pytest.mark.slow
@pytest.mark.parametrize("scene", sorted(groups(MECHANISMS)))
def test_every_trick_of_a_scene_is_given_away_and_its_honest_worlds_are_accepted(scene: str) -> None:
    assert dishonest_figures(scenes=[scene])["holes"] == []
