"""Lift of bodies that lie where liquid does not get under them: what is excused, and what is not."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from worldagent.testing.worlds import small_worlds as sw
from worldagent.testing.worlds.liquid_worlds import DENSITY, Flow, G, pool_in_tank
from worldagent.verifiers.categories import check as category
from worldagent.verifiers.categories.liquid.footing import NARROW, unwetted
from worldagent.verifiers.categories.liquid.frames import liquid_of
from worldagent.worlds.requirements import Row
from worldagent.worlds.spec import Entity, Material

S = 0.02
DEPTH = 0.2
FRAMES = 10


def sunk(body: Entity, *, density: float, push: float, height: float, volume: float) -> Flow:
    """A body held under still water with `height` [m] below its middle, pushed up by `push` of what it displaces."""
    place = body.model_copy(update={"material": "heavy", "pose": sw.pose((0.0, 0.0, height))})
    flow = pool_in_tank(
        size=(0.4, 0.4, DEPTH), spacing=S, wall=0.03, frames=FRAMES, others={"body": place}, two_way=True, below=0.1
    )
    spec = flow.spec.model_copy(update={"materials": {**flow.spec.materials, "heavy": Material(density=density)}})
    points = flow.position[0]
    radius = 0.5 * max(place.dimensions.size)
    keep = points[np.linalg.norm(points - (0.0, 0.0, height), axis=1) > radius]
    given = np.zeros((FRAMES, 6))
    given[1:, 2] = push * DENSITY * G * volume / 24.0
    row = flow.colliders.index("body/body")
    return flow.edited(
        spec=spec,
        position=[keep.copy() for _ in range(FRAMES)],
        velocity=[np.zeros_like(keep) for _ in range(FRAMES)],
        identity=[np.arange(len(keep))] * FRAMES,
        share={row: given},
        tracks={"body": (np.tile([0.0, 0.0, height], (FRAMES, 1)), sw.IDENTITY)},
        rigid={"velocity": np.zeros((FRAMES, 1, 3)), "exchange/impulse": given[:, None]},
    )


def ball(radius: float, *, density: float, push: float, gap: float = 0.0) -> Flow:
    """A ball whose lowest point is `gap` [m] above the tank's floor."""
    made = sw.ball(radius, motion="dynamic")
    return sunk(made, density=density, push=push, height=radius + gap, volume=4.0 / 3.0 * np.pi * radius**3)


def buoyancy(flow: Flow, folder: Path) -> Row:
    (row,) = [r for r in category.check(flow.candidate(folder)) if ":buoyancy:" in r.id]
    return row


def test_a_heavy_ball_on_the_floor_may_lack_the_lift_of_the_wedge_under_it(tmp_path: Path) -> None:
    row = buoyancy(ball(2.5 * S, density=2600.0, push=0.5), tmp_path)
    assert row.status == "pass", row.evidence
    assert "too narrow for the particles" in row.evidence["explanation"]
    assert row.evidence["lift_kept_out_n"]["body"] > 0.5 * DENSITY * G * 4.0 / 3.0 * np.pi * (2.5 * S) ** 3


@pytest.mark.parametrize(
    ("flow", "what"),
    [
        (ball(2.5 * S, density=2600.0, push=0.5, gap=S), "liquid is under it"),
        (ball(2.5 * S, density=500.0, push=0.45), "it would rise"),
        (ball(4.5 * S, density=2600.0, push=0.1), "more is missing than the wedge holds"),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_lift_that_no_wedge_explains_is_missed(tmp_path: Path, flow: Flow, what: str) -> None:
    row = buoyancy(flow, tmp_path)
    assert (row.status, row.first_failing_entity) == ("fail", "body"), what


def test_a_light_ball_that_stays_on_the_floor_needs_finer_particles(tmp_path: Path) -> None:
    row = buoyancy(ball(2.5 * S, density=500.0, push=0.45), tmp_path)
    assert row.corrections[0].group == "resolution"
    assert "would float up" in row.evidence["explanation"]


def test_full_lift_on_the_floor_passes_without_excuse(tmp_path: Path) -> None:
    row = buoyancy(ball(2.5 * S, density=2600.0, push=1.0), tmp_path)
    assert row.status == "pass"
    assert row.evidence["lift_kept_out_n"] == {}


def test_what_no_liquid_reaches_is_the_column_over_the_tight_places(tmp_path: Path) -> None:
    """Analytic: under a box its base times the depth; under a ball the integral over the cap that is lower than the gap."""
    base = sunk(sw.box(0.1, 0.08, 0.06, motion="dynamic"), density=2600.0, push=1.0, height=0.03, volume=0.1 * 0.08 * 0.06)
    liquid = liquid_of(base.candidate(tmp_path / "box"), "water")
    assert unwetted(liquid, "body/body", 0, DEPTH) == pytest.approx(0.1 * 0.08 * DEPTH, rel=0.05)
    radius, narrow = 4.0 * S, NARROW * S
    liquid = liquid_of(ball(radius, density=2600.0, push=1.0).candidate(tmp_path / "ball"), "water")
    heights = (np.arange(1000) + 0.5) / 1000 * narrow
    cap = float((2.0 * np.pi * (radius - heights) * (DEPTH - heights)).mean() * narrow)
    assert unwetted(liquid, "body/body", 0, DEPTH) == pytest.approx(cap, rel=0.1)
    lifted = liquid_of(ball(radius, density=2600.0, push=1.0, gap=S).candidate(tmp_path / "up"), "water")
    assert unwetted(lifted, "body/body", 0, DEPTH) == 0.0
