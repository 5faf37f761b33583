"""The work of `place_object`: put entities in their places, build what is missing, run the static checks; at once, or as a job."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pydantic import BaseModel

from ..worlds.folder import WorldFolder
from .arrangements import Array, AssetAsk, Beside, Station
from .places_asked import Asked
from .session import Session

if TYPE_CHECKING:
    from ..execution import JobContext, Tell

__all__ = ["asked_of", "asked_plain", "place_and_check", "placing", "takes_long"]

THINGS_AT_ONCE = 24
"""Own choice: worlds with more entities are built and checked as a job. One of 82 took 20 to 285 s on busy cores."""
RESTLESS = ("support:balance", "support:grip", "support:derived")
"""Questions about bodies that a settle run answers."""
PLACED = 0.2
"""Own choice: share of the work before the checks, for progress alone."""
_MODELS: dict[str, type[BaseModel]] = {"asset": AssetAsk, "beside": Beside, "river": Station, "array": Array}
_TUPLES = ("at", "group")


def asked_plain(asked: Asked) -> dict[str, Any]:
    """A place that is asked for as JSON-able data, without what is not given."""
    data = {f.name: getattr(asked, f.name) for f in fields(asked)}
    plain = {k: v.model_dump(mode="json") if k in _MODELS and v is not None else v for k, v in data.items()}
    return {k: list(v) if isinstance(v, tuple) else v for k, v in plain.items() if v is not None}


def asked_of(data: dict[str, Any]) -> Asked:
    """The place that is asked for, from its data as `asked_plain` gives it."""
    models: dict[str, Any] = {k: _MODELS[k].model_validate(v) for k, v in data.items() if k in _MODELS}
    tuples = {k: tuple(data[k]) for k in _TUPLES if k in data}
    return Asked(**{**data, **models, **tuples})


def takes_long(session: Session, things: Sequence[Asked]) -> bool:
    """True for a world that a job builds and checks."""
    many = sum(1 if asked.array is None else THINGS_AT_ONCE for asked in things)
    return len(session.spec.entities) + many > THINGS_AT_ONCE


def placing(payload: dict[str, Any], context: JobContext) -> dict[str, Any]:
    """Put entities in their places and check the scene, as a job."""
    from ..execution import Part

    session = Session.at(WorldFolder.at(Path(payload["folder"])))
    reasons = (payload.get("hypothesis", ""), payload.get("weakening_reason", ""))
    things = [asked_of(data) for data in payload["things"]]
    return place_and_check(session, things, reasons, Part(context.progress), many=payload.get("many", False))


def place_and_check(
    session: Session, things: Sequence[Asked], reasons: tuple[str, str], tell: Tell, *, many: bool = False
) -> dict[str, Any]:
    """Put entities in their places and run the static checks; what was done and found, for the reply.

    Args:
        session: the world.
        things: what is put where; of none the scene is built and checked as it stands.
        reasons: hypothesis and reason of a weakening, of the edit.
        tell: takes how far the work is, as parts of 1.
        many: things for which there is no place are told, and the others placed; of a single one it is an error.

    Raises:
        InputError: an argument is wrong, or there is no such place.
        RefusedError: something would overlap and `strict` is set, or the rules of repair refuse the edit.
    """
    from ..execution import Part
    from .answers import weaker_told
    from .early_words import unmet_at_start
    from .placement import place, place_many
    from .rows import summary

    outcome: dict[str, Any] = {}
    if things:
        tell(0.02, 1.0, f"finding the place of {things[0].entity}" + (f" and {len(things) - 1} more" if things[1:] else ""))
        if many:
            outcome = place_many(session, things, hypothesis=reasons[0], weakening_reason=reasons[1])
        else:
            outcome = place(session, things[0], hypothesis=reasons[0], weakening_reason=reasons[1])
    head = {"world": session.folder.id, "revision": session.revision, **outcome}
    if any(asked.asset is not None for asked in things) and not session.buildable(session.audit()):
        return {**head, "audit_open": [r.id for r in session.audit().rows if r.mandatory and r.status != "pass"]}
    rows, changed, fresh = session.check_static(Part(tell, PLACED, 0.95))
    tell(0.95, 1.0, "words of place at frame 0")
    failing = [r for r in rows if r.status == "fail"]
    return {
        **head,
        "built": fresh if len(fresh) <= 20 else [*fresh[:20], f"and {len(fresh) - 20} more"],
        "built_total": len(fresh),
        "static_passed": all(r.status in ("pass", "not_applicable") for r in rows if r.mandatory and r.check != "shots"),
        "changed_rows": len(changed),
        **summary(rows, static=True),
        "restless": any(r.question in RESTLESS for r in failing) and session.spec.simulation.settle is None,
        "audit_passed": session.audit().passed,
        "warnings": [*outcome.get("warnings", ()), *weaker_told(outcome), *unmet_at_start(session)],
    }
