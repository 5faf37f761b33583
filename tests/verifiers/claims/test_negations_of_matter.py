"""Claims of a negation about matter: a bound of one's own is accepted up to what a plain event reaches, and refused beyond it."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from pydantic import TypeAdapter
from worldagent.testing.defects._gas_scenes import scene
from worldagent.testing.worlds.simulated_worlds import simulate as simulated
from worldagent.testing.worlds.small_cloth import FLAG_PROMPT, PULLED_PROMPT, flag_spec, pulled_spec
from worldagent.tests.verifiers.categories import test_vessels as vessels
from worldagent.tests.verifiers.categories.particles import test_bury_event as burying
from worldagent.tests.verifiers.claims import test_rivals_of_matter as recorded
from worldagent.tests.verifiers.claims.claimed import claimed
from worldagent.verifiers.claims.check import check
from worldagent.verifiers.claims.negations import impossible
from worldagent.verifiers.forged.matter import plain_measures
from worldagent.verifiers.forged.trial import is_forged
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.patch import parse_spec
from worldagent.worlds.predicates import Predicate
from worldagent.worlds.predicates.events import EVENT_KINDS
from worldagent.worlds.requirements import Row
from worldagent.worlds.spec import BoxRegion

made = recorded.made
model: Any = TypeAdapter(Predicate).validate_python
DENIED = {"no": {"quote": "never", "type": "negation", "by": ["/story/requirements/no"]}}


def test_every_kind_of_event_has_a_forged_motion_or_a_plain_measure(made: Callable[[str], Candidate]) -> None:
    matter = [kind for kind in EVENT_KINDS if not is_forged(kind)]
    assert set(matter) == set(recorded.WORLDS)
    for kind in matter:
        plain = plain_measures(made(kind), model({"kind": kind, **recorded.WORLDS[kind][1]}))
        assert plain, kind
        assert set(plain) <= set(EVENT_KINDS[kind].tightens)


@pytest.mark.parametrize("kind", recorded.WORLDS)
def test_a_kind_is_denied_by_itself_and_by_a_bound_up_to_a_plain_event(kind: str, made: Callable[[str], Candidate]) -> None:
    """Its recorded motion, on which it comes true: what is asked there can be denied; so can a plain measure, and no more."""
    candidate = made(kind)
    told = {"kind": kind, **recorded.WORLDS[kind][1]}
    assert impossible(candidate, model(told)) is None
    for field, plain in plain_measures(candidate, model(told)).items():
        harder = 1.1 if EVENT_KINDS[kind].tightens[field] == "up" else 0.9
        assert impossible(candidate, model({**told, field: plain})) is None, field
        why = impossible(candidate, model({**told, field: plain * harder}))
        assert why is not None, field
        assert f"asks for a {field} of" in why


@pytest.mark.parametrize("kind", ["fills", "floats", "buries"])
def test_a_denial_of_what_begins_near_all_is_not_met_by_a_little_less_than_all(
    kind: str, made: Callable[[str], Candidate]
) -> None:
    why = impossible(made(kind), model({"kind": kind, **recorded.WORLDS[kind][1], "min": 0.97}))
    assert why is not None
    assert "asks for a min of 0.97" in why


@pytest.mark.parametrize("kind", ["torn", "broken", "splash_height", "liquid_flux_through"])
def test_a_bound_on_what_may_happen_at_most_is_its_own(kind: str, made: Callable[[str], Candidate]) -> None:
    why = impossible(made(kind), model({"kind": kind, **recorded.WORLDS[kind][1], "max": 1e6}))
    assert why is not None
    assert "a max of its own" in why


# ---------------------------------------------------------------- sentences


def denied(candidate: Candidate, predicate: dict[str, Any], **regions: Any) -> Row:
    requirements = {"no": {"predicate": predicate, "never": True}}
    spec = claimed(candidate.spec, DENIED, requirements=requirements)
    spec.graph.regions.update(regions)
    (row,) = [r for r in check(dataclasses.replace(candidate, spec=spec)) if r.id.startswith("claim:negation:")]
    return row


def half_full(folder: Path) -> Candidate:
    """A vessel whose water stands still."""
    return recorded.flow(vessels.leaked)(folder)


def whole(folder: Path) -> Candidate:
    """A strip that is drawn out and could tear, and does not."""
    spec = pulled_spec(stretch=0.018, strength=2000.0, frames=6, notch=True)
    return simulated(folder, parse_spec({**spec, "prompt": PULLED_PROMPT}))


def slack(folder: Path) -> Candidate:
    document = flag_spec(frames=25, resolution=0.1)
    document["simulation"]["drivers"] = {}
    return simulated(folder, parse_spec({**document, "prompt": FLAG_PROMPT}))


def sand(folder: Path) -> Candidate:
    return burying.laid(burying.sand(folder / "run"), folder)


ABOVE = BoxRegion(min=(-0.4, -0.4, 0.59), max=(0.4, 0.4, 0.6))
AWAY = BoxRegion(min=(5, 5, 0), max=(6, 6, 1))
SENTENCES: dict[str, tuple[Callable[[Path], Candidate], dict[str, Any], str, float, float, dict[str, Any]]] = {
    "the water does not overflow": (half_full, {"kind": "overflows", "entity": "pool", "other": "tank"}, "min", 0.03, 0.5, {}),
    "no water comes there": (half_full, {"kind": "liquid_arrives", "entity": "pool", "region": "away"}, "min_volume", 1e-4, 0.5, {"away": AWAY}),
    "the strip does not tear": (whole, {"kind": "tears", "entity": "strip"}, "min", 0.1, 1.0, {}),
    "the flag does not flutter": (slack, {"kind": "flutters", "entity": "flag"}, "min_amplitude", 0.03, 0.9, {}),
    "the smoke does not reach the ceiling": (
        lambda folder: scene("cold"), {"kind": "gas_arrives", "entity": "smoke", "region": "above"}, "min_density", 2e-5, 1e-3, {"above": ABOVE},
    ),
    "the smoke does not rise so high": (lambda folder: scene("cold"), {"kind": "plume_height", "entity": "smoke"}, "min", 0.595, 5.0, {}),
    "the smoke does not burn": (lambda folder: scene("cold"), {"kind": "heat_release", "entity": "smoke"}, "min", 20.0, 1e6, {}),
    "the sand does not spill": (sand, {"kind": "particle_volume_in", "entity": "sand", "region": "away"}, "min", 1e-9, 0.5, {"away": AWAY}),
}  # fmt: skip
"""By sentence: a motion in which it holds, what it denies, and in a field of that a bound that can be met and one that cannot."""


@pytest.mark.parametrize("said", SENTENCES)
def test_an_honest_bound_is_accepted_and_one_that_is_never_met_is_refused(said: str, tmp_path: Path) -> None:
    make, predicate, field, honest, beyond, regions = SENTENCES[said]
    candidate = make(tmp_path)
    found = denied(candidate, {**predicate, field: honest}, **regions)
    assert (found.status, found.evidence["vacuous"]) == ("pass", {}), found.evidence
    refused = denied(candidate, {**predicate, field: beyond}, **regions)
    assert refused.status == "fail"
    assert "denies by 'no' what is more than its words" in refused.evidence["explanation"]
    assert f"asks for a {field} of {beyond:g}" in refused.evidence["explanation"]


def test_a_negation_that_what_happens_voids_is_told(made: Callable[[str], Candidate]) -> None:
    found = denied(made("tears"), {"kind": "tears", "entity": "strip", "min": 0.06})
    assert found.status == "fail"
    assert ", but " in found.evidence["explanation"]
