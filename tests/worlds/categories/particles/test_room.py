"""Volumes too coarse for the radius of their grains are told with how many find room (R65)."""

from __future__ import annotations

import numpy as np
import pytest
from worldagent.simulation.particles.packing import fill_box
from worldagent.testing.worlds.small_grains import sand_spec
from worldagent.worlds.audits.audit import audit
from worldagent.worlds.patch import parse_spec

SIZES = {"thin": [0.3, 0.3, 0.025], "small": [0.04, 0.04, 0.04]}
RADIUS = 0.01


def warned(size: list[float], radius: float) -> tuple[str, ...]:
    """Warnings about sand of one radius in one box [m]."""
    spec = sand_spec()
    name = next(n for n, e in spec["entities"].items() if e.get("physics", {}).get("category") == "particles")
    sand = spec["entities"][name]
    sand["physics"]["radius"] = radius
    sand["dimensions"]["size"] = size
    sand["parts"] = {"body": {"shape": {"kind": "box", "size": size}}}
    return tuple(w for w in audit(parse_spec({**spec, "prompt": "Sand."})).warnings if "/physics/radius" in w)


@pytest.mark.parametrize("name", SIZES)
def test_a_volume_with_room_for_few_grains_is_told_and_the_radius_it_names_is_not(name: str) -> None:
    size = SIZES[name]
    (told,) = warned(size, RADIUS)
    assert "of 0.01 m radius and has room for about" in told
    most = float(told.split("Take a radius of at most ")[1].split(" m")[0])
    assert warned(size, most) == ()


@pytest.mark.parametrize("name", SIZES)
def test_the_number_that_is_told_is_about_that_of_the_packing(name: str) -> None:
    size = SIZES[name]
    (told,) = warned(size, RADIUS)
    said = float(told.split("has room for about ")[1].split(",")[0])
    spec = sand_spec()
    physics = next(e["physics"] for e in spec["entities"].values() if e.get("physics", {}).get("category") == "particles")
    share, spread = physics.get("packing", 0.58), physics.get("radius_spread", 0.1)
    counts = []
    for seed in range(6):
        low, high = np.zeros(3), np.array(size)
        place, radius = fill_box(low, high, RADIUS, share=share, spread=spread, seed=seed)
        counts.append(int((np.minimum(place, high - place).min(axis=1) >= radius).sum()))
    assert abs(np.mean(counts) - said) < 0.35 * said + 1.5


def test_a_volume_with_room_is_not_told() -> None:
    assert warned([0.3, 0.3, 0.3], RADIUS) == ()
    assert warned(SIZES["thin"], 0.002) == ()
