"""Shot plan (R24, R98, S9, S10): are all beats shown, is the camera where a camera can be, does it move sanely?

- `shots:tiling`: shots follow each other from the first to the last planned frame without gap or overlap.
- `shots:cover:<beat>`: a shot runs while an observed beat happens.
- `shots:visible:<beat>`: its subject fills `limits.visible_pixels` of the picture and shows `limits.visible_share`
  of itself at its best sampled frame, and is in view at `limits.beat_seen_frames` of the sampled frames.
- `shots:framed:<shot>`: every entity of `subjects` is in view at some sampled frame of the shot.
- `shots:inside:<shot>`: the camera is inside no solid.
- `shots:motion:<shot>`: what it aims at moves at most `SCREEN_STEP` of the width per frame, the camera at most that
  share of its distance; across a `continue` transition as well.
"""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from ..geometry import Camera
from ..worlds.candidate import Candidate
from ..worlds.errors import EvidenceError
from ..worlds.requirements import Correction, Row, Status
from . import motion
from .predicates import beat_times
from .reframing import reframe
from .sight import Seen, Sight
from .verdicts import correction, make_row

if TYPE_CHECKING:
    from ..worlds.spec import Beat, Shot

__all__ = ["SAMPLES", "SCREEN_STEP", "check"]

SAMPLES = 6
"""Own choice: frames per beat that are looked at, its first, last and first true frame among them."""
MOVING_SAMPLES = 9
"""Frames of a shot with a moving camera at which its subjects are looked for."""
SHOT_SAMPLES = 3
"""The same for a camera that stands still."""
SCREEN_STEP = 0.2
"""Own choice: a picture that moves by more than a fifth of its width per frame cannot be followed by eye."""


def check(candidate: Candidate) -> list[Row]:
    """Rows of the whole plan, of every observed beat and of every shot."""
    rows = [_tiling(candidate)]
    observed = {n: b for n, b in candidate.spec.story.beats.items() if b.observe}
    rows += [_cover(candidate, n, b) for n, b in observed.items()]
    try:
        sight: Sight | EvidenceError = Sight(candidate)
    except EvidenceError as error:
        sight = error
    for name, beat in observed.items():
        rows.append(
            _guard(
                candidate, f"shots:visible:{name}", sight, lambda s, n=name, b=beat: _visible(candidate, s, n, b), beat.mandatory
            )
        )
    for name, shot in candidate.spec.shots.items():
        for what, function in (("framed", _framed), ("inside", _inside), ("motion", _motion)):
            row_id = f"shots:{what}:{name}"
            rows += [_guard(candidate, row_id, sight, lambda s, f=function, n=name, p=shot: f(candidate, s, n, p))]
    return rows


def _guard(candidate: Candidate, row_id: str, sight: Sight | EvidenceError, make: Any, mandatory: bool = True) -> Row:
    try:
        if isinstance(sight, EvidenceError):
            raise sight
        made: Row = make(sight)
    except EvidenceError as error:
        return _row(candidate, row_id, "unverified", CLAIMS[row_id.split(":")[1]], str(error), mandatory=mandatory)
    return made


CLAIMS = {
    "tiling": "shots follow each other over all planned frames without gap or overlap",
    "cover": "a shot runs while the beat happens",
    "visible": "the beat's subject is in view and unoccluded while it happens",
    "framed": "every subject of the shot is in view",
    "inside": "the camera is inside no solid",
    "motion": f"the aim moves at most {SCREEN_STEP:g} of the picture's width per frame",
}


def _row(candidate: Candidate, row_id: str, status: Status, predicate: str, explanation: str, **more: Any) -> Row:
    extra = [
        {n: s.model_dump(mode="json") for n, s in candidate.spec.shots.items()},
        candidate.spec.simulation.limits.model_dump(mode="json"),
    ]
    more.setdefault("frames", (0, candidate.spec.simulation.frames - 1))
    return make_row(
        candidate,
        row_id,
        check="shots",
        group="observational",
        predicate=predicate,
        status=status,
        explanation=explanation,
        extra=extra,
        recipe_entities=list(candidate.spec.entities),
        **more,
    )


# ---------------------------------------------------------------- the plan


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
    return _row(
        candidate,
        "shots:tiling",
        "fail" if wrong else "pass",
        CLAIMS["tiling"],
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


def _shots_at(candidate: Candidate, frame: int) -> list[str]:
    return [n for n, s in candidate.spec.shots.items() if s.frames[0] <= frame <= s.frames[1]]


def _overlap(shot: Shot, frames: tuple[int, int]) -> int:
    return max(0, min(shot.frames[1], frames[1]) - max(shot.frames[0], frames[0]) + 1)


def _cover(candidate: Candidate, beat_id: str, beat: Beat) -> Row:
    shots = candidate.spec.shots
    named = [n for n, s in shots.items() if beat_id in s.covers]
    able = {n: _overlap(shots[n], beat.frames) for n in (named or shots)}
    best = max(able, key=lambda n: able[n], default=None)
    shown = able[best] if best is not None else 0
    length = beat.frames[1] - beat.frames[0] + 1
    text = f"{shown} of {length} frames of {beat_id} lie in {f'shot {best}' if best else 'no shot'}"
    if named and not shown:
        text = (
            f"shots {', '.join(named)} name {beat_id} in covers but run at other frames than {beat.frames[0]}..{beat.frames[1]}"
        )
    pointer = f"/shots/{best}/frames" if best else "/shots"
    return _row(
        candidate,
        f"shots:cover:{beat_id}",
        "pass" if shown else "fail",
        CLAIMS["cover"],
        text,
        frames=beat.frames,
        measured=float(shown),
        bound=1.0,
        comparison=">=",
        unit="frames",
        entities=(beat.subject,),
        first_failing_entity=None if shown else beat.subject,
        first_failing_frame=None if shown else beat.frames[0],
        mandatory=beat.mandatory,
        corrections=[
            correction(
                "no camera runs while it happens", "shots", f"let a shot run over frames {list(beat.frames)}", pointers=(pointer,)
            )
        ],
        artifact="world.json",
        evidence={"named_by": named, "overlap": able},
    )


# ---------------------------------------------------------------- what is seen


def _samples(frames: tuple[int, int], extra: int | None, count: int = SAMPLES) -> list[int]:
    inner = count if extra is None else count - 1
    picked = {round(f) for f in np.linspace(frames[0], frames[1], max(2, inner))}
    if extra is not None and frames[0] <= extra <= frames[1]:
        picked.add(extra)
    return sorted(picked)


def _visible(candidate: Candidate, sight: Sight, beat_id: str, beat: Beat) -> Row:
    limits, subject = candidate.spec.simulation.limits, beat.subject
    common: dict[str, Any] = {"mandatory": beat.mandatory, "frames": beat.frames, "entities": (subject,)}
    row_id = f"shots:visible:{beat_id}"
    if candidate.stage == "static":
        start = [sight.seen(subject, s, 0) for s in _shots_at(candidate, 0)]
        text = "not simulated yet; " + (_appearance(subject, start[0]) if start else "no shot shows frame 0")
        return _row(candidate, row_id, "unverified", CLAIMS["visible"], text, **common)
    if beat.frames[1] > candidate.last_frame:
        text = f"frames {beat.frames[0]}..{beat.frames[1]} are needed, the {candidate.stage} ends at frame {candidate.last_frame}"
        return _row(candidate, row_id, "unverified", CLAIMS["visible"], text, **common)
    frames = _samples(beat.frames, beat_times(candidate).first(beat_id))
    named = [n for n, s in candidate.spec.shots.items() if beat_id in s.covers]
    looks: list[Seen] = []
    blind = []
    for frame in frames:
        shots = [s for s in _shots_at(candidate, frame) if not named or s in named] or _shots_at(candidate, frame)
        if shots:
            looks.append(max((sight.seen(subject, s, frame) for s in shots), key=lambda s: (s.share, s.unoccluded)))
        else:
            blind.append(frame)
    if not looks:
        text = f"no shot runs at any of frames {frames}"
        return _row(
            candidate,
            row_id,
            "fail",
            CLAIMS["visible"],
            text,
            **common,
            first_failing_entity=subject,
            first_failing_frame=frames[0],
        )
    best = max(looks, key=lambda s: min(s.share / limits.visible_pixels, s.unoccluded / limits.visible_share))
    good = [s for s in looks if s.share >= limits.visible_pixels]
    seen_share = len(good) / len(frames)
    tests = [
        (best.share, limits.visible_pixels, "of the picture"),
        (best.unoccluded, limits.visible_share, "unoccluded"),
        (seen_share, limits.beat_seen_frames, "of the sampled frames"),
    ]
    failed = next(((v, b) for v, b, _ in tests if v < b), None)
    measured, bound = failed or tests[1][:2]
    text = f"{_appearance(subject, best)}; in view at {len(good)} of {len(frames)} sampled frames"
    bad_frames = sorted({s.frame for s in looks if s not in good} | set(blind))
    hints = [] if failed is None else reframe(candidate, sight, subject, best, beat.frames, seen_share < limits.beat_seen_frames)
    return _row(
        candidate,
        row_id,
        "pass" if failed is None else "fail",
        CLAIMS["visible"],
        text,
        **common,
        measured=measured,
        bound=bound,
        comparison=">=",
        unit="1",
        first_failing_entity=None if failed is None else subject,
        first_failing_frame=None if failed is None else (bad_frames or [best.frame])[0],
        corrections=hints,
        evidence={
            "best_frame": best.frame,
            "best_share": best.share,
            "best_unoccluded": best.unoccluded,
            "seen_share": seen_share,
            "samples": [[s.frame, s.shot, s.share, s.unoccluded, s.hidden_by] for s in looks],
            "pixels": [sight.width, sight.height],
        },
    )


def _appearance(subject: str, seen: Seen) -> str:
    if not seen.in_picture:
        return f"{subject} is outside the picture of shot {seen.shot} at frame {seen.frame}"
    behind = f", behind {seen.hidden_by}" if seen.hidden_by and seen.unoccluded < 1 else ""
    where = f"shot {seen.shot} at frame {seen.frame}"
    return f"{subject} fills {seen.share:.4%} of {where}, {seen.unoccluded:.0%} of it unoccluded{behind}"


def _framed(candidate: Candidate, sight: Sight, shot_id: str, shot: Shot) -> Row:
    row_id = f"shots:framed:{shot_id}"
    names = _subjects(candidate, shot)
    if not names:
        return _row(
            candidate,
            row_id,
            "not_applicable",
            CLAIMS["framed"],
            f"shot {shot_id} names no subject and no beat",
            frames=shot.frames,
        )
    if shot.frames[1] > candidate.last_frame:
        text = f"the shot runs to frame {shot.frames[1]}, the {candidate.stage} holds frames 0..{candidate.last_frame}"
        return _row(candidate, row_id, "unverified", CLAIMS["framed"], text, frames=shot.frames, entities=names)
    least = candidate.spec.simulation.limits.visible_pixels
    # The beats' own frames are judged by `shots:visible`; here it is enough to be in the shot at all.
    frames = _samples(shot.frames, None, SHOT_SAMPLES if shot.subjects and len(shot.keys) == 1 else MOVING_SAMPLES)
    best = {n: max((sight.seen(n, shot_id, f) for f in frames), key=lambda s: s.share) for n in names}
    lost = [n for n, s in best.items() if s.share < least]
    worst = min(best, key=lambda n: best[n].share)
    return _row(
        candidate,
        row_id,
        "fail" if lost else "pass",
        CLAIMS["framed"],
        _appearance(worst, best[worst]),
        frames=shot.frames,
        measured=best[worst].share,
        bound=least,
        comparison=">=",
        unit="1",
        entities=names,
        first_failing_entity=lost[0] if lost else None,
        first_failing_frame=frames[0] if lost else None,
        corrections=_reframed(candidate, sight, lost[0], best[lost[0]], shot, alone=len(names) <= 2) if lost else (),
        evidence={"best": {n: [s.frame, s.share, s.unoccluded] for n, s in best.items()}, "frames": frames},
    )


def _reframed(candidate: Candidate, sight: Sight, name: str, look: Seen, shot: Shot, *, alone: bool) -> list[Correction]:
    """Views of one subject; as ready edits only where they do not take the camera from several others."""
    found = reframe(candidate, sight, name, look, shot.frames, False)
    if alone:
        return list(found)
    text = f"the shot has other subjects too: turn or widen it so that {name} passes through the picture, or leave it to another shot"
    return [c.model_copy(update={"patch": (), "action": f"{text} (alone: {c.action})"}) for c in found]


# ---------------------------------------------------------------- the camera


def _judged(candidate: Candidate, shot: Shot) -> tuple[int, int] | None:
    """Frames of the shot whose camera is known: those simulated, or all where it follows nothing."""
    last = shot.frames[1] if shot.follow is None else min(shot.frames[1], candidate.last_frame)
    return (shot.frames[0], last) if last >= shot.frames[0] else None


def _inside(candidate: Candidate, sight: Sight, shot_id: str, shot: Shot) -> Row:
    span = (shot.frames[0], min(shot.frames[1], candidate.last_frame))
    row_id = f"shots:inside:{shot_id}"
    complete = span[1] == shot.frames[1]
    frames = (
        sorted({*_samples(span, None), *(k.frame for k in shot.keys.values() if span[0] <= k.frame <= span[1])})
        if span[0] <= span[1]
        else []
    )
    for frame in frames:
        position = sight.camera(shot_id, frame).position
        entity = sight.inside(position, frame)
        if entity is not None:
            pointers = (f"/shots/{shot_id}/keys",)
            return _row(
                candidate,
                row_id,
                "fail",
                CLAIMS["inside"],
                f"the camera of shot {shot_id} is inside {entity} at frame {frame}",
                frames=shot.frames,
                entities=(entity,),
                first_failing_entity=entity,
                first_failing_frame=frame,
                corrections=[correction("the camera is in a body", "shots", f"move it out of {entity}", pointers=pointers)],
                evidence={"position": position},
            )
    if not complete:
        text = f"outside all solids up to frame {span[1]}; frames up to {shot.frames[1]} are not simulated"
        return _row(candidate, row_id, "unverified", CLAIMS["inside"], text, frames=shot.frames)
    return _row(
        candidate,
        row_id,
        "pass",
        CLAIMS["inside"],
        f"outside all solids at frames {frames}",
        frames=shot.frames,
        evidence={"frames": frames},
    )


def _motion(candidate: Candidate, sight: Sight, shot_id: str, shot: Shot) -> Row:
    row_id = f"shots:motion:{shot_id}"
    span = _judged(candidate, shot)
    if span is None:
        return _row(
            candidate, row_id, "unverified", CLAIMS["motion"], f"{shot.follow} is not simulated in its frames", frames=shot.frames
        )
    cameras = [(f, sight.camera(shot_id, f)) for f in range(span[0], span[1] + 1)]
    if shot.transition == "continue":
        before = [n for n, s in candidate.spec.shots.items() if s.frames[1] == shot.frames[0] - 1]
        if before and shot.frames[0] - 1 <= candidate.last_frame:
            cameras.insert(0, (shot.frames[0] - 1, sight.camera(before[0], shot.frames[0] - 1)))
    worst, at, what = 0.0, None, ""
    for (_, one), (frame, two) in pairwise(cameras):
        pixels, depth = two.project(one.target[None])
        turned = float(np.linalg.norm(pixels[0] - (two.width / 2, two.height / 2))) / two.width if depth[0] > 0 else 1.0
        moved = float(np.linalg.norm(two.position - one.position) / np.linalg.norm(two.target - two.position))
        for value, name in ((turned, "the aim moves by"), (moved, "the camera travels, of its distance to the target,")):
            if value > worst:
                worst, what = value, name
            if value > SCREEN_STEP and at is None:
                at = frame
    runner = _fastest_subject(candidate, cameras, shot)
    if runner is not None and runner[0] > worst:
        worst, what = runner[0], f"{runner[1]} moves on the picture by"
        at = runner[2] if worst > SCREEN_STEP else at
    failed = at is not None
    text = f"{what or 'the camera stands still:'} at most {worst:.3f} per frame" + (
        f", too much first at frame {at}" if failed else ""
    )
    complete = span[1] == shot.frames[1]
    status: Status = "fail" if failed else "pass" if complete else "unverified"
    return _row(
        candidate,
        row_id,
        status,
        CLAIMS["motion"],
        text if complete else f"{text}; only up to frame {span[1]}",
        frames=shot.frames,
        measured=worst,
        bound=SCREEN_STEP,
        comparison="<=",
        unit="1",
        entities=_subjects(candidate, shot),
        first_failing_entity=runner[1] if failed and runner is not None and runner[0] == worst else None,
        first_failing_frame=at,
        corrections=[
            correction(
                "the camera jumps, or what it shows crosses the picture too fast",
                "shots",
                f"spread the keys of shot {shot_id} over more frames, cut into two shots, or show it from farther away",
                pointers=(f"/shots/{shot_id}/keys", f"/shots/{shot_id}/transition"),
                patch=_steady(shot_id, shot),
            )
        ],
    )


def _steady(shot_id: str, shot: Shot) -> list[dict[str, Any]]:
    """The edit that keeps the aim of the shot's first key throughout."""
    first, *others = sorted(shot.keys.items(), key=lambda item: item[1].frame)
    return [
        {"op": "replace", "path": f"/shots/{shot_id}/keys/{name}/target", "value": list(first[1].target)}
        for name, key in others
        if key.target != first[1].target
    ]


def _subjects(candidate: Candidate, shot: Shot) -> list[str]:
    beats = candidate.spec.story.beats
    return list(dict.fromkeys(shot.subjects or [beats[b].subject for b in shot.covers if b in beats]))


def _fastest_subject(candidate: Candidate, cameras: list[tuple[int, Camera]], shot: Shot) -> tuple[float, str, int] | None:
    """Largest move of a subject's centre on the picture in one frame, in widths; who, and at which frame.

    Only while it is in the picture at both frames, and within the simulated frames.
    """
    best: tuple[float, str, int] | None = None
    for name in _subjects(candidate, shot):
        centers = motion.centers(candidate, name)
        for (before, one), (after, two) in pairwise(cameras):
            if after > candidate.last_frame or not np.isfinite(centers[[before, after]]).all():
                continue
            if one.in_frame(centers[before][None])[0] and two.in_frame(centers[after][None])[0]:
                step = two.project(centers[after][None])[0][0] - one.project(centers[before][None])[0][0]
                share = float(np.linalg.norm(step)) / two.width
                if best is None or share > best[0]:
                    best = (share, name, after)
    return best
