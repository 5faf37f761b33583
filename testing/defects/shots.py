"""Seeded defects of the shot plan: beats that nobody sees, cameras where none can be, pictures too fast to follow."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from ...verifiers.shots.bounds import MOMENT, NEAR_PLANE, SCREEN_STEP
from ...worlds.spec import Box, Cylinder, Limits, Part, Pose, Sphere
from ._shot_light import LIGHT
from ._shot_moments import MOMENTS
from ._shot_worlds import ASPECT, RNG, Rig
from .cases import Mechanism, Suite, World

__all__ = ["SUITE"]

PIXELS, SHARE, SEEN = Limits().visible_pixels, Limits().visible_share, Limits().beat_seen_frames
OVER, UNDER = 1.05, 0.95
"""Just over and just under a bound."""
FPS = 24


# ---------------------------------------------------------------- the plan


def _plan(rig: Rig, rng: RNG) -> None:
    """A subject in plain view, and a beat of it."""
    place = rig.spot(float(rng.uniform(-0.4, 0.4)), float(rng.uniform(-0.4, 0.4)))
    path = rig.still(place)
    path[rig.frames // 2 :] += 0.02 * rig.axes[0]
    side = 0.05 * rig.distance
    shape = Sphere(radius=side / 2) if rng.random() < 0.3 else Box(size=(side,) * 3)
    rig.add("subject", shape, place, path=path)
    rig.beat("event", "subject")


def _hole(folder: Path, m: float, rng: RNG) -> World:
    """m frames at the beginning, in the middle or at the end belong to no shot."""
    rig, gap, kind = Rig(rng), round(m), int(rng.integers(3))
    _plan(rig, rng)
    last, cut = rig.frames - 1, int(rng.integers(4, 8))
    first, second = [
        ((gap, cut + gap), (cut + gap + 1, last)),
        ((0, cut), (cut + gap + 1, last)),
        ((0, cut), (cut + 1, last - gap)),
    ][kind]
    rig.shot("a", first)
    rig.shot("b", second)
    return rig.world(folder, "shots:tiling")


def _double(folder: Path, m: float, rng: RNG) -> World:
    """Two shots share m frames, or one lies within another."""
    rig, shared, last = Rig(rng), round(m), 23
    _plan(rig, rng)
    if rng.random() < 0.5:
        rig.shot("a", (0, 8 + shared - 1))
        rig.shot("b", (8, last))
    else:
        rig.shot("a")
        if shared > 0:
            rig.shot("b", (5, 5 + shared - 1))
    return rig.world(folder, "shots:tiling")


def _elsewhere(folder: Path, m: float, rng: RNG) -> World:
    """The shot that covers the beat ends m frames before it begins."""
    rig, early = Rig(rng), round(m)
    _plan(rig, rng)
    rig.beat("event", "subject", (14, 23))
    rig.shot("a", (0, 14 - early), covers=["event"])
    rig.shot("b", (15 - early, 23))
    return rig.world(folder, "event")


# ---------------------------------------------------------------- what is seen


def _plate(rig: Rig, rng: RNG, share: float, *, path: bool = True) -> float:
    """The subject: a flat plate that faces the camera and fills a share of the picture; its side [m]."""
    shape = float(np.exp(rng.uniform(-1, 1)))
    area = share * rig.wide * rig.wide / ASPECT
    high = math.sqrt(area / shape)
    place, roll = rig.spot(float(rng.uniform(-0.5, 0.5)), float(rng.uniform(-0.5, 0.5))), float(rng.uniform(-3, 3))
    # So thin and so near to the axis that its edges add nothing that counts.
    rig.add("subject", Box(size=(area / high, high, 1e-4 * high)), place, roll=roll, path=rig.still(place) if path else None)
    return high


def _sized(folder: Path, rng: RNG, share: float, *culprits: str) -> World:
    rig = Rig(rng)
    _plate(rig, rng, share)
    rig.beat("event", "subject")
    rig.shot("a", covers=["event"])
    return rig.world(folder, *culprits)


def _speck(folder: Path, m: float, rng: RNG) -> World:
    return _sized(folder, rng, PIXELS / m, "event")


def _covered(folder: Path, rng: RNG, shown: float, *culprits: str) -> World:
    """A wall, a fence or a hole in a wall leaves a share of the subject to be seen."""
    rig, kind = Rig(rng, crowd=False), int(rng.integers(3))
    side = 0.3 * rig.wide / ASPECT
    place = rig.spot(float(rng.uniform(-0.3, 0.3)), float(rng.uniform(-0.3, 0.3)))
    rig.add("subject", Box(size=(side, side, 1e-4)), place, path=rig.still(place))
    # The wall stands at half the depth, where the same pictures are half as large.
    half = 0.5 * (place + rig.eye)
    side *= 0.5
    if kind == 0:
        wall = Part(shape=Box(size=(side, 3 * side, 1e-3)), pose=Pose(position=(shown * side, 0, 0)))
        rig.add("wall", wall, half, roll=float(rng.choice([0, np.pi / 2, np.pi])))
    elif kind == 1:
        count = int(rng.integers(2, 6))
        pitch = side / count
        slats = tuple(
            Part(
                shape=Box(size=((1 - shown) * pitch, 3 * side, 1e-3)),
                pose=Pose(position=(-side / 2 + (k + 0.5) * pitch, 0, 0)),
            )
            for k in range(count)
        )
        rig.add("wall", slats, half)
    else:
        hole, rim = math.sqrt(shown) * side, 2 * side
        frame = (
            Part(shape=Box(size=(rim, (rim - hole) / 2, 1e-3)), pose=Pose(position=(0, (rim + hole) / 4, 0))),
            Part(shape=Box(size=(rim, (rim - hole) / 2, 1e-3)), pose=Pose(position=(0, -(rim + hole) / 4, 0))),
            Part(shape=Box(size=((rim - hole) / 2, hole, 1e-3)), pose=Pose(position=((rim + hole) / 4, 0, 0))),
            Part(shape=Box(size=((rim - hole) / 2, hole, 1e-3)), pose=Pose(position=(-(rim + hole) / 4, 0, 0))),
        )
        rig.add("wall", frame, half)
    rig.beat("event", "subject")
    rig.shot("a", covers=["event"])
    return rig.world(folder, *culprits)


def _behind_a_wall(folder: Path, m: float, rng: RNG) -> World:
    return _covered(folder, rng, SHARE / m, "event")


def _timed(folder: Path, rng: RNG, count: int, frames: int, *culprits: str) -> World:
    """The subject is in view at `count` of the frames, in one stretch or scattered; else beside or behind the camera."""
    rig = Rig(rng, frames=frames)
    away = [rig.at(5.0, 0, -2.0), rig.spot(3.0, 0.0), rig.spot(0.0, -4.0)][int(rng.integers(3))]
    path = np.tile(away, (frames, 1))
    start = int(rng.integers(0, frames - count + 1))
    chosen = rng.permutation(frames)[:count] if rng.random() < 0.5 else np.arange(start, start + count)
    path[chosen] = rig.spot(0.1, 0.1)
    rig.add("subject", Box(size=(0.05 * rig.distance,) * 3), path[0], path=path)
    # True where it first comes into view, or goes out of it.
    rig.beat("event", "subject")
    rig.shot("a")
    return rig.world(folder, *culprits)


def _too_brief(folder: Path, m: float, rng: RNG) -> World:
    frames = int(rng.choice([40, 60]))
    return _timed(folder, rng, math.ceil(SEEN / m * frames) - 1, frames, "event")


def _hidden_for(folder: Path, rng: RNG, before: int, after: int, *culprits: str) -> World:
    """It moves at one frame, and from `before` frames before to `after` frames after something stands in front of it."""
    rig, frames = Rig(rng, frames=48), 48
    moment = int(rng.integers(before + 2, frames - after - 1))
    place = rig.spot(float(rng.uniform(-0.4, 0.4)), float(rng.uniform(-0.4, 0.4)))
    path = rig.still(place)
    path[moment:] += 0.01 * rig.axes[1]
    side = 0.05 * rig.distance
    rig.add("subject", Box(size=(side,) * 3), place, path=path)
    cover, gone = 0.5 * (place + rig.eye), rig.at(30.0, 0, -30.0)
    hides = np.tile(gone, (frames, 1))
    hides[moment - before : moment + after + 1] = cover
    rig.add("screen", Box(size=(2 * side, 2 * side, 0.01)), gone, path=hides)
    rig.beat("event", "subject", (0, frames - 1))
    rig.shot("a", covers=["event"])
    return rig.world(folder, *culprits)


def _hidden_moment(folder: Path, m: float, rng: RNG) -> World:
    reach = math.ceil(m * FPS)
    return _hidden_for(folder, rng, reach, reach, "event")


def _out_of_picture(folder: Path, m: float, rng: RNG) -> World:
    """m half widths beside the picture's middle, or behind the camera."""
    rig = Rig(rng)
    place = rig.spot(float(rng.choice([-1.0, 1.0])) * m, 0.2) if rng.random() < 0.6 else rig.at(0.1, 0.1, -m)
    path = rig.still(place)
    path[12:] += 0.01 * rig.axes[1]
    rig.add("subject", Box(size=(0.02 * rig.distance,) * 3), place, path=path)
    rig.beat("event", "subject")
    rig.shot("a", covers=["event"])
    return rig.world(folder, "event")


def _flush(folder: Path, m: float, rng: RNG) -> World:
    """A plate of side m let into a wall: both faces lie in one plane."""
    rig = Rig(rng, fov=40.0)
    place = rig.spot(float(rng.uniform(-0.2, 0.2)), float(rng.uniform(-0.2, 0.2)))
    roll = float(rng.uniform(-3, 3))
    rig.add("subject", Box(size=(m, m, 0.1)), place, roll=roll, path=rig.still(place))
    rig.add("wall", Box(size=(3 + m, 3 + m, 0.1)), place, roll=roll)
    rig.beat("event", "subject")
    rig.shot("a", covers=["event"])
    return rig.world(folder, "event")


def _unframed(folder: Path, m: float, rng: RNG) -> World:
    """A named subject of the shot, or what it follows, is m half widths beside the picture, in this shot."""
    rig = Rig(rng)
    _plan(rig, rng)
    place = rig.spot(float(rng.choice([-1.0, 1.0])) * m, 0.0)
    path = rig.still(place)
    follows = rng.random() < 0.5
    if follows:
        path += np.linspace(0, 1, rig.frames)[:, None] * 0.2 * rig.axes[0]
    rig.add("star", Box(size=(0.02 * rig.distance,) * 3), place, path=path)
    rig.shot("a", (0, 11), **({"follow": "star"} if follows else {"subjects": ["star"]}))
    rig.shot("b", (12, 23), rig.key(aim=place))
    return rig.world(folder, "star")


# ---------------------------------------------------------------- cameras


def _engulfed(folder: Path, m: float, rng: RNG) -> World:
    """A body of side m is around the camera at one frame, which may be the last."""
    rig = Rig(rng)
    frame = int(rng.choice([0, rig.frames - 1, int(rng.integers(rig.frames))]))
    path = np.tile(rig.at(0, 0, -50.0), (rig.frames, 1))
    path[frame] = rig.at(*(rng.uniform(-0.3, 0.3, 3) * m))
    rig.add("intruder", Sphere(radius=m / 2) if rng.random() < 0.3 else Box(size=(m,) * 3), path[0], path=path)
    rig.shot("a")
    return rig.world(folder, "intruder")


def _through(folder: Path, m: float, rng: RNG) -> World:
    """A wall of thickness m lies between two frames of the camera's path, or flies through the camera."""
    rig = Rig(rng)
    step = 0.5 * SCREEN_STEP * rig.distance
    m = min(m, 0.5 * step)
    frame = int(rng.integers(1, rig.frames))
    wall = Box(size=(3, 3, m))
    if rng.random() < 0.5:
        # The wall comes from behind and is ahead of the camera at the next frame.
        path = np.tile(rig.at(0, 0, -2.0), (rig.frames, 1))
        path[frame:] = rig.at(0, 0, 1.0)
        rig.add("wall", wall, path[0], path=path)
        rig.shot("a")
    else:
        ahead = np.zeros(rig.frames)
        ahead[frame:] = step
        keys = [rig.key(k, eye=rig.at(0, 0, a), aim=rig.at(0, 0, a + rig.distance)) for k, a in enumerate(ahead)]
        rig.add("wall", wall, rig.at(0, 0, step / 2))
        rig.shot("a", None, *keys)
    return rig.world(folder, "wall")


def _close(folder: Path, rng: RNG, share: float, *culprits: str) -> World:
    """A wall ahead of or beside the camera at a share of what its near plane reaches."""
    rig = Rig(rng)
    reach = NEAR_PLANE * math.sqrt(1 + rig.tall**2 * (1 + ASPECT**2))
    wall, thick = share * reach, 0.05
    if rng.random() < 0.5:
        rig.add("wall", Box(size=(0.5, 0.5, thick)), rig.at(0, 0, wall + thick / 2))
    else:
        rig.add("wall", Box(size=(thick, 0.5, 0.5)), rig.at(wall + thick / 2, 0, 0))
    rig.shot("a")
    return rig.world(folder, *culprits)


def _cut_open(folder: Path, m: float, rng: RNG) -> World:
    return _close(folder, rng, 1 / m, "wall")


def _moved(folder: Path, rng: RNG, step: float, *culprits: str, across: bool = False) -> World:
    """From one frame to the next the picture pans, travels, zooms or its subject runs by `step`."""
    rig, kind = Rig(rng, fov=float(rng.uniform(25, 60))), int(rng.integers(2 if across else 4))
    frame = int(rng.choice([1, rig.frames - 1, int(rng.integers(1, rig.frames))]))
    if kind == 0:
        turn = math.atan(step * 2 * rig.tall * ASPECT)
        aim = rig.at(math.sin(turn) * rig.distance, 0, math.cos(turn) * rig.distance)
        after = rig.key(frame, aim=aim)
    elif kind == 1:
        way = float(rng.choice([-1.0, 1.0])) * step * rig.distance * rig.axes[2]
        after = rig.key(frame, eye=rig.eye + way, aim=rig.at(0, 0, rig.distance) + way)
    elif kind == 2:
        after = rig.key(frame, fov=math.degrees(2 * math.atan(rig.tall / (1 + 2 * step))))
    else:
        path = rig.still(rig.spot(-step, 0.1))
        path[frame:] = rig.spot(step, 0.1)
        rig.add("subject", Box(size=(0.03 * rig.wide,) * 3), path[0], path=path)
        rig.shot("a", subjects=["subject"])
        return rig.world(folder, *culprits)
    if across:
        rig.shot("b", (0, frame - 1))
        rig.shot("a", (frame, rig.frames - 1), after, transition="continue")
    else:
        rig.shot("a", None, rig.key(0), rig.key(frame - 1), after)
    return rig.world(folder, *culprits)


def _too_fast(folder: Path, m: float, rng: RNG) -> World:
    return _moved(folder, rng, m, "a", "subject")


def _false_continuation(folder: Path, m: float, rng: RNG) -> World:
    return _moved(folder, rng, m, "a", across=True)


def _spun(folder: Path, m: float, rng: RNG) -> World:
    """The camera looks down from above its aim and swings around it by m rad in one frame: the picture spins."""
    rig, frame = Rig(rng), int(rng.integers(1, 24))
    aim, high, out = rig.eye - np.array([0, 0, 6.0]), 6.0, 0.02
    start = float(rng.uniform(-3, 3))
    eyes = [aim + np.array([out * math.cos(a), out * math.sin(a), high]) for a in (start, start + m)]
    keys = [rig.key(f, eye=e, aim=aim) for f, e in ((0, eyes[0]), (frame - 1, eyes[0]), (frame, eyes[1]))]
    rig.shot("a", None, *keys)
    return rig.world(folder, "a")


# ---------------------------------------------------------------- clean


def _many_shots(folder: Path, m: float, rng: RNG) -> World:
    rig, count = Rig(rng), round(m)
    _plan(rig, rng)
    starts = np.linspace(0, rig.frames, count + 1).astype(int)
    for k in range(count):
        side = rig.at(0.3 * float(rng.uniform(-1, 1)) * rig.distance, 0, 0)
        rig.shot(f"s{k}", (int(starts[k]), int(starts[k + 1]) - 1), rig.key(eye=side))
    return rig.world(folder)


def _just_large_enough(folder: Path, m: float, rng: RNG) -> World:
    return _sized(folder, rng, PIXELS * m)


def _peeping_out(folder: Path, m: float, rng: RNG) -> World:
    return _covered(folder, rng, min(SHARE * m, 0.95))


def _just_long_enough(folder: Path, m: float, rng: RNG) -> World:
    frames = int(rng.choice([40, 60]))
    return _timed(folder, rng, min(frames, math.ceil(SEEN * m * frames)), frames)


def _passed_by(folder: Path, m: float, rng: RNG) -> World:
    """Hidden around the moment, but seen within `MOMENT` before or after."""
    short = min(round(m * FPS), round(MOMENT * FPS) - 1)
    long = int(rng.integers(0, 12))
    before, after = (short, long) if rng.random() < 0.5 else (long, short)
    return _hidden_for(folder, rng, before, after)


def _near_a_wall(folder: Path, m: float, rng: RNG) -> World:
    return _close(folder, rng, m)


def _fast_but_legal(folder: Path, m: float, rng: RNG) -> World:
    return _moved(folder, rng, m)


def _through_a_door(folder: Path, m: float, rng: RNG) -> World:
    """The camera travels through an opening with a clearance of m on both sides."""
    rig = Rig(rng)
    parts = tuple(Part(shape=Box(size=(1, 4, 0.2)), pose=Pose(position=(side * (0.5 + m), 0, 0))) for side in (-1, 1))
    rig.add("frame", parts, rig.at(0, 0, 1.0))
    keys = [rig.key(f, eye=rig.at(0, 0, a), aim=rig.at(0, 0, a + rig.distance)) for f, a in ((0, 0.0), (23, 2.0))]
    rig.shot("a", None, *keys)
    return rig.world(folder)


def _under_glass(folder: Path, m: float, rng: RNG) -> World:
    """Behind or inside glass of thickness m."""
    rig = Rig(rng)
    _plan(rig, rng)
    place = np.array(rig.entities["subject"].pose.position)
    if rng.random() < 0.5:
        rig.add("pane", Box(size=(4, 4, m)), 0.5 * (place + rig.eye), glass=True)
    else:
        side = 0.2 * rig.distance
        walls = tuple(Part(shape=Box(size=(side, side, m)), pose=Pose(position=(0, 0, z * side / 2))) for z in (-1, 1))
        rig.add("pane", walls, place, glass=True)
    rig.shot("a", covers=["event"])
    return rig.world(folder)


def _brief_guest(folder: Path, m: float, rng: RNG) -> World:
    """A subject of a still shot that passes through the picture within a few of its frames."""
    rig, stay = Rig(rng, frames=96), max(6, round(m))
    start = int(rng.integers(1, 96 - stay))
    across = np.clip((np.arange(96) - start) / stay, -0.2, 1.2) * 2 - 1
    path = np.array([rig.spot(1.5 * float(x), 0.1) for x in across])
    rig.add("guest", Box(size=(0.06 * rig.distance,) * 3), path[0], path=path)
    rig.shot("a", subjects=["guest"])
    return rig.world(folder)


def _cable(folder: Path, m: float, rng: RNG) -> World:
    """As thin as a share m of a pixel of 108 rows, but long enough to fill twice what it must."""
    rig = Rig(rng)
    thick = m * rig.wide / ASPECT / 108
    length = 2 * PIXELS * rig.wide**2 / ASPECT / thick
    length = min(length, 0.8 * rig.wide)
    thick = 2 * PIXELS * rig.wide**2 / ASPECT / length
    place = rig.spot(0.0, float(rng.uniform(-0.3, 0.3)))
    shape = Part(shape=Cylinder(radius=thick / 2, height=length), pose=Pose(euler=(0, np.pi / 2, 0)))
    rig.add("cable", shape, place, roll=float(rng.choice([0.0, rng.uniform(-0.2, 0.2)])), path=rig.still(place))
    rig.beat("event", "cable")
    rig.shot("a", covers=["event"])
    return rig.world(folder)


def _hard_cut(folder: Path, m: float, rng: RNG) -> World:
    """Cameras m apart follow each other by a cut; one of them looks straight down."""
    rig = Rig(rng)
    rig.shot("a", (0, 11))
    above = rig.eye + np.array([0, 0, m])
    rig.shot("b", (12, 23), rig.key(eye=above, aim=above - np.array([0, 0, 3.0])))
    return rig.world(folder)


SUITE = Suite(
    "shots",
    (
        Mechanism("hole", "frames without a shot", True, _hole, 1, 8, "frames", 0.999),
        Mechanism("double", "frames with two shots", True, _double, 1, 10, "frames", 0.999),
        Mechanism("elsewhere", "the covering shot runs before the beat", True, _elsewhere, 1, 12, "frames"),
        Mechanism("speck", "the subject is too small", True, _speck, OVER, 50, "times too small", 1.0),
        Mechanism("behind-a-wall", "too little of it is unoccluded", True, _behind_a_wall, OVER, 50, "times too little", 1.0),
        Mechanism("too-brief", "in view at too few frames", True, _too_brief, OVER, 5, "times too few", 1.0),
        Mechanism("hidden-moment", "hidden when the beat comes true", True, _hidden_moment, OVER * MOMENT, 0.8, "s", MOMENT),
        Mechanism("out-of-picture", "beside the picture or behind the camera", True, _out_of_picture, 1.1, 10, "half widths"),
        Mechanism("flush", "shares its plane with a wall", True, _flush, 0.3, 2.0, "m"),
        Mechanism("unframed", "a named or followed subject is not in the shot", True, _unframed, 1.2, 8, "half widths"),
        Mechanism("engulfed", "a body around the camera at one frame", True, _engulfed, 0.02, 5, "m"),
        Mechanism("through", "the camera passes through a wall between frames", True, _through, 1e-4, 0.1, "m"),
        Mechanism("cut-open", "the near plane cuts a wall", True, _cut_open, OVER, 20, "times too near", 1.0),
        Mechanism(
            "too-fast", "pans, travels, zooms or shows too fast", True, _too_fast, OVER * SCREEN_STEP, 0.45, "widths", SCREEN_STEP
        ),
        Mechanism(
            "false-continuation",
            "a continued shot jumps",
            True,
            _false_continuation,
            OVER * SCREEN_STEP,
            0.9,
            "widths",
            SCREEN_STEP,
        ),
        Mechanism("spun", "the picture spins", True, _spun, 0.5, 3.1, "rad"),
        Mechanism("many-shots", "short shots that tile", False, _many_shots, 1, 12, "shots"),
        Mechanism("just-large-enough", "small, but enough", False, _just_large_enough, OVER, 20, "times enough"),
        Mechanism("peeping-out", "partly hidden, but enough", False, _peeping_out, OVER, 3.5, "times enough"),
        Mechanism("just-long-enough", "in view for just enough frames", False, _just_long_enough, 1.0, 3.0, "times enough"),
        Mechanism("passed-by", "briefly hidden at the moment", False, _passed_by, 0.02, UNDER * MOMENT, "s"),
        Mechanism("near-a-wall", "close, but not cut", False, _near_a_wall, OVER, 50, "times far enough"),
        Mechanism(
            "fast-but-legal", "pans, travels, zooms or shows fast", False, _fast_but_legal, 0.01, UNDER * SCREEN_STEP, "widths"
        ),
        Mechanism("through-a-door", "through an opening", False, _through_a_door, 0.01, 1.0, "m"),
        Mechanism("under-glass", "behind or inside glass", False, _under_glass, 0.001, 0.05, "m"),
        Mechanism("brief-guest", "passes between two samples", False, _brief_guest, 8, 40, "frames"),
        Mechanism("cable", "thinner than a pixel, but long", False, _cable, 0.3, 3.0, "pixels"),
        Mechanism("hard-cut", "a cut to a far camera", False, _hard_cut, 1, 1000, "m"),
        *MOMENTS,
        *LIGHT,
    ),
)
