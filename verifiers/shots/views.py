"""Subjects in view: those of beats while these happen, and those of shots (R98, S9, S10)."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ...worlds.predicates.registry import is_invariant
from ..categories.registry import judge_of
from ..predicates.evaluators import beat_times
from ..rows.corrections import correction
from ..rows.findings import Finding
from ..rows.telling import tell
from .bounds import MOMENT
from .counted import unseen_members
from .plan import outcome_frames, shots_at, subjects_of
from .reframing import reframe

if TYPE_CHECKING:
    from ...worlds.requirements import Correction
    from ...worlds.spec import Beat, Shot
    from .sight import Seen, Sight

__all__ = ["SAMPLES", "framed", "samples", "visible"]

SAMPLES = 48
"""Own choice: frames of a beat that are looked at, all of them in a shorter one; its first true frame among them."""
MOST_SAMPLES = 400
"""The same where fewer leave the verdict open: at a share of seen frames within `DOUBT` of the bound, or never seen."""
DOUBT = 0.15
SHOT_SAMPLES = 24
"""Own choice: frames of a shot at which its subjects are looked for, besides those where they are nearest to its middle."""
NEAREST = 3


class _Looks(NamedTuple):
    """The subject of a beat at its sampled frames."""

    frames: list[int]
    seen: list[Seen]
    """One per frame at which a shot runs, in the shot that shows it best."""
    blind: list[int]
    """Frames without a shot."""

    def good(self, least: float) -> list[Seen]:
        """Looks at which the subject is large enough."""
        return [s for s in self.seen if s.share >= least]


def samples(frames: tuple[int, int], count: int, extra: int | None = None) -> list[int]:
    """At most `count` frames of an interval, evenly, and one more where it lies within."""
    picked = {round(f) for f in np.linspace(frames[0], frames[1], min(count, frames[1] - frames[0] + 1))}
    if extra is not None and frames[0] <= extra <= frames[1]:
        picked.add(extra)
    return sorted(picked)


def _look(sight: Sight, beat_id: str, subject: str, frames: list[int]) -> _Looks:
    """The subject at some frames, in the shots that name the beat or, where none of them runs, in any."""
    candidate = sight.candidate
    named = [n for n, s in candidate.spec.shots.items() if beat_id in s.covers]
    seen: list[Seen] = []
    blind = []
    for number, frame in enumerate(frames, 1):
        tell(f"view of {subject} in {beat_id}: frame", number, len(frames))
        shots = [s for s in shots_at(candidate, frame) if not named or s in named] or shots_at(candidate, frame)
        if shots:
            seen.append(max((sight.seen(subject, s, frame) for s in shots), key=lambda s: (s.share, s.unoccluded)))
        else:
            blind.append(frame)
    return _Looks(frames, seen, blind)


def _looks(sight: Sight, beat_id: str, beat: Beat, first: int | None) -> _Looks:
    limits = sight.candidate.spec.simulation.limits
    found = _look(sight, beat_id, beat.subject, samples(beat.frames, SAMPLES, first))
    good = found.good(limits.visible_pixels)
    share = len(good) / len(found.frames)
    open_verdict = not any(s.unoccluded >= limits.visible_share for s in good) or abs(share - limits.beat_seen_frames) <= DOUBT
    if open_verdict and len(found.frames) < beat.frames[1] - beat.frames[0] + 1:
        found = _look(sight, beat_id, beat.subject, samples(beat.frames, MOST_SAMPLES, first))
    return found


def _moment(sight: Sight, beat_id: str, beat: Beat, first: int | None) -> tuple[Seen | None, float]:
    """The clearest view of the subject around the frame where the beat comes true, and its unoccluded share.

    Large views before small ones; the share is 0 where all are too small, or no shot runs there (then there is no view). It is 1, without a
    view, where nothing is asked of a moment: the beat never comes true, or is a state that lasts, which is looked at as a whole.
    """
    candidate = sight.candidate
    own = outcome_frames(candidate, beat_id)
    if first is None or own is None or is_invariant(beat.predicate):
        return None, 1.0
    limits, best, shown = candidate.spec.simulation.limits, None, 0.0
    # Nearest frames first: the first that shows it decides.
    for frame in sorted(samples(own, SAMPLES, first), key=lambda f: abs(f - first)):
        for look in _look(sight, beat_id, beat.subject, [frame]).seen:
            best = look if best is None else max(best, look, key=lambda s: (s.share >= limits.visible_pixels, s.unoccluded))
        shown = best.unoccluded if best is not None and best.share >= limits.visible_pixels else 0.0
        if shown >= limits.visible_share:
            break
    return best, shown


def visible(sight: Sight, beat_id: str, beat: Beat) -> Finding:
    """Judge whether a beat's subject is seen while it happens."""
    candidate, subject, frames = sight.candidate, beat.subject, beat.frames
    open_found = Finding("unverified", "", entities=(subject,), frames=frames)
    if candidate.stage == "static":
        start = [sight.seen(subject, s, 0) for s in shots_at(candidate, 0)]
        return replace(
            open_found, text="not simulated yet; " + (_appearance(subject, start[0]) if start else "no shot shows frame 0")
        )
    if frames[1] > candidate.last_frame:
        text = f"frames {frames[0]}..{frames[1]} are needed, the {candidate.stage} ends at frame {candidate.last_frame}"
        return replace(open_found, text=text)
    first = beat_times(candidate).first(beat_id)
    looks = _looks(sight, beat_id, beat, first)
    if not looks.seen:
        text = f"no shot runs at any of frames {looks.frames[0]}..{looks.frames[-1]}"
        return replace(open_found, status="fail", text=text, frame=looks.frames[0])
    return _judged(sight, beat, looks, first, _moment(sight, beat_id, beat, first))


def _judged(sight: Sight, beat: Beat, looks: _Looks, first: int | None, moment: tuple[Seen | None, float]) -> Finding:
    """The finding about a beat's subject.

    Args:
        sight: pictures of the candidate.
        beat: the beat.
        looks: its subject at the sampled frames.
        first: frame at which the beat comes true.
        moment: the clearest view of it around that frame and its unoccluded share, as `_moment`.
    """
    limits, subject = sight.candidate.spec.simulation.limits, beat.subject
    view, shown = moment
    best = max(looks.seen, key=lambda s: min(s.share / limits.visible_pixels, s.unoccluded / limits.visible_share))
    good = looks.good(limits.visible_pixels)
    seen_share = len(good) / len(looks.frames)
    tests = [
        (best.share, limits.visible_pixels),
        (best.unoccluded, limits.visible_share),
        (seen_share, limits.beat_seen_frames),
        (shown, limits.visible_share),
    ]
    missed = [k for k, (value, bound) in enumerate(tests) if value < bound]
    measured, bound = tests[missed[0] if missed else 1]
    text = f"{_appearance(subject, best)}; in view at {len(good)} of {len(looks.frames)} sampled frames"
    if shown < limits.visible_share:
        behind = f", behind {view.hidden_by}" if view is not None and view.hidden_by else ""
        text += (
            f"; within {MOMENT:g} s of frame {first}, where the beat comes true, at most {shown:.0%} of it is unoccluded{behind}"
        )
    unseen = {} if first is None or first > sight.candidate.last_frame else unseen_members(sight, beat, first)
    if unseen:
        text += f"; of the others that it counts not seen at frame {first}: " + ", ".join(
            f"{n} ({why})" for n, why in unseen.items()
        )
    looked = view if missed == [3] and view is not None else best
    bad_frames = sorted({s.frame for s in looks.seen if s not in good} | set(looks.blind))
    return Finding(
        "fail" if missed else "pass",
        text,
        measured,
        bound,
        entity=subject,
        frame=first if missed[:1] == [3] else (bad_frames or [best.frame])[0],
        hints=_nearer(sight, beat, looked, leaves=0.0 < seen_share < limits.beat_seen_frames) if missed else (),
        evidence={
            "best_frame": best.frame,
            "best_share": best.share,
            "best_unoccluded": best.unoccluded,
            "seen_share": seen_share,
            "moment": {"frame": first, "unoccluded": shown, "hidden_by": None if view is None else view.hidden_by},
            **({"unseen_members": unseen} if unseen else {}),
            "samples": [[s.frame, s.shot, s.share, s.unoccluded, s.hidden_by] for s in looks.seen[:SAMPLES]],
            "pixels": [sight.width, sight.height],
        },
        frames=beat.frames,
    )


def _nearer(sight: Sight, beat: Beat, best: Seen, *, leaves: bool) -> tuple[Correction, ...]:
    """Corrections that show a beat's subject."""
    if not judge_of(sight.candidate.spec, beat.subject).grainy:
        return tuple(reframe(sight, beat.subject, best, beat.frames, leaves=leaves))
    cause = "particles are too small or too few to be seen from there"
    action = "bring the camera nearer, or show the beat when there are more of them"
    return (correction(cause, "shots", action, pointers=("/shots",)),)


def _appearance(subject: str, seen: Seen) -> str:
    if not seen.in_picture:
        return f"{subject} is outside the picture of shot {seen.shot} at frame {seen.frame}"
    behind = f", behind {seen.hidden_by}" if seen.hidden_by and seen.unoccluded < 1 else ""
    where = f"shot {seen.shot} at frame {seen.frame}"
    return f"{subject} fills {seen.share:.4%} of {where}, {seen.unoccluded:.0%} of it unoccluded{behind}"


def framed(sight: Sight, shot_id: str, shot: Shot) -> Finding:
    """Judge whether the subjects of a shot are in it at some frame, and what it follows at enough frames."""
    candidate, limits = sight.candidate, sight.candidate.spec.simulation.limits
    names = list(dict.fromkeys([*subjects_of(candidate, shot), *([shot.follow] if shot.follow else [])]))
    if not names:
        return Finding("not_applicable", f"shot {shot_id} names no subject and no beat", frames=shot.frames)
    if shot.frames[1] > candidate.last_frame:
        text = f"the shot runs to frame {shot.frames[1]}, the {candidate.stage} holds frames 0..{candidate.last_frame}"
        return Finding("unverified", text, entities=tuple(names), frames=shot.frames)
    # The beats' own frames are judged by `shots:visible`; here it is enough to be in the shot at all.
    frames = samples(shot.frames, SHOT_SAMPLES)
    looks = {n: [sight.seen(n, shot_id, f) for f in sorted({*frames, *_central(sight, n, shot_id, shot)})] for n in names}
    best = {n: max(found, key=lambda s: s.share) for n, found in looks.items()}
    lost = [n for n, s in best.items() if s.share < limits.visible_pixels]
    worst = min(best, key=lambda n: best[n].share)
    measured, bound, text = best[worst].share, limits.visible_pixels, _appearance(worst, best[worst])
    if not lost and shot.follow:
        kept = [s for s in looks[shot.follow] if s.frame in frames]
        share = sum(s.in_picture for s in kept) / len(kept)
        if share < limits.beat_seen_frames:
            lost, measured, bound = [shot.follow], share, limits.beat_seen_frames
            text = f"{shot.follow}, which the shot follows, is in the picture at {share:.0%} of its frames"
    return Finding(
        "fail" if lost else "pass",
        text,
        measured,
        bound,
        entity=lost[0] if lost else None,
        frame=frames[0],
        hints=_reframed(sight, lost[0], best[lost[0]], shot, alone=len(names) <= 2) if lost else (),
        evidence={"best": {n: [s.frame, s.share, s.unoccluded] for n, s in best.items()}, "frames": frames},
        entities=tuple(names),
        frames=shot.frames,
    )


def _central(sight: Sight, name: str, shot_id: str, shot: Shot) -> list[int]:
    """Frames at which the entity's centre is nearest to the middle of the picture: it may pass between two samples."""
    centers = judge_of(sight.candidate.spec, name).centers(sight.candidate, name)
    span = range(shot.frames[0], min(shot.frames[1], sight.candidate.last_frame) + 1)
    away = []
    for frame in span:
        if not np.isfinite(centers[frame]).all():
            continue
        camera = sight.camera(shot_id, frame)
        pixels, depth = camera.project(centers[frame][None])
        if depth[0] > 0.0:
            away.append((float(np.linalg.norm(pixels[0] - (camera.width / 2, camera.height / 2))), frame))
    return [frame for _, frame in sorted(away)[:NEAREST]]


def _reframed(sight: Sight, name: str, look: Seen, shot: Shot, *, alone: bool) -> tuple[Correction, ...]:
    """Views of one subject; as ready edits only where they do not take the camera from several others."""
    found = reframe(sight, name, look, shot.frames)
    if alone:
        return tuple(found)
    text = f"the shot has other subjects too: turn or widen it so that {name} passes through the picture, or leave it to another shot"
    return tuple(c.model_copy(update={"patch": (), "action": f"{text} (alone: {c.action})"}) for c in found)
