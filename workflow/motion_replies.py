"""Replies of the tools probe_sim and bake_sim, which simulate: the verdict over a motion, and the room that its frames need."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .answers import call, job_answer, rows_answer
from .context import ToolReply
from .rows import Detail

if TYPE_CHECKING:
    from ..execution import Job
    from ..worlds.spec import WorldSpec

__all__ = ["mend_first", "motion_answer", "motion_reply", "require_room", "sketch_answer", "sketch_reply"]


def require_room(workspace: Path, spec: WorldSpec) -> None:
    """Check that the workspace has room for the frames of one run.

    Raises:
        LimitError: it has not.
    """
    from ..worlds.limits import check_workspace, estimate_counts

    check_workspace(workspace, estimate_counts(spec)["cache_bytes"])


def mend_first(world: str, data: Mapping[str, Any], then: str) -> str:
    """Next step where rows are open: a repair of the motion, or of shots alone, which needs no hypothesis and no other run."""
    checks = {row.get("check") for row in data.get("open_rows", ())}
    if checks == {"shots"} and not data.get("more_open_rows"):
        return f"edit_spec: mend the shots; an edit of shots alone needs no hypothesis and no other run; then {call('run_checks', world=world, scope='full')}"
    return f"edit_spec: mend the first open row with one hypothesis and one parameter group, then {then}"


def motion_answer(world: str, kind: str, data: dict[str, Any], detail: Detail) -> ToolReply:
    """Reply of a probe or a bake: its state while it runs, else its verdict with a link to its contact sheet."""
    if "state" in data:
        return ToolReply(job_answer(data))
    open_count = data["counts"]["mandatory_open"]
    if kind == "probe":
        taken = f" ({'; '.join(data['taken'])})" if data.get("taken") else ""
        frames = f"{data['frames_probed']} frames probed{taken}"
        passed = f"{frames}, all that can be judged yet passes; settings frozen as {data['freeze']}"
        then = call("bake_sim", world=world)
    else:
        frames = f"{data['frames']} frames baked"
        passed = f"{frames}, {data['counts']['pass']} rows pass"
        then = call("run_checks", world=world, scope="acceptance")
    if "stopped_at" in data:
        by = f" by {', '.join(data['stopped_by'])}" if data["stopped_by"] else ""
        frames = f"ended at frame {data['stopped_at']} of {data['of_frames']}{by}; rows of later frames are not reached"
    failed = f"{frames}; {data['counts']['fail']} rows fail, {open_count} mandatory ones are open"
    repair = mend_first(world, data, "probe_sim again")
    if "stopped_at" in data:
        rest = call("probe_sim", world=world, stop_at="never")
        repair = f"{repair}; or its other rows first: {rest}" if data["counts"]["fail"] else rest
    said = rows_answer(world, data, detail, passed if data["passed"] else failed, then if data["passed"] else repair)
    name = data.get("picture")
    links = ((str(name), f"worldagent://worlds/{world}/pictures/{name}", "image/jpeg"),) if isinstance(name, str) else ()
    return ToolReply(said, links=links)


def motion_reply(job: Job) -> ToolReply:
    """Reply for a probe or a bake that has ended."""
    from .waiting import ended_data

    return motion_answer(str(job.world), job.kind, ended_data(job), job.payload.get("detail", "concise"))


def sketch_answer(world: str, data: dict[str, Any], detail: Detail) -> ToolReply:
    """Reply of a sketch: its state while it runs, else what it shows."""
    if "state" in data:
        return ToolReply(job_answer(data))
    coarse = "coarser than production" if data["left_coarser"] else "at production settings"
    failing = data["counts"]["fail"]
    text = f"sketch of {data['frames_sketched']} frames, {coarse}: {failing} rows fail; it freezes nothing and no row of the matrix is from it"
    repair = mend_first(world, data, "sketch or probe again")
    said = rows_answer(world, data, detail, text, repair if failing else call("probe_sim", world=world))
    name = str(data["picture"])
    return ToolReply(
        said, links=((name, f"worldagent://worlds/{world}/pictures/{name}", "image/jpeg"),) if data["picture"] else ()
    )


def sketch_reply(job: Job) -> ToolReply:
    """Reply for a sketch that has ended."""
    from .waiting import ended_data

    return sketch_answer(str(job.world), ended_data(job), job.payload.get("detail", "concise"))
