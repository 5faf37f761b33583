"""Words of material beside a noun: what it names is of that substance for most of its volume, whatever the claim of the word names."""

from __future__ import annotations

import re
from typing import Any

import pytest
from worldagent.tests.stories.small_run import small_spec
from worldagent.worlds.audits.claims import claim_problems
from worldagent.worlds.claim_marks import claim_operations
from worldagent.worlds.patch import apply_patch, parse_spec

STEEL, WOOD = ({"density": d, "substance": s} for d, s in ((7850, "steel"), (600, "wood")))
SMALL, LARGE = ({"shape": {"kind": "box", "size": [e, e, e]}} for e in (0.001, 0.5))


def refused(marked: str, ball: str = "wood", **parts: Any) -> list[str]:
    """Problems with the material of a ball of wood, with further parts; the floor is of steel."""
    spec = small_spec()
    spec["materials"] |= {"steel": STEEL, "wood": WOOD}
    for part in spec["entities"]["ball"]["parts"].values():
        part["material"] = ball
    spec["entities"]["ball"]["material"] = "steel"
    spec["entities"]["floor"]["material"] = "steel"
    spec["entities"]["ball"]["parts"] |= parts
    prompt = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", marked)
    made = parse_spec({**spec, "claims": {}, "spec_version": "2", "prompt": prompt})
    return [p.text for p in claim_problems(apply_patch(made, claim_operations(marked, made))) if "asks for steel" in p.text]


BADGE = {"badge": {**SMALL, "material": "steel"}}
CORE = {"core": {**LARGE, "material": "steel"}}


@pytest.mark.parametrize(
    ("marked", "parts"),
    [
        ("A [steel](property ball) [ball](thing ball).", {}),
        ("A [steel](property ball) [ball](thing ball).", BADGE),
        ("A [steel](property /entities/ball/parts/badge) [ball](thing ball).", BADGE),
        ("A [steel](property /materials/steel) [ball](thing ball).", BADGE),
        ("A [steel](property floor) [ball](thing ball) on a [floor](thing floor).", {}),
        ("A [ball](thing ball) of [steel](property floor) on a [floor](thing floor).", {}),
        ("Eine [Kugel](thing ball) aus [Stahl](property floor) auf dem [Boden](thing floor).", {}),
        ("Una [bola](thing ball) de [acero](property floor) sobre el [suelo](thing floor).", {}),
    ],
)
def test_a_body_that_is_mostly_of_something_else_is_refused(marked: str, parts: dict[str, Any]) -> None:
    assert refused(marked, **parts)


@pytest.mark.parametrize(
    ("marked", "ball", "parts"),
    [
        ("A [steel](property ball) [ball](thing ball).", "steel", {}),
        ("A [steel](property ball) [ball](thing ball).", "wood", CORE),
        ("A [steel](property /materials/steel) [ball](thing ball).", "steel", {}),
        ("A [ball](thing ball) on a [steel](property floor) [floor](thing floor).", "wood", {}),
        ("A [ball](thing ball) with a [steel](property /entities/ball/parts/badge) [badge](thing /entities/ball/parts/badge).", "wood", BADGE),
        ("Eine [Kugel](thing ball) auf einem [Boden](thing floor) aus [Stahl](property floor).", "wood", {}),
    ],
)  # fmt: skip
def test_honest_words_are_not_refused(marked: str, ball: str, parts: dict[str, Any]) -> None:
    assert refused(marked, ball, **parts) == []
