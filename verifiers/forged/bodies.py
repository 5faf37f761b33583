"""Forged motions of bodies, by kind of event: `it` does what the kind says, to `other` or on it where somebody else takes part.

Measures are modest: a few times a kind's own threshold, so that nobody hides behind an event that is larger than a plain one.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from ...worlds.arrays import F64
from ...worlds.spec import DetachDriver, ForceDriver, HingeJoint, WeldJoint
from ...worlds.spec.fields import FieldDriver, WindField
from .bounds import HALF, SOFT, WAY
from .stage import FPS, G, Stage

__all__ = ["BLOCK", "BODIES", "GAP"]

BLOCK = (2 * HALF,) * 3
GAP = 0.0005
"""Between what touches [m]."""
STEPS = 6
"""Frames of free fall over about that way: G (6 / 24 s)^2 / 2 = 0.31 m."""
FLOOR = (20.0, 20.0, 0.2)


def on_floor(frames: int) -> Stage:
    """A stage with a floor whose top is z = 0."""
    stage = Stage(frames)
    stage.add("floor", FLOOR, (0, 0, -0.1), motion="static")
    return stage


def _along(axis: int, values: F64) -> F64:
    result = np.zeros((len(values), 3))
    result[:, axis] = values
    return result


def _ramp(frames: int, first: float, last: float, over: int) -> F64:
    """From one value to another over some frames, and that one afterwards."""
    return np.asarray(np.interp(np.arange(frames), [0, over], [first, last]))


def fall() -> Stage:
    """It falls onto the other and stays."""
    stage = Stage(24)
    speeds = np.where(np.arange(24) <= STEPS, -G * stage.times, 0.0)
    drop = float(-(0.5 * (speeds[:-1] + speeds[1:])).sum() / FPS)
    stage.add("other", FLOOR, (0, 0, -0.1), motion="static")
    stage.add("it", BLOCK, (0, 0, HALF + GAP + drop), velocity=_along(2, speeds))
    stage.touch("other", "it", over=slice(STEPS, None), speed=-float(speeds[STEPS]))
    return stage


def bounce() -> Stage:
    """It falls onto the other and comes off it."""
    stage = Stage(16)
    up = 0.8 * G * STEPS / FPS - G * (stage.times - (STEPS + 1) / FPS)
    speeds = np.where(np.arange(16) <= STEPS, -G * stage.times, up)
    middle = _along(2, speeds)
    lowest = float(min(np.cumsum(0.5 * (speeds[:-1] + speeds[1:]) / FPS)))
    stage.add("other", FLOOR, (0, 0, -0.1), motion="static")
    stage.add("it", (HALF,), (0, 0, HALF + GAP - lowest), velocity=middle)
    stage.touch("other", "it", over=slice(STEPS, STEPS + 1), speed=-float(speeds[STEPS]))
    return stage


def flight() -> Stage:
    """It flies up and comes down again, and turns all the while."""
    stage = Stage(2 * STEPS + 1)
    stage.add("it", BLOCK, (0, 0, 2), velocity=_along(2, G * (STEPS / FPS - stage.times)), spin=(0, 0, 15.0))
    return stage


def jump() -> Stage:
    """It stands, and leaves the floor."""
    stage = on_floor(STEPS * 2)
    speeds = np.where(np.arange(stage.frames) < STEPS, 0.0, G * (STEPS / FPS - (stage.times - STEPS / FPS)))
    stage.add("it", BLOCK, (0, 0, HALF + GAP), velocity=_along(2, speeds))
    stage.touch("floor", "it", over=slice(0, STEPS))
    return stage


def slide() -> Stage:
    """It slides over the other, slower and slower, and stops."""
    stage = Stage(30)
    stage.add("other", FLOOR, (0, 0, -0.1), motion="static")
    stage.add("it", BLOCK, (0, 0, HALF + GAP), velocity=_along(0, _ramp(30, 4.0 * WAY, 0.0, 12)))
    stage.touch("other", "it")
    return stage


def roll() -> Stage:
    """It rolls over the other."""
    stage = Stage(13)
    stage.add("other", FLOOR, (0, 0, -0.1), motion="static")
    stage.add("it", (HALF,), (0, 0, HALF + GAP), velocity=(1.0, 0, 0), spin=(0, 1.0 / HALF, 0))
    stage.touch("other", "it")
    return stage


def topple() -> Stage:
    """It turns over an edge on the other, and lies."""
    stage = Stage(24)
    thick, tall, frames = 0.4 * HALF, 3.0 * HALF, 16
    rates = _ramp(24, 0.0, np.pi / (frames / FPS), frames)
    rates[frames + 1 :] = 0.0
    over = float(rates[frames] * 0.5 / FPS)
    rates *= 0.5 * np.pi / (0.5 * np.pi + over)
    stage.add("other", FLOOR, (0, 0, -0.1), motion="static")
    middle = (0.0, 0.0, tall / 2 + GAP)
    stage.add("it", (thick, HALF, tall), middle, spin=_along(1, rates), arm=(-thick / 2, 0, tall / 2))
    stage.touch("other", "it")
    return stage


def swing() -> Stage:
    """It goes to and fro on a rod of one metre."""
    stage = Stage(60)
    pace, wide = np.sqrt(G), 0.5
    rates = -_along(1, -wide * pace * np.sin(pace * stage.times))
    lean = np.array([np.sin(wide), 0.0, -np.cos(wide)])
    stage.joints["hinge"] = HingeJoint(child="it", anchor=(0, 0, 2), axis=(0, 1, 0))
    stage.add("it", BLOCK, np.add(lean, (0, 0, 2)), spin=rates, arm=lean)
    return stage


def drift() -> Stage:
    """The wind takes it along."""
    stage = Stage(60, gravity=0.0)
    stage.drivers["wind"] = FieldDriver(field=WindField(velocity=(1.0, 0, 0)))
    stage.add("it", (HALF,), (0, 0, 1), velocity=_along(0, _ramp(60, 0.0, 0.3, 59)))
    return stage


def uphill() -> Stage:
    """It goes up on the other."""
    stage = Stage(13)
    stage.add("other", (4, 4, 0.1), (0, 0, 0), motion="static", turn=((0, 1, 0), -np.pi / 4))
    stage.add("it", (HALF,), (0, 0, 0.3), velocity=(2 * WAY, 0, 2 * WAY))
    stage.touch("other", "it")
    return stage


def loose() -> Stage:
    """A weld that held it to the other is opened, and it falls."""
    stage = Stage(13)
    stage.joints["weld"] = WeldJoint(parent="other", child="it", anchor=(0, 0, 2.1))
    stage.drivers["cut"] = DetachDriver(joint="weld", time=STEPS / FPS)
    stage.add("other", (1, 0.1, 0.1), (0, 0, 2.15), motion="static")
    stage.add("it", BLOCK, (0, 0, 2), velocity=_along(2, -G * np.maximum(stage.times - STEPS / FPS, 0.0)))
    return stage


def _door(rates: F64, start: float) -> Stage:
    stage = Stage(len(rates))
    half = np.array([0.43, 0.0, 0.0])
    place = np.array([half[0] * np.cos(start), half[0] * np.sin(start), 1.0])
    stage.joints["hinge"] = HingeJoint(parent="other", child="it", anchor=(0, 0, 1), axis=(0, 0, 1))
    stage.add("other", (0.1, 0.1, 2), (0.91, 0, 1), motion="static")
    stage.add("it", (0.84, 0.04, 1.8), place, spin=_along(2, rates), arm=place - (0, 0, 1), turn=((0, 0, 1), start))
    return stage


def opening() -> Stage:
    """It lies against the other, and opens."""
    return _door(_ramp(25, 0.0, 2.4, 24), 0.0)


def closing() -> Stage:
    """It stands open, and comes to lie against the other."""
    return _door(-_ramp(25, 2.4, 0.0, 24), 1.2)


def blow() -> Stage:
    """It hits the other, which rests."""
    return _struck(np.sqrt(2.0 * G * WAY))


def touch() -> Stage:
    """It touches the other softly."""
    return _struck(SOFT)


def _struck(fast: float) -> Stage:
    stage, at = on_floor(13), 5
    before = np.arange(13) <= at
    stage.add(
        "it",
        BLOCK,
        (-2 * HALF - GAP - fast * (at + 0.6) / FPS, 0, HALF + GAP),
        velocity=_along(0, np.where(before, fast, 0.2 * fast)),
    )
    stage.add("other", BLOCK, (0, 0, HALF + GAP), velocity=_along(0, np.where(before, 0.0, 0.8 * fast)))
    stage.touch("it", "other", impulse=(stage.actors["it"].mass * 0.8 * fast, 0, 0), over=slice(at, at + 1), speed=float(fast))
    for name in ("it", "other"):
        stage.touch("floor", name)
    return stage


def _moved(offset: float) -> Stage:
    """It takes the other along the floor, from behind or from before it."""
    stage = on_floor(25)
    speeds = _along(0, _ramp(25, 0.0, 2.0 * WAY, 24))
    stage.add("it", BLOCK, (offset * (2 * HALF + GAP), 0, HALF + GAP), motion="kinematic", velocity=speeds)
    stage.add("other", BLOCK, (0, 0, HALF + GAP), velocity=speeds)
    mass = stage.actors["other"].mass
    stage.touch("it", "other", impulse=(mass * (2.0 * WAY / 24 + 0.3 * G / FPS), 0, 0))
    stage.touch("floor", "other")
    return stage


def push() -> Stage:
    """It pushes the other along."""
    return _moved(-1.0)


def pull() -> Stage:
    """It goes before the other and takes it along."""
    return _moved(1.0)


def _carried(speeds: F64, leaves: int | None = None) -> Stage:
    """It carries the other on itself; the other leaves it where told."""
    stage = Stage(len(speeds))
    flies = speeds.copy()
    if leaves is not None:
        flies[leaves:] = speeds[leaves] - G * (stage.times[leaves:] - stage.times[leaves])
        speeds = speeds.copy()
        speeds[leaves + 1 :] = 0.0
    stage.add("it", (0.4, 0.4, 2 * HALF), (0, 0, 1), motion="kinematic", velocity=_along(2, speeds))
    stage.add("other", BLOCK, (0, 0, 1 + 2 * HALF + GAP), velocity=_along(2, flies))
    stage.touch("it", "other", over=slice(0, leaves))
    return stage


def lift() -> Stage:
    """It takes the other up."""
    return _carried(_ramp(25, 0.0, 2.0 * WAY, 24))


def lower() -> Stage:
    """It takes the other down."""
    return _carried(_ramp(25, 0.0, -2.0 * WAY, 24))


def throw() -> Stage:
    """It sends the other up, faster and faster, and lets it fly."""
    return _carried(_ramp(16, 0.0, np.sqrt(2.0 * G * WAY), STEPS), STEPS)


def lean() -> Stage:
    """It stands with its foot on the floor and its head against the other."""
    tilt, thick, tall = np.radians(20.0), 0.04, 1.0
    low = (0.5 * tall * np.sin(tilt) + 0.5 * thick * np.cos(tilt), 0.5 * tall * np.cos(tilt) + 0.5 * thick * np.sin(tilt))
    stage = on_floor(25)
    stage.add("other", (0.2, 2, 2), (0.1, 0, 1), motion="static")
    stage.add("it", (thick, 0.2, tall), (-low[0] - GAP, 0, low[1] + GAP), turn=((0, 1, 0), tilt))
    stage.touch("floor", "it")
    return stage


def jam() -> Stage:
    """A force presses it against the other, which holds it."""
    stage = on_floor(25)
    stage.add("other", (0.2, 2, 0.5), (2 * HALF + GAP, 0, 0.25), motion="static")
    stage.add("it", BLOCK, (0, 0, HALF + GAP))
    press = 0.5 * stage.actors["it"].mass * G
    stage.drivers["press"] = ForceDriver(entity="it", force=(press, 0, 0), start=0.0, end=10.0)
    stage.touch("other", "it", impulse=(-press / FPS, 0, 0))
    stage.touch("floor", "it")
    return stage


BODIES: Mapping[str, Callable[[], Stage]] = {
    **dict.fromkeys(("falls", "lands", "rests_on"), fall),
    **dict.fromkeys(("rises", "spins"), flight),
    **dict.fromkeys(("stops", "slows", "slides", "speed"), slide),
    "tips": topple,
    "hits": blow,
    "contact": touch,
    "swings": swing,
    "jumps": jump,
    "drifts": drift,
    "rolls": roll,
    "bounces": bounce,
    "goes_uphill": uphill,
    "comes_loose": loose,
    "opens": opening,
    "closes": closing,
    "joint_angle": opening,
    "pushes": push,
    "pulls": pull,
    "lifts": lift,
    "lowers": lower,
    "throws": throw,
    "rests_against": lean,
    "jams": jam,
}
"""By kind of predicate."""
