"""Mistakes that the scripted agent makes in its first specification, drawn by seed.

Each takes the specification (a dict) and a random generator and changes it in place. The repairing part of the agent
(`repair.py`) never imports this module.
"""

from __future__ import annotations

import math
import random
from collections.abc import Callable
from typing import Any

__all__ = ["FLAWS", "plant"]

Spec = dict[str, Any]
Flaw = Callable[[Spec, random.Random], str]


def _domino(rng: random.Random, low: int = 2, high: int = 19) -> str:
    return f"d{rng.randint(low, high):02d}"


def sunk_domino(spec: Spec, rng: random.Random) -> str:
    """A domino stands inside the bench top, where no camera sees it."""
    name, depth = _domino(rng), rng.uniform(0.002, 0.02)
    spec["entities"][name]["pose"]["position"][2] -= depth
    return f"{name} sunk {1000 * depth:.1f} mm into the bench"


def overlapping_dominoes(spec: Spec, rng: random.Random) -> str:
    """A domino stands inside its neighbour."""
    k = rng.randint(2, 7)
    depth = rng.uniform(0.001, 0.004)
    a, b = spec["entities"][f"d{k:02d}"], spec["entities"][f"d{k + 1:02d}"]
    a["pose"]["position"][0] = round(b["pose"]["position"][0] - 0.01 + depth, 6)
    return f"d{k:02d} reaches {1000 * depth:.1f} mm into its neighbour"


def floating_domino(spec: Spec, rng: random.Random) -> str:
    """A domino hangs in the air."""
    name, height = _domino(rng), rng.uniform(0.005, 0.04)
    spec["entities"][name]["pose"]["position"][2] += height
    return f"{name} floats {1000 * height:.0f} mm above the bench"


def floating_bowl(spec: Spec, rng: random.Random) -> str:
    """The bowl hangs above the floor."""
    height = rng.uniform(0.01, 0.06)
    spec["entities"]["bowl"]["pose"]["position"][2] += height
    return f"the bowl floats {1000 * height:.0f} mm above the floor"


def giant_ball(spec: Spec, rng: random.Random) -> str:
    """The ball is modelled some times too large; its declared size is right."""
    factor = rng.choice([2.0, 2.5, 3.0])
    spec["entities"]["ball"]["parts"]["body"]["shape"]["radius"] *= factor
    return f"the ball is modelled {factor:g} times too large"


def millimetre_domino(spec: Spec, rng: random.Random) -> str:
    """A domino is modelled ten times too small; its declared size is right."""
    name = _domino(rng)
    shape = spec["entities"][name]["parts"]["body"]["shape"]
    shape["size"] = [s / 10 for s in shape["size"]]
    return f"{name} is modelled ten times too small"


def unowned_entity(spec: Spec, rng: random.Random) -> str:
    """An entity is in no solver: nobody moves it, nothing meets it."""
    name = rng.choice(["ball", "cube", "bowl", "ramp", "bench", _domino(rng)])
    spec["simulation"]["solvers"]["rigid"]["members"].remove(name)
    return f"{name} belongs to no solver"


def undriven_kinematic(spec: Spec, rng: random.Random) -> str:
    """An entity is declared kinematic, but no driver moves it."""
    name = rng.choice(["cube", "bowl", _domino(rng)])
    spec["entities"][name]["motion"] = "kinematic"
    return f"{name} is kinematic without a driver"


def wrong_density(spec: Spec, rng: random.Random) -> str:
    """A density with a slipped decimal point."""
    name = rng.choice(["steel", "ceramic", "concrete"])
    spec["materials"][name]["density"] /= 10
    return f"density of {name} is ten times too low"


def misspelt_reference(spec: Spec, rng: random.Random) -> str:
    """A reference to something that does not exist."""
    if rng.random() < 0.5:
        spec["story"]["beats"]["catch"]["predicate"]["region"] = "in_bowls"
        return "a beat names the unknown region in_bowls"
    spec["graph"]["relations"]["bowl_on_floor"]["a"] = "flor"
    return "a relation names the unknown entity flor"


def forgotten_claim(spec: Spec, rng: random.Random) -> str:
    """Words for a thing of the prompt are not claimed, of which events are told."""
    key = rng.choice(["ball", "cube"])
    del spec["claims"][key]
    return f"the words of the {key} are not claimed"


def missed_bowl(spec: Spec, rng: random.Random) -> str:
    """The bowl stands where the cube does not land."""
    angle, distance = rng.uniform(0, math.pi), rng.uniform(0.22, 0.3)
    position = spec["entities"]["bowl"]["pose"]["position"]
    position[0] = round(position[0] + distance * math.cos(angle), 4)
    position[1] = round(position[1] + distance * math.sin(angle), 4)
    return f"the bowl stands {distance:.2f} m off"


def late_release(spec: Spec, rng: random.Random) -> str:
    """The ball is let go so late that no beat comes in its time."""
    time = rng.choice([1.0, 1.25, 1.5])
    spec["simulation"]["drivers"]["let_go"]["time"] = time
    return f"the ball is released at {time:g} s"


def averted_camera(spec: Spec, rng: random.Random) -> str:
    """A camera looks away from what it should show."""
    name = rng.choice(sorted(spec["shots"]))
    shift = rng.choice([(1.5, 0, 0), (0, -1.5, 0), (0, 0, 1.2)])
    for key in spec["shots"][name]["keys"].values():
        key["target"] = [round(t + s, 4) for t, s in zip(key["target"], shift, strict=True)]
    return f"the cameras of {name} look elsewhere"


def shot_gap(spec: Spec, rng: random.Random) -> str:
    """Some frames belong to no shot."""
    cut = rng.randint(2, 4)
    spec["shots"]["chain_shot"]["frames"][0] += cut
    spec["shots"]["chain_shot"]["keys"]["a"]["frame"] += cut
    return f"{cut} frames belong to no shot"


def beat_out_of_range(spec: Spec, rng: random.Random) -> str:
    """A beat is planned beyond the end of the sequence."""
    extra = rng.randint(5, 40)
    spec["story"]["beats"]["catch"]["frames"][1] += extra
    return f"the last beat ends {extra} frames after the sequence"


FLAWS: dict[str, Flaw] = {
    f.__name__: f
    for f in (
        sunk_domino,
        overlapping_dominoes,
        floating_domino,
        floating_bowl,
        giant_ball,
        millimetre_domino,
        unowned_entity,
        undriven_kinematic,
        wrong_density,
        misspelt_reference,
        forgotten_claim,
        missed_bowl,
        late_release,
        averted_camera,
        shot_gap,
        beat_out_of_range,
    )
}


def plant(spec: Spec, seed: int, count: int = 3) -> dict[str, str]:
    """Put `count` different flaws into a specification; returns what was done, for the record only."""
    rng = random.Random(seed)
    chosen = rng.sample(sorted(FLAWS), count)
    return {name: FLAWS[name](spec, rng) for name in chosen}
