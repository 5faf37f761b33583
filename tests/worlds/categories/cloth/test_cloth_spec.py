"""Audit of cloth, the cost of an instance, and the vertices that a pin holds."""

from __future__ import annotations

from copy import deepcopy
from typing import Any

import numpy as np
import pytest
from worldagent.construction.build import build_entity
from worldagent.simulation.cloth.engine import SAFE
from worldagent.simulation.cloth.mesh import Fabric, sheet_of
from worldagent.simulation.cloth.stability import highest_frequency, longest_step
from worldagent.testing.worlds.small_cloth import DRAPE_PROMPT, FLAG_PROMPT, drape_spec, flag_spec
from worldagent.worlds.audits.audit import audit
from worldagent.worlds.categories.cloth.facts import cloth_estimate, held_by, sheet_grid, stiffest_step, vertices_of
from worldagent.worlds.limits import estimate_counts
from worldagent.worlds.patch import parse_spec
from worldagent.worlds.spec import ClothPin, Sheet, WorldSpec

CLOTH = {"area_density": 0.15, "thickness": 0.0006, "stretch_stiffness": 1000.0, "bend_stiffness": 2e-5}


def _flag(**changes: Any) -> WorldSpec:
    """The flag's world with changes to its physics."""
    spec = deepcopy(flag_spec())
    spec["entities"]["flag"]["physics"] |= changes
    return parse_spec({**spec, "prompt": FLAG_PROMPT})


def _problems(spec: WorldSpec) -> list[str]:
    return [str(p) for r in audit(spec).rows if r.id == "audit:cloth" for p in r.evidence.get("problems", ())]


def test_sound_worlds_pass_the_audit() -> None:
    for spec, prompt in ((flag_spec(), FLAG_PROMPT), (drape_spec(), DRAPE_PROMPT)):
        assert audit(parse_spec({**spec, "prompt": prompt})).passed


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"thickness": 0.03}, "neighbours would touch"),
        ({"pins": {"far": {"center": [9.0, 0.0, 0.0], "radius": 0.1}}}, "holds no vertex"),
        ({"pins": {"a": {"edge": "-x"}, "b": {"edge": "-x", "to": "pole"}}}, "hold the same vertices"),
        ({"pins": {"a": {"edge": "-x", "to": "flag"}}}, "only rigid ones hold"),
        ({"ignores": ["flag"]}, "not rigid"),
    ],
)
def test_what_cannot_work_is_named(changes: dict[str, Any], said: str) -> None:
    assert any(said in p for p in _problems(_flag(**changes)))


@pytest.mark.parametrize(("gap", "told"), [(0.0, True), (3e-4, True), (2e-3, False)])
def test_parts_of_a_cloth_that_meet_are_told_to_be_separate_sheets(gap: float, told: bool) -> None:
    """A hem of the flag, in its plane beside its free edge."""
    spec = deepcopy(flag_spec())
    parts = spec["entities"]["flag"]["parts"]
    (sheet,) = parts.values()
    (width, height), edge = sheet["shape"]["size"], sheet["shape"]["resolution"]
    hem = {**sheet["shape"], "size": [width, 4.0 * edge]}
    parts["hem"] = {"shape": hem, "pose": {"position": [0.0, -0.5 * height - gap - 2.0 * edge, 0.0]}}
    found = [p for p in _problems(parse_spec({**spec, "prompt": FLAG_PROMPT})) if "separate sheets" in p]
    assert bool(found) == told


def test_a_pin_needs_a_holder_of_one_body() -> None:
    """A rope is a chain of bodies, a breakable body falls into pieces: the audit refuses both before anything is simulated."""
    spec = deepcopy(flag_spec())
    spec["entities"]["flag"]["physics"]["pins"] = {"top": {"edge": "-x", "to": "pole"}}
    assert _problems(parse_spec({**spec, "prompt": FLAG_PROMPT})) == []
    pole = spec["entities"]["pole"]
    body = pole.pop("parts")
    pole |= {"motion": "dynamic", "generator": {"kind": "rope", "points": [[0, 0, 0], [0, 0, 1]], "radius": 0.01, "segments": 7}}
    (said,) = _problems(parse_spec({**spec, "prompt": FLAG_PROMPT}))
    assert "/entities/flag/physics/pins/top/to" in said
    for told in ("'pole', which is a rope of 7 bodies", "a holder of one body", "rod"):
        assert told in said
    del pole["generator"]
    bond = {"tension": 1e5, "shear": 1e5, "toughness": 10.0}
    pole |= {"parts": body, "breakable": {"pattern": {"kind": "voronoi", "pieces": 9, "seed": 1}, "bond": bond}}
    (said,) = _problems(parse_spec({**spec, "prompt": FLAG_PROMPT}))
    assert "'pole', which is breakable, of about 9 bodies" in said


def test_a_sheet_belongs_to_cloth_and_cloth_to_sheets() -> None:
    spec = deepcopy(flag_spec())
    spec["entities"]["pole"]["parts"]["body"]["shape"] = {"kind": "sheet", "size": [1.0, 1.0], "resolution": 0.1}
    spec["entities"]["flag"]["parts"]["body"]["shape"] = {"kind": "box", "size": [1.0, 1.0, 1.0]}
    spec["simulation"]["drivers"]["push"] = {"kind": "force", "entity": "flag", "end": 1.0}
    said = _problems(parse_spec({**spec, "prompt": FLAG_PROMPT}))
    assert any("sheets are cloth only" in p for p in said)
    assert any("made of sheets or meshes" in p for p in said)
    assert any("cannot act on cloth" in p for p in said)


def test_a_sheet_too_coarse_to_bend_is_refused_with_the_resolution_it_needs() -> None:
    spec = deepcopy(flag_spec(resolution=0.4))
    said = _problems(parse_spec({**spec, "prompt": FLAG_PROMPT}))
    assert any("fewer than 4 edges" in p and "0.2 m" in p for p in said)


def test_pins_hold_an_edge_a_patch_or_the_nearest_vertex() -> None:
    points, _ = sheet_grid(Sheet(size=(1.0, 0.5), resolution=0.1))
    assert np.ptp(points[held_by(ClothPin(edge="+y"), points), 1]) == 0
    assert len(held_by(ClothPin(edge="+y"), points)) == 11
    assert len(held_by(ClothPin(center=(0.5, 0.25, 0.0)), points)) == 1
    patch = points[held_by(ClothPin(center=(0.0, 0.0, 0.0), radius=0.15), points)]
    assert 1 < len(patch) < 20
    assert np.linalg.norm(patch, axis=1).max() <= 0.15


def test_the_estimate_is_what_is_built_and_near_the_step_that_is_taken() -> None:
    """The step is estimated from the edge alone: within 40 % of the one from the sheet's highest frequency."""
    spec = _flag()
    built = build_entity(spec, "flag", None)  # type: ignore[arg-type]
    mesh = built.parts[0].simulation
    assert mesh is not None
    estimate = cloth_estimate(spec, "cloth")
    assert estimate.vertices == len(mesh.vertices)
    assert estimate_counts(spec)["vertices"] == estimate.vertices
    found = vertices_of(spec.entities["flag"])
    assert found is not None
    assert found == pytest.approx(mesh.vertices)
    assert built.bodies[0].mass == pytest.approx(0.15 * 1.2 * 0.8)
    sheet = sheet_of(mesh.vertices, mesh.faces, Fabric(0.15, (1000.0, 1000.0), 100.0, 2e-5, 0.0, 6e-4))
    physics = spec.entities["flag"].physics
    assert physics.category == "cloth"
    taken = SAFE * longest_step(highest_frequency(sheet), 0.0)
    assert stiffest_step(physics, 0.05) == pytest.approx(taken, rel=0.4)


def test_widening_what_cloth_may_do_is_a_weakening() -> None:
    from worldagent.worlds.patch import weakenings

    before = _flag(max_stretch=0.1)
    for changes in (
        {"max_stretch": 0.5},
        {"max_stretch": 0.1, "self_collision": False},
        {"max_stretch": 0.1, "ignores": ["pole"]},
    ):
        assert weakenings(before, _flag(**changes)), changes
