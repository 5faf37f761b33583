"""A workshop whose furniture and clutter never move but for what a story needs: its static rows pass as it is built."""

from __future__ import annotations

from pathlib import Path

from worldagent.construction.interiors.build import build_interior
from worldagent.workflow.creation import create
from worldagent.workflow.interiors import interior_operations
from worldagent.worlds.patch import apply_patch
from worldagent.worlds.spec import Interior

PLAN = {
    "rooms": {"shop": {"kind": "workshop", "area": 20.0, "doors": ["outside"], "windows": False}},
    "seed": 4,
    "density": 0.5,
    "still": True,
    "moves": ["tin_can"],
}


def test_a_still_workshop_passes_its_static_checks_with_few_bodies_that_move(tmp_path: Path) -> None:
    """Nothing in it floats over gaps of skins that add up, and no edit had to make anything static."""
    asked = Interior.model_validate(PLAN)
    made = build_interior("flat", asked, gap=1e-3)
    moving = [key for key, entity in made.entities.items() if entity["motion"] == "dynamic"]
    assert 1 <= len(moving) <= 6 < 50 < len(made.entities)
    session, _ = create(tmp_path, "w", "a workshop", {"simulation": {"frames": 2}})
    operations = interior_operations(session.spec, "flat", asked, made)
    session.commit(apply_patch(session.spec, operations), patch=operations)
    rows, _, _ = session.check_static()
    held = [r for r in rows if r.id.startswith("support:derived")]
    assert len(held) > 60
    assert [(r.id, r.status) for r in rows if r.status not in ("pass", "not_applicable")] == []
