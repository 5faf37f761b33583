"""Corrections applied to the worlds they are made for: does the audit take the edit, does the row get better, does anything else fail?

Broken worlds are of three kinds: those of the suites of seeded defects, judged by the suite's check; the flaws of `skills/repair`, and the
wrong edits of recorded worlds, which are built, simulated and judged as a probe. A row of a seeded world that fails before anything moves
is judged without motion; one of motion that was written by hand is simulated first without an edit: where it passes then, the recording was wrong, and
nothing but baking again helps.
"""

from __future__ import annotations

import json
import random
import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

import numpy as np

from ..bench.skill_repair import cases, flawed
from ..bench.wrong_edits import WrongEdit
from ..construction import build_world, built_paths
from ..construction.build import build_entity
from ..server.skill_files import SKILLS
from ..simulation.freeze import open_freeze
from ..simulation.probe import run_probe
from ..verifiers.checks import run_checks
from ..verifiers.diagnosis.cite import MIN_EFFECT
from ..worlds.audits.audit import audit
from ..worlds.candidate import Candidate
from ..worlds.canonical import spec_digest
from ..worlds.errors import WorldAgentError
from ..worlds.folder import WorldFolder
from ..worlds.patch import apply_patch, parse_spec, weakenings
from ..worlds.requirements import Correction, Row
from ..worlds.spec import WorldSpec
from .defects.cases import Mechanism
from .defects.suites import suite_of

__all__ = ["Broken", "Outcome", "Tried", "flaw", "outcome_of", "seeded", "try_corrections", "wrong_edit"]

Outcome = Literal["helps", "eases", "refused", "audit", "same", "worse", "breaks", "needless", "words"]
"""`helps`: the audit takes it, the row passes or comes nearer to its bound, nothing else fails newly. `eases`: so too, by asking for less.
`needless`: the row passes without it once the world is simulated anew. `words`: it carries no patch, and was not tried."""
AGAIN = re.compile(r"[Bb]ake(_sim)? again|call bake_sim|[Cc]onstruct .* again")
"""Actions that ask for the same work once more, and not for an edit."""
ANEW = "simulated or built anew it passes"
STILL = ("scale", "interpenetration", "support", "relations")
"""Checks that are judged after an edit of the scene, beside the row's own."""
SEED = 1

Judge = Callable[[WorldSpec, Row, Correction], Sequence[Row]]
"""Rows of a world under a specification, judged in the way that a row and a correction of it call for."""


@dataclass(frozen=True)
class Tried:
    """One correction of a failing row, and what came of it."""

    world: str
    check: str
    row: str
    frame: int | None
    """First failing frame."""
    group: str
    cause: str
    action: str
    outcome: Outcome
    why: str = ""
    """The audit that refused it, rows that fail newly, or the row's measured value before and after."""

    @property
    def recording(self) -> bool:
        """True if it shows that the recording was wrong, and not the specification."""
        return self.outcome == "needless" or (self.outcome == "helps" and self.why == ANEW)

    @property
    def useless(self) -> bool:
        """True if it carries an edit that does not help."""
        return self.outcome not in ("helps", "words") and not self.recording


@dataclass(frozen=True)
class Broken:
    """A broken world with its failing rows."""

    name: str
    spec: WorldSpec
    rows: tuple[Row, ...]
    judge: Judge


def try_corrections(world: Broken) -> Iterator[Tried]:
    """Every correction of every failing row of a world, tried on the world as it was; a row without corrections gives one that says so."""
    standing = {r.id for r in audit(world.spec).rows if r.mandatory and r.status == "fail"}
    for row in world.rows:
        for correction in _offered(world, row):
            outcome, why = _tried(world, row, correction, standing)
            yield _as(world, row, correction, outcome, why)
        if not row.corrections:
            yield Tried(world.name, row.check, row.id, row.first_failing_frame, "", "", "", "words", "it carries no correction")


def _offered(world: Broken, row: Row) -> tuple[Correction, ...]:
    """Corrections of a row, and those of the row that it follows and tells to mend first."""
    first = next((r for r in world.rows if r.id == row.evidence.get("follows") and r.id != row.id), None)
    known = [c.patch for c in row.corrections]
    more = () if first is None else tuple(c for c in first.corrections if c.patch and c.patch not in known)
    return (*row.corrections, *more)


def _as(world: Broken, row: Row, correction: Correction, outcome: Outcome, why: str) -> Tried:
    told = (correction.group, correction.cause, correction.action)
    return Tried(world.name, row.check, row.id, row.first_failing_frame, *told, outcome, why)


def _tried(world: Broken, row: Row, correction: Correction, standing: set[str]) -> tuple[Outcome, str]:
    again = not correction.patch and bool(AGAIN.search(correction.action))
    if not correction.patch and not again:
        return "words", ""
    try:
        after = apply_patch(world.spec, correction.patch) if correction.patch else world.spec
    except WorldAgentError as error:
        return "refused", str(error)[:200]
    fresh = [r.id for r in audit(after).rows if r.mandatory and r.status == "fail" and r.id not in standing]
    if fresh:
        return "audit", ", ".join(fresh[:3])
    try:
        now = world.judge(after, row, correction)
        before = world.rows if again else world.judge(world.spec, row, correction)
    except WorldAgentError as error:
        return "refused", f"{type(error).__name__}: {error}"[:200]
    easier = bool(weakenings(world.spec, after)) if correction.patch else False
    return outcome_of(row, before, now, again=again, easier=easier)


def outcome_of(row: Row, before: Iterable[Row], now: Iterable[Row], *, again: bool, easier: bool) -> tuple[Outcome, str]:
    """Outcome of one correction, and why.

    Args:
        row: which it is made for.
        before: rows of the world as it is, judged anew in the same way.
        now: rows after the edit.
        again: it asks for another run of the same specification, and not for an edit.
        easier: it asks for less than before.
    """
    was, is_now = ({r.id: r for r in rows if r.mandatory} for rows in (before, now))
    open_before = {n for n, r in was.items() if r.status == "fail"}
    if row.id not in open_before:
        return "needless", ANEW
    asked = {r.check for r in was.values()}
    later = any(r.first_failing_frame for r in was.values())
    broken = [
        n
        for n, r in is_now.items()
        if r.status == "fail" and n not in open_before and r.check in asked and (later or not r.first_failing_frame)
    ]
    if broken and not again:
        return "breaks", ", ".join(broken[:3])
    old, new = was.get(row.id, row), is_now.get(row.id)
    if new is None or new.status != "fail":
        return ("eases" if easier else "helps"), ANEW if again else ""
    told = f"{_told(old)} before, {_told(new)} after"
    if None in (old.measured, old.bound, new.measured, new.bound):
        return "same", told
    far, near = (abs(float(r.measured or 0.0) - float(r.bound or 0.0)) for r in (old, new))
    if near <= (1.0 - MIN_EFFECT) * far:
        return ("eases" if easier else "helps"), told
    return ("worse" if near > (1.0 + MIN_EFFECT) * far else "same"), told


def _told(row: Row) -> str:
    return "no number" if row.measured is None else f"{row.measured:.4g} {row.unit}"


# ---------------------------------------------------------------- worlds


def simulated(folder: Path, spec: WorldSpec) -> Candidate:
    """The probe of a specification, built and simulated in a new folder.

    Raises:
        WorldAgentError: it cannot be built or simulated.
    """
    world = WorldFolder(folder)
    world.assets.mkdir(parents=True)
    built, _ = build_world(world, spec)
    return run_probe(world, open_freeze(world, spec, built, built_paths(world, spec), 1))


def seeded(check: str, mechanism: Mechanism, folder: Path) -> Broken:
    """The first hand-picked world of a mechanism of a suite, with the failing rows of its check."""
    made = mechanism.build(folder, mechanism.hand_picked[0], np.random.default_rng(SEED)).candidate
    name = mechanism.check or suite_of(check).check
    rows = [r for r in run_checks(made, only=[name]) if r.mandatory and r.status == "fail"]
    return Broken(f"{check}/{mechanism.name}", made.spec, tuple(rows), _Seeded(made, name, folder))


class _Seeded:
    """Judges a seeded world under other specifications, each once."""

    def __init__(self, given: Candidate, check: str, folder: Path) -> None:
        self.given, self.check, self.folder = given, check, folder
        self.known: dict[tuple[str, str], list[Row]] = {}

    def __call__(self, spec: WorldSpec, row: Row, correction: Correction) -> list[Row]:
        if not correction.patch:
            return self._rows(spec, "built" if self.given.stage == "static" else "simulated")
        if self.given.stage == "static" or self._still_fails(row):
            return self._rows(spec, "still")
        moves = correction.edit_class in ("scene", "solver") and correction.group != "relations"
        return self._rows(spec, "simulated" if moves else "kept")

    def _still_fails(self, row: Row) -> bool:
        return any(r.id == row.id and r.mandatory and r.status == "fail" for r in self._rows(self.given.spec, "still"))

    def _rows(self, spec: WorldSpec, way: str) -> list[Row]:
        key = (spec_digest(spec), way)
        if key not in self.known:
            checks = [self.check, *(STILL if way in ("still", "built") else ())]
            self.known[key] = run_checks(self._candidate(spec, way), only=checks)
        return self.known[key]

    def _candidate(self, spec: WorldSpec, way: str) -> Candidate:
        if way == "simulated":
            return simulated(self.folder / f"again{len(self.known)}", spec)
        old, built = self.given.spec, dict(self.given.built)
        for name, entity in spec.entities.items():
            had = old.entities.get(name)
            if way == "built" or had is None or entity.model_copy(update={"pose": had.pose, "dimensions": had.dimensions}) != had:
                built[name] = build_entity(spec, name, self.folder / "assets")
        if way in ("still", "built"):
            return Candidate(self.folder, spec, built, "static")
        return replace(self.given, spec=spec, built=built)


def probed(name: str, spec: WorldSpec, folder: Path) -> Broken:
    """A specification as a probe judges it: the rows of its audit, else of its static checks, else of its simulation."""
    judge = _Probed(folder)
    rows = [r for r in judge.rows(spec) if r.mandatory and r.status == "fail"]
    return Broken(name, spec, tuple(rows), judge)


class _Probed:
    """Judges specifications from nothing, each once; those that fail before anything moves are not simulated."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.known: dict[str, list[Row]] = {}

    def __call__(self, spec: WorldSpec, row: Row, correction: Correction) -> list[Row]:
        return self.rows(spec)

    def rows(self, spec: WorldSpec) -> list[Row]:
        """Rows of a specification."""
        key = spec_digest(spec)
        if key not in self.known:
            self.known[key] = self._judged(spec, self.folder / f"w{len(self.known)}")
        return self.known[key]

    def _judged(self, spec: WorldSpec, folder: Path) -> list[Row]:
        world = WorldFolder(folder / "still")
        world.assets.mkdir(parents=True)
        built, _ = build_world(world, spec)
        still = run_checks(Candidate(world.root, spec, built, "static"))
        if any(r.mandatory and r.status == "fail" and r.check != "shots" for r in still):
            return still
        return run_checks(simulated(folder / "moving", spec), reruns=False)


def flaw(name: str, folder: Path) -> Broken:
    """A flawed world of `skills/repair`, its magnitude drawn by a fixed seed."""
    data = cases()
    spec = flawed(data, name, random.Random(f"{name} {SEED}"))
    return probed(f"flaws/{name}", parse_spec({**spec, "prompt": data["worlds"][data["flaws"][name]["world"]]["prompt"]}), folder)


def wrong_edit(edit: WrongEdit, folder: Path) -> Broken:
    """A recorded world with an edit that spoils it."""
    document = json.loads((SKILLS / f"{edit.world}.json").read_text())
    patch = [
        {"op": "replace" if p.rpartition("/")[2].isdigit() else "add", "path": p, "value": v} for p, v in edit.values.items()
    ]
    return probed(f"edits/{edit.world}: {edit.wrong}", apply_patch(parse_spec(document), patch), folder)
