"""Tool build_interior: rooms with walls, doors, windows, furniture and what lies on it, on storeys and on uneven ground."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

from pydantic import Field

from ..workflow.arguments import Hypothesis, WorldId
from ..workflow.context import ToolContext, ToolReply
from ..worlds.errors import InputError
from ..worlds.vocabulary import Id

if TYPE_CHECKING:
    from ..execution import Job
    from ..workflow.session import Session
    from ..worlds.spec import Interior

__all__ = ["build_interior", "interior_reply"]


def build_interior(
    context: ToolContext,
    world: WorldId,
    interior: Annotated[Id, Field(description="Its id, e.g. 'flat'; ids of all that it makes begin with it")],
    plan: Annotated[
        dict[str, Any] | None,
        Field(
            description="{rooms: {id: {kind, area, doors: [room ids, 'outside']}}, seed, ...}: inspect_world(part='schema', pointer='Interior'). "
            "Omit to build the one under /interiors again"
        ),
    ] = None,
    hypothesis: Hypothesis = "",
    wait_s: Annotated[
        float, Field(ge=0, le=240, description="Seconds to wait (50 at most, unless the server allows more), then a job id")
    ] = 30.0,
) -> ToolReply:
    """Make a building of rooms with floors, walls, doors, windows, furniture by function and what lies on it, as one revision, and check it.

    Corridors with steps, L-shaped rooms (shape), storeys joined by stairs, also straight in an open well with railings, barn or museum hall, a roof,
    uneven ground (`on`: plinth, steps, floor at the entrance).
    Makes ordinary entities <interior>_<room>_<thing>, a region <interior>_<room>, a route through every door; tells what found no place and why.
    `still: true` makes all of it static but what `moves` names (ids, kinds, rooms).
    Repeating it replaces what it made. Not for: single things (place_object with asset). Next: place_object for what the prompt asks beyond that.
    """
    from ..workflow.session import Session
    from ..workflow.waiting import start_and_wait
    from ..worlds.canonical import digest_of

    session = Session.open(context.workspace, world)
    asked = _asked(session, interior, plan)
    payload = {"interior": interior, "asked": asked.model_dump(mode="json"), "hypothesis": hypothesis}
    key = f"interior:{digest_of(payload)}:{session.revision}"
    return _told(world, interior, start_and_wait(context, session, "interior", payload, wait_s=wait_s, key=key, reuse=False))


def _asked(session: Session, interior: str, plan: dict[str, Any] | None) -> Interior:
    from pydantic import ValidationError

    from ..worlds.spec import Interior

    known = session.spec.interiors
    if plan is None:
        if interior not in known:
            raise InputError(f"there is no interior {interior!r}; the world has {sorted(known)}: give plan to make one")
        return known[interior]
    try:
        return Interior.model_validate({k: v for k, v in plan.items() if k != "entities"})
    except ValidationError as error:
        lines = [
            f"plan/{'/'.join(str(p) for p in e['loc'])}: {e['msg']} (got {str(e.get('input'))[:60]})" for e in error.errors()[:8]
        ]
        raise InputError("\n".join([*lines, "fields: inspect_world(part='schema', pointer='Interior')"])) from error


def interior_reply(job: Job) -> ToolReply:
    """Reply for an interior whose job has ended."""
    from ..workflow.waiting import ended_data

    return _told(str(job.world), job.payload["interior"], ended_data(job))


def _told(world: str, interior: str, data: dict[str, Any]) -> ToolReply:
    from ..workflow.answers import call, job_answer, rows_answer

    if "state" in data:
        return ToolReply(job_answer(data))
    things = sum(r["things"] for r in data["rooms"].values())
    text = f"interior {interior!r}: {len(data['rooms'])} rooms on {data['plan'][0]:g} x {data['plan'][1]:g} m, {things} things"
    left = data.get("not_placed_total", 0)
    text += f", {left} found no place" if left else ""
    if "audit" in data:
        audit = data.pop("audit")
        told = rows_answer(
            world, audit, "concise", f"{text}; the audit leaves rows open", "edit_spec: mend the audit's open rows"
        )
        head = {k: told.pop(k) for k in ("summary", "warnings", "next")}
        return ToolReply({**head, **data, "audit": told})
    then = (
        call("render_shot", world=world, kind="plan")
        if not data.pop("static_open")
        else "place_object or edit_spec: mend the first open row"
    )
    return ToolReply(rows_answer(world, data, "concise", text, then))
