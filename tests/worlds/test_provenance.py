"""Artifacts are stale after an edit exactly where their inputs changed (R115, R116)."""

from __future__ import annotations

from typing import Any

import pytest
from worldagent.tests.stories.small_run import PROMPT, small_spec
from worldagent.worlds.patch import apply_patch, parse_spec
from worldagent.worlds.provenance import SEEN, recipes, stale_artifacts, stale_rows
from worldagent.worlds.requirements import Row
from worldagent.worlds.slices import geometry_slice, motion_slice
from worldagent.worlds.spec import WorldSpec

MOTION = {"motion", "contact", "category", "story", "shots", "seen", "claims", "acceptance", "final"}
JUDGED = {"contact", "category", "story", "shots", "claims", "acceptance", "final"}
ALL_STATIC = {f"static:{n}" for n in small_spec()["entities"]}
EDITS: dict[str, tuple[str, Any, set[str]]] = {
    "a pose": ("/entities/b1/pose/position", [0.1, 0, 0.33], MOTION | {"static:b1"}),
    "a shape": ("/entities/b1/parts/body/shape/size", [0.03, 0.05, 0.06], MOTION | {"built:b1", "static:b1"}),
    "a mass": ("/entities/b1/physics/mass", 0.1, MOTION | {"built:b1", "static:b1"}),
    "a start velocity": ("/entities/ball/physics/linear_velocity", [2, 0, 0], MOTION),
    "a declared size": ("/entities/b1/dimensions/size", [0.03, 0.05, 0.051], {"static:b1", "claims", "acceptance", "final"}),
    "a tolerance": ("/entities/b1/dimensions/tolerance", 0.05, {"static:b1", "claims", "acceptance", "final"}),
    "a density": ("/materials/steel/density", 7800, MOTION | {"built:ball", "static:ball"}),
    "a friction": ("/materials/steel/friction", 0.4, MOTION),
    "a colour": ("/materials/steel/appearance/color", [0, 0, 0], {"seen", "final"}),
    "light": ("/look/sky", "overcast", {"seen", "final"}),
    "an exposure": ("/look/exposure", 1, {"seen", "final"}),
    "words of a shot": ("/shots/only/intent", "other", {"shots", "claims", "acceptance", "final"}),
    "samples": ("/look/samples", 4, {"final"}),
    "the shape of the picture": ("/look/width", 128, {"shots", "seen", "claims", "acceptance", "final"}),
    "a camera": ("/shots/only/keys/a/fov_deg", 45, {"shots", "seen", "claims", "acceptance", "final"}),
    "a beat": ("/story/beats/fall/predicate/min", 0.2, {"story", "shots", "claims", "acceptance", "final"}),
    "a limit": ("/simulation/limits/max_speed", 30, JUDGED | ALL_STATIC),
    "a relation": ("/graph/relations/hits", {"kind": "interacts", "a": "ball", "b": "b2"},
                   {"static:ball", "static:b1", "static:b2", "story", "claims", "acceptance", "final"}),
    "declared overlap": ("/graph/relations/glue", {"kind": "fastened", "a": "b1", "b": "b2", "max_depth": 0.1, "reason": "glued fast"},
                         MOTION | {"static:b1", "static:b2"}),
    "a region": ("/graph/regions/r", {"kind": "sphere", "center": [0, 0, 0], "radius": 1}, {"story", "claims", "acceptance", "final"}),
    "a step": ("/simulation/solvers/rigid/settings/step", 0.0002, MOTION),
    "gravity": ("/simulation/gravity", [0, 0, -3.7], MOTION),
    "a claim": ("/claims/ball/by", ["/entities/b1"], {"claims", "acceptance", "final"}),
    "a title": ("/title", "other", {"acceptance", "final"}),
    "a role": ("/entities/b1/role", "other", {"static:b1", "claims", "acceptance", "final"}),
    "an unused material": ("/materials/lead", {"density": 11340}, {"seen", "acceptance", "final"}),
}  # fmt: skip


def base() -> WorldSpec:
    return parse_spec({**small_spec(), "prompt": PROMPT})


def edited(pointer: str, value: Any) -> WorldSpec:
    return apply_patch(base(), [{"op": "add", "path": pointer, "value": value}])


@pytest.mark.parametrize("name", EDITS)
def test_an_edit_makes_stale_exactly_what_depends_on_it(name: str) -> None:
    pointer, value, expected = EDITS[name]
    assert set(stale_artifacts(base(), edited(pointer, value))) == expected


def test_equal_specifications_leave_nothing_stale() -> None:
    assert stale_artifacts(base(), base()) == []


def test_added_and_removed_entities_are_named() -> None:
    spec = edited("/entities/b4", small_spec()["entities"]["b1"])
    assert {"built:b4", "static:b4"} < set(stale_artifacts(base(), spec))
    assert stale_artifacts(base(), spec) == stale_artifacts(spec, base())


def test_every_entity_has_its_recipes() -> None:
    found = recipes(base())
    assert set(found) == {f"{k}:{n}" for k in ("built", "static") for n in small_spec()["entities"]} | MOTION


def test_the_motion_does_not_read_the_story_or_the_look() -> None:
    for name in ("a beat", "a camera", "a colour", "light", "a limit", "a relation", "a title"):
        pointer, value, _ = EDITS[name]
        assert motion_slice(edited(pointer, value)) == motion_slice(base()), name


def test_the_motion_reads_what_is_fastened_to_a_body_that_moves() -> None:
    """The engine opens no skins between them, so that a bake without the relation is another one."""
    assert "fastened" not in motion_slice(base())
    still = next(n for n, e in base().entities.items() if e.motion == "static")
    relation = {"kind": "fastened", "a": "b1", "b": still, "max_depth": 0.01, "reason": "glued to its base"}
    assert motion_slice(edited("/graph/relations/glued", relation))["fastened"] == [sorted(("b1", still))]
    loose = motion_slice(edited("/graph/relations/glued", {**relation, "a": still, "b": still}))
    assert "fastened" not in loose, "what does not move is not opened"


def test_defaults_written_out_change_no_geometry() -> None:
    written = edited("/entities/b1/parts/body/pose", {"position": [0, 0, 0]})
    assert geometry_slice(written, "b1") == geometry_slice(base(), "b1")


def row(check: str, *entities: str) -> Row:
    return Row(
        id=f"{check}:{'-'.join(entities)}",
        check=check,
        group="physical",
        predicate="p",
        status="pass",
        artifact="x",
        entities=entities,
    )  # type: ignore[arg-type]


ROWS = [
    row("audit"), row("scale", "b1"), row("scale", "b2"), row("interpenetration", "b1", "b2"), row("support", "b1"), row("navigability"),
    row("contact"), row("category"), row("numerical"), row("beat"), row("causal"), row("shots", "b1"), row("delivery"),
    row("shots", "light").model_copy(update={"question": SEEN}),
]  # fmt: skip


def lost(name: str, stage: str) -> set[str]:
    pointer, value, _ = EDITS[name]
    stages = {r.id: "static" if r.check in ("scale", "interpenetration") else stage for r in ROWS}
    found = stale_rows(ROWS, stages, stale_artifacts(base(), edited(pointer, value)))
    return {i.split(":")[0] if i.count(":") == 1 and i.endswith(":") else i for i in found}


def test_rows_lose_their_evidence_with_what_they_judged() -> None:
    moving = {
        "contact",
        "category",
        "numerical",
        "beat",
        "causal",
        "shots:b1",
        "delivery",
        "support:b1",
        "navigability",
        "shots:light",
    }
    assert lost("a pose", "full") == moving | {"scale:b1", "interpenetration:b1-b2"}
    assert lost("a start velocity", "full") == moving
    assert lost("a camera", "full") == {"shots:b1", "shots:light", "delivery"}
    assert lost("a beat", "full") == {"beat", "causal", "support:b1", "navigability", "shots:b1", "shots:light", "delivery"}
    assert lost("samples", "full") == set()
    assert lost("a title", "full") == {"delivery"}
    assert lost("a role", "full") == {"delivery", "scale:b1", "interpenetration:b1-b2"}
    assert lost("light", "full") == lost("an exposure", "full") == lost("a colour", "full") == {"shots:light"}
    assert lost("a limit", "full") == moving | {"scale:b1", "scale:b2", "interpenetration:b1-b2"}


def test_rows_judged_at_frame_0_lose_theirs_with_the_scene() -> None:
    assert "shots:b1" in lost("a camera", "static")
    assert "navigability" in lost("a region", "static")
    assert "support:b1" in lost("a pose", "static")
