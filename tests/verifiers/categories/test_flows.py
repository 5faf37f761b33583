"""Flows and spreads: a flux that goes one way by itself, and an area that grows on what bears it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from worldagent.testing.defects import _liquid_scenes as scenes
from worldagent.testing.worlds.liquid_worlds import Flow, G, pool_in_tank, stream
from worldagent.tests.verifiers.agreement import evaluate
from worldagent.verifiers.predicates.outcome import Outcome
from worldagent.worlds.arrays import F64
from worldagent.worlds.categories.event import FlowEvent, SpreadEvent

S = 0.02
SPREADS = SpreadEvent(kind="spreads", entity="pool")


def flows(point: tuple[float, float, float], normal: tuple[float, float, float], **more: float) -> FlowEvent:
    return FlowEvent(kind="flows", entity="pool", point=point, normal=normal, radius=0.2, **more)


def judged(flow: Flow, folder: Path, event: FlowEvent | SpreadEvent) -> Outcome:
    return evaluate(flow.candidate(folder), event, (0, flow.frames - 1))


def moved(flow: Flow, way: F64) -> Flow:
    """All of the water shifted, frame by frame [m], shape (frames, 3), with the velocities that go with it."""
    speed = np.gradient(way, 1 / 24, axis=0)
    position = [p + w for p, w in zip(flow.position, way, strict=True)]
    return flow.edited(position=position, velocity=[np.tile(v, (len(p), 1)) for p, v in zip(position, speed, strict=True)])


def along(values: F64) -> F64:
    return np.stack([values, 0 * values, 0 * values], axis=1)


def still() -> Flow:
    return pool_in_tank(size=(0.24, 0.2, 0.12), spacing=S, frames=24)


def test_a_stream_that_falls_flows_down_and_not_up(tmp_path: Path) -> None:
    """The water that the tap lets in passes below: its section times its speed."""
    found = judged(stream(speed=1.0), tmp_path, flows((0, 0, 0.6), (0, 0, -1)))
    assert (found.status, found.unit) == ("pass", "m^3/s"), found.explanation
    assert found.value == pytest.approx(0.08**2 * 1.0, rel=0.1)
    assert judged(stream(speed=1.0), tmp_path / "up", flows((0, 0, 0.6), (0, 0, 1))).status == "fail"
    assert judged(stream(speed=1.0), tmp_path / "more", flows((0, 0, 0.6), (0, 0, -1), min=0.02)).status == "fail"


def test_water_that_sways_to_and_fro_does_not_flow(tmp_path: Path) -> None:
    swaying = moved(still(), along(0.05 * np.sin(2 * np.pi * np.arange(24) / 8)))
    found = judged(swaying, tmp_path, flows((0.01, 0, 0.06), (1, 0, 0)))
    assert (found.status, found.value) == ("fail", pytest.approx(0.0, abs=0.74))


def test_water_that_a_moving_tank_takes_along_does_not_flow(tmp_path: Path) -> None:
    """As much passes the disc as in a stream, in its vessel."""
    way = along(0.4 * np.arange(24) / 24)
    flow = moved(still(), way)
    free = judged(flow, tmp_path / "free", flows((0.15, 0, 0.06), (1, 0, 0)))
    assert free.status == "pass", free.explanation
    tank = flow.spec.entities["tank"].model_copy(update={"motion": "kinematic"})
    spec = flow.spec.model_copy(update={"entities": {**flow.spec.entities, "tank": tank}})
    carried = flow.edited(spec=spec, tracks={"tank": (way, (1.0, 0.0, 0.0, 0.0))})
    found = judged(carried, tmp_path / "carried", flows((0.15, 0, 0.06), (1, 0, 0)))
    assert (found.status, found.comparison, found.value) == ("fail", "<=", pytest.approx(1.0))


def test_still_water_does_not_flow_or_spread(tmp_path: Path) -> None:
    candidate = still().candidate(tmp_path)
    for event in (flows((0.01, 0, 0.06), (1, 0, 0)), SPREADS):
        assert evaluate(candidate, event, (0, 23)).status == "fail"


def flattened(growth: F64) -> Flow:
    """A heap of water that grows wider and lower about its foot, at a constant volume."""
    flow = still()
    position = [p * np.array([g, g, g**-2]) for p, g in zip(flow.position, growth, strict=True)]
    velocity = list(np.gradient(np.array(position), 1 / 24, axis=0))
    return flow.edited(position=position, velocity=velocity)


def test_water_that_runs_out_over_the_floor_spreads(tmp_path: Path) -> None:
    found = judged(flattened(np.linspace(1.0, 1.5, 24)), tmp_path, SPREADS)
    assert found.status == "pass", found.explanation
    assert found.value == pytest.approx(1.5**2, rel=0.3)
    assert judged(flattened(np.linspace(1.0, 1.1, 24)), tmp_path / "little", SPREADS).status == "fail"


def test_water_that_comes_apart_in_the_air_does_not_spread(tmp_path: Path) -> None:
    flow = scenes.block((0.12, 0.12, 0.12), (0, 0, 2.0), frames=12)
    times = np.arange(12) / 24
    middle = flow.position[0].mean(axis=0)
    out = [(flow.position[0] - middle) * (1 + 2 * t) + middle - [0, 0, 0.5 * G * t * t] for t in times]
    apart = flow.edited(
        position=out, velocity=[np.tile([0, 0, -G * t], (len(middle_free), 1)) for t, middle_free in zip(times, out, strict=True)]
    )
    found = judged(apart, tmp_path, SPREADS)
    assert (found.status, found.value) == ("fail", pytest.approx(0.0, abs=1e-3))


def test_a_disc_needs_a_direction() -> None:
    with pytest.raises(ValueError, match="normal must have a length"):
        flows((0, 0, 0), (0, 0, 0))
