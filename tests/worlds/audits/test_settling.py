"""Audit of `simulation.settle`: what cannot come to rest, and what would be held while something settles in it, is told."""

from __future__ import annotations

from typing import Any

from worldagent.testing.worlds.by_category import spec_of
from worldagent.testing.worlds.small_liquids import PROMPT, tank_spec
from worldagent.testing.worlds.small_worlds import ball, box, ground, world
from worldagent.worlds.audits.audit import audit
from worldagent.worlds.audits.settling import settle_problems
from worldagent.worlds.limits import estimate_counts
from worldagent.worlds.patch import apply_patch
from worldagent.worlds.settled import settling
from worldagent.worlds.spec import ReleaseDriver, Settle, WorldSpec


def _with(spec: WorldSpec, *entities: str, **plan: Any) -> WorldSpec:
    settle = Settle(entities=list(entities))
    return spec.model_copy(update={"simulation": spec.simulation.model_copy(update={"settle": settle, **plan})})


def _yard() -> WorldSpec:
    things = {
        "ground": ground(),
        "stone": box(0.1, 0.1, 0.1, motion="dynamic", at=(0, 0, 0.06)),
        "thrown": box(0.1, 0.1, 0.1, motion="dynamic", at=(1, 0, 0.06), velocity=(1, 0, 0)),
        "kept": ball(0.1, motion="dynamic", at=(2, 0, 1)),
    }
    return world(things, drivers={"hold": ReleaseDriver(entity="kept", time=0.5)})


def test_an_empty_list_means_all_that_can_settle() -> None:
    spec = _with(_yard())
    assert settling(spec) == ("stone",)
    assert settle_problems(spec) == []
    assert settling(_yard()) == ()


def test_what_cannot_settle_is_named_with_the_reason_and_a_patch_that_mends_it() -> None:
    spec = _with(_yard(), "stone", "ground", "thrown", "kept")
    told = {p.pointer.rsplit("/", 1)[1]: p for p in settle_problems(spec)}
    assert list(told) == ["1", "2", "3"]
    assert "it is static" in told["1"].text
    assert "starts with a velocity" in told["2"].text
    assert "release 'hold' holds it" in told["3"].text
    assert told["3"].patch is not None
    assert len(settle_problems(apply_patch(spec, [told["3"].patch]))) == 2


def test_a_preroll_and_a_settle_that_settles_nothing_are_refused() -> None:
    both = _with(_yard(), preroll=0.5)
    (problem,) = settle_problems(both)
    assert problem.patch is not None
    assert settle_problems(apply_patch(both, [problem.patch])) == []
    nothing = _with(world({"ground": ground()}))
    (problem,) = settle_problems(nothing)
    assert problem.patch is not None
    assert apply_patch(nothing, [problem.patch]).simulation.settle is None
    (row,) = (r for r in audit(nothing).rows if r.id == "audit:settle")
    assert row.status == "fail"


def test_a_body_settles_with_the_liquid_that_carries_it() -> None:
    tank = spec_of(tank_spec(), PROMPT)
    (problem,) = settle_problems(_with(tank, "crate"))
    assert "'water' is held as a whole while 'crate' settles" in problem.text
    assert problem.patch is not None
    assert settle_problems(apply_patch(_with(tank, "crate"), [problem.patch])) == []
    assert settling(_with(tank)) == ("water", "crate")


def test_the_settle_run_counts_as_frames() -> None:
    plain, more = (estimate_counts(s)["frames"] for s in (_yard(), _with(_yard())))
    assert more == plain + 5.0 * 24
