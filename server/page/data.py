"""Data of the page: read from world folders, ledgers and jobs, never judged here."""

from __future__ import annotations

import json
import math
import sqlite3
import time
from collections import OrderedDict
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ...workflow.standing import film_of, standing
from ...workflow.waiting import job_data
from ...worlds.errors import EvidenceError, InputError
from ...worlds.folder import WorldFolder, world_ids
from ...worlds.ledger import Ledger
from ...worlds.ledger_file import change_count
from ...worlds.patch import parse_spec
from ...worlds.requirements import Row
from .charts import ledger_charts
from .judged import OPEN_ROWS, latest_acceptance, latest_verdict, row_counts, row_line, row_status, row_text
from .pictures import SHEETS, picture_list
from .plates import plate_list, plate_picture
from .prompts import judged_prompt

if TYPE_CHECKING:
    from ...execution import Job, JobStore

__all__ = ["MAX_PAGE", "PageData", "QueryError", "job_view", "signature"]

GROUPS = ("spatial", "physical", "temporal", "observational", "delivery")
STATUSES = ("fail", "stale", "unverified", "pass", "not_applicable")
PROMPT_CHARACTERS = 280
MAX_PAGE = 200
KEPT_WORLDS = 16
"""Worlds whose rows are held in memory while they do not change."""
KEPT_SUMMARIES = 1000
PATCH_CHARACTERS = 4000


class QueryError(InputError):
    """A filter or a page that is asked for is out of range."""


Signature = tuple[tuple[int, ...], ...]


def job_view(job: Job, jobs: JobStore) -> dict[str, Any]:
    """A job with its times; a queued one says what it waits for, a running one what it does and how long it will take [s]."""
    data = job_data(job, jobs)
    data.pop("next", None)
    left = data.pop("left_s", None)
    if job.state == "running":
        data["message"] = job.message or "starting"
        if left is not None and job.heartbeat is not None:
            data["eta_s"] = round(max(0.0, left - max(0.0, time.time() - job.heartbeat)), 1)
    return data | {
        "created": job.created,
        "started": job.started,
        "finished": job.finished,
        "cancelling": job.cancel_requested is not None and not job.ended,
        "ended": job.ended,
    }


def signature(folder: WorldFolder) -> Signature:
    """Changes when anything that the page shows of a world changes; four looks at the file system."""
    found = []
    for path in (folder.spec_path, folder.ledger_path, folder.pictures, folder.acceptance, folder.root / "candidates"):
        try:
            stat = path.stat()
            # Two changes may come within one tick of the file system's clock.
            count = change_count(path) if path == folder.ledger_path else stat.st_ino
            found.append((stat.st_mtime_ns, stat.st_size, count))
        except OSError:
            found.append((0, 0, 0))
    return tuple(found)


class PageData:
    """Reads one workspace for the page. Writes nothing; safe from several threads."""

    def __init__(self, workspace: Path, jobs: Callable[[], JobStore]) -> None:
        self.workspace = workspace
        self._jobs = jobs
        self._summaries: OrderedDict[str, tuple[Signature, dict[str, Any]]] = OrderedDict()
        self._rows: OrderedDict[str, tuple[Signature, list[Row]]] = OrderedDict()

    # ---------------------------------------------------------------- jobs

    def store(self) -> JobStore | None:
        """The jobs of the workspace; None while there never was one: looking makes no file."""
        return self._jobs() if (self.workspace / ".worldagent" / "jobs.db").is_file() else None

    def jobs(self, *, world: str | None = None, offset: int = 0, limit: int = 50) -> dict[str, Any]:
        """Jobs, the newest first."""
        store = self.store()
        if store is None:
            return {"jobs": [], "offset": offset, "total": 0}
        found = store.list(world, limit=limit, offset=offset)
        return {"jobs": [job_view(j, store) for j in found], "offset": offset, "total": store.count(world)}

    def active(self) -> list[dict[str, Any]]:
        """Jobs that run or wait."""
        store = self.store()
        if store is None:
            return []
        return [job_view(j, store) for j in store.list(None, ("running", "queued"), limit=MAX_PAGE)]

    # ---------------------------------------------------------------- worlds

    def ids(self) -> list[str]:
        """Worlds of the workspace; folders that lead out of it are none of its own."""
        root = self.workspace.resolve()
        return [w for w in world_ids(self.workspace) if (root / w).resolve().parent == root]

    def worlds(self, *, query: str = "", offset: int = 0, limit: int = 50) -> dict[str, Any]:
        """Summaries of the worlds, the last changed first."""
        found = [w for w in self.ids() if query.lower() in w]
        found.sort(key=lambda w: (-max(m for m, *_ in signature(WorldFolder(self.workspace / w))), w))
        chosen = found[offset : offset + limit]
        return {"worlds": [self.summary(w) for w in chosen], "total": len(found), "offset": offset}

    def summary(self, world: str) -> dict[str, Any]:
        """A world at a glance; one that cannot be read says why.

        Raises:
            InputError: there is no such world.
        """
        now = signature(WorldFolder(self.workspace / world))
        kept = self._summaries.get(world)
        if kept is None or kept[0] != now:
            kept = (now, self._summarise(world, now))
            self._summaries[world] = kept
            while len(self._summaries) > KEPT_SUMMARIES:
                self._summaries.popitem(last=False)
        return kept[1]

    def _summarise(self, world: str, now: Signature) -> dict[str, Any]:
        data: dict[str, Any] = {"id": world, "title": world, "prompt": "", "changed": max(m for m, *_ in now) / 1e9}
        try:
            folder = WorldFolder.of(self.workspace, world)
        except EvidenceError as error:
            return data | {"problem": str(error)}
        try:
            spec = folder.read_json(folder.spec_path)
            data |= {"title": str(spec.get("title") or world), "prompt": str(spec.get("prompt", ""))}
        except (EvidenceError, AttributeError) as error:
            data["problem"] = str(error)
        data["cut"] = len(data["prompt"]) > PROMPT_CHARACTERS
        data["prompt"] = data["prompt"][:PROMPT_CHARACTERS]
        try:
            with self._ledger(folder) as ledger:
                rows = self.rows(folder)
                where = standing(folder, ledger, rows)
                data |= {
                    "revision": ledger.revision(),
                    "matrix": row_counts(rows),
                    "verdict": latest_verdict(ledger, where),
                    **where.as_data(),
                }
        except EvidenceError as error:
            data["problem"] = str(error)
        return data

    def world(self, world: str) -> dict[str, Any]:
        """Everything of a world but its rows, pictures and revisions, which come in pages.

        Raises:
            InputError: there is no such world.
            EvidenceError: its specification cannot be read.
        """
        folder = WorldFolder.of(self.workspace, world)
        spec = folder.read_json(folder.spec_path)
        plan = spec.get("simulation") or {}
        pictures = picture_list(folder, self._revisions(folder))
        data = self.summary(world) | {
            "prompt": str(spec.get("prompt", "")),
            "frames": plan.get("frames"),
            "fps": plan.get("fps"),
            "entities": len(spec.get("entities") or {}),
            "beats": _beats(spec),
            "pictures": len(pictures),
            "latest": next((p for p in pictures if p["kind"] in SHEETS), pictures[0] if pictures else None),
            "jobs": self.jobs(world=world, limit=5)["jobs"],
        }
        if "problem" in data:
            return data
        with self._ledger(folder) as ledger:
            rows = self.rows(folder)
            where = standing(folder, ledger, rows)
            open_rows = [r for r in rows if r.mandatory and r.status in ("fail", "unverified")]
            data |= {
                "open_rows": [row_line(r) for r in open_rows[:OPEN_ROWS]],
                "open_count": len(open_rows),
                "weakenings": ledger.weakenings(),
                "acceptance": latest_acceptance(folder, ledger, where),
                "judged_prompt": judged_prompt(spec, rows, pictures, partial(plate_list, folder, ledger, where)),
            }
            film = film_of(folder)
            if film is not None:
                step = where.step("rendered")
                data["film"] = {"state": step.state, "note": step.note, "bytes": film.stat().st_size, "at": film.stat().st_mtime}
        return data

    def plate(self, world: str, number: str) -> tuple[bytes, str]:
        """Picture of a plate of the present bake, and its format; errors as `plate_picture`."""
        folder = WorldFolder.of(self.workspace, world)
        spec = parse_spec(folder.read_json(folder.spec_path))
        with self._ledger(folder) as ledger:
            return plate_picture(folder, ledger, standing(folder, ledger, self.rows(folder)), spec, number)

    def rows(self, folder: WorldFolder) -> list[Row]:
        """The matrix of a world, failing rows first; read again only after the ledger changed."""
        now = signature(folder)[1:2]
        kept = self._rows.get(folder.id)
        if kept is None or kept[0] != now:
            with self._ledger(folder) as ledger:
                kept = (now, ledger.rows())
            self._rows[folder.id] = kept
            while len(self._rows) > KEPT_WORLDS:
                self._rows.popitem(last=False)
        return kept[1]

    def matrix(
        self, world: str, *, status: str = "", group: str = "", query: str = "", offset: int = 0, limit: int = 100
    ) -> dict[str, Any]:
        """A page of rows in the order of their groups, with counts per status of all that match the rest.

        Raises:
            InputError: there is no such world; QueryError: no such status or group.
        """
        for name, value, known in (("status", status, STATUSES), ("group", group, GROUPS)):
            if value and value not in known:
                raise QueryError(f"{name} {value!r} must be one of {', '.join(known)}")
        folder = WorldFolder.of(self.workspace, world)
        words = query.lower().split()
        with self._ledger(folder) as ledger:
            revision, stages = ledger.revision(), ledger.stages()
        fitting = [r for r in self.rows(folder) if all(w in row_text(r) for w in words)]
        by_status = {s: sum(row_status(r) == s and (not group or r.group == group) for r in fitting) for s in STATUSES}
        by_group = {g: sum(r.group == g and (not status or row_status(r) == status) for r in fitting) for g in GROUPS}
        chosen = [r for r in fitting if (not status or row_status(r) == status) and (not group or r.group == group)]
        rank = {s: k for k, s in enumerate(STATUSES)}
        worst = {g: min((rank[row_status(r)] for r in chosen if r.group == g), default=len(rank)) for g in GROUPS}
        # Groups with failures come first; a group's own rows go from worst to best.
        order = {g: k for k, g in enumerate(sorted(GROUPS, key=lambda g: (worst[g], GROUPS.index(g))))}
        chosen.sort(key=lambda r: (order[r.group], rank[row_status(r)], not r.mandatory, r.id))
        return {
            "world": world,
            "revision": revision,
            "rows": [row_line(r) | {"stage": stages.get(r.id, "")} for r in chosen[offset : offset + limit]],
            "total": len(chosen),
            "offset": offset,
            "by_status": by_status,
            "by_group": by_group,
        }

    def row(self, world: str, row_id: str) -> dict[str, Any]:
        """One row in full, with its past.

        Raises:
            InputError: there is no such world or row.
        """
        folder = WorldFolder.of(self.workspace, world)
        found = next((r for r in self.rows(folder) if r.id == row_id), None)
        if found is None:
            raise InputError(f"there is no row {row_id!r} in {world!r}; the matrix lists them")
        with self._ledger(folder) as ledger:
            return {"row": found.model_dump(mode="json") | {"shown": row_status(found)}, "history": ledger.history(found.id)}

    def revisions(self, world: str, *, offset: int = 0, limit: int = 25) -> dict[str, Any]:
        """Edits, the newest first, patches cut to a readable length.

        Raises:
            InputError: there is no such world.
        """
        folder = WorldFolder.of(self.workspace, world)
        with self._ledger(folder) as ledger:
            total = ledger.revision()
            found = ledger.revisions(limit, offset)
            attempts = {i["revision"]: i for i in ledger.iterations(limit=200)}
        for revision in found:
            text = json.dumps(revision["patch"], ensure_ascii=False, indent=1)
            revision["patch"] = text[:PATCH_CHARACTERS]
            revision["patch_left"] = max(0, len(text) - PATCH_CHARACTERS)
            if (attempt := attempts.get(revision["n"])) is not None:
                failing = attempt["failing_after"]
                revision["attempt"] = {
                    "failing_before": attempt["failing_before"] or [],
                    "failing_after": failing,
                    "test": attempt["probe"],
                }
        return {"revisions": found, "total": total, "offset": offset}

    def pictures(self, world: str, *, offset: int = 0, limit: int = 24) -> dict[str, Any]:
        """Pictures, the newest first.

        Raises:
            InputError: there is no such world.
        """
        folder = WorldFolder.of(self.workspace, world)
        found = picture_list(folder, self._revisions(folder))
        return {"pictures": found[offset : offset + limit], "total": len(found), "offset": offset}

    def charts(self, world: str) -> dict[str, Any]:
        """Recorded quantities over time.

        Raises:
            InputError: there is no such world.
            EvidenceError: nothing was simulated.
        """
        folder = WorldFolder.of(self.workspace, world)
        with self._ledger(folder) as ledger:
            return ledger_charts(folder, ledger)

    def _revisions(self, folder: WorldFolder) -> tuple[int, dict[str, int]]:
        """The present revision, and the revision of each freeze by the first letters of its hash."""
        try:
            with self._ledger(folder) as ledger:
                return ledger.revision(), {f["freeze"][:8]: f["revision"] for f in ledger.freezes(500)}
        except EvidenceError:
            return 0, {}

    @contextmanager
    def _ledger(self, folder: WorldFolder) -> Iterator[Ledger]:
        """The ledger of a world; looking makes no file.

        Raises:
            EvidenceError: it is missing or damaged.
        """
        if not folder.ledger_path.is_file():
            raise EvidenceError(f"world {folder.id!r} has no ledger: nothing was recorded about it")
        try:
            yield Ledger(folder.ledger_path)
        except (sqlite3.Error, ValueError, KeyError) as error:
            raise EvidenceError(f"the ledger of {folder.id!r} cannot be read: {error}") from error


def _beats(spec: Mapping[str, Any]) -> list[dict[str, Any]]:
    beats = (spec.get("story") or {}).get("beats") or {}
    found = [{"id": k, "text": str(b.get("text", "")), "frames": b.get("frames")} for k, b in beats.items()]
    return sorted(found, key=lambda b: (b["frames"] or [math.inf], b["id"]))
