"""Every duty of a claim: a prompt marked in one wrong way fails the row of the claims, with pointer and hint (R2, R131, R155)."""

from __future__ import annotations

from typing import Any

import pytest
from worldagent.testing.prompts import Marked, honest
from worldagent.testing.prompts.told import untaken
from worldagent.tests.stories.small_run import MARKED, PROMPT, small_spec
from worldagent.tests.stories.version_1 import old_spec
from worldagent.worlds.audits.audit import audit
from worldagent.worlds.audits.claims import claim_problems
from worldagent.worlds.canonical import canonical_json
from worldagent.worlds.claim_marks import claim_operations, claims_from, marked_claims
from worldagent.worlds.claims import LONGEST, prompt_record, reading_of
from worldagent.worlds.errors import InputError, SpecError
from worldagent.worlds.patch import apply_patch, parse_spec, weakenings
from worldagent.worlds.slices import geometry_slice, motion_slice
from worldagent.worlds.spec import WorldSpec
from worldagent.worlds.verdicts import verdict_words

FALLS = {"kind": "falls", "entity": "b3"}


def world(marked: str = MARKED, *operations: tuple[str, Any], prompt: str = PROMPT) -> WorldSpec:
    spec = parse_spec({**small_spec(claims={}), "prompt": prompt})
    spec = apply_patch(spec, [{"op": "add", "path": p, "value": v} for p, v in operations])
    return apply_patch(spec, claim_operations(marked, spec))


def problems(spec: WorldSpec) -> dict[str, str]:
    return {p.pointer: p.text for p in claim_problems(spec)}


def test_a_world_whose_words_are_claimed_passes_the_audit() -> None:
    spec = world()
    assert problems(spec) == {}
    assert [r.id for r in audit(spec).rows if r.status != "pass"] == []
    assert not {"audit:clauses"} & {r.id for r in audit(spec).rows}


def swapped(old: str, new: str) -> str:
    assert old in MARKED
    return MARKED.replace(old, new)


WRONG: dict[str, tuple[WorldSpec, str, str]] = {
    "a displacement told as an event": (
        world(MARKED, ("/story/beats/fall/predicate", {"kind": "displacement", "entity": "b3", "axis": [0, 0, 1], "max": -0.15})),
        "/claims/falls_off/by", "displacement, which is no kind of event"),
    "an event that need not happen": (
        world(MARKED, ("/story/beats/fall/predicate", {"kind": "or", "of": [FALLS, {"kind": "displacement", "entity": "b3", "axis": [0, 0, 1], "max": -0.15}]})),
        "/claims/falls_off/by", "asks or, which is no kind of event"),
    "an event that none need have": (
        world(MARKED, ("/story/beats/fall/predicate", {"kind": "count", "entities": ["b2", "b3"], "predicate": {**FALLS, "entity": "each"}, "max": 1})),
        "/claims/falls_off/by", "asks count, which is no kind of event"),
    "an optional beat": (world(MARKED, ("/story/beats/fall/mandatory", False)), "/claims/falls_off/by", "fall is optional"),
    "a beat that nobody sees": (world(MARKED, ("/story/beats/fall/observe", False)), "/claims/falls_off/by", "fall need not be seen"),
    "an event judged by a thing": (world(swapped("(event fall)", "(event /entities/b3)")), "/claims/falls_off/by/0", "judged by /story/beats, not by"),
    "too few that are counted": (world(swapped("(count b1 b2 b3)", "(count b1 b2)")), "/claims/three/by", "counts 3, by names 2"),
    "one more of the same": (
        world(swapped("row of [three](count b1 b2 b3) [blocks](thing b1 b2 b3)", "row of [three](count b1 b2 ball) blocks")
              .replace("[block](thing b3 same_as=blocks)", "block")),
        "/claims/three/by", "b3 has the same shape and material"),
    "two spans that share a thing": (
        world(swapped("[shelf](thing shelf)", "[shelf](thing ball)")), "/claims/shelf/by", "'shelf' and 'ball' are both /entities/ball"),
    "one of several as a thing of its own": (
        world(swapped("[block](thing b3 same_as=blocks)", "[block](thing b3)")),
        "/claims/block/by", "if it is some of them alone, [block](thing b3 same_as=blocks)"),
    "a wrong material": (world(swapped("[steel](property ball)", "[steel](property b1)")), "/claims/steel/by", "'steel' asks for steel; what the claim names is not"),
    "no thing at all": (world("A steel ball [rolls](event roll) into a row of [three](count b1 b2 b3) blocks. The last block falls off the shelf."),
                        "/claims", "no claim says which words of the prompt are things"),
    "too much that is waived": (
        world('A [steel ball rolls into a row of](waived because="it is too hard to judge") [three](count b1 b2 b3) [blocks](thing b1 b2 b3). '
              "The last [block](thing b3 same_as=blocks) [falls off](event fall) the [shelf](thing shelf)."),
        "/claims", "of the prompt's letters are waived, at most 20%"),
    "an event of what nobody speaks of": (
        world(swapped("[shelf](thing shelf)", "shelf"), ("/story/beats/fall/subject", "shelf"), ("/story/beats/fall/predicate", {"kind": "falls", "entity": "shelf"})),
        "/claims/falls_off/by/0", "told of 'shelf', which no claim of a thing names"),
    "a pointer that leads nowhere": (world(swapped("[shelf](thing shelf)", "[shelf](thing /entities/table)")), "/claims/shelf/by/0", "leads nowhere"),
    "a same_as of another type": (
        world(swapped("[block](thing b3 same_as=blocks)", "[block](thing b3 same_as=rolls)")), "/claims/block/same_as",
        "must be another claim of type thing that stands for itself; it takes a claim's id, made of the words that it quotes: ball, blocks, shelf"),
    "an order of one beat": (world(swapped("The last [block]", "The [last](order fall) [block]")), "/claims/last/by", "name two beats, the first first"),
}  # fmt: skip


@pytest.mark.parametrize("name", WRONG)
def test_a_claim_that_asks_for_less_than_its_words_is_refused_with_pointer_and_hint(name: str) -> None:
    spec, pointer, hint = WRONG[name]
    found = problems(spec)
    assert hint in found.get(pointer, str(found))
    assert not audit(spec).passed


DENIED = "The ball never touches the third block, and the last one falls."
DENIAL = (
    "The [ball](thing ball) [never touches](negation apart) the [third block](thing b3), and the last one [falls](event fall)."
)
TOUCHES = {"text": "the ball touches the third block", "predicate": {"kind": "contact", "a": "ball", "b": "b3"}}


def denied(**more: Any) -> WorldSpec:
    return world(DENIAL, ("/story/requirements", {"apart": {**TOUCHES, **more}}), prompt=DENIED)


@pytest.mark.parametrize(
    ("more", "hint"),
    [
        ({}, "never: true, the server negates it"),
        ({"never": True, "mandatory": False}, "is optional"),
        ({"never": True, "frames": [0, 4]}, "looks at frames [0, 4] alone"),
        ({"never": True, "predicate": {"kind": "no_contact", "a": "ball", "b": "b3"}}, "tells of a state"),
    ],
)
def test_a_negation_is_a_mandatory_requirement_that_the_server_negates(more: dict[str, Any], hint: str) -> None:
    assert any(hint in text for text in problems(denied(**more)).values())
    assert problems(denied(never=True)) == {}


def test_the_patch_of_a_negation_mends_it() -> None:
    (patch,) = [p.patch for p in claim_problems(denied()) if p.patch is not None]
    assert problems(apply_patch(denied(), [patch])) == {}


def test_a_claim_is_judged_up_to_the_length_of_its_type() -> None:
    spec = world(
        swapped(
            "A [steel](property ball) [ball](thing ball) [rolls](event roll) into a row of",
            "[A steel ball rolls into a row of](thing ball)",
        ).replace("[rolls]", "rolls")
    )
    first = reading_of(spec).spans[0]
    assert first.text == "A steel ball rolls"
    assert LONGEST["thing"] == 4
    assert reading_of(spec).spans[1].text.startswith(" into a row of ")


@pytest.mark.parametrize("prompt", honest(), ids=lambda p: p.id)
def test_no_honest_prompt_is_refused_for_a_word_as_persons_marked_it(prompt: Marked) -> None:
    assert untaken(prompt) == []


def test_one_of_a_span_of_several_bodies_is_a_number_that_a_thing_does_not_judge() -> None:
    told = swapped("A [steel](property ball) [ball](thing ball)", "[A](thing ball b1)")
    prompt = PROMPT.replace("A steel ball", "One", 1)
    spec = world(told.replace("[A]", "[One]"), prompt=prompt)
    assert any("'One' of 'One' is a number word" in text for text in problems(spec).values())
    single = world(told.replace("[A](thing ball b1)", "[One](thing ball)"), prompt=prompt)
    assert not any("'One'" in text for text in problems(single).values())


def test_claimed_filler_and_waived_letters_make_up_the_prompt() -> None:
    found = prompt_record(world())
    assert found["claimed"] + found["filler"] + found["waived"] == pytest.approx(1.0, abs=2e-4)
    assert "".join(s["text"] for s in found["spans"]) == PROMPT
    assert found["filler_texts"] == ["A", "into a row of", "The last", "the"]


def test_marks_of_claims_give_the_claims_again() -> None:
    spec = world()
    assert claims_from(marked_claims(spec), spec) == {
        k: c.model_dump(mode="json", exclude_defaults=True) | {"nth": c.nth} for k, c in spec.claims.items()
    }


@pytest.mark.parametrize(
    ("marked", "hint"),
    [
        (MARKED.replace("thing shelf", "thing shelv"), "did you mean 'shelf'"),
        (MARKED.replace("The last", "The first"), "is not the prompt"),
        (MARKED.replace("thing shelf", "thong shelf"), "has the type 'thong'"),
    ],
)
def test_marked_text_that_cannot_be_read_says_what_to_write(marked: str, hint: str) -> None:
    with pytest.raises(InputError, match=hint):
        world(marked)


def test_versions_do_not_mix_and_a_version_stays_out_of_the_motion() -> None:
    one = parse_spec(old_spec())
    with pytest.raises(SpecError, match="claims are of spec_version '2'"):
        apply_patch(
            one, [{"op": "add", "path": "/claims", "value": {"a": {"quote": "ball", "type": "thing", "by": ["/entities/ball"]}}}]
        )
    with pytest.raises(SpecError, match="clauses are of spec_version '1'"):
        apply_patch(one, [{"op": "replace", "path": "/spec_version", "value": "2"}])
    two = apply_patch(one, claim_operations(MARKED, one))
    assert canonical_json(motion_slice(two)) == canonical_json(motion_slice(one))
    for name in one.entities:
        assert canonical_json(geometry_slice(two, name)) == canonical_json(geometry_slice(one, name))
    assert b"claims" not in canonical_json(one)
    assert b"clauses" not in canonical_json(two)


@pytest.mark.parametrize(
    ("edited", "told"),
    [
        (swapped("[shelf](thing shelf)", "shelf"), "claim of 'shelf' dropped"),
        (swapped("[shelf](thing shelf)", '[shelf](waived because="nobody sees it anyway")'), "claim of 'shelf' waived"),
        (swapped("[falls off](event fall)", "[falls off](route fall)"), "claim of 'falls off' is route, was event"),
        (swapped("(thing b1 b2 b3)", "(thing b1 b2)"), "no longer judged by /entities/b3"),
        (swapped("[falls off](event fall)", "[falls](event fall) off"), "claim of 'falls off' covers less: 'off' is filler now"),
    ],
)
def test_an_edit_of_claims_that_asks_for_less_is_called_so(edited: str, told: str) -> None:
    spec = world()
    after = apply_patch(spec, claim_operations(edited, spec))
    assert any(told in w for w in weakenings(spec, after)), weakenings(spec, after)
    assert weakenings(spec, spec) == []


def test_words_that_are_marked_together_or_apart_ask_for_no_less() -> None:
    apart = world()
    marked = swapped("[three](count b1 b2 b3) [blocks](thing b1 b2 b3)", "[three blocks](count b1 b2 b3)")
    marked = marked.replace("same_as=blocks", 'same_as="three blocks"')
    together = apply_patch(apart, claim_operations(marked, apart))
    assert [w for w in weakenings(apart, together) if "claim" in w] == []
    assert [w for w in weakenings(together, apart) if "claim" in w] == []


def test_a_requirement_that_must_never_come_true_is_weaker_where_its_event_is_harder() -> None:
    spec = denied(never=True)
    harder = apply_patch(spec, [{"op": "add", "path": "/story/requirements/apart/predicate/min_impulse", "value": 1.0}])
    easier = apply_patch(harder, [{"op": "add", "path": "/story/requirements/apart/predicate/min_impulse", "value": 0.1}])
    assert weakenings(spec, harder)
    assert weakenings(harder, easier) == []


@pytest.mark.parametrize(
    ("record", "words"),
    [
        ({"verdict": "incomplete"}, "incomplete"),
        ({"verdict": "accepted"}, "physics accepted; prompt judged by clauses"),
        ({"verdict": "accepted", "prompt": {}}, "accepted, prompt read by nobody"),
        ({"verdict": "accepted", "prompt": {"read_by": "client"}}, "accepted, prompt read by its own client alone"),
        ({"verdict": "accepted", "prompt": {"read_by": "person"}}, "accepted"),
    ],
)
def test_a_verdict_says_who_read_the_prompt(record: dict[str, Any], words: str) -> None:
    assert verdict_words(record) == words


HELD: dict[str, tuple[str, str, str, str]] = {
    "a negation in an event": (
        "The ball doesn't roll.", "The [ball](thing ball) [doesn't roll](event roll).", "n't", "which a claim of type event does not judge"),
    "a negation in filler": ("The ball never rolls.", "The [ball](thing ball) never [rolls](event roll).", "never", "no claim takes it up"),
    "a number in a thing": (
        "The ball rolls into three blocks.", "The [ball](thing ball) [rolls](event roll) into [three blocks](thing b1 b2 b3).", "three", "of type thing does not judge"),
    "an order word in filler": (
        "The ball rolls, then the block falls.", "The [ball](thing ball) [rolls](event roll), then the [block](thing b3) [falls](event fall).", "then", "mark it as order"),
    "in German": ("Drei Blöcke, und keiner fällt.", "[Drei](count b1 b2 b3) [Blöcke](thing b1 b2 b3), und keiner [fällt](event fall).", "keiner", "no claim takes it up"),
    "in Chinese": ("三个木块，球没有碰到它们。", "[三个](count b1 b2 b3)[木块](thing b1 b2 b3)，[球](thing ball)没有[碰到](event roll)它们。", "没有", "no claim takes it up"),
}  # fmt: skip


@pytest.mark.parametrize("name", HELD)
def test_a_number_negation_or_order_word_is_judged_as_what_it_is(name: str) -> None:
    prompt, marked, word, said = HELD[name]
    found = [text for text in problems(world(marked, prompt=prompt)).values() if repr(word)[1:-1] in text and said in text]
    assert found, problems(world(marked, prompt=prompt))


MEASURED: dict[str, tuple[str, str, bool]] = {
    "the size that is said": (
        "a shelf 30 cm tall",
        "a [shelf](thing shelf) [30 cm tall](quantity /entities/shelf/dimensions/size/2)",
        True,
    ),
    "another size": (
        "a shelf 40 cm tall",
        "a [shelf](thing shelf) [40 cm tall](quantity /entities/shelf/dimensions/size/2)",
        False,
    ),
    "a duration": (
        "the ball rolls for 1.5 s",
        "the [ball](thing ball) [rolls](event roll) for [1.5 s](quantity /simulation/frames)",
        True,
    ),
    "half of it": (
        "the ball rolls for 0.75 s",
        "the [ball](thing ball) [rolls](event roll) for [0.75 s](quantity /simulation/frames)",
        False,
    ),
    "a thing in place of a number": (
        "a shelf 30 cm tall",
        "a [shelf](thing shelf) [30 cm tall](quantity /entities/shelf)",
        False,
    ),
}


@pytest.mark.parametrize("name", MEASURED)
def test_a_quantity_is_the_number_that_its_words_say(name: str) -> None:
    prompt, marked, right = MEASURED[name]
    found = [p for p in problems(world(marked, prompt=prompt)) if p.endswith("/by")]
    assert (found == []) is right, problems(world(marked, prompt=prompt))
