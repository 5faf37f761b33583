"""Tool probe_sim: run a probe of the production settings and check it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

from pydantic import Field

from ..worlds.errors import RefusedError
from ..worlds.requirements import Row
from .context import ToolContext, ToolReply

if TYPE_CHECKING:
    from ..execution import Job

__all__ = ["motion_reply", "picture_reply", "probe_sim"]


def probe_sim(
    context: ToolContext,
    world: Annotated[str, Field(description="World id")],
    wait_s: Annotated[
        float, Field(ge=0, le=240, description="Seconds to wait for the result before a job id is returned")
    ] = 30.0,
) -> ToolReply:
    """Simulate to 0.75 s after the last beat with production settings, check the motion, and freeze the settings if it passes.

    Covers preroll, activation, first contact, peak response and early settling (a world that is meant to rest has none of them).
    What can only be judged later waits for the bake. Returns the failing rows with measured
    values, first failing entity and frame, ranked causes and suggested edits, plus a contact sheet. Refused while the
    audit or a static row fails. After a failure: one edit_spec with a hypothesis and one parameter group, then probe again.
    Next: bake_sim when it passes; render_shot(kind='contact_sheet', stage='probe') to see it.
    """
    from ..simulation.freeze import freeze_hash
    from .measurements import is_whole
    from .session import Session
    from .waiting import start_and_wait

    session = Session.open(context.workspace, world)
    session.require_audit("probe_sim")
    rows, _, _ = session.check_static()
    open_rows = [r for r in rows if r.mandatory and r.status in ("fail", "unverified") and r.check != "shots"]
    if open_rows:
        raise RefusedError(
            "probe_sim needs passing static rows; mend these with edit_spec or place_object first:\n"
            + "\n".join(_line(r) for r in open_rows[:8])
        )
    from ..construction import build_world

    built, _ = build_world(session.folder, session.spec)
    freeze = freeze_hash(session.spec, built)
    whole = session.ledger.freeze(freeze) is not None and is_whole(session, freeze, "probe")
    key = f"probe:{freeze}:{session.revision}"
    data = start_and_wait(context, session, "probe", {}, wait_s=wait_s, key=key, reuse=whole)
    return picture_reply(world, data)


def _line(row: Row) -> str:
    action = row.corrections[0].action if row.corrections else ""
    return f"  {row.id}: measured {row.measured} {row.unit}, needs {row.comparison} {row.bound}. {action}"


def picture_reply(world: str, data: dict[str, Any]) -> ToolReply:
    """A result with a link to the contact sheet it made."""
    name = data.get("picture")
    links = ((str(name), f"worldagent://worlds/{world}/pictures/{name}", "image/jpeg"),) if isinstance(name, str) else ()
    return ToolReply(data, links=links)


def motion_reply(job: Job) -> ToolReply:
    """Reply for a probe or a bake that has ended."""
    from .waiting import ended_data

    return picture_reply(str(job.world), ended_data(job))
