"""Parts and gaps that a liquid's spacing does not resolve are told before anything runs, and only where the liquid can get to (R58)."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import pytest
from worldagent.construction.build import build_entity
from worldagent.simulation.liquid.scene import build_scene
from worldagent.testing.worlds.small_liquids import PROMPT, tank_spec
from worldagent.worlds.audits.audit import AuditReport, audit
from worldagent.worlds.categories.liquid.reach import own_reach
from worldagent.worlds.errors import InputError
from worldagent.worlds.patch import parse_spec
from worldagent.worlds.spec import WorldSpec

DRY, WET, ABOVE = 0.45, 0.1, 0.7
"""Heights of a plank over the water's surface at 0.2 m, below it, and over the domain [m]."""


def with_plank(
    thick: float,
    height: float,
    *,
    size: tuple[float, float] = (0.2, 0.1),
    motion: str = "static",
    collides: bool = True,
    **tank: Any,
) -> WorldSpec:
    """A tank with a level plank in it or over it."""
    spec = tank_spec(**{"crate_at": None, "coupled": False, **tank})
    box = [*size, thick]
    spec["entities"]["pier"] = {
        "role": "pier", "motion": motion, "material": "stone", "dimensions": {"size": box}, "pose": {"position": [0, 0, height]},
        "parts": {"plank": {"shape": {"kind": "box", "size": box}, "collides": collides}},
    }  # fmt: skip
    if motion == "kinematic":
        keys = {"a": {"time": 0, "pose": {"position": [0, 0, height]}}, "b": {"time": 1, "pose": {"position": [0, 0, WET]}}}
        spec["simulation"]["drivers"] = {"dip": {"kind": "path", "entity": "pier", "keys": keys}}
    spec["simulation"]["solvers"]["rigid"]["members"].append("pier")
    return parse_spec({**spec, "prompt": PROMPT})


def problems(report: AuditReport) -> list[str]:
    """Problems of the row about liquids."""
    row = next(r for r in report.rows if r.id == "audit:liquids")
    return list(row.evidence.get("problems", ()))


def refusal(spec: WorldSpec, folder: Path) -> str:
    """Text with which setting the liquid up is refused; empty where it is not."""
    try:
        build_scene(spec, {n: build_entity(spec, n, folder) for n in spec.entities}, "water")
    except InputError as error:
        return str(error)
    return ""


@pytest.mark.parametrize(("engine", "least"), [("dfsph", 0.0125), ("flip", 0.025)])
def test_a_wet_part_that_is_too_thin_is_told_by_part_place_and_thickness(engine: str, least: float, tmp_path: Path) -> None:
    spec = with_plank(0.008, WET, engine=engine)
    (told,) = problems(audit(spec))
    assert told.startswith(
        "/entities/pier/parts/plank/shape: pier/plank at [-0.1, -0.05, 0.096] to [0.1, 0.05, 0.104] m is 0.008 m thick"
    )
    assert f"make it at least {least:g} m thick" in told
    assert "'pier' is 0.008 m thick about [0, 0, 0.1] m" in refusal(spec, tmp_path)


@pytest.mark.parametrize("height", [DRY, ABOVE])
def test_a_thin_part_over_the_water_is_neither_told_nor_refused(height: float, tmp_path: Path) -> None:
    spec = with_plank(0.008, height)
    report = audit(spec)
    assert problems(report) == []
    assert report.warnings == ()
    assert refusal(spec, tmp_path) == ""


def test_a_part_that_is_thick_enough_is_not_told(tmp_path: Path) -> None:
    spec = with_plank(0.02, WET)
    assert problems(audit(spec)) == []
    assert refusal(spec, tmp_path) == ""


def test_a_thin_part_that_does_not_collide_is_not_told(tmp_path: Path) -> None:
    spec = with_plank(0.008, WET, collides=False)
    assert problems(audit(spec)) == []
    assert refusal(spec, tmp_path) == ""


def test_a_thin_part_to_which_a_falling_crate_may_throw_water_is_warned_of(tmp_path: Path) -> None:
    spec = with_plank(0.008, DRY, crate_at=0.6)
    report = audit(spec)
    assert problems(report) == []
    (told,) = report.warnings
    assert "pier/plank" in told
    assert "by itself it rises to 0.2 m" in told
    assert refusal(spec, tmp_path) == ""
    assert audit(with_plank(0.008, DRY, crate_at=0.26)).warnings == (), "from there it lifts nothing so high"


def test_thin_parts_of_one_entity_that_water_may_be_thrown_to_are_one_warning() -> None:
    """The digits on eight doors made sixty-nine, which hid all others."""
    spec = with_plank(0.008, DRY, crate_at=0.6)
    pier = spec.entities["pier"]
    plank = pier.parts["plank"]
    thinner = plank.model_copy(update={"shape": plank.shape.model_copy(update={"size": (0.2, 0.1, 0.004)})})
    more = pier.model_copy(update={"parts": {"plank": plank, "slat": thinner, "other": plank}})
    (told,) = audit(spec.model_copy(update={"entities": {**spec.entities, "pier": more}})).warnings
    assert told.startswith("/entities/pier/parts/slat/shape: ")
    assert "2 more of its parts are too thin there" in told


def test_a_thin_part_on_a_path_is_told_wherever_it_starts(tmp_path: Path) -> None:
    spec = with_plank(0.008, DRY, motion="kinematic")
    (told,) = problems(audit(spec))
    assert "its path may bring it into the liquid of 'water'" in told
    assert "0.008 m thick" in refusal(spec, tmp_path)


def test_a_liquid_rises_by_its_speed_and_nowhere_ends_without_gravity() -> None:
    spec = with_plank(0.008, DRY)
    assert own_reach(spec, "water") == pytest.approx(0.2)
    water = spec.entities["water"]
    fast = water.model_copy(update={"physics": water.physics.model_copy(update={"linear_velocity": (3.0, 0.0, 0.0)})})
    thrown = spec.model_copy(update={"entities": {**spec.entities, "water": fast}})
    assert own_reach(thrown, "water") == pytest.approx(0.2 + 9.0 / 2 / 9.81)
    assert problems(audit(thrown))
    weightless = spec.model_copy(update={"simulation": spec.simulation.model_copy(update={"gravity": (0.0, 0.0, 0.0)})})
    assert own_reach(weightless, "water") == math.inf


def gap(width: float, *, height: float | None = None, size: tuple[float, float] = (0.36, 0.36)) -> tuple[str, ...]:
    """Warnings about a plate so far above the floor of a tank, or at another height [m]."""
    thick = 0.05
    return audit(with_plank(thick, (width if height is None else height) + thick / 2, size=size)).warnings


def test_a_gap_under_a_body_that_the_spacing_does_not_carry_is_told_with_its_width() -> None:
    (told,) = gap(0.05)
    assert "the gap between" in told
    assert "tank/bottom" in told
    assert "pier/plank" in told
    assert "is 0.05 m wide, 2 spacings of 0.025 m" in told
    assert "Use a resolution of at most 0.0167 m, make it 0.075 m wide, or close it" in told


def test_a_gap_that_is_carried_closed_short_or_dry_is_not_told() -> None:
    assert gap(0.08) == ()
    assert gap(0.0) == ()
    assert gap(0.05, size=(0.1, 0.1)) == (), "water comes at it from all sides"
    dry = tank_spec(crate_at=None, coupled=False)
    for name, height in (("low", 0.3), ("high", 0.38)):
        box = [0.36, 0.36, 0.03]
        dry["entities"][name] = {
            "role": name, "motion": "static", "material": "stone", "dimensions": {"size": box}, "pose": {"position": [0, 0, height]},
            "parts": {"body": {"shape": {"kind": "box", "size": box}}},
        }  # fmt: skip
        dry["simulation"]["solvers"]["rigid"]["members"].append(name)
    assert audit(parse_spec({**dry, "prompt": PROMPT})).warnings == ()
    dry["entities"]["water"]["dimensions"]["size"][2] = dry["entities"]["water"]["parts"]["body"]["shape"]["size"][2] = 0.4
    dry["entities"]["water"]["pose"]["position"][2] = 0.2
    assert len(audit(parse_spec({**dry, "prompt": PROMPT})).warnings) == 1, "the same gap under water"


def still(spacing: float, **tank: Any) -> tuple[str, ...]:
    """Warnings about still water, in a domain with closed sides 0.24 m apart."""
    return audit(
        parse_spec({**tank_spec(crate_at=None, coupled=False, spacing=spacing, **{"closed": True, **tank}), "prompt": PROMPT})
    ).warnings


@pytest.mark.parametrize("spacing", [0.24 / 4.5, 0.24 / 5.5, 0.24 / 6.5, 0.24 / 7.5])
def test_a_pool_that_is_no_whole_number_of_spacings_wide_is_told_with_resolutions_that_fit(spacing: float) -> None:
    told = [w for w in still(spacing) if "particles lie" in w]
    assert len(told) == 2, "along x and along y"
    assert told[0].startswith(
        "/entities/water/physics/resolution: 'water' is 0.24 m wide between the closed sides of 'water' along x"
    )
    for part in told[0].split("Use a resolution of ")[1].split(", or a width")[0].split(" or "):
        assert still(float(part.removesuffix(" m"))) == ()


def test_a_pool_that_fits_is_nearly_whole_free_above_or_between_solids_is_not_told() -> None:
    assert still(0.24 / 5) == ()
    assert still(0.24 / 9.49) == ()
    assert still(0.24 / 5, depth=0.24 / 5 * 4.4) == ()
    assert still(0.4 / 7.5, closed=False) == ()
