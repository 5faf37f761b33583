"""Tool place_object: build geometry, put an entity on its support, check what changed."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import Field

from ..workflow.arguments import Hypothesis, RowDetail, WeakeningReason, WorldId
from ..workflow.arrangements import Array, AssetAsk, Beside, Station
from ..workflow.context import ToolContext, ToolReply
from ..worlds.errors import InputError

__all__ = ["place_object"]

RESTLESS = ("support:balance", "support:grip", "support:derived")
"""Questions about bodies that a settle run answers."""


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
    cameras: Annotated[bool, Field(description="With group: cameras of shots that frame them go along")] = False,
    strict: Annotated[bool, Field(description="Refuse a place that overlaps another entity")] = True,
    hypothesis: Hypothesis = "",
    weakening_reason: WeakeningReason = "",
    detail: RowDetail = "concise",
) -> ToolReply:
    """Build the shapes of all entities and run the static checks; with `entity`, move that one first.

    Call it without `entity` after every edit of geometry. With `entity` and `on`, the entity is lowered along z onto that
    support until it rests with a gap of two collision skins (0.1 mm between static things); `at`, `beside` or `river`, and `yaw_deg`, choose where and how; `tilt`
    lays it along the slope. `group` moves an assembly as one, `copy` copies it, `array` makes many. All of it is one revision and one
    change; after a failed row it needs a hypothesis, except the first one onto a support while nothing else fails.
    Returns: ids and poses, overlaps, what was left behind, what was built, whether the static rows pass, the open rows with measured value, bound, cause and suggested patch.
    Not for: declaring that something carries something (a `supports` relation in /graph/relations, by edit_spec).
    Refused: while the audit fails (beats and claims may be missing yet, not wrong); a place that overlaps (`strict`); an entity that is not above `on`.
    Next: probe_sim when static_passed, else mend the first open row; render_shot shows the scene.
    """
    from ..workflow.answers import call, rows_answer, weaker_told
    from ..workflow.early_words import unmet_at_start
    from ..workflow.job_kinds import ENTRIES
    from ..workflow.placement import place
    from ..workflow.places_asked import Asked
    from ..workflow.rows import summary
    from ..workflow.session import Session

    session = Session.open(context.workspace, world)
    context.jobs.warm_up(ENTRIES)
    if asset is None:
        session.require_audit("place_object", still=True)
    outcome: dict[str, Any] = {}
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
    if entity is not None:
        more = {
            **where,
            "group": None if group is None else tuple(group),
            "tilt": tilt,
            "lay": lay,
            "cameras": cameras,
            "strict": strict,
        }
        outcome = place(session, Asked(entity, **more), hypothesis=hypothesis, weakening_reason=weakening_reason)
    elif tilt or lay or group is not None or any(v is not None for v in where.values()):
        raise InputError("on, at, height, yaw_deg and all else that says where need entity")
    if asset is not None and not session.buildable(session.audit()):
        return _unjudged(session, outcome)
    rows, changed, fresh = session.check_static()
    passed = all(r.status in ("pass", "not_applicable") for r in rows if r.mandatory and r.check != "shots")
    data = {
        "world": world,
        "revision": session.revision,
        **outcome,
        "built": fresh if len(fresh) <= 20 else [*fresh[:20], f"and {len(fresh) - 20} more"],
        "static_passed": passed,
        "changed_rows": len(changed),
        **summary(rows, static=True),
        "warnings": [*outcome.get("warnings", ()), *weaker_told(outcome), *unmet_at_start(session)],
    }
    moved = "" if entity is None else _said(entity, outcome)
    found = data["counts"]
    verdict = "the static checks pass" if passed else f"{found['fail']} static rows fail"
    then = call("probe_sim", world=world) if passed else "edit_spec or place_object: mend the first open row, one group at a time"
    if passed and not session.audit().passed:
        then = "place_object for more; edit_spec: beats and claims, which the audit still asks for"
    if not passed and any(r.status == "fail" and r.question in RESTLESS for r in rows) and session.spec.simulation.settle is None:
        then += "; bodies that would first have to come to rest: add /simulation/settle {}, and they do before frame 0"
    links = ((f"{world} matrix", f"worldagent://worlds/{world}/matrix", "application/json"),)
    return ToolReply(rows_answer(world, data, detail, f"{moved}{len(fresh)} entities built anew; {verdict}", then), links=links)


def _unjudged(session: Any, outcome: dict[str, Any]) -> ToolReply:
    """Reply after an asset was made in a world whose audit still has open rows: static checks wait for it."""
    from ..workflow.answers import answer

    open_rows = [r.id for r in session.audit().rows if r.mandatory and r.status != "pass"]
    data = {"world": session.folder.id, "revision": session.revision, **outcome, "audit_open": open_rows}
    text = f"{outcome['pose']['position']} is where it stands; static checks wait for the audit, which leaves {', '.join(open_rows)} open"
    return ToolReply(answer(data, text, "place_object for more, then edit_spec: mend the audit's open rows"))


def _said(entity: str, outcome: dict[str, Any]) -> str:
    many = outcome.get("placed_total", 0)
    what = f"{many} entities placed ({outcome['placed'][0]['id']} ...)" if many else f"{entity} moved"
    return f"{what}; " if outcome["moved"] else f"{entity} stays where it was; "
