"""Every field of a specification belongs to one causal parameter group (R111-R113)."""

from __future__ import annotations

import pytest
from worldagent.worlds.groups import GROUPS, group_of
from worldagent.worlds.patch import differences
from worldagent.worlds.spec import WorldSpec

CASES = {
    "placement": ["/entities/a/pose", "/entities/a/pose/position/2", "/entities/a/pose/euler", "/entities/a/afloat"],
    "dimensions": ["/entities/a/dimensions/size/0", "/entities/a/nominal_diagonal"],
    "shape": ["/entities/a", "/entities/a/parts/b/shape/size", "/entities/a/generator/segments", "/entities/a/motion",
              "/entities/a/parts/b/collides", "/entities/a/active", "/simulation/solvers/s/members/0"],
    "terrain": ["/terrains/land/layers/hill/height", "/terrains/land", "/terrains/land/erosion/years"],
    "cover": ["/terrains/land/ground/sand/order", "/terrains/land/vegetation", "/terrains/land/vegetation/density"],
    "joints": ["/simulation/joints/h", "/simulation/joints/h/range", "/entities/a/physics/pins/left/size/0"],
    "relations": ["/graph/relations/r", "/graph/regions/r/radius"],
    "material": ["/materials/m/friction", "/materials/m", "/entities/a/material", "/entities/a/parts/b/material"],
    "mass": ["/entities/a/physics/mass", "/entities/a/physics/linear_damping", "/entities/a/physics"],
    "stiffness": ["/entities/a/physics/young_modulus", "/entities/a/physics/poisson_ratio", "/entities/a/physics/yield_strain"],
    "bonds": ["/entities/a/breakable/bond", "/entities/a/breakable/bond/tension"],
    "initial_state": ["/entities/a/physics/linear_velocity", "/entities/a/physics/currents/reach_0/speeds/3", "/entities/a/physics/angular_velocity/1",
                      "/entities/a/physics/temperature"],
    "liquid": ["/entities/a/physics/viscosity", "/entities/a/physics/activation", "/simulation/solvers/s/settings/wall_friction",
               "/simulation/solvers/s/settings/roughness"],
    "cloth": ["/entities/a/physics/stretch_stiffness", "/entities/a/physics/tear/strength", "/entities/a/physics/thickness", "/entities/a/physics/ignores/0"],
    "resolution": ["/entities/a/physics/resolution", "/entities/a/physics/radius"],
    "grains": ["/entities/a/physics/rolling", "/entities/a/physics/cohesion", "/entities/a/physics/packing", "/entities/a/physics/life"],
    "gas": ["/simulation/solvers/s/settings/expands", "/simulation/solvers/s/settings/diffusivity", "/simulation/solvers/s/settings/ambient_temperature"],
    "domain": ["/simulation/solvers/s/settings/domain", "/simulation/solvers/s/settings/domain/size/0"],
    "contact": ["/simulation/contacts/c/friction", "/simulation/solvers/s/settings/skin", "/simulation/solvers/s/settings/impratio",
                "/simulation/solvers/s/settings/contact_steps", "/simulation/solvers/s/settings/speculative"],
    "step": ["/simulation/solvers/s/settings/step", "/simulation/solvers/s/settings/iterations", "/simulation/solvers/s"],
    "drivers": ["/simulation/drivers/d/time", "/simulation/gravity/2", "/simulation/gravity", "/simulation/couplings/c", "/simulation/order"],
    "interval": ["/simulation/frames", "/simulation/fps", "/simulation/preroll", "/simulation/seed"],
    "story": ["/story/beats/b", "/story/requirements/r/predicate/min"],
    "limits": ["/simulation/limits/max_speed", "/entities/a/physics/max_strain", "/entities/a/physics/recovery", "/entities/a/physics/max_stretch"],
    "shots": ["/shots/s/keys/k/position/0"],
    "look": ["/look/width", "/materials/m/appearance/color/0"],
    "text": ["/title", "/clauses/c1/met_by", "/entities/a/role", "/entities/a/inputs/0", "/story/semantics", "/spec_version"],
}  # fmt: skip
CLASSES = {
    "scene": {"placement", "dimensions", "shape", "joints", "relations", "terrain"},
    "solver": {
        "material",
        "mass",
        "stiffness",
        "bonds",
        "initial_state",
        "contact",
        "step",
        "drivers",
        "interval",
        "liquid",
        "cloth",
        "resolution",
        "grains",
        "gas",
        "domain",
    },
    "story": {"story", "limits"},
    "shot": {"shots", "look", "cover"},
    "text": {"text"},
}


@pytest.mark.parametrize("name", CASES)
def test_pointers_fall_into_their_group(name: str) -> None:
    assert [group_of(p).name for p in CASES[name]] == [name] * len(CASES[name])


def test_every_group_has_cases_and_a_class() -> None:
    assert set(CASES) == set(GROUPS)
    assert {c: {g.name for g in GROUPS.values() if g.edit_class == c} for c in CLASSES} == CLASSES


def test_every_field_of_the_simulation_plan_and_an_entity_is_known() -> None:
    spec = WorldSpec.model_validate({"title": "t", "prompt": "p", "simulation": {"frames": 2}})
    pointers = list(differences({}, spec.simulation.model_dump(mode="json"), "/simulation"))
    assert len(pointers) >= len(type(spec.simulation).model_fields) // 2, "the plan was not taken apart"
    for pointer in pointers:
        assert group_of(pointer).name != "text", pointer


def test_what_is_simulated_is_never_text() -> None:
    """A field that the motion depends on must not be changeable as mere text."""
    from worldagent.tests.stories.small_run import PROMPT, small_spec
    from worldagent.worlds.slices import motion_slice

    spec = WorldSpec.model_validate({**small_spec(), "prompt": PROMPT})
    motion = motion_slice(spec)
    assert "ball" in motion["entities"]
    for pointer in differences({}, spec.model_dump(mode="json")["entities"]["ball"], "/entities/ball"):
        if group_of(pointer).name == "text":
            assert pointer.rpartition("/")[2] not in motion["entities"]["ball"], pointer
