"""Rows of claims on worlds that the engine ran: what a span says is judged in the motion and the pictures, and rivals of it are refused."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

import pytest
from worldagent.testing.defects._films import film_of
from worldagent.testing.worlds.event_worlds import event_world
from worldagent.verifiers.claims.check import check
from worldagent.verifiers.stored import open_in_probe
from worldagent.worlds.claim_marks import claim_operations
from worldagent.worlds.patch import apply_patch, parse_spec
from worldagent.worlds.requirements import Row

PROMPT = "A box hits another box, which then slides but never rolls."
MARKED = (
    "A [box](thing hitter) [hits](event hit) another [box](thing box), which [then](order hit slide) [slides](event slide) "
    "but [never rolls](negation rolls)."
)
BEATS: dict[str, Any] = {
    "hit": {"text": "it hits", "owner": "rigid", "subject": "hitter", "frames": [0, 30], "predicate": {"kind": "hits", "entity": "hitter", "other": "box"}},
    "slide": {"text": "it slides", "owner": "rigid", "subject": "box", "frames": [0, 35], "predicate": {"kind": "slides", "entity": "box", "other": "floor"}},
}  # fmt: skip
ROLLS = {"text": "it rolls", "predicate": {"kind": "rolls", "entity": "box"}, "never": True}
SHOT = {"frames": [0, 35], "keys": {"k": {"frame": 0, "position": [0.5, -4, 2], "target": [0.5, 0, 0]}}}


def rows(folder: Path, *operations: tuple[str, Any], marked: str = MARKED) -> dict[str, Row]:
    document = event_world("hit").model_dump(mode="json")
    document |= {"prompt": PROMPT, "story": {"beats": BEATS, "requirements": {"rolls": ROLLS}}, "shots": {"only": SHOT}}
    spec = apply_patch(parse_spec(document), [{"op": "replace", "path": p, "value": v} for p, v in operations])
    spec = apply_patch(spec, claim_operations(marked, spec))
    found = check(film_of(spec).candidate(folder))
    assert {r.check for r in found} == {"claim"}
    return {r.subject[0]: r for r in found if r.subject}


def test_a_motion_that_is_what_the_words_say_passes_every_row(tmp_path: Path) -> None:
    found = rows(tmp_path)
    assert {n: r.status for n, r in found.items()} == dict.fromkeys(
        ("box", "hits", "box_2", "then", "slides", "never_rolls"), "pass"
    )
    assert any("roles swapped" in text for text in found["hits"].evidence["rivals"])
    assert found["then"].measured is not None
    assert found["then"].measured >= 1 / 24


@pytest.mark.parametrize(
    ("operation", "claim", "said"),
    [
        # roles: the box that is hit is told to hit the other
        (("/story/beats/hit/predicate", {"kind": "hits", "entity": "box", "other": "hitter"}), "hits", "does not come true"),
        # it is told to fall, and slides
        (("/story/beats/slide/predicate", {"kind": "falls", "entity": "box"}), "slides", "does not come true"),
        # what must never happen happens
        (("/story/requirements/rolls/predicate", {"kind": "slides", "entity": "box", "other": "floor"}), "never_rolls", "but "),
        # nobody looks at it
        (("/shots/only/keys/k/target", [0.5, -8, 2]), "box", "fills at most"),
    ],
)  # fmt: skip
def test_a_motion_or_picture_that_is_not_what_the_words_say_fails_the_row(
    operation: tuple[str, Any], claim: str, said: str, tmp_path: Path
) -> None:
    row = rows(tmp_path, operation)[claim]
    assert (row.status, said in row.evidence["explanation"]) == ("fail", True), row.evidence
    assert row.corrections


def test_an_order_told_the_other_way_round_fails(tmp_path: Path) -> None:
    row = rows(tmp_path, marked=MARKED.replace("(order hit slide)", "(order slide hit)"))["then"]
    assert row.status == "fail"
    assert row.measured is not None
    assert row.measured <= 0


def test_an_event_of_which_the_swapped_roles_are_as_true_is_void(tmp_path: Path) -> None:
    both = {"kind": "or", "of": [BEATS["hit"]["predicate"], {"kind": "hits", "entity": "box", "other": "hitter"}]}
    row = rows(tmp_path, ("/story/beats/hit/predicate", both))["hits"]
    assert row.status == "fail"
    assert any("roles swapped" in text for text in row.evidence["true_rivals"])
    assert "ask `contact`, which has no roles" in row.corrections[0].action


def test_a_probe_that_ends_before_what_is_denied_for_ever_waits_for_the_bake(tmp_path: Path) -> None:
    document = event_world("hit").model_dump(mode="json")
    document |= {"prompt": PROMPT, "story": {"beats": BEATS, "requirements": {"rolls": ROLLS}}, "shots": {"only": SHOT}}
    spec = parse_spec(document)
    spec = apply_patch(spec, claim_operations(MARKED, spec))
    seen = film_of(spec).candidate(tmp_path)
    longer = spec.model_copy(update={"simulation": spec.simulation.model_copy(update={"frames": spec.simulation.frames + 20})})
    probe = dataclasses.replace(seen, spec=longer, stage="probe")
    found = {r.subject[0]: r for r in check(probe) if r.subject}
    assert found["never_rolls"].status == "unverified"
    assert [r.id for r in open_in_probe(found.values(), probe.last_frame)] == []
