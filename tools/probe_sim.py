"""Tool probe_sim: run a probe of the production settings and check it."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from ..workflow.arguments import RowDetail, WaitSeconds, WorldId
from ..workflow.context import ToolContext, ToolReply
from ..worlds.errors import RefusedError
from ..worlds.requirements import Row
from ..worlds.verdicts import asked_words

__all__ = ["probe_sim"]


def probe_sim(
    context: ToolContext,
    world: WorldId,
    wait_s: WaitSeconds = 30.0,
    detail: RowDetail = "concise",
    coarser: Annotated[
        float,
        Field(
            ge=1,
            le=2,
            description="Spacing of liquids and radius of grains in this probe over production's; 2 costs about a sixteenth",
        ),
    ] = 1.0,
) -> ToolReply:
    """Simulate to 0.75 s after the last beat with production settings, judge the motion, and freeze the settings if it passes.

    Use it when the static rows pass, and again after every repair. It covers preroll, activation, first contact, peak response
    and early settling (a world that is meant to rest has none of them). Liquids and grains run at their production resolution, or coarser as
    asked: then the bake must show the same beats in the same order and within 15 % of the times that the probe promised.
    Refused while the audit or a static row fails; when a liquid's spacing does not resolve a wall, a passage or a source, with its name.
    Returns: passed, phases (frames), open rows with measured value, bound, first failing entity and frame, ranked causes and
    suggested patches, and a link to a contact sheet; or a job_id when it takes longer than wait_s.
    Not for: looking only (render_shot), nor for judging changed beats or shots on unchanged motion (run_checks(scope='probe')).
    Next: bake_sim when passed; else one edit_spec with a hypothesis and one parameter group, then probe again.
    """
    from ..simulation.probe import probe_frames
    from ..workflow.estimates import usual_seconds
    from ..workflow.measurements import is_whole
    from ..workflow.motion_replies import motion_answer, require_room
    from ..workflow.session import Session
    from ..workflow.waiting import start_and_wait
    from ..worlds.coarsening import coarsened, overrides_for

    session = Session.open(context.workspace, world)
    report = session.require_audit("probe_sim")
    rows, _, _ = session.check_static()
    open_rows = [r for r in rows if r.mandatory and r.status in ("fail", "unverified") and r.check != "shots"]
    if open_rows:
        raise RefusedError(
            "probe_sim needs passing static rows; mend these with edit_spec or place_object first:\n"
            + "\n".join(_line(r) for r in open_rows[:8])
        )
    freeze = session.freeze()
    overrides = overrides_for(session.spec, coarser)
    known = session.ledger.freeze(freeze)
    whole = known is not None and known["detail"].get("overrides", {}) == overrides and is_whole(session, freeze, "probe")
    if not whole:
        require_room(context.workspace, session.spec)
    key = f"probe:{freeze}:{session.revision}{f':{coarser:g}' if overrides else ''}"
    payload = {"detail": detail, **({"coarser": coarser} if overrides else {})}
    data = start_and_wait(context, session, "probe", payload, wait_s=wait_s, key=key, reuse=whole)
    if "state" in data:
        data["estimate_s"] = usual_seconds(coarsened(session.spec, overrides), probe_frames(session.spec))
        data["estimate_of"] = "moving its liquids and gases once, checks and runs without a cause apart,"
    return motion_answer(world, "probe", {**data, "warnings": [*data.get("warnings", ()), *report.told]}, detail)


def _line(row: Row) -> str:
    action = row.corrections[0].action if row.corrections else ""
    asked = "" if row.bound is None else f", needs {asked_words(row.comparison, row.bound, row.unit)}"
    return f"  {row.id}: measured {row.measured} {row.unit}{asked}. {action}"
