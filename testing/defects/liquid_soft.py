"""Seeded defects of liquids that meet what deforms: a jelly in a tank, and a cloth that catches water.

Sound worlds are simulated once per kind (a few seconds) and kept; a broken one is such a cache changed in one way, with the records
that an adversary would change with it.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from ...worlds.arrays import F64, I32
from ...worlds.candidate import Candidate
from ..worlds.simulated_worlds import edited
from ._liquid_partners import PARTNER_MECHANISMS
from ._soft_scenes import BATHED, CAUGHT, CLOTH, FIRST, JELLY, LAST, SPACING, SPILLED, soft_world
from .cases import Mechanism, Suite, World

__all__ = ["SUITE"]

WATER, BODIES = "water", "rigid"
FPS = 24
Frame = dict[str, Any]
Edit = Callable[[int, Frame, float], None]
Draw = Callable[[Candidate, float, np.random.Generator], dict[str, Edit]]
"""Function that draws the edits of frames, by instance."""


def _changed(base: Candidate, folder: Path, edits: dict[str, Edit], magnitude: float) -> Candidate:
    for solver, edit in edits.items():
        base = edited(base, folder / f"of_{solver}", solver, lambda k, data, edit=edit: edit(k, data, magnitude))  # type: ignore[misc]
    return base


def _defect(kind: str, text: str, draw: Draw, low: float, high: float, unit: str = "1", **more: Any) -> Mechanism:
    name, culprits = draw.__name__.removeprefix("_"), more.pop("culprits", (kind,))

    def build(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
        base = soft_world(kind, int(rng.integers(2)))
        return World(_changed(base, folder, draw(base, magnitude, rng), magnitude), culprits)

    return Mechanism(name, text, True, build, low, high, unit, **more)


# ---------------------------------------------------------------- water where none can be


def _tell(data: Frame) -> None:
    """Make the records of a liquid of water those of its particles."""
    mass = 1000.0 * data["particle/volume"].astype(np.float64)
    velocity = data["particle/velocity"].astype(np.float64)
    height = (data["particle/position"].astype(np.float64) + data["origin"])[:, 2]
    data["record/kinetic_energy"] = np.float64(0.5 * mass @ (velocity**2).sum(axis=1))
    data["record/potential_energy"] = np.float64(9.81 * mass @ height)
    for axis, value in zip("xyz", mass @ velocity, strict=True):
        data[f"record/momentum_{axis}"] = np.float64(value)
    data["record/max_speed"] = np.float64(np.linalg.norm(velocity, axis=1).max())


def _led(base: Candidate, ways: dict[int, F64]) -> Edit:
    """Particles by id follow ways [m], shape (frames, 3), NaN where they stay their own; speeds are those of the ways."""

    def edit(k: int, data: Frame, much: float) -> None:
        del much
        for name, way in ways.items():
            row = np.flatnonzero(data["particle/id"] == name)
            if not len(row) or np.isnan(way[k]).any():
                continue
            data["particle/position"][row] = way[k] - data["origin"]
            then = way[k - 1] if not np.isnan(way[k - 1]).any() else _place(base, k - 1, name)
            data["particle/velocity"][row] = (way[k] - then) * FPS
        _tell(data)

    return edit


def _place(base: Candidate, frame: int, name: int) -> F64:
    data = base.caches[WATER].read(frame)
    return np.asarray((data["particle/position"].astype(np.float64) + data["origin"])[data["particle/id"] == name][0])


def _some(base: Candidate, frame: int, count: int, rng: np.random.Generator, about: F64) -> list[int]:
    """Ids of the particles that are nearest to a place as seen from above, in drawn order."""
    data = base.caches[WATER].read(frame)
    place = data["particle/position"].astype(np.float64) + data["origin"]
    order = np.argsort(np.linalg.norm((place - about)[:, :2], axis=1), kind="stable")[:count]
    return [int(i) for i in rng.permutation(data["particle/id"][order])]


def inside(base: Candidate, magnitude: float, rng: np.random.Generator) -> dict[str, Edit]:
    """A particle goes into the jelly within two frames, `magnitude` spacings deep, and stays."""
    body, spacing = base.deforming[JELLY], SPACING[JELLY]
    first = int(rng.integers(FIRST, LAST - 1))
    shift = rng.uniform(-0.01, 0.01, 2)
    ways = np.full((LAST + 1, 3), np.nan)
    for k in range(first, LAST + 1):
        points = body.positions(k)
        ways[k] = [*(points[:, :2].mean(axis=0) + shift), points[:, 2].min() + magnitude * spacing]
    name = _some(base, first, 1, rng, ways[first])[0]
    start = _place(base, first - 1, name)
    ways[first] = 0.5 * (start + ways[first])
    return {WATER: _led(base, {name: ways})}


def _over(base: Candidate, frame: int, face: I32, gap: float) -> F64:
    """A place `gap` [m] over the middle of a cloth's triangle (less: under it)."""
    corners = base.deforming[CLOTH].positions(frame)[face]
    normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
    return np.asarray(corners.mean(axis=0) + gap * np.sign(normal[2]) * normal / np.linalg.norm(normal))


def _through(base: Candidate, gaps: F64, first: int, count: int, rng: np.random.Generator) -> dict[str, Edit]:
    """Particles that go by these distances to the cloth [m] from a frame on, and keep the last."""
    faces = base.entity(CLOTH).parts[0].render.faces
    middles = base.deforming[CLOTH].positions(first)[faces].mean(axis=1)
    ways = {}
    for name in _some(base, first, count, rng, np.zeros(3)):
        own = np.full((LAST + 1, 3), np.nan)
        face = faces[np.argmin(np.linalg.norm((middles - 0.6 * _place(base, first, name))[:, :2], axis=1))]
        for k in range(first, LAST + 1):
            own[k] = _over(base, k, face, float(gaps[min(k - first, len(gaps) - 1)]))
        ways[name] = own
    return {WATER: _led(base, ways)}


def through_sheet(base: Candidate, magnitude: float, rng: np.random.Generator) -> dict[str, Edit]:
    """So many particles go through the cloth within a frame."""
    gaps = SPACING[CLOTH] * np.array([0.6, -0.6])
    return _through(base, gaps, int(rng.integers(FIRST, LAST)), round(magnitude), rng)


def shot(base: Candidate, magnitude: float, rng: np.random.Generator) -> dict[str, Edit]:
    """Three particles go through the cloth by so many spacings in a frame."""
    gaps = SPACING[CLOTH] * magnitude * np.array([0.5, -0.5])
    return _through(base, gaps, int(rng.integers(FIRST, LAST)), 3, rng)


def seeping(base: Candidate, magnitude: float, rng: np.random.Generator) -> dict[str, Edit]:
    """Three particles go through the cloth by a share of a spacing in every frame."""
    count = 4
    gaps = SPACING[CLOTH] * magnitude * np.linspace(0.5, -0.5, count) * (count - 1)
    return _through(base, gaps, LAST - count + 1, 3, rng)


def risen(base: Candidate, magnitude: float, rng: np.random.Generator) -> dict[str, Edit]:
    """The cloth is higher by so many spacings at a frame, over the water that lies on it."""
    which = int(rng.integers(LAST - 1, LAST + 1))

    def edit(k: int, data: Frame, much: float) -> None:
        if k == which:
            data["vertex/position"] = data["vertex/position"] + [0.0, 0.0, much * SPACING[CLOTH]]

    return {CLOTH: edit}


# ---------------------------------------------------------------- what the two give each other


def _row(base: Candidate, entity: str) -> int:
    return [c.split("/")[0] for c in base.caches[WATER].index.colliders].index(entity)


def _scaled(name: str, row: int, which: int) -> Edit:
    def edit(k: int, data: Frame, much: float) -> None:
        if k == which:
            data[name][row] = data[name][row] * (1.0 + much)

    return edit


def _both(*edits: Edit) -> Edit:
    def edit(k: int, data: Frame, much: float) -> None:
        for one in edits:
            one(k, data, much)

    return edit


def given_more(base: Candidate, magnitude: float, rng: np.random.Generator) -> dict[str, Edit]:
    """The water gave the jelly more than that received, in both of its books."""
    which, row = int(rng.integers(LAST - 1, LAST + 1)), _row(base, JELLY)
    return {WATER: _both(*(_scaled(f"exchange/{n}", row, which) for n in ("impulse", "reaction")))}


def received_more(base: Candidate, magnitude: float, rng: np.random.Generator) -> dict[str, Edit]:
    """The jelly received more than it was given."""
    return {BODIES: _scaled("exchange/soft", 0, int(rng.integers(LAST - 1, LAST + 1)))}


def forged_loss(base: Candidate, magnitude: float, rng: np.random.Generator) -> dict[str, Edit]:
    """The water's recorded loss to the jelly differs from what it gave, where it gave most: the row goes by that."""
    row = _row(base, JELLY)
    given = np.array(base.caches[WATER].series("exchange/impulse"))[:, row, :3]
    return {WATER: _scaled("exchange/reaction", row, int(np.argmax(np.linalg.norm(given, axis=1))))}


def forged_loss_to_cloth(base: Candidate, magnitude: float, rng: np.random.Generator) -> dict[str, Edit]:
    """The same of the cloth."""
    return {WATER: _scaled("exchange/reaction", _row(base, CLOTH), int(rng.integers(LAST - 1, LAST + 1)))}


def _handed_on(base: Candidate, sign: float, rng: np.random.Generator) -> Edit:
    """From a frame on, a cloth tells of a share more (or less) of what it received in that frame, and that its holds took it."""
    which = int(rng.integers(LAST - 1, LAST + 1))
    held = [base.caches[CLOTH].read(k) for k in (which - 1, which)]
    gained = {a: float(held[1][f"record/load_impulse_{a}"]) - float(held[0][f"record/load_impulse_{a}"]) for a in "xyz"}

    def edit(k: int, data: Frame, much: float) -> None:
        for axis, value in gained.items() if k >= which else ():
            data[f"record/load_impulse_{axis}"] = data[f"record/load_impulse_{axis}"] + sign * much * value
            data[f"record/hold_impulse_{axis}"] = data[f"record/hold_impulse_{axis}"] - sign * much * value

    return edit


def unreceived(base: Candidate, magnitude: float, rng: np.random.Generator) -> dict[str, Edit]:
    """The cloth received less than the water gave; its holds are said to have given the rest."""
    return {CLOTH: _handed_on(base, -1.0, rng)}


def received_of_nobody(base: Candidate, magnitude: float, rng: np.random.Generator) -> dict[str, Edit]:
    """The cloth received more than the water gave, and handed it on to its holds."""
    return {CLOTH: _handed_on(base, 1.0, rng)}


# ---------------------------------------------------------------- energy


def _stirred(rng: np.random.Generator) -> Edit:
    """From a frame on, every particle is faster by so much in a drawn direction, and all together are not [m/s]."""
    which, seed = int(rng.integers(FIRST, LAST)), int(rng.integers(2**31))

    def edit(k: int, data: Frame, much: float) -> None:
        if k >= which:
            way = np.random.default_rng(seed).normal(size=data["particle/velocity"].shape)
            way -= way.mean(axis=0)
            way *= much / np.sqrt((way**2).sum(axis=1).mean())
            data["particle/velocity"] = (data["particle/velocity"] + way).astype(np.float32)
            _tell(data)

    return edit


def stirred_by_jelly(base: Candidate, magnitude: float, rng: np.random.Generator) -> dict[str, Edit]:
    """Water about a jelly is faster, though nothing worked on it."""
    return {WATER: _stirred(rng)}


def stirred_by_cloth(base: Candidate, magnitude: float, rng: np.random.Generator) -> dict[str, Edit]:
    """The same on a cloth."""
    return {WATER: _stirred(rng)}


def worked(base: Candidate, magnitude: float, rng: np.random.Generator) -> dict[str, Edit]:
    """The water did more work on the jelly than it had, and kept its own energy [J]."""
    which = int(rng.integers(FIRST, LAST + 1))

    def edit(k: int, data: Frame, much: float) -> None:
        if k == which:
            data["record/soft_exchange_work"] = data["record/soft_exchange_work"] + much

    return {BODIES: edit}


def worked_on_cloth(base: Candidate, magnitude: float, rng: np.random.Generator) -> dict[str, Edit]:
    """The same of the cloth, from a frame on, whose holds are said to have taken it."""
    which = int(rng.integers(FIRST, LAST + 1))

    def edit(k: int, data: Frame, much: float) -> None:
        if k >= which:
            data["record/load_work"] = data["record/load_work"] + much
            data["record/hold_work"] = data["record/hold_work"] - much

    return {CLOTH: edit}


# ---------------------------------------------------------------- sound ones


def _sound(name: str, text: str, kind: str, kinds: int) -> Mechanism:
    """Worlds as simulated; the magnitude is which one."""

    def build(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
        return World(soft_world(kind, round(magnitude) - 1))

    return Mechanism(name, text, False, build, 1.0, float(kinds), "1", named=tuple(range(1, kinds + 1)))


def _looks(name: str, text: str, edit: Edit, low: float, high: float, unit: str = "1", solver: str = WATER) -> Mechanism:
    """A change that changes nothing."""

    def build(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
        base = soft_world((JELLY, CLOTH)[int(rng.integers(2))], 0)
        return World(_changed(base, folder, {solver: edit}, magnitude))

    return Mechanism(name, text, False, build, low, high, unit)


def _reordered(k: int, data: Frame, much: float) -> None:
    order = np.random.default_rng(round(1e3 * much)).permutation(len(data["particle/id"]))
    for name in [n for n in data if n.startswith("particle/")]:
        data[name] = data[name][order]


def _renamed(k: int, data: Frame, much: float) -> None:
    data["particle/id"] = data["particle/id"] + np.int32(round(much))


def _elsewhere(k: int, data: Frame, much: float) -> None:
    data["particle/position"] = (data["particle/position"].astype(np.float64) - much).astype(np.float32)
    data["origin"] = data["origin"] + much


def _blurred(k: int, data: Frame, much: float) -> None:
    data["particle/position"] = data["particle/position"] + np.float32(much)


IMPULSE = 1.05e-5, 0.5
SUITE = Suite(
    "category",
    (
        _defect(JELLY, "a particle lies in a jelly", inside, 0.6, 0.9, "spacings"),
        _defect(CLOTH, "water goes through a cloth", through_sheet, 2.0, 20.0, "particles"),
        _defect(CLOTH, "water shoots through a cloth", shot, 1.5, 6.0, "spacings"),
        _defect(CLOTH, "water seeps through a cloth", seeping, 0.1, 0.4, "spacings"),
        _defect(CLOTH, "a cloth is drawn through the water", risen, 1.2, 3.0, "spacings"),
        _defect(JELLY, "water gives a jelly more than that received", given_more, 1e-8, 0.5, bound=1e-9),
        _defect(JELLY, "a jelly receives more than it was given", received_more, 1e-8, 0.5, bound=1e-9),
        _defect(JELLY, "what water lost to a jelly is not what it gave", forged_loss, *IMPULSE),
        _defect(CLOTH, "what water lost to a cloth is not what it gave", forged_loss_to_cloth, 1e-4, 0.5),
        _defect(CLOTH, "a cloth receives less than it was given", unreceived, 1e-4, 0.5),
        _defect(CLOTH, "a cloth receives more than it was given", received_of_nobody, 1e-4, 0.5),
        _defect(JELLY, "water about a jelly gains energy", stirred_by_jelly, 0.3, 1.0, "m/s", culprits=(WATER,)),
        _defect(CLOTH, "water on a cloth gains energy", stirred_by_cloth, 0.7, 1.5, "m/s", culprits=(WATER,)),
        _defect(JELLY, "water works on a jelly and loses nothing", worked, 0.5, 3.0, "J", culprits=(WATER,)),
        _defect(CLOTH, "water works on a cloth and loses nothing", worked_on_cloth, 0.15, 2.0, "J", culprits=(WATER,)),
        _sound("bathed", "jellies of several weights fall into a tank", JELLY, len(BATHED)),
        _sound("caught", "a cloth catches water, coupled both ways or one way", CLOTH, len(CAUGHT)),
        _sound("spilled", "water falls on the rim of a cloth, and beside it", "spilled", len(SPILLED)),
        _looks("reordered", "particles in another order in every frame", _reordered, 1.0, 1e3),
        _looks("renamed", "other ids, the same in every frame", _renamed, 1.0, 1e6),
        _looks("elsewhere", "another origin for the same places", _elsewhere, 1e-3, 0.05, "m"),
        _looks("blurred", "places off by single precision", _blurred, 1e-9, 1e-7, "m"),
        *PARTNER_MECHANISMS,
    ),
)
