"""A ball that hits the floor under water, or in wind: the law of the contact is told from what pushes it meanwhile."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from worldagent.testing.worlds.simulated_worlds import edited, simulate
from worldagent.testing.worlds.small_liquids import PROMPT, tank_spec
from worldagent.verifiers.categories.rigid import check as rigid
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.patch import parse_spec
from worldagent.worlds.requirements import Row

RADIUS, KEPT = 0.06, 0.6
FRAMES = 7


def sinking_ball(density: float = 7800.0, high: float = 0.2, radius: float = RADIUS, frames: int = FRAMES) -> dict[str, Any]:
    """A ball, of iron as it is, in or over water over the floor of a tank."""
    spec = tank_spec(frames=frames, spacing=0.04, depth=0.16, crate_at=high)
    ball = spec["entities"].pop("crate")
    shape = {"body": {"shape": {"kind": "sphere", "radius": radius}}}
    spec["entities"]["ball"] = {**ball, "material": "iron", "dimensions": {"size": [2 * radius] * 3}, "parts": shape}
    spec["materials"]["iron"] = {"density": density, "friction": 0.3, "restitution": KEPT}
    spec["materials"]["stone"]["restitution"] = 0.95
    spec["simulation"]["solvers"]["rigid"]["members"] = ["tank", "ball"]
    for beat in spec["story"]["beats"].values():
        beat["subject"] = beat["predicate"]["entity"] = "ball"
    return spec


@pytest.fixture(scope="module")
def sunk(tmp_path_factory: pytest.TempPathFactory) -> Candidate:
    return simulate(tmp_path_factory.mktemp("sunk"), parse_spec({"prompt": PROMPT, **sinking_ball()}))


def row_of(candidate: Candidate, name: str = "restitution") -> Row:
    return next(r for r in rigid.category_rows(candidate, "rigid") if r.id == f"category:rigid:{name}:rigid")


def test_a_ball_that_bounces_under_water_keeps_what_its_contact_says(sunk: Candidate) -> None:
    row = row_of(sunk)
    (hit,) = row.evidence["hits"]
    assert row.status == "pass"
    assert hit["kept"] == pytest.approx((KEPT, KEPT), abs=0.02)
    at = hit["frame"]
    pushed = sunk.caches["rigid"].read(at)["exchange/impulse"][-1, 2]
    assert pushed > 0.1  # the water's push is not small against the bound


@pytest.mark.parametrize("declared", [0.5, 0.7])
def test_a_ball_that_keeps_other_than_declared_is_told_under_water(sunk: Candidate, declared: float) -> None:
    other = sunk.spec.materials["iron"].model_copy(update={"restitution": declared})
    spec = sunk.spec.model_copy(update={"materials": {**sunk.spec.materials, "iron": other}})
    row = row_of(replace(sunk, spec=spec))
    assert (row.status, row.first_failing_entity) == ("fail", "ball")
    assert row.measured == pytest.approx(0.1, abs=0.02)


def test_a_closing_speed_that_the_water_cannot_have_left_is_told(sunk: Candidate, tmp_path: Path) -> None:
    """A log that makes a hit look as declared: what it kept of another speed."""

    def slower(frame: int, data: dict[str, Any]) -> None:
        data["event/speed"] = data["event/speed"] * 0.6

    assert row_of(edited(sunk, tmp_path, "rigid", slower)).status == "fail"


@pytest.mark.slow
def test_water_that_turns_round_within_a_frame_moves_a_light_ball_as_it_may(tmp_path: Path) -> None:
    """After a hit the water pushes up and then down, by as much: nothing of it is left in the frame's sum."""
    spec = sinking_ball(density=2700.0, high=0.3, radius=0.05, frames=14)
    light = simulate(tmp_path, parse_spec({"prompt": PROMPT, **spec}))
    assert row_of(light, "motion").status == "pass"

    def aside(frame: int, data: dict[str, Any]) -> None:
        data["position"][-1, 0] += 0.03 if frame == 8 else 0.0

    assert row_of(edited(light, tmp_path / "aside", "rigid", aside), "motion").status == "fail"
