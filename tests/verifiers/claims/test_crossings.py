"""A body that crosses a thing goes from one of its sides to the other, over it; a plane that is passed somewhere is not enough (R131, R155)."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from worldagent.testing.worlds.event_worlds import event_world
from worldagent.testing.worlds.small_worlds import box
from worldagent.tests.verifiers.claims.claimed import rows
from worldagent.worlds.claims import reading_of
from worldagent.worlds.patch import parse_spec
from worldagent.worlds.spec import Entity, WorldSpec

LINE = box(0.04, 1.0, 0.0002, at=(0.75, 0, 0.0001))
BRIDGE = box(1.2, 0.4, 0.0002, at=(0.6, 0, 0.0001))
FAR = box(0.04, 1.0, 0.0002, at=(4.0, 0, 0.0001))
BESIDE = box(0.04, 0.5, 0.0002, at=(0.75, 2.0, 0.0001))
BEHIND = box(0.04, 1.0, 0.0002, at=(-0.5, 0, 0.0001))
LONG = box(6.0, 0.4, 0.0002, at=(1.0, 0, 0.0001))
PROMPT = "A ball crosses the {}."


def scene(thing: Entity) -> WorldSpec:
    """A ball that rolls 1.5 m along x from the origin, and a thing that it does not touch."""
    made = event_world("roll")
    document = made.model_dump(mode="json")
    document["entities"]["thing"] = thing.model_copy(update={"parts": {n: p.model_copy(update={"collides": False}) for n, p in thing.parts.items()}}).model_dump(mode="json")  # fmt: skip
    return parse_spec(document)


def claims(noun: str, verb: str = "crosses", more: Any = None) -> dict[str, Any]:
    return {
        "ball": {"quote": "ball", "type": "thing", "by": ["/entities/ball"]},
        "cross": {"quote": verb, "type": "event", "by": ["/story/beats/cross"]},
        noun: {"quote": noun, "type": "thing", "by": ["/entities/thing"]},
        **(more or {}),
    }


def judged(
    folder: Path, thing: Entity, noun: str, x: float, *, normal: float = 1.0, prompt: str = PROMPT, verb: str = "crosses"
) -> Any:
    plane = {"kind": "crosses", "entity": "ball", "point": [x, 0, 0], "normal": [normal, 0, 0]}
    found = rows(folder, scene(thing), claims(noun, verb), beats={"cross": ("ball", plane)}, prompt=prompt.format(noun))
    return found["cross"]


@pytest.mark.parametrize(
    ("thing", "noun", "x", "status"),
    [
        (LINE, "line", 0.75, "pass"),
        (LINE, "line", 0.1, "pass"),
        (BRIDGE, "bridge", 1.1, "pass"),
        (BRIDGE, "bridge", 0.3, "pass"),
        (FAR, "line", 0.1, "fail"),
        (BESIDE, "line", 0.75, "fail"),
        (BEHIND, "line", 0.1, "fail"),
        (LONG, "bridge", 0.3, "fail"),
        (LONG, "floor", 0.3, "pass"),
    ],
)
def test_the_named_thing_is_crossed_and_not_a_plane_alone(
    thing: Entity, noun: str, x: float, status: str, tmp_path: Path
) -> None:
    row = judged(tmp_path, thing, noun, x)
    assert row.status == status, row.evidence
    assert status == "pass" or "from one side of thing to the other" in row.evidence["explanation"]


def test_a_preposition_or_another_verb_asks_for_no_other_side(tmp_path: Path) -> None:
    assert judged(tmp_path / "a", FAR, "line", 0.75, prompt="A ball crosses towards the {}.").status == "pass"
    assert judged(tmp_path / "b", FAR, "line", 0.75, prompt="A ball rolls near the {}.", verb="rolls").status == "pass"


def test_another_language_is_measured_too(tmp_path: Path) -> None:
    for name, thing, status in (("a", LINE, "pass"), ("b", FAR, "fail")):
        row = judged(
            tmp_path / name, thing, "Linie", 0.1, prompt="Ein ball überquert die {}, und dann ist er hier.", verb="überquert"
        )
        assert row.status == status, row.evidence


def test_a_plane_beside_no_thing_is_the_agents_reading(tmp_path: Path) -> None:
    from worldagent.tests.verifiers.claims.claimed import candidate_of

    plane = {"kind": "crosses", "entity": "ball", "point": [0.5, 0, 0], "normal": [1, 0, 0]}
    for noun, told in (("line", False), ("floor", True)):
        made = candidate_of(
            tmp_path / noun, scene(LINE), claims(noun), beats={"cross": ("ball", plane)}, prompt=PROMPT.format(noun)
        )
        assert any("where the plane stands is the agent's reading" in w for w in reading_of(made.spec).warnings) is told
