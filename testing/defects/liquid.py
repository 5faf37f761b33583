"""Seeded defects of liquids: gaps, walls, bodies that sink through, volume taken from the cache, forged books, popping surfaces.

Sound worlds are closed-form motions (`testing/defects/_liquid_scenes.py`). A broken one is changed in one way, and whatever an adversary
would change with it (ledgers, records, what boundaries gave) is changed too.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...worlds.arrays import F64
from ...worlds.spec import Pose
from ..worlds import small_worlds as sw
from ..worlds.liquid_worlds import DENSITY, Flow, stream
from . import _liquid_scenes as scenes
from ._liquid_fields import drawn, undrawn
from ._liquid_resolution import (
    apex,
    clinging,
    film,
    ledge,
    narrow_way,
    parted,
    slot,
    slotted,
    thin_pool,
    thin_wall,
    tight_drain,
    tight_tap,
)
from ._liquid_scenes import SPACING
from ._liquid_stages import feeding, overdrained, overfilled
from ._liquid_waves import flat_waves, slow_waves, waving
from ._liquid_wet import dried, drowned, shifted, wetted
from .cases import Mechanism, Suite, World

__all__ = ["SUITE"]

Rows = NDArray[np.int64]
Maker = Callable[[Path, float, np.random.Generator], World]
LIQUID = "water"
"""Rows that name no solid name the instance."""


def _broken(flow: Flow, folder: Path, *culprits: str) -> World:
    return World(flow.candidate(folder), culprits or (LIQUID,))


def _some(flow: Flow, share: float, rng: np.random.Generator) -> Rows:
    """Rows of about a share of the particles, at least one."""
    count = max(1, round(share * len(flow.position[0])))
    return rng.choice(len(flow.position[0]), count, replace=False)


def _shifted(flow: Flow, rows: Rows, offset: F64, first: int) -> Flow:
    """A copy in which some particles are elsewhere from a frame on."""
    made = flow.edited()
    for k in range(first, flow.frames):
        made.position[k][rows] += offset
    return made


# ---------------------------------------------------------------- walls


def gap(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    return _broken(scenes.draining(rng, gap=magnitude), folder, "tank")


def through_wall(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """Particles next to a wall walk out through it within a frame."""
    flow = scenes.pool(rng)
    points = flow.position[0]
    wall = flow.spec.entities["tank"].parts["p0"].shape.size[0]  # type: ignore[union-attr]
    edge = np.flatnonzero((points[:, 0] > points[:, 0].max() - 0.5 * SPACING) & (points[:, 2] > 2 * SPACING))
    rows = rng.choice(edge, min(len(edge), round(magnitude)), replace=False)
    first = int(rng.integers(3, flow.frames - 3))
    way, h = np.array([wall + SPACING, 0.0, 0.0]), 1.0 / 24
    made = _shifted(flow, rows, way, first)
    # The speed of the way, so that they do not jump.
    for k in (first - 1, first):
        made.velocity[k][rows] = way / h / 1.2
    return _broken(made, folder, "tank")


def in_wall(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A particle sinks into the floor by `magnitude` [m] and stays."""
    flow = scenes.pool(rng, wall=0.04)
    bottom = np.flatnonzero(flow.position[0][:, 2] < SPACING)
    rows = rng.choice(bottom, 1)
    made = flow.edited()
    first = int(rng.integers(2, flow.frames - 4))
    for k in range(flow.frames):
        share = float(np.clip((k - first) / 3, 0.0, 1.0))
        made.position[k][rows, 2] = 0.5 * SPACING - share * (magnitude + 0.5 * SPACING)
    return _broken(made, folder, "tank")


def walled_source(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """The opening of an inflow reaches `magnitude` [m] into a wall."""
    width = 0.08
    side = float(rng.uniform(0.1, 0.3))
    post = sw.box(side, side, 0.2, at=(width / 2 + side / 2 - magnitude, 0.0, 0.8))
    return _broken(stream(others={"post": post}), folder, "post")


# ---------------------------------------------------------------- books


def volume_removed(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A share of the particles is gone from a frame on, records and all."""
    flow = scenes.pool(rng)
    rows = _some(flow, magnitude, rng)
    first = int(rng.integers(2, flow.frames))
    keep = np.ones(len(flow.position[0]), dtype=bool)
    keep[rows] = False
    made = flow.edited()
    for k in range(first, flow.frames):
        made.position[k], made.velocity[k], made.identity[k] = (
            x[keep] for x in (made.position[k], made.velocity[k], made.identity[k])
        )
    return _broken(made, folder)


def counted_out(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """The same, booked as having left through an open side, which they were nowhere near."""
    flow = scenes.pool(rng)
    points = flow.position[0]
    amid = np.flatnonzero((np.abs(points[:, :2]) < np.abs(points[:, :2]).max(axis=0) - 2.5 * SPACING).all(axis=1))
    rows = rng.choice(amid, min(len(amid), max(1, round(magnitude * len(points)))), replace=False)
    first = int(rng.integers(2, flow.frames))
    keep = np.ones(len(flow.position[0]), dtype=bool)
    keep[rows] = False
    made = flow.edited(left=np.where(np.arange(flow.frames) >= first, len(rows) * flow.volume * DENSITY, 0.0))
    for k in range(first, flow.frames):
        made.position[k], made.velocity[k], made.identity[k] = (
            x[keep] for x in (made.position[k], made.velocity[k], made.identity[k])
        )
    return _broken(made, folder)


def shrunk(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """Every particle has lost a share of its volume from a frame on; records still tell the old one."""
    flow = scenes.pool(rng)
    first = int(rng.integers(2, flow.frames))
    change = dict(flow.change)
    for k in range(first, flow.frames):
        change[k, "particle/volume"] = np.full(len(flow.position[k]), flow.volume * (1 - magnitude), dtype=np.float32)
    return _broken(flow.edited(change=change), folder)


def cooked_records(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    flow = scenes.slosh(rng)
    name = str(rng.choice(["mass", "volume", "kinetic_energy", "potential_energy"]))
    clean = flow.candidate(folder / "clean").caches[LIQUID]
    series = np.array([float(clean.read(k)[f"record/{name}"]) for k in range(flow.frames)])
    size = (
        flow.volume * DENSITY * len(flow.position[0]) * 9.81 * SPACING
        if name == "potential_energy"
        else float(np.abs(series).max())
    )
    k = int(rng.integers(1, flow.frames))
    value = series[k] + magnitude * size * rng.choice([-1.0, 1.0])
    return _broken(flow.edited(change={(k, f"record/{name}"): np.array(value)}), folder)


def forged_reaction(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """The liquid's recorded loss to a boundary is larger than the impulse it gave."""
    flow = scenes.crate_afloat(rng)
    k, given = int(rng.integers(1, flow.frames)), flow.impulses()
    row = int(rng.integers(len(flow.colliders)))
    reaction = -given[k]
    reaction[row] *= 1.0 + magnitude
    return _broken(flow.edited(change={(k, "exchange/reaction"): reaction}), folder, flow.colliders[row].split("/")[0])


def unequal_sides(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """The body received less than the liquid gave."""
    flow = scenes.crate_afloat(rng)
    received = np.array(flow.rigid["exchange/impulse"])
    received[int(rng.integers(1, flow.frames))] *= 1.0 - magnitude
    return _broken(flow.edited(rigid={**flow.rigid, "exchange/impulse": received}), folder, "crate")


# ---------------------------------------------------------------- motion


def sinks_through(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A crate half as dense as water sinks at `magnitude` g: the liquid gives it that share of its weight less."""
    return _broken(scenes.crate_afloat(rng, sinking=magnitude), folder, "crate")


def teleport(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """One particle is `magnitude` spacings elsewhere from a frame on, upwards into the air."""
    flow = scenes.slosh(rng)
    rows = np.array([int(np.argmax(flow.position[0][:, 2] + 1e-3 * rng.random(len(flow.position[0]))))])
    first = int(rng.integers(2, flow.frames - 1))
    return _broken(_shifted(flow, rows, np.array([0.0, 0.0, magnitude * SPACING]), first), folder)


def spike(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """One particle shoots up at `magnitude` times the speed that energy allows, and its way fits."""
    flow = scenes.pool(rng)
    points = flow.position[0]
    row = int(np.argmax(points[:, 2]))
    height = float(np.ptp(points[:, 2])) + 2 * SPACING
    speed = 4.0 * magnitude * float(np.sqrt(2 * 9.81 * height))
    first = int(rng.integers(3, flow.frames - 2))
    made = flow.edited()
    for k in range(first, flow.frames):
        t = (k - first) / 24
        made.position[k][row, 2] += speed * t - 0.5 * 9.81 * t * t
        made.velocity[k][row, 2] = speed - 9.81 * t
    return _broken(made.drained(), folder)


def hovering(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A chunk of water falls with a share of g missing."""
    flow = scenes.falling(rng)
    made = flow.edited()
    top = made.position[0].copy()
    for k in range(flow.frames):
        t = k / 24
        made.position[k] = top - np.array([0, 0, 0.5 * 9.81 * (1 - magnitude) * t * t])
        made.velocity[k] = np.tile([0.0, 0.0, -9.81 * (1 - magnitude) * t], (len(top), 1))
    return _broken(made, folder)


def boiling(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """Still water whose particles quiver at `magnitude` m/s in their places."""
    flow = scenes.pool(rng, frames=30)
    made = flow.edited()
    for k in range(flow.frames):
        way = rng.normal(size=made.velocity[k].shape)
        made.velocity[k] = magnitude * way / np.linalg.norm(way, axis=1)[:, None]
    return _broken(made, folder)


def drifting(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """All of a falling block's water speeds up sideways by `magnitude` g without anything that pushes it."""
    flow = scenes.falling(rng)
    made = flow.edited()
    side = 9.81 * magnitude
    for k in range(flow.frames):
        t = k / 24
        made.position[k] = made.position[k] + np.array([0.5 * side * t * t, 0, 0])
        made.velocity[k] = made.velocity[k] + np.array([side * t, 0, 0])
    return _broken(
        made.edited(change={(k, f"exchange/{n}"): np.zeros((1, 6)) for k in range(flow.frames) for n in ("impulse", "reaction")}),
        folder,
    )


def rising(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """Swaying water gains energy: its amplitude grows by a share over the frames."""
    flow = scenes.slosh(rng, amplitude=0.012, frames=36)
    mean = 0.5 * (np.max(flow.position, axis=0) + np.min(flow.position, axis=0))
    made = flow.edited()
    for k in range(flow.frames):
        grown = 1.0 + magnitude * k / flow.frames
        made.position[k] = mean + (made.position[k] - mean) * grown
        made.velocity[k] = made.velocity[k] * grown
    return _broken(made, folder)


def crushed(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """The pool is pressed together by a share along x, while recorded densities stay those at rest."""
    flow = scenes.pool(rng)
    made = flow.edited()
    for k in range(flow.frames):
        made.position[k][:, 0] *= 1.0 / (1.0 + magnitude)
    return _broken(made, folder)


# ---------------------------------------------------------------- surfaces


def _with_surface(flow: Flow, grown: Callable[[int], float] = lambda k: 0.0) -> Flow:
    return flow.edited(surface=lambda k, p: scenes.sheet(p, top=grown(k)))


def popping(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """The surface stands higher by a share of the depth at one frame."""
    flow = scenes.pool(rng)
    depth = float(np.ptp(flow.position[0][:, 2])) + SPACING
    frame = int(rng.integers(1, flow.frames))
    return _broken(_with_surface(flow, lambda k: magnitude * depth if k == frame else 0.0), folder)


def stray_chunk(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A piece of surface hangs `magnitude` spacings above all particles for one frame."""
    flow = scenes.pool(rng)
    frame = int(rng.integers(1, flow.frames))

    def surface(k: int, points: F64) -> tuple[F64, F64]:
        vertices, faces = scenes.sheet(points, top=0.0)
        if k != frame:
            return vertices, faces
        block = points[:8].mean(axis=0) + np.array([[0, 0, 0.0]])
        high = np.array([block[0, 0], block[0, 1], points[:, 2].max() + magnitude * SPACING])
        more, extra = scenes.sheet(np.stack([high - 0.2 * SPACING, high + 0.2 * SPACING]), top=0.0, margin=-0.3 * SPACING)
        return np.concatenate([vertices, more]), np.concatenate([faces, extra + len(vertices)])

    return _broken(flow.edited(surface=surface), folder)


# ---------------------------------------------------------------- sound ones


def _sound(make: Callable[[np.random.Generator, float], Flow]) -> Maker:
    def build(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
        return World(make(rng, magnitude).candidate(folder))

    return build


def _beside_wall(rng: np.random.Generator, magnitude: float) -> Flow:
    """The opening ends `magnitude` [m] beside a wall, along which the water falls."""
    side = float(rng.uniform(0.1, 0.3))
    return stream(others={"post": sw.box(side, side, 0.2, at=(0.04 + side / 2 + magnitude, 0.0, 0.8))})


def _thrown(rng: np.random.Generator, speed: float) -> Flow:
    """A block of water thrown sideways, in free flight."""
    flow = scenes.falling(rng)
    made = flow.edited()
    way = rng.normal(size=2)
    way *= speed / np.linalg.norm(way)
    for k in range(flow.frames):
        made.position[k] = made.position[k] + np.array([*(way * k / 24), 0.0])
        made.velocity[k] = made.velocity[k] + np.array([*way, 0.0])
    pool = flow.spec.entities["pool"]
    physics = pool.physics.model_copy(update={"linear_velocity": (*map(float, way), 0.0)})
    spec = flow.spec.model_copy(update={"entities": {**flow.spec.entities, "pool": pool.model_copy(update={"physics": physics})}})
    return made.edited(spec=spec).drained()


def _turned(rng: np.random.Generator, angle: float) -> Flow:
    """A pool whose tank and water are turned about the vertical."""
    flow = scenes.pool(rng)
    turn = np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
    entities = {
        n: e.model_copy(update={"pose": Pose(position=tuple(turn @ e.pose.position), euler=(0, 0, angle))})
        for n, e in flow.spec.entities.items()
    }
    domain = {"center": (0.0, 0.0, 0.2), "size": (1.2, 1.2, 1.2)}
    plan = flow.spec.simulation
    instance = plan.solvers[LIQUID]
    settings = instance.settings.model_copy(update={"domain": instance.settings.domain.model_copy(update=domain)})  # type: ignore[union-attr]
    solvers = {**plan.solvers, LIQUID: instance.model_copy(update={"settings": settings})}
    spec = flow.spec.model_copy(update={"entities": entities, "simulation": plan.model_copy(update={"solvers": solvers})})
    return flow.edited(spec=spec, position=[p @ turn.T for p in flow.position])


def _defect(name: str, text: str, build: Maker, low: float, high: float, unit: str, bound: float | None = None) -> Mechanism:
    return Mechanism(name, text, True, build, low, high, unit, bound)


def _clean(
    name: str,
    text: str,
    make: Callable[[np.random.Generator, float], Flow],
    low: float = 1.0,
    high: float = 3.0,
    unit: str = "variant",
) -> Mechanism:
    return Mechanism(name, text, False, _sound(make), low, high, unit, named=(low, high))


SUITE = Suite(
    "category",
    (
        _defect("gap", "water drains through a slit in the tank's floor that nothing resolves", gap, 0.0005, 0.008, "m"),
        _defect("through_wall", "particles pass a wall within a frame", through_wall, 2.0, 40.0, "particles", 1.0),
        _defect("in_wall", "a particle lies in the floor", in_wall, 0.0102, 0.014, "m", 0.01),
        _defect("walled_source", "the opening of an inflow reaches into a wall", walled_source, 5e-4, 0.05, "m", 2e-5),
        _defect("volume_removed", "particles are gone from the cache, and from its records", volume_removed, 1e-3, 0.5, "1"),
        _defect("counted_out", "particles vanish amid the pool, booked as outflow", counted_out, 1e-3, 0.5, "1"),
        _defect("overfilled", "an inflow gives though the surface is above the level that it holds", overfilled, 0.1, 0.3, "m"),
        _defect("overdrained", "an outflow takes below the level that it holds", overdrained, 2.1, 8.0, "spacings", 2.0),
        _clean("feeding", "an inflow whose gauge is dry gives all it can", feeding, 0.1, 0.9, "m"),
        _defect("shrunk", "particles lose volume", shrunk, 2e-6, 0.5, "1", 1e-6),
        _defect("cooked_records", "one record at one frame is not that of the particles", cooked_records, 5e-3, 0.5, "1"),
        _defect("forged_reaction", "the liquid's own loss is not what it gave", forged_reaction, 1.05e-5, 0.5, "1", 1e-5),
        _defect("unequal_sides", "a body received less than it was given", unequal_sides, 1.05e-5, 0.5, "1", 1e-5),
        _defect("sinks_through", "a light crate sinks where it should float", sinks_through, 0.35, 1.0, "g", 0.31),
        _defect("teleport", "a particle is elsewhere from one frame to the next", teleport, 1.2, 50.0, "spacings", 0.93),
        _defect("spike", "a particle shoots up faster than energy allows", spike, 1.1, 3.0, "1", 1.0),
        _defect("hovering", "a chunk of water falls too slowly", hovering, 0.26, 1.0, "g", 0.25),
        _defect("boiling", "still water quivers", boiling, 0.08, 0.5, "m/s"),
        _defect("drifting", "water speeds up sideways by itself", drifting, 0.03, 1.0, "g", 0.02),
        _defect("rising", "swaying water gains energy", rising, 0.6, 2.0, "1"),
        _defect("crushed", "water is pressed together while its records say otherwise", crushed, 0.02, 0.5, "1", 0.01),
        _defect("popping", "the surface jumps at one frame", popping, 0.011, 0.5, "1", 0.01),
        _defect("stray_chunk", "a piece of surface where no liquid is", stray_chunk, 3.5, 20.0, "spacings", 2.0),
        _defect("narrow_way", "water stands on both sides of a way that is not resolved", narrow_way, 1.1, 2.97, "spacings"),
        Mechanism(
            "slot",
            "a slot in the floor that its spacing does not see",
            True,
            slot,
            0.0011,
            0.015,
            "m",
            0.001,
            finds=("unverified",),
        ),
        Mechanism("film", "a body floats on a few layers", True, film, 3.0, 4.0, "layers", finds=("unverified",)),
        _clean("joint", "the floor's boards do not quite meet", slotted, 0.0001, 0.0009, "m"),
        _clean("deep enough", "a body floats on enough layers", thin_pool, 5.0, 9.0, "layers"),
        _defect("thin_wall", "walls are thinner than is resolved", thin_wall, 0.1, 0.494, "spacings"),
        _defect("tight_tap", "an inflow is narrower than is resolved", tight_tap, 1.0, 2.99, "spacings"),
        _defect("tight_drain", "an outflow is narrower than is resolved", tight_drain, 0.5, 2.99, "spacings"),
        _defect("clinging", "water stays on a wall over the pool or under a lid", clinging, 3.0, 30.0, "particles", 2.0),
        _defect("dried", "a share of the wet surface is called dry", dried, 0.01, 0.8, "1", 0.005),
        _defect("drowned", "wet places are said to lie deeper than they do", drowned, 0.25, 5.0, "spacings", 0.1),
        _defect("shifted", "places of the wet map lie off the surfaces", shifted, 2e-5, 0.01, "m", 1e-5),
        _defect("flat_waves", "waves lack a share of their declared height", flat_waves, 0.28, 1.0, "1", 0.25),
        _defect("slow_waves", "waves have a longer period than declared", slow_waves, 0.06, 0.5, "1", 0.05),
        _defect("undrawn", "a force field gave less than it says", undrawn, 0.06, 1.0, "1", 0.05),
        _clean("drawn", "a field draws falling water aside", lambda rng, m: drawn(rng, pull=m), 0.5, 20.0, "m/s^2"),
        _clean("waves", "waves travel from one zone to the other", lambda rng, m: waving(rng, height=m), 0.02, 0.04, "m"),
        Mechanism("wetted", "a swaying pool with its wet maps", False, wetted, 0.001, 0.006, "m"),
        _clean("parted", "a way that is just resolved", lambda rng, m: parted(rng, m * SPACING), 3.03, 6.0, "spacings"),
        _clean("ledge", "water lies on a ledge over the pool", ledge, 3.0, 20.0, "particles"),
        _clean("apex", "water is thrown up beside a wall and turns round", apex, 0.3, 2.0, "m/s"),
        _clean("pool", "still water in tanks of many sizes", lambda rng, m: scenes.pool(rng)),
        _clean(
            "turned", "the same, turned about the vertical, so that walls cut the judge's cubes aslant", _turned, 0.1, 0.8, "rad"
        ),
        _clean("slosh", "water sways to and fro", lambda rng, m: scenes.slosh(rng, amplitude=m), 0.001, 0.006, "m"),
        _clean(
            "crate", "a crate floats at its draft", lambda rng, m: scenes.crate_afloat(rng, density=1000.0 * m), 1 / 6, 5 / 6, "1"
        ),
        _clean("falling", "a block of water falls freely", lambda rng, m: scenes.falling(rng)),
        _clean("thrown", "a block of water flies", _thrown, 0.5, 4.0, "m/s"),
        _clean(
            "stream",
            "a stream falls out of an inflow and leaves through the open bottom",
            lambda rng, m: stream(speed=m),
            0.5,
            3.0,
            "m/s",
        ),
        _clean("beside_wall", "a source just beside a wall", _beside_wall, 1e-4, 0.05, "m"),
        _clean(
            "hole",
            "water falls through a hole that is many spacings wide",
            lambda rng, m: scenes.draining(rng, gap=m, wide=True),
            0.07,
            0.14,
            "m",
        ),
        _clean("shown", "a pool with the surface that it is shown with", lambda rng, m: _with_surface(scenes.pool(rng))),
        _clean(
            "breathing",
            "a surface that breathes by less than the bound",
            lambda rng, m: _with_surface(scenes.pool(rng), lambda k: m * SPACING * (k % 2)),
            1e-3,
            0.05,
            "spacings",
        ),
    ),
)
