"""Tool probe_sim: run a probe of the production settings and check it."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import Field

from ..workflow.arguments import RowDetail, Sketch, WaitSeconds, WorldId
from ..workflow.context import ToolContext, ToolReply
from ..workflow.motion_replies import motion_answer, require_room, sketch_answer
from ..worlds.errors import RefusedError
from ..worlds.requirements import Row
from ..worlds.verdicts import asked_words

if TYPE_CHECKING:
    from ..workflow.session import Session

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
    stop_at: Annotated[
        Literal["first_failure", "never"],
        Field(
            description="first_failure ends a run of which more than 10 s are left when a row fails for good; never shows all rows"
        ),
    ] = "first_failure",
    sketch: Annotated[
        Sketch | None,
        Field(
            description="instead of a probe: some frames, coarse and quick; judged, freezes nothing, counts as the test of an edit"
        ),
    ] = None,
) -> ToolReply:
    """Simulate to 0.75 s after the last beat with production settings, judge the motion, and freeze the settings if it passes.

    Use it when the static rows pass, and again after every repair. It covers preroll, activation, first contact, peak response
    and early settling (a world that is meant to rest has none of them). Liquids and grains run at their production resolution, or coarser as
    asked: then the bake must show the same beats in the same order and within 15 % of the times that the probe promised.
    sketch={'until': beat or frame} tries a part in seconds, coarse, without a verdict. Frames of a motion that are
    looked at (render_shot, inspect_world) before any verdict count as evidence: the next edit of scene or solver names its hypothesis. Rows are judged while it runs; a stopped, cancelled or failed run keeps its frames, which can be seen and judged, and goes on when called again.
    Refused while the audit or a static row fails; when a liquid's spacing does not resolve a wall, a passage or a source, with its name.
    Returns: passed, phases (frames), open rows with measured value, bound, first failing entity and frame, ranked causes and
    suggested patches, and a link to a contact sheet; or a job_id when it takes longer than wait_s.
    Not for: looking only (render_shot), nor for judging changed beats or shots on unchanged motion (run_checks(scope='probe')).
    Next: bake_sim when passed; else one edit_spec with a hypothesis and one parameter group, then probe again.
    """
    from ..workflow.session import Session

    session = Session.open(context.workspace, world)
    warnings = context.heard.news(world, session.require_audit("probe_sim").told)
    if sketch is not None:
        return _sketch(context, session, sketch, wait_s, detail)
    _require_static(session)
    payload = {"detail": detail, **({"stop_at": stop_at} if stop_at == "never" else {})}
    data = _probe(context, session, payload, wait_s, coarser)
    return motion_answer(world, "probe", {**data, "warnings": [*data.get("warnings", ()), *warnings]}, detail)


def _probe(context: ToolContext, session: Session, payload: dict[str, Any], wait_s: float, coarser: float) -> dict[str, Any]:
    """Result or state of the job; errors as the tool."""
    from ..workflow.estimates import pace_seen, usual_seconds
    from ..workflow.measurements import is_whole
    from ..workflow.waiting import start_and_wait
    from ..worlds.coarsening import coarsened, overrides_for
    from ..worlds.probe_length import probe_frames

    freeze = session.freeze()
    overrides = overrides_for(session.spec, coarser)
    known = session.ledger.freeze(freeze)
    told = {} if known is None else known["detail"]
    ended = known is not None and "stopped" not in told and told.get("overrides", {}) == overrides
    whole = ended and is_whole(session, freeze, "probe")
    if not whole:
        require_room(context.workspace, session.spec)
    through = ":whole" if "stop_at" in payload else ""
    key = f"probe:{freeze}:{session.revision}{f':{coarser:g}' if overrides else ''}{through}"
    usual = usual_seconds(coarsened(session.spec, overrides), probe_frames(session.spec))
    payload |= {"usual_s": usual.whole} | ({"coarser": coarser} if overrides else {})
    data = start_and_wait(context, session, "probe", payload, wait_s=wait_s, key=key, reuse=whole)
    if "state" in data:
        usual = usual.at(pace_seen(context.jobs, session.folder))
        data["estimate_s"], data["estimate_of"] = usual.whole, usual.told
    return data


def _sketch(context: ToolContext, session: Session, asked: Sketch, wait_s: float, detail: RowDetail) -> ToolReply:
    """A sketch in place of a probe; errors as the tool."""
    from ..workflow.sketches import end_of
    from ..workflow.waiting import start_and_wait

    end_of(session.spec, asked)
    require_room(context.workspace, session.spec)
    given = asked.model_dump(mode="json", exclude_none=True)
    key = f"sketch:{session.freeze()}:{session.revision}:{json.dumps(given, sort_keys=True)}"
    data = start_and_wait(context, session, "sketch", {"detail": detail, "sketch": given}, wait_s=wait_s, key=key, reuse=False)
    return sketch_answer(session.folder.id, data, detail)


def _require_static(session: Session) -> None:
    """Check the geometry; errors as the tool."""
    rows, _, _ = session.check_static()
    open_rows = [r for r in rows if r.mandatory and r.status in ("fail", "unverified") and r.check != "shots"]
    if open_rows:
        raise RefusedError(
            "probe_sim needs passing static rows; mend these with edit_spec or place_object first:\n"
            + "\n".join(_line(r) for r in open_rows[:8])
        )


def _line(row: Row) -> str:
    action = row.corrections[0].action if row.corrections else ""
    asked = "" if row.bound is None else f", needs {asked_words(row.comparison, row.bound, row.unit)}"
    return f"  {row.id}: measured {row.measured} {row.unit}{asked}. {action}"
