"""A specification that asks for nothing is asked what nature asks of it, by mandatory rows (R154)."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from worldagent.testing.defects import _liquid_scenes as scenes
from worldagent.testing.worlds.small_worlds import box, ground, make_candidate, world
from worldagent.verifiers.checks import run_checks
from worldagent.worlds.audits.audit import audit
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.requirements import Row
from worldagent.worlds.spec import WorldSpec


def judged(candidate: Candidate) -> dict[str, Row]:
    asked_for_nothing(candidate.spec)
    return {r.id: r for r in (*run_checks(candidate, reruns=False), *audit(candidate.spec).rows)}


def asked_for_nothing(spec: WorldSpec) -> None:
    assert (spec.story.beats, spec.story.requirements, spec.graph.relations, spec.claims) == ({}, {}, {}, {})


@pytest.mark.parametrize(("gap", "status"), [(0.002, "fail"), (0.0, "pass")])
def test_a_liquid_is_contained_and_kept_whoever_asks(tmp_path: Path, gap: float, status: str) -> None:
    """A tank with a slit in its floor, and without one."""
    flow = scenes.draining(np.random.default_rng(3), gap=gap) if gap else scenes.pool(np.random.default_rng(3))
    rows = judged(flow.candidate(tmp_path))
    assert rows["category:liquid:leak:water"].status == status
    for name in ("leak", "mass", "identity", "inside", "domain"):
        assert rows[f"category:liquid:{name}:water"].mandatory, name
    for name in ("audit:density:water", "audit:masses", "audit:bounds", "support:derived:tank", "shots:tiling"):
        assert rows[name].mandatory, name


@pytest.mark.parametrize(("height", "status"), [(0.05, "pass"), (0.5, "fail")])
@pytest.mark.parametrize("motion", ["static", "dynamic"])
def test_a_body_is_held_whoever_asks(tmp_path: Path, height: float, status: str, motion: str) -> None:
    spec = world({"ground": ground(), "a": box(0.1, 0.1, 0.1, at=(0, 0, height), motion=motion)}, frames=4)
    rows = judged(make_candidate(tmp_path, spec, tracks={}, stage="full"))
    assert (rows["support:derived:a"].status, rows["support:derived:a"].mandatory) == (status, True)
    assert all(rows[name].mandatory for name in ("contact:scene", "interpenetration:scene", "scale:a", "support:scene"))
