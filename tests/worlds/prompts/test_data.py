"""The generated tables: whole, unedited, with their source and licence."""

from __future__ import annotations

import hashlib
import json
from importlib.resources import files

import pytest
from worldagent.worlds.prompts.measures import SI_UNITS
from worldagent.worlds.prompts.tables import NUMBER_LANGUAGES, table


@pytest.mark.parametrize("name", ["numbers", "units"])
def test_a_table_is_as_it_was_made_and_names_its_source(name: str) -> None:
    data = table(name)
    body = json.dumps(data["languages"], ensure_ascii=False, sort_keys=True)
    assert data["source"]["languages_sha256"] == hashlib.sha256(body.encode()).hexdigest(), (
        "made by packaging/number_words.py, never by hand"
    )
    assert len(data["source"]["library_sha256"]) == 64
    assert data["source"]["icu"] == "72.1"
    assert tuple(data["languages"]) == NUMBER_LANGUAGES
    licence = files("worldagent.worlds.prompts") / "data" / "UNICODE-LICENSE.txt"
    assert "Unicode, Inc." in licence.read_text(encoding="utf-8")


def test_every_unit_has_a_dimension_with_an_si_unit_and_a_name_of_one_meaning_in_every_language() -> None:
    data = table("units")
    assert {unit["dimension"] for unit in data["units"].values()} == set(SI_UNITS)
    twice = []
    for language in NUMBER_LANGUAGES:
        names = [name for forms in data["languages"][language].values() for name in forms]
        twice += [(language, name) for name in set(names) if names.count(name) > 1]
        assert set(data["languages"][language]) == set(data["units"])
    assert twice == []


def test_the_factors_are_those_of_the_definitions() -> None:
    units = table("units")["units"]
    assert units["mile"]["factor"] == 5280 * units["foot"]["factor"]
    assert units["foot"]["factor"] == pytest.approx(12 * units["inch"]["factor"], rel=1e-15)
    assert units["ounce"]["factor"] == units["pound"]["factor"] / 16
    assert units["fahrenheit"]["factor"] * 32 + units["fahrenheit"]["offset"] == pytest.approx(273.15)
