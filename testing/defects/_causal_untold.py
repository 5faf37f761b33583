"""Simulated worlds of the causal suite about drivers that the story does not tell of, and about effects of several bodies.

A block `a` slides into `m`, which is to slide on into `b`.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from ...worlds.predicates import And, Displacement
from ...worlds.spec import Beat, Entity, ForceDriver, HingeJoint, MotorDriver, ReleaseDriver, SpringJoint
from ..worlds.simulated_worlds import SLICK, beat, simulate
from ..worlds.small_worlds import box, ground, world
from .cases import Mechanism, World

__all__ = ["UNTOLD", "lane", "pull"]

FRAMES = 27
LAST = FRAMES - 1
SIDE = 0.1
FRICTION = 0.1 * 600.0 * SIDE**3 * 9.81
"""Force on a block on the floor [N]."""
Rng = np.random.Generator


def _block(x: float, *, y: float = 0.0, speed: float = 0.0) -> Entity:
    return box(SIDE, SIDE, SIDE, motion="dynamic", at=(x, y, SIDE / 2 + 1e-3), velocity=(speed, 0, 0))


def _goes(name: str, least: float, *causes: str, **more: Any) -> Beat:
    return beat(name, Displacement(entity=name, min=least), frames=(0, LAST), causes=causes, **more)


def lane(
    folder: Path,
    rng: Rng,
    *,
    gap: float,
    culprits: tuple[str, ...] = (),
    drivers: dict[str, Any] | None = None,
    beats: dict[str, Beat] | None = None,
    more: dict[str, Entity] | None = None,
    **plan: Any,
) -> World:
    """A block `a` that slides into `m`, and `b` behind a gap [m] that `m` alone crosses where it is less than 0.2."""
    near = float(rng.uniform(0.03, 0.06))
    entities = {
        "floor": ground(),
        "a": _block(0.0, speed=1.5),
        "m": _block(SIDE + near),
        "b": _block(2 * SIDE + near + gap),
        **(more or {}),
    }
    told = {"comes": _goes("a", 0.02), "slides": _goes("b", 0.01, "comes"), **(beats or {})}
    spec = world(entities, beats=told, drivers=drivers or {}, frames=FRAMES, materials=SLICK, **plan)
    return World(simulate(folder, spec), culprits)


def pull(share: float, **more: Any) -> ForceDriver:
    """A force on `m` along its way, as share of its friction: it moves nothing that rests."""
    return ForceDriver(entity="m", force=(share * FRICTION, 0.0, 0.0), end=2.0, **more)


def _needed(folder: Path, magnitude: float, rng: Rng) -> World:
    """A force on the block between the two, `magnitude` times its friction, carries it over a gap at which it would stop."""
    return lane(folder, rng, gap=0.35, drivers={"wind": pull(magnitude)}, culprits=("causal:untold",))


def _either_would_do(folder: Path, magnitude: float, rng: Rng) -> World:
    """Two such forces, each `magnitude` times its friction, either of which would do."""
    drivers: dict[str, Any] = {"wind": pull(magnitude), "gust": pull(magnitude, start=float(rng.uniform(0.0, 0.05)))}
    return lane(folder, rng, gap=0.3, drivers=drivers, culprits=("causal:untold",))


def _sprung_after(folder: Path, magnitude: float, rng: Rng) -> World:
    """A third block on a spring, `magnitude` m short, that a release of no beat lets go behind them, pushes the two on."""
    x, z = -0.2, SIDE / 2 + 1e-3
    spring = SpringJoint(
        parent="floor",
        child="c",
        parent_point=(x - 1.0, 0, z),
        child_point=(x, 0, z),
        stiffness=60.0,
        rest_length=1.0 + magnitude,
    )
    let_go = {"go": ReleaseDriver(entity="c", time=float(rng.uniform(0.1, 0.15)))}
    more = {"c": _block(x)}
    return lane(folder, rng, gap=0.35, drivers=let_go, more=more, culprits=("causal:untold",), joints={"k": spring})


def _motor(folder: Path, magnitude: float, rng: Rng) -> World:
    """A motor of no beat turns an arm, at `magnitude` rad/s, whose end comes from behind and pushes the two on."""
    pivot = (0.15, 0.3, 0.06)
    arm = box(0.6, 0.04, 0.06, motion="dynamic", at=pivot)
    pin = HingeJoint(child="arm", anchor=pivot, axis=(0, 0, 1))
    turn = {"turn": MotorDriver(joint="pin", velocity=magnitude, max_effort=3.0, start=float(rng.uniform(0.1, 0.15)), end=2.0)}
    return lane(folder, rng, gap=0.3, drivers=turn, more={"arm": arm}, culprits=("causal:untold",), joints={"pin": pin})


def _both(*causes: str, least: float = 0.01) -> Beat:
    both = And(of=[Displacement(entity="b", min=least), Displacement(entity="d", min=0.03)])
    return beat("b", both, frames=(0, LAST), causes=causes)


def _one_of_two(folder: Path, magnitude: float, rng: Rng) -> World:
    """Two blocks are to move; the cause reaches one, the other comes along its own way at `magnitude` m/s."""
    other = {"d": _block(0.3, y=float(rng.uniform(0.5, 1.0)), speed=magnitude)}
    return lane(folder, rng, gap=0.05, more=other, beats={"slides": _both("comes")}, culprits=("d",))


def _one_comes_anyway(folder: Path, magnitude: float, rng: Rng) -> World:
    """Two blocks are to move, and a chain leads to both; the second, at `magnitude` m/s, has come already by itself."""
    small = box(
        0.04, 0.04, 0.04, motion="dynamic", at=(0.46 + float(rng.uniform(0.0, 0.01)), 0, 0.021), velocity=(-magnitude, 0, 0)
    )
    return lane(folder, rng, gap=0.05, more={"d": small}, beats={"slides": _both("comes", least=0.05)}, culprits=("d",))


# ---------------------------------------------------------------- clean


def _told(folder: Path, magnitude: float, rng: Rng) -> World:
    """The force that carries the block over the gap owns a beat that is named as a cause."""
    drawn = _goes("m", 0.01, owner="wind")
    beats = {"drawn": drawn, "slides": _goes("b", 0.01, "comes", "drawn")}
    return lane(folder, rng, gap=0.35, drivers={"wind": pull(magnitude)}, beats=beats)


def _not_needed(folder: Path, magnitude: float, rng: Rng) -> World:
    """A force of no beat helps the block over a gap that it crosses without."""
    return lane(folder, rng, gap=0.05, drivers={"wind": pull(magnitude)})


def _passed_on(folder: Path, magnitude: float, rng: Rng) -> World:
    """Two blocks are to move, and what moves the first goes on to the second, over a gap of `magnitude` m."""
    other = {"d": _block(0.38 + magnitude + 2e-3)}
    both = And(of=[Displacement(entity="b", min=0.01), Displacement(entity="d", min=0.01)])
    return lane(folder, rng, gap=0.02, more=other, beats={"slides": beat("b", both, frames=(0, LAST), causes=("comes",))})


def _each_its_own(folder: Path, magnitude: float, rng: Rng) -> World:
    """Two blocks are to move, each from a cause of its own; the second one is struck at `magnitude` m/s."""
    side = float(rng.uniform(0.5, 1.0))
    other = {"e": _block(0.1, y=side, speed=magnitude), "d": _block(0.3, y=side)}
    beats = {"too": _goes("e", 0.02), "slides": _both("comes", "too")}
    return lane(folder, rng, gap=0.05, more=other, beats=beats)


UNTOLD = (
    Mechanism("helping-force", "a force of no beat carries a link of the chain on, by this share of its friction", True, _needed, 0.7, 0.95, "1"),
    Mechanism("either-would-do", "two forces of no beat, of which either would do", True, _either_would_do, 0.42, 0.48, "1"),
    Mechanism("sprung-after", "a release of no beat lets go what pushes on", True, _sprung_after, 0.4, 0.6, "m"),
    Mechanism("helping-motor", "a motor of no beat pushes a link of the chain on", True, _motor, 4.0, 8.0, "rad/s"),
    Mechanism("one-of-two", "two are to move, and the cause reaches one", True, _one_of_two, 0.4, 1.5, "m/s"),
    Mechanism("one-comes-anyway", "two are to move, and one comes without the cause too", True, _one_comes_anyway, 0.6, 0.9, "m/s"),
    Mechanism("told-force", "a force carries a link of the chain on, and a beat says so", False, _told, 0.7, 0.95, "1"),
    Mechanism("spare-force", "a force of no beat helps what comes without it", False, _not_needed, 0.02, 0.5, "1"),
    Mechanism("passed-on", "two are to move, and the first passes it on", False, _passed_on, 5e-3, 0.02, "m"),
    Mechanism("each-its-own", "two are to move, each from its own cause", False, _each_its_own, 1.2, 2.0, "m/s"),
)  # fmt: skip
