"""Seeded defects of when a shot shows a beat: too early, too late, or never asked to."""

from __future__ import annotations

from pathlib import Path

from ...verifiers.shots.bounds import MOMENT
from ...worlds.spec import Box
from ._shot_worlds import RNG, Rig
from .cases import Mechanism, World

__all__ = ["MOMENTS"]

FPS = 24
REACH = round(MOMENT * FPS)
FRAMES = 60


def _rig(rng: RNG, moment: int) -> Rig:
    """A subject in plain view that moves at a frame."""
    rig = Rig(rng, frames=FRAMES)
    place = rig.spot(float(rng.uniform(-0.3, 0.3)), float(rng.uniform(-0.3, 0.3)))
    path = rig.still(place)
    path[moment:] += 0.01 * rig.axes[1]
    rig.add("subject", Box(size=(0.05 * rig.distance,) * 3), place, path=path)
    return rig


def _covered_until(folder: Path, rng: RNG, ends: int, moment: int, *culprits: str) -> World:
    """The covering shot ends at a frame; what follows covers nothing."""
    rig = _rig(rng, moment)
    rig.beat("event", "subject", (2, FRAMES - 1))
    rig.shot("a", (0, ends), covers=["event"])
    rig.shot("b", (ends + 1, FRAMES - 1), subjects=["subject"])
    return rig.world(folder, *culprits)


def _covers_what_was_before(folder: Path, m: float, rng: RNG) -> World:
    """The shot that names the beat runs in its interval, and ends m frames before anything of its outcome."""
    moment = int(rng.integers(34, 50))
    return _covered_until(folder, rng, moment - REACH - round(m), moment, "event")


def _cuts_at_the_outcome(folder: Path, m: float, rng: RNG) -> World:
    """It ends m frames into what counts as the outcome."""
    moment = int(rng.integers(34, 50))
    return _covered_until(folder, rng, moment - REACH + min(round(m), 2 * REACH) - 1, moment)


def _turns_at(folder: Path, rng: RNG, frame: int, *culprits: str) -> World:
    """It comes true at the first frame of its interval; the camera looks away before a frame."""
    rig, moment = _rig(rng, 12), 12
    rig.beat("event", "subject", (moment, FRAMES - 1))
    rig.shot("a", (0, frame - 1), rig.key(aim=rig.at(0.0, 0.0, -5.0)))
    rig.shot("b", (frame, FRAMES - 1))
    return rig.world(folder, *culprits)


def _sees_what_came_after(folder: Path, m: float, rng: RNG) -> World:
    return _turns_at(folder, rng, 12 + REACH + round(m), "event")


def _turns_in_time(folder: Path, m: float, rng: RNG) -> World:
    return _turns_at(folder, rng, max(1, 12 + REACH + 1 - round(m)))


def _unobserved(folder: Path, rng: RNG, unseen: int, seen: int, *culprits: str) -> World:
    """Beats that ask for no camera, and others that do."""
    rig = _rig(rng, 20)
    for k in range(unseen + seen):
        rig.beat(f"beat{k}", "subject")
        if k < unseen:
            rig.beats[f"beat{k}"] = rig.beats[f"beat{k}"].model_copy(update={"observe": False})
    rig.shot("a", subjects=["subject"])
    return rig.world(folder, *culprits)


def _nobody_looks(folder: Path, m: float, rng: RNG) -> World:
    return _unobserved(folder, rng, round(m), 0, "subject")


def _one_is_seen(folder: Path, m: float, rng: RNG) -> World:
    return _unobserved(folder, rng, round(m), int(rng.integers(1, 3)))


MOMENTS: tuple[Mechanism, ...] = (
    Mechanism("covers-before", "the covering shot ends before the outcome", True, _covers_what_was_before, 1, 20, "frames", 0.5),
    Mechanism("sees-after", "in view only after the outcome, at the interval's first frame", True, _sees_what_came_after, 1, 20, "frames", 0.5),
    Mechanism("nobody-looks", "no mandatory beat is observed", True, _nobody_looks, 1, 4, "beats"),
    Mechanism("cuts-at-outcome", "the covering shot ends at the outcome", False, _cuts_at_the_outcome, 1, 2 * REACH, "frames"),
    Mechanism("turns-in-time", "comes into view at the outcome", False, _turns_in_time, 1, 2 * REACH, "frames"),
    Mechanism("one-is-seen", "some mandatory beats are not observed", False, _one_is_seen, 1, 4, "beats"),
)  # fmt: skip
