"""Tool inspect_world: data of a world, paged."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field

from ..worlds.errors import InputError
from .context import ToolContext, ToolReply
from .links import proof_links

__all__ = ["inspect_world"]

Part = Literal[
    "overview", "spec", "matrix", "row", "revisions", "iterations", "state", "events", "records", "acceptance", "worlds"
]


def inspect_world(
    context: ToolContext,
    world: Annotated[str | None, Field(description="World id; not needed for part='worlds'")] = None,
    part: Annotated[
        Part,
        Field(
            description="overview: where the world stands; spec: a part of world.json; matrix: requirement rows; row: one row in full with "
            "its history; state: poses and speeds at one frame; events: contact begins; records: energy, momentum, ... over time; "
            "acceptance: the last verdict with its approximation register, links to its report page and bundle"
        ),
    ] = "overview",
    pointer: Annotated[str, Field(description="For spec: JSON pointer, e.g. /entities/ball")] = "",
    row: Annotated[str | None, Field(description="For row: its id")] = None,
    status: Annotated[
        Literal["fail", "unverified", "pass", "not_applicable"] | None, Field(description="For matrix: only these")
    ] = None,
    entities: Annotated[list[str] | None, Field(description="For state and events: only these entities")] = None,
    frames: Annotated[tuple[int, int] | None, Field(description="For state, events and records: [first, last]")] = None,
    limit: Annotated[int, Field(ge=1, le=200, description="Most items to return")] = 40,
    offset: Annotated[int, Field(ge=0, description="Items to skip")] = 0,
) -> ToolReply:
    """Read data of a world: specification, requirement rows, measured state, events, records, history. Changes nothing.

    Poses are [x, y, z] in m and quaternions (w, x, y, z); speeds in m/s. state, events and records read the bake if there
    is one of the present settings, else the probe. Pictures: render_shot.
    """
    from ..worlds.folder import world_ids
    from .session import Session, brief, counts

    if part == "worlds":
        return ToolReply({"worlds": world_ids(context.workspace)})
    if world is None:
        raise InputError(f"part {part!r} needs world; known worlds: {world_ids(context.workspace)[:20]}")
    session = Session.open(context.workspace, world)
    ledger = session.ledger
    data: dict[str, Any]
    if part == "overview":
        rows = ledger.rows()
        latest = ledger.acceptance()
        data = {
            "title": session.spec.title,
            "prompt": session.spec.prompt,
            "frames": session.spec.simulation.frames,
            "fps": session.spec.simulation.fps,
            "entities": len(session.spec.entities),
            "beats": {k: {"text": b.text, "frames": list(b.frames)} for k, b in session.spec.story.beats.items()},
            "matrix": counts(rows),
            "open_rows": [r.id for r in rows if r.mandatory and r.status in ("fail", "unverified")][:limit],
            "last_verdict": None if latest is None else {"verdict": latest["verdict"], "revision": latest["revision"]},
            "jobs_running": [j.id for j in context.jobs.list(world, "running")],
        }
    elif part == "spec":
        data = {"pointer": pointer, "value": _resolve(session.spec.model_dump(mode="json", exclude_none=True), pointer)}
    elif part == "matrix":
        chosen = [r for r in ledger.rows() if status is None or r.status == status]
        data = {
            "counts": counts(chosen),
            "rows": [brief(r, corrections=1) for r in chosen[offset : offset + limit]],
            **_page(len(chosen), offset, limit),
        }
    elif part == "row":
        found = next((r for r in ledger.rows() if r.id == row), None)
        if found is None:
            raise InputError(f"there is no row {row!r}; inspect_world(part='matrix') lists them")
        data = {"row": found.model_dump(mode="json"), "history": ledger.history(found.id)}
    elif part == "revisions":
        data = {"revisions": ledger.revisions(limit, offset), **_page(session.revision, offset, limit)}
    elif part == "iterations":
        data = {"iterations": ledger.iterations(limit)}
    elif part == "acceptance":
        latest = ledger.acceptance()
        keys = ("verdict", "clauses", "approximations", "weakenings", "versions", "spec_digest", "cache_digest", "seed")
        data = {
            "acceptance": None
            if latest is None
            else {k: latest["record"].get(k) for k in keys} | {"revision": latest["revision"]}
        }
        if latest is not None:
            kinds = {"report": "html", **({"bundle": "zip"} if latest["verdict"] == "accepted" else {})}
            files = {name: session.folder.acceptance / f"{latest['freeze'][:16]}.{kind}" for name, kind in kinds.items()}
            data |= {name: session.folder.relative(path) for name, path in files.items() if path.is_file()}
    else:
        from .measurements import measured

        data = measured(session, part, entities=entities, frames=frames, limit=limit, offset=offset)
    links = proof_links(world, data) if part == "acceptance" else ()
    return ToolReply({"world": world, "revision": session.revision, "part": part, **data}, links=links)


def _page(total: int, offset: int, limit: int) -> dict[str, Any]:
    left = total - offset - limit
    return {"total": total, **({"more": f"{left} further: offset={offset + limit}"} if left > 0 else {})}


def _resolve(document: Any, pointer: str) -> Any:
    at = document
    for token in [t for t in pointer.split("/") if t]:
        key = token.replace("~1", "/").replace("~0", "~")
        if isinstance(at, dict) and key in at:
            at = at[key]
        elif isinstance(at, list) and key.isdigit() and int(key) < len(at):
            at = at[int(key)]
        else:
            known = list(at)[:20] if isinstance(at, dict) else f"0..{len(at) - 1}" if isinstance(at, list) else "nothing below it"
            raise InputError(f"pointer {pointer!r} leads nowhere at {token!r}; there is {known}")
    return at
