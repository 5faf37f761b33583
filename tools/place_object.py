"""Tool place_object: build geometry, put an entity on its support, check what changed."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

from pydantic import Field

from ..workflow.arguments import Hypothesis, RowDetail, WaitSeconds, WeakeningReason, WorldId
from ..workflow.arrangements import Array, AssetAsk, Beside, Station, Thing
from ..workflow.context import ToolContext, ToolReply
from ..worlds.errors import InputError

if TYPE_CHECKING:
    from ..execution import Job

__all__ = ["place_object", "placed_reply"]


def place_object(
    context: ToolContext,
    world: WorldId,
    entity: Annotated[
        str | None,
        Field(description="Entity to move, or with asset to make; omit to build and check the whole scene as specified"),
    ] = None,
    asset: Annotated[
        AssetAsk | None,
        Field(description="Make the entity, or make it anew: tables, doors, vessels, carts, ... with their joints"),
    ] = None,
    on: Annotated[str | None, Field(description="Entity it shall rest on; the height is found by exact clearance")] = None,
    surface: Annotated[
        str | None,
        Field(description="With on: a surface of that asset, e.g. 'shelf_2'; at and yaw_deg count from its middle"),
    ] = None,
    at: Annotated[
        tuple[float, float] | None, Field(description="World x, y of the entity's origin [m]; default where it is")
    ] = None,
    height: Annotated[
        float | None, Field(ge=-1e4, le=1e4, description="Instead of on: z of its origin [m]; what hangs on walls and ceilings")
    ] = None,
    yaw_deg: Annotated[
        float | None, Field(ge=-360, le=360, description="Turn about z [degrees]; default keep the orientation")
    ] = None,
    tilt: Annotated[bool, Field(description="With on: turned to the mean slope of the surface under it")] = False,
    lay: Annotated[bool, Field(description="Turned by the least angle onto a side on which it stays: stones, logs")] = False,
    beside: Annotated[Beside | None, Field(description="Instead of at: beside, in front or on top of another entity")] = None,
    river: Annotated[Station | None, Field(description="Instead of at: a place in a river of a landscape")] = None,
    afloat: Annotated[
        str | None,
        Field(description="Liquid entity, or landscape whose water, it floats on: lowered until it displaces its own mass"),
    ] = None,
    group: Annotated[
        list[str] | None,
        Field(
            max_length=200,
            description="Entities that go along as one, with joints, drivers and paths of all of them; [] for its own alone",
        ),
    ] = None,
    copy: Annotated[
        str | None, Field(max_length=60, description="Put a copy there instead, and of group: suffix of the new ids, e.g. '_b'")
    ] = None,
    array: Annotated[Array | None, Field(description="Many of it: a row or grid, a circle, a scatter inside a polygon")] = None,
    things: Annotated[
        list[Thing] | None,
        Field(
            min_length=1, max_length=60, description="Instead of entity: many different ones in one call, placed in this order"
        ),
    ] = None,
    cameras: Annotated[bool, Field(description="With group: cameras of shots that frame them go along")] = False,
    strict: Annotated[bool, Field(description="Refuse a place that overlaps another entity")] = True,
    hypothesis: Hypothesis = "",
    weakening_reason: WeakeningReason = "",
    detail: RowDetail = "concise",
    wait_s: WaitSeconds = 30.0,
) -> ToolReply:
    """Build the shapes of all entities and run the static checks; with `entity`, move that one first.

    Call it without `entity` after every edit of geometry. With `entity` and `on`, the entity is lowered along z onto that
    support until it rests with a gap of two collision skins (0.1 mm between static things); `at`, `beside` or `river`, and `yaw_deg`, choose where and how; `tilt`
    lays it along the slope. `group` moves an assembly as one, `copy` copies it, `array` makes many; `things` lays a table in one call: those without a place are told
    (`not_placed`), the others stand. All of it is one revision and one change; after a failed row it needs a hypothesis, except the first one onto a support while nothing else fails.
    Returns: ids and poses, overlaps, what was left behind, what was built, whether the static rows pass, the open rows with measured value, bound, cause and suggested patch;
    or, of a scene of many entities, a job_id when it takes longer than wait_s.
    Not for: declaring that something carries something (a `supports` relation in /graph/relations, by edit_spec).
    Refused: while the audit fails (beats and claims may be missing yet, not wrong); a place that overlaps (`strict`); an entity that is not above `on`.
    Next: probe_sim when static_passed, else mend the first open row; render_shot shows the scene.
    """
    from ..workflow.job_kinds import ENTRIES
    from ..workflow.places_asked import Asked
    from ..workflow.placing import asked_plain, place_and_check, takes_long
    from ..workflow.session import Session
    from ..workflow.waiting import start_and_wait
    from ..worlds.canonical import digest_of

    session = Session.open(context.workspace, world)
    context.jobs.warm_up(ENTRIES)
    if asset is None and not (things and all(thing.asset is not None for thing in things)):
        session.require_audit("place_object", still=True)
    where: dict[str, Any] = {
        "asset": asset,
        "on": on,
        "surface": surface,
        "at": at,
        "height": height,
        "yaw_deg": yaw_deg,
        "beside": beside,
        "river": river,
        "afloat": afloat,
        "copy": copy,
        "array": array,
    }
    asked: list[Asked] = []
    if entity is not None:
        together = None if group is None else tuple(group)
        asked = [Asked(entity, **where, group=together, tilt=tilt, lay=lay, cameras=cameras, strict=strict)]
    elif tilt or lay or group is not None or any(v is not None for v in where.values()):
        raise InputError("on, at, height, yaw_deg and all else that says where need entity")
    if things is not None:
        if entity is not None:
            raise InputError("entity places one thing, things many; give one of them")
        asked = [Asked(**{k: getattr(thing, k) for k in type(thing).model_fields}, strict=strict) for thing in things]
    reasons, many = (hypothesis, weakening_reason), things is not None
    if not takes_long(session, asked):

        def tell(done: float, total: float, message: str, ends: float | None = None) -> None:
            del ends
            context.progress(done, total, message)

        return _told(context, world, place_and_check(session, asked, reasons, tell, many=many), entity, detail)
    given = {"hypothesis": hypothesis, "weakening_reason": weakening_reason, "many": many, "entity": entity}
    payload = {"things": [asked_plain(a) for a in asked], "detail": detail, **{k: v for k, v in given.items() if v}}
    key = f"place:{digest_of(payload)}:{session.revision}"
    data = start_and_wait(context, session, "placing", payload, wait_s=wait_s, key=key, reuse=False)
    return _told(context, world, data, entity, detail)


def placed_reply(job: Job) -> ToolReply:
    """Reply for a scene whose job has ended."""
    from ..workflow.waiting import ended_data

    return _told(None, str(job.world), ended_data(job), job.payload.get("entity"), job.payload.get("detail", "concise"))


def _told(context: ToolContext | None, world: str, data: dict[str, Any], entity: str | None, detail: RowDetail) -> ToolReply:
    """Reply about a scene; `context`: the call that takes it, whose session is told standing warnings once (`job` does so itself)."""
    from ..workflow.answers import answer, call, job_answer, rows_answer

    if "state" in data:
        return ToolReply(job_answer(data))
    if "audit_open" in data:
        open_rows = ", ".join(data["audit_open"])
        where = f"{data['pose']['position']} is where it stands" if "pose" in data else _said(entity, data).removesuffix("; ")
        text = f"{where}; static checks wait for the audit, which leaves {open_rows} open"
        return ToolReply(answer(data, text, "place_object for more, then edit_spec: mend the audit's open rows"))
    if context is not None:
        data = {**data, "warnings": context.heard.without_repeats(world, data["warnings"])}
    restless, complete, fresh = (data.pop(k) for k in ("restless", "audit_passed", "built_total"))
    passed = data["static_passed"]
    verdict = "the static checks pass" if passed else f"{data['counts']['fail']} static rows fail"
    then = (
        call("probe_sim", world=world)
        if passed
        else "edit_spec or place_object: mend the open rows, all of the scene in one edit with a hypothesis"
    )
    if passed and not complete:
        then = "place_object for more; edit_spec: beats and claims, which the audit still asks for"
    if not passed and restless:
        then += "; bodies that would first have to come to rest: add /simulation/settle {}, and they do before frame 0"
    links = ((f"{world} matrix", f"worldagent://worlds/{world}/matrix", "application/json"),)
    moved = _said(entity, data) if entity is not None or "placed" in data else ""
    return ToolReply(rows_answer(world, data, detail, f"{moved}{fresh} entities built anew; {verdict}", then), links=links)


def _said(entity: str | None, outcome: dict[str, Any]) -> str:
    many, without = outcome.get("placed_total", 0), outcome.get("not_placed", ())
    what = f"{many} entities placed ({outcome['placed'][0]['id']} ...)" if many else f"{entity} moved"
    if without:
        what += f", {len(without)} without a place ({without[0]['thing']}: {without[0]['why']})"
    return f"{what}; " if outcome["moved"] else f"{entity or 'all'} stays where it was; "
