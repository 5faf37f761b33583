"""Subjects seen in the light of the film (`shots:seen:<beat>`): plates of the bake, with and without each, compared pixel by pixel.

The pixels of a subject come from the verifiers' own rays, their colours from the plates, which `workflow/` has rendered: nothing is
rendered here. A plate counts only for the caches and the look that it was made from.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ...worlds.errors import EvidenceError
from ...worlds.plates import MOST_PLATES, SEEDS, Plates, View, plate_size, plates_folder
from ...worlds.provenance import recipes
from ..categories.registry import judge_of
from ..rows.corrections import correction
from ..rows.findings import Finding
from .bounds import BRIGHT, DARK, JUST_NOTICEABLE, SEEN_NOISE, SEEN_PIXELS, SEEN_SHARE
from .difference import Difference, compared, lab, linear
from .plan import shot_row
from .questions import SEEN
from .reframing import reframe
from .relight import Shade, brighter, darker, dimmed, lit, recoloured
from .sight import sight_of
from .wanted import Wanted, best_look, seen_beats, wanted

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate
    from ...worlds.plates import Plate
    from ...worlds.requirements import Correction, Row
    from ...worlds.spec import WorldSpec
    from ..rows.questions import Question
    from .sight import Mask, Sight

__all__ = ["AGAIN", "check", "plates_now", "seen_ids", "taken"]

AGAIN = "call run_checks(scope='full'), which renders what is missing"
Y = np.array([0.2126, 0.7152, 0.0722])
"""Luminance of linear sRGB (IEC 61966-2-1)."""


def seen_ids(spec: WorldSpec) -> frozenset[str]:
    """Ids of the rows that plates answer."""
    return frozenset(SEEN.row_id((n,)) for n in seen_beats(spec))


def taken(candidate: Candidate) -> bool:
    """True if plates of a candidate's bake were made at all."""
    return candidate.stage == "full" and (plates_folder(candidate) / "index.json").exists()


def plates_now(candidate: Candidate) -> Plates:
    """The plates of a candidate.

    Raises:
        EvidenceError: there are none of these caches in this look.
    """
    found = Plates.open(plates_folder(candidate))
    if found is None:
        raise EvidenceError(f"no plates were rendered of this bake; {AGAIN}")
    if found.recipe != recipes(candidate.spec)["seen"] or found.size != plate_size(candidate.spec.look):
        raise EvidenceError(f"the plates show another look or shot plan (stale); {AGAIN}")
    if found.cache != candidate.digest:
        raise EvidenceError(f"the plates show another bake (stale); {AGAIN}")
    return found


def check(candidate: Candidate) -> list[Row]:
    """Rows of all beats whose subject must be seen."""
    judge = _Judge(candidate)
    found = []
    for name, beat in candidate.spec.story.beats.items():
        if beat.mandatory and beat.observe:
            row = shot_row(candidate, judge.question(name), (name,), partial(judge.seen, name))
            found.append(row.model_copy(update={"artifact": judge.artifact}))
    return found


class _Judge:
    """Reads the plates of one candidate, once."""

    def __init__(self, candidate: Candidate) -> None:
        self.candidate, self.folder = candidate, plates_folder(candidate)
        self.artifact = f"{candidate.artifact.rpartition('/')[0]}/{self.folder.name}".lstrip("/")
        self.sight = sight_of(candidate)
        self._plan: Wanted | None = None

    @property
    def plan(self) -> Wanted:
        """Which plates there should be; errors as `wanted`."""
        if self._plan is None:
            self._plan = wanted(self.candidate, self.sight)
        return self._plan

    def question(self, beat_id: str) -> Question:
        """The question; one more view than there may be is told, and no part of the verdict."""
        try:
            return replace(SEEN, mandatory=beat_id not in self.plan.left)
        except EvidenceError:  # the row says so
            return SEEN

    def seen(self, beat_id: str) -> Finding:
        """Judge whether a beat's subject is seen at its best frame."""
        beat, plates = self.candidate.spec.story.beats[beat_id], plates_now(self.candidate)
        subject, view = beat.subject, self.plan.of.get(beat_id)
        told = Finding("unverified", "", unit="1", entities=(subject,), frames=beat.frames, extra=[plates.digest])
        if view is None:
            return self._nowhere(told, beat_id, subject)
        if beat_id in self.plan.left:
            return replace(
                told, text=f"not looked at: a world has {MOST_PLATES} plates at most, of other subjects and beats first"
            )
        if view not in plates.views:
            why = plates.left.get(subject, "no plate shows it there")
            text = f"{subject} was not looked at in shot {view.shot} at frame {view.frame}: {why}; {AGAIN}"
            return replace(told, text=text, hints=(correction(why, "look", AGAIN, pointers=("/look",)),))
        mask = self.sight.mask(subject, view.shot, view.frame, plates.size)
        if int(mask.visible.sum()) < SEEN_PIXELS:
            return self._small(told, view, mask)
        return self._compared(told, view, mask, plates.read(self.folder, view))

    def _nowhere(self, told: Finding, beat_id: str, subject: str) -> Finding:
        """A subject that no picture of its outcome shows."""
        look = best_look(self.sight, beat_id)
        why = f"hidden behind {look.hidden_by}" if look is not None and look.hidden_by else "out of the picture"
        text = f"{subject} is in no picture of the outcome of {beat_id}: {why}"
        frame = told.frames[0] if look is None and told.frames is not None else getattr(look, "frame", None)
        hints = () if look is None else tuple(reframe(self.sight, subject, look, (look.frame, look.frame)))
        return replace(
            told, status="fail", text=text, measured=0.0, bound=SEEN_SHARE, frame=frame, hints=hints, evidence={"cause": why}
        )

    def _small(self, told: Finding, view: View, mask: Mask) -> Finding:
        """A subject of which next to nothing is in the picture."""
        own, shown = int(mask.own.sum()), int(mask.visible.sum())
        hidden = mask.hidden_by is not None and own >= SEEN_PIXELS
        why = f"hidden behind {mask.hidden_by}" if hidden else "too small"
        text = f"{view.subject} shows {shown} of its {own} pixels in shot {view.shot} at frame {view.frame}, {why}"
        text += f"; {SEEN_PIXELS} are needed"
        hints = reframe(self.sight, view.subject, self.sight.seen(view.subject, view.shot, view.frame), (view.frame, view.frame))
        evidence = {"cause": why, "pixels": shown, "own_pixels": own}
        return replace(
            told,
            status="fail",
            text=text,
            measured=0.0,
            bound=SEEN_SHARE,
            frame=view.frame,
            hints=tuple(hints),
            evidence=evidence,
        )

    def _compared(self, told: Finding, view: View, mask: Mask, plate: Plate) -> Finding:
        """The finding about a plate."""
        difference = compared(plate)
        pixels, share = int(mask.visible.sum()), float(difference.differs[mask.visible].mean())
        shade = _shade(plate, mask)
        text = f"{share:.0%} of the {pixels} pixels of {view.subject} in shot {view.shot} at frame {view.frame} differ from "
        text += f"the picture without it; mean luminance {shade.luminance:.4f} of white"
        found = replace(told, status="pass", text=text, measured=share, bound=SEEN_SHARE, frame=view.frame)
        delta, noise = (float(np.median(values[mask.visible])) for values in (difference.delta, difference.noise))
        evidence = {
            "seed": f"{SEEDS} of the renderer",
            "shot": view.shot,
            "frame": view.frame,
            "pixels": pixels,
            "delta": delta,
            "noise": noise,
            **shade._asdict(),
        }
        if share >= SEEN_SHARE:
            return replace(found, evidence=evidence)
        cause = _cause(self.sight, view, shade, difference, mask)
        return replace(
            found,
            status="fail",
            text=f"{text}: {cause.text}",
            entity=view.subject,
            hints=tuple(cause.hints),
            evidence={**evidence, "cause": cause.text},
        )


class _Cause(NamedTuple):
    """Why a subject is not seen, and what mends it."""

    text: str
    hints: list[Correction]


def _shade(plate: Plate, mask: Mask) -> Shade:
    """Lightness of a subject, of what is behind it, and of the whole picture."""
    shown, bare = (lab(p).mean(axis=0)[..., 0] for p in plate)
    return Shade(
        luminance=float((linear(plate.shown).mean(axis=0) @ Y)[mask.visible].mean()),
        subject=float(np.median(shown[mask.visible])),
        behind=float(np.median(bare[mask.visible])),
        picture=float(np.median(shown)),
    )


def _cause(sight: Sight, view: View, shade: Shade, difference: Difference, mask: Mask) -> _Cause:
    """The first reason that holds: no light, too much, the colour of what is behind, noise."""
    delta, noise = (float(np.median(values[mask.visible])) for values in (difference.delta, difference.noise))
    spec = sight.candidate.spec
    glows = judge_of(spec, view.subject).glows(spec, view.subject)
    if max(shade.subject, shade.behind) < DARK:
        return _Cause(f"too dark, lightness {shade.subject:.1f} of 100", brighter(sight, view, shade))
    if min(shade.subject, shade.behind) > BRIGHT:
        return _Cause(f"too bright, lightness {shade.subject:.1f} of 100", darker(sight, view, shade))
    if delta <= JUST_NOTICEABLE:
        text = f"it has the colour of what is behind it: they differ by {delta:.1f} of CIELAB, an eye notices {JUST_NOTICEABLE:g}"
        return _Cause(text, dimmed(sight, view) if glows else recoloured(sight, view, shade))
    text = f"its difference of {delta:.1f} of CIELAB is less than {SEEN_NOISE:g} times the noise of {noise:.1f}"
    dark = [lit(sight, view, "so little light reaches it that it is lost in noise")]
    return _Cause(text, dimmed(sight, view) if glows else dark)
