"""Frames that a probe takes over from an earlier run: the same bytes as a run from the start, and none where an edit acts from the start."""

from __future__ import annotations

import copy
import hashlib
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import pytest
from worldagent.construction.build import build_entity
from worldagent.simulation.freeze import open_freeze
from worldagent.simulation.origins import RECORD, Origins, Taken, taken_in
from worldagent.simulation.schedule import run_frames
from worldagent.testing.worlds.small_cloth import FLAG_PROMPT, flag_spec
from worldagent.testing.worlds.small_gas import FIRE_PROMPT, SMOKE_PROMPT, fire_spec, stirred_spec
from worldagent.testing.worlds.small_grains import SAND_PROMPT, SPARK_PROMPT, sand_spec, spark_spec
from worldagent.testing.worlds.small_liquids import PROMPT as TANK_PROMPT
from worldagent.testing.worlds.small_liquids import jelly_tank_spec, tank_spec
from worldagent.tests.physics import rigid_world
from worldagent.worlds import bake_plan
from worldagent.worlds.built import BuiltEntity
from worldagent.worlds.cache import Cache
from worldagent.worlds.coarsening import write_overrides
from worldagent.worlds.folder import WorldFolder
from worldagent.worlds.patch import parse_spec
from worldagent.worlds.spec import WorldSpec

FPS = 24
EVERY = 2
"""Frames between checkpoints in these tests."""
FRAMES = 9
LATE = 4 / FPS
"""When most drivers of these worlds begin [s]: at a checkpoint."""
Document = dict[str, Any]
Edit = Callable[[Document], None]


@pytest.fixture(autouse=True)
def _often(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bake_plan, "CHECKPOINT_SECONDS", EVERY / FPS)


def _bodies() -> Document:
    """Balls on a floor, one held, one pushed, a door with a motor, a weld that opens, a plate on a path; gusts come late."""
    key = [
        {"time": t, "pose": {"position": [1.0, x, 0.3]}}
        for t, x in ((0.0, 0.0), (0.2, 0.0), (0.25, 0.1), (0.3, 0.3), (0.4, 0.35))
    ]
    entities = {
        "floor": rigid_world.floor(),
        "held": rigid_world.ball(0.1, at=(0, 0, 0.4)),
        "pushed": rigid_world.box(0.2, 0.2, 0.2, at=(0.5, 0.5, 0.102)),
        "free": rigid_world.ball(0.1, at=(-0.5, 0, 0.15), v=(0.3, 0, 0)),
        "door": rigid_world.box(0.4, 0.05, 0.4, at=(-1.5, 0, 0.5)),
        "hung": rigid_world.ball(0.1, at=(0, 1.5, 0.6)),
        "plate": rigid_world.box(0.2, 0.2, 0.1, at=(1.0, 0, 0.3), motion="kinematic"),
    }
    joints = {
        "hinge": {"kind": "hinge", "child": "door", "anchor": (-1.7, 0, 0.5), "axis": (0, 0, 1)},
        "weld": {"kind": "weld", "child": "hung", "anchor": (0, 1.5, 0.6)},
    }
    drivers = {
        "hold": {"kind": "release", "entity": "held", "time": LATE},
        "push": {"kind": "force", "entity": "pushed", "force": (30, 0, 0), "start": LATE, "end": 8 / FPS},
        "motor": {"kind": "motor", "joint": "hinge", "velocity": 2.0, "max_effort": 5.0, "start": LATE, "end": 8 / FPS},
        "cut": {"kind": "detach", "joint": "weld", "time": LATE},
        "way": {"kind": "path", "entity": "plate", "keys": {f"k{n}": k for n, k in enumerate(key)}},
        "gust": {"kind": "field", "field": {"kind": "wind", "velocity": (6, 0, 0)}, "start": LATE, "end": 8 / FPS},
    }
    spec = rigid_world.world(entities, seconds=(FRAMES - 1) / FPS, restitution=0.3, joints=joints, drivers=drivers)
    return spec.model_dump(mode="json", exclude_none=True)


def _jelly() -> Document:
    spec = jelly_tank_spec(frames=FRAMES, spacing=0.06)
    spec["simulation"]["drivers"]["let_go"]["time"] = LATE
    return {**spec, "prompt": TANK_PROMPT}


def _tank(engine: str) -> Document:
    """A crate over water, held; water comes in late."""
    grid = engine == "flip"
    spec = tank_spec(frames=FRAMES, spacing=0.03 if grid else 0.05, engine=engine, coupled=not grid, closed=grid, crate_at=0.3)
    tap = {"kind": "inflow", "entity": "water", "pose": {"position": [0.1, 0, 0.42], "euler": [3.141592653589793, 0, 0]},
           "size": [0.12, 0.12], "speed": 1.0, "start": LATE}  # fmt: skip
    hold = {"kind": "release", "entity": "crate", "time": LATE}
    wind = {"kind": "field", "entities": ["water"], "field": {"kind": "wind", "velocity": [4, 0, 0]}, "start": LATE}
    spec["simulation"]["drivers"] = {"tap": tap, "hold": hold, "wind": wind}
    return {**spec, "prompt": TANK_PROMPT}


def _sand() -> Document:
    spec = sand_spec(frames=FRAMES, radius=0.016, preroll=0.02, ball_at=0.13)
    spec["simulation"]["drivers"]["hold"]["time"] = LATE
    spec["simulation"]["drivers"]["wind"] = {"kind": "field", "field": {"kind": "wind", "velocity": [9, 0, 0]}, "start": LATE}
    return {**spec, "prompt": SAND_PROMPT}


def _sparks() -> Document:
    spec = spark_spec(frames=FRAMES)
    spec["simulation"]["drivers"]["grinder"]["start"] = 1 / FPS
    spec["simulation"]["drivers"]["second"] = {
        **copy.deepcopy(spec["simulation"]["drivers"]["grinder"]),
        "start": LATE,
        "rate": 900.0,
    }
    spec["simulation"]["drivers"]["gust"] = {"kind": "field", "field": {"kind": "wind", "velocity": [5, 0, 0]}, "start": LATE}
    return {**spec, "prompt": SPARK_PROMPT}


def _smoke() -> Document:
    spec = stirred_spec(frames=FRAMES, resolution=0.1)
    spec["simulation"]["drivers"]["second"] = {"kind": "emission", "entity": "smoke", "rate": 0.003, "start": LATE}
    spec["simulation"]["drivers"]["wind"]["start"] = LATE
    return {**spec, "prompt": SMOKE_PROMPT}


def _flag() -> Document:
    spec = flag_spec(frames=FRAMES, resolution=0.2)
    spec["simulation"]["drivers"]["breeze"]["start"] = LATE
    return {**spec, "prompt": FLAG_PROMPT}


def _far(spec: Document, solver: str = "bodies") -> Document:
    """The world with a block that stands far away."""
    spec["materials"]["brick"] = {"density": 1800.0, "friction": 0.7}
    spec["entities"]["far"] = {
        "role": "block", "motion": "static", "material": "brick", "dimensions": {"size": [0.2, 0.2, 0.2]},
        "pose": {"position": [9.0, 0, 0.2]}, "parts": {"p": {"shape": {"kind": "box", "size": [0.2, 0.2, 0.2]}}},
    }  # fmt: skip
    spec["simulation"]["solvers"][solver]["members"].append("far")
    return spec


def _still_sand() -> Document:
    return {**sand_spec(frames=FRAMES, radius=0.016, preroll=0.02, ball_at=None), "prompt": SAND_PROMPT}


WORLDS: dict[str, Callable[[], Document]] = {
    "bodies": _bodies,
    "jelly in water": _jelly,
    "particles": lambda: _tank("dfsph"),
    "grid": lambda: _tank("flip"),
    "sand": _sand,
    "still sand": lambda: _far(_still_sand()),
    "sparks": lambda: _far(_sparks()),
    "smoke": lambda: _far(_smoke()),
    "hot": lambda: _far({**fire_spec(frames=FRAMES, resolution=0.1), "prompt": FIRE_PROMPT}),
    "flag": _flag,
}


def _set(pointer: str, value: Any) -> Edit:
    """Sets a member of a document; None takes it away."""

    def edit(document: Document) -> None:
        *way, last = pointer.strip("/").split("/")
        at = document
        for name in way:
            at = at[name]
        if value is None:
            del at[last]
        else:
            at[last] = value

    return edit


def _driver(name: str, field: str, value: Any) -> Edit:
    return _set(f"simulation/drivers/{name}/{field}", value)


FORCE = {"kind": "force", "entity": "free", "force": [0, 9, 0], "start": LATE, "end": 1.0}
ALL = 5
"""Frames 0 to 4, the last checkpoint before most drivers begin."""
SOON = 3
"""The same where steps of an engine do not end exactly where a driver begins."""


class Case(NamedTuple):
    world: str
    edit: Edit
    taken: dict[str, int]


CASES = {
    "force": Case("bodies", _driver("push", "force", [0, 40, 5]), {"main": ALL}),
    "torque, of a frame later": Case("bodies", _driver("push", "start", 5 / FPS), {"main": ALL}),
    "earlier force": Case("bodies", _driver("push", "start", 3 / FPS), {"main": SOON}),
    "end of a force": Case("bodies", _driver("push", "end", 7 / FPS), {"main": 7}),
    "another body": Case("bodies", _driver("push", "entity", "free"), {"main": ALL}),
    "added force": Case("bodies", _set("simulation/drivers/late", FORCE), {"main": ALL}),
    "first added force": Case("bodies", _set("simulation/drivers/a", FORCE), {"main": ALL}),
    "force taken away": Case("bodies", _set("simulation/drivers/push", None), {"main": ALL}),
    "release": Case("bodies", _driver("hold", "time", 6 / FPS), {"main": ALL}),
    "motor": Case("bodies", _driver("motor", "start", 6 / FPS), {"main": ALL}),
    "detach": Case("bodies", _driver("cut", "time", 6 / FPS), {"main": ALL}),
    "last key of a path": Case("bodies", _driver("way", "keys/k4/pose/position", [1.0, 0.5, 0.3]), {"main": 5}),
    "third key of a path that waits": Case("bodies", _driver("way", "keys/k2/pose/position", [1.0, 0.2, 0.3]), {"main": 5}),
    "wind": Case("bodies", _driver("gust", "field/velocity", [9, 9, 0]), {"main": ALL}),
    "end of a wind": Case("bodies", _driver("gust", "end", 7 / FPS), {"main": 7}),
    "longer": Case("bodies", _set("simulation/frames", FRAMES + 4), {"main": FRAMES}),
    "shorter": Case("bodies", _set("simulation/frames", FRAMES - 2), {"main": FRAMES - 2}),
    "release of jelly": Case("jelly in water", _driver("let_go", "time", 6 / FPS), {"rigid": ALL, "water": ALL}),
    "release over particles": Case("particles", _driver("hold", "time", 6 / FPS), {"rigid": ALL, "water": ALL}),
    "tap into particles": Case("particles", _driver("tap", "start", 6 / FPS), {"rigid": SOON, "water": SOON}),
    "wind over particles": Case("particles", _driver("wind", "field/velocity", [8, 0, 0]), {"rigid": ALL, "water": ALL}),
    "release over a grid": Case("grid", _driver("hold", "time", 6 / FPS), {"rigid": ALL, "water": ALL}),
    "tap into a grid": Case("grid", _driver("tap", "start", 6 / FPS), {"rigid": FRAMES, "water": SOON}),
    "wind over a grid": Case("grid", _driver("wind", "rise", 0.1), {"rigid": FRAMES, "water": ALL}),
    "speed of a tap": Case("grid", _driver("tap", "speed", 1.2), {"rigid": FRAMES}),
    "spacing of a grid that only reads": Case("grid", _set("entities/water/physics/resolution", 0.028), {"rigid": FRAMES}),
    "release over sand": Case("sand", _driver("hold", "time", 6 / FPS), {"bodies": ALL, "grains": ALL}),
    "wind over sand": Case("sand", _driver("wind", "field/velocity", [0, 20, 0]), {"bodies": ALL, "grains": ALL}),
    "later emitter": Case("sparks", _driver("second", "rate", 300.0), {"bodies": FRAMES, "flight": SOON}),
    "emitter turned": Case("sparks", _driver("second", "pose/euler", [0, -1.0, 0]), {"bodies": FRAMES, "flight": SOON}),
    "wind over sparks": Case("sparks", _driver("gust", "field/velocity", [0, 0, 5]), {"bodies": FRAMES, "flight": ALL}),
    "later emission": Case("smoke", _driver("second", "start", 6 / FPS), {"bodies": FRAMES, "air": SOON}),
    "wind over smoke": Case("smoke", _driver("wind", "field/velocity", [2, 0, 0]), {"bodies": FRAMES, "air": ALL}),
    "force on a crate that a grid reads": Case(
        "grid", _set("simulation/drivers/late", {**FORCE, "entity": "crate"}), {"rigid": ALL, "water": ALL}
    ),
    "far block and sand": Case("still sand", _set("entities/far/pose/position", [9.0, 1.0, 0.2]), {"grains": FRAMES}),
    "far block and sparks": Case("sparks", _set("entities/far/pose/position", [9.0, 1.0, 0.2]), {"flight": FRAMES}),
    "roughness of a far block and sparks": Case("sparks", _set("materials/brick/friction", 0.2), {"flight": FRAMES}),
    "far block and smoke": Case("smoke", _set("entities/far/pose/position", [9.0, 1.0, 0.2]), {"air": FRAMES}),
    "wind at a flag": Case("flag", _driver("breeze", "field/velocity", [3, 3, 0]), {"rigid": FRAMES, "cloth": ALL}),
}
"""Edits that act later than frame 0, and the frames that each instance takes over."""

REFUSED = {
    "added release": Case("bodies", _set("simulation/drivers/h", {"kind": "release", "entity": "free", "time": LATE}), {}),
    "release taken away": Case("bodies", _set("simulation/drivers/hold", None), {}),
    "release of another body": Case("bodies", _driver("hold", "entity", "free"), {}),
    "speed of a later motor": Case("bodies", _driver("motor", "velocity", 3.0), {}),
    "effort of a later motor": Case("bodies", _driver("motor", "max_effort", 9.0), {}),
    "motor taken away": Case("bodies", _set("simulation/drivers/motor", None), {}),
    "detach taken away": Case("bodies", _set("simulation/drivers/cut", None), {}),
    "second key of a path": Case("bodies", _driver("way", "keys/k1/pose/position", [1.0, 0.01, 0.3]), {}),
    "still air for wind": Case("bodies", _driver("gust", "field", {"kind": "drag"}), {}),
    "fewer bodies in a wind": Case("bodies", _driver("gust", "entities", ["free"]), {}),
    "wind taken away": Case("bodies", _set("simulation/drivers/gust", None), {}),
    "force from the start": Case("bodies", _driver("push", "start", 0.0), {}),
    "friction": Case("bodies", _set("materials/m/friction", 0.4), {}),
    "mass": Case("bodies", _set("entities/free/physics/mass", 1.0), {}),
    "place of a body that only lies there": Case("bodies", _set("entities/floor/pose/position", [0, 0, -0.501]), {}),
    "gravity": Case("bodies", _set("simulation/gravity", [0, 0, -9.8]), {}),
    "seed": Case("bodies", _set("simulation/seed", 5), {}),
    "step": Case("bodies", _set("simulation/solvers/main/settings", {"step": 4e-4}), {}),
    "fastened": Case(
        "bodies",
        _set("graph", {"relations": {"f": {"kind": "fastened", "a": "free", "b": "floor", "max_depth": 0.01, "reason": "for this test alone"}}}),
        {},
    ),
    "rate of a later emission": Case("smoke", _driver("second", "rate", 0.004), {"bodies": FRAMES}),
    "another emitter": Case("sparks", _set("simulation/drivers/third", {"kind": "emitter", "entity": "sparks", "rate": 9.0, "speed": 1.0, "start": LATE}), {"bodies": FRAMES}),
    "speed of a tap into particles": Case("particles", _driver("tap", "speed", 1.1), {}),
    "block that comes near and sparks": Case("sparks", _set("entities/far/pose/position", [1.5, 0, 0.2]), {}),
    "block that comes near and smoke": Case("smoke", _set("entities/far/pose/position", [0.4, 0, 0.2]), {}),
    "roughness of the floor and sparks": Case("sparks", _set("materials/stone/friction", 0.2), {}),
    "roughness of the tray and sand": Case("still sand", _set("materials/wood/friction", 0.2), {}),
    "far block and fire": Case("hot", _set("entities/far/pose/position", [9.0, 1.0, 0.2]), {}),
    "preroll": Case("sand", _set("simulation/preroll", 0.04), {}),
    "radius of sand": Case("sand", _set("entities/sand/physics/radius", 0.017), {}),
}  # fmt: skip
"""Edits that look later and act earlier, or change the layout: the group runs from the start."""


class World(NamedTuple):
    spec: WorldSpec
    built: dict[str, BuiltEntity]


def _world(document: Document) -> World:
    spec = parse_spec(document)
    return World(spec, {n: build_entity(spec, n, Path()) for n in spec.entities})


def _probe(folder: WorldFolder, world: World, *, frames: int | None = None, alone: bool = False) -> Path:
    """Run a world in its candidate; alone: without what other candidates have."""
    freeze = open_freeze(folder, world.spec, world.built, dict.fromkeys(world.built, "nowhere"), 1)
    root = folder.candidate(freeze) / "probe"
    reuse = False if alone else Origins(root, world.spec, world.built)
    run_frames(world.spec, world.built, root, frames=frames or world.spec.simulation.frames, reuse=reuse)
    return root


def _content(root: Path) -> dict[str, bytes]:
    """Everything that a run left but the note of where it came from, and wet maps, whose note says when they were made."""
    return {str(p.relative_to(root)): p.read_bytes() for p in sorted(root.rglob("*")) if p.is_file() and p.name != RECORD}


@pytest.fixture(scope="module")
def first(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], WorldFolder]:
    """A folder with the run of a world of the table."""
    made: dict[str, WorldFolder] = {}

    def of(name: str) -> WorldFolder:
        if name not in made:
            made[name] = WorldFolder(tmp_path_factory.mktemp("first"))
            _probe(made[name], _world(WORLDS[name]()), alone=True)
        return made[name]

    return of


def _copied(folder: WorldFolder, to: Path) -> WorldFolder:
    import shutil

    shutil.copytree(folder.root, to, dirs_exist_ok=True)
    return WorldFolder(to)


@pytest.mark.parametrize("name", [*CASES, *REFUSED])
def test_a_run_that_takes_frames_over_equals_one_from_the_start(
    name: str, first: Callable[[str], WorldFolder], tmp_path: Path
) -> None:
    case = (CASES | REFUSED)[name]
    document = copy.deepcopy(WORLDS[case.world]())
    case.edit(document)
    edited = _world(document)
    assert edited.spec != _world(WORLDS[case.world]()).spec
    taking = _probe(_copied(first(case.world), tmp_path / "taking"), edited)
    fresh = _probe(WorldFolder(tmp_path / "fresh"), edited, alone=True)
    assert {n: t.frames for n, t in taken_in(taking).items()} == case.taken
    assert _content(taking) == _content(fresh)


def _edited(world: str = "sparks") -> World:
    """The world whose second emitter lets out less: frames up to the last checkpoint before it are the same."""
    document = copy.deepcopy(WORLDS[world]())
    _driver("second", "rate", 300.0)(document)
    return _world(document)


def _other(folder: WorldFolder) -> Path:
    """The folder of the only candidate."""
    (record,) = folder.root.glob("candidates/*/candidate.json")
    return record.parent


def _altered(path: Path) -> None:
    """Turn a byte of a file that others share, in a copy of its own."""
    content = bytearray(path.read_bytes())
    content[-40] ^= 1
    path.unlink()
    path.write_bytes(content)


def _of_another_engine(candidate: Path) -> None:
    path = candidate / "candidate.json"
    path.write_text(path.read_text().replace('"source": "', '"source": "0'))


def _of_another_place(candidate: Path) -> None:
    """The record of other settings than those that were simulated: the folder's name is their hash."""
    path = candidate / "candidate.json"
    told = json.loads(path.read_text())
    told["spec"]["simulation"]["drivers"]["grinder"]["speed"] = 4.0
    path.write_text(json.dumps(told))


DAMAGE: dict[str, tuple[Callable[[Path], None], dict[str, int]]] = {
    "a frame": (lambda c: _altered(c / "probe/flight/frame_000002.npz"), {"bodies": FRAMES, "flight": 1}),
    "a checkpoint": (lambda c: _altered(c / "probe/flight/checkpoints/000002.bin"), {"bodies": FRAMES, "flight": 1}),
    "no checkpoint": (lambda c: (c / "probe/flight/checkpoints/000002.bin").unlink(), {"bodies": FRAMES, "flight": 1}),
    "the index": (lambda c: (c / "probe/flight/index.json").write_text("{}"), {"bodies": FRAMES}),
    "the engines": (_of_another_engine, {}),
    "the record": (_of_another_place, {}),
    "a coarser probe": (lambda c: write_overrides(c / "probe", {"/entities/sparks/physics/radius": 0.0015}), {}),
}


@pytest.mark.parametrize("what", DAMAGE)
def test_only_whole_frames_of_the_present_engines_are_taken(
    what: str, first: Callable[[str], WorldFolder], tmp_path: Path
) -> None:
    damage, taken = DAMAGE[what]
    folder, edited = _copied(first("sparks"), tmp_path / "taking"), _edited()
    damage(_other(folder))
    taking = _probe(folder, edited)
    assert {n: t.frames for n, t in taken_in(taking).items()} == taken
    assert _content(taking) == _content(_probe(WorldFolder(tmp_path / "fresh"), edited, alone=True))


def test_a_run_that_ends_early_goes_on_and_its_record_stays_true(first: Callable[[str], WorldFolder], tmp_path: Path) -> None:
    """The longest common past wins; what the run has by then is not taken again, and the record names its origin and digests."""
    folder, edited = _copied(first("sparks"), tmp_path / "taking"), _edited()
    origin = _other(folder)
    taking = _probe(folder, edited, frames=6)
    told = taken_in(taking)["flight"]
    digests = Cache(origin / "probe" / "flight").digests()[:SOON]
    assert told == Taken(f"{origin.name}/probe", SOON, hashlib.sha256("".join(digests).encode()).hexdigest())
    assert _content(_probe(folder, edited)) == _content(_probe(WorldFolder(tmp_path / "fresh"), edited, alone=True))
    assert taken_in(taking)["flight"] == told
    _altered(taking / "flight" / "frame_000002.npz")
    _altered(origin / "probe" / "flight" / "frame_000002.npz")
    again = _probe(folder, edited)
    assert taken_in(again)["flight"].frames == 1
    assert _content(again) == _content(tmp_path / "fresh" / "candidates" / again.parent.name / "probe")


def test_frames_are_shared_on_disk_and_never_written_into(first: Callable[[str], WorldFolder], tmp_path: Path) -> None:
    folder = _copied(first("sparks"), tmp_path / "taking")
    origin = _other(folder) / "probe"
    before = _content(origin)
    taking = _probe(folder, _edited())
    assert (taking / "flight" / "frame_000001.npz").samefile(origin / "flight" / "frame_000001.npz")
    assert not (taking / "flight" / "digests.txt").samefile(origin / "flight" / "digests.txt")
    _probe(folder, _edited(), frames=FRAMES)
    assert _content(origin) == before
