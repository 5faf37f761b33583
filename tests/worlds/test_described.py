"""Words of claims that a rule judges: found in the ten languages with reviewed lists, and nowhere else."""

from __future__ import annotations

import itertools

import pytest
from worldagent.testing.worlds.small_worlds import ball, ground, world
from worldagent.worlds.claims import prompt_record
from worldagent.worlds.described import alike, judged_words
from worldagent.worlds.prompts.descriptions import WordKind, anchors, meanings, terms
from worldagent.worlds.prompts.languages import REVIEWED
from worldagent.worlds.prompts.tables import table
from worldagent.worlds.spec import Claim, WorldSpec


@pytest.mark.parametrize(
    ("language", "kind", "quote", "found"),
    [
        ("en", "colour", "a bright red ball", ["red"]),
        ("de", "colour", "die grüne Kugel auf weißem Grund", ["green", "white"]),
        ("fr", "colour", "une balle rouge et verte", ["red", "green"]),
        ("es", "form", "una caja pequeña y pesada", ["small", "heavy"]),
        ("it", "time", "al tramonto", ["dusk"]),
        ("pt", "weather", "com nevoeiro", ["fog"]),
        ("nl", "place", "naast de vijver", ["beside"]),
        ("ru", "colour", "красного шара", ["red"]),
        ("zh", "form", "大球和小球", ["big", "small"]),
        ("ja", "colour", "白い皿", ["white"]),
        ("fr", "material", "d'acier", ["steel"]),
        ("en", "place", "on top of the shelf", ["on"]),
        # Words that are none of these here.
        ("en", "form", "a light blue kite", ["-"]),
        ("zh", "form", "大小不一的石块", ["-"]),
        ("en", "colour", "a tired ball, ordered", []),
        (None, "colour", "a red ball", []),
        ("hi", "colour", "red", []),
    ],
)
def test_words_are_found_in_their_language(language: str | None, kind: WordKind, quote: str, found: list[str]) -> None:
    assert [m.term for m in meanings(quote, language, kind)] == found


def test_every_meaning_has_words_in_every_reviewed_language_and_no_word_two_meanings() -> None:
    words = table("descriptions")["words"]
    lacking = [
        (kind, term, language)
        for kind, of_term in words.items()
        for term, of in of_term.items()
        for language in REVIEWED
        if term != "-" and not of.get(language)
    ]
    assert lacking == []
    twice = []
    for kind, language in itertools.product(words, REVIEWED):
        listed = [w for of in words[kind].values() for w in of.get(language, ())]
        twice += [(kind, language, w) for w in set(listed) if listed.count(w) > 1]
    assert twice == []
    assert set(terms("colour")) == set(anchors()), "the eleven basic terms have words and places"
    assert "Munroe" in table("colours")["source"]["survey"]


PROMPT = "A small ball and two balls stand on a floor at dusk, oddly."


def claimed(**more: Claim) -> WorldSpec:
    spec = world({"floor": ground(), "a": ball(0.1), "b": ball(0.2), "c": ball(0.2)}, frames=2)
    claims = {
        "one": Claim(quote="ball", type="thing", by=["/entities/a"]),
        "others": Claim(quote="balls", type="thing", by=["/entities/b", "/entities/c"]),
        "floor": Claim(quote="floor", type="thing", by=["/entities/floor"]),
        **more,
    }
    document = spec.model_dump(mode="json")
    document.pop("clauses")
    return WorldSpec.model_validate(
        {**document, "spec_version": "2", "prompt": PROMPT, "claims": {k: c.model_dump() for k, c in claims.items()}}
    )


def test_a_word_of_size_is_judged_where_others_of_its_kind_are_there() -> None:
    small = Claim(quote="small", type="property", by=["/entities/a"])
    spec = claimed(small=small)
    assert alike(spec, "small", "small") == ["b", "c"]
    assert [w.term for w in judged_words(spec, "small")] == ["small"]
    alone = claimed(small=small.model_copy(update={"by": ["/entities/floor"]}))
    assert judged_words(alone, "small") == ()


def test_what_no_rule_judges_is_printed_as_the_agents_reading() -> None:
    dusk = Claim(quote="dusk", type="time", by=["/look/sun_elevation_deg"])
    oddly = Claim(quote="oddly", type="property", by=["/entities/a"])
    assert prompt_record(claimed(dusk=dusk, oddly=oddly))["readings"] == {"oddly": ["/entities/a"]}


def test_weather_of_the_past_is_no_weather_of_the_film() -> None:
    spec = claimed()
    after = spec.model_copy(
        update={
            "prompt": "After a rain a ball and two balls lie on a floor.",
            "claims": {"rain": Claim(quote="After a rain", type="weather", by=["/look/sky"])},
        }
    )
    assert judged_words(after, "rain") == ()
