"""Tool edit_spec: create a world, or change its specification by JSON Patch."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field

from ..workflow.arguments import Repair, WeakeningReason
from ..workflow.context import ToolContext, ToolReply
from ..worlds.errors import InputError, RefusedError

__all__ = ["edit_spec"]

SCENE_GROUPS = {"placement", "dimensions", "shape", "joints", "relations"}
"""Groups whose edits want the static checks first."""
PROMPT_WARNINGS = 4
"""Warnings about the words of the prompt that a reply shows."""


def edit_spec(
    context: ToolContext,
    world: Annotated[str, Field(description="World id: lower-case letters, digits, _ and -, e.g. 'domino_run'")],
    prompt: Annotated[
        str | None, Field(description="Only to create a world: the user's prompt, verbatim. It can never be changed.")
    ] = None,
    spec: Annotated[
        dict[str, Any] | None,
        Field(
            description="Only to create a world: the specification without `prompt`; may be partial. inspect_world(part='schema', pointer='example') shows a whole one"
        ),
    ] = None,
    copy_of: Annotated[
        str | None,
        Field(
            description="Only to create a world: another one whose specification it begins with, changed by `patch`; with its prompt unless `prompt` is given"
        ),
    ] = None,
    patch: Annotated[
        list[dict[str, Any]] | None,
        Field(
            description="To edit: RFC 6902 operations on world.json, e.g. [{'op':'replace','path':'/entities/ball/pose/position/2','value':0.8}]"
        ),
    ] = None,
    claims: Annotated[
        str | None,
        Field(
            description="The whole prompt with what each span means marked: 'A [ball](thing ball) [rolls off](event roll) the [table](thing table).' "
            "Targets are ids or pointers; more in inspect_world(part='claims')"
        ),
    ] = None,
    hypothesis: Annotated[
        str,
        Field(
            description="After a failed row: what causes the failure and why this change cures it. Then change one parameter group; while static rows alone fail, any of the scene."
        ),
    ] = "",
    repairs: Annotated[
        list[Repair] | None,
        Field(
            min_length=2,
            max_length=8,
            description="Instead of hypothesis: one per parameter group that changes, where the failing rows have nothing to do with each other",
        ),
    ] = None,
    weakening_reason: WeakeningReason = "",
    expected_revision: Annotated[int | None, Field(description="Refuse if the world is at another revision", ge=0)] = None,
    on_hand_edit: Annotated[
        Literal["refuse", "adopt", "restore"],
        Field(description="What to do when world.json was edited outside the server"),
    ] = "refuse",
) -> ToolReply:
    """Create a world from a prompt, or apply a JSON Patch to its specification as a new revision.

    Create with `world`, `prompt` and `spec` (or a part of it, the rest by patches), or with `world` and `copy_of`; edit with `world` and `patch`; say with `claims`,
    then or later, which words of the prompt mean which thing or beat. Learn the
    fields part by part from inspect_world(part='schema', pointer=...), the procedure from inspect_world(part='guide', prompt=...).
    Units are SI (m, kg, s, rad), Z is up, frame k is the state at k / fps seconds.
    Returns: revision, the prompt with spans proposed for its claims, the audit's open rows, what became stale. Refused: another prompt; a patch that does not validate; after failed rows an edit without hypothesis
    or of several parameter groups at once without repairs. Nothing changes when it is refused.
    Not for: putting an entity onto another one by contact (place_object finds the height), ground (build_terrain).
    Next: the reply's `next`; usually place_object, after story or shot edits run_checks.
    """
    if copy_of is not None:
        if spec is not None:
            raise InputError("copy_of begins with the specification of another world, spec is one; give one of them")
        from ..workflow.creation import copy

        return _answer(*copy(context.workspace, world, copy_of, prompt, list(patch or ()), claims))
    if prompt is not None:
        if patch is not None:
            raise InputError("prompt creates a world, patch edits one; give one of them")
        from ..workflow.creation import create

        return _answer(*create(context.workspace, world, prompt, spec or {}, claims))
    if spec is not None:
        raise InputError("spec is only for creating a world, together with prompt; use patch to edit")
    from ..workflow.job_kinds import ENTRIES
    from ..workflow.session import Session

    if on_hand_edit != "refuse":
        from ..workflow.creation import mend_hand_edit

        return _answer(*mend_hand_edit(context.workspace, world, on_hand_edit, hypothesis=hypothesis, reason=weakening_reason))
    session = Session.open(context.workspace, world)
    context.jobs.warm_up(ENTRIES)
    if expected_revision is not None and expected_revision != session.revision:
        raise RefusedError(
            f"world {world!r} is at revision {session.revision}, not {expected_revision}; read it again before editing"
        )
    if not patch and claims is None:
        raise InputError("give patch (RFC 6902 operations), claims (the prompt, marked), or prompt to create a world")
    from ..worlds.limits import check_limits
    from ..worlds.patch import apply_patch

    operations = list(patch or ())
    after = apply_patch(session.spec, operations)
    if claims is not None:
        from ..worlds.claim_marks import claim_operations

        more = claim_operations(claims, after)
        after, operations = apply_patch(after, more), operations + more
    check_limits(after)
    joint = None
    if repairs:
        from ..workflow.joint_repairs import Joint
        from ..workflow.measurements import latest_candidate

        joint = Joint(tuple(repairs), latest_candidate(session))
        hypothesis = "; ".join(r.hypothesis for r in repairs)
    before = session.spec
    outcome = session.commit(after, patch=operations, hypothesis=hypothesis, weakening_reason=weakening_reason, joint=joint)
    return _answer(session, outcome, before)


def _answer(session: Any, outcome: dict[str, Any], before: Any = None) -> ToolReply:
    from ..workflow.answers import answer, rows_answer, weaker_told
    from ..workflow.interiors import unlisted
    from ..workflow.material_rows import table_values
    from ..workflow.rows import summary

    world = session.folder.id
    report = session.audit()
    audit = rows_answer(world, summary(report.rows), "concise", "", "")
    data = {
        "world": world,
        **outcome,
        "audit": {"passed": report.passed, **{k: v for k, v in audit.items() if k not in ("summary", "warnings", "next")}},
        "bake_order": list(report.bake_order),
    }
    taken = table_values(session.spec, before)
    if taken:
        data["materials_from_table"] = taken
    if before is not None and before.interiors and (gone := unlisted(before, session.spec)):
        data["interiors_list_no_more"] = gone
    uncovered = [k for k, v in report.coverage.items() if not v]
    if uncovered:
        data["beats_no_shot_covers"] = uncovered[:20]
    told = _prompt_told(session)
    data |= told
    found = audit["counts"]
    verdict = "the audit passes" if report.passed else f"the audit leaves {found['mandatory_open']} rows open"
    done = (
        "created" if outcome.get("created") else "restored" if outcome.get("restored") else f"at revision {outcome['revision']}"
    )
    warnings = weaker_told(outcome)
    warnings += report.told_after(before)
    warnings += _where_told(told.get("prompt_judged", {}).get("warnings", []))
    moved = bool({"probe", "full"} & set(session.ledger.stages().values()))
    then = _next(session, report.passed, set(outcome.get("groups", ("shape",))) if moved else {"shape"})
    if moved and report.passed and set(outcome.get("stale", ())) == {"final", "seen"}:
        then = _relit(session)
    if outcome.get("undoes_revisions") and report.passed:
        then = _after_undo(session)
    links = ((f"{world} specification", f"worldagent://worlds/{world}/spec", "application/json"),)
    stale = outcome.get("rows_now_stale", 0)
    if outcome.get("changed") == []:
        done += ", though nothing changed"
    if outcome.get("undoes_revisions"):
        done += f", which takes back {', '.join(f'revision {n}' for n in outcome['undoes_revisions'])}"
    text = f"{world} {done}; {verdict}" + (f"; {stale} rows are stale now" if stale else "")
    return ToolReply(answer(data, text, then, warnings), links=links)


def _where_told(lines: list[str]) -> list[str]:
    """A warning that says where those about the words of the prompt stand; none where there are none."""
    return (
        ["the words of the prompt have warnings of their own: prompt_judged.warnings, printed with the acceptance"]
        if lines
        else []
    )


def _prompt_told(session: Any) -> dict[str, Any]:
    """Shares of the prompt and warnings, or, without claims, the spans that the server proposes."""
    spec = session.spec
    if spec.claims:
        from ..worlds.claims import prompt_record

        told = prompt_record(spec)
        kept = {k: told[k] for k in ("claimed", "filler", "waived")}
        lines = told["warnings"][:PROMPT_WARNINGS]
        more = len(told["warnings"]) - len(lines)
        lines += [f"{more} more; the acceptance prints all"] if more else []
        return {"prompt_judged": kept | ({"warnings": lines} if lines else {})}
    from ..worlds.prompts.proposals import proposal_text

    marked = proposal_text(spec.prompt)
    told = (
        {"claims_note": "(unknown): give the span a type, cut it anew, or leave it unmarked as filler"}
        if "](unknown)" in marked
        else {}
    )
    return {"claims_to_make": marked, **told}


def _next(session: Any, passed: bool, groups: set[str]) -> str:
    from ..workflow.answers import call
    from ..workflow.outdoor import to_build

    world, land = session.folder.id, to_build(session)
    if not passed:
        mend = "edit_spec: mend the audit's open rows"
        if not session.spec.entities and not session.spec.terrains:
            guide = call("inspect_world", part="guide", prompt="...")
            mend = f"edit_spec: add entities, beats or requirements, and claims; {guide} with the prompt returns what fits it"
        return mend if land is None else f"{land} (it needs no passing audit), or {mend}"
    if land is not None:
        return land
    if groups == {"text"}:
        return _made_already(session) or call("place_object", world=world)
    if groups <= {"story", "limits", "shots", "look", "text"}:
        return f"{call('run_checks', world=world, scope='probe')} judges this again on the motion there is"
    return _made_already(session) or call("place_object" if groups & SCENE_GROUPS else "probe_sim", world=world)


def _made_already(session: Any) -> str:
    """The next step where a probe or a bake of the present settings is there, as after an edit that takes another back; else empty."""
    from ..workflow.answers import call
    from ..workflow.gates import bake_opens
    from ..workflow.standing import standing

    world, there = session.folder.id, standing(session.folder, session.ledger)
    if there.step("accepted").state == "done":
        return call("render_shot", world=world, kind="final")
    if there.step("baked").state == "done":
        return call("run_checks", world=world, scope="acceptance")
    return call("bake_sim", world=world) if bake_opens(session) else ""


def _relit(session: Any) -> str:
    """The next step after an edit that changes nothing but what pictures look like: acceptance stands, its pictures do not."""
    from ..workflow.answers import call

    world = session.folder.id
    asked = call("run_checks", world=world, scope="full", only=["shots"])
    film = call("render_shot", world=world, kind="final")
    return f"{asked} asks the stale rows in the new look; of an accepted world {film} asks them before its first frame and is refused where one fails"


def _after_undo(session: Any) -> str:
    from ..workflow.answers import call
    from ..workflow.earlier import has_motion

    again = f", or {call('run_checks', world=session.folder.id, scope='probe')} to judge the motion of these settings again"
    return f"edit_spec: another hypothesis{again if has_motion(session) else ''}"
