"""Contacts and causes between bodies and cloth, by the cloth's own record: a ball that falls into a held sheet, and one that misses it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.testing.worlds.simulated_worlds import beat, edited, simulate
from worldagent.testing.worlds.small_cloth import CATCH_PROMPT, catch_spec
from worldagent.verifiers.categories.registry import JUDGES, pressed
from worldagent.verifiers.predicates.evaluators import evaluate
from worldagent.verifiers.predicates.events.course import between
from worldagent.verifiers.story import causal
from worldagent.verifiers.story.chains import Chains
from worldagent.verifiers.story.onsets import begins
from worldagent.worlds.audits.audit import audit
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.errors import EvidenceError
from worldagent.worlds.patch import parse_spec
from worldagent.worlds.predicates import Contact, Deflection, Displacement, NoContact, PairEvent, Predicate
from worldagent.worlds.spec import WorldSpec

FRAMES = 14
"""The ball falls 0.12 m to the sheet: it meets it in frame 4."""


def _world(*, x: float = 0.0, coupled: bool = True, holder: str | None = None, frames: int = FRAMES) -> WorldSpec:
    given = catch_spec(frames=frames, coupled=coupled)
    given["entities"]["ball"]["pose"]["position"][0] = x
    if holder is not None:
        given["entities"]["cloth"]["physics"]["pins"]["c0"]["to"] = holder
    return parse_spec({**given, "prompt": CATCH_PROMPT})


def _asked(base: Candidate, cause: Predicate) -> Candidate:
    """With a story in which the cause, of the ball, makes the cloth sag. It sags by itself a little from the start: that is not asked."""
    last = base.frame_count - 1
    sag = Displacement(entity="cloth", min=0.002)
    told = {
        "falls": beat("ball", cause, frames=(0, last)),
        "sags": beat("cloth", sag, frames=(8, last), causes=["falls"], owner="cloth"),
    }
    spec = base.spec.model_copy(update={"story": base.spec.story.model_copy(update={"beats": told})})
    return Candidate(base.folder, spec, base.built, base.stage, base.caches, base.artifact, base.digest)


@pytest.fixture(scope="module")
def caught(tmp_path_factory: pytest.TempPathFactory) -> Candidate:
    return simulate(tmp_path_factory.mktemp("caught"), _world())


@pytest.fixture(scope="module")
def missed(tmp_path_factory: pytest.TempPathFactory) -> Candidate:
    return simulate(tmp_path_factory.mktemp("missed"), _world(x=0.9))


def _silenced(base: Candidate, folder: Path) -> Candidate:
    def change(_frame: int, data: dict[str, Any]) -> None:
        data["exchange/impulse"] = np.zeros_like(data["exchange/impulse"])

    return edited(base, folder, "cloth", change)


def _contact(candidate: Candidate, least: float = 0.01) -> Any:
    return evaluate(candidate, Contact(a="ball", b="cloth", min_impulse=least), (0, FRAMES - 1))


def test_a_ball_that_falls_into_a_sheet_touches_it(caught: Candidate) -> None:
    """The impulse is what the ball's own momentum says: it was stopped by the sheet, or pushed more."""
    found, given = _contact(caught), pressed(caught, "cloth", "ball")
    assert given is not None
    assert (found.status, found.first_true_frame) == ("pass", int(np.argmax(np.cumsum(given) >= 0.01)))
    assert not given[:3].any()
    speed = caught.caches["rigid"].series("velocity")[:, 0, 2]
    mass = caught.entity("ball").bodies[0].mass
    felt = mass * (speed[-1] - speed[0] + 9.81 * (FRAMES - 1) / 24)
    assert found.value == pytest.approx(felt, rel=0.05)
    assert _contact(caught, 2.0 * found.value).status == "fail"
    assert evaluate(caught, NoContact(a="cloth", b="ball"), (0, FRAMES - 1)).status == "fail"
    assert begins(caught, "ball", "cloth", (0, FRAMES - 1)) == (int(np.argmax(given > 0)) - 1) / 24


def test_a_sheet_that_throws_a_ball_back_pushes_it(missed: Candidate, tmp_path: Path) -> None:
    """It takes the ball's fall, which is no push, and then gives it a way upwards; what it gave is what the ball's momentum says."""
    last = 23
    thrown = simulate(tmp_path / "thrown", _world(frames=last + 1))
    asked = PairEvent(kind="pushes", entity="cloth", other="ball")
    found = evaluate(thrown, asked, (0, last))
    height, speed = (thrown.caches["rigid"].series(name)[:, 0, 2] for name in ("position", "velocity"))
    lowest = int(np.argmin(height))
    assert found.status == "pass", found.explanation
    assert found.first_true_frame is not None
    assert found.first_true_frame > lowest
    assert evaluate(thrown, asked, (0, lowest)).status == "fail"
    met = between(thrown, "cloth", "ball")
    felt = thrown.entity("ball").bodies[0].mass * (speed[-1] - speed[0] + 9.81 * last / 24)
    assert met.impulse[:, 2].sum() == pytest.approx(felt, rel=0.05)
    assert np.array_equal(between(thrown, "ball", "cloth").impulse, -met.impulse)
    assert evaluate(missed, asked, (0, FRAMES - 1)).status == "fail"


def test_a_ball_that_misses_touches_nothing_and_is_no_cause(missed: Candidate) -> None:
    found = _contact(missed, 0.0)
    assert (found.status, found.unit) == ("fail", "m")
    assert evaluate(missed, NoContact(a="cloth", b="ball"), (0, 4)).status == "pass"
    (row,) = causal.check(_asked(missed, Displacement(entity="ball", min=0.05)))
    assert row.status == "fail"
    assert "no impulse chain" in row.evidence["explanation"]


@pytest.mark.parametrize("cause", [Displacement(entity="ball", min=0.05), Contact(a="ball", b="cloth", min_impulse=0.01)])
def test_a_ball_makes_a_sheet_sag(caught: Candidate, tmp_path: Path, cause: Predicate) -> None:
    """The record set to zero leaves neither a contact nor a chain."""
    (row,) = causal.check(_asked(caught, cause))
    assert row.status == "pass", row.evidence["explanation"]
    silent = _asked(_silenced(caught, tmp_path), cause)
    assert [r.status for r in causal.check(silent)] == ["fail"]
    assert _contact(silent).status == "fail"


def test_a_sheet_sends_to_what_feels_it_alone(caught: Candidate, tmp_path: Path) -> None:
    assert JUDGES["cloth"].unfelt(caught.spec) == set()
    back = Chains(caught).spread(["cloth"], 0.0, FRAMES - 1, subject="ball", acting_until=FRAMES)
    assert [(h.source, h.target) for h in back.chain("ball")] == [("cloth", "ball")]
    alone = simulate(tmp_path, _world(coupled=False, frames=7))
    chains = Chains(alone)
    assert any(JUDGES["cloth"].pushes(alone))
    assert not chains.spread(["cloth"], 0.0, 6, subject="ball", acting_until=6).ever("ball")
    assert chains.spread(["ball"], 0.0, 6, subject="cloth").ever("cloth")


def test_what_holds_a_sheet_and_stands_still_sends_nothing(tmp_path: Path) -> None:
    """The ground holds a corner: its pull is in the record, and no chain goes from it to the cloth or through it to the ball."""
    held = simulate(tmp_path, _world(holder="ground"))
    assert any(b == "ground" for pushes in JUDGES["cloth"].pushes(held) for _, b, *_ in pushes)
    reach = Chains(held).spread(["ground"], 0.0, FRAMES - 1, subject="cloth")
    assert not reach.ever("cloth")
    assert Chains(held).spread(["ball"], 0.0, FRAMES - 1, subject="cloth").chain("cloth")[0].source == "ball"
    with pytest.raises(EvidenceError, match="holds a pin"):
        pressed(held, "ground", "cloth")


def _two(frames: int = FRAMES) -> WorldSpec:
    """A second sheet of the same instance, three metres away."""
    given = catch_spec(frames=frames)
    given["entities"]["far"] = {**given["entities"]["cloth"], "pose": {"position": [3.0, 0.0, 0.8]}}
    given["simulation"]["solvers"]["cloth"]["members"].append("far")
    return parse_spec({**given, "prompt": CATCH_PROMPT})


def test_two_sheets_of_one_instance_are_told_apart_by_their_place(tmp_path: Path) -> None:
    """Only the sheet under the ball is pushed by it; of contacts the record of both tells nothing."""
    both = simulate(tmp_path, _two(7))
    assert {(a, b) for pushes in JUDGES["cloth"].pushes(both) for a, b, *_ in pushes} == {("cloth", "ball")}
    with pytest.raises(EvidenceError, match="other members"):
        pressed(both, "ball", "cloth")


def _evidence(world: WorldSpec, predicate: Predicate) -> tuple[str, str]:
    event = world.story.beats["event"].model_copy(update={"predicate": predicate})
    told = world.model_copy(update={"story": world.story.model_copy(update={"beats": {"event": event}})})
    row = next(r for r in audit(told).rows if r.id.endswith("evidence"))
    return row.status, " ".join(c.action + c.cause for c in row.corrections) + str(row.evidence)


def test_contacts_that_no_record_tells_are_refused_by_the_audit() -> None:
    asked = Contact(a="ball", b="cloth")
    assert _evidence(_world(), asked)[0] == "pass"
    assert _evidence(_world(), PairEvent(kind="pushes", entity="cloth", other="ball"))[0] == "pass"
    status, told = _evidence(_world(), PairEvent(kind="hits", entity="ball", other="cloth"))
    assert status == "fail"
    assert "min_impulse, or pushes" in told
    for world, what in (
        (_world(holder="ball"), "holds a pin"),
        (_two(), "instance of its own"),
    ):
        status, text = _evidence(world, asked)
        assert status == "fail"
        assert what in text
    status, text = _evidence(_two(), Contact(a="cloth", b="far"))
    assert (status, "ask separation" in text) == ("fail", True)
    through = _world()
    through.entities["cloth"].physics.ignores.append("ball")  # type: ignore[union-attr]
    assert "passes through" in _evidence(through, NoContact(a="cloth", b="ball"))[1]
    assert _evidence(_world(), Deflection(entity="cloth", min=0.01))[0] == "pass"
