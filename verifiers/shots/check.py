"""Shot plan (R24, R98, S9, S10): are all beats shown, is the camera where a camera can be, does it move sanely?

- `shots:tiling`: shots follow each other from the first to the last planned frame without gap or overlap.
- `shots:cover:<beat>`: a shot that covers an observed beat runs at frames of its outcome (`outcome_frames`: within `MOMENT` of the
  frame at which it comes true); where these are not known yet, at a frame of its interval.
- `shots:observed:story`: where a mandatory beat asks for no camera (`observe` false), another one is observed; all such are named.
- `shots:visible:<beat>`: its subject fills `limits.visible_pixels` of the picture and shows `limits.visible_share`
  of itself at its best frame, is in view at `limits.beat_seen_frames` of the frames, and is seen within `MOMENT` of the
  frame at which the beat comes true.
- `shots:framed:<shot>`: every entity of `subjects` is in view at some frame of the shot, what it follows at enough frames.
- `shots:inside:<shot>`: the camera is inside no solid, passes through no surface, and its near plane cuts none open.
- `shots:motion:<shot>`: what it aims at, its sides and its subjects move at most `SCREEN_STEP` of the width per frame,
  the camera at most that share of its distance; across a `continue` transition as well.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any

from ..predicates.evaluators import beat_times
from ..rows.corrections import correction
from ..rows.findings import Finding
from ..rows.telling import tell
from .camera_path import inside, moves
from .plan import outcome_frames, shot_row, unseen_text
from .questions import COVER, FRAMED, INSIDE, MOTION, OBSERVED, TILING, VISIBLE
from .sight import sight_of
from .views import framed, visible

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate
    from ...worlds.requirements import Correction, Row
    from ...worlds.spec import Beat, Shot

__all__ = ["check"]


def check(candidate: Candidate) -> list[Row]:
    """Rows of the whole plan, of every observed beat and of every shot."""
    sight = partial(sight_of, candidate)

    def seen(judge: Callable[..., Finding], name: str, judged: Beat | Shot) -> Callable[[], Finding]:
        return lambda: judge(sight(), name, judged)

    observed = {n: b for n, b in candidate.spec.story.beats.items() if b.observe}
    rows = [shot_row(candidate, TILING, (), _tiling(candidate), planned=True), *_unobserved(candidate)]
    for number, (name, beat) in enumerate(observed.items(), 1):
        tell(f"when {name} comes true: beat", number, len(observed))
        question = replace(COVER, mandatory=beat.mandatory)
        rows.append(shot_row(candidate, question, (name,), _cover(candidate, name, beat), planned=True))
    for name, beat in observed.items():
        question = replace(VISIBLE, mandatory=beat.mandatory)
        rows.append(shot_row(candidate, question, (name,), seen(visible, name, beat)))
    for name, shot in candidate.spec.shots.items():
        for question, judge in ((FRAMED, framed), (INSIDE, inside), (MOTION, moves)):
            rows.append(shot_row(candidate, question, (name,), seen(judge, name, shot)))
    return rows


def _tiling(candidate: Candidate) -> Finding:
    last = candidate.spec.simulation.frames - 1
    order = sorted(candidate.spec.shots.items(), key=lambda s: (s[1].frames, s[0]))
    expected, wrong = 0, []
    hints: list[Correction] = []
    for name, shot in order:
        first, end = shot.frames
        if first != expected:
            kind = "gap" if first > expected else "overlap"
            wrong.append((min(first, expected), f"{kind} of {abs(first - expected)} frames before shot {name}"))
            hints.append(_set_frames(name, (min(expected, end), end), f"begin shot {name} at frame {expected}"))
        expected = max(expected, end + 1)
    if not order:
        wrong.append((0, "the plan has no shots"))
        hints.append(correction("no shots", "shots", f"add a shot over frames 0..{last}", pointers=("/shots",)))
    elif expected <= last:
        name, shot = order[-1]
        wrong.append((expected, f"frames {expected}..{last} have no shot"))
        hints.append(_set_frames(name, (shot.frames[0], last), f"extend shot {name} to frame {last}"))
    elif expected > last + 1:
        name, shot = max(order, key=lambda s: s[1].frames[1])
        wrong.append((last + 1, f"shot {name} runs to frame {shot.frames[1]}, the simulation ends at {last}"))
        hints.append(_set_frames(name, (min(shot.frames[0], last), last), f"end shot {name} at frame {last}"))
    return Finding(
        "fail" if wrong else "pass",
        "; ".join(w[1] for w in wrong) or f"{len(order)} shots cover frames 0..{last}",
        float(len(wrong)),
        0.0,
        frame=min(w[0] for w in wrong) if wrong else None,
        hints=tuple(hints),
        evidence={"shots": {n: list(s.frames) for n, s in order}},
    )


def _set_frames(name: str, frames: tuple[int, int], action: str) -> Correction:
    pointer = f"/shots/{name}/frames"
    patch = ({"op": "replace", "path": pointer, "value": list(frames)},)
    return correction("shots do not follow each other", "shots", action, pointers=(pointer,), patch=patch)


def _overlap(shot: Shot, frames: tuple[int, int]) -> int:
    return max(0, min(shot.frames[1], frames[1]) - max(shot.frames[0], frames[0]) + 1)


def _cover(candidate: Candidate, beat_id: str, beat: Beat) -> Finding:
    shots = candidate.spec.shots
    named = [n for n, s in shots.items() if beat_id in s.covers]
    own, frames = outcome_frames(candidate, beat_id), beat.frames
    first = None if own is None else beat_times(candidate).first(beat_id)
    if own is not None:
        frames = max(own[0], frames[0]), min(own[1], frames[1])
    able = {n: _overlap(shots[n], frames) for n in (named or shots)}
    best = max(able, key=lambda n: able[n], default=None)
    shown = able[best] if best is not None else 0
    length = frames[1] - frames[0] + 1
    when = f"of {beat_id}" if first is None else f"around frame {first}, where {beat_id} comes true,"
    text = f"{shown} of {length} frames {when} lie in {f'shot {best}' if best else 'no shot'}"
    if named and not shown:
        text = f"shots {', '.join(named)} name {beat_id} in covers but run at other frames than {frames[0]}..{frames[1]}"
        text += "" if first is None else f": {beat_id} comes true at frame {first}"
    pointer = f"/shots/{best}/frames" if best else "/shots"
    action = f"let a shot run over frames {list(frames)}"
    patch: tuple[dict[str, Any], ...] = ()
    running = max(shots, key=lambda n: _overlap(shots[n], frames), default=None)
    if running is not None and running not in named and _overlap(shots[running], frames):
        action = f"name {beat_id} in the covers of shot {running}, which runs then, or {action}"
        pointer, patch = f"/shots/{running}/covers", _covering(running, beat_id)
    return Finding(
        "pass" if shown else "fail",
        text,
        float(shown),
        1.0,
        entity=beat.subject,
        frame=beat.frames[0] if first is None else first,
        hints=(correction("no camera runs while it happens", "shots", action, pointers=(pointer,), patch=patch),),
        evidence={"named_by": named, "overlap": able},
        frames=frames,
    )


def _covering(shot: str, beat_id: str) -> tuple[dict[str, Any], ...]:
    """Patch that lets a shot cover a beat."""
    return ({"op": "add", "path": f"/shots/{shot}/covers/-", "value": beat_id},)


def _unobserved(candidate: Candidate) -> list[Row]:
    """A row where mandatory beats ask for no camera: not all of them may. A probe tells it; physics is tried without cameras too."""
    mandatory = {n: b for n, b in candidate.spec.story.beats.items() if b.mandatory}
    unseen = {n: b for n, b in mandatory.items() if not b.observe}
    if not unseen:
        return []
    told = "; ".join(unseen_text(n, b) for n, b in unseen.items())
    first, count = next(iter(unseen)), len(mandatory) - len(unseen)
    place = f"/story/beats/{first}/observe"
    shots = candidate.spec.shots
    running = max(shots, key=lambda n: _overlap(shots[n], unseen[first].frames), default=None)
    covered = any(first in s.covers for s in shots.values())
    hint = correction(
        "no camera is asked to see anything that must happen",
        "story",
        f"observe {first}, in a shot that covers it",
        pointers=(place, "/shots"),
        patch=({"op": "remove", "path": place}, *(() if covered or running is None else _covering(running, first))),
    )
    found = Finding(
        "pass" if count else "fail",
        f"{count} of {len(mandatory)} mandatory beats are observed; {told}",
        float(count),
        1.0,
        frame=unseen[first].frames[0],
        hints=(hint,),
        evidence={"unobserved": list(unseen), "pointers": [f"/story/beats/{n}/observe" for n in unseen]},
        entities=tuple(b.subject for b in unseen.values()),
    )
    return [shot_row(candidate, replace(OBSERVED, mandatory=candidate.stage == "full"), ("story",), found, planned=True)]
