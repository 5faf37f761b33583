"""A world beside a failed one of its prompt: the acceptance tells where it asks less, by claim (R157)."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from worldagent.execution import JobStore
from worldagent.tests.worlds.test_by_claim import OTHER_IDS, WEAKER, Edit, world
from worldagent.tools.edit_spec import edit_spec
from worldagent.workflow.context import ToolContext
from worldagent.workflow.siblings import easier_beside, started_anew
from worldagent.worlds.folder import WorldFolder
from worldagent.worlds.ledger import Ledger
from worldagent.worlds.requirements import Row
from worldagent.worlds.spec import WorldSpec

LIGHTER, LATER = WEAKER["a lighter body"][0], WEAKER["an optional beat"][0]


class Made:
    """A workspace with worlds of one prompt."""

    def __init__(self, root: Path) -> None:
        self.root = root
        self.context = ToolContext(root, JobStore(root), lambda done, total, message: None, lambda: False)

    def world(self, name: str, spec: WorldSpec) -> None:
        told: dict[str, Any] = spec.model_dump(mode="json", exclude_none=True)
        edit_spec(self.context, world=name, prompt=told.pop("prompt"), spec=told)

    def fails(self, name: str) -> None:
        ledger = Ledger(WorldFolder.of(self.root, name).ledger_path)
        row = Row(id="beat:fall", check="beat", group="temporal", predicate="p", status="fail", artifact="x")
        ledger.put_rows([row], revision=ledger.revision(), stage="probe")

    def looked(self, name: str) -> None:
        """Frames of a sketch were looked at, and no row of it was ever judged."""
        ledger = Ledger(WorldFolder.of(self.root, name).ledger_path)
        ledger.add_look("sketch of it", "sketch", ledger.revision(), 40)

    def easier(self, spec: WorldSpec) -> list[str]:
        return easier_beside(self.root, "again", spec)


@pytest.fixture
def made(tmp_path: Path) -> Made:
    found = Made(tmp_path)
    found.world("first", world())
    return found


def other(edit: Edit) -> WorldSpec:
    return world(edit, ids=OTHER_IDS)


def test_a_world_is_compared_with_failed_ones_alone(made: Made) -> None:
    assert made.easier(other(LIGHTER)) == []
    made.fails("first")
    (line,) = made.easier(other(LIGHTER))
    assert line.startswith("easier than revision 1 of world first, whose rows failed: /entities/b3/physics/mass default -> 0.01")
    assert made.easier(world(ids=OTHER_IDS)) == []


def test_a_failed_world_that_was_made_easier_since_is_compared_as_it_failed(made: Made) -> None:
    made.fails("first")
    easier = [{"op": "replace", "path": "/story/beats/fall/mandatory", "value": False}]
    edit_spec(made.context, world="first", patch=easier, weakening_reason="it matters to nobody at all")
    (line,) = made.easier(other(LATER))
    assert line == "easier than revision 1 of world first, whose rows failed: /story/beats/fall made optional"


def test_a_world_that_was_looked_at_and_never_judged_is_compared_too(made: Made) -> None:
    made.looked("first")
    (line,) = made.easier(other(LIGHTER))
    assert line.startswith(
        "easier than revision 1 of world first, of which frames were seen without a verdict: /entities/b3/physics/mass"
    )
    assert started_anew(made.root, "again", world().prompt) == [
        "started anew beside world first, in which frames were seen without a verdict for this prompt"
    ]


def test_a_world_that_failed_before_it_was_claimed_is_compared_with_its_claims(made: Made) -> None:
    spec = world()
    made.world("early", spec.model_copy(update={"claims": {}}))
    made.fails("early")
    claims = {name: claim.model_dump(mode="json", exclude_none=True) for name, claim in spec.claims.items()}
    edit_spec(made.context, world="early", patch=[{"op": "add", "path": "/claims", "value": claims}])
    (line,) = made.easier(other(LATER))
    assert line.startswith("easier than revision 2 of world early")


def test_a_damaged_world_is_told_and_ends_nothing(made: Made) -> None:
    made.fails("first")
    WorldFolder.of(made.root, "first").ledger_path.write_bytes(b"no ledger")
    assert made.easier(other(LATER)) == ["not compared with world first: its ledger is damaged"]


def test_a_sentence_beside_the_prompt_hides_no_failed_world(made: Made) -> None:
    made.fails("first")
    before = "It is a quiet old yard in summer, with flowers along its old walls and a smell of hay. "
    longer = other(LIGHTER).model_copy(update={"prompt": before + world().prompt})
    (line,) = made.easier(longer)
    assert line.startswith("easier than revision 1 of world first")
    assert started_anew(made.root, "again", longer.prompt) == [
        "started anew beside world first, in which rows failed for a prompt that stands in this one, or holds it"
    ]


def test_a_prompt_of_the_same_pattern_about_other_things_is_not_accused(made: Made) -> None:
    made.fails("first")
    prompt = world().prompt
    things = prompt.replace("ball", "drum").replace("block", "bottle")
    assert things != prompt
    assert started_anew(made.root, "again", things) == []
    assert len(started_anew(made.root, "again", prompt.replace("The last", "Its last"))) == 1
