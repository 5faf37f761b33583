"""Bodies of compound predicates: who does what, and causes asked for each."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.testing.defects._causal_untold import UNTOLD
from worldagent.testing.defects.judge import judge_one
from worldagent.testing.worlds.small_worlds import IDENTITY, ball, box, ground, make_candidate, world
from worldagent.verifiers.story.bodies import acting_atoms, deeds_of, moved_bodies, spoken_bodies, standing_atoms
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.predicates import (
    And,
    Contact,
    Count,
    Displacement,
    Eventually,
    Not,
    Or,
    RestsOn,
    Speed,
    StaysIn,
    Topples,
)
from worldagent.worlds.spec import Beat

FRAMES = 25
FAR = {name: Displacement(entity=name, min=0.3) for name in ("one", "two", "three")}


def candidate_of(folder: Path) -> Candidate:
    """Blocks `one` and `two` slide off, `three` stays."""
    entities = {"floor": ground(), **{n: box(0.2, 0.2, 0.2, motion="dynamic", at=(0, k, 0.1)) for k, n in enumerate(FAR)}}
    entities["hand"] = ball(0.1, motion="kinematic", at=(0, 5, 0.1))
    way = np.arange(FRAMES) / 24
    tracks: dict[str, Any] = {
        n: (np.stack([way, 0 * way + k, 0 * way + 0.1], axis=1), IDENTITY) for k, n in enumerate(("one", "two"))
    }
    return make_candidate(folder, world(entities, frames=FRAMES), tracks=tracks)


def beat(predicate: Any) -> Beat:
    return Beat(text="it happens", owner="rigid", subject="one", frames=(1, FRAMES - 1), predicate=predicate)


@pytest.mark.parametrize(
    ("predicate", "found"),
    [
        (FAR["one"], []),
        (Contact(a="one", b="two"), []),
        (Not(predicate=And(of=[FAR["one"], FAR["two"]])), []),
        (And(of=[FAR["one"], Speed(entity="one", min=0.1)]), [(1, ["one"])]),
        (And(of=[FAR["one"], FAR["two"]]), [(1, ["one"]), (1, ["two"])]),
        (Eventually(predicate=And(of=[FAR["one"], FAR["two"]])), [(1, ["one"]), (1, ["two"])]),
        (And(of=[FAR["one"], RestsOn(entity="three", on="floor"), Displacement(entity="two", max=9)]), [(1, ["one"])]),
        (Or(of=[FAR["one"], FAR["three"]]), [(1, ["one"])]),
        (Or(of=[FAR["one"], FAR["two"]]), [(1, ["one", "two"])]),
        (Count(entities=list(FAR), predicate=Displacement(entity="each", min=0.3), min=1), [(1, ["one", "two"])]),
        (Count(entities=list(FAR), predicate=Displacement(entity="each", min=0.3), min=2), [(1, ["one"]), (1, ["two"])]),
        (Count(entities=list(FAR), predicate=Displacement(entity="each", min=0.3), max=2), []),
        (And(of=[FAR["one"], Displacement(entity="hand", min=0.0)]), [(1, ["one"])]),
    ],
    ids=str,
)  # fmt: skip
def test_deeds_are_those_of_the_bodies_that_a_predicate_needs(
    tmp_path: Path, predicate: Any, found: list[tuple[int, list[str]]]
) -> None:
    assert [(d.least, list(d.atoms)) for d in deeds_of(candidate_of(tmp_path), beat(predicate))] == found


def test_a_deed_lacks_bodies_only_where_too_few_are_brought_about(tmp_path: Path) -> None:
    any_one = Count(entities=["one", "two"], predicate=Displacement(entity="each", min=0.3), min=1)
    (deeds,) = deeds_of(candidate_of(tmp_path), beat(any_one))
    assert deeds.lacking(lambda body, _: body == "two") == ()
    assert deeds.lacking(lambda *_: False) == ("one", "two")


def test_who_is_moved_and_who_is_spoken_of(tmp_path: Path) -> None:
    spec = candidate_of(tmp_path).spec
    asked = beat(And(of=[Topples(entity="two"), StaysIn(entity="three", region="home"), Contact(a="one", b="hand")]))
    assert moved_bodies(spec, asked) == ("one", "two")
    assert spoken_bodies(spec, asked) == ("one", "two", "three")
    assert [getattr(a, "kind", "") for a in acting_atoms(asked.predicate)] == ["topples", "contact"]


def test_where_a_body_stands_is_of_its_own_atoms_that_an_and_joins(tmp_path: Path) -> None:
    rests = RestsOn(entity="one", on="floor")
    joined = And(
        of=[
            FAR["one"],
            And(of=[rests, RestsOn(entity="two", on="floor")]),
            Or(of=[StaysIn(entity="one", region="home"), FAR["two"]]),
        ]
    )
    assert list(standing_atoms(joined, "one")) == [rests]
    assert list(standing_atoms(FAR["one"], "one")) == []


@pytest.mark.parametrize("name", ["one-of-two", "one-comes-anyway", "passed-on", "each-its-own"])
def test_every_body_of_a_compound_effect_needs_a_cause(name: str) -> None:
    (mechanism,) = (m for m in UNTOLD if m.name == name)
    judged = judge_one("causal", mechanism, mechanism.low, 1)
    row = next(r for r in judged.rows if r.status == "fail") if mechanism.broken else judged.rows[0]
    assert (judged.detected, judged.alarm) == (mechanism.broken, False), [r.evidence["explanation"] for r in judged.rows]
    assert row.first_failing_entity == ("d" if mechanism.broken else None)
    assert any("d in the causes of slides" in c.action for c in row.corrections) == mechanism.broken
