"""Plates: pictures that show whether the subjects of a story are seen in the light of the film (R24, R98).

The verifiers say which are wanted and read them (`verifiers/shots/`); here they are rendered, as far as their time allows.
"""

from __future__ import annotations

import secrets
import shutil
import time
from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from ..worlds.errors import EngineError, EvidenceError, InputError, RefusedError
from ..worlds.plates import Plate, Plates, View, plate_size, plates_folder
from ..worlds.provenance import recipes

if TYPE_CHECKING:
    from pathlib import Path

    from ..execution import Tell
    from ..rendering import FrameRenderer
    from ..worlds.arrays import U8
    from ..worlds.candidate import Candidate
    from .session import Session

__all__ = ["AT_ACCEPTANCE", "SAMPLES", "allowed_seconds", "depart", "make_plates", "plates_anywhere", "require_seen"]

SAMPLES = 16
"""[paths/pixel] Own choice: the default of a film, whose light is to be judged; its noise is measured, and more would only lower it."""
SHARE_OF_BAKE = 0.1
"""[1] Own choice: part of a bake's time that looking at it may take."""
LEAST_S = 60.0
"""[s] Own choice: however short the bake; two cores load a scene and take all plates of a small world in it. One more call goes on."""
AT_ACCEPTANCE = 2.0
"""[1] Own choice: times as long where an acceptance looks, so that it renders what a check had no time for: without a plate it is wasted."""
NAMED = 8
"""Open rows that a refusal names."""
DEPARTURE = 0.05
"""[1] Own choice: share of a subject's pixels that may differ by more than noise when the program that made a plate renders it again: it
gives the same bytes. Another program or variant gives other noise and other edges; there `SEEN_SHARE` is the bound."""


def allowed_seconds(bake: dict[str, Any] | None) -> float:
    """Time that plates of a bake may take [s].

    Args:
        bake: its record in the ledger.
    """
    spent = 0.0 if bake is None else float(bake["detail"].get("seconds", 0.0))
    return max(LEAST_S, SHARE_OF_BAKE * spent)


def make_plates(
    candidate: Candidate,
    *,
    seconds: float,
    progress: Tell | None = None,
    check: Callable[[], None] = lambda: None,
    distrust: bool = False,
) -> Plates:
    """The plates that a candidate needs, those that are missing or stale rendered.

    Args:
        candidate: a complete bake.
        seconds: time that rendering may take; one plate is rendered in any case.
        progress: told of every plate.
        check: called before every plate; raises where the job is cancelled.
        distrust: render one of the plates that are there again, and all where it departs.
    """
    from ..verifiers.shots.wanted import wanted

    clock, folder = _Clock(seconds, progress, check), plates_folder(candidate)
    try:
        plan = wanted(candidate)
    except EvidenceError as error:  # the rows of the shot plan say it too
        made = _empty(candidate, {})
        return _left(made, folder, {b.subject: str(error) for b in candidate.spec.story.beats.values()})
    try:
        made = _kept(candidate, folder, plan.views)
        renderer = _Lazy(candidate)
        if distrust and made.views and depart(candidate, made, secrets.choice(made.views), renderer):
            made = _fresh(made, folder)
        return _taken(made, folder, plan.views, renderer, clock)
    except (EngineError, ImportError, RuntimeError) as error:  # Mitsuba and its compiler raise plain ones
        return _left(_empty(candidate, {}), folder, {v.subject: f"no renderer: {error}" for v in plan.views})


class _Lazy:
    """The renderer of one candidate, its scene loaded at the first plate."""

    def __init__(self, candidate: Candidate) -> None:
        self.candidate = candidate
        self._renderer: FrameRenderer | None = None

    def __call__(self) -> FrameRenderer:
        from ..rendering import FrameRenderer

        self._renderer = self._renderer or FrameRenderer(self.candidate)
        return self._renderer


class _Clock:
    """When to stop, and whom to tell.

    What counts is the time on the wall or that of the processors, the lesser: beside other work a plate takes several times as long, and
    rows must not stay open for that.
    """

    def __init__(self, seconds: float, progress: Tell | None, check: Callable[[], None]) -> None:
        self._seconds, self._wall, self._worked = seconds, time.monotonic(), time.process_time()
        self.progress, self.check = progress, check

    def over(self) -> bool:
        """True once the time is spent."""
        return min(time.monotonic() - self._wall, time.process_time() - self._worked) > self._seconds


def _taken(made: Plates, folder: Path, views: tuple[View, ...], renderer: _Lazy, clock: _Clock) -> Plates:
    """The plates with those that are missing, as far as the time goes."""
    left, rendered = dict[str, str](), 0
    for place, view in enumerate(views):
        if view in made.views:
            continue
        clock.check()
        if rendered and clock.over():
            left |= {v.subject: "the time for plates was over" for v in views[place:] if v not in made.views}
            break
        if clock.progress is not None:
            clock.progress(
                place, len(views), f"looking at {view.subject} in the light of the film" if rendered else "loading the scene"
            )
        try:
            plate = renderer().plate(view, size=made.size, samples=made.samples)
        except InputError as error:
            left[view.subject] = str(error)
            continue
        made, rendered = made.added(folder, view, plate), rendered + 1
    return _left(made, folder, left)


def _left(made: Plates, folder: Path, left: dict[str, str]) -> Plates:
    found = replace(made, left=left)
    found.write(folder)
    return found


def _empty(candidate: Candidate, renderer: dict[str, str]) -> Plates:
    look = candidate.spec.look
    return Plates(recipes(candidate.spec)["seen"], candidate.digest, renderer, plate_size(look), SAMPLES)


def _fresh(made: Plates, folder: Path) -> Plates:
    """The same without any plate; what was there is deleted."""
    shutil.rmtree(folder, ignore_errors=True)
    return replace(made, views=(), digests=(), left={})


def _kept(candidate: Candidate, folder: Path, views: tuple[View, ...]) -> Plates:
    """Plates that are there and still hold; none where one of them is damaged, stale or no longer wanted."""
    from ..rendering import renderer_versions

    wanted = _empty(candidate, renderer_versions())
    try:
        found = Plates.open(folder)
        if found is not None and found.same_making(wanted) and set(found.views) <= set(views):
            for view in found.views:
                found.read(folder, view)
            return found
    except EvidenceError:
        pass
    return _fresh(wanted, folder)


def require_seen(session: Session, freeze: str, candidate: Candidate, check: Callable[[], None]) -> None:
    """Judge by the present look and its plates, made anew where they are stale, and record it.

    Raises:
        RefusedError: a subject is not seen, or not as the prompt says, or was not looked at.
    """
    from ..verifiers.checks import lit_rows

    make_plates(candidate, seconds=allowed_seconds(session.ledger.bake(freeze)), check=check)
    rows = session.cited(lit_rows(candidate))
    session.record(rows, stage="full")
    left = [r for r in rows if r.mandatory and r.status in ("fail", "unverified")]
    if left:
        lines = [f"  {r.id}: {r.status}, {r.evidence.get('explanation', '')}" for r in left[:NAMED]]
        raise RefusedError(
            f"the film would not show its story: {len(left)} subjects are not seen in this light, or not as the prompt says. Mend them with edit_spec, "
            "then run_checks(scope='full'):\n" + "\n".join(lines)
        )


def plates_anywhere(root: Path) -> None:
    """Make the plates that a world folder lacks, without a server; nothing where it has no complete bake."""
    from ..verifiers.acceptance import find_candidate
    from ..worlds.candidate import open_candidate
    from ..worlds.folder import WorldFolder
    from ..worlds.patch import parse_spec

    folder = WorldFolder(root)
    try:
        spec = parse_spec(folder.read_json(folder.spec_path))
        candidate = open_candidate(folder, find_candidate(folder, spec), "full")
    except (RefusedError, EvidenceError):  # whoever judges the folder says so
        return
    make_plates(candidate, seconds=LEAST_S)


def depart(candidate: Candidate, plates: Plates, view: View, renderer: Callable[[], FrameRenderer] | None = None) -> bool:
    """True where a plate, rendered again here, is another picture: more of its subject's pixels differ than noise explains.

    A plate of this program may differ in `DEPARTURE` of them. One that says that another program or variant made it may differ in
    `SEEN_SHARE`, as many as make a subject seen, and must not show a subject that is not seen here.

    Args:
        renderer: makes the picture here; the candidate's own where it is None.

    Raises:
        EvidenceError: it is damaged.
        EngineError: nothing can be rendered here.
    """
    from ..rendering import renderer_versions
    from ..verifiers.shots.bounds import SEEN_SHARE
    from ..verifiers.shots.difference import compared
    from ..verifiers.shots.sight import sight_of

    there = plates.read(plates_folder(candidate), view)
    mask = sight_of(candidate).mask(view.subject, view.shot, view.frame, plates.size).visible
    if not mask.any():
        return False
    here = (renderer or _Lazy(candidate))().plate(view, size=plates.size, samples=plates.samples)

    def share(shown: U8, bare: U8) -> float:
        return float(compared(Plate(shown, bare)).differs[mask].mean())

    apart = max(share(a, b) for a, b in zip(there, here, strict=True))
    if dict(plates.renderer) == renderer_versions():
        return apart > DEPARTURE
    return apart > SEEN_SHARE or share(*here) < SEEN_SHARE <= share(*there)
