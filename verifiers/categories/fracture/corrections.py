"""Corrections that make a body break as asked: harder blows, weaker bonds, or a distance that its pieces reach."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from ....worlds.categories.fracture.events import FractureEvent
from ....worlds.errors import EvidenceError
from ....worlds.predicates import Breach, Broken, Debris, atoms_of
from ...rows.corrections import correction
from .bounds import NEARLY
from .frames import Frames

if TYPE_CHECKING:
    from ....worlds.candidate import Candidate
    from ....worlds.requirements import Correction
    from ....worlds.spec import SpecModel
    from ...predicates.outcome import Outcome

__all__ = ["breaking"]


def breaking(
    candidate: Candidate, predicate: SpecModel, entity: str, outcome: Outcome, details: dict[str, object], pointer: str
) -> list[Correction] | None:
    """Corrections for a breakable body that breaks or falls apart too little; None where something else is asked.

    Args:
        candidate: what was judged.
        predicate: what is asked.
        entity: of which it fails.
        outcome: what it came to.
        details: numbers of the outcome.
        pointer: of the beat or requirement.
    """
    asked = [a for a in atoms_of(predicate) if isinstance(a, Broken | Breach | Debris | FractureEvent) and a.entity == entity]
    contract = candidate.spec.entities[entity]
    if not asked or contract.breakable is None or outcome.comparison != ">=":
        return None
    hitters = _hitters(candidate, entity, asked)
    falls = not hitters and any(isinstance(a, FractureEvent) and _still(candidate, a.other) for a in asked)
    who = " and ".join(hitters) or (f"{entity} itself" if falls else "what hits it")
    hitters = hitters or ([entity] if falls else [])
    bond = f"/entities/{entity}/breakable/bond"
    found = _apart(predicate, entity, outcome, details, pointer, asked)
    return [
        *found,
        correction(
            f"the blow on {entity} is too weak",
            "initial_state",
            f"raise the speed of {who}: a faster throw, a longer or steeper way; what a blow can break grows with mass times speed squared",
            pointers=tuple(f"/entities/{h}/physics/linear_velocity" for h in hitters),
        ),
        correction(
            f"what hits {entity} is too light",
            "mass",
            f"make {who} heavier",
            pointers=tuple(f"/entities/{h}/physics/mass" for h in hitters),
        ),
        correction(
            f"the bonds of {entity} hold more than the blow gives",
            "bonds",
            f"lower tension and shear, and toughness where it is not 0; now {contract.breakable.bond.tension:.3g} and "
            f"{contract.breakable.bond.shear:.3g} Pa",
            pointers=(f"{bond}/tension", f"{bond}/shear", f"{bond}/toughness"),
        ),
    ]


def _still(candidate: Candidate, name: str | None) -> bool:
    """True of something static: what is to break on it brings the blow along."""
    return name in candidate.spec.entities and candidate.spec.entities[name].motion == "static"


def _apart(
    predicate: SpecModel,
    entity: str,
    outcome: Outcome,
    details: dict[str, object],
    pointer: str,
    asked: list[Broken | Breach | Debris | FractureEvent],
) -> list[Correction]:
    """Corrections of debris: by whether enough lumps came loose at all, and how far they went."""
    one = asked[0]
    lumps, reached = details.get("lumps"), details.get("reached")
    if len(asked) > 1 or not isinstance(one, Debris) or not isinstance(lumps, int) or outcome.bound is None:
        return []
    if not isinstance(reached, float):
        return [
            correction(
                f"{entity} is in {lumps} loose lumps, {math.ceil(outcome.bound)} are asked for: its bonds hold, however far the lumps go",
                "bonds",
                "lower tension and shear, so that it falls into more pieces",
                pointers=(f"/entities/{entity}/breakable/bond/tension", f"/entities/{entity}/breakable/bond/shear"),
            )
        ]
    wanted = float(f"{NEARLY * reached:.2g}")
    place = f"{pointer}/predicate/min_distance"
    if wanted <= 0.0:
        return []
    return [
        correction(
            f"{entity} is in {lumps} loose lumps, enough of them lie {reached:.3g} m off their place, {one.min_distance:g} m are asked for",
            "story",
            f"ask for min_distance {wanted:g} m (a weakening), or drive the pieces further apart",
            pointers=(place,),
            patch=({"op": "add", "path": place, "value": wanted},) if one is predicate else (),
        )
    ]


def _hitters(candidate: Candidate, entity: str, asked: list[Broken | Breach | Debris | FractureEvent]) -> list[str]:
    """Dynamic bodies that are to break it, or else those that broke bonds of it."""
    named = [n for a in asked if (n := a.by if isinstance(a, Broken) else getattr(a, "other", None)) is not None]
    if not named:
        solver = next((s for s, i in candidate.spec.simulation.rigid.items() if entity in i.members), None)
        if solver is None:
            return []
        try:
            frames = Frames(candidate, solver, entity)
            named = [frames.collider(e.cause) for f in range(1, candidate.last_frame + 1) for e in frames.breaks(f)]
        except EvidenceError:
            return []
    entities = candidate.spec.entities
    return [n for n in dict.fromkeys(named) if n != entity and n in entities and entities[n].motion == "dynamic"]
