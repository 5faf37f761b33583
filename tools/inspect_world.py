"""Tool inspect_world: data of a world, paged."""

from __future__ import annotations

import sqlite3
from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import Field

from ..workflow.context import ToolContext, ToolReply
from ..workflow.links import proof_links
from ..workflow.rows import Detail
from ..worlds.errors import InputError, WorldAgentError
from ..worlds.storage import storage_failure

if TYPE_CHECKING:
    from ..workflow.session import Session

__all__ = ["inspect_world"]

Part = Literal[
    "overview",
    "schema",
    "guide",
    "materials",
    "assets",
    "spec",
    "matrix",
    "row",
    "revisions",
    "iterations",
    "state",
    "events",
    "records",
    "wet",
    "account",
    "claims",
    "acceptance",
    "terrain",
    "worlds",
]


def inspect_world(
    context: ToolContext,
    world: Annotated[
        str | None, Field(description="World id; not needed for worlds, schema, guide, materials and assets")
    ] = None,
    part: Annotated[
        Part,
        Field(
            description="overview: where the world stands, what comes next; schema: what a specification can say, part by part; "
            "guide: what the skills say of a prompt, or they themselves, file by file; materials: rows of the table of materials; assets: generators of things; spec: what world.json says at a pointer; matrix: requirement rows, open ones first; "
            "row: one row in full with its history; revisions, iterations: edits, and what repairs did; "
            "state: poses, speeds, spins and contact forces at a frame or over frames; of grains and liquids count, speed, centre and front, per region; of cloth the stretch by place; events: contact begins; records: energy, momentum, ... over time; "
            "wet: what liquids wetted up to a frame, when and how deep; "
            "account: what happens, as somebody is told who did not make the world; "
            "claims: the prompt with what each span means and its row; "
            "acceptance: the last verdict, its approximation register, its report and bundle; terrain: a built landscape in numbers, "
            "values at points, places to build on; worlds: all ids"
        ),
    ] = "overview",
    pointer: Annotated[
        str,
        Field(
            description="spec: JSON pointer, e.g. /entities/ball. schema: types (Entity, Shape, Predicate, ...; several with commas), a pointer, or 'example' "
            "for a whole small world; empty for the index. guide: a file, e.g. world-building/SKILL.md; empty for the list"
        ),
    ] = "",
    prompt: Annotated[
        str | None,
        Field(
            description="For guide: a prompt; returns its words marked, kinds of event, and the sections of skills and the example "
            "that fit it, in 15,000 characters"
        ),
    ] = None,
    query: Annotated[
        str,
        Field(
            description="For materials: names, or a group (wood, metal, fabric, ...); for assets: what is wanted (oak chair); empty for all names"
        ),
    ] = "",
    row: Annotated[str | None, Field(description="For row: its id")] = None,
    status: Annotated[
        Literal["open", "fail", "unverified", "pass", "not_applicable"] | None,
        Field(description="For matrix: only these; open means fail or unverified"),
    ] = None,
    entities: Annotated[
        list[str] | None,
        Field(
            description="For state, events and wet: only these entities; for state also one body of a rope or breakable entity, 'wall/piece_003'"
        ),
    ] = None,
    frames: Annotated[tuple[int, int] | None, Field(description="For state, events, records and wet: [first, last]")] = None,
    terrain: Annotated[str | None, Field(description="For terrain: id under /terrains; default the only one")] = None,
    points: Annotated[
        list[tuple[float, float]] | None,
        Field(
            min_length=1, max_length=40, description="For terrain: x, y [m] to tell the land at; with find, one to search from"
        ),
    ] = None,
    profile: Annotated[
        int | None, Field(ge=2, le=200, description="For terrain: so many places along the line through the points instead")
    ] = None,
    find: Annotated[
        Literal["flat", "shore", "sea", "lake", "river"] | None,
        Field(
            description="For terrain: nearest dry flat squares of size, places beside the sea or a lake (shore: either), or in rivers"
        ),
    ] = None,
    size: Annotated[
        float, Field(gt=0, le=5000, description="For find: side of a flat square, or distance between other places [m]")
    ] = 20.0,
    detail: Annotated[Detail, Field(description="full: rows with all evidence, edits with their patches")] = "concise",
    limit: Annotated[int, Field(ge=1, le=200, description="Most items to return")] = 40,
    offset: Annotated[int, Field(ge=0, description="Items to skip: the next_offset of the last reply")] = 0,
) -> ToolReply:
    """Read data: what a world specifies, its requirement rows, measured motion, history, and the schema and guides. Changes nothing.

    Use it to decide by numbers: which rows fail and why, where a body is and how fast, what touched what and when. Poses are
    [x, y, z] in m and quaternions (w, x, y, z); speeds in m/s, impulses in N s. state, events, records and wet read the bake of the
    present settings if there is one, else the probe or sketch, else (state only) frame 0. Lists are paged: a reply says total and
    next_offset. Not for pictures (render_shot), nor for judging anew (run_checks). `next` names the call that usually follows.
    """
    from ..workflow import parts, schema_parts

    if part == "worlds":
        return ToolReply(parts.worlds(context.workspace, offset=offset, limit=limit))
    if part == "schema":
        return ToolReply(schema_parts.schema(pointer))
    if part == "guide":
        if prompt is not None:
            from ..workflow.prompt_guide import prompt_guide

            return ToolReply(prompt_guide(prompt))
        return ToolReply(parts.guide(pointer, offset=offset))
    if part == "materials":
        from ..workflow.material_rows import materials

        return ToolReply(materials(query, offset=offset, limit=limit))
    if part == "assets":
        from ..workflow.asset_rows import assets

        return ToolReply(assets(query, offset=offset, limit=limit))
    if world is None:
        from ..worlds.folder import world_ids, worlds_told

        raise InputError(f"part {part!r} needs world; {worlds_told(world_ids(context.workspace))}")
    from ..workflow.measurements import measured
    from ..workflow.session import Session
    from ..workflow.surveys import terrain as survey

    session = Session.open(context.workspace, world)
    readers: dict[str, Callable[..., dict[str, Any]]] = {
        "overview": partial(_overview, context, session),
        "spec": partial(parts.spec, session, pointer),
        "matrix": partial(parts.matrix, session, status, detail),
        "row": partial(parts.one_row, session, row),
        "revisions": partial(parts.revisions, session, detail),
        "iterations": partial(parts.iterations, session, detail),
        "claims": partial(parts.claims, session),
        "acceptance": partial(parts.acceptance, session),
        "terrain": partial(survey, session, terrain, points=points, profile=profile, find=find, size=size),
    }
    reader = readers.get(part) or partial(measured, session, part, entities=entities, frames=frames)
    data = reader(offset=offset, limit=limit)
    links = proof_links(world, data) if part == "acceptance" else ()
    head = {k: data.pop(k) for k in ("summary", "warnings", "next")}
    return ToolReply({**head, "world": world, "revision": session.revision, "part": part, **data}, links=links)


def _overview(context: ToolContext, session: Session, *, offset: int, limit: int) -> dict[str, Any]:
    from ..workflow import parts

    jobs, unknown = _running(context, session.folder.id)
    data = parts.overview(session, jobs=jobs, offset=offset, limit=limit)
    return {**data, "warnings": [*data["warnings"], *unknown]}


def _running(context: ToolContext, world: str) -> tuple[list[str], list[str]]:
    """Jobs of the world that run; and where their list cannot be opened, why: the world can be read all the same."""
    try:
        return [j.id for j in context.jobs.list(world, "running")], []
    except (WorldAgentError, OSError, sqlite3.Error) as error:
        return [], [f"running jobs are unknown: {storage_failure(error) or error}"]
