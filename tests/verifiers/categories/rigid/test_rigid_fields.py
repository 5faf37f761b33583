"""Recorded impulses of force fields are those of the declared fields, whatever turned a body's way between two frames."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.testing.worlds.simulated_worlds import edited, simulate
from worldagent.tests.physics.rigid_world import ball, box, floor, world
from worldagent.verifiers.categories.rigid.fields import fields
from worldagent.verifiers.ledgers.balance import books_of
from worldagent.verifiers.register.fields import field_lines
from worldagent.verifiers.rows.findings import Finding
from worldagent.worlds.candidate import Candidate

DRAG = {"air": {"kind": "field", "field": {"kind": "drag"}}}


def _wall(x: float) -> dict[str, Any]:
    return box(0.2, 2, 2, at=(x, 0, 1), motion="static")


BALLS: dict[str, dict[str, Any]] = {
    "falls": {"b": ball(0.1, at=(0, 0, 20), mass=0.05)},
    "hops": {"b": ball(0.1, at=(0, 0, 0.103), mass=0.5), "f": floor()},
    "between walls": {"b": ball(0.1, at=(0, 0, 0.2), mass=0.5, v=(12, 0, 0)), "f": floor(), "l": _wall(-0.25), "r": _wall(0.25)},
}


def _row(candidate: Candidate) -> Finding:
    (cache,) = candidate.rigid_caches.values()
    return fields(books_of(candidate, cache))


def _forged(base: Candidate, folder: Path, push: float) -> Candidate:
    """The same motion with a field impulse along x in every frame that is larger by `push` [N s]."""
    (solver,) = base.rigid_caches

    def change(k: int, data: dict[str, Any]) -> None:
        data["field/impulse"] = data["field/impulse"] + (np.array([push, 0.0, 0.0]) if k else 0.0)

    return edited(base, folder, solver, change)


@pytest.mark.parametrize("name", list(BALLS))
def test_a_ball_with_drag_keeps_the_declared_field_while_it_bounces(name: str, tmp_path: Path) -> None:
    spec = world(BALLS[name], seconds=0.25, restitution=1.0, drivers=DRAG)
    row = _row(simulate(tmp_path, spec))
    assert row.status == "pass", row.evidence


def test_an_impulse_that_the_field_cannot_have_given_is_found(tmp_path: Path) -> None:
    """In free flight half of the largest; where walls turn the ball in every frame, what its fastest flight cannot explain."""
    for name, push in (("falls", 0.004), ("between walls", 1.0)):
        base = simulate(tmp_path / name, world(BALLS[name], seconds=0.25, restitution=1.0, drivers=DRAG))
        row = _row(_forged(base, tmp_path / f"{name} forged", push))
        assert row.status == "fail", (name, row.evidence)


def test_the_register_says_whom_a_field_spares() -> None:
    spec = world(
        {"b": ball(0.1), "c": ball(0.1, at=(1, 0, 0.1)), "f": floor()}, drivers={"air": {**DRAG["air"], "entities": ["b"]}}
    )
    lines = {line["what"]: line["effect"] for line in field_lines(spec)}
    assert lines["field 'air' is declared for b alone"] == "it spares c"
    everywhere = world({"b": ball(0.1), "f": floor()}, drivers=DRAG)
    assert not any("alone" in line["what"] for line in field_lines(everywhere))
