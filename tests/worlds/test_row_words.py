"""Words that name a row of the table of materials: what is said to be gold weighs as gold, or says why not (R131, R154)."""

from __future__ import annotations

from typing import Any

import pytest
from worldagent.testing.dishonest.cases import without_marks
from worldagent.tests.stories.small_run import small_spec
from worldagent.verifiers.register.scene import _materials
from worldagent.worlds.audits.audit import audit
from worldagent.worlds.audits.claims import claim_problems
from worldagent.worlds.claim_marks import claim_operations
from worldagent.worlds.claims import reading_of
from worldagent.worlds.patch import apply_patch, parse_spec
from worldagent.worlds.prompts.marks import parse_marks
from worldagent.worlds.spec import WorldSpec


def made(marked: str, name: str = "stuff", **material: Any) -> WorldSpec:
    """A world whose ball is of one material, of substance other where it says none."""
    spec = small_spec()
    spec["materials"][name] = {"substance": "other", **material}
    spec["entities"]["ball"]["material"] = name
    for part in spec["entities"]["ball"]["parts"].values():
        part.pop("material", None)
    prompt = without_marks(marked)
    assert parse_marks(marked, prompt)
    plain = parse_spec({**spec, "claims": {}, "spec_version": "2", "prompt": prompt})
    return apply_patch(plain, claim_operations(marked, plain))


def refused(spec: WorldSpec) -> str:
    return " | ".join(p.text for p in claim_problems(spec) if "asks for" in p.text)


def warned(spec: WorldSpec) -> str:
    return " | ".join(w for w in reading_of(spec).warnings if "name of a material" in w)


def of(word: str) -> str:
    return f"The [{word}](property ball) [ball](thing ball) rolls along the shelf."


@pytest.mark.parametrize(
    ("marked", "honest", "dishonest"),
    [
        (of("gold"), 19300, 500),
        (of("lead"), 11340, 500),
        (of("cork"), 180, 9000),
        (of("copper"), 8940, 100),
        ("Die [Kugel](thing ball) aus [Blei](property ball) rollt über das Regal.", 11340, 500),
        ("La [bille](thing ball) de [cuivre](property ball) roule sur le sol.", 8940, 100),
        ("La [bola](thing ball) de [plomo](property ball) rueda por el estante.", 11340, 500),
    ],
)
def test_what_is_called_by_a_row_has_its_density(marked: str, honest: float, dishonest: float) -> None:
    assert refused(made(marked, density=honest)) == ""
    assert "with a density of" in refused(made(marked, density=dishonest))


def test_the_noun_beside_the_word_counts_whatever_the_claim_names() -> None:
    marked = "The [gold](property floor) [ball](thing ball) rolls along the shelf."
    assert "'stuff' has 500" in refused(made(marked, density=500))


def test_a_reason_is_taken_and_printed() -> None:
    hollow = made(of("gold"), density=500, departs="hollow, a thin shell of gold")
    assert refused(hollow) == ""
    assert "hollow, a thin shell of gold" in " ".join(what for what, _ in _materials(hollow))
    assert list(_materials(made(of("gold"), density=19300))) == []


def test_friction_and_bounce_far_from_the_row_are_refused_and_near_it_are_not() -> None:
    assert "with a friction of" in refused(made(of("copper"), density=8940, friction=0.0))
    assert refused(made(of("copper"), density=8940, friction=0.3)) == ""
    assert "with a restitution of" in refused(
        made(of("granite"), density=2600, substance="stone", friction=0.65, restitution=1.0)
    )
    assert refused(made(of("granite"), density=2600, substance="stone", friction=0.65, restitution=0.0)) == ""


def test_a_word_that_is_a_colour_too_warns_of_another_substance_and_one_that_is_none_is_refused() -> None:
    golden = made(of("gold"), density=600, substance="wood")
    assert refused(golden) == ""
    assert "'gold' is the name of a material" in warned(golden)
    assert warned(made(of("gold"), density=19300)) == ""
    assert "'cork' asks for cork" in refused(made(of("cork"), density=180, substance="wood"))


@pytest.mark.parametrize(("name", "density", "passes"), [("lead", 11340, True), ("lead", 500, False), ("cork", 9000, False)])
def test_a_material_that_is_called_by_a_row_has_its_density(name: str, density: float, passes: bool) -> None:
    spec = made("The [ball](thing ball) rolls along the shelf.", name, density=density)
    found = [p for r in audit(spec).rows if r.id == "audit:masses" for p in (r.evidence or {}).get("problems", ())]
    assert (found == []) == passes


def test_a_material_that_is_called_by_a_row_has_its_friction() -> None:
    slick = made("The [ball](thing ball) rolls along the shelf.", "copper", density=8940, friction=0.0)
    found = [p for r in audit(slick).rows if r.id == "audit:masses" for p in (r.evidence or {}).get("problems", ())]
    assert "has a friction of 0" in "".join(found)
