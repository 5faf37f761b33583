"""Floats and sinks: what carries the body decides, on motions in closed form whose impulses are known."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from worldagent.testing.worlds.bodies_in_liquid import EDGE, crate_in_tank
from worldagent.testing.worlds.liquid_worlds import Flow, G
from worldagent.tests.verifiers.agreement import evaluate
from worldagent.verifiers.predicates.outcome import Outcome
from worldagent.worlds.categories.liquid.events import FloatEvent, SinkEvent
from worldagent.worlds.predicates.registry import is_invariant

FRAMES = 18
AFLOAT = 0.2
"""Height of the middle of a crate of half the water's density: that of the surface [m]."""
FLOATS = FloatEvent(kind="floats", entity="crate", other="pool")
LASTS = FloatEvent(kind="floats", entity="crate", other="pool", when="always")
SINKS = SinkEvent(kind="sinks", entity="crate", other="pool")
BOBS = SinkEvent(kind="bobs", entity="crate", other="pool")
KINDS: dict[str, FloatEvent | SinkEvent] = {"floats": FLOATS, "sinks": SINKS, "bobs": BOBS}


def judged(flow: Flow, folder: Path, event: FloatEvent | SinkEvent) -> Outcome:
    return evaluate(flow.candidate(folder), event, (0, flow.frames - 1))


def still(height: float, frames: int = FRAMES) -> np.ndarray:
    return np.full(frames, height)


def sunk(share: float, frames: int = FRAMES, start: float = 0.3, stop: float = 0.05) -> np.ndarray:
    """Heights of a crate that goes down at a share of free fall until it lies at `stop`."""
    fall = start - 0.5 * share * G * (np.arange(frames) / 24) ** 2
    return np.maximum(fall, stop)


def test_a_crate_at_its_draft_floats(tmp_path: Path) -> None:
    found = judged(crate_in_tank(still(AFLOAT)), tmp_path, FLOATS)
    assert (found.status, found.unit, found.value) == ("pass", "1", pytest.approx(1.0, abs=0.02)), found.explanation
    assert found.first_true_frame == 12
    assert judged(crate_in_tank(still(AFLOAT)), tmp_path / "b", SINKS).status == "fail"


def test_a_crate_that_has_just_fallen_in_does_not_float_yet(tmp_path: Path) -> None:
    """Its impact gives as much as half a second's weight; until then it was in the air."""
    k = np.arange(FRAMES)
    z = np.where(k < 10, AFLOAT + 0.5 * G * ((10 / 24) ** 2 - (k / 24) ** 2), AFLOAT)
    found = judged(crate_in_tank(z), tmp_path, FLOATS)
    assert (found.status, found.bound, found.value) == ("fail", 0.9, pytest.approx(0.67, abs=0.1)), found.explanation


def test_a_stone_that_falls_in_and_comes_to_a_shallow_bottom_sinks(tmp_path: Path) -> None:
    """It gets under on its way, and lies there half of its height under the surface."""
    z = np.maximum(0.3 - 0.4 * np.arange(FRAMES) / 24, 0.05)
    flow = crate_in_tank(z, density=2500.0, depth=0.15, tank_share=np.where(z <= 0.05 + 1e-9, 0.6, 0.0))
    found = judged(flow, tmp_path, SINKS)
    assert (found.status, found.bound, found.value) == ("pass", 0.5, pytest.approx(1.0, abs=0.15)), found.explanation


def test_a_crate_that_bobs_floats(tmp_path: Path) -> None:
    z = AFLOAT + 0.01 * np.sin(2 * np.pi * np.arange(FRAMES) / 12)
    assert judged(crate_in_tank(z), tmp_path, FLOATS).status == "pass"


def bobbing(size: float, frames: int = 30) -> np.ndarray:
    """Heights about its draft, with a period of half a second."""
    return AFLOAT + size * np.sin(2 * np.pi * np.arange(frames) / 12)


def test_a_crate_that_goes_up_and_down_in_water_bobs(tmp_path: Path) -> None:
    found = judged(crate_in_tank(bobbing(0.005)), tmp_path, BOBS)
    assert (found.status, found.unit, found.value) == ("pass", "1", 5.0), found.explanation
    assert judged(crate_in_tank(bobbing(0.005)), tmp_path / "b", BOBS.model_copy(update={"min": 6.0})).status == "fail"


@pytest.mark.parametrize("frames", [30, 60])
def test_a_crate_that_lies_still_or_shivers_in_water_does_not_bob(tmp_path: Path, frames: int) -> None:
    for name, heights in (("still", still(AFLOAT, frames)), ("shivers", bobbing(0.0004, frames))):
        found = judged(crate_in_tank(heights), tmp_path / name, BOBS)
        assert (found.status, found.value) == ("fail", 0.0), found.explanation


def test_a_crate_that_a_rope_moves_up_and_down_does_not_bob(tmp_path: Path) -> None:
    found = judged(crate_in_tank(bobbing(0.005), density=2000.0, other_share=0.75), tmp_path, BOBS)
    assert (found.status, found.value) == ("fail", pytest.approx(0.25, abs=0.05)), found.explanation


def test_a_crate_that_sinks_or_comes_up_once_does_not_bob(tmp_path: Path) -> None:
    down = judged(crate_in_tank(sunk(0.4, 30), density=2500.0, depth=0.4), tmp_path / "down", BOBS)
    rising = np.minimum(0.1 + 0.01 * np.arange(30), AFLOAT)
    up = judged(crate_in_tank(rising), tmp_path / "up", BOBS)
    assert [down.status, up.status] == ["fail", "fail"]


def test_a_crate_floats_always_where_it_floats_over_every_half_second(tmp_path: Path) -> None:
    found = judged(crate_in_tank(still(AFLOAT)), tmp_path, LASTS)
    assert (found.status, found.first_true_frame, found.value) == ("pass", 0, pytest.approx(1.0, abs=0.02)), found.explanation
    assert is_invariant(LASTS)
    assert not is_invariant(FLOATS)


def test_a_crate_that_falls_in_and_then_floats_does_so_in_the_end_and_not_always(tmp_path: Path) -> None:
    k = np.arange(36)
    z = np.where(k < 6, AFLOAT + 0.5 * G * ((6 / 24) ** 2 - (k / 24) ** 2), AFLOAT)
    assert judged(crate_in_tank(z), tmp_path, FLOATS).status == "pass"
    found = judged(crate_in_tank(z), tmp_path / "b", LASTS)
    assert (found.status, found.first_failing_frame) == ("fail", 12), found.explanation


def test_whether_it_lasts_takes_more_than_half_a_second(tmp_path: Path) -> None:
    found = judged(crate_in_tank(still(AFLOAT, 12)), tmp_path, LASTS)
    assert found.status == "unverified"
    assert "more than 0.5 s" in found.explanation


def test_a_crate_that_stands_on_the_bottom_does_not_float(tmp_path: Path) -> None:
    """Half of its weight is borne by the floor, whatever the water gives."""
    flow = crate_in_tank(still(EDGE / 2), density=900.0, depth=0.04, tank_share=0.56)
    found = judged(flow, tmp_path, FLOATS)
    assert (found.status, found.value) == ("fail", pytest.approx(0.44, abs=0.02))
    assert found.details["others"]["tank"] == pytest.approx(0.56, abs=0.02)


def test_a_crate_that_hangs_on_a_rope_does_not_float(tmp_path: Path) -> None:
    found = judged(crate_in_tank(still(AFLOAT), density=2000.0, other_share=0.75), tmp_path, FLOATS)
    assert (found.status, found.value) == ("fail", pytest.approx(0.25, abs=0.02))


def test_a_crate_whose_push_is_a_record_that_it_never_got_does_not_float(tmp_path: Path) -> None:
    flow = crate_in_tank(still(AFLOAT))
    flow.rigid["exchange/impulse"] = 0.3 * flow.rigid["exchange/impulse"]
    assert judged(flow, tmp_path, FLOATS).status == "fail"


def test_a_crate_that_goes_down_at_the_speed_at_which_drag_carries_it_does_not_float(tmp_path: Path) -> None:
    """Water carries all of its weight, and it sinks."""
    z = 0.33 - 0.3 * np.arange(FRAMES) / 24
    flow = crate_in_tank(z, density=1500.0, depth=0.4)
    found = judged(flow, tmp_path, FLOATS)
    assert (found.status, found.details["frame"]) == ("fail", found.details["span"][1])
    assert found.value == pytest.approx(12 * 0.3 / 24 / EDGE, abs=0.01)
    assert judged(flow, tmp_path / "b", SINKS).status == "pass"


def test_a_heavy_crate_that_goes_down_to_the_bottom_sinks(tmp_path: Path) -> None:
    found = judged(crate_in_tank(sunk(0.4), density=2500.0, depth=0.4), tmp_path, SINKS)
    assert found.status == "pass", found.explanation
    assert found.value == pytest.approx(2.5, abs=0.4)
    more = SINKS.model_copy(update={"min": 4.0})
    assert judged(crate_in_tank(sunk(0.4), density=2500.0, depth=0.4), tmp_path / "b", more).status == "fail"


def test_in_shallow_water_half_of_its_height_to_the_bottom_is_enough(tmp_path: Path) -> None:
    z = sunk(0.3, start=0.13, stop=0.05)
    landed = z <= 0.05 + 1e-9
    flow = crate_in_tank(z, density=2500.0, depth=0.2, tank_share=np.where(landed, 0.6, 0.0))
    found = judged(flow, tmp_path, SINKS)
    assert (found.status, found.bound) == ("pass", 0.5), found.explanation
    floating = crate_in_tank(z, density=2500.0, depth=0.2)
    assert judged(floating, tmp_path / "b", SINKS).status == "fail"


def test_a_light_crate_that_a_hand_pushes_down_does_not_sink(tmp_path: Path) -> None:
    flow = crate_in_tank(0.33 - 0.3 * np.arange(FRAMES) / 24, density=500.0, depth=0.4, other_share=-1.0)
    found = judged(flow, tmp_path, SINKS)
    assert (found.status, found.comparison, found.value) == ("fail", ">=", pytest.approx(0.5))


def test_a_stone_that_a_rope_lets_down_does_not_sink(tmp_path: Path) -> None:
    flow = crate_in_tank(0.33 - 0.3 * np.arange(FRAMES) / 24, density=2000.0, depth=0.4, other_share=0.5)
    found = judged(flow, tmp_path, SINKS)
    assert (found.status, found.comparison, found.value) == ("fail", "<=", pytest.approx(0.5, abs=0.03))


@pytest.mark.parametrize("kind", ["floats", "sinks", "bobs"])
def test_a_crate_at_rest_on_the_bottom_throughout_neither_floats_nor_sinks(kind: str, tmp_path: Path) -> None:
    flow = crate_in_tank(still(EDGE / 2), density=2000.0, depth=0.2, tank_share=0.5)
    assert judged(flow, tmp_path, KINDS[kind]).status == "fail"


@pytest.mark.parametrize("kind", ["floats", "sinks", "bobs"])
def test_nothing_floats_or_sinks_in_painted_water(kind: str, tmp_path: Path) -> None:
    painted = {"other": "tank"}
    event = KINDS[kind].model_copy(update=painted)
    found = judged(crate_in_tank(still(AFLOAT)), tmp_path, event)
    assert (found.status, found.details.get("painted")) == ("fail", True)
