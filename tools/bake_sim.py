"""Tool bake_sim: simulate the full sequence of a frozen candidate."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from ..workflow.context import ToolContext, ToolReply
from ..workflow.rows import Detail
from ..worlds.errors import RefusedError

__all__ = ["bake_sim"]


def bake_sim(
    context: ToolContext,
    world: Annotated[str, Field(description="World id")],
    wait_s: Annotated[
        float,
        Field(
            ge=0, le=240, description="Seconds to wait for the result (50 at most, unless the server allows more), then a job id"
        ),
    ] = 30.0,
    detail: Annotated[Detail, Field(description="full: open rows with all evidence and causes")] = "concise",
) -> ToolReply:
    """Simulate every frame of the frozen candidate, in the declared solver order, coupled instances together, and check all of it.

    Use it after a passing probe of exactly these settings; it is refused without one. An interrupted bake is resumed, a
    complete one is given back. Takes about as long for each frame as the probe did; the reply estimates it.
    Returns: frames, rows that do not pass, a link to a contact sheet; or a job_id when it takes longer than wait_s.
    Not for: trying settings (probe_sim is shorter). Next: run_checks(scope='acceptance').
    """
    from ..construction import build_world
    from ..simulation.freeze import freeze_hash
    from ..workflow.estimates import bake_estimate
    from ..workflow.measurements import is_whole
    from ..workflow.session import Session
    from ..workflow.waiting import start_and_wait
    from ..worlds.limits import check_workspace, estimate_counts
    from .probe_sim import told

    session = Session.open(context.workspace, world)
    session.require_audit("bake_sim")
    built, _ = build_world(session.folder, session.spec)
    freeze = freeze_hash(session.spec, built)
    record = session.ledger.freeze(freeze)
    if record is None or not record["passed"]:
        left = "" if record is None else f" (the last probe left {record['detail']['failing'][:6]} open)"
        raise RefusedError(f"bake_sim needs a passing probe of exactly these settings{left}; call probe_sim first")
    whole = session.ledger.bake(freeze) is not None and is_whole(session, freeze, "full")
    if not whole:
        check_workspace(context.workspace, estimate_counts(session.spec)["cache_bytes"])
    key = f"bake:{freeze}:{session.revision}"
    data = start_and_wait(context, session, "bake", {"detail": detail}, wait_s=wait_s, key=key, reuse=whole)
    if "state" in data:
        data["estimate_s"] = bake_estimate(session, record)
    return told(world, "bake", data, detail)
