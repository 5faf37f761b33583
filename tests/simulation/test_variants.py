"""Runs without a cause that go on from a checkpoint (R97): they differ by the intervention alone, and are kept by what made them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from worldagent.simulation import kept_runs, variants
from worldagent.simulation.kept_runs import KeptRuns
from worldagent.simulation.protocol import Intervention
from worldagent.simulation.runs import Run
from worldagent.simulation.variants import run_variant, simulated
from worldagent.testing.worlds.simulated_worlds import simulate
from worldagent.testing.worlds.small_worlds import ground, world
from worldagent.tests.verifiers.pushed_blocks import N, only, pushed
from worldagent.verifiers.story.counterfactual import check
from worldagent.worlds.cache import read_container, write_container
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.errors import EvidenceError
from worldagent.worlds.predicates import Displacement
from worldagent.worlds.spec import (
    ForceDriver,
)


def test_a_variant_is_the_run_itself_up_to_its_start_and_differs_after(tmp_path: Path) -> None:
    candidate = simulate(tmp_path, pushed())
    done = Intervention(held=frozenset({"a"}), since=14 / 24)
    variant = run_variant(candidate, done, start=14, end=20)
    assert variant.last_frame == 20
    own, other = (c.caches["rigid"].series("position") for c in (candidate, variant))
    assert np.array_equal(own[:15], other[:15])
    row = candidate.caches["rigid"].index.bodies.index("a/body")
    assert np.abs(other[15:, row] - other[14, row]).max() < 1e-9
    assert np.abs(own[20, row] - own[14, row]).max() > 0.01
    events = variant.caches["rigid"].ragged("contact/pair", "contact/impulse")
    assert len(events) == 21


def test_no_intervention_gives_the_run_again(tmp_path: Path) -> None:
    """The intervention acts on nothing that moves, so that the frames are those of the cache."""
    spec = pushed(drivers={"none": ForceDriver(entity="a", force=(0, 0, 0), end=1.0)})
    candidate = simulate(tmp_path, spec)
    variant = run_variant(candidate, Intervention(without=frozenset({"none"})), start=13, end=24)
    own, other = (c.caches["rigid"].series("position") for c in (candidate, variant))
    assert np.array_equal(own, other)


def test_pairs_apart_part_only_from_the_start_on(tmp_path: Path) -> None:
    """A block that rests on the floor stays there until the frame at which the two pass through each other."""
    candidate = simulate(tmp_path, pushed())
    variant = run_variant(candidate, Intervention(apart=frozenset({("b", "floor")})), start=15, end=20)
    row = candidate.caches["rigid"].index.bodies.index("b/body")
    z = variant.caches["rigid"].series("position")[:, row, 2]
    assert np.ptp(z[:16]) < 1e-3
    assert z[20] < z[15] - 0.05


def counted_frames(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """The frames that runs of this process advance to from now on."""
    seen: list[int] = []
    plain = Run.advance

    def advance(self: Run, frame: int) -> None:
        seen.append(frame)
        plain(self, frame)

    monkeypatch.setattr(Run, "advance", advance)
    return seen


def test_what_nobody_reads_is_not_simulated(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Judging an edge simulates the instances of its beats; a variant whose frames are not read takes none."""
    candidate = simulate(tmp_path, pushed())
    frames = counted_frames(monkeypatch)
    variant = run_variant(candidate, Intervention(held=frozenset({"a"}), since=14 / 24), start=14, end=20)
    assert variant.last_frame == 20
    assert (frames, simulated(variant)) == ([], ())
    variant.caches["rigid"].read(16)
    assert (frames, simulated(variant)) == (list(range(13, 21)), ("rigid",))
    variant.caches["rigid"].series("position")
    assert frames == list(range(13, 21))


def test_the_same_motion_is_not_simulated_twice(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Another bound of an effect is judged on the frames that were kept; rows equal those of a new simulation."""
    candidate = simulate(tmp_path, pushed())
    keeping = replace(candidate, variants=tmp_path / "variants")
    plain = only(candidate)
    frames = counted_frames(monkeypatch)
    assert only(keeping) == plain
    once = len(frames)
    assert once > 0
    again = replace(candidate, variants=tmp_path / "variants")
    assert only(again) == plain
    slide = candidate.spec.story.beats["slide"].model_copy(update={"predicate": Displacement(entity="b", min=0.04)})
    story = candidate.spec.story.model_copy(update={"beats": {**candidate.spec.story.beats, "slide": slide}})
    assert only(replace(again, spec=candidate.spec.model_copy(update={"story": story}))).bound == 0.04
    assert len(frames) == once
    only(candidate)  # what is given no folder simulates for itself
    assert len(frames) == 2 * once


def _shoved(folder: Path, *, start: int = 5, end: float = 0.5, **force: float) -> Candidate:
    """A candidate of one world, in which a block is shoved from a frame on."""
    shove = ForceDriver(entity="b", force=(force.get("x", 3.0), 0, 0), start=start / 24, end=end)
    spec = pushed(drivers={"shove": shove})
    candidate = simulate(folder, spec)
    (folder / "candidate.json").write_text("{}")
    return replace(candidate, variants=folder / "variants")


def _positions(candidate: Candidate, done: Intervention, start: int, end: int) -> np.ndarray:
    return np.asarray(run_variant(candidate, done, start=start, end=end).caches["rigid"].series("position"))


@pytest.mark.parametrize(
    ("done", "last", "changes", "shared"),
    [
        (Intervention(without=frozenset({"shove"})), 20, {"x": 9.0}, True),
        (Intervention(without=frozenset({"shove"})), 20, {"end": 0.6}, False),
        (Intervention(held=frozenset({"a"}), since=5 / 24), 20, {"x": 9.0}, False),
        (Intervention(held=frozenset({"a"}), since=2 / 24), 5, {"x": 9.0}, True),
        (Intervention(held=frozenset({"a"}), since=2 / 24), 6, {"x": 9.0}, False),
    ],
)
def test_a_run_without_what_an_edit_changed_is_kept_for_the_next_candidate(
    done: Intervention, last: int, changes: dict[str, float], shared: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Another force in a run without it, or after its end, changes nothing in that run; anything else is simulated anew."""
    first, second = _shoved(tmp_path / "one"), _shoved(tmp_path / "two", **changes)  # type: ignore[arg-type]
    start = round(24 * done.since) or 5
    fresh = _positions(replace(second, variants=None), done, start, last)
    _positions(first, done, start, last)
    frames = counted_frames(monkeypatch)
    assert np.array_equal(_positions(second, done, start, last), fresh)
    assert (frames == []) == shared


def test_a_kept_run_that_was_touched_or_is_of_another_recipe_is_made_anew(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    candidate = replace(simulate(tmp_path, pushed()), variants=tmp_path / "variants")
    plain = only(candidate)
    (path,) = (tmp_path / "variants").glob("*.npz")
    whole = path.read_bytes()
    frames = counted_frames(monkeypatch)

    def judged_again() -> int:
        before = len(frames)
        assert only(replace(candidate)) == plain
        return len(frames) - before

    assert judged_again() == 0
    path.write_bytes(whole[: len(whole) // 2])
    assert judged_again() > 0
    forged = read_container(path)
    name = next(n for n in forged if n.endswith("/position"))
    write_container(path, {**forged, name: forged[name] + 1.0})
    assert judged_again() > 0
    assert judged_again() == 0
    monkeypatch.setattr("worldagent.simulation.freeze.solver_source", lambda: "another program")
    assert judged_again() > 0
    assert len(list((tmp_path / "variants").glob("*.npz"))) == 2
    heavier = candidate.spec.model_copy(
        update={"simulation": candidate.spec.simulation.model_copy(update={"gravity": (0.0, 0.0, -9.7)})}
    )
    before = len(frames)
    check(replace(candidate, spec=heavier))
    assert len(frames) > before


def test_a_kept_run_does_not_hide_that_the_frames_it_continues_were_altered(tmp_path: Path) -> None:
    candidate = replace(simulate(tmp_path, pushed()), variants=tmp_path / "variants")
    done = Intervention(held=frozenset({"a"}), since=3 / 24)
    run_variant(candidate, done, start=3, end=5).caches["rigid"].read(4)
    data = candidate.caches["rigid"].read(3)
    write_container(candidate.caches["rigid"].path(3), {**data, "position": data["position"] + 0.001})
    with pytest.raises(EvidenceError, match="altered"):
        run_variant(candidate, done, start=3, end=5).caches["rigid"].read(4)


def test_the_runs_used_longest_ago_make_room(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    kept, frames = KeptRuns(tmp_path), {"rigid": {1: {"position": np.zeros((10, 3))}}}
    kept.keep("a" * 64, frames)
    size = (tmp_path / f"{'a' * 32}.npz").stat().st_size
    monkeypatch.setattr(kept_runs, "FOLDER_BYTES", 2 * size)
    for name in "bc":
        kept.keep(name * 64, frames)
    assert [kept.find(n * 64) is not None for n in "abc"] == [False, True, True]
    monkeypatch.setattr(kept_runs, "FILE_BYTES", 100)
    kept.keep("d" * 64, frames)
    assert kept.find("d" * 64) is None
    assert KeptRuns(None).find("b" * 64) is None


def test_a_cache_that_its_checkpoint_does_not_lead_to_is_unverified(tmp_path: Path) -> None:
    candidate = simulate(tmp_path, pushed())
    cache = candidate.caches["rigid"]
    for frame in range(N):
        data = cache.read(frame)
        data["position"] = data["position"] + 0.001
        write_container(cache.path(frame), data)
    with pytest.raises(EvidenceError, match="altered"):
        run_variant(candidate, Intervention(held=frozenset({"a"}), since=3 / 24), start=3, end=5).caches["rigid"].read(4)


def test_a_tolerance_of_continuation_is_small_beside_the_skins() -> None:
    skin = world({"floor": ground()}).simulation.solvers["rigid"].settings.skin
    assert variants.CONTINUES / (2 * skin) <= 0.1
