"""Causes that are none, and true ones that look doubtful.

Worlds written by hand are judged by order and link. Simulated ones are judged at the probe stage, where causes are also taken
away: in those of the group "only a run without the cause tells", order and link are as they should be.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ...verifiers.story.chains import MOMENTUM_SHARE, PAUSE
from ...worlds.candidate import Candidate
from ...worlds.predicates import And, Contact, Displacement, Speed, Tilts, Topples
from ...worlds.spec import ForceDriver, HingeJoint, PathDriver, SpringJoint, WeldJoint
from ..worlds.simulated_worlds import beat
from ._causal_simulated import SIMULATED
from ._causal_untold import UNTOLD
from ._causal_worlds import FPS, LAST, TIME, Scene, falls
from .cases import Mechanism, Suite, World

__all__ = ["SUITE"]

Rng = np.random.Generator


def _frame_time(rng: Rng, low: int = 8, high: int = 20) -> float:
    """Beginning of some frame's span [s]."""
    return float(rng.integers(low, high)) / FPS


# ---------------------------------------------------------------- broken


def _passes_by(folder: Path, magnitude: float, rng: Rng) -> World:
    scene, start = Scene(rng), _frame_time(rng)
    x = float(rng.uniform(0.5, 1.5))
    scene.domino("glass", x, start)
    scene.slider("ball", x + 1.5 * (TIME - start), y=0.1 + magnitude)
    beats = {
        "passes": beat("ball", Displacement(entity="ball", min=1.5 * start), frames=(0, LAST)),
        "breaks": falls("glass", causes=["passes"]),
    }
    return World(scene.candidate(folder, beats), ("glass",))


def _frames_early(folder: Path, magnitude: float, rng: Rng) -> World:
    """The contact is there, but the effect is past its threshold first."""
    scene, start, early = Scene(rng), _frame_time(rng), max(1, round(magnitude)) / FPS
    scene.domino("d0", 0.0, start + early)
    scene.domino("d1", 0.08, start)
    scene.leans(start, "d0", "d1")
    return World(scene.candidate(folder, {"first": falls("d0"), "second": falls("d1", causes=["first"])}), ("d1",))


def _steps_early(folder: Path, magnitude: float, rng: Rng) -> World:
    """Two contacts in one frame, the effect first."""
    scene, frame = Scene(rng), _frame_time(rng)
    late = frame + float(rng.uniform(magnitude + 5e-4, 1 / FPS))
    for k, start in enumerate((frame - 0.2, frame, frame)):
        scene.domino(f"d{k}", 0.08 * k, start)
    scene.hit(late, "d0", "d1")
    scene.hit(late - magnitude, "d1", "d2")
    beats = {
        "a": beat("d1", Contact(a="d0", b="d1"), frames=(0, LAST)),
        "b": beat("d2", Contact(a="d1", b="d2"), frames=(0, LAST), causes=["a"]),
    }
    return World(scene.candidate(folder, beats), ("d2",))


def _link_before_cause(folder: Path, magnitude: float, rng: Rng) -> World:
    """The second domino is struck by the first one before that one is struck; both in one frame."""
    scene, frame = Scene(rng), _frame_time(rng)
    late = frame + float(rng.uniform(magnitude + 5e-4, 1 / FPS))
    scene.slider("ball", -0.3 + 1.0 * np.minimum(TIME, late))
    scene.domino("d1", late - 0.24, frame)
    scene.domino("d2", late - 0.16, late)
    scene.hit(late, "ball", "d1")
    scene.hit(late - magnitude, "d1", "d2")
    beats = {"hit": beat("d1", Contact(a="ball", b="d1"), frames=(0, LAST)), "end": falls("d2", causes=["hit"])}
    return World(scene.candidate(folder, beats), ("d2",))


def _ground_only(folder: Path, magnitude: float, rng: Rng) -> World:
    """Both touch the floor, ever so hard."""
    scene, start = Scene(rng), _frame_time(rng)
    scene.domino("d0", 0.0, start)
    scene.domino("d1", float(rng.uniform(0.3, 1.0)), start + float(rng.uniform(0.05, 0.3)))
    scene.hit(start + 0.2, "floor", "d0", magnitude)
    scene.hit(start + 0.21, "floor", "d1", magnitude)
    return World(scene.candidate(folder, {"first": falls("d0"), "second": falls("d1", causes=["first"])}), ("d1",))


def _shared_tray(folder: Path, magnitude: float, rng: Rng) -> World:
    """Both stand on a heavy dynamic tray that stays still; `magnitude` is how much its contacts flicker."""
    scene, start = Scene(rng), _frame_time(rng)
    scene.domino("d0", 0.0, start)
    scene.domino("d1", 0.5, start + float(rng.uniform(0.1, 0.4)))
    scene.slider("tray", 0.25, y=0.3, radius=0.2)
    for name in ("d0", "d1"):
        scene.rests("tray", name, 0.1 * (1 + magnitude * rng.uniform(-0.5, 0.5, len(TIME))))
    return World(scene.candidate(folder, {"first": falls("d0"), "second": falls("d1", causes=["first"])}), ("d1",))


def _missing_domino(folder: Path, magnitude: float, rng: Rng) -> World:
    """Some dominoes of the row are not there; a driver pushes the one after the gap in time."""
    scene, start, count = Scene(rng), _frame_time(rng, 4, 8), int(rng.integers(4, 8))
    gap, at = round(magnitude), int(rng.integers(1, count - 1))
    names = [f"d{k}" for k in range(count)]
    for k, name in enumerate(names):
        scene.domino(name, 0.08 * (k + (gap if k > at else 0)), start + 0.1 * k)
        if 0 < k != at + 1:
            scene.leans(start + 0.1 * k, names[k - 1], name)
    push = ForceDriver(entity=names[at + 1], force=(0.5, 0, 0), start=start + 0.1 * (at + 1), end=2.0)
    beats = {"first": falls("d0"), "last": falls(names[-1], causes=["first"])}
    return World(scene.candidate(folder, beats, drivers={"push": push}), (names[-1], names[at + 1]))


def _rested(folder: Path, magnitude: float, rng: Rng) -> World:
    """The chain reached it; it came to rest for `magnitude` seconds, and then moved by itself."""
    scene, start = Scene(rng), _frame_time(rng, 4, 8)
    stop = start + 0.25
    moved = np.clip(TIME - start, 0, 0.25) + np.clip(TIME - stop - magnitude, 0, 1.0)
    scene.slider("a", np.minimum(TIME - start, 0.02) - 0.12)
    scene.slider("b", 0.5 * moved)
    scene.hit(start, "a", "b", 0.4)
    beats = {
        "hit": beat("b", Contact(a="a", b="b"), frames=(0, LAST)),
        "far": beat("b", Displacement(entity="b", min=0.16), frames=(0, LAST), causes=["hit"]),
    }
    return World(scene.candidate(folder, beats), ("b",))


def _wrong_neighbour(folder: Path, magnitude: float, rng: Rng) -> World:
    """Two rows side by side; the effect in one is laid to the other, `magnitude` metres away."""
    scene, start = Scene(rng), _frame_time(rng, 4, 10)
    for row in "ab":
        for k in range(4):
            scene.domino(f"{row}{k}", 0.08 * k, start + 0.1 * k)
            if k:
                scene.leans(start + 0.1 * k, f"{row}{k - 1}", f"{row}{k}")
    for k in range(4):  # the second row stands beside the first
        places, turns = scene.tracks[f"b{k}"]
        shift = scene.at([0, 0.1 + magnitude, 0]) - scene.at([0, 0, 0])
        scene.tracks[f"b{k}"] = places + shift, turns
    return World(scene.candidate(folder, {"first": falls("a1"), "last": falls("b3", causes=["first"])}), ("b3",))


def _common_cause(folder: Path, magnitude: float, rng: Rng) -> World:
    """A hammer strikes one and, `magnitude` seconds later, the other."""
    scene, start = Scene(rng), _frame_time(rng)
    scene.slider("hammer", 1.0 * (TIME - start) - 0.05)
    scene.domino("d0", 0.0, start + 5e-3)
    scene.domino("d1", magnitude, start + magnitude + 5e-3)
    scene.leans(start + 5e-3, "hammer", "d0", until=start + 2 / FPS)
    scene.hit(start + magnitude + 5e-3, "hammer", "d1")
    return World(scene.candidate(folder, {"one": falls("d0"), "two": falls("d1", causes=["one"])}), ("d1",))


def _reversed_edge(folder: Path, magnitude: float, rng: Rng) -> World:
    scene, start = Scene(rng), _frame_time(rng, 4, 10)
    scene.domino("d0", 0.0, start)
    scene.domino("d1", 0.08, start + magnitude)
    scene.leans(start + magnitude, "d0", "d1")
    return World(scene.candidate(folder, {"second": falls("d1"), "first": falls("d0", causes=["second"])}), ("d0",))


def _graze(folder: Path, magnitude: float, rng: Rng) -> World:
    """Struck by a touch of 1 % / `magnitude` of the momentum that it has."""
    return World(_touched(folder, MOMENTUM_SHARE / magnitude, rng), ("d1",))


def _touched(folder: Path, share: float, rng: Rng) -> Candidate:
    scene, start = Scene(rng), _frame_time(rng, 4, 10)
    scene.domino("d0", 0.0, start)
    scene.domino("d1", 0.08, start + 0.05)
    when = start + 0.05 + 1.5 / FPS
    scene.hit(when, "d0", "d1", share * scene.momentum("d1", int(np.ceil(when * FPS))))
    return scene.candidate(folder, {"first": falls("d0"), "second": falls("d1", causes=["first"])})


def _graze_then_blow(folder: Path, magnitude: float, rng: Rng) -> World:
    """A touch sets it going, and a body of no part in the chain strikes it 100 x `magnitude` times as hard."""
    scene, start = Scene(rng), _frame_time(rng, 6, 12)
    touch = float(rng.uniform(1e-4, 1e-3))
    scene.domino("d0", 0.0, start - 0.2)
    scene.domino("d1", 0.08, start + 2 / FPS)
    scene.slider("fist", 0.08 - 2.0 * np.clip(start + 2 / FPS - TIME, 0, None), y=0.15)
    scene.hit(start + 1e-3, "d0", "d1", touch)
    scene.hit(start + 2 / FPS + 1e-3, "fist", "d1", 100 * magnitude * touch)
    return World(scene.candidate(folder, {"first": falls("d0"), "second": falls("d1", causes=["first"])}), ("d1",))


def _on_a_path(folder: Path, magnitude: float, rng: Rng) -> World:
    """The effect's subject follows a path; contacts with the cause are all in order."""
    scene, start = Scene(rng), _frame_time(rng, 6, 12)
    scene.domino("d0", 0.0, start - 0.1)
    scene.slider("cart", 0.1 + magnitude * np.clip(TIME - start, 0, None), motion="kinematic")
    scene.hit(start, "d0", "cart", 1.0)
    first, last = scene.tracks["cart"][0][[0, -1]]
    keys = {"a": {"time": start, "pose": {"position": first}}, "b": {"time": 2.0, "pose": {"position": last}}}
    path = PathDriver(entity="cart", keys=keys)
    beats = {
        "first": falls("d0"),
        "goes": beat("cart", Speed(entity="cart", min=magnitude / 2), frames=(0, LAST), causes=["first"]),
    }
    return World(scene.candidate(folder, beats, drivers={"path": path}), ("cart",))


# ---------------------------------------------------------------- clean


def _one_frame(folder: Path, magnitude: float, rng: Rng) -> World:
    """A whole row is struck within one frame, `magnitude` seconds from touch to touch."""
    scene, start = Scene(rng), _frame_time(rng)
    count = min(12, 2 + int(0.9 / FPS / magnitude))
    first = start + 5e-4
    for k in range(count):
        scene.domino(f"d{k}", 0.03 * k, first + magnitude * (k - 1))
        if k:
            scene.hit(first + magnitude * (k - 1), f"d{k - 1}", f"d{k}")
    beats = {
        "a": beat("d1", Contact(a="d0", b="d1"), frames=(0, LAST)),
        "b": beat(
            f"d{count - 1}", Contact(a=f"d{count - 2}", b=f"d{count - 1}"), frames=(0, LAST), causes=["a"] if count > 2 else []
        ),
        "c": falls(f"d{count - 1}", causes=["a"]),
    }
    return World(scene.candidate(folder, beats))


def _creep(folder: Path, magnitude: float, rng: Rng) -> World:
    """Bodies push each other along at `magnitude` metres per second."""
    scene, count = Scene(rng), int(rng.integers(3, 6))
    delay = float(rng.uniform(0.1, 0.25))
    for k in range(count):
        scene.slider(f"b{k}", 0.1 * k + magnitude * (delay + np.clip(TIME - delay * k, 0, None) - delay))
        if k:
            scene.leans(delay * k, f"b{k - 1}", f"b{k}", 0.05)
    last = f"b{count - 1}"
    beats = {
        "push": beat("b0", Displacement(entity="b0", min=0.2 * magnitude), frames=(0, LAST)),
        "end": beat(last, Displacement(entity=last, min=0.1 * magnitude), frames=(0, LAST), causes=["push"]),
    }
    return World(scene.candidate(folder, beats))


def _long_row(folder: Path, magnitude: float, rng: Rng) -> World:
    scene, count = Scene(rng), round(magnitude)
    pace = 1.5 / count
    for k in range(count):
        scene.domino(f"d{k}", 0.08 * k, 0.05 + pace * k)
        if k:
            scene.leans(0.05 + pace * k, f"d{k - 1}", f"d{k}", until=min(2.0, 0.3 + pace * k))
    return World(scene.candidate(folder, {"first": falls("d0"), "last": falls(f"d{count - 1}", causes=["first"])}))


def _through_a_joint(folder: Path, magnitude: float, rng: Rng) -> World:
    """The two ends are joined, `magnitude` metres apart; nothing else touches the second."""
    scene, start = Scene(rng), _frame_time(rng, 6, 12)
    scene.domino("d0", 0.0, start - 0.1)
    scene.domino("d1", 0.08, start)
    scene.domino("d2", 0.08 + magnitude, start)
    scene.leans(start, "d0", "d1")
    one, two = (tuple(map(float, p)) for p in scene.at([[0.08, 0, 0.1], [0.08 + magnitude, 0, 0.1]]))
    joint = {
        0: WeldJoint(parent="d1", child="d2", anchor=one),
        1: HingeJoint(parent="d2", child="d1", anchor=two, axis=(0, 0, 1)),
        2: SpringJoint(parent="d1", child="d2", parent_point=one, child_point=two, stiffness=100.0),
    }[int(rng.integers(3))]
    return World(scene.candidate(folder, {"first": falls("d0"), "last": falls("d2", causes=["first"])}, joints={"j": joint}))


def _double_hit(folder: Path, magnitude: float, rng: Rng) -> World:
    """One body strikes two at the very same moment; a third one joins in, as hard as `magnitude` times the first."""
    scene, start = Scene(rng), _frame_time(rng, 6, 12)
    scene.slider("ball", 1.0 * np.minimum(TIME - start, 0.0) - 0.06)
    scene.slider("other", 0.2 + 1.0 * np.clip(start - TIME, 0.0, None))
    for name in ("d0", "d1"):
        scene.domino(name, 0.0, start)
        scene.hit(start + 1e-3, "ball", name)
    scene.hit(start + 1e-3, "other", "d1", 0.05 * magnitude)
    beats = {"rolls": beat("ball", Speed(entity="ball", min=0.5), frames=(0, LAST)), "a": falls("d0", causes=["rolls"])}
    return World(scene.candidate(folder, {**beats, "b": falls("d1", causes=["rolls"])}))


def _lever(folder: Path, magnitude: float, rng: Rng) -> World:
    """A plank of `magnitude` metres on a static block: one end goes down, what lies on the other goes up."""
    scene, start = Scene(rng), _frame_time(rng, 6, 12)
    scene.slider("ball", 1.0 * np.minimum(TIME - start, 0.15) - 0.1)
    scene.domino("plank", magnitude / 2, start, lies=0.5)
    scene.slider("stone", magnitude + 1.5 * np.clip(TIME - start - 1e-3, 0.0, None))
    scene.leans(start, "ball", "plank", 0.1, until=start + 0.2)
    scene.rests(
        "plank", "stone", np.where(start + 0.15 < TIME, 0.0, 0.02) + np.where(np.abs(TIME - start - 0.05) < 0.05, 0.2, 0.0)
    )
    beats = {
        "lands": beat("plank", Contact(a="ball", b="plank"), frames=(0, LAST)),
        "flies": beat("stone", Displacement(entity="stone", min=0.3), frames=(0, LAST), causes=["lands"]),
    }
    return World(scene.candidate(folder, beats))


def _just_enough(folder: Path, magnitude: float, rng: Rng) -> World:
    """A touch of 1 % x `magnitude` of the momentum that it has."""
    return World(_touched(folder, MOMENTUM_SHARE * magnitude, rng))


def _short_stop(folder: Path, magnitude: float, rng: Rng) -> World:
    """A body turns round at an apex, where it stays `magnitude` seconds."""
    scene, turn = Scene(rng), _frame_time(rng, 10, 20)
    speed = float(rng.uniform(0.3, 1.5))
    scene.slider("ball", speed * (np.minimum(TIME, turn) - np.clip(TIME - turn - magnitude, 0.0, None)))
    beats = {
        "up": beat("ball", Displacement(entity="ball", min=0.5 * speed * turn), frames=(0, LAST)),
        "back": beat(
            "ball", Displacement(entity="ball", max=0.8 * speed * turn), frames=(round(turn * FPS) + 2, LAST), causes=["up"]
        ),
    }
    return World(scene.candidate(folder, beats))


def _cradle(folder: Path, magnitude: float, rng: Rng) -> World:
    """Balls in a row pass a blow on while all but the outer ones stay still; it is `magnitude` times their resting contact."""
    scene, start, count = Scene(rng), _frame_time(rng), int(rng.integers(3, 7))
    rest = 0.02
    for k in range(count):
        speed = {0: np.minimum(TIME - start, 0.0), count - 1: np.clip(TIME - start, 0.0, None)}.get(k, 0.0)
        scene.slider(f"b{k}", 0.1 * k + 1.0 * speed)
        if k > 1:
            own = np.full(len(TIME), rest)
            own[round(start * FPS) + 1] = rest * magnitude
            scene.rests(f"b{k - 1}", f"b{k}", own)
    scene.hit(start + 1e-3, "b0", "b1", 0.4)
    last = f"b{count - 1}"
    beats = {
        "swings": beat("b0", Speed(entity="b0", min=0.5), frames=(0, LAST)),
        "leaves": beat(last, Displacement(entity=last, min=0.05), frames=(0, LAST), causes=["swings"]),
    }
    return World(scene.candidate(folder, beats))


def _lies_long_since(folder: Path, magnitude: float, rng: Rng) -> World:
    """The effect's subject came to rest `magnitude` seconds before the effect, which speaks of others too."""
    scene = Scene(rng)
    starts = np.linspace(0.1, 0.35 + magnitude, 3 + int(magnitude / 0.1))
    for k, start in enumerate(starts):
        scene.domino(f"d{k}", 0.08 * k, float(start))
    for k, start in enumerate(starts[1:]):
        scene.leans(float(start), f"d{k}", f"d{k + 1}")
    ends = (0, 1, len(starts) - 1)
    beats = {
        "tips": beat("d0", Tilts(entity="d0", min=0.1), frames=(0, LAST)),
        "all": beat("d0", And(of=[Topples(entity=f"d{k}") for k in ends]), frames=(0, LAST), causes=["tips"]),
    }
    return World(scene.candidate(folder, beats))


BROKEN = (
    Mechanism("passes-by", "it breaks as a ball passes without touching it", True, _passes_by, 1e-3, 0.3, "m"),
    Mechanism("frames-early", "touching, but the effect is past its threshold first", True, _frames_early, 1, 8, "frame"),
    Mechanism("steps-early", "two contacts in one frame, the effect's first", True, _steps_early, 5e-4, 0.03, "s"),
    Mechanism("link-before-cause", "the link comes before the cause, in one frame", True, _link_before_cause, 5e-4, 0.03, "s"),
    Mechanism("ground-only", "linked through the floor only", True, _ground_only, 0.01, 100, "N s"),
    Mechanism("shared-tray", "linked through resting contacts on a heavy tray only", True, _shared_tray, 1e-3, 0.08, "1"),
    Mechanism("missing-domino", "a gap in the row, behind which a driver pushes", True, _missing_domino, 1, 4, "dominoes"),
    Mechanism("rested", "at rest between cause and effect", True, _rested, 0.22, 0.9, "s", bound=PAUSE),
    Mechanism("wrong-neighbour", "the other row is named", True, _wrong_neighbour, 1e-3, 0.5, "m"),
    Mechanism("common-cause", "a third strikes both, one after the other", True, _common_cause, 0.1, 0.5, "s"),
    Mechanism("reversed-edge", "cause and effect exchanged", True, _reversed_edge, 0.05, 0.8, "s"),
    Mechanism("graze", "a touch of less than 1 % of its momentum, by this factor", True, _graze, 1.05, 1e3, "1", bound=1.0),
    Mechanism(
        "graze-then-blow", "another strikes 100 times as hard, by this factor", True, _graze_then_blow, 1.05, 50, "1", bound=1.0
    ),
    Mechanism("on-a-path", "the effect is keyframed", True, _on_a_path, 0.05, 2.0, "m/s"),
)
CLEAN = (
    Mechanism("one-frame", "a whole row within one frame", False, _one_frame, 5e-4, 0.03, "s"),
    Mechanism("creep", "bodies push each other very slowly", False, _creep, 2e-3, 0.02, "m/s"),
    Mechanism("long-row", "a long row of dominoes", False, _long_row, 5, 40, "dominoes"),
    Mechanism("through-a-joint", "weld, hinge or spring pass it on", False, _through_a_joint, 0.05, 2.0, "m"),
    Mechanism("double-hit", "two at the same moment, one of them struck by a third as well", False, _double_hit, 0.01, 50, "1"),
    Mechanism("lever", "the effect is far off, at the other end of a plank", False, _lever, 0.3, 3.0, "m"),
    Mechanism("just-enough", "a touch of just over 1 % of its momentum", False, _just_enough, 1.05, 50, "1"),
    Mechanism("short-stop", "an apex between cause and effect", False, _short_stop, 0.01, 0.1, "s"),
    Mechanism("cradle", "what passes it on stays still itself", False, _cradle, 1.2, 50, "1"),
    Mechanism("lies-long-since", "the subject rests when the others are done", False, _lies_long_since, 0.05, 1.0, "s"),
)
SUITE = Suite("causal", (*BROKEN, *CLEAN, *SIMULATED, *UNTOLD))
