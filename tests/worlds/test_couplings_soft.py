"""Which deforming surfaces an instance meets, and the couplings of cloth with grains that the audit lets through."""

from __future__ import annotations

from typing import Any

import pytest
from worldagent.testing.worlds.small_soft import HAMMOCK_PROMPT, hammock_spec
from worldagent.worlds.audits.couplings import coupling_problems
from worldagent.worlds.instances import cloth_of, soft_met
from worldagent.worlds.patch import parse_spec


def world(couplings: dict[str, Any], **changes: Any) -> Any:
    spec = hammock_spec(radius=0.012)
    spec["simulation"]["couplings"] = couplings
    spec["simulation"] |= changes
    return parse_spec({**spec, "prompt": HAMMOCK_PROMPT})


def joined(source: str, target: str, direction: str, *variables: str) -> dict[str, Any]:
    return {"source": source, "target": target, "direction": direction, "variables": list(variables)}


def test_elastic_bodies_are_met_by_cloth_and_grains_and_cloth_by_grains_it_is_coupled_with() -> None:
    spec = world({})
    assert (soft_met(spec, "cloth"), soft_met(spec, "grains"), soft_met(spec, "bodies")) == (("jelly",), ("jelly",), ())
    led = world({"led": joined("cloth", "grains", "one_way", "motion")})
    assert soft_met(led, "grains") == ("cloth", "jelly")
    assert (cloth_of(led, "grains"), coupling_problems(led)) == (("cloth",), [])


def test_cloth_and_grains_push_each_other_beside_a_rigid_instance_only() -> None:
    both = joined("cloth", "grains", "two_way", "motion", "wrench")
    (alone,) = coupling_problems(world({"both": both}))
    assert "one_way from the cloth" in alone.text
    beside = {"both": both, "held": joined("bodies", "cloth", "two_way", "motion", "wrench")}
    assert coupling_problems(world(beside)) == []


@pytest.mark.parametrize(
    ("coupling", "says"),
    [
        (joined("grains", "cloth", "one_way", "motion"), "swap source and target"),
        (joined("cloth", "grains", "one_way", "motion", "wrench"), "exchanges motion"),
    ],
)
def test_other_couplings_of_cloth_with_grains_are_refused_with_a_next_step(coupling: dict[str, Any], says: str) -> None:
    (problem,) = coupling_problems(world({"c": coupling}))
    assert says in problem.text


def test_grains_declared_before_the_cloth_they_read_are_refused() -> None:
    led = {"led": joined("cloth", "grains", "one_way", "motion")}
    (problem,) = coupling_problems(world(led, order=["bodies", "grains", "cloth"]))
    assert "'cloth'" in problem.text


def wet(engine: str, direction: str = "two_way", *variables: str) -> Any:
    """The hammock's cloth coupled with water."""
    spec = hammock_spec(radius=None)
    spec["materials"]["water"] = {"density": 1000, "substance": "water"}
    size = [0.2, 0.2, 0.06]
    spec["entities"]["water"] = {
        "role": "water", "motion": "dynamic", "material": "water", "dimensions": {"size": size}, "pose": {"position": [0, 0, 0.4]},
        "parts": {"body": {"shape": {"kind": "box", "size": size}}}, "physics": {"category": "liquid", "resolution": 0.02},
    }  # fmt: skip
    settings = {"domain": {"center": [0, 0, 0.3], "size": [0.6, 0.6, 0.8]}}
    spec["simulation"]["solvers"]["water"] = {"engine": engine, "members": ["water"], "settings": settings}
    spec["simulation"]["couplings"]["wet"] = joined("cloth", "water", direction, *(variables or ("motion", "wrench")))
    return parse_spec({**spec, "prompt": HAMMOCK_PROMPT})


def test_particle_liquids_meet_elastic_bodies_and_the_cloth_they_are_coupled_with_grids_neither() -> None:
    spec = wet("dfsph")
    assert (soft_met(spec, "water"), coupling_problems(spec)) == (("cloth", "jelly"), [])
    assert soft_met(wet("flip"), "water") == ()
    (problem,) = coupling_problems(wet("flip"))
    assert problem.patch == {"op": "replace", "path": "/simulation/solvers/water/engine", "value": "dfsph"}
