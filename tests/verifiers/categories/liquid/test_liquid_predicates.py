"""Predicates about liquids on caches written by hand, against what the motion is known to do."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pydantic import ValidationError
from worldagent.testing.defects import _liquid_scenes as scenes
from worldagent.testing.worlds import small_worlds as sw
from worldagent.testing.worlds.liquid_worlds import Flow, stream
from worldagent.tests.verifiers.agreement import evaluate
from worldagent.verifiers.predicates.outcome import Outcome
from worldagent.worlds.predicates import (
    LiquidArrives,
    LiquidFluxThrough,
    LiquidLevelAt,
    LiquidSpeed,
    LiquidTemperature,
    LiquidVolumeIn,
    SplashHeight,
    SubmergedFraction,
    WetArea,
    entities_of,
)
from worldagent.worlds.spec import BoxRegion, SceneGraph, SpecModel

S = scenes.SPACING
G = 9.81


def rng() -> np.random.Generator:
    return np.random.default_rng(3)


def with_region(flow: Flow, low: tuple[float, ...], high: tuple[float, ...]) -> Flow:
    graph = SceneGraph(regions={"there": BoxRegion(min=low, max=high)})
    return flow.edited(spec=flow.spec.model_copy(update={"graph": graph}))


def judged(flow: Flow, folder: Path, predicate: SpecModel, frames: tuple[int, int] | None = None) -> Outcome:
    candidate = flow.candidate(folder)
    return evaluate(candidate, predicate, frames or (0, flow.frames - 1))


def test_volume_in_a_region_is_that_of_the_particles_there(tmp_path: Path) -> None:
    """The left half of a pool holds half of it, at every frame."""
    flow = scenes.pool(rng())
    half = flow.volume * float((flow.position[0][:, 0] < 0).sum())
    flow = with_region(flow, (-9, -9, -9), (0, 9, 9))
    found = judged(flow, tmp_path, LiquidVolumeIn(entity="pool", region="there", min=0.99 * half, max=1.01 * half, when="always"))
    assert found.status == "pass"
    assert found.value == pytest.approx(half, rel=1e-6)
    assert judged(flow, tmp_path / "b", LiquidVolumeIn(entity="pool", region="there", min=1.1 * half)).status == "fail"


def test_level_is_half_a_particle_above_the_highest_middle(tmp_path: Path) -> None:
    flow = scenes.pool(rng())
    depth = float(flow.position[0][:, 2].max()) + 0.5 * S
    found = judged(
        flow, tmp_path, LiquidLevelAt(entity="pool", point=(0.0, 0.0), min=depth - 1e-3, max=depth + 1e-3, when="always")
    )
    assert (found.status, found.value) == ("pass", pytest.approx(depth, abs=1e-6))
    dry = judged(flow, tmp_path / "b", LiquidLevelAt(entity="pool", point=(5.0, 0.0), min=0.0))
    assert dry.status == "fail"
    assert dry.value == pytest.approx(
        float(
            flow.spec.simulation.liquid["water"].settings.domain.center[2]
            - flow.spec.simulation.liquid["water"].settings.domain.size[2] / 2
        )
    )


def test_level_of_swaying_water_rises_and_falls_by_its_amplitude(tmp_path: Path) -> None:
    flow = scenes.slosh(rng(), amplitude=0.006)
    edge = float(flow.position[0][:, 0].min())
    heights = [float(p[np.abs(p[:, 0] - edge) < 2.5 * S, 2].max()) + 0.5 * S for p in flow.position]
    found = judged(flow, tmp_path, LiquidLevelAt(entity="pool", point=(edge, 0.0), min=max(heights) - 1e-3))
    assert found.first_true_frame == int(np.argmax(np.array(heights) >= max(heights) - 1e-3))


def test_flux_through_a_disc_is_what_an_inflow_lets_in(tmp_path: Path) -> None:
    """A stream that falls freely: what left the tap a fall's time ago passes the disc now."""
    flow = stream(speed=1.0, height=0.8)
    fall = (-1.0 + np.sqrt(1.0 + 2 * G * 0.4)) / G
    passed = 0.08 * 0.08 * (1.0 * (23 / 24 - fall)) + 0.08 * 0.08 * 0.04
    disc = LiquidFluxThrough(
        entity="pool", point=(0, 0, 0.4), normal=(0, 0, -1), radius=0.2, min=0.9 * passed, max=1.1 * passed, when="end"
    )
    found = judged(flow, tmp_path, disc)
    assert found.status == "pass", found.explanation
    rate = disc.model_copy(update={"measure": "rate", "min": 0.5 * 0.0064, "max": None, "when": "eventually"})
    assert judged(flow, tmp_path / "b", rate).unit == "m^3/s"
    against = disc.model_copy(update={"normal": (0, 0, 1), "min": None, "max": -0.9 * passed})
    assert judged(flow, tmp_path / "c", against).status == "pass"
    beside = disc.model_copy(update={"point": (0.5, 0, 0.4), "radius": None, "size": (0.3, 0.3)})
    assert judged(flow, tmp_path / "d", beside).value == pytest.approx(0.0)


def test_liquid_arrives_when_it_has_fallen_so_far(tmp_path: Path) -> None:
    """Free fall from rest: half g t^2."""
    flow = scenes.block((0.12, 0.12, 0.12), (0, 0, 2.0), frames=16)
    low = float(flow.position[0][:, 2].min())
    flow = with_region(flow, (-1, -1, 0), (1, 1, 1.5))
    found = judged(flow, tmp_path, LiquidArrives(entity="pool", region="there"))
    assert found.first_true_frame == int(np.ceil(24 * np.sqrt(2 * (low - 1.5) / G)))
    all_of_it = LiquidArrives(entity="pool", region="there", min_volume=0.12**3 * 0.999)
    assert int(judged(flow, tmp_path / "b", all_of_it).first_true_frame or 0) > int(found.first_true_frame or 99)
    never = judged(flow, tmp_path / "c", LiquidArrives(entity="pool", target="ground"))
    assert never.status == "fail"


def test_liquid_arrives_at_a_body_that_it_falls_on(tmp_path: Path) -> None:
    flow = stream(others={"post": sw.box(0.1, 0.1, 0.2, at=(0.0, 0.0, 0.1))})
    found = judged(flow, tmp_path, LiquidArrives(entity="pool", target="post"))
    fall = 0.8 - 0.04 - 0.2 - S
    assert found.status == "pass"
    assert found.first_true_frame == pytest.approx(24 * (-1 + np.sqrt(1 + 2 * G * fall)) / G, abs=1.5)


@pytest.mark.parametrize("density", [1000 / 6, 500.0, 5000 / 6])
def test_a_floating_crate_is_submerged_by_its_density_ratio(tmp_path: Path, density: float) -> None:
    flow = scenes.crate_afloat(rng(), density=density)
    found = judged(flow, tmp_path, SubmergedFraction(entity="crate", liquid="pool", min=0.0, max=1.0, when="always"))
    assert found.value == pytest.approx(density / 1000, abs=0.03)


def test_what_stands_beside_the_water_is_dry(tmp_path: Path) -> None:
    flow = scenes.pool(rng(), others={"box": sw.box(0.1, 0.1, 0.1, at=(2, 0, 0))})
    assert judged(flow, tmp_path, SubmergedFraction(entity="box", liquid="pool", max=0.0, when="always")).status == "pass"
    assert judged(flow, tmp_path / "b", WetArea(entity="box", liquid="pool", max=0.0, when="always")).status == "pass"


def test_wet_area_of_a_tank_is_its_floor_and_sides_up_to_the_level(tmp_path: Path) -> None:
    flow = scenes.pool(rng())
    size = np.ptp(flow.position[0], axis=0) + S
    wanted = size[0] * size[1] + 2 * (size[0] + size[1]) * size[2]
    found = judged(flow, tmp_path, WetArea(entity="tank", liquid="pool", min=0.9 * wanted, max=1.3 * wanted, when="always"))
    assert found.status == "pass", found.explanation


def test_wet_area_remembers_what_was_touched(tmp_path: Path) -> None:
    flow = stream(others={"post": sw.box(0.02, 0.3, 0.2, at=(0.055, 0.0, 0.5))}, frames=24)
    last = flow.frames - 1
    gone = flow.edited()
    gone.position[last], gone.velocity[last], gone.identity[last] = (
        x[last][:0] for x in (gone.position, gone.velocity, gone.identity)
    )
    now = judged(gone, tmp_path / "a", WetArea(entity="post", liquid="pool", measure="now", min=1e-4, when="end"))
    ever = judged(gone, tmp_path / "b", WetArea(entity="post", liquid="pool", measure="ever", min=1e-4, when="end"))
    assert (now.status, ever.status) == ("fail", "pass")


def test_splash_height_needs_more_than_a_few_drops(tmp_path: Path) -> None:
    flow = scenes.pool(rng())
    few, many = flow.edited(), flow.edited()
    top = np.argsort(flow.position[0][:, 2])[::-1]
    few.position[5][top[:7], 2] += 0.3
    many.position[5][top[:8], 2] += 0.3
    splash = SplashHeight(entity="pool", min=0.25)
    assert judged(few, tmp_path / "a", splash).status == "fail"
    found = judged(many, tmp_path / "b", splash)
    assert (found.status, found.first_true_frame, found.value) == ("pass", 5, pytest.approx(0.3, abs=1e-6))


def test_speed_is_the_mean_by_mass_or_the_largest(tmp_path: Path) -> None:
    flow = scenes.falling(rng())
    last = flow.frames - 1
    found = judged(flow, tmp_path, LiquidSpeed(entity="pool", min=G * last / 24 * 0.999))
    assert (found.status, found.first_true_frame) == ("pass", last)
    assert (
        judged(flow, tmp_path / "b", LiquidSpeed(entity="pool", measure="largest", max=0.1, when="always")).first_failing_frame
        == 1
    )


def test_temperature_is_recorded_or_the_row_stays_open(tmp_path: Path) -> None:
    flow = scenes.pool(rng())
    bare = judged(flow, tmp_path / "a", LiquidTemperature(entity="pool", min=280))
    assert bare.status == "unverified"
    heat: dict[Any, Any] = {}
    for k in range(flow.frames):
        heat[k, "particle/temperature"] = np.linspace(300 + k, 320 + k, len(flow.position[k])).astype(np.float32)
    warm = flow.edited(change=heat)
    for measure, value in (("mean", 310 + 17), ("lowest", 300 + 17), ("highest", 320 + 17)):
        found = judged(warm, tmp_path / measure, LiquidTemperature(entity="pool", measure=measure, min=200, when="end"))
        assert found.value == pytest.approx(value, abs=1e-3)


LIQUID = [
    LiquidVolumeIn(entity="paint", region="there", min=0.0),
    LiquidLevelAt(entity="paint", point=(0, 0), min=-9),
    LiquidFluxThrough(entity="paint", point=(0, 0, 0), normal=(0, 0, 1), radius=1.0, min=-9),
    LiquidArrives(entity="paint", region="there"),
    SubmergedFraction(entity="tank", liquid="paint", min=0.0),
    WetArea(entity="tank", liquid="paint", min=0.0),
    SplashHeight(entity="paint", min=-9),
    LiquidSpeed(entity="paint", min=0.0),
    LiquidTemperature(entity="paint", min=0.0),
]


@pytest.mark.parametrize("predicate", LIQUID, ids=[str(p.kind) for p in LIQUID])  # type: ignore[attr-defined]
def test_painted_water_meets_no_predicate(tmp_path: Path, predicate: SpecModel) -> None:
    """A static slab called water, however easy the bound."""
    slab = sw.box(0.4, 0.4, 0.02, at=(1, 0, 0)).model_copy(update={"role": "water of a pond"})
    flow = with_region(scenes.pool(rng(), others={"paint": slab}), (-9, -9, -9), (9, 9, 9))
    found = judged(flow, tmp_path, predicate)
    assert (found.status, found.details.get("painted")) == ("fail", True)
    assert "no evidence of a liquid" in found.explanation


def test_predicates_name_the_liquids_and_bodies_they_speak_of() -> None:
    assert entities_of(SubmergedFraction(entity="log", liquid="river", min=0.1)) == ("log", "river")
    assert entities_of(LiquidArrives(entity="river", target="house")) == ("river", "house")


@pytest.mark.parametrize(
    ("kind", "fields"),
    [(LiquidFluxThrough, {"entity": "w", "point": (0, 0, 0), "normal": (0, 0, 1), "min": 1}),
     (LiquidFluxThrough, {"entity": "w", "point": (0, 0, 0), "normal": (0, 0, 0), "radius": 1, "min": 1}),
     (LiquidArrives, {"entity": "w"}), (LiquidArrives, {"entity": "w", "region": "r", "target": "t"}),
     (LiquidLevelAt, {"entity": "w", "point": (0, 0)}), (SplashHeight, {"entity": "w", "min": 2, "max": 1})],
)  # fmt: skip
def test_half_said_predicates_are_refused(kind: type[SpecModel], fields: dict[str, Any]) -> None:
    with pytest.raises(ValidationError):
        kind(**fields)
