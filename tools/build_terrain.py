"""Tool build_terrain: the ground, as a plain height field or cut from a landscape of the specification."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import Field

from ..workflow.arguments import Hypothesis, WorldId
from ..workflow.context import ToolContext, ToolReply
from ..worlds.errors import InputError
from ..worlds.vocabulary import ID_PATTERN

if TYPE_CHECKING:
    from ..execution import Job
    from ..workflow.plain_ground import PlainGround
    from ..workflow.session import Session

__all__ = ["build_terrain", "landscape_reply"]


def build_terrain(
    context: ToolContext,
    world: WorldId,
    entity: Annotated[str, Field(description="Entity id of the ground; replaced if it is a terrain already")] = "ground",
    terrain: Annotated[
        str | None,
        Field(description="Id under /terrains: build that landscape and cut the ground from it; kind, relief, ... are not used"),
    ] = None,
    kind: Annotated[Literal["flat", "slope", "hills"], Field(description="Without terrain: shape of the land")] = "flat",
    size: Annotated[
        tuple[float, float] | None,
        Field(description="Extent of the ground x, y [m], 0.5 to 2000; default 20 x 20, of a landscape up to 256 x 256"),
    ] = None,
    center: Annotated[
        tuple[float, float] | None, Field(description="With terrain: where the ground is cut out, x, y [m]")
    ] = None,
    cells: Annotated[
        int | None,
        Field(
            ge=2, le=512, description="Cells along the longer side; default 48, of a landscape 96. Checks take longer with more"
        ),
    ] = None,
    relief: Annotated[float, Field(ge=0, le=200, description="slope: rise from -x to +x [m]; hills: height range [m]")] = 0.0,
    plain_radius: Annotated[
        float, Field(ge=0, le=2000, description="hills: level circle around the origin for things to stand on [m]")
    ] = 0.0,
    seed: Annotated[int, Field(ge=0, lt=2**31, description="hills: random seed")] = 0,
    material: Annotated[
        str | None, Field(description="Material id; default: the first stone, concrete or other material")
    ] = None,
    liquid: Annotated[
        str | None,
        Field(
            description="With terrain: id of a liquid entity to make of the water in the cut, with its domain and an inflow where a river enters"
        ),
    ] = None,
    spacing: Annotated[
        float | None,
        Field(gt=0, le=100, description="With liquid: particle spacing or cell size [m]; default a quarter of a cell"),
    ] = None,
    stems: Annotated[
        bool, Field(description="With terrain: bodies bounce off the trunks and boulders that stand on the ground, at most 2,000")
    ] = False,
    hypothesis: Hypothesis = "",
    wait_s: Annotated[
        float,
        Field(
            ge=0, le=240, description="With terrain: seconds to wait (50 at most, unless the server allows more), then a job id"
        ),
    ] = 30.0,
) -> ToolReply:
    """Make the ground of an outdoor world: a static height field, as a new revision, and check it.

    With terrain: builds the landscape declared under /terrains/<id> (height layers, erosion, lakes, rivers, ground materials,
    plants), checks it, and cuts the ground that bodies stand on from it, in world coordinates. Declare it first with
    edit_spec: skill://outdoor-terrain/SKILL.md. See it with render_shot(kind='field'). Its water is a surface to look at; with liquid
    the water inside the cut is simulated: lakes and rivers start filled to their level, rivers run, come in with their bankfull discharge and leave through outflow boxes. Plants are
    drawn only; with stems those inside the cut are solid, without their crowns: give it where bodies move among them.
    Without: flat lies at z = 0; slope rises from z = 0 at -x towards +x; hills is noise that fades to z = 0 inside
    plain_radius. The ground becomes a member of the first solver instance. Lengths in m. Needs a material.
    Not for: floors, tables and other flat things, which a static box does better (edit_spec). Repeating it with the same
    entity replaces that ground. Returns: revision, heights, water, and of the open rows those that this call changed (the others by
    id in open_as_before). Works before the audit passes. Next: the reply's `next`.
    """
    from ..workflow.plain_ground import PlainGround
    from ..workflow.session import Session

    _check_names(entity, liquid, size)
    session = Session.open(context.workspace, world)
    known = session.spec.entities.get(entity)
    if known is not None and not any(p.shape.kind == "heightfield" for p in known.parts.values()):
        raise InputError(f"entity {entity!r} exists and is no terrain; choose another id")
    if terrain is not None:
        asked: dict[str, Any] = {
            "terrain": terrain,
            "entity": entity,
            "center": center,
            "size": size,
            "cells": cells or 96,
            "material": material,
        }
        asked |= {"liquid": liquid, "spacing": spacing} if liquid is not None else {}
        asked |= {"stems": True} if stems else {}
        return _landscape(context, session, {**asked, "hypothesis": hypothesis}, wait_s)
    if liquid is not None:
        raise InputError("liquid makes an entity of a landscape's water; give terrain, too")
    if stems:
        raise InputError("stems are a landscape's trunks and boulders; give terrain, too")
    if cells is not None and cells > 200:
        raise InputError(f"cells {cells} is out of range without terrain; allowed 2 to 200")
    ground = PlainGround(kind, size or (20.0, 20.0), cells or 48, relief, plain_radius, seed)
    return _plain(session, entity, ground, material, hypothesis)


def _check_names(entity: str, liquid: str | None, size: tuple[float, float] | None) -> None:
    """Refuses ids and extents that no ground can have."""
    for name, example in ((entity, "ground"), (liquid, "river")):
        if name is not None and re.match(ID_PATTERN, name) is None:
            raise InputError(f"entity id {name!r} must match {ID_PATTERN}, e.g. {example!r}")
    if size is not None and not all(0.5 <= s <= 2000 for s in size):
        raise InputError(f"size {size} m is out of range; allowed 0.5 to 2000 m along each side")


def _landscape(context: ToolContext, session: Session, payload: dict[str, Any], wait_s: float) -> ToolReply:
    from ..workflow.landscapes import ground_material
    from ..workflow.waiting import start_and_wait
    from ..worlds.canonical import digest_of

    name = payload["terrain"]
    if name not in session.spec.terrains:
        raise InputError(
            f"there is no terrain {name!r}; the world has {sorted(session.spec.terrains)}. Add /terrains/{name} with edit_spec"
        )
    ground_material(session.spec, payload["material"])
    key = f"terrain:{digest_of(payload)}:{session.revision}"
    return _landscape_told(
        session.folder.id, name, start_and_wait(context, session, "terrain", payload, wait_s=wait_s, key=key, reuse=False)
    )


def landscape_reply(job: Job) -> ToolReply:
    """Reply for a landscape whose job has ended."""
    from ..workflow.waiting import ended_data

    return _landscape_told(str(job.world), job.payload["terrain"], ended_data(job))


def _landscape_told(world: str, name: str, data: dict[str, Any]) -> ToolReply:
    from ..workflow.answers import call, job_answer, rows_answer

    if "state" in data:
        return ToolReply(job_answer(data))
    counts = data["features"]
    text = (
        f"landscape {name!r}: {data['cells'][0]} x {data['cells'][1]} cells, {counts['lakes']} lakes, {counts['rivers']} rivers, "
        f"{counts['streams']} streams, {counts['plants']} plants"
    )
    picture = data["picture"]
    links = ((picture, f"worldagent://worlds/{world}/pictures/{picture}", "image/jpeg"),)
    then = data.pop("then", None) or call("place_object", world=world)
    if "audit" in data:
        audit = data.pop("audit")
        told = rows_answer(
            world, audit, "concise", f"{text}; the audit leaves {audit['counts']['mandatory_open']} rows open", then
        )
        head = {k: told.pop(k) for k in ("summary", "warnings", "next")}
        head["warnings"] = [*head["warnings"], *data.pop("warnings", ())]
        return ToolReply({**head, **data, "audit": told}, links=links)
    return ToolReply(rows_answer(world, data, "concise", text, then), links=links)


def _plain(session: Session, entity: str, ground: PlainGround, material: str | None, hypothesis: str) -> ToolReply:
    from ..workflow.answers import answer, call, rows_answer
    from ..workflow.plain_ground import lay
    from ..workflow.rows import news, open_rows

    world = session.folder.id
    before = {row.id: row for row in session.ledger.rows()}
    data: dict[str, Any] = {"world": world, **lay(session, entity, ground, material, hypothesis)}
    report = session.audit()
    extent = f"{ground.size[0]:g} x {ground.size[1]:g} m, {data['cells'][0]} x {data['cells'][1]} cells"
    text = f"{entity}: {ground.kind} ground of {extent}"
    if not report.passed:
        audit = rows_answer(world, news(report.rows, before), "concise", "", "")
        data["audit"] = {"passed": False, **{k: v for k, v in audit.items() if k not in ("summary", "warnings", "next")}}
        left = [r.id for r in open_rows(report.rows) if r.mandatory]
        text += f"; the audit leaves {len(left)} rows open"
        return ToolReply(answer(data, text, f"edit_spec: add what stands on the ground, or mend {', '.join(left[:3])}"))
    rows, changed, _ = session.check_static()
    data |= {"changed_rows": len(changed), **news(rows, before, static=True)}
    return ToolReply(rows_answer(world, data, "concise", text, call("place_object", world=world)))
