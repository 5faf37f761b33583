"""Bonds that no declared fall or velocity can break are told before anything runs (R61)."""

from __future__ import annotations

from typing import Any

import pytest
from worldagent.worlds.audits.audit import audit
from worldagent.worlds.patch import parse_spec

SIDE, HIT = 0.2, 0.05


def _body(shape: dict[str, Any], size: list[float], at: list[float], motion: str = "dynamic", **more: Any) -> dict[str, Any]:
    return {
        "role": "a body", "motion": motion, "material": "stone", "dimensions": {"size": size}, "pose": {"position": at},
        "parts": {"body": {"shape": shape}}, **more,
    }  # fmt: skip


def warned(
    *,
    height: float = 0.1,
    tension: float = 40e6,
    toughness: float = 0.0,
    speed: float = 0.0,
    predicate: dict[str, Any] | None = None,
    **plan: Any,
) -> tuple[str, ...]:
    """Warnings about a block of eight pieces that falls onto a floor from a height of its lower side [m]."""
    bond = {"tension": tension, "shear": tension, "toughness": toughness}
    block = _body(
        {"kind": "box", "size": [SIDE] * 3}, [SIDE] * 3, [0, 0, height + SIDE / 2], breakable={"pattern": {"kind": "voronoi", "pieces": 8}, "bond": bond},
        physics={"category": "rigid", "linear_velocity": [0, 0, -speed]},
    )  # fmt: skip
    floor = _body({"kind": "box", "size": [4, 4, 1]}, [4, 4, 1], [0, 0, -0.5], "static")
    asked = predicate or {"kind": "breaks", "entity": "block"}
    beat = {"text": "it breaks", "owner": "rigid", "subject": "block", "frames": [0, 20], "predicate": asked}
    spec = {
        "spec_version": "2", "title": "t", "prompt": "A block falls and breaks.",
        "materials": {"stone": {"density": 2400, "substance": "stone"}},
        "entities": {"block": block, "floor": floor},
        "story": {"beats": {"breaks": beat}},
        "simulation": {"fps": 24, "frames": 24, "solvers": {"rigid": {"engine": "mujoco", "members": ["block", "floor"]}}, **plan},
    }  # fmt: skip
    return audit(parse_spec(spec)).warnings


def test_bonds_that_a_short_fall_cannot_break_are_told_with_both_stresses() -> None:
    (told,) = warned(tension=400e6)
    assert told.startswith("/entities/block/breakable/bond: the strongest declared blow is that of 'block'")
    assert "its bonds bear 4e+08 Pa, so that /story/beats/breaks cannot come" in told


def test_the_stress_that_is_told_is_one_that_is_not_told_any_more() -> None:
    (told,) = warned(tension=400e6)
    most = float(told.split("at most ")[2].split(" Pa")[0])
    assert warned(tension=0.99 * most) == ()


def test_weak_bonds_high_falls_and_fast_bodies_are_not_told() -> None:
    assert warned(tension=1e6) == ()
    assert warned(tension=400e6, height=60.0) == ()
    assert warned(tension=400e6, speed=40.0) == ()


def test_a_toughness_that_no_blow_has_the_energy_for_is_told() -> None:
    (told,) = warned(tension=1e5, toughness=1e5)
    assert told.startswith("/entities/block/breakable/bond/toughness:")
    assert "takes 1e+03 J to break" in told
    assert warned(tension=1e5, toughness=100.0) == ()


@pytest.mark.parametrize(
    "predicate",
    [
        {"kind": "broken", "entity": "block", "max": 0.1},
        {"kind": "not", "predicate": {"kind": "breaks", "entity": "block"}},
        {"kind": "speed", "entity": "block", "min": 1.0},
    ],
)
def test_a_story_that_wants_nothing_broken_is_not_told(predicate: dict[str, Any]) -> None:
    assert warned(tension=400e6, predicate=predicate) == ()


def test_where_anything_else_brings_energy_nothing_is_told() -> None:
    hammer = {"kind": "field", "field": {"kind": "attraction", "center": [0, 0, 0], "acceleration": 1.0, "distance": 1.0}}
    assert not [w for w in warned(tension=400e6, drivers={"pull": hammer}) if "breakable" in w]
    assert not [w for w in warned(tension=400e6, gravity=[0, 0, 0], speed=60.0) if "breakable" in w]
