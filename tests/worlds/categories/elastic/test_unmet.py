"""Contacts with elastic bodies that no engine makes are told before anything runs (R62, R66)."""

from __future__ import annotations

from typing import Any

import pytest
from worldagent.testing.worlds.small_liquids import PROMPT, jelly_tank_spec
from worldagent.worlds.audits.audit import audit
from worldagent.worlds.patch import parse_spec


def told(spec: dict[str, Any]) -> list[str]:
    """Warnings about contacts that are not made."""
    return [w for w in audit(parse_spec({**spec, "prompt": PROMPT})).warnings if "make" in w]


def soft_of(spec: dict[str, Any]) -> str:
    return next(n for n, e in spec["entities"].items() if e.get("physics", {}).get("category") == "elastic")


def liquid_of(spec: dict[str, Any]) -> dict[str, Any]:
    return next(s for s in spec["simulation"]["solvers"].values() if s["engine"] == "dfsph")


def test_a_liquid_on_a_grid_passes_through_an_elastic_body_in_its_domain_and_particles_do_not() -> None:
    spec = jelly_tank_spec()
    assert told(spec) == []
    liquid = liquid_of(spec)
    liquid["engine"] = "flip"
    liquid["settings"] = {"domain": liquid["settings"]["domain"]}
    spec["simulation"]["couplings"] = {}
    (line,) = told(spec)
    assert f"(flip on cpu) makes no contact with elastic {soft_of(spec)!r}" in line
    assert "use engine dfsph" in line


def test_a_grid_whose_domain_does_not_reach_the_body_is_not_told() -> None:
    spec = jelly_tank_spec()
    liquid = liquid_of(spec)
    liquid["engine"], liquid["settings"] = "flip", {"domain": liquid["settings"]["domain"]}
    spec["simulation"]["couplings"] = {}
    spec["entities"][soft_of(spec)]["pose"]["position"] = [50, 0, 0]
    assert told(spec) == []


@pytest.mark.parametrize("together", [True, False])
def test_a_contact_with_a_body_of_another_instance_is_told(together: bool) -> None:
    spec = jelly_tank_spec()
    soft, size = soft_of(spec), [0.05, 0.05, 0.05]
    spec["entities"]["stone"] = {
        "role": "stone", "motion": "dynamic", "material": next(iter(spec["materials"])), "dimensions": {"size": size},
        "pose": {"position": [0, 0, 1]}, "parts": {"body": {"shape": {"kind": "box", "size": size}}},
    }  # fmt: skip
    home = next(k for k, s in spec["simulation"]["solvers"].items() if soft in s["members"])
    if together:
        spec["simulation"]["solvers"][home]["members"].append("stone")
    else:
        spec["simulation"]["solvers"]["other"] = {"engine": "mujoco", "members": ["stone"]}
    spec["story"]["beats"]["hits"] = {
        "text": "it hits", "owner": home if together else "other", "subject": "stone", "frames": [0, 10],
        "predicate": {"kind": "contact", "a": "stone", "b": soft},
    }  # fmt: skip
    lines = told(spec)
    assert len(lines) == (0 if together else 1)
    assert all("/story/beats/hits/predicate" in line and "in 'other'" in line for line in lines)
