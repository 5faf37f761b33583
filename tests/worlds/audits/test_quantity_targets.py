"""Quantities: by a number of the world, of the thing that the words stand with, and also where an article is the number (R131, R155)."""

from __future__ import annotations

import pytest
from worldagent.tests.worlds.test_amounts import said
from worldagent.tests.worlds.test_amounts import told as of
from worldagent.worlds.audits.claims import claim_problems
from worldagent.worlds.prompts.languages import held_words
from worldagent.worlds.prompts.numbers import quantity_in

BALL = "[ball](thing ball)"


@pytest.mark.parametrize(
    "pointer",
    [
        "/simulation/preroll", "/simulation/fps", "/simulation/seed", "/simulation/limits/contact_gap", "/simulation/solvers/rigid/settings/step",
        "/entities/ball/dimensions/tolerance", "/materials/wood/appearance/roughness",
    ],
)  # fmt: skip
def test_a_setting_says_no_quantity_of_the_world(pointer: str) -> None:
    marked = f"[Within 0.1 s](quantity %s) a {BALL} [rolls](event roll) on the [shelf](thing shelf) of wood."
    assert "name what says it of the world" in said(marked % pointer) or "is none; give the pointer" in said(marked % pointer)
    assert "name what says it of the world" not in said(marked % "/story/beats/roll/frames/1")


SHELF, B1 = "/entities/shelf/dimensions/size/2", "/entities/b1/dimensions/size/2"
STANDS = {
    "of": ("A [shelf](thing shelf) of [30 cm](quantity %s) holds a [block](thing b1).", SHELF, B1),
    "before a noun": ("A [30 cm](quantity %s) [shelf](thing shelf) holds a [block](thing b1).", SHELF, B1),
    "before its properties": (
        "A [30 cm](quantity %s) [wooden](property shelf) [shelf](thing shelf) holds a [block](thing b1).",
        SHELF,
        B1,
    ),
    "von": ("Ein [Regal](thing shelf) von [30 cm](quantity %s) trägt einen [Klotz](thing b1).", SHELF, B1),
    "de": ("Une [étagère](thing shelf) de [30 cm](quantity %s) porte un [cube](thing b1) sur le sol.", SHELF, B1),
}


@pytest.mark.parametrize("name", STANDS)
def test_a_quantity_that_stands_with_a_thing_is_of_that(name: str) -> None:
    marked, own, other = STANDS[name]
    assert "is of another" not in said(marked % own)
    assert "is of another" in said(marked % other)


def test_a_quantity_with_words_between_is_left_to_the_measure() -> None:
    assert "is of another" not in said(
        "A [shelf](thing shelf) holds, [5 cm high](quantity /entities/b1/dimensions/size/2), a [block](thing b1)."
    )


def test_a_distance_is_no_size() -> None:
    marked = "A [ball](thing ball) rolls into a [block](thing b1) [30 cm](quantity %s) off."
    assert "says how far by 'off'" in said(marked % B1)
    assert "says how far" not in said(marked % "/entities/b1/pose/position/0")
    assert "says how far" not in said("A [block](thing b1) [5 cm](quantity /entities/b1/dimensions/size/2) tall.")


def test_a_number_of_another_unit_is_refused_by_the_description_of_its_field() -> None:
    """A mass is no drag on a body in N s/m."""
    marked = "A [ball](thing ball) of [8 kg](quantity /entities/ball/physics/%s) [rolls](event roll) on the [shelf](thing shelf)."
    assert "is a N s/m" in said(marked % "linear_damping")
    assert "is a N s/m" not in said(marked % "mass")


def test_a_way_across_a_floor_is_no_size() -> None:
    marked = "A [ball](thing ball) [rolls](event roll) [4 cm](quantity /entities/ball/dimensions/size/0) across%s"
    assert "says how far" in said(marked % " the [shelf](thing shelf).")
    assert "says how far" in said(marked % " a [shelf](thing shelf).")


@pytest.mark.parametrize(
    ("language", "text", "words"),
    [
        ("en", "For a whole minute it rolls, half a second, within an hour, a metre away, an inch", ["a whole minute", "half a second", "an hour", "a metre", "an inch"]),
        ("en", "a second ball, a metre stick, a minute crack, an hour glass, a foot of the table, wait a second box", []),
        ("en", "it lasts for a second.", ["a second"]),
        ("de", "Eine ganze Minute lang rollt die Kugel, eine halbe Sekunde", ["Eine ganze Minute", "eine halbe Sekunde"]),
        ("fr", "La bille roule une heure sur le sol, une demi-seconde, une seconde bille", ["une heure", "une demi-seconde"]),
        ("es", "medio metro, un minuto entero, un segundo cubo", ["medio metro", "un minuto entero"]),
        ("it", "mezzo metro, un minuto intero", ["mezzo metro", "un minuto intero"]),
        ("pt", "meio metro, um minuto inteiro", ["meio metro", "um minuto inteiro"]),
        ("nl", "een halve meter, een hele minuut", ["een halve meter", "een hele minuut"]),
        ("ru", "целую минуту, полсекунды", ["целую минуту", "полсекунды"]),
    ],
)  # fmt: skip
def test_an_article_before_a_unit_is_a_number(language: str, text: str, words: list[str]) -> None:
    assert [text[h.start : h.end] for h in held_words(text, language) if h.kind == "number"] == words


@pytest.mark.parametrize(
    ("language", "text", "value"),
    [
        ("en", "a whole minute", 60.0), ("en", "half a second", 0.5), ("en", "one full hour", 3600.0), ("de", "eine ganze Minute", 60.0), ("es", "un minuto entero", 60.0),
        ("it", "un intero minuto", 60.0), ("pt", "um inteiro minuto", 60.0), ("nl", "een hele minuut", 60.0), ("ru", "целую минуту", 60.0), ("ru", "полминуты", 30.0),
    ],
)  # fmt: skip
def test_an_article_before_a_unit_is_read(language: str, text: str, value: float) -> None:
    found = quantity_in(text, language)
    assert found is not None
    assert found.value == value


def test_a_whole_minute_is_refused_in_filler_and_of_a_film_of_a_second() -> None:
    assert "'a whole minute' at character" in said(f"For a whole minute a {BALL} [rolls](event roll).")
    assert "says 60 s" in said(f"For [a whole minute](quantity /simulation/frames) a {BALL} [rolls](event roll).")


SIZED = {
    "before a noun": "A [30 cm](quantity %s) wide [shelf](thing shelf) holds a [block](thing b1).",
    "before its properties": "A [30 cm](quantity %s) wide [wooden](property shelf) [shelf](thing shelf) holds a [block](thing b1).",
    "in the quote": "A [30 cm long](quantity %s) [shelf](thing shelf) holds a [block](thing b1).",
    "behind": "A [shelf](thing shelf) [30 cm](quantity %s) across holds a [block](thing b1).",
    "behind a comma": "A [shelf](thing shelf), [30 cm](quantity %s) thick, holds a [block](thing b1).",
    "by a noun": "A [shelf](thing shelf) [30 cm](quantity %s) in width and a [block](thing b1).",
}


@pytest.mark.parametrize("name", SIZED)
def test_a_size_is_no_position(name: str) -> None:
    text = "says the size of a body by"
    assert text in said(SIZED[name] % "/entities/shelf/pose/position/1")
    assert "name its size, as /entities/shelf/dimensions/size/" in said(SIZED[name] % "/entities/shelf/pose/position/0")
    assert text not in said(SIZED[name] % "/entities/shelf/dimensions/size/1")


@pytest.mark.parametrize(
    "marked",
    [
        "Across a [30 cm](quantity %s) wide gap a [block](thing shelf) stands.",
        "A [30 cm](quantity %s) wide [gap](thing shelf) is before a [block](thing b1).",
        "A [30 cm](quantity %s) long row of [blocks](thing shelf) stands there.",
        "A [30 cm](quantity %s) long [row](thing shelf b1) stands there.",
        "A [block](thing shelf) lies [30 cm](quantity %s) across from the [block](thing b1).",
        "A [block](thing shelf) lies [30 cm](quantity %s) wide of the [block](thing b1).",
        "A [30 cm](quantity %s) high [shelf](thing shelf) holds a [block](thing b1).",
        "A [lamp](thing shelf) hangs [30 cm](quantity %s) high above the [block](thing b1).",
    ],
)
def test_a_position_that_a_size_word_stands_beside_is_left_to_the_measure(marked: str) -> None:
    assert "says the size" not in said(marked % "/entities/shelf/pose/position/2")


def test_a_length_is_no_coefficient_of_a_material() -> None:
    """Rolling friction is in metres, and no width of a body."""
    marked = "An [8 cm](quantity /materials/wood/rolling_friction) wide [block](thing b1) stands on a [shelf](thing shelf) and a [ball](thing ball) [rolls](event roll)%s."
    rolls = ("/materials/wood/rolling_friction", 0.08)
    told = [" | ".join(p.text for p in claim_problems(of(marked % end, rolls))) for end in ("", " with rolling resistance")]
    assert "'8 cm' is a length to be seen, and /materials/wood/rolling_friction says how a material resists rolling" in told[0]
    assert "resists rolling" not in told[1]
