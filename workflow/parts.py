"""The parts that `inspect_world` reads: each an answer of a stable shape, a page at a time."""

from __future__ import annotations

import difflib
import math
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from ..worlds.ablation import ABLATED
from ..worlds.errors import InputError
from ..worlds.folder import world_ids
from ..worlds.verdicts import asked_words, prompt_told, unusual_told, verdict_words
from .answers import PAGE_CHARACTERS, answer, call, paged, size_of
from .gates import bake_opens
from .joint_repairs import said_of
from .outdoor import to_build
from .rows import Detail, brief, concise, counts, ranked, why_line
from .session import Session
from .standing import is_about_present
from .table_entries import entry_of

__all__ = [
    "acceptance",
    "claims",
    "guide",
    "iterations",
    "matrix",
    "one_row",
    "overview",
    "revisions",
    "spec",
    "worlds",
]

SKILLS = Path(__file__).resolve().parent.parent / "skills"
PROMPT_CHARACTERS = 1500
GUIDE_CHARACTERS = 8000
OPEN = ("fail", "unverified")
_DESCRIPTION = re.compile(r"^description:\s*(.+?)\s*$", re.MULTILINE)


def _on(world: str, part: str, page: Mapping[str, Any], otherwise: str, **more: Any) -> str:
    """The call for the next page, or else the one that usually follows."""
    if "next_offset" not in page:
        return otherwise
    return call("inspect_world", world=world, part=part, **more, offset=page["next_offset"])


def worlds(workspace: Path, *, offset: int, limit: int) -> dict[str, Any]:
    """Ids of all worlds."""
    known = world_ids(workspace)
    page, place = paged(known, offset, limit)
    then = call("inspect_world", world=page[0]) if page else "edit_spec(world=..., prompt=..., spec=...) creates a world"
    if "next_offset" in place:
        then = call("inspect_world", part="worlds", offset=place["next_offset"])
    return answer({"part": "worlds", "worlds": page, **place}, f"{len(known)} worlds in this workspace", then)


def guide(path: str, *, offset: int) -> dict[str, Any]:
    """The skills: their list, or a file of one, some thousand characters at a time."""
    files = {
        p.relative_to(SKILLS).as_posix(): p for p in sorted(SKILLS.rglob("*")) if p.suffix in (".md", ".json") and p.is_file()
    }
    # `guide.json` tells which sections the guide of a prompt takes from its skill: it is for the server.
    shown = {n: p for n, p in files.items() if "/evals/" not in n and n.count("/") and p.name != "guide.json"}
    wanted, _, entry = path.removeprefix("skill://").strip("/").partition("#")
    if not wanted:
        about = {n: _about(p) if p.name == "SKILL.md" else p.stat().st_size for n, p in shown.items()}
        then = call("inspect_world", part="guide", pointer="world-building/SKILL.md")
        return answer(
            {"part": "guide", "files": about},
            "guides for building and repairing worlds: what each skill is for, sizes of other files in characters",
            then,
        )
    if wanted not in files:
        same = [f for f in files if f.rsplit("/", 1)[-1] == wanted.rsplit("/", 1)[-1]]
        close = same or difflib.get_close_matches(wanted, files, n=1, cutoff=0.3)
        hint = f"; did you mean {close[0]!r}?" if close else ""
        raise InputError(f"there is no guide {path!r}{hint} inspect_world(part='guide') lists them")
    text = entry_of(files[wanted].read_text(), entry)
    if offset and offset >= len(text):
        raise InputError(f"offset {offset} is past the end: {wanted} has {len(text)} characters")
    end = offset + GUIDE_CHARACTERS
    if end < len(text):
        end = text.rfind("\n", offset, end) + 1 or end
    more = call("inspect_world", part="guide", pointer=wanted, offset=end) if end < len(text) else "inspect_world(part='guide')"
    place = {"total": len(text), "offset": offset, **({"next_offset": end} if end < len(text) else {})}
    data = {"part": "guide", "file": wanted, **place, "text": text[offset:end]}
    return answer(data, f"{wanted}, characters {offset} to {min(end, len(text))} of {len(text)}", more)


def _about(path: Path) -> str:
    found = _DESCRIPTION.search(path.read_text()[:2000])
    return found.group(1).strip("'\"") if found else ""


def overview(session: Session, *, jobs: list[str], offset: int, limit: int) -> dict[str, Any]:
    """Where a world stands and what comes next."""
    world, plan = session.folder.id, session.spec.simulation
    rows = session.ledger.rows()
    latest = session.ledger.acceptance()
    says = "" if latest is None else verdict_words(latest["record"])
    left = [r.id for r in ranked(rows, only=OPEN) if r.mandatory]
    page, place = paged(left, offset, limit)
    prompt = session.spec.prompt
    beats = {k: {"text": b.text[:120], "frames": list(b.frames)} for k, b in list(session.spec.story.beats.items())[:limit]}
    data = {
        "title": session.spec.title,
        "prompt": prompt
        if len(prompt) <= PROMPT_CHARACTERS
        else f"{prompt[:PROMPT_CHARACTERS]}... (all: part='spec', pointer='/prompt')",
        "frames": plan.frames,
        "fps": plan.fps,
        "entities": len(session.spec.entities),
        "beats": beats,
        "matrix": counts(rows),
        "open_rows": page,
        **{f"open_{k}": v for k, v in place.items()},
        "last_verdict": None if latest is None else {k: latest[k] for k in ("verdict", "revision")} | {"says": says},
        "jobs_running": jobs,
    }
    about = latest is not None and is_about_present(session.ledger, latest)
    accepted = about and latest is not None and latest["verdict"] in ("accepted", ABLATED)
    if jobs:
        then = call("job", action="wait", job_id=jobs[0])
    elif accepted and not left:
        then = call("render_shot", world=world, kind="final")
    else:
        failed = {r.check for r in rows if r.status == "fail" and r.mandatory}
        mend = call("inspect_world", world=world, part="matrix", status="open")
        # A landscape is built before the audit passes.
        then = mend if failed - {"audit"} else to_build(session) or (mend if failed else _coming(session))
    verdict = "never judged" if latest is None else f"last verdict at revision {latest['revision']}: {says}"
    return answer(data, f"{session.spec.title!r}, revision {session.revision}: {len(left)} mandatory rows open, {verdict}", then)


def _of_another(judged: int, now: int) -> str:
    """Warning that a verdict is not about the present world."""
    if judged != now:
        return f"this verdict is about revision {judged}, and the world is at revision {now} now: this verdict is not about it"
    return (
        f"this verdict is filed under revision {now}, at which the world is, but its record is about another specification: this verdict is not about it; "
        "judge the world again"
    )


def _coming(session: Session) -> str:
    """The next stage of the loop, by what has been judged."""
    stages, world = set(session.ledger.stages().values()), session.folder.id
    if "full" in stages:
        return call("run_checks", world=world, scope="acceptance")
    if "probe" in stages and bake_opens(session):
        return call("bake_sim", world=world)
    return call("probe_sim" if stages & {"probe", "static"} else "place_object", world=world)


def spec(session: Session, pointer: str, *, offset: int, limit: int) -> dict[str, Any]:
    """The specification at a pointer: whole where it is small, else its members a page at a time."""
    world = session.folder.id
    value = _resolve(session.spec.model_dump(mode="json", exclude_none=True), pointer)
    head = {"pointer": pointer}
    if not isinstance(value, dict | list) or size_of(value) <= PAGE_CHARACTERS:
        return answer({**head, "value": value}, f"world.json at {pointer or '/'}", call("edit_spec", world=world, patch=[]))
    named = list(value.items() if isinstance(value, dict) else enumerate(value))
    shown = [(k, _outline(v, f"{pointer}/{k}")) for k, v in named]
    page, place = paged(shown, offset, limit)
    told: Any = dict(page) if isinstance(value, dict) else [v for _, v in page]
    then = _on(
        world, "spec", place, call("inspect_world", world=world, part="spec", pointer=f"{pointer}/{named[0][0]}"), pointer=pointer
    )
    text = f"world.json at {pointer or '/'}: {size_of(value)} characters, larger members are outlined; read one by its pointer"
    return answer({**head, "value": told, **place}, text, then)


def _outline(value: Any, pointer: str, room: int = 900) -> Any:
    """A member in full where it is small, else what it holds and where to read it."""
    if size_of(value) <= room:
        return value
    if isinstance(value, dict):
        names = list(value)
        more = f", ... ({len(names)} in all)" if len(names) > 12 else ""
        return f"object of {size_of(value)} characters with {', '.join(names[:12])}{more}; pointer {pointer}"
    if isinstance(value, list):
        return f"list of {len(value)} items, {size_of(value)} characters; pointer {pointer}"
    return f"{str(value)[:room]}... ({len(str(value))} characters; pointer {pointer})"


def _resolve(document: Any, pointer: str) -> Any:
    at = document
    walked = ""
    for token in [t for t in pointer.split("/") if t]:
        key = token.replace("~1", "/").replace("~0", "~")
        if isinstance(at, dict) and key in at:
            at = at[key]
        elif isinstance(at, list) and key.isdigit() and int(key) < len(at):
            at = at[int(key)]
        else:
            raise InputError(f"pointer {pointer!r} leads nowhere at {token!r}; {_there(at, key, walked)}")
        walked += f"/{token}"
    return at


def _there(at: Any, key: str, walked: str) -> str:
    if isinstance(at, dict):
        close = difflib.get_close_matches(key, at, n=1)
        hint = f"did you mean {walked}/{close[0]}? " if close else ""
        return f"{hint}there is {list(at)[:20]}"
    return f"there is 0..{len(at) - 1}" if isinstance(at, list) else "there is nothing below it"


def matrix(session: Session, status: str | None, detail: Detail, *, offset: int, limit: int) -> dict[str, Any]:
    """Requirement rows, open ones first; passing rows in a line each unless asked in full, and where all are asked for, so are open
    ones once half a page is told."""
    world = session.folder.id
    rows = session.ledger.rows()
    only = {None: ("fail", "unverified", "pass", "not_applicable"), "open": OPEN}.get(status, (str(status),))
    chosen = ranked(rows, only=only)
    full = [brief(r) for r in chosen]
    items, room = full, math.inf if status else PAGE_CHARACTERS / 2
    if detail != "full":
        items = []
        for row in full:
            items.append(concise(row, world) if row["status"] in OPEN and room > 0 else why_line(row))
            room -= size_of(items[-1])
    page, place = paged(items, offset, limit, room=PAGE_CHARACTERS if detail == "concise" else 2 * PAGE_CHARACTERS)
    first = next((r["id"] for r in page if r["status"] in OPEN), None)
    then = call("inspect_world", world=world, part="row", row=first) if first else call("inspect_world", world=world)
    found = counts(rows)
    text = f"{found['pass']} rows pass, {found['fail']} fail, {found['unverified']} unverified ({found['mandatory_open']} mandatory open)"
    data = {"counts": found, "rows": page, **place}
    more = {"status": status, "detail": detail if detail == "full" else None}
    return answer(data, f"{text}; showing {len(page)} of {place['total']}", _on(world, "matrix", place, then, **more))


def one_row(session: Session, row: str | None, *, offset: int, limit: int) -> dict[str, Any]:
    """One row in full, with its past verdicts."""
    world = session.folder.id
    known = {r.id: r for r in session.ledger.rows()}
    if row is None:
        raise InputError("part 'row' needs row, the id of a requirement row; inspect_world(part='matrix') lists them")
    if row not in known:
        close = difflib.get_close_matches(row, known, n=3, cutoff=0.4) or [k for k in known if row.lower() in k.lower()][:3]
        hint = f"; did you mean {' or '.join(map(repr, close))}?" if close else ""
        raise InputError(f"there is no row {row!r}{hint} inspect_world(world={world!r}, part='matrix') lists them")
    found = known[row]
    past, place = paged(session.ledger.history(row, limit=200), offset, limit, room=2500)
    place = {f"history_{k}": v for k, v in place.items()}
    data = {"row": found.model_dump(mode="json", exclude={"recipe"}, exclude_none=True), "history": past, **place}
    asked = "" if found.bound is None else f", needs {asked_words(found.comparison, found.bound, found.unit)}"
    measured = "" if found.measured is None else f": measured {found.measured:.6g}{asked}"
    then = (
        "edit_spec with a hypothesis and one parameter group"
        if found.status in OPEN
        else call("inspect_world", world=world, part="matrix")
    )
    return answer(data, f"{row}: {found.status}{measured}", then)


def revisions(session: Session, detail: Detail, *, offset: int, limit: int) -> dict[str, Any]:
    """Edits, newest first; concise ones name the places of the patch only."""
    found = session.ledger.revisions(session.revision)
    if detail == "concise":
        found = [
            {k: v for k, v in r.items() if k not in ("patch", "digest") and v not in ("", [])}
            | {"changed": _few([o.get("path", o.get("op")) for o in r["patch"]], 6)}
            for r in found
        ]
    page, place = paged(found, offset, limit)
    world = session.folder.id
    return answer(
        {"revisions": page, **place},
        f"{session.revision} revisions, newest first",
        _on(world, "revisions", place, call("inspect_world", world=world, part="iterations")),
    )


def iterations(session: Session, detail: Detail, *, offset: int, limit: int) -> dict[str, Any]:
    """Attempts at repair, newest first: what was changed and which rows it mended or broke."""
    found = session.ledger.iterations(1000)
    if detail == "concise":
        found = [_iteration(i) for i in found]
    page, place = paged(found, offset, limit)
    world = session.folder.id
    then = _on(world, "iterations", place, call("inspect_world", world=world, part="matrix", status="open"))
    return answer({"iterations": page, **place}, f"{place['total']} attempts at repair, newest first", then)


def _iteration(found: Mapping[str, Any]) -> dict[str, Any]:
    before, after = found["failing_before"] or [], found["failing_after"]
    told = {k: found[k] for k in ("n", "revision", "hypothesis", "grp", "probe") if found.get(k) is not None}
    told |= {"changes": _few(found.get("changes") or [], 4), "failing_before": _few(before, 6)}
    if after is not None:
        told |= {"failing_after": _few(after, 6), "mended": _few([r for r in before if r not in after], 6)}
    said = said_of(found)
    return told | ({"said": said} if said else {})


def _few(items: Sequence[Any], most: int) -> list[Any]:
    return [*items[:most], *([f"and {len(items) - most} more"] if len(items) > most else [])]


def claims(session: Session, *, offset: int, limit: int) -> dict[str, Any]:
    """The prompt, marked, and how each span is judged; of version 1 it is unmarked, with the spans that the server proposes."""
    from ..worlds.claim_marks import marked_claims
    from ..worlds.claims import prompt_record
    from ..worlds.spec import CLAIM_TYPES

    world, spec = session.folder.id, session.spec
    say = f"edit_spec(world={world!r}, claims='...') with the whole prompt, marked"
    if spec.spec_version == "1":
        from ..worlds.prompts.proposals import proposal_text

        data: dict[str, Any] = {"spec_version": "1", "marked": spec.prompt, "claims_to_make": proposal_text(spec.prompt)}
        return answer(data, "a world of version 1: nothing judges the words of its prompt; claims make it version 2", say)
    told = prompt_record(spec)
    status = {r.subject[0]: r.status for r in session.ledger.rows() if r.check == "claim" and r.subject}
    spans = [s | ({"row": status[s["claim"]]} if s.get("claim") in status else {}) for s in told.pop("spans")]
    page, place = paged(spans, offset, limit)
    data = {
        "marked": marked_claims(spec),
        "spans": page,
        **{f"spans_{k}": v for k, v in place.items()},
        **told,
        "types": list(CLAIM_TYPES),
    }
    data["marks"] = (
        '[words](type target ...): targets are ids or pointers; [it](thing same_as=ball); [nicely](waived because="why nothing is judged")'
    )
    shares = ", ".join(f"{told[k]:.0%} {k}" for k in ("claimed", "filler", "waived"))
    return answer(data, f"{len(spec.claims)} claims: {shares}", _on(world, "claims", place, say))


def acceptance(session: Session, *, offset: int, limit: int) -> dict[str, Any]:
    """The last verdict with its register of approximations, and where its report and bundle are."""
    world = session.folder.id
    latest = session.ledger.acceptance()
    if latest is None:
        return answer({"acceptance": None}, "never judged", call("run_checks", world=world, scope="acceptance"))
    record = latest["record"]
    keys = ("verdict", "clauses", "weakenings", "easier_beside", "not_counted", "versions", "spec_digest", "cache_digest", "seed")
    listed, place = paged(record.get("approximations") or [], offset, limit, room=3000)
    says, judged = verdict_words(record), prompt_told(record) if "prompt" in record else {}
    told = {
        "says": says,
        **unusual_told(record),
        **{k: record.get(k) for k in keys},
        **judged,
        "revision": latest["revision"],
        "approximations": listed,
    }
    data: dict[str, Any] = {"acceptance": told, **{f"approximations_{k}": v for k, v in place.items()}}
    kinds = {"report": "html", **({"bundle": "zip"} if latest["verdict"] == "accepted" else {})}
    files = {name: session.folder.acceptance / f"{latest['freeze'][:16]}.{kind}" for name, kind in kinds.items()}
    data |= {name: session.folder.relative(path) for name, path in files.items() if path.is_file()}
    current = is_about_present(session.ledger, latest)
    then = (
        call("render_shot", world=world, kind="final")
        if latest["verdict"] == "accepted" and current
        else call("inspect_world", world=world)
    )
    warnings = [] if current else [_of_another(latest["revision"], session.revision)]
    if current and latest["revision"] != session.revision:
        warnings = [
            f"the world is at revision {session.revision} now, which differs from revision {latest['revision']} in its light or the format of its "
            "pictures at most: the verdict stands, and the film asks the rows about light anew before its first frame"
        ]
    text = f"{says}: revision {latest['revision']}, {len(record.get('approximations') or [])} approximations"
    return answer(data, text, _on(world, "acceptance", place, then), warnings)
