"""Small worlds of hard impacts: cradles of balls that touch, bounces, boxes on edges, stacks that land; and what a law that pushes opening contacts makes of them."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path
from typing import Any
from unittest.mock import patch

import numpy as np

from ...simulation.rigid import contact_law
from ...simulation.rigid.impact_sequence import ImpactSequence
from ...simulation.rigid.impacts import Impact
from ...worlds.arrays import F64
from ...worlds.spec import Entity, Material, RigidSettings, SpringJoint, WorldSpec
from ..worlds.small_worlds import ball, box, ground, world
from ._films import Film, copied, film_of
from .cases import World

__all__ = [
    "bouncing", "cradle", "forged_cradle", "forged_gain", "landing", "leave_out_strongest", "less_inside", "lost_spring", "old_law", "on_a_spring", "on_an_edge", "rack", "untold", "wedged",
]  # fmt: skip

STEP, GAP = 5e-4, 1e-3
"""Default step [s] and summed skins [m]."""
SPRUNG = 200.0
"""[N/m]"""


def _make(
    entities: dict[str, Entity], restitution: float, *, frames: int = 12, friction: float = 0.4, **more: object
) -> WorldSpec:
    wood = Material(density=600.0, friction=friction, restitution=restitution, substance="wood")
    settings = RigidSettings(step=STEP)
    return world(entities, frames=frames, settings=settings, materials={"wood": wood}, **more)  # type: ignore[arg-type]


def _cradle(number: int) -> WorldSpec:
    """Five balls that touch, of which one or two run into the others: at the gap of the two skins, or a fifth more."""
    gap, let, e = GAP * (1.0, 1.2)[number % 2], 1 + (number // 2) % 2, (1.0, 0.9)[number // 4 % 2]
    places = [((0.1 + gap) * k - (0.05 if k < let else 0.0), 0, 1) for k in range(5)]
    made = {
        f"ball{k}": ball(0.05, motion="dynamic", at=at, velocity=(1.0 if k < let else 0.0, 0, 0)) for k, at in enumerate(places)
    }
    return _make(made, e, gravity=(0, 0, 0))


def _bouncing(number: int) -> WorldSpec:
    """A hard ball falls on a floor, beside one that lies there."""
    falls = ball(0.1, motion="dynamic", at=(0, 0, 0.11), velocity=(0.1 * number, 0, -4.0 - number))
    return _make(
        {"floor": ground(), "falls": falls, "lies": ball(0.1, motion="dynamic", at=(1, 0, 0.101))}, (1.0, 0.8)[number % 2]
    )


def _on_an_edge(number: int) -> WorldSpec:
    """A box lands obliquely on an edge, with friction and nearly no loss."""
    turned = box(0.1, 0.1, 0.1, motion="dynamic", at=(0, 0, 0.25), euler=(0, 0.3 + 0.1 * number, 0), velocity=(2.0, 0, -2.0))
    return _make({"floor": ground(), "box": turned}, (1.0, 0.9)[number % 2], friction=0.5, frames=18)


def _landing(number: int) -> WorldSpec:
    """A stack of boxes falls on the floor."""
    high = 0.05 + 0.05 * number
    boxes = {f"box{k}": box(0.1, 0.1, 0.05, motion="dynamic", at=(0, 0, high + 0.025 + 0.051 * k)) for k in range(4)}
    return _make({"floor": ground(), **boxes}, (0.0, 0.5)[number % 2], frames=18)


def _on_a_spring(number: int) -> WorldSpec:
    """A box lies and sleeps under a spring that pulls by less than its weight."""
    lies = box(0.2, 0.2, 0.2, motion="dynamic", at=(0, 0, 0.1))
    weight = 600.0 * 0.2**3 * 9.81
    pull = SpringJoint(
        child="box",
        child_point=(0, 0, 0.2),
        parent_point=(0, 0, 1.2),
        stiffness=SPRUNG,
        rest_length=1.0 - 0.1 * weight * (1 + number) / SPRUNG,
    )
    return _make({"floor": ground(), "box": lies}, 0.0, frames=24, joints={"pull": pull})


def _rack(number: int) -> WorldSpec:
    """A ball runs into six that touch, in a triangle on a floor."""
    gap, e, speed = GAP * (1.0, 1.2)[number % 2], (1.0, 0.9, 0.6)[number % 3], 2.0 + 0.5 * (number // 2)
    pitch = 0.06 + gap
    places = [(0.5 * 3**0.5 * pitch * row, pitch * (k - 0.5 * row)) for row in range(3) for k in range(row + 1)]
    made = {f"ball{k}": ball(0.03, motion="dynamic", at=(x, y, 0.031)) for k, (x, y) in enumerate(places)}
    made["cue"] = ball(0.03, motion="dynamic", at=(-0.15, 0.004 * (number // 4), 0.031), velocity=(speed, 0, 0))
    return _make({"floor": ground(), **made}, e, friction=0.2)


def _wedged(number: int) -> WorldSpec:
    """Dominoes tip onto a ball that lies on a floor, and the later ones drive the first one on, which wedges it."""
    high, r = 0.15, 0.015 + 0.001 * (number % 4)
    made = {"floor": ground(), "marble": ball(r, motion="dynamic", at=(0.06 + 0.008 * (number // 4), 0, r + GAP))}
    for k in range(5):
        made[f"domino{k}"] = box(0.024, 0.075, high, motion="dynamic", at=(-0.075 * k, 0, high / 2 + GAP))
    last = made["domino4"]
    made["domino4"] = last.model_copy(update={"physics": last.physics.model_copy(update={"angular_velocity": (0, 9.0, 0)})})
    return _make(made, 0.0, frames=30)


KINDS = {
    "rack": _rack,
    "wedged": _wedged,
    "cradle": _cradle,
    "bouncing": _bouncing,
    "edge": _on_an_edge,
    "landing": _landing,
    "spring": _on_a_spring,
}
VARIANTS = 8


@lru_cache(maxsize=64)
def _once(kind: str, number: int) -> Film:
    return film_of(KINDS[kind](number))


def _film(kind: str, number: int) -> Film:
    return copied(_once(kind, number % VARIANTS))


def cradle(number: int) -> Film:
    """Balls that touch and hand an impact on."""
    return _film("cradle", number)


def rack(number: int) -> Film:
    """A ball runs into six that touch."""
    return _film("rack", number)


def wedged(number: int) -> Film:
    """A ball that a domino wedges onto its floor."""
    return _film("wedged", number)


def bouncing(number: int) -> Film:
    """A hard bounce."""
    return _film("bouncing", number)


def on_an_edge(number: int) -> Film:
    """A box that lands on an edge."""
    return _film("edge", number)


def landing(number: int) -> Film:
    """A stack that lands."""
    return _film("landing", number)


def on_a_spring(number: int) -> Film:
    """A box asleep under a spring."""
    return _film("spring", number)


def _pushing(data: Any, rows: Any, hit: Any, speed: Any, bounce: Any, tight: Any) -> Impact:
    """The impacts of a law that asks a contact that opens for three quarters of its speed, whatever closes it."""
    impact = _of(data, rows, hit, speed, bounce, tight)
    impact.parting[:] = False
    return impact


_of = Impact.of


@lru_cache(maxsize=8)
def _badly(kind: str, number: int) -> Film:
    """The world under that law, all impacts of a step at once."""
    at_once = patch.object(contact_law, "ImpactSequence", lambda *_: None)
    with at_once, patch.object(Impact, "of", _pushing):
        return film_of(KINDS[kind](number))


def _judged(film: Film, folder: Path) -> World:
    return World(film.candidate(folder), (*film.index.colliders, "rigid"))


def old_law(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A cradle, or a box on an edge, under a law that gives energy to contacts that open."""
    del magnitude
    kind, number = (("cradle", 0), ("cradle", 2), ("cradle", 6), ("edge", 0))[int(rng.integers(4))]
    return _judged(copied(_badly(kind, number)), folder)


@lru_cache(maxsize=64)
def _less_inside(number: int, less: float) -> Film:
    """A cradle of balls that touch, those inside of which give back `less` than declared."""

    def resolve(self: Any, data: Any, slowest: float, restitution: Any) -> Any:
        rows = data.contact.efc_address
        inside = (rows >= 0) & (np.abs(data.efc_vel[rows]) < 0.1)
        return honest(self, data, slowest, np.where(inside, restitution - less, restitution))

    honest = ImpactSequence.resolve
    with patch.object(ImpactSequence, "resolve", resolve):
        return film_of(_cradle(number))


def less_inside(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """Impacts that are handed on within a step give back `magnitude` less than is declared; the first one does not."""
    return _judged(copied(_less_inside(2 * int(rng.integers(4)), magnitude)), folder)


def untold(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """The strongest impact of a rack or a cradle is missing from the log."""
    del magnitude
    film = (cradle, rack)[int(rng.integers(2))](int(rng.integers(VARIANTS)))
    leave_out_strongest(film)
    return _judged(film, folder)


def leave_out_strongest(film: Film) -> None:
    """Take the strongest impact of the first frame with impacts out of its log."""
    k = next(k for k in range(1, film.count) if len(film.frames[k]["impact/time"]))
    data = film.frames[k]
    strongest = int(np.argmax(np.linalg.norm(data["impact/vector"], axis=1)))
    for name in [n for n in data if n.startswith("impact/")]:
        data[name] = np.delete(data[name], strongest, axis=0)


def forged_cradle(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """The same cradle with the record of it taken out: all energies tell it, by the share that the step's gain has of them."""
    del magnitude
    film = copied(_badly("cradle", 2 * int(rng.integers(2))))
    film.set_record("contact_gain", 0.0)
    return _judged(film, folder)


def forged_gain(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """An impact step gave `magnitude` of the energy of the bodies that touched, and the next ones took it again."""
    film = cradle(int(rng.integers(VARIANTS)))
    kinetic: F64 = film.series("record/kinetic_energy")
    k = next(k for k in range(1, film.count) if np.sum(film.frames[k]["contact/impulse"]) > 1e-3)
    gain = film.series("record/contact_gain")
    # What was fast before and what is fast after both took part.
    gain[k] = magnitude * 2.05 * kinetic.max()
    film.set_record("contact_gain", gain)
    return _judged(film, folder)


def lost_spring(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """The energy stored by a spring on a sleeping body is recorded as if it were `magnitude` of its length shorter."""
    film = on_a_spring(int(rng.integers(4)))
    asleep = film.series("asleep", "box") > 0
    stored = film.series("record/potential_energy")
    film.set_record("potential_energy", np.where(asleep, stored + 0.5 * SPRUNG * magnitude**2, stored))
    return _judged(film, folder)
