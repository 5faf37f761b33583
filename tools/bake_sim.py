"""Tool bake_sim: simulate the full sequence of a frozen candidate."""

from __future__ import annotations

from ..workflow.arguments import RowDetail, WaitSeconds, WorldId
from ..workflow.context import ToolContext, ToolReply

__all__ = ["bake_sim"]


def bake_sim(
    context: ToolContext,
    world: WorldId,
    wait_s: WaitSeconds = 30.0,
    detail: RowDetail = "concise",
) -> ToolReply:
    """Simulate the whole sequence of the frozen candidate, in the declared solver order, coupled instances together, and check all of it.

    Use it after a passing probe of exactly these settings; it is refused without one. Frames that this probe simulated, nothing
    coarser, are taken from it. An interrupted bake is resumed, a complete one is given back; the reply estimates the time.
    Returns: frames, rows that do not pass, a link to a contact sheet; or a job_id when it takes longer than wait_s.
    Not for: trying settings (probe_sim is shorter). Next: run_checks(scope='acceptance').
    """
    from ..workflow.estimates import bake_estimate
    from ..workflow.gates import require_probe
    from ..workflow.measurements import is_whole
    from ..workflow.motion_replies import motion_answer, require_room
    from ..workflow.session import Session
    from ..workflow.waiting import start_and_wait

    session = Session.open(context.workspace, world)
    session.require_audit("bake_sim")
    freeze = session.freeze()
    record = require_probe(session, freeze)
    whole = session.ledger.bake(freeze) is not None and is_whole(session, freeze, "full")
    if not whole:
        require_room(context.workspace, session.spec)
    key = f"bake:{freeze}:{session.revision}"
    data = start_and_wait(context, session, "bake", {"detail": detail}, wait_s=wait_s, key=key, reuse=whole)
    if "state" in data:
        data["estimate_s"] = bake_estimate(session, record)
    return motion_answer(world, "bake", data, detail)
