"""Steam where hot matter meets water: how much, where, by whose heat, held against the caches of liquids and bodies."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import pytest
from worldagent.geometry.camera import Camera
from worldagent.physics.boiling import BOILING, STEAM_DENSITY, boiling_flux, steam_heat
from worldagent.rendering.tracer.scene import SceneRenderer
from worldagent.simulation.runs import reads
from worldagent.testing.worlds.simulated_worlds import edited, simulate
from worldagent.testing.worlds.small_steam import DEPTH, LAVA_PROMPT, QUENCH_PROMPT, WIDE, lava_spec, quench_spec
from worldagent.verifiers.categories.gas.check import category_rows, numerical_rows
from worldagent.verifiers.categories.gas.frames import box_of
from worldagent.verifiers.categories.registry import JUDGES
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.categories.gas.audit import gas_problems
from worldagent.worlds.instances import bake_order
from worldagent.worlds.spec import WorldSpec

FRAMES = 8
SIDE = 0.12


def _quench(**changes: Any) -> WorldSpec:
    return WorldSpec.model_validate({"prompt": QUENCH_PROMPT, **quench_spec(frames=FRAMES, side=SIDE, **changes)})


@pytest.fixture(scope="module")
def block(tmp_path_factory: pytest.TempPathFactory) -> Candidate:
    return simulate(tmp_path_factory.mktemp("quench"), _quench())


@pytest.fixture(scope="module")
def lava(tmp_path_factory: pytest.TempPathFactory) -> Candidate:
    spec = WorldSpec.model_validate({"prompt": LAVA_PROMPT, **lava_spec(frames=FRAMES)})
    return simulate(tmp_path_factory.mktemp("lava"), spec)


def _last(world: Candidate, name: str) -> float:
    return float(world.caches["air"].series(name)[-1].sum())


def test_a_block_under_water_is_wet_on_all_but_the_side_that_it_lies_on(block: Candidate) -> None:
    """Five sides of 0.12 m; the bottom lies on the floor."""
    assert float(block.caches["air"].series("steam_area")[1:, 0].mean()) == pytest.approx(5 * SIDE**2, rel=0.03)


def test_lava_beside_water_touches_it_over_their_common_side(lava: Candidate) -> None:
    assert float(lava.caches["air"].series("steam_area")[1, 0]) == pytest.approx(WIDE * DEPTH, rel=0.1)


def test_steam_is_what_the_law_boils_through_that_area(block: Candidate) -> None:
    seconds = (FRAMES - 1) / 24
    heat = boiling_flux(1000.0 - BOILING) * 5 * SIDE**2 * seconds
    assert _last(block, "steam_given") == pytest.approx(heat, rel=0.03)
    assert _last(block, "record/steam_mass") == pytest.approx(heat / steam_heat(293.15), rel=0.03)
    volume = _last(block, "record/steam_mass") / STEAM_DENSITY
    assert float(box_of(block, "air").record("volume_emitted")[-1]) == pytest.approx(volume, rel=1e-6)


def test_the_block_cools_by_what_it_gave(block: Candidate) -> None:
    capacity = 7850.0 * SIDE**3 * 450.0
    cooled = 1000.0 - float(block.caches["air"].series("steam_temperature")[-1, 0])
    assert capacity * cooled == pytest.approx(_last(block, "steam_given"), rel=1e-6)


def test_a_small_thing_gives_all_its_heat_and_no_more(tmp_path: Any) -> None:
    """A light block ends at the temperature of boiling water, and all of its heat is in the steam."""
    document = quench_spec(frames=FRAMES, side=SIDE)
    document["materials"]["steel"]["density"] = 1.0
    world = simulate(tmp_path, WorldSpec.model_validate({"prompt": QUENCH_PROMPT, **document}))
    whole = 1.0 * SIDE**3 * 450.0 * (1000.0 - BOILING)
    assert _last(world, "steam_given") == pytest.approx(whole, rel=1e-9)
    assert _last(world, "steam_temperature") == pytest.approx(BOILING)
    rows = {r.id: r.status for r in category_rows(world, "air")}
    assert rows["category:gas:boiled:air"] == rows["category:gas:quenched:air"] == rows["category:gas:emitted:air"] == "pass"


def test_it_comes_over_the_water(block: Candidate) -> None:
    box = box_of(block, "air")
    frame = box.read(2)
    middle = np.average(frame.centers[frame.soot > 0], axis=0, weights=frame.soot[frame.soot > 0])
    assert np.linalg.norm(middle[:2]) < 0.05
    assert DEPTH < middle[2] < DEPTH + 0.3


@pytest.mark.parametrize("kind", ["block", "lava"])
def test_all_rows_hold(kind: str, request: pytest.FixtureRequest) -> None:
    world = request.getfixturevalue(kind)
    rows = category_rows(world, "air") + numerical_rows(world, "air")
    assert [r.id for r in rows if r.status not in ("pass", "not_applicable")] == []
    assert {r.id for r in rows if r.status == "pass"} >= {
        f"category:gas:{n}:air" for n in ("boiled", "quenched", "above", "kept")
    }


def test_without_its_driver_nothing_boils(lava: Candidate) -> None:
    from worldagent.simulation.protocol import Intervention
    from worldagent.simulation.variants import run_variant

    variant = run_variant(lava, Intervention(without=frozenset({"boils"})), start=0, end=FRAMES - 1)
    data = variant.caches["air"].read(FRAMES - 1, ("gas_soot", "record/steam_mass", "steam_temperature"))
    assert not data["gas_soot"].any()
    assert float(data["record/steam_mass"]) == 0.0
    assert data["steam_temperature"].tolist() == [1400.0]


def test_hot_matter_that_stands_still_before_it_meets_the_water_makes_no_more_steam(tmp_path: Any) -> None:
    """The steam is simulated anew where the liquid is: held lava beside the water does not come to it."""
    from worldagent.simulation.protocol import Intervention
    from worldagent.simulation.variants import run_variant, simulated

    document = lava_spec(frames=6)
    document["entities"]["lava"]["pose"]["position"][2] += 0.3
    world = simulate(tmp_path, WorldSpec.model_validate({"prompt": LAVA_PROMPT, **document}))
    assert _last(world, "steam_area") > 0.0
    variant = run_variant(world, Intervention(held=frozenset({"lava"}), since=0.0), start=0, end=5)
    assert float(variant.caches["air"].read(5, ("steam_area",))["steam_area"].sum()) < 0.2 * _last(world, "steam_area")
    assert set(simulated(variant)) == {"liquid", "air"}


def test_the_gas_comes_after_the_liquid_that_it_reads() -> None:
    spec = _quench()
    assert "liquid" in reads(spec, "air")
    assert bake_order(spec).index("liquid") < bake_order(spec).index("air")
    assert reads(spec, "liquid") == ("bodies",)


def test_what_is_hot_and_the_water_are_told_to_make_it(lava: Candidate) -> None:
    judge = JUDGES["gas"]
    pushes = {(p.a, p.b) for frame in judge.pushes(lava) for p in frame}
    assert pushes == {("lava", "steam"), ("pool", "steam")}
    assert judge.unfelt(lava.spec) == {("steam", "lava"), ("steam", "pool")}


def test_the_register_tells_what_is_left_out(block: Candidate) -> None:
    told = " ".join(line["what"] + line["effect"] for line in JUDGES["gas"].lines(block))
    for words in (
        "keeps the water",
        "cools as a whole",
        "film boiling",
        "balls of 0.1 m",
        "13% of the steam",
        "1000 K for 'boils' alone",
    ):
        assert words in told


CHANGES: dict[str, tuple[str, dict[str, float]]] = {
    "more steam than boils": ("boiled", {"record/steam_mass": 1.01}),
    "more heat than was given": ("quenched", {"steam_given": 1.01}),
    "a larger area": ("boiled", {"steam_area": 1.01}),
    "hot matter that cools too little": ("quenched", {"steam_temperature": 1.00001}),
    "all water boiled off": ("kept", {"record/steam_mass": 1e4}),
}


@pytest.mark.parametrize("name", CHANGES)
def test_a_forged_record_is_found(name: str, block: Candidate, tmp_path: Any) -> None:
    row, factors = CHANGES[name]

    def change(frame: int, data: dict[str, Any]) -> None:
        for channel, factor in factors.items():
            data[channel] = data[channel] * factor

    rows = {r.id: r.status for r in category_rows(edited(block, tmp_path, "air", change), "air")}
    assert rows[f"category:gas:{row}:air"] == "fail"


def test_steam_that_would_come_outside_of_the_box_is_found(block: Candidate) -> None:
    document = quench_spec(frames=FRAMES, side=SIDE)
    document["simulation"]["drivers"]["boils"]["radius"] = 0.6
    spec = WorldSpec.model_validate({"prompt": QUENCH_PROMPT, **document})
    rows = {r.id: r.status for r in category_rows(dataclasses.replace(block, spec=spec), "air")}
    assert rows["category:gas:above:air"] == "pass"
    document["simulation"]["drivers"]["boils"]["radius"] = 1.2
    spec = WorldSpec.model_validate({"prompt": QUENCH_PROMPT, **document})
    rows = {r.id: r.status for r in category_rows(dataclasses.replace(block, spec=spec), "air")}
    assert rows["category:gas:above:air"] == "fail"


REFUSED: dict[str, tuple[dict[str, Any], str, str]] = {
    "not as hot as steam": ({"/entities/steam/physics/temperature": 400.0}, "/entities/steam/physics/temperature", "boils at 373.15 K"),
    "clear": ({"/entities/steam/physics/soot_density": 0.0}, "/entities/steam/physics/soot_density", "above 0 and at most"),
    "more drops than steam": ({"/entities/steam/physics/soot_density": 0.9}, "/entities/steam/physics/soot_density", "at most 0.5956"),
    "with a fuel": ({"/entities/steam/physics/fuel": "wood"}, "/entities/steam/physics/fuel", "does not burn"),
    "no temperature": ({"/simulation/drivers/boils/temperature": None}, "/simulation/drivers/boils/temperature", "380 to 3000 K"),
    "no water": ({"/materials/water/substance": "oil"}, "/materials/water/substance", "only water boils"),
    "hot water": ({"/entities/pool/physics/temperature": 400.0}, "/entities/pool/physics/temperature", "273 to 373.15 K"),
    "water that conducts": ({"/entities/pool/physics/conductivity": 0.6}, "/entities/pool/physics/conductivity", "leave its conductivity at 0"),
    "a thin ball": ({"/simulation/drivers/boils/radius": 0.06}, "/simulation/drivers/boils/radius", "at least 2 cells"),
    "too late": ({"/simulation/drivers/boils/start": 5.0}, "/simulation/drivers/boils/start", "after the last frame"),
    "a gas as what is hot": ({"/simulation/drivers/boils/hot": ["steam"]}, "/simulation/drivers/boils/hot/0", "rigid entities in one piece"),
    "a solid as water": ({"/simulation/drivers/boils/water": ["block"]}, "/simulation/drivers/boils/water/0", "name a liquid"),
    "no gas": ({"/simulation/drivers/boils/entity": "pool"}, "/simulation/drivers/boils/entity", "no gas"),
    "a box beside the water": (
        {"/simulation/solvers/air/settings/domain/center": [0.3, 0.0, 0.6]},
        "/simulation/solvers/air/settings/domain",
        "does not hold the water",
    ),
    "a closed box": ({"/simulation/solvers/air/settings/domain/sides": ["closed"] * 6}, "/simulation/solvers/air/settings/domain/sides", "open side"),
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSED)
def test_the_audit_refuses(name: str) -> None:
    changes, pointer, words = REFUSED[name]
    document = quench_spec()
    for place, value in changes.items():
        *way, last = place.strip("/").split("/")
        at: Any = document
        for step in way:
            at = at[step]
        at[last] = value
    found = {p.pointer: p.text for p in gas_problems(WorldSpec.model_validate({"prompt": QUENCH_PROMPT, **document}))}
    assert words in found[pointer]


def test_the_audit_passes_both_worlds() -> None:
    for prompt, document in ((QUENCH_PROMPT, quench_spec()), (LAVA_PROMPT, lava_spec())):
        assert gas_problems(WorldSpec.model_validate({"prompt": prompt, **document})) == []


def test_lava_in_an_instance_of_its_own_is_refused_since_liquids_of_two_pass_through_each_other() -> None:
    document = lava_spec()
    solvers = document["simulation"]["solvers"]
    solvers["liquid"]["members"] = ["pool"]
    solvers["other"] = {**solvers["liquid"], "members": ["lava"]}
    found = {p.pointer: p.text for p in gas_problems(WorldSpec.model_validate({"prompt": LAVA_PROMPT, **document}))}
    assert "pass through each other" in found["/simulation/drivers/boils/hot/0"]


def test_heat_that_two_drivers_take_is_refused() -> None:
    document = lava_spec()
    drivers = document["simulation"]["drivers"]
    drivers["again"] = dict(drivers["boils"])
    found = {p.pointer: p.text for p in gas_problems(WorldSpec.model_validate({"prompt": LAVA_PROMPT, **document}))}
    assert "is there once" in found["/simulation/drivers/again/hot/0"]


def test_a_picture_of_lava_in_steam_follows_its_guides(lava: Candidate) -> None:
    """The scene without the gas shares the light of the lava with the picture: when it was gone, the next picture ended the process."""
    camera = Camera(np.array([-1.6, -1.6, 1.2]), np.array([0.0, 0.0, 0.2]), 40.0, 48, 27)
    scene = SceneRenderer(lava, frame=FRAMES - 1)
    for frame in (FRAMES - 2, FRAMES - 1):
        scene.pose(frame)
        scene.features(camera)
        assert np.isfinite(scene.radiance(camera, 2)).all()
