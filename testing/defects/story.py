"""Seeded defects of the story's own rows: beats that were true before, that nothing starts, and runs that end wrongly.

Worlds are written by hand: one ball, and what a log of contacts would hold of it.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from ...verifiers.story.phase_ends import GROWTH
from ...worlds.arrays import F64
from ...worlds.candidate import Stage
from ...worlds.predicates import Contact, Displacement, Or, Predicate, Reaches
from ...worlds.spec import Beat, BoxRegion, ForceDriver
from ..worlds.small_worlds import IDENTITY, Event, Touch, ball, ground, make_candidate, world
from ._helpers import guided_block, pushed_row, sprung_block
from .cases import Mechanism, Suite, World

__all__ = ["SUITE"]

RNG = np.random.Generator
FPS, FRAMES = 24, 73
LAST = FRAMES - 1
TIME: F64 = np.arange(FRAMES) / FPS
G = 9.81
FLOOR = Contact(a="ball", b="floor", min_impulse=0.05)
FAR = Displacement(entity="ball", min=0.5)
HOME = Reaches(entity="ball", region="home")
REGIONS = {"home": BoxRegion(min=(-0.2, -9, 0), max=(0.2, 9, 9))}


def _beat(predicate: Predicate, first: int, last: int = LAST, **more: Any) -> Beat:
    owner = more.pop("owner", "rigid")
    return Beat(text="it happens", owner=owner, subject="ball", frames=(first, last), predicate=predicate, **more)


def _world(
    folder: Path,
    beats: Mapping[str, Beat],
    culprits: tuple[str, ...],
    *,
    x: Any = 0.0,
    z: Any = 1.0,
    hits: tuple[int, ...] = (),
    sent: bool = True,
    slides: bool = False,
    probe: bool = False,
    velocity: F64 | None = None,
    **more: Any,
) -> World:
    """A ball of 0.1 m at (x, 0, z) over time; `sent` gives it a declared start velocity."""
    along, high = (np.broadcast_to(np.asarray(v, dtype=np.float64), (FRAMES,)) for v in (x, z))
    place = np.stack([along, 0 * along, high], axis=1)
    start = ball(0.1, motion="dynamic", at=tuple(place[0]), velocity=(1.0, 0.0, 0.0) if sent else (0.0, 0.0, 0.0))
    spec = world({"floor": ground(9.0), "ball": start}, frames=FRAMES, beats=beats, regions=REGIONS, **more)
    touches = [Touch(f, "ball", "floor", 0.2) for f in hits]
    touches += [Touch(f, "ball", "floor", 0.01) for f in range(FRAMES)] if slides else []
    events = [Event((f - 0.5) / FPS, "ball", "floor") for f in hits]
    stage: Stage = "probe" if probe else "full"
    channels = {} if velocity is None else {"velocity": velocity}
    tracks = {"ball": (place, IDENTITY)}
    made = make_candidate(folder, spec, tracks=tracks, touches=touches, events=events, stage=stage, channels=channels)
    return World(made, culprits)


def _between(*spans: tuple[int, int]) -> F64:
    """1 m during some spans of frames, else 0."""
    value = np.zeros(FRAMES)
    for first, last in spans:
        value[first : last + 1] = 1.0
    return value


# ---------------------------------------------------------------- true before


def _bounces(folder: Path, m: float, rng: RNG, *, owned: bool, honest: bool) -> World:
    """Two bounces, m frames apart; the beat asks for the second."""
    first = int(rng.integers(4, 20))
    second = first + max(3, round(m))
    beats = {"second": _beat(FLOOR, second - 1, causes=["first"] if owned else [])}
    if owned:
        beats["first"] = _beat(FLOOR, first - 2, first + 1)
    return _world(folder, beats, () if honest else ("second",), hits=(first, second))


def _happened_before(folder: Path, m: float, rng: RNG) -> World:
    return _bounces(folder, m, rng, owned=False, honest=False)


def _second_of_two(folder: Path, m: float, rng: RNG) -> World:
    return _bounces(folder, m, rng, owned=True, honest=True)


def _lasts_since(folder: Path, m: float, rng: RNG) -> World:
    """It went away m frames before the interval, and stayed away."""
    went = int(rng.integers(3, 20))
    return _world(folder, {"goes": _beat(FAR, went + round(m))}, ("goes",), x=_between((went, LAST)))


def _went_again(folder: Path, m: float, rng: RNG) -> World:
    """It went away, came back m frames before the interval, and goes away again in it."""
    went = int(rng.integers(2, 10))
    begins = went + 6 + round(m)
    return _world(folder, {"goes": _beat(FAR, begins)}, (), x=_between((went, went + 5), (begins + 3, LAST)))


def _came_before(folder: Path, m: float, rng: RNG) -> World:
    """It was where it should come to for m frames, long before."""
    came = int(rng.integers(3, 12))
    x = 1.0 - _between((came, came + round(m) - 1), (55, LAST))
    return _world(folder, {"comes": _beat(HOME, 50)}, ("comes",), x=x)


def _comes_home(folder: Path, m: float, rng: RNG) -> World:
    """It starts there, leaves after m frames, and comes back."""
    return _world(folder, {"comes": _beat(HOME, 50)}, (), x=1.0 - _between((0, round(m)), (int(rng.integers(50, 60)), LAST)))


def _starts(folder: Path, m: float, rng: RNG, culprits: tuple[str, ...], *causes: str) -> World:
    """It stays near where it starts for m frames, and goes away later."""
    goes = round(m) + int(rng.integers(2, 12))
    near = Displacement(entity="ball", max=0.1, when="always")
    first = int(rng.integers(0, round(m)))
    beats = {"stays": _beat(near, first, round(m)), "goes": _beat(FAR, round(m) + 1, causes=list(causes))}
    return _world(folder, beats, culprits, x=_between((goes, LAST)), velocity=None)


def _start_as_cause(folder: Path, m: float, rng: RNG) -> World:
    return _starts(folder, m, rng, ("stays",), "stays")


def _told_start(folder: Path, m: float, rng: RNG) -> World:
    return _starts(folder, m, rng, ())


# ---------------------------------------------------------------- one of several


def _either(folder: Path, blow: float, *culprits: str) -> World:
    """It goes away, or it is hit with an impulse [N s]; the log knows one blow of 0.2 N s."""
    either = Or(of=[FAR, Contact(a="ball", b="floor", min_impulse=blow)])
    return _world(folder, {"goes": _beat(either, 5)}, culprits, x=np.clip(TIME - 0.5, 0, None), hits=(20,))


def _one_side_never(folder: Path, m: float, rng: RNG) -> World:
    return _either(folder, 0.2 * m, "goes")


def _both_sides(folder: Path, m: float, rng: RNG) -> World:
    return _either(folder, 0.2 * m)


# ---------------------------------------------------------------- what starts it


def _set_off(folder: Path, at: float, *, sent: bool, honest: bool, **more: Any) -> World:
    """It moves from a time [s] on."""
    beats = {"goes": _beat(FAR, 2, owner=more.pop("owner", "rigid")), **more.pop("beats", {})}
    return _world(folder, beats, () if honest else ("ball",), x=np.clip(TIME - at, 0, None), sent=sent, **more)


def _from_nothing(folder: Path, m: float, rng: RNG) -> World:
    return _set_off(folder, m, sent=False, honest=False)


def _sent_off(folder: Path, m: float, rng: RNG) -> World:
    return _set_off(folder, m, sent=True, honest=True)


def _push(m: float) -> dict[str, ForceDriver]:
    return {"push": ForceDriver(entity="ball", force=(1.0, 0, 0), start=m, end=m + 0.5)}


def _unsaid(folder: Path, m: float, rng: RNG) -> World:
    return _set_off(folder, m, sent=bool(rng.random() < 0.5), honest=False, drivers=_push(m))


def _owned(folder: Path, m: float, rng: RNG) -> World:
    return _set_off(folder, m, sent=False, honest=True, drivers=_push(m), owner="push")


def _by_weight(folder: Path, m: float, rng: RNG) -> World:
    """It falls from frame 0 on, from m metres."""
    z = np.maximum(m - 0.5 * G * TIME**2, 0.1)
    falls = {"falls": _beat(Displacement(entity="ball", axis=(0, 0, -1), min=0.4 * m), 1)}
    return _world(folder, falls, (), z=z, sent=False)


# ---------------------------------------------------------------- how it ends


def _swings(folder: Path, rate: float, rng: RNG, *culprits: str) -> World:
    """A pendulum of 0.5 to 1 m whose amplitude grows by e^(rate t) [1/s], with its exact velocity."""
    length, steps = float(rng.uniform(0.5, 1.0)), 200
    angle, turn, states = float(rng.uniform(0.4, 0.7)), 0.0, []
    for _ in range(FRAMES):
        states.append((angle, turn))
        for _ in range(steps):
            turn += (2 * rate * turn - G / length * np.sin(angle)) / FPS / steps
            angle += turn / FPS / steps
    at, speed = np.array(states).T
    along, up = length * speed * np.cos(at), length * speed * np.sin(at)
    beats = {"goes": _beat(Displacement(entity="ball", min=0.05), 1, 20)}
    velocity = np.stack([along, 0 * along, up], axis=1)[:, None]
    return _world(folder, beats, culprits, x=length * np.sin(at), z=2.0 - length * np.cos(at), probe=True, velocity=velocity)


def _grows(folder: Path, m: float, rng: RNG) -> World:
    return _swings(folder, m, rng, "ball")


def _decays(folder: Path, m: float, rng: RNG) -> World:
    return _swings(folder, -m, rng)


def _goes_on(folder: Path, speed: Any, *culprits: str, **more: Any) -> World:
    """It goes along x at a speed [m/s] over time."""
    x = np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1])) / FPS])
    return _world(folder, {"goes": _beat(Displacement(entity="ball", min=0.05), 1, 20)}, culprits, x=x, probe=True, **more)


def _blows_up(folder: Path, m: float, rng: RNG) -> World:
    """It slides, and its energy grows by m times what is allowed during the last fifth of a second."""
    late = np.clip((TIME - TIME[-5]) / (TIME[-1] - TIME[-5]), 0, 1)
    return _goes_on(folder, 2.0 * np.sqrt(1.0 + m * GROWTH / (1.0 - min(0.9, m * GROWTH)) * late), "ball", slides=True)


def _slides_on(folder: Path, m: float, rng: RNG) -> World:
    """On ice, at a speed that trembles by a share m."""
    return _goes_on(folder, 2.0 * (1.0 + m * np.sin(rng.uniform(20, 60) * TIME)), slides=True)


def _flies_on(folder: Path, m: float, rng: RNG) -> World:
    """It falls at m metres per second sideways to the end."""
    return _goes_on(folder, np.full(FRAMES, m), z=60.0 - 0.5 * G * TIME**2)


# ---------------------------------------------------------------- helped along


def _spring(folder: Path, m: float, rng: RNG) -> World:
    return World(sprung_block(folder, load=m), ("block",))


def _spring_told(folder: Path, m: float, rng: RNG) -> World:
    return World(sprung_block(folder, load=m, told="release"), ())


def _rail(folder: Path, m: float, rng: RNG) -> World:
    return World(guided_block(folder, speed=m, friction=0.0), ("block",))


def _rough_rail(folder: Path, m: float, rng: RNG) -> World:
    return World(guided_block(folder, speed=m, friction=1.0), ())


def _hand(folder: Path, m: float, rng: RNG) -> World:
    return World(pushed_row(folder, between=round(m) - 1, told=False), ("last",))


def _hand_told(folder: Path, m: float, rng: RNG) -> World:
    return World(pushed_row(folder, between=round(m) - 1, told=True), ())


SUITE = Suite(
    "beat",
    (
        Mechanism("happened-before", "a contact that happened before its interval", True, _happened_before, 3, 40, "frames"),
        Mechanism("lasts-since-before", "a state that lasts since before its interval", True, _lasts_since, 1, 40, "frames"),
        Mechanism("came-before", "was already there once", True, _came_before, 1, 30, "frames"),
        Mechanism("start-as-cause", "a state from frame 0 on, named as a cause", True, _start_as_cause, 2, 40, "frames"),
        Mechanism(
            "one-side-never",
            "an `or` one side of which never comes true",
            True,
            _one_side_never,
            1.1,
            5000,
            "times the blow",
            1.0,
        ),
        Mechanism("from-nothing", "moves by itself, later than frame 0", True, _from_nothing, 0.2, 1.5, "s"),
        Mechanism("unsaid-driver", "a driver that no beat owns starts it", True, _unsaid, 0.2, 1.5, "s"),
        Mechanism("loaded-spring", "a spring of no beat drives it on", True, _spring, 0.3, 1.5, "m"),
        Mechanism("hand-behind", "a body on a path of no beat pushes it, through others", True, _hand, 1, 3, "bodies"),
        Mechanism("smooth-rail", "a slide bears it where it would rub", True, _rail, 1.5, 3.0, "m/s"),
        Mechanism("swing-grows", "a swing gains from nowhere, its beats long over", True, _grows, 0.2, 0.5, "1/s"),
        Mechanism("blows-up", "gains energy at the very end", True, _blows_up, 1.3, 15, "times the bound", 1.0),
        Mechanism("second-of-two", "a second bounce whose first has a beat", False, _second_of_two, 3, 40, "frames"),
        Mechanism("told-start", "a state from frame 0 on that no beat names", False, _told_start, 2, 40, "frames"),
        Mechanism("went-again", "a state that ended and comes back", False, _went_again, 1, 40, "frames"),
        Mechanism("comes-home", "starts there, leaves and comes back", False, _comes_home, 1, 30, "frames"),
        Mechanism("both-sides", "an `or` both sides of which come true", False, _both_sides, 0.1, 0.9, "times the blow"),
        Mechanism("sent-off", "starts with a declared velocity", False, _sent_off, 0.2, 1.5, "s"),
        Mechanism("owned-driver", "its own driver starts it", False, _owned, 0.2, 1.5, "s"),
        Mechanism("spring-told", "a spring that a release of a beat lets act", False, _spring_told, 0.3, 1.5, "m"),
        Mechanism("hand-told", "a body on a path of a beat pushes it, through others", False, _hand_told, 1, 3, "bodies"),
        Mechanism("rough-rail", "a slide with the friction of its surfaces", False, _rough_rail, 1.5, 3.0, "m/s"),
        Mechanism("by-weight", "falls from frame 0 on", False, _by_weight, 0.5, 5.0, "m"),
        Mechanism("swing-decays", "still swings at the end, ever less", False, _decays, 0.01, 1.0, "1/s"),
        Mechanism("slides-on", "a puck on ice", False, _slides_on, 1e-4, 0.01, "1"),
        Mechanism("flies-on", "still falls at the end", False, _flies_on, 0.5, 5.0, "m/s"),
    ),
)
