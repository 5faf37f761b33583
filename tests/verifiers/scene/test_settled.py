"""Row `numerical:settled`: it passes over what rests at frame 0, and fails over what was stopped early, slid away or was altered."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from worldagent.testing.worlds.simulated_worlds import simulate
from worldagent.testing.worlds.small_worlds import MATERIALS, box, build_all, ground, world
from worldagent.verifiers.checks import run_checks
from worldagent.verifiers.register.assemble import approximations
from worldagent.verifiers.scene.settled import settled_rows
from worldagent.verifiers.support import check as support
from worldagent.worlds.cache import write_container
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.patch import apply_patch
from worldagent.worlds.settled import SettledFrames
from worldagent.worlds.spec import ForceDriver, Material, Settle, Supports, WorldSpec

SLICK = {"wood": MATERIALS["wood"].model_copy(update={"friction": 0.02})}


def tilted(*, slope: float = 0.0, materials: dict[str, Material] | None = None, max_time: float = 4.0, **more: Any) -> WorldSpec:
    """Two bricks let down askew on a slab that slopes towards -x [rad]."""
    things = {
        "slab": box(6.0, 2.0, 0.1, at=(0, 0, -0.05), euler=(0, -slope, 0)),
        "low": box(0.2, 0.2, 0.1, motion="dynamic", at=(0.0, 0, 0.08), euler=(0.03, -slope, 0)),
        "high": box(0.1, 0.1, 0.1, motion="dynamic", at=(0.0, 0, 0.2), euler=(0, -slope, 0.5)),
    }
    spec = world(things, frames=8, materials=materials, **more)
    plan = spec.simulation.model_copy(update={"settle": Settle(max_time=max_time)})
    return spec.model_copy(update={"simulation": plan})


def test_what_came_to_rest_passes_and_the_register_says_how_far_it_moved(tmp_path: Path) -> None:
    candidate = simulate(tmp_path, tilted(slope=0.1), stage="full")
    (row,) = settled_rows(candidate)
    assert (row.id, row.status) == ("numerical:settled:rigid", "pass"), row.evidence
    assert row.measured is not None
    assert row.measured <= 0.001
    assert row.evidence["moved_m"]["high"] > 0.01
    failing = [r.id for r in run_checks(candidate, only=("numerical", "support"), reruns=False) if r.status == "fail"]
    assert not failing
    lines = [line["effect"] for line in approximations(candidate) if "settled before frame 0" in line["what"]]
    assert len(lines) == 1
    assert "'high' moved farthest" in lines[0]


def test_what_was_stopped_before_it_rests_fails_by_name_with_more_time_as_its_correction(tmp_path: Path) -> None:
    spec = tilted(slope=0.6, max_time=0.5)  # 34 degrees, of wood whose friction holds it up to 27
    (row,) = settled_rows(simulate(tmp_path, spec))
    assert row.status == "fail"
    assert row.first_failing_entity in ("low", "high")
    assert "m/s" in row.evidence["explanation"]
    first = row.corrections[0]
    assert first.group in ("interval", "placement")
    if first.patch:
        longer = apply_patch(spec, first.patch).simulation.settle
        assert longer is not None
        assert longer.max_time == 1.0


def test_what_slid_away_while_it_settled_fails(tmp_path: Path) -> None:
    """It comes to rest on level ground, far from the slope that it was placed on."""
    wall = box(0.1, 2.0, 1.0, at=(-1.6, 0, 0.0))
    spec = tilted(slope=0.3, materials=SLICK, max_time=30.0)
    spec = spec.model_copy(
        update={
            "entities": {**spec.entities, "wall": wall},
            "simulation": spec.simulation.model_copy(
                update={
                    "solvers": {"rigid": spec.simulation.rigid["rigid"].model_copy(update={"members": [*spec.entities, "wall"]})}
                }
            ),
        }
    )
    (row,) = settled_rows(simulate(tmp_path, spec))
    assert row.status == "fail"
    assert "aside" in row.evidence["explanation"]
    assert row.corrections[0].group == "placement"


def test_a_driver_that_acts_ends_what_is_asked_of_the_first_frames(tmp_path: Path) -> None:
    push = {"push": ForceDriver(entity="low", force=(400.0, 0, 0), start=0.0, end=0.2)}
    pushed = simulate(tmp_path / "pushed", tilted(drivers=push))
    (row,) = settled_rows(pushed)
    assert row.status == "pass", row.evidence
    (still,) = settled_rows(simulate(tmp_path / "still", tilted()))
    assert still.status == "pass"


def test_altered_or_missing_settled_frames_are_no_evidence(tmp_path: Path) -> None:
    candidate = simulate(tmp_path, tilted())
    kept = SettledFrames(candidate.caches["rigid"])
    first = kept.files.read(0)
    write_container(kept.files.path(0), {**first, "position": first["position"] + 0.1})
    (row,) = settled_rows(candidate)
    assert row.status == "unverified"
    assert "altered" in row.evidence["explanation"]
    kept.state_path.unlink()
    (kept.files.folder / "digests.txt").unlink()
    (row,) = settled_rows(simulate_again(candidate))
    assert row.status == "unverified"


def simulate_again(candidate: Candidate) -> Candidate:
    """The same candidate with readers that have read nothing yet."""
    caches = {n: type(c)(c.folder) for n, c in candidate.caches.items()}
    return Candidate(
        candidate.folder, candidate.spec, candidate.built, candidate.stage, caches, candidate.artifact, candidate.digest
    )


@pytest.mark.parametrize("settles", [True, False])
def test_before_any_simulation_support_of_what_settles_waits(tmp_path: Path, settles: bool) -> None:
    relation = {"carries": Supports(a="slab", b="low", frames=(0, 5))}
    spec = tilted(relations=relation)
    off = box(0.2, 0.2, 0.1, motion="dynamic", at=(-3.08, 0.0, 0.051))  # its middle is past the edge
    spec = spec.model_copy(update={"entities": {**spec.entities, "low": off}})
    if not settles:
        spec = spec.model_copy(update={"simulation": spec.simulation.model_copy(update={"settle": None})})
    rows = {r.id: r for r in support.check(Candidate(tmp_path, spec, build_all(spec), "static"))}
    own = [r for r in rows.values() if "low" in r.entities[:1] and r.question != "support:scene"]
    assert own
    if settles:
        assert {r.status for r in own} <= {"pass", "not_applicable"}
        assert any("settles before frame 0" in r.evidence["explanation"] for r in own)
    else:
        (tips,) = (r for r in own if r.question == "support:balance")
        assert tips.status == "fail"
        (let,) = (c for c in tips.corrections if c.group == "interval")
        assert apply_patch(spec, let.patch).simulation.settle == Settle(entities=["low"])


def test_what_does_not_settle_has_no_row(tmp_path: Path) -> None:
    spec = world({"ground": ground(), "a": box(0.1, 0.1, 0.1, motion="dynamic", at=(0, 0, 0.051))}, frames=3)
    assert settled_rows(simulate(tmp_path, spec)) == []
