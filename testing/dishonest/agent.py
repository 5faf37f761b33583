"""An agent that calls the server's tools in this process, and walks a world from its prompt to the verdict."""

from __future__ import annotations

import shutil
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any

from ...execution import Job, JobStore, Terms, run_inline
from ...tools import TOOLS
from ...workflow.context import ToolContext
from ...worlds.canonical import digest_of
from ...worlds.claims import prompt_record
from ...worlds.errors import WorldAgentError
from ...worlds.folder import WorldFolder
from ...worlds.ledger import Ledger
from ...worlds.patch import parse_spec
from ...worlds.slices import motion_slice

__all__ = ["WORLD", "Agent", "Walk"]

WORLD = "w"
STEPS: tuple[tuple[str, str, dict[str, Any]], ...] = (
    ("place_object", "static_passed", {}),
    ("probe_sim", "passed", {"wait_s": 600.0}),
    ("bake_sim", "passed", {"wait_s": 600.0}),
)
"""Tools between audit and acceptance, the field of the answer that says that it let the world through, arguments."""


class InlineJobs(JobStore):
    """Jobs that run within the call that submits them: the same entries and results, without a process each."""

    def submit(self, kind: str, world: str | None, payload: dict[str, Any], *, entry: str, terms: Terms = Terms()) -> Job:  # noqa: B008 - frozen
        """Run the job; its errors are those of the entry."""
        began = time.time()
        result = run_inline(entry, payload, workspace=self.workspace)
        known = {"id": "job_000000000000", "kind": kind, "world": world, "entry": entry, "payload": payload, "key": terms.key}
        done = {"state": "done", "result": result, "created": began, "started": began, "finished": time.time(), "message": ""}
        return Job(**{f.name: None for f in fields(Job)} | known | done)  # type: ignore[arg-type]

    def latest(self, kind: str, world: str | None, key_start: str) -> Job | None:
        """None: no job is remembered."""
        return None

    def warm_up(self, module: str) -> bool:
        """False: nothing waits for jobs."""
        return False


@dataclass
class Walk:
    """The stage that a world came to, and what was said of it."""

    reached: str
    """The tool that let it go no further, or `accepted`."""
    rows: tuple[tuple[str, str], ...] = ()
    """Open mandatory rows, and what each says."""
    lines: tuple[str, ...] = ()
    """Text of a verdict: its words, warnings, filler, waivers, weakenings and approximations; else the refusal."""
    seconds: float = 0.0
    """Processor time of this process [s]."""

    @property
    def accepted(self) -> bool:
        """True where the verdict was `accepted`, in whatever words."""
        return self.reached == "accepted"


@dataclass
class Agent:
    """A client of one workspace with at most one world."""

    workspace: Path
    verdict: dict[str, Any] = field(default_factory=dict)
    """Answer of the latest acceptance."""

    @property
    def folder(self) -> WorldFolder:
        """The world's folder."""
        return WorldFolder(self.workspace / WORLD)

    def call(self, tool: str, **arguments: Any) -> dict[str, Any]:
        """Data of a tool's reply; raises what the tool raises."""
        context = ToolContext(self.workspace, InlineJobs(self.workspace), lambda *_: None, lambda: False)
        function = next(b.function for b in TOOLS if b.name == tool)
        return function(context, world=WORLD, **arguments).data

    def walk(
        self,
        prompt: str,
        marked: str | None,
        document: dict[str, Any],
        *,
        motion_of: Path | None = None,
        enough: Callable[[Walk], object] = lambda _: None,
    ) -> Walk:
        """Take a world from its creation to its verdict, as far as the server lets it go.

        Args:
            prompt: of the user.
            marked: the prompt with its claims.
            document: specification.
            motion_of: folder of an accepted world; where its settings are equal, its frames are taken over and only judged anew.
            enough: of what the audit has let through, with the lines that a verdict would have of its prompt: true ends the walk there.
        """
        began = time.process_time()
        try:
            found = self._walk(prompt, marked, document, motion_of, enough)
        except WorldAgentError as error:
            found = Walk("refused", self.open_rows("fail"), (str(error),))
        found.seconds = time.process_time() - began
        return found

    def _walk(
        self, prompt: str, marked: str | None, document: dict[str, Any], motion_of: Path | None, enough: Callable[[Walk], object]
    ) -> Walk:
        claims = {} if marked is None else {"claims": marked}
        if not self.call("edit_spec", prompt=prompt, spec=document, **claims)["audit"]["passed"]:
            return Walk("edit_spec", self.open_rows())
        spec = parse_spec(self.folder.read_json(self.folder.spec_path))
        audited = Walk("audited", (), tuple(prompt_lines(prompt_record(spec) if spec.spec_version == "2" else {})))
        if enough(audited):
            return audited
        if motion_of is not None:
            self._take_over(motion_of)
        for tool, passed, more in STEPS:
            if not self.call(tool, **more)[passed]:
                return Walk(tool, self.open_rows("fail"))
        self.verdict = self.call("run_checks", scope="acceptance", wait_s=600.0)
        reached = "accepted" if self.verdict["verdict"] == "accepted" else "run_checks"
        known = Ledger(self.folder.ledger_path).acceptance() or {"record": {}}
        return Walk(reached, self.open_rows(), (*prompt_lines(known["record"].get("prompt", {})), *lines_of(self.verdict)))

    def _take_over(self, other: Path) -> None:
        """Copy frames and plates of a world that moves alike."""
        mine, theirs = (parse_spec(WorldFolder(f).read_json(WorldFolder(f).spec_path)) for f in (self.folder.root, other))
        if digest_of(motion_slice(mine)) == digest_of(motion_slice(theirs)):
            shutil.copytree(other / "candidates", self.folder.root / "candidates")

    def open_rows(self, *statuses: str) -> tuple[tuple[str, str], ...]:
        """Mandatory rows of the ledger of these statuses, all that are open where none is given.

        Before the bake much is unverified that no trick has to do with.
        """
        if not self.folder.ledger_path.is_file():
            return ()
        rows = [
            r for r in Ledger(self.folder.ledger_path).rows() if r.mandatory and r.status in (statuses or ("fail", "unverified"))
        ]
        return tuple(
            (r.id, " ".join([str(r.evidence.get("explanation", "")), *map(str, r.evidence.get("problems", ()))])) for r in rows
        )


def prompt_lines(prompt: Mapping[str, Any]) -> list[str]:
    """Lines of a verdict about the words of a prompt: warnings, language, filler, waivers, readings of the agent.

    Args:
        prompt: see `prompt_record`; the acceptance keeps it as it is.
    """
    found = [*map(str, prompt.get("warnings", ())), f"language {prompt.get('language')}"]
    found += [f"filler: {t}" for t in prompt.get("filler_texts", ())]
    found += [f"waived: {quote}: {why}" for quote, why in prompt.get("waivers", {}).items()]
    return found + [f"reading: {quote}" for quote in prompt.get("readings", {})]


def lines_of(verdict: Mapping[str, Any]) -> list[str]:
    """Lines of an acceptance about all else: its words, what is unusual, weakenings and approximations."""
    found = [str(verdict["says"]), *(f"weakening: {w}" for w in verdict.get("weakenings", ()))]
    found += [f"unusual: {line}" for line in verdict.get("unusual", ())]
    return found + [f"{a['what']}: {a['effect']}" for a in verdict.get("approximations", ())]
