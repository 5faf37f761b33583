"""Several parts of the schema in one reply."""

from __future__ import annotations

import pytest
from worldagent.workflow.answers import MAX_CHARACTERS, size_of
from worldagent.workflow.schema_parts import schema
from worldagent.worlds.errors import InputError
from worldagent.worlds.schema_words import described, known_parts


def test_parts_that_are_named_together_come_together_each_as_alone() -> None:
    found = schema("Entity, /simulation/joints,release, Entity")
    assert found["parts"] == {name: described(name) for name in ("Entity", "/simulation/joints", "release")}
    assert found["summary"] == "3 parts of the schema"


def test_what_does_not_fit_one_reply_is_told_with_the_call_for_it() -> None:
    every = known_parts()
    told, asked = [], ", ".join(every)
    while True:
        found = schema(asked)
        assert size_of(found) < MAX_CHARACTERS
        told += found["parts"]
        if "more do not fit" not in found["summary"]:
            break
        asked = found["next"].partition("pointer='")[2].removesuffix("')")
        assert asked.split(", ")[0] in every
    assert told == list(every)


def test_an_unknown_part_among_known_ones_is_named_and_the_others_are_told() -> None:
    found = schema("Entity, Spheres")
    assert list(found["parts"]) == ["Entity"]
    (told,) = found["warnings"]
    assert "no part 'Spheres'" in told
    assert "did you mean Sphere" in told
    with pytest.raises(InputError, match=r"no part 'Spheres'.*did you mean Sphere"):
        schema("Spheres, Spheres")
