"""Seeded defects of gas: caches of a small room with smoke, changed in one way, and sound ones that look suspicious.

A sound room is simulated once per kind (seconds) and kept; a broken one is that cache changed by a magnitude, or judged by another specification.
Each defect has to be found by the rows that are there to find it.
"""

from __future__ import annotations

import dataclasses
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from ...worlds.cache import Cache, write_container
from ...worlds.candidate import Candidate
from ...worlds.spec import WorldSpec
from ..worlds.small_gas import SMOKE_PROMPT
from ..worlds.small_worlds import build_all
from . import _carried_changes as carried
from . import _fire_changes as fires
from . import _following_changes as following
from . import _gas_changes as changes
from . import _kindling_changes as kindling
from . import _returned_changes as returned
from . import _steam_changes as steam
from ._gas_changes import Change
from ._gas_scenes import KINDS, SOLVER, scene, scene_spec
from .cases import Mechanism, Suite, World

__all__ = ["SUITE"]

Build = Callable[[Path, float, np.random.Generator], World]


def _edited(
    base: Candidate, folder: Path, change: Change, magnitude: float, rng: np.random.Generator, solver: str = SOLVER
) -> Candidate:
    other = folder / solver
    shutil.copytree(base.caches[solver].folder, other)
    old, found = base.caches[solver], Cache(other)
    state = rng.bit_generator.state
    for frame in range(found.index.frames):
        data = {k: np.array(v) for k, v in old.read(frame).items()}
        rng.bit_generator.state = state  # every frame is changed alike
        change(frame, data, magnitude, rng, old)
        write_container(found.path(frame), data)
    fresh = dataclasses.replace(base)
    vars(fresh)["caches"] = {**base.caches, solver: Cache(other)}
    return fresh


def _breaks(change: Change, *rows: str, kinds: tuple[str, ...] = ("room", "maccormack")) -> Build:
    """Broken frames, to be found by some of the rows."""

    def build(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
        base = scene(kinds[int(rng.integers(len(kinds)))])
        return World(_edited(base, folder, change, magnitude, rng), tuple(_question(r) for r in rows))

    return build


def _carried(change: Change, kind: str, solver: str) -> Build:
    """Broken frames of what a gas carries, to be found by the row about its pushes."""

    def build(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
        return World(_edited(scene(kind), folder, change, magnitude, rng, solver), ("category:gas:pushed",))

    return build


def _question(row: str) -> str:
    return row if ":" in row else f"category:gas:{row}"


def _told(place: Callable[[dict[str, Any], float], None], *rows: str, kind: str = "room") -> Build:
    """Sound frames of another specification than that by which they are judged."""

    def build(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
        base, document = scene(kind), scene_spec(kind)
        place(document, magnitude)
        spec = WorldSpec.model_validate({"prompt": SMOKE_PROMPT, **document})
        fresh = dataclasses.replace(base, spec=spec, built=build_all(spec))
        return World(fresh, tuple(_question(r) for r in rows))

    return build


def _late(document: dict[str, Any], magnitude: float) -> None:
    document["simulation"]["drivers"]["fire"]["start"] = magnitude


def _weaker(document: dict[str, Any], magnitude: float) -> None:
    document["simulation"]["drivers"]["fire"]["rate"] *= 1.0 - magnitude


def _blunter(document: dict[str, Any], magnitude: float) -> None:
    """A body that is carried is told to be blunter than it was."""
    document["simulation"]["solvers"][SOLVER]["settings"]["coefficient"] *= 1.0 + magnitude


def _unlifted(document: dict[str, Any], magnitude: float) -> None:
    """A card that is carried is told to have no lift."""
    document["entities"]["card"]["physics"]["lift"] = False


def _airier(document: dict[str, Any], magnitude: float) -> None:
    """The sheet that is carried is told to catch more air than it did."""
    document["entities"]["sheet"]["physics"]["drag"] = 1.2 * (1.0 + magnitude)


def _softer(document: dict[str, Any], magnitude: float) -> None:
    """Impacts raise less dust than there is."""
    document["simulation"]["drivers"]["kick"]["per_energy"] *= 1.0 - magnitude


def _cooler(document: dict[str, Any], magnitude: float) -> None:
    """Hot matter is told to be less hot than it was."""
    document["simulation"]["drivers"]["boils"]["temperature"] *= 1.0 - magnitude


def _wide(document: dict[str, Any], magnitude: float) -> None:
    """Steam comes in balls that stand out of the box."""
    document["simulation"]["drivers"]["boils"]["radius"] = magnitude


def _heavy(document: dict[str, Any], magnitude: float) -> None:
    document["simulation"]["gravity"] = [0.0, 0.0, 9.81 * magnitude]


def _thick(document: dict[str, Any], magnitude: float) -> None:
    """A block where the frames have open air."""
    box = {"size": [magnitude] * 3}
    document["entities"]["plate"].update(dimensions=box, pose={"position": [-0.2, 0.0, 0.35]})
    document["entities"]["plate"]["parts"]["plate"]["shape"] = {"kind": "box", **box}


def _covered(document: dict[str, Any], magnitude: float) -> None:
    """The plate lies in the source."""
    document["entities"]["plate"]["pose"]["position"] = [0.0, 0.0, 0.13 - magnitude]


def _narrow(document: dict[str, Any], magnitude: float) -> None:
    """A source narrower than cells show."""
    document["entities"]["smoke"]["parts"]["source"]["shape"] = {"kind": "cylinder", "radius": 0.5 * magnitude, "height": 0.1}


def _far_spark(document: dict[str, Any], magnitude: float) -> None:
    """The spark is far from the fuel."""
    document["simulation"]["drivers"]["spark"] |= {"center": [0.35, 0.35, 0.6 - magnitude], "radius": 0.04}


def _lean(document: dict[str, Any], magnitude: float) -> None:
    """Less of the gas is fuel than burnt."""
    document["entities"]["smoke"]["physics"]["fuel_share"] = 1.0 - magnitude


def _looks(kinds: tuple[str, ...], change: Change = changes.still) -> Build:
    def build(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
        return World(_edited(scene(kinds[int(rng.integers(len(kinds)))]), folder, change, magnitude, rng))

    return build


BURNING = ("fire", "burner")
KINDLED = ("kindled", "torch", "hung")
QUENCHED = ("quench",)
FOLLOWED = ("followed",)
FELT = ("felt", "swarm")
BROKEN = (
    Mechanism("fade", "soot is lost from a frame on", True, _breaks(changes.fade, "soot"), 2e-4, 0.9, "1"),
    Mechanism("grow", "soot comes from nowhere", True, _breaks(changes.grow, "soot"), 2e-4, 0.9, "1"),
    Mechanism("forge", "the record of soot is too large", True, _breaks(changes.forge, "records"), 2e-4, 0.5, "1"),
    Mechanism("slip", "soot is told to have left, and nothing flowed out", True, _breaks(changes.slip, "escape"), 0.1, 0.9, "1"),
    Mechanism("withhold", "heat is lost from a frame on", True, _breaks(changes.withhold, "heat"), 3e-4, 0.9, "1"),
    Mechanism(
        "vent_heat", "heat is told to have left, and nothing flowed out", True, _breaks(changes.vent_heat, "escape_heat"), 0.12, 0.9, "1"
    ),
    Mechanism(
        "overfeed", "a source lets out too much soot, and all books say so", True, _breaks(changes.overfeed, "emitted"), 2e-3, 0.9, "1"
    ),
    Mechanism("misread", "more gas is told to have come than drivers let out", True, _breaks(changes.misread, "emitted"), 2e-3, 0.9, "1"),
    Mechanism("late", "the source began before its driver", True, _told(_late, "emitted"), 2e-3, 0.3, "s"),
    Mechanism("weaker", "the source let out more than its driver says", True, _told(_weaker, "emitted"), 2e-3, 0.9, "1"),
    Mechanism("teleport", "soot is where the gas has not come", True, _breaks(changes.teleport, "continuity"), 0.03, 0.5, "1", 0.02),
    Mechanism("stall", "frames repeat the one before", True, _breaks(changes.stall, "carried", "soot"), 1.0, 4.0, "frames"),
    Mechanism("jump", "all smoke stands aside from a frame on", True, _breaks(changes.jump, "continuity", "carried"), 2.0, 6.0, "cells"),
    Mechanism("haze", "a hole in even smoke", True, _breaks(changes.haze, "gaps"), 0.06, 1.0, "1"),
    Mechanism("chill", "gas colder than the air", True, _breaks(changes.chill, "temperature"), 3.0, 60.0, "K"),
    Mechanism("scorch", "gas hotter than its source", True, _breaks(changes.scorch, "temperature"), 5.0, 900.0, "K"),
    Mechanism("owe", "soot below none", True, _breaks(changes.owe, "dense"), 0.03, 1.0, "1", 0.02),
    Mechanism("clot", "soot denser than at the source", True, _breaks(changes.clot, "dense"), 0.4, 3.0, "1"),
    Mechanism("spout", "air goes up out of nothing", True, _breaks(changes.spout, "divergence", kinds=("cold",)), 0.02, 2.0, "m/s"),
    Mechanism("press", "all air runs apart", True, _breaks(changes.press, "divergence"), 0.02, 2.0, "m/s"),
    Mechanism("hurry", "all gas is faster than its source lets it", True, _breaks(changes.hurry, "outflow"), 2e-3, 1.0, "1"),
    Mechanism("whirl", "a wheel of air turns out of nothing", True, _breaks(changes.whirl, "energy"), 0.1, 2.0, "m/s"),
    Mechanism("heavy", "hot gas rose where gravity pulls it down", True, _told(_heavy, "energy"), 0.3, 3.0, "g"),
    Mechanism("unsolved", "the pressure was not solved", True, _breaks(changes.unsolved, "projection"), 1.2e-4, 1.0, "1", 1e-4),
    Mechanism("wall_up", "closed cells in open air", True, _breaks(changes.wall_up, "room", kinds=("cold",)), 1.0, 9.0, "cells", 0.0),
    Mechanism("thick", "gas where a block stands", True, _told(_thick, "room"), 0.2, 0.35, "m"),
    Mechanism("covered", "a plate lies in the source", True, _told(_covered, "source"), 0.04, 0.08, "m"),
    Mechanism("narrow", "a source narrower than cells show", True, _told(_narrow, "resolved"), 0.02, 0.095, "m", 0.1),
    Mechanism("drift_off", "the box stands beside its source", True, _breaks(changes.drift_off, "continuity"), 0.15, 0.5, "m"),
    Mechanism(
        "seep", "soot in a closed cell", True, _breaks(changes.seep, "inside", kinds=("block",)), 2e-3, 1.0, "1", 1e-3
    ),
    Mechanism("shower", "more dust than impacts raise, and all books say so", True, _breaks(changes.overfeed, "emitted", kinds=("dust",)), 2e-3, 0.9, "1"),
    Mechanism("softer", "impacts raised more dust than is declared", True, _told(_softer, "emitted", kind="dust"), 2e-3, 0.9, "1"),
    Mechanism("hop", "all dust stands aside from a frame on", True, _breaks(changes.jump, "continuity", "carried", kinds=("dust",)), 2.0, 6.0, "cells"),
    Mechanism("geyser", "more steam than boils, and all books of the gas say so", True, _breaks(changes.overfeed, "emitted", kinds=QUENCHED), 2e-3, 0.9, "1"),
    Mechanism("scald", "more heat and steam than contacts give", True, _breaks(steam.scald, "boiled", kinds=QUENCHED), 2e-3, 1.0, "1"),
    Mechanism("sprawl", "a larger contact than there is", True, _breaks(steam.sprawl, "boiled", kinds=QUENCHED), 2e-3, 1.0, "1"),
    Mechanism("cooler", "what is hot was hotter than is told", True, _told(_cooler, "boiled", "emitted", kind="quench"), 2e-3, 0.5, "1"),
    Mechanism("perpetual", "hot matter gives heat and keeps it", True, _breaks(steam.perpetual, "quenched", kinds=QUENCHED), 1e-3, 1.0, "1", 1e-4),
    Mechanism("dilute", "less steam than its heat makes", True, _breaks(steam.dilute, "quenched", "boiled", kinds=QUENCHED), 2e-3, 0.9, "1"),
    Mechanism("parch", "much of the water boils off, and its liquid keeps it", True, _breaks(steam.parch, "kept", kinds=QUENCHED), 0.06, 1.0, "1"),
    Mechanism("astray", "steam would come above the box", True, _told(_wide, "above", kind="quench"), 0.6, 2.0, "m"),
    Mechanism("shove", "a body got more from the gas than its stream gives", True, _carried(carried.shove, "borne", "bodies"), 0.06, 2.0, "1"),
    Mechanism("sideways", "a body was pushed across the stream", True, _carried(carried.sideways, "borne", "bodies"), 0.08, 1.0, "1"),
    Mechanism("puffing", "a sheet got more from the gas than its stream gives", True, _carried(carried.puffing, "waved", "sheets"), 0.08, 2.0, "1"),
    Mechanism("gale", "a faster stream than that which carried", True, _breaks(carried.gale, "pushed", kinds=("borne", "waved")), 0.06, 1.0, "1"),
    Mechanism("blunter", "what is carried was less blunt than is told", True, _told(_blunter, "pushed", kind="borne"), 0.06, 3.0, "1"),
    Mechanism("airier", "a sheet that is carried caught less air than is told", True, _told(_airier, "pushed", kind="waved"), 0.08, 2.0, "1"),
    Mechanism("forget", "a gas lost less than what it carries got", True, _breaks(returned.forget, "returned", kinds=FELT), 3e-3, 1.0, "1"),
    Mechanism("redouble", "it lost more", True, _breaks(returned.redouble, "returned", kinds=FELT), 3e-3, 1.0, "1"),
    Mechanism("invert", "it got what it should have lost", True, _breaks(returned.invert, "returned", kinds=FELT), 0.01, 1.0, "1"),
    Mechanism("miscount", "its cells lost more than all of it", True, _breaks(returned.miscount, "returned", kinds=FELT), 3e-3, 1.0, "1"),
    Mechanism("displace", "it lost that beside what it carries", True, _breaks(returned.displace, "returned_there", kinds=("felt",)), 8.0, 12.0, "cells"),
    Mechanism("unlift", "a card got less lift from the gas than its stream gives, none (1) or the opposite (2)", True, _carried(carried.unlift, "glided", "bodies"), 0.15, 2.0, "1"),
    Mechanism("overlift", "a card got more lift than that, twice as much (1)", True, _carried(carried.overlift, "glided", "bodies"), 0.15, 2.0, "1"),
    Mechanism("unlifted", "a card that the gas lifted declares no lift", True, _told(_unlifted, "pushed", kind="glided"), 1.0, 1.0, "1"),
    Mechanism("forget_lift", "a gas lost less than a card that it lifts got", True, _breaks(returned.forget, "returned", kinds=("deflected",)), 3e-3, 1.0, "1"),
    Mechanism("arrive", "smoke at the sides of the part that follows it", True, _breaks(following.arrive, "arrived", kinds=FOLLOWED), 2e-3, 1.0, "1", 1e-3),
    Mechanism("ooze", "smoke left the part that follows it", True, _breaks(following.ooze, "slipped", kinds=FOLLOWED), 2e-4, 0.9, "1", 1e-4),
    Mechanism("stir", "air moves outside the part that follows", True, _breaks(following.stir, "beyond", kinds=FOLLOWED), 1e-3, 2.0, "m/s", 0.0),
    Mechanism("leave_behind", "a source outside the part that follows", True, _breaks(following.leave_behind, "followed", kinds=FOLLOWED), 1.0, 6.0, "cells"),
    Mechanism("embezzle", "fuel is lost, burnt or not", True, _breaks(fires.embezzle, "fuel", kinds=BURNING), 2e-4, 0.9, "1"),
    Mechanism("lean", "more fuel came than the source has", True, _told(_lean, "fuel", kind="burner"), 2e-3, 0.9, "1"),
    Mechanism("flatter", "more heat than the fuel that burnt has", True, _breaks(fires.flatter, "burnt", kinds=BURNING), 0.01, 1.0, "1"),
    Mechanism("smother", "more soot than the fuel makes", True, _breaks(fires.smother, "burnt", kinds=BURNING), 0.01, 0.3, "1"),
    Mechanism("dim", "flames weaker than is told", True, _breaks(fires.dim, "released", kinds=BURNING), 0.5, 0.95, "1"),
    Mechanism("ghost", "flames in cold air without fuel", True, _breaks(fires.ghost, "flames", kinds=BURNING), 5e-3, 1.0, "1", 1e-3),
    Mechanism("blast", "a cell burns harder than flames do", True, _breaks(fires.blast, "flames", kinds=BURNING), 0.01, 3.0, "1"),
    Mechanism("leap", "fire where no hot gas came", True, _breaks(fires.leap, "lit", kinds=BURNING), 0.05, 1.0, "1", 1e-3),
    Mechanism("far_spark", "the spark was somewhere else", True, _told(_far_spark, "lit", "flames", kind="burner"), 0.05, 0.15, "m"),
    Mechanism("stuff", "more products than gas", True, _breaks(fires.stuff, "oxygen", kinds=BURNING), 0.03, 3.0, "1", 0.02),
    Mechanism("gloom", "flames radiate too little", True, _breaks(fires.gloom, "radiated", kinds=BURNING), 0.05, 1.0, "1", 0.02),
    Mechanism("glare", "cold air radiates", True, _breaks(fires.glare, "radiated", kinds=BURNING), 0.05, 1.0, "1", 0.02),
    Mechanism("pilfer", "surfaces lose more than they give", True, _breaks(kindling.pilfer, "gasified", kinds=KINDLED), 1e-3, 1.0, "1", 1e-4),
    Mechanism("regrow", "mass comes back to surfaces", True, _breaks(kindling.regrow, "gasified", kinds=KINDLED), 1e-3, 1.0, "1", 1e-4),
    Mechanism("smoulder", "a cold surface gives gas", True, _breaks(kindling.smoulder, "kindled", kinds=KINDLED), 5e-3, 1.0, "1", 1e-3),
    Mechanism("blister", "surfaces get heat from nowhere", True, _breaks(kindling.blister, "heated", kinds=KINDLED), 0.5, 5.0, "1", 0.05),
    Mechanism("freeze", "heat of surfaces is lost", True, _breaks(kindling.freeze, "stored", kinds=KINDLED), 1e-3, 1.0, "1", 1e-4),
    Mechanism("gift", "surfaces took more than they hold", True, _breaks(kindling.gift, "stored", kinds=KINDLED), 1e-3, 1.0, "1", 1e-4),
    Mechanism("hollow", "less of a part can burn than it has", True, _breaks(kindling.hollow, "surfaces", kinds=KINDLED), 0.01, 0.5, "1", 1e-3),
    Mechanism("shrink", "pieces do not cover their part", True, _breaks(kindling.shrink, "surfaces", kinds=KINDLED), 0.01, 0.5, "1", 1e-3),
    Mechanism("lag", "pieces stay behind what carries them", True, _breaks(kindling.lag, "carried_along", kinds=("torch", "hung")), 0.01, 1.0, "1"),
    Mechanism("shuffle", "pieces stand aside from their parts", True, _breaks(kindling.shuffle, "carried_along", kinds=KINDLED), 1e-3, 0.2, "m"),
    Mechanism("sear", "cloth that is consumed takes heat", True, _breaks(kindling.sear, "heated", kinds=("hung",)), 0.1, 3.0, "1", 0.05),
    Mechanism("hellish", "gas hotter than any flame", True, _breaks(fires.forge, "temperature", kinds=BURNING), 1.0, 2000.0, "K"),
    Mechanism(
        "blank", "numbers that are none", True, _breaks(changes.blank, "numerical:finite"), 1.0, 500.0, "numbers", check="numerical"
    ),
    Mechanism("bolt", "air faster than anything may be", True, _breaks(changes.bolt, "numerical:speed"), 61.0, 500.0, "m/s", check="numerical"),
    Mechanism(
        "capped", "steps that ended at the cap", True, _breaks(changes.capped, "numerical:iterations"), 0.03, 1.0, "1", 0.02, check="numerical"
    ),
    Mechanism("skip", "a frame with too few steps", True, _breaks(changes.skip, "numerical:counters"), 1.0, 1.0, "steps", check="numerical"),
)  # fmt: skip
CLEAN = (
    *(Mechanism(kind, f"as simulated: {kind}", False, _looks((kind,)), 1.0, 1.0, "1") for kind in KINDS),
    Mechanism("rounded", "fields off by single precision", False, _looks(("room", "hot"), changes.rounded), 1e-9, 1e-7, "1"),
)
SUITE = Suite("category", (*BROKEN, *CLEAN))
