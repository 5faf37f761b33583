"""Audit of particles, and their estimated cost."""

from __future__ import annotations

import copy
from typing import Any

import numpy as np
import pytest
from worldagent.testing.worlds.small_grains import SAND_PROMPT, SPARK_PROMPT, sand_spec, spark_spec
from worldagent.worlds.audits.audit import audit
from worldagent.worlds.categories.particles.facts import grain_step, particle_estimate
from worldagent.worlds.coarsening import coarsened, overrides_for
from worldagent.worlds.errors import LimitError
from worldagent.worlds.limits import check_limits
from worldagent.worlds.spec import WorldSpec

SAND, SPARKS = {"prompt": SAND_PROMPT, **sand_spec()}, {"prompt": SPARK_PROMPT, **spark_spec()}


def changed(base: dict[str, Any], *edits: tuple[str, Any]) -> WorldSpec:
    """A specification with other values at some pointers."""
    document = copy.deepcopy(base)
    for pointer, value in edits:
        *way, last = pointer.strip("/").split("/")
        node = document
        for step in way:
            node = node[step]
        node[last] = value
    return WorldSpec.model_validate(document)


def row(spec: WorldSpec, name: str) -> Any:
    return next(r for r in audit(spec).rows if r.id == f"audit:{name}")


def test_sound_particles_pass() -> None:
    for base in (SAND, SPARKS):
        assert row(changed(base), "particles").status == "pass"
        assert row(changed(base), "ownership").status == "pass"


PUSH = {"kind": "force", "entity": "sand", "force": [1, 0, 0], "end": 1}
BOTH = {"source": "bodies", "target": "flight", "direction": "two_way", "variables": ["motion", "wrench"]}
WRONG = [
    (SAND, ("/entities/sand/physics/law", "ballistic"), "engine 'dem' moves granular particles"),
    (SAND, ("/entities/sand/motion", "static"), "particles are dynamic"),
    (SAND, ("/entities/sand/physics/radius", 0.04), "holds no grain"),
    (SAND, ("/simulation/solvers/grains/settings/domain/size", [0.1, 0.6, 0.6]), "beyond the domain"),
    (SAND, ("/simulation/drivers/push", PUSH), "cannot act on particles"),
    (SPARKS, ("/simulation/drivers/grinder/entity", "floor"), "are no ballistic particles"),
    (SPARKS, ("/simulation/drivers/grinder/pose", {"position": [9, 0, 0]}), "outside the domain"),
    (SPARKS, ("/simulation/couplings", {"c": BOTH}), "push nothing"),
]


@pytest.mark.parametrize(("base", "edit", "said"), WRONG, ids=[w[2] for w in WRONG])
def test_the_audit_names_what_is_wrong(base: dict[str, Any], edit: tuple[str, Any], said: str) -> None:
    found = row(changed(base, edit), "particles")
    assert found.status == "fail"
    assert any(said in c.action for c in found.corrections), [c.action for c in found.corrections]


def test_the_estimate_is_that_of_volume_and_stiffness() -> None:
    spec = changed(SAND)
    found = particle_estimate(spec, "grains")
    volume = 0.238**2 * 0.07
    assert found.particles == pytest.approx(0.58 * volume / (4 / 3 * np.pi * 0.008**3 * 1.01), rel=1e-6)
    softer = particle_estimate(changed(SAND, ("/entities/sand/physics/young_modulus", 1.5e7)), "grains")
    assert found.steps / softer.steps == pytest.approx(2.0, rel=1e-6)
    assert grain_step(spec.entities["sand"].physics, 2600.0, 0.15) == pytest.approx(0.15 * 2.66e-4, rel=0.05)  # type: ignore[arg-type]


def test_too_many_grains_are_refused_with_the_knob() -> None:
    with pytest.raises(LimitError, match="radius of grains"):
        check_limits(changed(SAND, ("/entities/sand/physics/radius", 2e-5)))


def test_a_probe_may_take_larger_grains() -> None:
    spec = changed(SAND)
    overrides = overrides_for(spec, 1.5)
    assert overrides == {"/entities/sand/physics/radius": pytest.approx(0.012)}
    assert coarsened(spec, overrides).entities["sand"].physics.radius == pytest.approx(0.012)  # type: ignore[union-attr]
