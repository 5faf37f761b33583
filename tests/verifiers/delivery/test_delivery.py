"""Delivery rows: the whole sequence, as it was baked, in a folder that refers to nothing outside (R84, R118, R126)."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import get_args

from worldagent.testing.worlds.small_worlds import box, ground, make_candidate, world
from worldagent.verifiers.checks import run_checks
from worldagent.verifiers.delivery.check import check
from worldagent.worlds.audits.audit import audit
from worldagent.worlds.cache import Cache, read_container, write_container
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.predicates.models import Speed
from worldagent.worlds.requirements import Group, Row
from worldagent.worlds.spec import Beat, CameraKey, Shot, Supports

FRAMES = 6
BEAT = Beat(text="it stays", owner="rigid", subject="a", frames=(0, 5), predicate=Speed(entity="a", max=0.1, when="always"))
SHOT = Shot(frames=(0, FRAMES - 1), covers=["stays"], keys={"k": CameraKey(frame=0, position=(1, -1, 1), target=(0, 0, 0))})


def baked(folder: Path) -> Candidate:
    spec = world({"ground": ground(), "a": box(0.1, 0.1, 0.1, at=(0, 0, 0.05), motion="dynamic")}, frames=FRAMES)
    candidate = make_candidate(folder, spec, tracks={}, stage="full")
    (cache,) = candidate.caches.values()
    digests = [cache.frame_digest(k) for k in range(FRAMES)]
    (cache.folder / "digests.txt").write_text("\n".join(digests) + "\n")
    return candidate


def reopened(candidate: Candidate) -> Candidate:
    return dataclasses.replace(candidate, caches={n: Cache(c.folder) for n, c in candidate.caches.items()})


def rows(candidate: Candidate) -> dict[str, Row]:
    return {r.id: r for r in check(reopened(candidate))}


def test_a_whole_untouched_bake_passes(tmp_path: Path) -> None:
    found = rows(baked(tmp_path))
    assert set(found) == {"delivery:independent", "delivery:complete:rigid", "delivery:digests:rigid"}
    assert all(r.status == "pass" and r.mandatory and r.artifact for r in found.values())


def test_an_altered_a_swapped_and_a_missing_frame_are_named(tmp_path: Path) -> None:
    for kind in ("altered", "swapped", "missing", "torn"):
        candidate = baked(tmp_path / kind)
        (cache,) = candidate.caches.values()
        data = read_container(cache.path(3))
        if kind == "altered":
            data["position"][0, 0] += 1e-12
            write_container(cache.path(3), data)
        elif kind == "swapped":
            data["position"] = data["position"] + 1.0
            write_container(cache.path(3), data)
        elif kind == "missing":
            cache.path(3).unlink()
        else:
            cache.path(3).write_bytes(cache.path(3).read_bytes()[:50])
        row = rows(candidate)["delivery:digests:rigid"]
        assert (row.status, row.first_failing_frame) == ("fail", 3), kind
        assert row.evidence["reason"]
        assert "bake again" in row.corrections[0].action


def test_fewer_frames_than_asked_for_fail(tmp_path: Path) -> None:
    candidate = baked(tmp_path)
    (cache,) = candidate.caches.values()
    cache.write_index(dataclasses.replace(cache.index, frames=FRAMES - 2))
    row = rows(candidate)["delivery:complete:rigid"]
    assert (row.status, row.measured, row.bound, row.first_failing_frame) == ("fail", FRAMES - 2, FRAMES, FRAMES - 2)


def test_a_frame_without_a_recorded_digest_fails(tmp_path: Path) -> None:
    candidate = baked(tmp_path)
    (cache,) = candidate.caches.values()
    (cache.folder / "digests.txt").write_text("\n".join(cache.digests()[:4]))
    assert rows(candidate)["delivery:digests:rigid"].first_failing_frame == 4


def test_links_inside_are_fine_and_links_out_are_named(tmp_path: Path) -> None:
    candidate = baked(tmp_path / "w")
    (tmp_path / "w" / "inside").symlink_to(tmp_path / "w" / "candidates")
    assert rows(candidate)["delivery:independent"].status == "pass"
    (tmp_path / "w" / "mesh.obj").symlink_to(tmp_path / "far.obj")
    row = rows(candidate)["delivery:independent"]
    assert (row.status, row.evidence["links"]) == ("fail", ["mesh.obj"])


def test_every_one_of_the_five_groups_has_rows_and_each_row_is_of_one_of_them(tmp_path: Path) -> None:
    """R84: a world with a beat and a shot, judged whole."""
    spec = world(
        {"ground": ground(), "a": box(0.1, 0.1, 0.1, at=(0, 0, 0.05), motion="dynamic")},
        frames=FRAMES,
        relations={"on": Supports(a="ground", b="a")},
        beats={"stays": BEAT},
        shots={"only": SHOT},
    )
    candidate = make_candidate(tmp_path, spec, tracks={}, stage="full")
    found = {r.group for r in (*audit(spec).rows, *run_checks(candidate, reruns=False))}
    assert found == set(get_args(Group))
