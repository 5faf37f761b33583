"""Statements of the skill about mistakes, clauses and weakening, shown on its own example by the audit and the patches."""

from __future__ import annotations

import copy
import json
from collections.abc import Callable
from typing import Any

import pytest
from worldagent.server.skill_files import SKILLS
from worldagent.worlds.audits.audit import audit
from worldagent.worlds.audits.clauses import clauses_of
from worldagent.worlds.errors import SpecError
from worldagent.worlds.patch import apply_patch, parse_spec, weakenings
from worldagent.worlds.provenance import stale_artifacts

SKILL = (SKILLS / "world-building" / "SKILL.md").read_text()
EXAMPLE: dict[str, Any] = json.loads((SKILLS / "world-building" / "examples" / "two_blocks.json").read_text())
Change = Callable[[dict[str, Any]], Any]


def _broken(change: Change) -> dict[str, Any]:
    document = copy.deepcopy(EXAMPLE)
    change(document)
    return document


def _relate(document: dict[str, Any], **relation: Any) -> None:
    document["graph"]["relations"]["extra"] = relation


MISTAKES: list[tuple[str, Change]] = [
    ("audit:ownership", lambda d: d["simulation"]["solvers"]["rigid"]["members"].remove("wooden_block")),
    ("audit:ownership", lambda d: d["entities"]["floor"].update(motion="kinematic")),
    ("audit:claims", lambda d: d["claims"]["hits"].update(by=["/entities/steel_block"])),
    ("audit:claims", lambda d: d["claims"]["floor"].update(by=["/entities/nobody"])),
    ("audit:references", lambda d: d["story"]["beats"]["hit"].update(subject="wooden_blok")),
    ("audit:references", lambda d: _relate(d, kind="connects", a="hall", b="window")),
    ("audit:story", lambda d: d["story"]["beats"]["push"].update(subject="steel_block")),
    ("audit:story", lambda d: d["story"]["beats"]["slide"].update(causes=["push"])),
    ("audit:story", lambda d: d["story"]["beats"]["push"].update(frames=[4, 36])),
    ("audit:shots", lambda d: d["shots"]["only"]["covers"].remove("hit")),
    ("audit:density:wood", lambda d: d["materials"]["wood"].update(density=2000)),
    ("audit:graph", lambda d: _relate(d, kind="supports", a="wooden_block", b="floor")),
    ("audit:bounds", lambda d: d["simulation"]["solvers"]["rigid"]["settings"].update(skin=0.002)),
]


@pytest.mark.parametrize(("row_id", "change"), MISTAKES, ids=[f"{i}-{m[0]}" for i, m in enumerate(MISTAKES)])
def test_a_typical_mistake_fails_the_row_that_the_skill_names(row_id: str, change: Change) -> None:
    report = audit(parse_spec(_broken(change)))
    row = next(r for r in report.rows if r.id == row_id)
    assert row.status == "fail"
    assert not report.passed
    assert row.corrections[0].pointers
    assert row.evidence["problems"]


def test_the_skill_lists_these_mistakes() -> None:
    listed = SKILL.split("## Typical mistakes", 1)[1]
    for row_id in ("audit:ownership", "audit:claims", "audit:references", "audit:story", "audit:shots", "audit:density:*"):
        assert f"`{row_id}`" in listed


def test_the_audit_derives_order_pairs_and_coverage() -> None:
    report = audit(parse_spec(EXAMPLE))
    assert report.bake_order == ("rigid",)
    assert ("steel_block", "wooden_block") in report.contact_pairs
    assert report.coverage == {"slide": ("only",), "hit": ("only",), "push": ("only",)}


def test_clauses_of_version_1_are_split_at_sentences_and_commas() -> None:
    text = "A red ball rolls down, then it hits a cup and then the cup falls over; a small, old lamp stays lit"
    assert list(clauses_of(text).values()) == [
        "A red ball rolls down",
        "it hits a cup",
        "the cup falls over",
        "a small, old lamp stays lit",
    ]


def test_a_waived_claim_passes_the_audit_with_its_reason() -> None:
    waived = {"quote": "stone", "type": "property", "waived": "any floor will do here"}
    report = audit(parse_spec(_broken(lambda d: d["claims"].update(stone=waived))))
    assert next(r for r in report.rows if r.id == "audit:claims").status == "pass"


def test_the_prompt_never_changes() -> None:
    with pytest.raises(SpecError, match="immutable"):
        apply_patch(parse_spec(EXAMPLE), [{"op": "replace", "path": "/prompt", "value": "Something easier."}])


BEATS = "/story/beats"
GLUE = {"kind": "fastened", "a": "floor", "b": "wooden_block", "max_depth": 0.01, "reason": "it is glued"}
WEAKER: list[dict[str, Any]] = [
    {"op": "remove", "path": f"{BEATS}/push"},
    {"op": "add", "path": f"{BEATS}/push/mandatory", "value": False},
    {"op": "add", "path": f"{BEATS}/push/observe", "value": False},
    {"op": "replace", "path": f"{BEATS}/push/frames", "value": [5, 35]},
    {"op": "replace", "path": f"{BEATS}/push/causes", "value": []},
    {"op": "replace", "path": f"{BEATS}/push/predicate/of/1/min", "value": 0.01},
    {"op": "replace", "path": f"{BEATS}/hit/predicate", "value": {"kind": "speed", "entity": "wooden_block", "min": 0.1}},
    {"op": "remove", "path": "/graph/relations/wood_on_floor"},
    {"op": "add", "path": "/graph/relations/glue", "value": GLUE},
    {"op": "add", "path": "/simulation/limits/contact_gap", "value": 0.005},
    {"op": "add", "path": "/simulation/limits/visible_pixels", "value": 0.0002},
    {"op": "add", "path": "/entities/wooden_block/dimensions/tolerance", "value": 0.1},
    {"op": "remove", "path": "/claims/stone"},
    {"op": "replace", "path": "/simulation/frames", "value": 30},
    {"op": "replace", "path": "/materials/wood/substance", "value": "other"},
    {"op": "replace", "path": "/materials/wood/density", "value": 500},
    {"op": "replace", "path": f"{BEATS}/push/owner", "value": "nobody"},
]  # fmt: skip


@pytest.mark.parametrize("operation", WEAKER, ids=lambda o: f"{o['op']} {o['path']}")
def test_what_the_skill_calls_weakening_is_weakening(operation: dict[str, Any]) -> None:
    before = parse_spec(EXAMPLE)
    assert weakenings(before, apply_patch(before, [operation]))


@pytest.mark.parametrize(
    "operation",
    [
        {"op": "replace", "path": f"{BEATS}/push/predicate/of/1/min", "value": 0.1},
        {"op": "add", "path": "/simulation/limits/contact_gap", "value": 0.002},
        {"op": "replace", "path": "/entities/wooden_block/pose/position", "value": [-0.1, 0, 0.051]},
        {"op": "replace", "path": "/materials/wood/friction", "value": 0.4},
        {"op": "replace", "path": "/entities/wooden_block/parts/body/shape/size", "value": [0.1, 0.1, 0.12]},
    ],
    ids=lambda o: str(o["path"]),
)
def test_repairs_and_tightening_are_no_weakening(operation: dict[str, Any]) -> None:
    before = parse_spec(EXAMPLE)
    assert weakenings(before, apply_patch(before, [operation])) == []


def test_a_new_camera_keeps_the_motion_and_a_moved_block_does_not() -> None:
    before = parse_spec(EXAMPLE)
    camera = apply_patch(before, [{"op": "replace", "path": "/shots/only/keys/a/fov_deg", "value": 45}])
    assert "motion" not in stale_artifacts(before, camera)
    assert "shots" in stale_artifacts(before, camera)
    moved = apply_patch(before, [{"op": "replace", "path": "/entities/wooden_block/pose/position/0", "value": -0.1}])
    stale = stale_artifacts(before, moved)
    assert {"motion", "static:wooden_block"} <= set(stale)
    assert "built:wooden_block" not in stale
    assert "static:steel_block" not in stale
