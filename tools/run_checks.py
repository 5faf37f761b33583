"""Tool run_checks: judge again, or judge more."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import Field

from ..workflow.arguments import RowDetail, WaitSeconds, WorldId
from ..workflow.context import ToolContext, ToolReply
from ..workflow.links import proof_links
from ..workflow.rows import Detail
from ..worlds.ablation import ABLATED
from ..worlds.errors import InputError, RefusedError

if TYPE_CHECKING:
    from ..execution import Job
    from ..workflow.session import Session

__all__ = ["run_checks", "verdict_reply"]

Check = Literal[
    "scale",
    "interpenetration",
    "support",
    "navigability",
    "shots",
    "numerical",
    "contact",
    "category",
    "beat",
    "causal",
    "robustness",
    "delivery",
]


def run_checks(
    context: ToolContext,
    world: WorldId,
    scope: Annotated[
        Literal["audit", "static", "probe", "full", "review", "acceptance"],
        Field(
            description="audit: the specification; static: geometry at frame 0; probe / full: the motion that was probed / baked; "
            "review: somebody who did not make the world reads its baked motion; acceptance: a fresh read-only process judges the whole candidate and replays random intervals"
        ),
    ],
    only: Annotated[list[Check] | None, Field(description="For probe and full: only these checks")] = None,
    wait_s: WaitSeconds = 30.0,
    detail: RowDetail = "concise",
) -> ToolReply:
    """Judge again and return requirement rows, or ask for acceptance.

    Every tool that changes or simulates something runs the checks it affects already. Use this after editing the story or the
    shots (no new simulation is needed: scope probe or full), after editing the look (scope full: small pictures are rendered in
    which every subject must be seen), and for acceptance: a fresh read-only process judges the whole candidate and replays
    random intervals of its bake. Refused without a complete bake of exactly these settings.
    Returns: counts and the open rows: measured value, bound, first failing entity and frame, what to do; for acceptance the
    verdict, the approximation register, and links to a report and a bundle. review asks the model that the server's owner named
    whether the bake shows what the prompt says, part by part; without one a person can answer on the page. Statuses: pass, fail, unverified (no evidence,
    never a pass), not_applicable (proven). No call can set one.
    Not for: reading known rows (inspect_world(part='matrix')). Next: after acceptance render_shot(kind='final'); after
    failures edit_spec.
    """
    from ..workflow.rows import summary
    from ..workflow.session import Session
    from ..workflow.waiting import start_and_wait

    session = Session.open(context.workspace, world)
    data: dict[str, Any]
    if scope == "audit":
        report = session.audit()
        data = {"scope": scope, "passed": report.passed, **summary(report.rows), "warnings": list(report.told)}
    elif scope == "static":
        session.require_audit("static checks", still=True)
        rows, changed, fresh = session.check_static()
        data = {"scope": scope, "built": fresh, "changed_rows": len(changed), **summary(rows, static=True)}
    else:
        kind, payload, key = _job_of(session, scope, only)
        payload |= {"revision": session.revision, "detail": detail}
        data = start_and_wait(context, session, kind, payload, wait_s=wait_s, key=f"{key}:{session.revision}", reuse=False)
    return _reply(world, session.revision, data, detail, only or ())


def _job_of(session: Session, scope: str, only: list[Check] | None) -> tuple[str, dict[str, Any], str]:
    """Kind, own payload and key of the job that judges a scope, where everything that it needs is there."""
    from ..workflow.measurements import latest_candidate

    session.require_audit({"acceptance": "acceptance", "review": "a review"}.get(scope, f"{scope} checks"))
    if only and scope in ("acceptance", "review"):
        raise InputError(f"{scope} is about the whole world; leave only out")
    if scope == "acceptance":
        if session.ledger.bake(session.freeze()) is None:
            raise RefusedError("acceptance needs a complete bake of exactly these settings; call probe_sim and bake_sim first")
        return "accept", {}, "accept"
    latest_candidate(session, "full" if scope == "review" else scope)
    if scope == "review":
        return "review", {}, "review"
    return "check", {"scope": scope, "only": only}, f"check:{scope}:{'+'.join(only or ('all',))}"


NO_READER = (
    "nobody can answer from here. The server's owner names a model (WORLDAGENT_REVIEW_URL and WORLDAGENT_REVIEW_MODEL), or a person "
    "answers on the page of `worldagent serve --transport http`; an acceptance stands without, and says so"
)


def verdict_reply(job: Job) -> ToolReply:
    """Reply for checks or an acceptance that have ended."""
    from ..workflow.waiting import ended_data

    return _reply(
        str(job.world),
        int(job.payload["revision"]),
        ended_data(job),
        job.payload.get("detail", "concise"),
        job.payload.get("only") or (),
    )


def _call_asked(rows: Sequence[Mapping[str, Any]]) -> str:
    """The call that all open rows ask for, none of them for an edit; empty where one does."""
    actions = {r["corrections"][0]["action"] if r.get("corrections") else "" for r in rows}
    first = next(iter(actions), "")
    return first if len(actions) == 1 and first.startswith("call ") else ""


def _reply(world: str, revision: int, data: dict[str, Any], detail: Detail, only: Sequence[str] = ()) -> ToolReply:
    from ..workflow.answers import answer, call, job_answer, rows_answer
    from ..workflow.motion_replies import mend_first

    place = {"world": world, "revision": revision}
    if "state" in data:
        told = job_answer(data)
        return ToolReply(answer({**place, **told}, told["summary"], told["next"]))
    found = data["counts"]
    text = f"{found['pass']} rows pass, {found['fail']} fail, {found['unverified']} unverified"
    if "verdict" in data:
        text = f"{data.get('says', data['verdict'])}: {text}"
        if data.get("not_counted"):
            names = ", ".join(data["not_counted"][:3])
            text = f"{text}; the matrix has {len(data['not_counted'])} more, which only a bake judges against its probe: {names}"
        then = call("render_shot", world=world, kind="final")
        good = data["verdict"] in ("accepted", ABLATED)
    else:
        text = f"{data['scope']}: {text}"
        then = {
            "audit": call("place_object", world=world),
            "static": call("probe_sim", world=world),
            "probe": call("bake_sim", world=world),
            "full": call("run_checks", world=world, scope="acceptance"),
            "review": call("run_checks", world=world, scope="acceptance"),
        }[data["scope"]]
        if "stopped_at" in data:
            text = f"{text}; frames 0..{data['stopped_at']} of {data['of_frames']} are there"
            then = call("probe_sim", world=world)
        later = data.get("waiting_for_motion", 0) if data["scope"] == "static" else 0
        good = found["mandatory_open"] <= later or ("stopped_at" in data and not found["fail"])
        if data["scope"] == "review":
            text = f"{text}; read by {data['read_by']}"
            if data["read_by"] == "nobody":
                text = f"{text}: {NO_READER}"
                then = call("render_shot", world=world, kind="final") if data.get("accepted") else then
        if only:
            text = f"{text} (only {', '.join(only)})"
            then = call("run_checks", world=world, scope=data["scope"])
    repair = mend_first(world, data, "repeat from the first stale step")
    told = rows_answer(world, {**place, **data}, detail, text, then if good else _call_asked(data.get("open_rows", ())) or repair)
    return ToolReply(told, links=proof_links(world, data))
