"""Honest worlds walked to their verdict, and every trick on them judged: was it given away by the row or line that its case names?"""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Container, Iterable, Iterator, Mapping
from dataclasses import dataclass
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Literal

from .agent import WORLD, Agent, Walk
from .cases import Case, Twin

__all__ = ["Judged", "Outcome", "given_away", "groups", "judged_group", "walked_whole"]

Outcome = Literal["caught", "accepted", "otherwise", "no twin"]
"""`otherwise`: refused, but by nothing that the case names; `no twin`: its honest world was refused."""


@dataclass(frozen=True)
class Judged:
    """Outcome of a case, or of a twin."""

    name: str
    mechanism: str
    """Empty for a twin."""
    outcome: Outcome | Literal["refused"]
    """`accepted` or `refused`, of a twin."""
    reached: str
    told: str
    """Row or line that gave it away, or what was said instead."""
    seconds: float


def groups(mechanisms: Mapping[str, Iterable[Case]]) -> dict[str, list[tuple[str, Case]]]:
    """Cases with their mechanism, by the scene of their twins: those share frames."""
    found: dict[str, list[tuple[str, Case]]] = {}
    for mechanism, cases in mechanisms.items():
        for case in cases:
            found.setdefault(case.twin.scene.__name__, []).append((mechanism, case))
    return found


def walked_whole(mechanisms: Mapping[str, Iterable[Case]]) -> frozenset[str]:
    """The first case of every mechanism that a line gives away: it is walked to its verdict, to see the line there."""
    firsts = (next((c for c in cases if not c.row and c.act is None), None) for cases in mechanisms.values())
    return frozenset(c.id for c in firsts if c is not None)


def judged_group(cases: Iterable[tuple[str, Case]], whole: Container[str] = ()) -> Iterator[Judged]:
    """All twins of one scene, each with its cases.

    Args:
        cases: with their mechanisms.
        whole: cases that are walked to their verdict though a line about the prompt is known since their creation.
    """
    by_twin: dict[str, list[tuple[str, Case]]] = {}
    for mechanism, case in cases:
        by_twin.setdefault(case.twin.name, []).append((mechanism, case))
    first: Path | None = None
    with tempfile.TemporaryDirectory(prefix="worldagent-dishonest-") as root:
        for name, own in by_twin.items():
            agent = Agent(Path(root) / name)
            walk = _twin(agent, own[0][1].twin, first)
            yield Judged(name, "", "accepted" if walk.accepted else "refused", walk.reached, _said(walk), walk.seconds)
            first = first or (agent.folder.root if walk.accepted else None)
            for mechanism, case in own:
                if not walk.accepted:
                    yield Judged(case.id, mechanism, "no twin", "", "", 0.0)
                    continue
                yield _case(Path(root) / "case", agent, walk, (mechanism, case), whole=case.id in whole)


def _twin(agent: Agent, twin: Twin, motion_of: Path | None) -> Walk:
    agent.workspace.mkdir()
    return agent.walk(twin.prompt, twin.marked, twin.document(), motion_of=motion_of)


def _case(workspace: Path, honest: Agent, twin: Walk, of: tuple[str, Case], *, whole: bool) -> Judged:
    """One case in a workspace of its own, which is deleted."""
    mechanism, case = of
    try:
        if case.act is not None:
            shutil.copytree(honest.workspace, workspace)
            answer = case.act(Agent(workspace, honest.verdict))
            caught = any(text in answer for text in case.says.split("|"))
            return Judged(case.id, mechanism, "caught" if caught else "accepted", "act", answer[:300], 0.0)
        workspace.mkdir()

        def known(walk: Walk) -> bool:
            return not whole and not case.row and bool(given_away(case, walk, twin))

        walk = Agent(workspace).walk(*case.given(), motion_of=honest.workspace / WORLD, enough=known)
        told = given_away(case, walk, twin)
        outcome: Outcome = "caught" if told else "accepted" if walk.accepted else "otherwise"
        return Judged(case.id, mechanism, outcome, walk.reached, told or _said(walk), walk.seconds)
    finally:
        shutil.rmtree(workspace, ignore_errors=True)


def given_away(case: Case, walk: Walk, twin: Walk) -> str:
    """The row or line that a case names, where it is there and the twin lacks it; else nothing."""
    says = case.says.lower().split("|")
    if case.row:
        for row, text in walk.rows:
            if any(fnmatchcase(row, pattern) for pattern in case.row.split("|")) and any(s in text.lower() for s in says):
                return f"{row}: {text}"[:300]
        return ""
    return next((line[:300] for line in walk.lines if line not in twin.lines and any(s in line.lower() for s in says)), "")


def _said(walk: Walk) -> str:
    """Everything open, in short."""
    return "; ".join([*(f"{row}: {text}"[:160] for row, text in walk.rows[:4]), *(walk.lines[:2] if not walk.rows else ())])[:500]
