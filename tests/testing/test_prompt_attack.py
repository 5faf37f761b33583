"""A scripted attacker that binds every span of a stranger's prompt to the best that passes: what the audit sees of it, and what it does not."""

from __future__ import annotations

import pytest
from worldagent.bench.prompt_attack import attack_figures, attacked, own_world, stolen
from worldagent.testing.prompts import strangers
from worldagent.worlds.audits.audit import audit
from worldagent.worlds.claims import prompt_record


def test_the_shipped_example_passes_with_its_own_prompt_and_with_no_strangers() -> None:
    spec = own_world()
    assert audit(spec).passed
    assert [p.id for p in strangers() if audit(stolen(spec, p.text)).passed] == []
    assert len(strangers()) >= 500


@pytest.mark.parametrize(
    "prompt", ["A ball never touches the wall.", "Seven cups fall on the floor.", "The ball rolls, then the cup doesn't fall."]
)
def test_the_attacker_is_stopped_where_a_number_or_negation_is_left(prompt: str) -> None:
    report = audit(attacked(own_world(), prompt))
    (row,) = [r for r in report.rows if r.status != "pass"]
    assert row.id == "audit:claims"


def test_the_attacker_passes_elsewhere_and_the_verdict_says_how_many_are_the_same() -> None:
    spec = attacked(
        own_world(), "An old farmer leads his cow and goat with a dog, a horse, a sheep and a cat across the bridge to the fair."
    )
    assert audit(spec).passed
    assert any("are said to be the same as another" in w for w in prompt_record(spec)["warnings"])


def test_figures_count_what_passed_and_why_the_rest_did_not() -> None:
    found = attack_figures(strangers()[:20])
    assert found["unchanged_passed"] == 0
    assert found["attacker_passed"] + sum(found["attacker_refused_by"].values()) == 20
    assert found["attacker_passed_with_warnings"] <= found["attacker_passed"]
