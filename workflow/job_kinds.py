"""Kinds of the tools' jobs: how urgent, how long at most, and the call that does their work again."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, NamedTuple

from ..execution import BULK, INTERACTIVE, NORMAL, Job
from .answers import call
from .arrangements import Thing

__all__ = ["ENTRIES", "KINDS", "Again", "JobKind", "again"]

ENTRIES = "worldagent.workflow.jobs"
"""The module of the functions that do the work."""
HOUR_S = 3600.0


@dataclass(frozen=True)
class JobKind:
    """One kind of job."""

    priority: int
    wall_s: float
    """Longest running time where the environment names no other [s]. Own choice: several times what the caps of a
    specification allow on a slow machine, so that only work that hangs meets it."""
    tool: str
    """The tool that starts it."""
    arguments: tuple[str, ...] = ()
    """Arguments of that tool which the job's payload holds."""
    fixed: dict[str, str] = field(default_factory=dict)
    """Arguments of that tool which are the same for all jobs of the kind."""
    alone: bool = True
    """True if it is one after another with the others of its world; one that only looks, or that a caller does between two looks, is not."""
    keeps: str = ""
    """Sentence on the way the same call goes on with the work of a job that was interrupted."""


KINDS: dict[str, JobKind] = {
    "check": JobKind(INTERACTIVE, 6 * HOUR_S, "run_checks", ("scope", "only")),
    "terrain": JobKind(
        NORMAL,
        6 * HOUR_S,
        "build_terrain",
        ("terrain", "entity", "size", "center", "cells", "material", "hypothesis"),
        keeps="keeps a landscape that is built",
    ),
    "interior": JobKind(NORMAL, HOUR_S, "build_interior", ("interior", "hypothesis")),
    "probe": JobKind(
        NORMAL, 6 * HOUR_S, "probe_sim", ("coarser", "stop_at"), keeps="goes on from the last checkpoint of the probe"
    ),
    "sketch": JobKind(INTERACTIVE, HOUR_S, "probe_sim", ("sketch",)),
    "accept": JobKind(NORMAL, 12 * HOUR_S, "run_checks", fixed={"scope": "acceptance"}),
    "review": JobKind(NORMAL, HOUR_S, "run_checks", fixed={"scope": "review"}, keeps="keeps answers that are recorded"),
    "bake": JobKind(BULK, 48 * HOUR_S, "bake_sim", keeps="goes on from the last checkpoint of the bake"),
    "placing": JobKind(INTERACTIVE, HOUR_S, "place_object", ("hypothesis", "weakening_reason"), alone=False),
    "picture": JobKind(INTERACTIVE, HOUR_S, "render_shot", alone=False),
    "final": JobKind(
        BULK,
        96 * HOUR_S,
        "render_shot",
        ("width", "height", "samples"),
        {"kind": "final"},
        keeps="keeps the frames that are rendered",
    ),
}
"""All kinds by name."""


class Again(NamedTuple):
    """Next call after a job that was cancelled or lost, and what it keeps of the work."""

    call: str
    """The exact call; empty where there is none: repeating what failed would fail again."""
    keeps: str


def again(job: Job) -> Again:
    """The next call after a job that came to no result."""
    kind = KINDS.get(job.kind)
    if kind is None or job.world is None or job.state not in ("cancelled", "lost"):
        return Again("", "")
    given = {name: job.payload.get(name) or None for name in kind.arguments} | _asked(job)
    return Again(call(kind.tool, world=job.world, **kind.fixed, **given), kind.keeps)


def _asked(job: Job) -> dict[str, Any]:
    """Arguments that a job keeps together, without those that are not given."""
    if job.kind == "placing":
        things = job.payload.get("things") or []
        if not job.payload.get("many"):
            return dict(things[0]) if things else {}
        return {"things": [{k: v for k, v in t.items() if k in Thing.model_fields and v is not False} for t in things]}
    asked = job.payload.get("asked")
    if job.kind != "picture" or not isinstance(asked, dict):
        return {}
    width, height = asked.get("size") or (None, None)
    return {**{k: v for k, v in asked.items() if k != "size"}, "width": width, "height": height}
