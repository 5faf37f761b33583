"""Whole landscapes: sun, moisture, ground and plants agree with the land and its water."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.spatial import cKDTree
from worldagent.construction.terrain.climate import BIOMES, moisture
from worldagent.construction.terrain.grid import Grid
from worldagent.construction.terrain.ground import cover
from worldagent.construction.terrain.landscape import Landscape, build_landscape
from worldagent.construction.terrain.relief import horizons, relief, sunlight, wind_exposure
from worldagent.construction.terrain.vegetation import RESPONSES, _table, plant_table, species_of, suitability, trapezoid
from worldagent.server.capabilities import _vegetation as capabilities_of_plants
from worldagent.server.skill_files import SKILLS
from worldagent.worlds.errors import InputError, LimitError
from worldagent.worlds.patch import parse_spec
from worldagent.worlds.spec.terrain import BIOME_NAMES, FIELD_NAMES, SPECIES_NAMES, SPECIES_OF_FORM, Terrain

ISLAND: dict[str, Any] = {
    "extent": [1600, 1600],
    "cell": 10,
    "datum": -40,
    "sea_level": 0,
    "seed": 5,
    "layers": {
        "hill": {"kind": "cone", "radius": 700, "height": 320, "order": 1},
        "rough": {"kind": "noise", "style": "ridged", "amplitude": 40, "wavelength": 400, "order": 2},
        "crater": {"kind": "crater", "radius": 130, "depth": 70, "order": 3},
        "way": {"kind": "road", "line": [[-300, -400], [300, -350]], "width": 8, "order": 4},
    },
    "erosion": {"years": 20000, "steps": 4},
    "climate": {"biome": "volcanic-island", "rain_shadow": 0.8, "wind_deg": 60, "latitude_deg": 20},
    "hydrology": {"required": ["sea", "lake"]},
    "zones": {"west": {"polygon": [[-800, -800], [0, -800], [0, 800], [-800, 800]]}},
    "ground": {
        "low": {"order": 1, "material": "sand", "where": [{"field": "height", "at_most": 10}]},
        "shore": {"order": 2, "material": "gravel", "where": [{"field": "height", "at_least": -3, "at_most": 5}], "blend": 20},
    },
    "vegetation": {"density": 0.6},
}


def _built(**changes: Any) -> Landscape:
    return build_landscape(Terrain.model_validate({**ISLAND, **changes}), Path())


@pytest.fixture(scope="module")
def island() -> Landscape:
    return _built()


def test_nothing_grows_in_water_on_beds_or_on_the_road(island: Landscape) -> None:
    assert island.plants is not None
    assert len(island.plants) > 500
    x, y = island.plants.position[:, 0], island.plants.position[:, 1]
    row, col = island.grid.indices(x, y)
    assert not island.wet[row, col].any()
    assert not island.channels.bed[row, col].any()
    share = np.clip(((x + 300) * 600 + (y + 400) * 50) / (600**2 + 50**2), 0, 1)
    assert np.hypot(x + 300 - 600 * share, y + 400 - 50 * share).min() > 4.0


def test_plants_keep_their_distance(island: Landscape) -> None:
    plants = island.plants
    assert plants is not None
    points = plants.position[:, :2]
    tree = cKDTree(points)
    pairs = tree.query_pairs(2 * plants.radius.max(), output_type="ndarray")
    apart = np.hypot(*(points[pairs[:, 0]] - points[pairs[:, 1]]).T)
    assert (apart >= plants.radius[pairs[:, 0]] + plants.radius[pairs[:, 1]] - 1e-9).all()


def test_plants_stand_on_the_ground(island: Landscape) -> None:
    plants = island.plants
    assert plants is not None
    assert plants.position[:, 2] == pytest.approx(island.grid.sample(island.fields["height"], *plants.position[:, :2].T))


def test_the_same_seed_gives_the_same_bytes_and_another_seed_another_land(island: Landscape) -> None:
    again, other = _built(), _built(seed=6)
    for name, values in island.fields.items():
        assert values.tobytes() == again.fields[name].tobytes(), name
    assert island.plants is not None
    assert again.plants is not None
    assert island.plants.position.tobytes() == again.plants.position.tobytes()
    assert not np.array_equal(island.fields["height"], other.fields["height"])


@pytest.mark.parametrize("threads", [1, 3])
def test_the_number_of_cores_changes_no_byte(island: Landscape, threads: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("worldagent.construction.terrain.slices.cores", lambda: threads)
    again = _built()
    for name, values in island.fields.items():
        assert values.tobytes() == again.fields[name].tobytes(), name
    assert island.figures == again.figures


def test_the_forest_stands_on_the_wet_side(island: Landscape) -> None:
    rain = island.fields["rain"]
    x, y = island.grid.points()
    windward = x * np.cos(np.radians(60)) + y * np.sin(np.radians(60)) > 0
    land = island.fields["height"] > 0
    assert rain[land & windward].mean() > 1.1 * rain[land & ~windward].mean()
    assert rain.mean() == pytest.approx(2.0, rel=1e-6)
    density = island.fields["tree_density"]
    assert density[land & windward].mean() > density[land & ~windward].mean()


def test_the_last_matching_rule_wins_and_weights_sum_to_one(island: Landscape) -> None:
    cover, height = island.cover, island.fields["height"]
    shore = (height >= -3) & (height <= 5)
    assert (cover.index[shore] == cover.names.index("gravel")).all()
    assert (cover.index[height < -4] == cover.names.index("sand")).all()
    weights = cover.weights(island.grid)
    assert weights.sum(axis=0) == pytest.approx(np.ones(island.grid.shape), abs=1e-5)
    assert (weights >= 0).all()


def test_every_field_is_finite_or_says_where_there_is_no_water(island: Landscape) -> None:
    for name, values in island.fields.items():
        assert values.shape == island.grid.shape, name
        assert not np.isnan(values).any(), name
        if name not in ("water_distance", "height_above_water"):
            assert np.isfinite(values).all(), name
    assert 0 <= island.fields["moisture"].min() <= island.fields["moisture"].max() <= 1


def test_the_figures_hold_the_distribution_of_height_and_slope(island: Landscape) -> None:
    figures, height = island.figures["relief"], island.fields["height"]
    land = ~island.water.sea
    assert figures["height"] == sorted(figures["height"])
    assert figures["height"][0] == pytest.approx(height[land].min(), abs=0.01)
    assert figures["height"][-1] == pytest.approx(height[land].max(), abs=0.01)
    assert (height[land] <= figures["height"][4]).mean() == pytest.approx(0.5, abs=0.01)
    assert 0.1 < figures["hypsometric_integral"] < 0.6, "a cone of a third and what erosion left of it"
    assert figures["slope_deg"][-1] < 90
    assert figures["land_share"] == pytest.approx(land.mean(), abs=1e-3)


def test_finer_grids_see_the_same_skyline() -> None:
    """The horizon is looked for over the same metres on a grid four times as fine."""
    means = []
    for cells in (256, 1024):
        grid = Grid(8, cells, 4096 / cells)
        x, _ = grid.points()
        ridge = 300 * np.exp(-((x - 600) ** 2) / 200**2)
        seen = horizons(grid, ridge, azimuths=2)[0]
        means.append(seen[4, (x[4] > -200) & (x[4] < 0)].mean())
    assert means[0] > 0.2
    assert means[1] == pytest.approx(means[0], rel=0.05)


def test_required_water_that_the_land_does_not_have_is_refused_with_a_remedy() -> None:
    plain = {"extent": [400, 400], "cell": 10, "layers": {"r": {"kind": "ramp", "rise": 20}}}
    for kind, words in (("lake", "crater"), ("sea", "sea_level")):
        with pytest.raises(InputError, match=words):
            build_landscape(Terrain.model_validate({**plain, "hydrology": {"required": [kind]}}), Path())
    dry = {**plain, "hydrology": {"required": ["river"], "density": 0}}
    with pytest.raises(InputError, match="no river"):
        build_landscape(Terrain.model_validate(dry), Path())


def test_a_pond_that_is_smaller_than_lakes_may_be_is_refused_with_its_area_and_what_lets_it_be() -> None:
    pond = {"kind": "crater", "center": [0, 0], "radius": 6, "depth": 1.5}
    plain = {"extent": [60, 60], "cell": 0.5, "layers": {"pond": pond}, "erosion": {"years": 0, "steps": 1}, "vegetation": None}
    with pytest.raises(InputError, match="least_lake_area to") as refused:
        build_landscape(Terrain.model_validate({**plain, "hydrology": {"required": ["lake"]}}), Path())
    least = float(str(refused.value).rsplit("least_lake_area to ", 1)[1])
    told = {"required": ["lake"], "least_lake_area": least}
    assert build_landscape(Terrain.model_validate({**plain, "hydrology": told}), Path()).water.lakes
    coarse = {**plain, "cell": 4, "hydrology": {"required": ["lake"], "least_lake_area": 1}}
    with pytest.raises(InputError, match="smaller cells"):
        build_landscape(Terrain.model_validate(coarse), Path())


def test_an_inflow_makes_a_river_where_the_rain_would_not() -> None:
    plain = {"extent": [300, 300], "cell": 5, "layers": {"r": {"kind": "ramp", "rise": -20}}, "climate": {"biome": "desert"}}
    given = {
        **plain,
        "hydrology": {"inflows": {"spring": {"position": [-140, 10], "discharge": 2.0}}, "density": 0, "required": ["river"]},
    }
    land = build_landscape(Terrain.model_validate(given), Path())
    river = next(r for r in land.water.rivers if r.kind == "river")
    assert land.water.discharge.flat[river.cells[0]] == pytest.approx(2.0, rel=1e-3)
    assert river.width[0] == pytest.approx(3.33 * np.sqrt(5 * 2.0), rel=1e-3)


def test_a_grid_that_is_too_large_or_too_small_is_refused_before_any_work() -> None:
    with pytest.raises(LimitError, match="cells"):
        _built(extent=[16384, 16384], cell=1)
    with pytest.raises(InputError, match="at least 3 x 3"):
        _built(extent=[10, 10], cell=10)


def test_too_many_plants_are_refused_with_the_estimate() -> None:
    with pytest.raises(InputError, match="lower the density"):
        _built(vegetation={"density": 10, "forms": ["tree", "grass"], "most": 1000, "species": ["meadow-grass"]})
    with pytest.raises(InputError, match="does not grow"):
        _built(vegetation={"species": ["cactus"]})


@pytest.mark.parametrize(
    "changes",
    [{"vegetation": {"zone": "nowhere"}}, {"ground": {"g": {"material": "sand", "zone": "nowhere"}}}],
)
def test_a_zone_that_is_not_declared_is_refused_with_those_that_are(changes: dict[str, Any]) -> None:
    with pytest.raises(InputError, match=r"'nowhere' is not declared; the terrain has \['west'\]"):
        _built(**changes)


def test_every_field_that_a_rule_may_name_is_there(island: Landscape) -> None:
    assert set(FIELD_NAMES) <= set(island.fields)


def test_a_level_plain_has_the_astronomical_day() -> None:
    grid = Grid(20, 20, 10.0)
    for latitude, day, hours in ((0.0, 80, 12.0), (52.0, 172, 16.5), (52.0, 355, 7.6)):
        light = sunlight(grid, np.zeros(grid.shape), latitude=np.radians(latitude), day=day, steps=96)
        assert light.hours[10, 10] == pytest.approx(hours, abs=0.35)
        assert light.sky[10, 10] == 1.0


def test_slopes_towards_the_sun_get_more_of_it() -> None:
    grid = Grid(60, 60, 10.0)
    _, y = grid.points()
    ridge = 100 - 0.4 * np.abs(y)
    light = sunlight(grid, ridge, latitude=np.radians(48.0), day=80).energy
    assert light[15].mean() > 1.3 * light[45].mean(), "row 0 is south, and the sun stands there"


def test_a_wall_hides_the_sky_behind_it_and_shelters_from_the_wind() -> None:
    grid = Grid(64, 64, 1.0)
    x, _ = grid.points()
    wall = np.where(np.abs(x) < 1, 10.0, 0.0) + 0.0 * x
    seen = horizons(grid, wall)
    assert seen[0, 32, 26] == pytest.approx(10 / 6, rel=0.35)
    sheltered = wind_exposure(seen, direction=0.0)
    assert sheltered[32, 28] < 0.3
    assert sheltered[32, 45] == 1.0


def test_moisture_rises_with_water_near_gathered_held_and_fallen() -> None:
    middle = {"distance": 50.0, "above": 3.0, "index": 9.0, "retention": 0.5, "rain": 0.8}
    wetter = {"distance": 5.0, "above": 0.5, "index": 13.0, "retention": 0.9, "rain": 2.0}

    def at(values: dict[str, float]) -> float:
        return float(moisture(**{k: np.array(v) for k, v in values.items()}))

    for name, value in wetter.items():
        assert at({**middle, name: value}) > at(middle), name
    assert 0 <= at({"distance": np.inf, "above": np.inf, "index": 0.0, "retention": 0.0, "rain": 0.0}) <= 1e-6


def test_species_are_whole_and_every_biome_has_some() -> None:
    for name, row in _table().items():
        assert set(row["responses"]) == set(RESPONSES), name
        assert row["source"], name
        for corners in row["responses"].values():
            assert list(corners) == sorted(corners), name
    for biome in BIOME_NAMES:
        assert {"rock"} < {s.form for s in species_of(biome)}, biome
    with pytest.raises(InputError, match="known"):
        species_of("moon")


def test_the_specification_and_the_guide_know_the_species_that_there_are() -> None:
    assert {n: form for form, names in SPECIES_OF_FORM.items() for n in names} == {n: row["form"] for n, row in _table().items()}
    guide = (SKILLS / "outdoor-terrain" / "plants.md").read_text()
    assert plant_table() in guide
    for name, biome in BIOMES.items():
        assert f"{name} {biome.temperature:g}" in guide.replace("\n", " ")
    told = capabilities_of_plants()["species"]
    assert {n for forms in told.values() for names in forms.values() for n in names} == set(SPECIES_NAMES)
    assert "pine" in told["boreal"]["tree"]


def test_an_unknown_species_answers_with_the_list() -> None:
    with pytest.raises(InputError) as error:
        parse_spec(
            {
                "title": "t",
                "prompt": "p",
                "simulation": {"frames": 2},
                "terrains": {"land": {**ISLAND, "vegetation": {"species": ["pin"]}}},
            }
        )
    assert "did you mean 'pine'" in str(error.value)
    assert all(name in str(error.value) for name in SPECIES_NAMES)


def test_species_bring_their_forms_and_contradictions_are_refused() -> None:
    shrubs = _built(vegetation={"species": ["ohia-shrub"], "density": 0.05})
    assert shrubs.plants is not None
    assert shrubs.plants.species == ("ohia-shrub",)
    assert len(shrubs.plants) > 50
    with pytest.raises(InputError, match="is a shrub, and /vegetation/forms"):
        _built(vegetation={"species": ["ohia-shrub"], "forms": ["tree"]})
    with pytest.raises(InputError, match="'pine' grows in boreal, mediterranean, temperate"):
        _built(vegetation={"species": ["pine"]})


def test_a_trapezoid_is_one_in_its_middle_and_zero_outside() -> None:
    values = trapezoid(np.array([-1.0, 0.0, 0.5, 1.0, 2.0, 2.5, 3.0, 4.0]), (0.0, 1.0, 2.0, 3.0))
    assert values.tolist() == [0.0, 0.0, 0.5, 1.0, 1.0, 0.5, 0.0, 0.0]


RELIEF_INPUTS = (
    "slope", "height", "curvature", "roughness", "peak", "sunlight", "wear", "deposit", "sediment", "filled", "basin_depth", "accumulation",
)  # fmt: skip
"""Inputs of materials that R41 names, and the Priority-Flood fields that it refers to and a rule may name."""


@pytest.mark.parametrize("field", RELIEF_INPUTS)
def test_a_rule_on_any_input_decides_exactly_its_cells(island: Landscape, field: str) -> None:
    """R41: half of what the field spans is sand, the rest stays as it was without the rule."""
    values = island.fields[field]
    bound = (
        float(values.min() + 0.5 * np.ptp(values)) if field == "peak" else float(np.quantile(values[values > values.min()], 0.5))
    )
    plain = Terrain.model_validate({**ISLAND, "ground": {}})
    ruled = Terrain.model_validate(
        {**ISLAND, "ground": {"r": {"order": 1, "material": "sand", "where": [{"field": field, "at_least": bound}]}}}
    )
    bed = np.zeros(island.grid.shape, dtype=bool)
    without, found = (cover(island.grid, t, island.fields, bed=bed) for t in (plain, ruled))
    sand = found.index == found.names.index("sand")
    assert 0 < sand.sum() < sand.size, "the bound parts the land"
    assert np.array_equal(sand, values >= bound)
    assert np.array_equal(found.index[~sand], without.index[~sand])


def test_derivatives_of_relief_are_those_of_its_formula() -> None:
    """Law: a bowl z = r^2 / 2R has the curvature 2 / R and the slope r / R; a plane is not rough; one summit is one peak."""
    grid, radius = Grid(61, 61, 2.0), 80.0
    x, y = grid.points()
    inner = np.s_[5:-5, 5:-5]
    bowl = relief(grid, (x**2 + y**2) / (2 * radius))
    assert bowl.curvature[inner] == pytest.approx(2 / radius, rel=1e-9)
    assert bowl.slope[inner] == pytest.approx((np.hypot(x, y) / radius)[inner], rel=1e-9, abs=1e-12)
    plane = relief(grid, 0.3 * x + 0.0 * y)
    assert plane.roughness.max() < 1e-6
    assert not plane.peak[inner].any()
    waves = relief(grid, 0.3 * np.sin(x / 3) + 0.0 * y)
    assert waves.roughness[inner].min() > 1e-3
    summit = relief(grid, 50 - np.hypot(x, y))
    assert np.argwhere(summit.peak).tolist() == [[30, 30]]


@pytest.mark.parametrize("response", RESPONSES)
def test_a_plant_thrives_within_its_range_of_every_response_and_nowhere_else(response: str) -> None:
    """R44: moisture (which holds the distance to the bank), accumulated sunlight, wind exposure (which terrain shelters from), and more."""
    (oak,) = (s for s in species_of("temperate") if s.name == "oak")
    good = {name: np.array([0.5 * (max(c[1], 0.0) + min(c[2], 2 * max(c[1], 0.5)))]) for name, c in oak.responses.items()}
    assert suitability(oak, good)[0] == 1.0
    low, _, _, high = oak.responses[response]
    wrong = [v for v in (low - 1e-6, high + 1e-6) if -1 <= v <= 100]
    assert wrong
    for value in wrong:
        assert suitability(oak, {**good, response: np.array([value])})[0] == 0.0, value


def test_a_biome_sets_how_much_water_a_land_has() -> None:
    """R38: the same land, from a desert to the tropics, and there twice as dense as the biome has it."""
    lengths = {}
    for biome, density in (("desert", 1.0), ("mediterranean", 1.0), ("tropical", 1.0), ("tropical", 2.0)):
        land = _built(climate={"biome": biome}, hydrology={"density": density}, vegetation=None, erosion=None)
        wet = land.water.channels("river").sum() * land.grid.cell / (~land.water.standing).sum() / land.grid.cell_area
        assert wet == pytest.approx(density * BIOMES[biome].river_density, rel=0.35), (biome, density)
        lengths[biome, density] = wet
    assert list(lengths.values()) == sorted(lengths.values())


def test_basins_are_chosen_by_the_area_and_depth_asked_for() -> None:
    """R38: the crater holds a lake until lakes must be deeper than it."""
    kept = _built(hydrology={"least_lake_depth": 1.0}, vegetation=None)
    deepest = max(lake.depth for lake in kept.water.lakes)
    none = _built(hydrology={"least_lake_depth": deepest + 0.1}, vegetation=None)
    assert not none.water.lakes
