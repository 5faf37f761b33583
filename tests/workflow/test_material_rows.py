"""Rows of the table of materials as `inspect_world` tells them."""

from __future__ import annotations

import pytest
from worldagent.workflow.answers import PAGE_CHARACTERS, size_of
from worldagent.workflow.material_rows import materials
from worldagent.worlds.errors import InputError
from worldagent.worlds.materials import material_table


def test_a_name_finds_its_row_with_figures_units_sources_and_friction_with_others() -> None:
    told = materials("oak", offset=0, limit=40)
    oak = told["materials"]["oak"]
    assert oak["figures"]["density"]["range"][0] < 762 <= oak["figures"]["density"]["range"][2]
    assert told["units"]["density"] == "kg/m^3"
    assert set(told["sources"]) >= {f["source"] for f in oak["figures"].values()}
    assert oak["friction_with"]["leather"]["range"][1] == 0.52


@pytest.mark.parametrize(
    ("query", "first"),
    [("steel", "mild_steel"), ("a glass bottle", "soda_lime_glass"), ("metals", "mild_steel"), ("Sand", "quartz_sand")],
)
def test_other_names_words_and_groups_find_rows(query: str, first: str) -> None:
    assert next(iter(materials(query, offset=0, limit=40)["materials"])) == first


def test_every_row_is_reached_by_pages_within_their_size() -> None:
    groups = {row.group for row in material_table().materials.values()}
    assert len(groups) > 5
    for group in groups:
        seen, offset = list[str](), 0
        while True:
            told = materials(group, offset=offset, limit=40)
            assert size_of(told["materials"]) <= PAGE_CHARACTERS + 2000
            assert size_of(told) < 10_000
            seen += told["materials"]
            if "next_offset" not in told:
                break
            offset = told["next_offset"]
        assert set(seen) >= {n for n, row in material_table().materials.items() if row.group == group}


def test_no_query_gives_all_names_and_one_that_finds_nothing_the_nearest() -> None:
    groups = materials("", offset=0, limit=40)["groups"]
    assert sum(map(len, groups.values())) == len(material_table().materials)
    with pytest.raises(InputError, match="did you mean 'basalt'"):
        materials("bassalt", offset=0, limit=40)
