"""Settle runs: things come to rest before frame 0, alike however often, and only what was listed."""

from __future__ import annotations

import dataclasses
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.construction import build_entity
from worldagent.simulation import settling as settle_runs
from worldagent.simulation.origins import checkpoint_path
from worldagent.simulation.probe import replay
from worldagent.simulation.schedule import run_frames
from worldagent.simulation.sealed import from_bytes, to_bytes
from worldagent.testing.worlds.small_bodies import struck_wall_spec
from worldagent.testing.worlds.small_worlds import ball, box, build_all, ground, world
from worldagent.worlds.cache import Cache
from worldagent.worlds.candidate import Candidate, cache_digest
from worldagent.worlds.common_past import Settings, alike_until
from worldagent.worlds.errors import EngineError
from worldagent.worlds.settled import SettledFrames, rest_way, settling, settling_world
from worldagent.worlds.spec import FieldDriver, ForceDriver, HingeJoint, Pose, ReleaseDriver, RigidPhysics, Settle, WorldSpec
from worldagent.worlds.spec.fields import DragField

FRAMES = 14
"""Two checkpoints at 24 frames per second."""


def settled(spec: WorldSpec, *entities: str, max_time: float = 4.0, **plan: Any) -> WorldSpec:
    """The specification with `entities`, by default all, settling."""
    settle = Settle(entities=list(entities), max_time=max_time)
    return spec.model_copy(update={"simulation": spec.simulation.model_copy(update={"settle": settle, **plan})})


def pile() -> WorldSpec:
    """Three bricks let fall askew over one another, and a ball that is held far above them until frame 6."""
    things = {
        "ground": ground(),
        "a": box(0.4, 0.4, 0.1, motion="dynamic", at=(0, 0, 0.06), euler=(0.02, 0, 0)),
        "b": box(0.2, 0.15, 0.1, motion="dynamic", at=(0.02, 0, 0.19), euler=(0, 0.06, 0.3)),
        "c": box(0.2, 0.15, 0.1, motion="dynamic", at=(-0.01, 0.02, 0.33), euler=(0.05, 0.02, 1.0)),
        "ball": ball(0.05, motion="dynamic", at=(0, 0, 1.0)),
    }
    return settled(world(things, frames=FRAMES, drivers={"hold": ReleaseDriver(entity="ball", time=0.25)}))


def run(folder: Path, spec: WorldSpec, **more: Any) -> dict[str, Cache]:
    """The specification's motion in a candidate's folder."""
    return run_frames(spec, built_of(spec.model_dump_json()), folder / "probe", frames=spec.simulation.frames, **more)


@cache
def built_of(document: str) -> Any:
    return build_all(WorldSpec.model_validate_json(document))


@pytest.fixture(scope="module")
def base(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, WorldSpec, dict[str, Cache]]:
    folder, spec = tmp_path_factory.mktemp("pile") / "one", pile()
    return folder, spec, run(folder, spec)


def test_a_pile_rests_at_frame_0_and_what_a_release_holds_is_where_it_was_declared(base: Any) -> None:
    _, spec, caches = base
    assert settling(spec) == ("a", "b", "c")
    cache, kept = caches["rigid"], SettledFrames(caches["rigid"])
    places = cache.series("position")
    rows = {n: cache.body_row(n) for n in ("a", "b", "c", "ball")}
    assert (cache.read(0)["velocity"] == 0.0).all()
    for name in ("a", "b", "c"):
        away = np.linalg.norm(places[:7, rows[name]] - places[0, rows[name]], axis=1)
        assert away.max() <= rest_way(spec, name), "it stays until the ball is let go"
        assert np.linalg.norm(places[0, rows[name]] - spec.entities[name].pose.position) > 0.005, "it came down"
    assert places[0, rows["ball"]] == pytest.approx([0, 0, 1.0], abs=1e-9)
    assert 0.0 < kept.about()["seconds"] < 4.0
    last = kept.files.read(kept.files.index.frames - 1)
    assert (last["position"] == places[0]).all()
    assert np.linalg.norm(places[-1, rows["ball"]] - places[0, rows["ball"]]) > 0.1, "the ball falls at its time"


def test_a_resumed_run_equals_an_unbroken_one_byte_for_byte(base: Any, tmp_path: Path) -> None:
    _, spec, caches = base
    whole = caches["rigid"].digests()

    class StoppedError(Exception):
        pass

    def stop(after: int) -> Any:
        left = [after]

        def check() -> None:
            left[0] -= 1
            if left[0] < 0:
                raise StoppedError

        return check

    rest = round(SettledFrames(caches["rigid"]).about()["seconds"] * spec.simulation.fps)
    for number, after in enumerate((3, rest + FRAMES - 1)):  # within the settle run, and after the last checkpoint
        folder = tmp_path / str(number)
        with pytest.raises(StoppedError):
            run(folder, spec, check=stop(after), reuse=False)
        again = run(folder, spec)
        assert again["rigid"].digests() == whole
        for frame in (0, 12):
            one, two = (checkpoint_path(c["rigid"].folder, frame).read_bytes() for c in (caches, again))
            assert one == two
        assert SettledFrames(again["rigid"]).files.digests() == SettledFrames(caches["rigid"]).files.digests()


def test_an_edit_of_a_driver_does_not_settle_again_and_a_moved_body_does(base: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    folder, spec, caches = base
    runs = []
    real = settle_runs._settled
    monkeypatch.setattr(settle_runs, "_settled", lambda *given: runs.append(given[2]) or real(*given))
    drivers = {**spec.simulation.drivers, "push": ForceDriver(entity="a", force=(300.0, 0, 0), start=0.1, end=0.3)}
    pushed = spec.model_copy(update={"simulation": spec.simulation.model_copy(update={"drivers": drivers, "frames": 10})})
    other = run_frames(pushed, build_all(pushed), folder.with_name("two") / "probe", frames=10)
    assert not runs, "the state at rest is that of the other candidate"
    assert (other["rigid"].read(0)["position"] == caches["rigid"].read(0)["position"]).all()
    assert np.abs(other["rigid"].read(9)["position"] - caches["rigid"].read(9)["position"]).max() > 0.01
    moved = spec.entities["c"].model_copy(
        update={"pose": spec.entities["c"].pose.model_copy(update={"position": (0.0, 0.0, 0.33)})}
    )
    elsewhere = spec.model_copy(update={"entities": {**spec.entities, "c": moved}})
    run_frames(elsewhere, build_all(elsewhere), folder.with_name("three") / "probe", frames=2)
    assert runs == [("rigid",)]


def test_drivers_story_and_frames_are_no_part_of_the_settling_world(base: Any) -> None:
    _, spec, _ = base
    fewer = spec.model_copy(update={"simulation": spec.simulation.model_copy(update={"drivers": {}, "frames": 3})})
    assert settling_world(spec).simulation == settling_world(fewer).simulation
    assert settling_world(spec).simulation.drivers == {}


def test_a_replay_settles_again_and_finds_a_forged_state(base: Any, tmp_path: Path) -> None:
    _, spec, caches = base
    honest = Candidate(tmp_path, spec, build_all(spec), "full", caches, "run", cache_digest(caches))
    results = replay(honest, intervals=1, seed=1)
    assert results
    assert all(r["identical"] for r in results)
    forged = run(tmp_path / "forged", spec, reuse=False)
    kept = SettledFrames(forged["rigid"]).state_path
    state = from_bytes(kept.read_bytes())
    state["qpos"][0] += 0.05
    kept.write_bytes(to_bytes(state))
    (tmp_path / "forged" / "probe" / "rigid" / "digests.txt").unlink()
    forged = run(tmp_path / "forged", spec)
    assert forged["rigid"].digests() != caches["rigid"].digests(), "the bake believed the file"
    judged = Candidate(tmp_path, spec, build_all(spec), "full", forged, "run", cache_digest(forged))
    assert not replay(judged, intervals=1, seed=1)[0]["identical"]


def test_what_hangs_on_a_hinge_without_friction_comes_to_hang(tmp_path: Path) -> None:
    """It would swing for ever: kinetic damping brings it to where it hangs."""
    post = box(0.1, 0.1, 0.1, at=(0, 0, 1.0))
    arm = box(0.05, 0.05, 0.5, motion="dynamic", at=(0.0, 0.2, 0.8))
    hinge = HingeJoint(parent="post", child="arm", anchor=(0, 0, 1.0), axis=(1, 0, 0))
    spec = settled(world({"post": post, "arm": arm}, joints={"hinge": hinge}, frames=8), max_time=20.0)
    cache = run(tmp_path, spec)["rigid"]
    middle = cache.series("position")[:, cache.body_row("arm")]
    reach = float(np.hypot(0.2, 0.2))
    assert np.abs(middle[:, 1]).max() < 0.02 * reach
    assert middle[0, 2] == pytest.approx(1.0 - reach, abs=1e-3)


def test_what_is_not_listed_is_held_while_the_rest_settles(tmp_path: Path) -> None:
    things = {
        "ground": ground(),
        "base": box(0.3, 0.3, 0.1, motion="dynamic", at=(0, 0, 0.0515)),
        "top": box(0.1, 0.1, 0.1, motion="dynamic", at=(0, 0, 0.2)),
    }
    spec = settled(world(things, frames=4), "top")
    cache = run(tmp_path, spec)["rigid"]
    first = cache.read(0)["position"]
    assert first[cache.body_row("base")] == pytest.approx([0, 0, 0.0515], abs=1e-9)
    assert first[cache.body_row("top")][2] == pytest.approx(0.1515, abs=2e-3), "it came down on what is held"


def test_what_breaks_while_it_settles_is_told(tmp_path: Path) -> None:
    spec = struck_wall_spec(frames=3)
    dropped = spec.entities["ball"].model_copy(update={"pose": Pose(position=(0, 0, 4)), "physics": RigidPhysics()})
    spec = settled(spec.model_copy(update={"entities": {**spec.entities, "ball": dropped}}))
    built = {n: build_entity(spec, n, tmp_path) for n in spec.entities}
    with pytest.raises(EngineError, match=r"broke while it settled; place it nearer"):
        run_frames(spec, built, tmp_path / "probe", frames=3)


def test_frames_that_were_settled_count_in_the_digest_of_the_caches(base: Any, tmp_path: Path) -> None:
    _, spec, caches = base
    kept = SettledFrames(caches["rigid"])
    assert kept.count() == caches["rigid"].index.frames
    assert dataclasses.replace(kept.files.index, settings="").solver == "rigid"
    bare = run(tmp_path, spec.model_copy(update={"simulation": spec.simulation.model_copy(update={"settle": None})}))
    assert SettledFrames(bare["rigid"]).count() == 0


def test_two_runs_are_alike_only_where_they_settled_alike(base: Any) -> None:
    _, spec, _ = base
    contents = {n: b.digest() for n, b in build_all(spec).items()}

    def after(**drivers: Any) -> Settings:
        return Settings(spec.model_copy(update={"simulation": spec.simulation.model_copy(update={"drivers": drivers})}), contents)

    hold = spec.simulation.drivers["hold"]
    push = ForceDriver(entity="a", force=(1.0, 0, 0), start=0.3, end=0.4)
    air = FieldDriver(field=DragField(), start=0.3)
    assert alike_until(after(hold=hold), after(hold=hold, push=push), ("rigid",)) == pytest.approx(0.3, abs=0.05)
    assert alike_until(after(hold=hold), after(hold=hold, air=air), ("rigid",)) == 0.0, "air at rest is there while things settle"
    assert alike_until(after(hold=hold), after(), ("rigid",)) == 0.0, "what nothing holds settles too"
