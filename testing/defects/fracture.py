"""Seeded defects of bodies that break: bonds that break without a cause or hold too much, logs that lie, pieces that hang, jump or vanish.

Every world is run by the engine first (`testing/defects/_fracture_scenes.py`). A broken one is then changed in one way that physics rules out, and the
records are changed with it; or its specification is, so that what was run is no longer what was declared.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from ...worlds.arrays import F64
from ...worlds.bonds import WORLD
from ...worlds.categories.fracture.pieces import piece_overlap
from ...worlds.spec import WorldSpec
from ._films import Film
from ._fracture_scenes import film, root_stress
from .cases import Mechanism, Suite, World

__all__ = ["SUITE"]

Maker = Callable[[Path, float, np.random.Generator], World]
NAME = "wall"
BREAKING = ("struck", "crossfire", "unpropped", "dropped")
APART = 0.25
"""[m] How far a piece that is alone is from all others: farther than what falls and tumbles sweeps between two frames."""
EVENT = ("time", "bond", "point", "cause", "ratio", "energy", "case")


def _any(rng: np.random.Generator, *kinds: str) -> Film:
    return film(str(rng.choice(list(kinds or BREAKING))), rng)


def _standing(rng: np.random.Generator, *kinds: str) -> Film:
    """A world of these kinds in which some bonds hold to the end."""
    while True:
        made = _any(rng, *kinds)
        if len(_holding(made)):
            return made


def _world(made: Film, folder: Path) -> World:
    return World(made.candidate(folder), (NAME, "rigid", "beam"))


def _hits(made: Film) -> list[int]:
    """Frames in which bonds break."""
    return [k for k, f in enumerate(made.frames) if len(f["break/time"])]


def _holding(made: Film) -> Any:
    """Bonds that hold to the end."""
    return np.flatnonzero(made.frames[-1]["bond/broken"] == 0)


def _select(frame: dict[str, Any], keep: Any) -> None:
    """Leave these events in a frame's log."""
    for name in EVENT:
        frame[f"break/{name}"] = frame[f"break/{name}"][keep]


def _loose(made: Film) -> list[str]:
    """Pieces that broke off alone: all their bonds are broken at the end."""
    bonds = made.built[NAME].bonds
    assert bonds is not None
    held = np.unique(bonds.pieces[made.frames[-1]["bond/broken"][: len(bonds)] == 0])
    return [b.name for k, b in enumerate(made.built[NAME].bodies) if k not in held]


def _flying(rng: np.random.Generator) -> tuple[Film, str, int]:
    """A world in which a piece that broke off is `APART` from all that stands or moves at a frame and the next; and these."""
    while True:
        made = _any(rng, "dropped")
        found = _lonely(made)
        if found:
            return (made, *found[int(rng.integers(len(found)))])


def _lonely(made: Film) -> list[tuple[str, int]]:
    """Pieces and frames at which they are apart."""
    centers, reach = made.series("position"), []
    for name in made.index.bodies:
        entity, body = name.split("/", 1)
        reach.append(max(float(np.linalg.norm(p.render.vertices, axis=1).max()) for p in made.built[entity].parts_of(body)))
    still = [e for e in made.spec.entities.values() if e.motion == "static"]
    middle, half = np.array([e.pose.position for e in still]), 0.5 * np.array([e.dimensions.size for e in still])
    found = []
    for piece in _loose(made):
        row = made.row(NAME, piece)
        for k in range(_hits(made)[0] + 1, made.count - 1):
            gaps = []
            for here, there in ((k, k), (k, k + 1), (k + 1, k + 1)):
                others = np.linalg.norm(centers[there] - centers[here, row], axis=1) - np.array(reach)
                others[row] = np.inf
                outside = np.maximum(np.abs(centers[here, row] - middle) - half, 0.0)
                gaps.append(min(float(others.min()), float(np.linalg.norm(outside, axis=1).min())) - reach[row])
            if min(gaps) > APART:
                found.append((piece, k))
    return found


def _declare(made: Film, change: Callable[[dict[str, Any]], None]) -> Film:
    """The same motion under another specification."""
    data = made.spec.model_dump(mode="json")
    change(data)
    return dataclasses.replace(made, spec=WorldSpec.model_validate(data))


# ---------------------------------------------------------------- causes


def unloaded(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """The loads under which the bonds of one moment broke are less by a share than what breaks them."""
    made = _any(rng, "struck", "crossfire", "dropped")
    data = made.frames[int(rng.choice(_hits(made)))]
    case = int(rng.choice(data["break/case"]))
    start = int(data["case/count"][:case].sum())
    rows = slice(start, start + int(data["case/count"][case]))
    worst = float(data["break/ratio"][data["break/case"] == case].max())
    data["case/load"][rows] *= (1.0 - magnitude) / worst
    return _world(made, folder)


def spontaneous(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A bond that nothing loads breaks, with an event, a ratio and an energy as if something had."""
    made = _standing(rng, "struck", "held", "unpropped")
    bonds = made.built[NAME].bonds
    assert bonds is not None
    bond, first = int(rng.choice(_holding(made))), int(rng.integers(1, made.count))
    data = made.frames[first]
    point = made.spec.entities[NAME].pose.position + bonds.point[bond]
    case = len(data["case/count"])
    told = {
        "time": (first - 0.5) * made.duration,
        "bond": bond,
        "point": point,
        "cause": -1,
        "ratio": magnitude,
        "energy": 1e-3,
        "case": case,
    }
    for name, value in told.items():
        held = data[f"break/{name}"]
        data[f"break/{name}"] = np.concatenate([held, np.asarray(value, dtype=held.dtype).reshape(1, *held.shape[1:])])
    data["case/count"] = np.append(data["case/count"], np.int32(0))
    data["case/spin"] = np.concatenate([data["case/spin"], np.zeros((1, 3))])
    for frame in made.frames[first:]:
        frame["bond/broken"][bond] = 1
        frame["record/fracture_energy"] = np.float64(frame["record/fracture_energy"] + 1e-3)
    return _world(made, folder)


def early(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """All bonds of the first break do so some frames before the blow, their log with them."""
    made = _any(rng, "struck", "crossfire", "dropped")
    hit = _hits(made)[0]
    then = max(1, hit - max(1, round(magnitude)))
    moved = {n: v for n, v in made.frames[hit].items() if n.startswith(("break/", "case/"))}
    for name in moved:
        made.frames[hit][name], made.frames[then][name] = made.frames[then][name], moved[name]
    made.frames[then]["break/time"] = made.frames[then]["break/time"] - (hit - then) * made.duration
    for frame in made.frames[then:hit]:
        for name in ("bond/broken", "record/fracture_energy"):
            frame[name] = made.frames[hit][name].copy()
    return _world(made, folder)


def stranger(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A share of the events names a body as its cause that never touched."""
    made = _any(rng)
    witness, done = made.index.colliders.index("witness"), False
    for k in _hits(made):
        cause = made.frames[k]["break/cause"]
        chosen = rng.random(len(cause)) < magnitude
        if not done and not chosen.any():
            chosen[int(rng.integers(len(cause)))] = True
        cause[chosen], done = witness, True
    return _world(made, folder)


def nameless(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A share of the events says that weight alone broke the bond, where a blow did."""
    made = _any(rng, "struck", "crossfire", "dropped")
    cause = made.frames[_hits(made)[0]]["break/cause"]
    chosen = rng.random(len(cause)) < magnitude
    chosen[int(rng.integers(len(cause)))] = True
    cause[chosen] = -1
    return _world(made, folder)


def untouched(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """The named cause of the broken bonds is in no contact."""
    del magnitude
    made = _any(rng, "struck", "crossfire", "dropped")
    own = made.index.colliders.index(NAME)
    causes = {int(c) for k in _hits(made) for c in made.frames[k]["break/cause"] if c >= 0} - {own}
    for frame in made.frames:
        pairs = frame["contact/pair"]
        mine = np.isin(pairs, list(causes)).any(axis=1) & (pairs == own).any(axis=1)
        for name in [n for n in frame if n.startswith("contact/")]:
            frame[name] = frame[name][~mine]
    return _world(made, folder)


def stronger(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """Bonds are declared stronger, by a factor, than those that broke."""
    made = _any(rng)

    def change(data: dict[str, Any]) -> None:
        bond = data["entities"][NAME]["breakable"]["bond"]
        bond |= {k: magnitude * bond[k] for k in ("tension", "shear")} | {"friction": min(2.0, magnitude * bond["friction"])}

    return _world(_declare(made, change), folder)


# ---------------------------------------------------------------- what should have broken


def overstressed(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A bond bears more than its strength in a frame, and holds."""
    made = _standing(rng, "struck", "held", "propped", "unpropped")
    bond = int(rng.choice(_holding(made)))
    made.frames[int(rng.integers(1, made.count))]["bond/stress"][bond] = np.float32(magnitude)
    return _world(made, folder)


def weaker(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """Bonds that hold are declared weaker than what the weight alone asks of them."""
    made = _any(rng, "propped")

    def change(data: dict[str, Any]) -> None:
        data["entities"][NAME]["breakable"]["bond"]["tension"] = root_stress(made.spec.entities[NAME]) / magnitude

    return _world(_declare(made, change), folder)


# ---------------------------------------------------------------- the log


def heals(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A share of the broken bonds is whole again from a frame on."""
    made = _any(rng)
    first = int(rng.integers(_hits(made)[0] + 1, made.count))
    gone = np.flatnonzero(made.frames[first - 1]["bond/broken"])
    count = max(1, round(magnitude * len(gone)))
    for frame in made.frames[first:]:
        frame["bond/broken"][rng.permutation(gone)[:count]] = 0
    return _world(made, folder)


def silent(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A share of the breaks has no event."""
    made = _any(rng)
    data = made.frames[int(rng.choice(_hits(made)))]
    keep = rng.random(len(data["break/time"])) >= magnitude
    keep[int(rng.integers(len(keep)))] = False
    lost = float(data["break/energy"][~keep].sum())
    hit = next(k for k, f in enumerate(made.frames) if f is data)
    _select(data, keep)
    for frame in made.frames[hit:]:
        frame["record/fracture_energy"] = np.float64(frame["record/fracture_energy"] - lost)
    return _world(made, folder)


def untimely(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """An event lies beside its frame, by a share of one."""
    made = _any(rng)
    hit = int(rng.choice(_hits(made)))
    time = made.frames[hit]["break/time"]
    time[int(rng.integers(len(time)))] = (hit + magnitude if rng.random() < 0.5 else hit - 1 - magnitude) * made.duration
    return _world(made, folder)


def elsewhere(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """An event is not where its bond was [m]."""
    made = _any(rng)
    point = made.frames[_hits(made)[0]]["break/point"]
    way = rng.normal(size=3)
    point[int(rng.integers(len(point)))] += magnitude * way / np.linalg.norm(way)
    return _world(made, folder)


def overspent(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """The record of what broken bonds took is another than that of the events [J]."""
    made = _any(rng)
    for frame in made.frames[int(rng.integers(1, made.count)) :]:
        frame["record/fracture_energy"] = np.float64(frame["record/fracture_energy"] + magnitude)
    return _world(made, folder)


def unrecorded(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A channel is missing from a frame on."""
    made = _any(rng)
    names = ("bond/broken", "bond/stress", "break/bond", "case/load", "load/impulse")
    for frame in made.frames[int(rng.integers(made.count)) :]:
        del frame[names[int(magnitude) % len(names)]]
    return _world(made, folder)


# ---------------------------------------------------------------- pieces


def drifts(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A piece whose bonds hold moves away from what it is bonded to [m]."""
    made = _standing(rng, "struck", "held", "crossfire", "unpropped")
    bonds = made.built[NAME].bonds
    assert bonds is not None
    piece = made.built[NAME].bodies[int(bonds.pieces[int(rng.choice(_holding(made))), 0])].name
    way = rng.normal(size=3)
    late = np.clip(np.arange(made.count) - int(rng.integers(made.count - 1)), 0, 1)[:, None]
    made.add("position", NAME, late * magnitude * way / np.linalg.norm(way), piece)
    made.settle_records()
    return _world(made, folder)


def hangs(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A piece that broke off hangs in the air for some frames, held by no bond and near nothing."""
    made, piece, first = _flying(rng)
    last = first + max(2, round(magnitude))
    for channel in ("position", "quaternion", "velocity", "angular_velocity"):
        held = made.series(channel, NAME, piece)
        held[first:last] = held[first] if channel in ("position", "quaternion") else 0.0
        made.put(channel, held, NAME, piece)
    made.settle_records()
    return _world(made, folder)


def thrown(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A piece in the air is given a speed by nothing [m/s]."""
    made, piece, before = _flying(rng)
    way, first = rng.normal(size=3), before + 1
    late = np.clip(np.arange(made.count) - first + 1, 0, None)[:, None] * made.duration
    change = magnitude * way / np.linalg.norm(way)
    made.add("velocity", NAME, np.where(late > 0, change, 0.0), piece)
    made.add("position", NAME, (late - 0.5 * made.duration * (late > 0)) * change, piece)
    made.settle_records()
    return _world(made, folder)


def burst(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """At the break, the pieces of a body that falls get a speed that the blow does not give [m/s]."""
    made = _any(rng, "dropped")
    hit, way = _hits(made)[0], rng.normal(size=3)
    change = magnitude * way / np.linalg.norm(way)
    late = np.clip(np.arange(made.count) - hit + 1, 0, None)[:, None] * made.duration
    for body in made.built[NAME].bodies:
        made.add("velocity", NAME, np.where(late > 0, change, 0.0), body.name)
        made.add("position", NAME, (late - 0.5 * made.duration * (late > 0)) * change, body.name)
    made.settle_records()
    return _world(made, folder)


def vanishes(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A piece that broke off is elsewhere from a frame on [m]: under the ground, or gone."""
    made = _any(rng)
    piece = str(rng.choice(_loose(made) or [made.built[NAME].bodies[0].name]))
    first = int(rng.integers(_hits(made)[0] + 1, made.count))
    way = np.array([0.0, 0.0, -1.0]) if rng.random() < 0.5 else rng.normal(size=3)
    late = (np.arange(made.count) >= first)[:, None]
    made.add("position", NAME, late * magnitude * way / np.linalg.norm(way), piece)
    return _world(made, folder)


def lighter(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """Mass is lost at the break, by a share."""
    made = _any(rng)
    for frame in made.frames[_hits(made)[0] :]:
        frame["record/mass"] = np.float64(frame["record/mass"] * (1.0 - magnitude))
    return _world(made, folder)


def _rebuilt(made: Film, folder: Path, **more: Any) -> World:
    made.built[NAME] = dataclasses.replace(made.built[NAME], **more)
    return _world(made, folder)


def shrunken(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A piece is smaller than what was cut, by a share of its edges."""
    return _smaller(_any(rng), folder, magnitude, rng)


def sherd(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """The same of a pot."""
    return _smaller(_any(rng, "potted"), folder, magnitude, rng)


def _smaller(made: Film, folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    parts = list(made.built[NAME].parts)
    k = int(rng.integers(len(parts)))
    vertices: F64 = parts[k].render.vertices
    middle = vertices.mean(axis=0)
    render = dataclasses.replace(parts[k].render, vertices=middle + (1.0 - magnitude) * (vertices - middle))
    parts[k] = dataclasses.replace(parts[k], render=render)
    return _rebuilt(made, folder, parts=tuple(parts))


def hollow(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A piece weighs less than its volume, by a share."""
    bodies = list((made := _any(rng)).built[NAME].bodies)
    k = int(rng.integers(len(bodies)))
    bodies[k] = dataclasses.replace(bodies[k], mass=(1.0 - magnitude) * bodies[k].mass)
    return _rebuilt(made, folder, bodies=tuple(bodies))


def overlapping(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A piece reaches into its neighbour deeper than its broken face crumbles."""
    made = _any(rng, "struck", "held", "crossfire", "unpropped")
    bonds = made.built[NAME].bonds
    assert bonds is not None
    inner = np.flatnonzero(bonds.pieces[:, 1] != WORLD)
    bond = int(rng.choice(inner))
    name = made.built[NAME].bodies[int(bonds.pieces[bond, 0])].name
    breakable = made.spec.entities[NAME].breakable
    assert breakable is not None
    shift = magnitude * piece_overlap(breakable, made.built[NAME]) * bonds.frame[bond, 0]
    parts = tuple(
        dataclasses.replace(p, render=dataclasses.replace(p.render, vertices=p.render.vertices + shift)) if p.body == name else p
        for p in made.built[NAME].parts
    )
    return _rebuilt(made, folder, parts=parts)


# ---------------------------------------------------------------- sound worlds


def _sound(name: str, text: str, *kinds: str) -> Mechanism:
    return Mechanism(name, text, False, lambda folder, _, rng: World(_any(rng, *kinds).candidate(folder)), 1.0, 2.0, "1")


def _shuffled(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """Contacts of every frame are listed in another order."""
    del magnitude
    made = _any(rng)
    for frame in made.frames:
        order = rng.permutation(len(frame["contact/pair"]))
        for name in [n for n in frame if n.startswith("contact/")]:
            frame[name] = frame[name][order]
    return World(made.candidate(folder))


def _far(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """Another margin of a bound that nothing comes near: a stronger mortar that never broke [factor]."""
    made = _any(rng, "held")

    def change(data: dict[str, Any]) -> None:
        bond = data["entities"][NAME]["breakable"]["bond"]
        bond |= {k: magnitude * bond[k] for k in ("tension", "shear")}

    return World(_declare(made, change).candidate(folder))


def _defect(name: str, build: Maker, low: float, high: float, unit: str, bound: float | None = None, **more: Any) -> Mechanism:
    assert build.__doc__ is not None
    return Mechanism(name, build.__doc__, True, build, low, high, unit, bound, **more)


SUITE = Suite(
    "category",
    (
        _defect("unloaded", unloaded, 0.25, 0.999, "1"),
        _defect("spontaneous", spontaneous, 1.001, 1e3, "strengths"),
        _defect("early", early, 1.0, 4.0, "frames"),
        _defect("stranger", stranger, 0.01, 1.0, "1"),
        _defect("nameless", nameless, 0.01, 1.0, "1"),
        _defect("untouched", untouched, 1.0, 1.0, "1"),
        _defect("stronger", stronger, 1.05, 100.0, "1"),
        _defect("overstressed", overstressed, 1.01, 50.0, "strengths", 1.0),
        _defect("weaker", weaker, 1.3, 30.0, "strengths", 1.25),
        _defect("heals", heals, 0.01, 1.0, "1"),
        _defect("silent", silent, 0.01, 1.0, "1"),
        _defect("untimely", untimely, 0.001, 5.0, "frames"),
        _defect("elsewhere", elsewhere, 1.2, 20.0, "m"),
        _defect("overspent", overspent, 1e-4, 10.0, "J"),
        _defect("unrecorded", unrecorded, 1.0, 5.0, "channel", finds=("unverified",)),
        _defect("drifts", drifts, 1e-6, 0.1, "m"),
        _defect("hangs", hangs, 2.0, 5.0, "frames"),
        _defect("thrown", thrown, 0.01, 5.0, "m/s"),
        _defect("burst", burst, 2.0, 20.0, "m/s"),
        _defect("vanishes", vanishes, 1.0, 100.0, "m"),
        _defect("lighter", lighter, 1e-8, 0.5, "1", 1e-9),
        _defect("shrunken", shrunken, 1e-3, 0.3, "1"),
        _defect("sherd", sherd, 1e-3, 0.3, "1"),
        _defect("hollow", hollow, 1e-5, 0.5, "1", 1e-6),
        _defect("overlapping", overlapping, 1.05, 8.0, "allowed depths", 1.0, check="interpenetration"),
        _sound("struck", "a ball breaks a wall in part", "struck"),
        _sound("held", "a ball hits a wall softly, which holds", "held"),
        _sound("crossfire", "two balls hit a wall from both sides", "crossfire"),
        _sound("unpropped", "a beam breaks by its weight when its support goes", "unpropped"),
        _sound("propped", "a beam bears most of what it can", "propped"),
        _sound("chain", "a shelf breaks and falls on another, which breaks", "chain"),
        _sound("dropped", "a free plate falls on a post and breaks", "dropped"),
        _sound("potted", "a hollow pot falls and breaks", "potted"),
        Mechanism("shuffled", "contacts in another order", False, _shuffled, 1.0, 2.0, "1"),
        Mechanism("stronger mortar", "a mortar that holds is declared stronger", False, _far, 1.0, 10.0, "1"),
    ),
)
