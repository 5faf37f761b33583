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

from typing import TYPE_CHECKING, Any

from ...worlds.errors import EvidenceError
from ...worlds.requirements import Correction, RowId
from ..predicates import beat_times
from ..rows.verdicts import correction
from .camera_path import inside, moves
from .rows import SCREEN_STEP, outcome_frames, shot_row, unseen_text
from .sight import Sight
from .views import framed, visible

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate
    from ...worlds.requirements import Row
    from ...worlds.spec import Beat, Shot

__all__ = ["SCREEN_STEP", "check"]


def check(candidate: Candidate) -> list[Row]:
    """Rows of the whole plan, of every observed beat and of every shot."""
    rows = [_tiling(candidate)]
    observed = {n: b for n, b in candidate.spec.story.beats.items() if b.observe}
    rows += _unobserved(candidate)
    rows += [_cover(candidate, n, b) for n, b in observed.items()]
    try:
        sight: Sight | EvidenceError = Sight(candidate)
    except EvidenceError as error:
        sight = error
    for name, beat in observed.items():
        rows.append(
            _guard(
                candidate,
                RowId("shots:visible", name),
                sight,
                lambda s, n=name, b=beat: visible(candidate, s, n, b),
                beat.mandatory,
            )
        )
    for name, shot in candidate.spec.shots.items():
        for what, function in (("framed", framed), ("inside", inside), ("motion", moves)):
            row_id = RowId(f"shots:{what}", name)
            rows += [_guard(candidate, row_id, sight, lambda s, f=function, n=name, p=shot: f(candidate, s, n, p))]
    return rows


def _guard(candidate: Candidate, row_id: RowId, sight: Sight | EvidenceError, make: Any, mandatory: bool = True) -> Row:
    try:
        if isinstance(sight, EvidenceError):
            raise sight
        made: Row = make(sight)
    except EvidenceError as error:
        return shot_row(candidate, row_id, "unverified", str(error), mandatory=mandatory)
    return made


def _tiling(candidate: Candidate) -> Row:
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
    return shot_row(
        candidate,
        RowId("shots:tiling"),
        "fail" if wrong else "pass",
        "; ".join(w[1] for w in wrong) or f"{len(order)} shots cover frames 0..{last}",
        measured=float(len(wrong)),
        bound=0.0,
        comparison="<=",
        unit="faults",
        first_failing_frame=min(w[0] for w in wrong) if wrong else None,
        corrections=hints,
        artifact="world.json",
        evidence={"shots": {n: list(s.frames) for n, s in order}},
    )


def _set_frames(name: str, frames: tuple[int, int], action: str) -> Correction:
    pointer = f"/shots/{name}/frames"
    patch = ({"op": "replace", "path": pointer, "value": list(frames)},)
    return correction("shots do not follow each other", "shots", action, pointers=(pointer,), patch=patch)


def _overlap(shot: Shot, frames: tuple[int, int]) -> int:
    return max(0, min(shot.frames[1], frames[1]) - max(shot.frames[0], frames[0]) + 1)


def _cover(candidate: Candidate, beat_id: str, beat: Beat) -> Row:
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
    return shot_row(
        candidate,
        RowId("shots:cover", beat_id),
        "pass" if shown else "fail",
        text,
        frames=frames,
        measured=float(shown),
        bound=1.0,
        comparison=">=",
        unit="frames",
        entities=(beat.subject,),
        first_failing_entity=None if shown else beat.subject,
        first_failing_frame=None if shown else beat.frames[0] if first is None else first,
        mandatory=beat.mandatory,
        corrections=[
            correction(
                "no camera runs while it happens", "shots", f"let a shot run over frames {list(frames)}", pointers=(pointer,)
            )
        ],
        artifact="world.json",
        evidence={"named_by": named, "overlap": able},
    )


def _unobserved(candidate: Candidate) -> list[Row]:
    """A row where mandatory beats ask for no camera: not all of them may. A probe tells it; physics is tried without cameras too."""
    mandatory = {n: b for n, b in candidate.spec.story.beats.items() if b.mandatory}
    unseen = {n: b for n, b in mandatory.items() if not b.observe}
    if not unseen:
        return []
    told = "; ".join(unseen_text(n, b) for n, b in unseen.items())
    first = next(iter(unseen))
    place = f"/story/beats/{first}/observe"
    alone = len(unseen) == len(mandatory)
    return [
        shot_row(
            candidate,
            RowId("shots:observed", "story"),
            "fail" if alone else "pass",
            f"{len(mandatory) - len(unseen)} of {len(mandatory)} mandatory beats are observed; {told}",
            measured=float(len(mandatory) - len(unseen)),
            bound=1.0,
            comparison=">=",
            unit="beats",
            entities=[b.subject for b in unseen.values()],
            first_failing_entity=unseen[first].subject if alone else None,
            first_failing_frame=unseen[first].frames[0] if alone else None,
            mandatory=candidate.stage == "full",
            corrections=[
                correction(
                    "no camera is asked to see anything that must happen",
                    "story",
                    f"observe {first}, in a shot that covers it",
                    pointers=(place, "/shots"),
                    patch=({"op": "remove", "path": place},),
                )
            ]
            if alone
            else (),
            artifact="world.json",
            evidence={"unobserved": list(unseen), "pointers": [f"/story/beats/{n}/observe" for n in unseen]},
        )
    ]
