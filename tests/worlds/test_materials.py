"""The table of materials: densities against printed ones, figures with sources and within their substances."""

from __future__ import annotations

from typing import get_args

import pytest
from pydantic import ValidationError
from worldagent.worlds.materials import DENSITY_RANGES, QUANTITIES, Figure, friction_between, material_table, row_named
from worldagent.worlds.spec import Appearance, Material

ROWS = material_table().materials
PRINTED = {
    "steel": (7850,),
    "iron": (7870, 7150),  # pure, cast
    "aluminium": (2700,),
    "wood": (130, 750, 1200),  # balsa, oak, ebony
    "stone": (2650, 2750, 3000),  # granite, marble, basalt
    "concrete": (2400,),
    "brick": (1400, 2200),
    "glass": (2230, 2500),  # borosilicate, soda-lime
    "rubber": (920, 1100),
    "plastic": (900, 950, 1400),  # polypropylene, polyethylene, PVC
    "ice": (917,),
    "paper": (700, 1150),
    "water": (998.2, 1025),  # fresh, of the sea
    "oil": (920,),
}
"""[kg/m^3] CRC Handbook of Chemistry and Physics, 95th edition, "Density of Various Solids" and "Density of Liquids"."""


@pytest.mark.parametrize("substance", PRINTED)
def test_a_range_holds_the_printed_densities(substance: str) -> None:
    low, high = DENSITY_RANGES[substance]
    assert low <= min(PRINTED[substance])
    assert max(PRINTED[substance]) <= high


def test_no_range_is_so_wide_that_it_holds_any_matter() -> None:
    assert [n for n, (low, high) in DENSITY_RANGES.items() if high > 12 * low] == ["foam", "fabric", "other"]


def test_substances_are_those_of_the_schema() -> None:
    assert set(DENSITY_RANGES) == set(get_args(Material.model_fields["substance"].annotation))


PRINTED_ROWS = {
    "oak": 760, "beech": 720, "balsa": 160, "granite": 2640, "soda_lime_glass": 2500, "mild_steel": 7850, "lead": 11340, "gold": 19300,
    "cork": 200, "freshwater_ice": 917, "water": 998, "mercury": 13546, "nylon": 1140, "natural_rubber": 930,
}  # fmt: skip
"""[kg/m^3] CRC Handbook of Chemistry and Physics, "Density of Various Solids" and "Density of Liquids"; woods at 12 % moisture."""


@pytest.mark.parametrize("name", PRINTED_ROWS)
def test_a_row_holds_the_printed_density(name: str) -> None:
    low, typical, high = ROWS[name].figures["density"].range
    assert 0.99 * low <= PRINTED_ROWS[name] <= 1.01 * high
    assert typical == pytest.approx(PRINTED_ROWS[name], rel=0.15)


def test_every_figure_has_a_unit_and_a_source_that_is_cited() -> None:
    table, cited = material_table(), {"own"}
    for name, row in ROWS.items():
        assert set(row.figures) <= set(QUANTITIES), name
        cited |= {figure.source for figure in row.figures.values()}
    cited |= {pair.friction.source for pair in table.pairs}
    assert cited == set(table.sources), "no source is missing, none is left over"
    assert len(ROWS) >= 50


def test_every_row_weighs_as_its_substance_allows_and_has_a_look_that_the_schema_takes() -> None:
    assert len(ROWS) >= 50
    for name, row in ROWS.items():
        low, high = DENSITY_RANGES[row.substance]
        density = row.figures["density"].range
        assert low <= density[0] <= density[2] <= high, name
        Appearance.model_validate(dict(row.look))


def test_solids_have_poisson_ratios_below_a_half_and_are_stronger_in_compression_than_in_tension() -> None:
    """Poisson's ratio of an isotropic solid is at most 1/2; rock, brick, ice, concrete and glass crack in tension first."""
    both = [n for n, row in ROWS.items() if {"tensile_strength", "compressive_strength"} <= set(row.figures)]
    assert len(both) > 5
    for name, row in ROWS.items():
        figures = row.figures
        assert figures.get("poisson_ratio", Figure(range=(0, 0, 0), source="own")).range[2] <= 0.5, name
        if name in both:
            assert figures["tensile_strength"].range[1] < figures["compressive_strength"].range[1], name


def test_a_name_means_one_row() -> None:
    names = [n for name, row in ROWS.items() for n in (name, *row.also)]
    assert len(names) == len(set(names))
    found = row_named("Steel")
    assert found is not None
    assert found[0] == "mild_steel"
    assert row_named("unobtainium") is None


def test_friction_of_a_pair_is_that_of_the_rows_before_that_of_their_substances() -> None:
    oak, spruce, leather = friction_between("oak", "oak"), friction_between("spruce", "oak"), friction_between("oak", "leather")
    assert oak is not None
    assert spruce is not None
    assert leather is not None
    assert (oak.source, spruce.source, leather.range[1]) == ("marks", "bowden", 0.52)
    assert friction_between("honey", "oak") is None


def test_every_side_of_a_pair_is_a_row_or_a_substance() -> None:
    pairs = material_table().pairs
    assert len(pairs) > 10
    for pair in pairs:
        assert {pair.a, pair.b} <= set(ROWS) | set(DENSITY_RANGES)


def test_a_figure_out_of_order_is_refused() -> None:
    with pytest.raises(ValidationError, match="least <= typical <= largest"):
        Figure(range=(2.0, 1.0, 3.0), source="own")
