"""The work of `place_object`: put entities in their places, build what is missing, run the static checks; at once, or as a job."""

from __future__ import annotations

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


def asked_plain(asked: Asked | None) -> dict[str, Any] | None:
    """A place that is asked for as JSON-able data, without what is not given."""
    if asked is None:
        return None
    data = {f.name: getattr(asked, f.name) for f in fields(asked)}
    plain = {k: v.model_dump(mode="json") if k in _MODELS and v is not None else v for k, v in data.items()}
    return {k: list(v) if isinstance(v, tuple) else v for k, v in plain.items() if v is not None}


def asked_of(data: dict[str, Any] | None) -> Asked | None:
    """The place that is asked for, from its data as `asked_plain` gives it."""
    if data is None:
        return None
    models: dict[str, Any] = {k: _MODELS[k].model_validate(v) for k, v in data.items() if k in _MODELS}
    tuples = {k: tuple(data[k]) for k in _TUPLES if k in data}
    return Asked(**{**data, **models, **tuples})


def takes_long(session: Session, asked: Asked | None) -> bool:
    """True for a world that a job builds and checks."""
    many = 0 if asked is None or asked.array is None else THINGS_AT_ONCE
    return len(session.spec.entities) + many > THINGS_AT_ONCE


def placing(payload: dict[str, Any], context: JobContext) -> dict[str, Any]:
    """Put entities in their places and check the scene, as a job."""
    from ..execution import Part

    session = Session.at(WorldFolder.at(Path(payload["folder"])))
    reasons = (payload.get("hypothesis", ""), payload.get("weakening_reason", ""))
    return place_and_check(session, asked_of(payload.get("asked")), reasons, Part(context.progress))


def place_and_check(session: Session, asked: Asked | None, reasons: tuple[str, str], tell: Tell) -> dict[str, Any]:
    """Put entities in their places and run the static checks; what was done and found, for the reply.

    Args:
        session: the world.
        asked: what is put where; None builds and checks the scene as it stands.
        reasons: hypothesis and reason of a weakening, of the edit.
        tell: takes how far the work is, as parts of 1.

    Raises:
        InputError: an argument is wrong, or there is no such place.
        RefusedError: something would overlap and `strict` is set, or the rules of repair refuse the edit.
    """
    from ..execution import Part
    from .answers import weaker_told
    from .early_words import unmet_at_start
    from .placement import place
    from .rows import summary

    outcome: dict[str, Any] = {}
    if asked is not None:
        tell(0.02, 1.0, f"finding the place of {asked.entity}")
        outcome = place(session, asked, hypothesis=reasons[0], weakening_reason=reasons[1])
    head = {"world": session.folder.id, "revision": session.revision, **outcome}
    if asked is not None and asked.asset is not None and not session.buildable(session.audit()):
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
