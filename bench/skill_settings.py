"""Do the numbers of `rigid-bodies` help? Impacts of drawn size and speed, with the skill's step and skin and with the defaults.

The scenes are data in `skills/rigid-bodies/evals/cases.json`, the numbers in `skills/rigid-bodies/settings.json`. Both arms
build the same scene but for step and skin (and the gaps that follow from the skin); the figure is the share of probes
that pass at the first try.
"""

from __future__ import annotations

import json
import math
import random
import sys
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from ..worlds.spec import Limits, RigidSettings
from .trial import Trial

__all__ = ["by_default", "by_skill", "measure", "scene"]

SKILL = Path(__file__).resolve().parent.parent / "skills" / "rigid-bodies"
G = 9.81
FPS = 24
AFTER = 22
"""Frames after the hit: the probe wants to see 0.75 s of settling."""
LEAST_STEP = 2e-5
"""Least step that the specification allows [s]."""
STARTED = 0.2
"""Start speed of what falls [m/s]: bodies in the air must be launched."""


def by_skill(speed: float, thinnest: float, smallest: float, rules: Mapping[str, Any] | None = None) -> dict[str, float]:
    """Step [s] and skin [m] by the rules of the skill.

    Args:
        speed: fastest closing speed [m/s].
        thinnest: thinnest collider [m].
        smallest: smallest moving body [m].
        rules: default those of `settings.json`.
    """
    rules = json.loads((SKILL / "settings.json").read_text()) if rules is None else rules
    step_rules, skin_rules = rules["step"], rules["skin"]
    largest = step_rules["largest_small_s"] if thinnest < step_rules["small_m"] else step_rules["largest_s"]
    step = min(largest, step_rules["share_of_thickness"] * thinnest / speed)
    ceiling = min(skin_rules["share_of_contact_gap"] * Limits().contact_gap, skin_rules["share_of_body"] * smallest)
    # A hit dips about speed x step into the two skins: where the ceiling is below that, the step gives way.
    step = min(step, ceiling / (skin_rules["share_of_dip"] * speed))
    skin = min(ceiling, max(skin_rules["share_of_dip"] * speed * step, min(skin_rules["usual_m"], ceiling)))
    # Two digits, rounded down: a step just above a bound is above it.
    digit = 10.0 ** (math.floor(math.log10(step)) - 1)
    return {"step": max(LEAST_STEP, float(f"{math.floor(step / digit + 1e-9) * digit:.2g}")), "skin": float(f"{skin:.3g}")}


def by_default(speed: float, thinnest: float, smallest: float) -> dict[str, float]:
    """Step and skin as the specification has them when nobody chooses."""
    return {"step": RigidSettings().step, "skin": RigidSettings().skin}


ARMS = {"with": by_skill, "without": by_default}


def _entity(
    role: str, motion: str, size: Sequence[float], at: Sequence[float], shape: dict[str, Any], **more: Any
) -> dict[str, Any]:
    pose = {"position": [round(v, 6) for v in at]}
    return {
        "role": role,
        "motion": motion,
        "material": "steel",
        "dimensions": {"size": list(size)},
        "pose": pose,
        "parts": {"body": {"shape": shape}},
        **more,
    }


def scene(case: Mapping[str, Any], rng: random.Random, arm: str) -> tuple[str, dict[str, Any]]:
    """(prompt, specification) of one drawn scene: a ball meets a slab."""
    drawn = {k: round(rng.uniform(*v), 4) for k, v in case.items() if isinstance(v, list)}
    radius, thickness = drawn["radius"], drawn["thickness"]
    down = case["axis"] == "z"
    start = STARTED if down else drawn["speed"]
    speed = math.sqrt(start**2 + 2 * G * drawn["height"]) if down else start
    settings = ARMS[arm](speed, min(thickness, 2 * radius), 2 * radius)
    way = drawn["height"] if down else 0.3
    hit = round(FPS * ((speed - start) / G if down else way / start))
    last = hit + AFTER
    slab = [0.4, 0.4, thickness] if down else [thickness, 0.4, 0.4]
    # What is thrown flies over a floor that is far enough below to be met after the wall only.
    place = [0.0, 0.0, thickness / 2] if down else [0.0, 0.0, 0.2]
    ball = [0.01, 0.0, thickness + way + radius] if down else [-(thickness / 2 + way + radius), 0.0, 0.3]
    velocity = [0.0, 0.0, -start] if down else [start, 0.0, 0.0]
    floor = _entity("floor", "static", [3, 3, 0.2], [0, 0, -0.1], {"kind": "box", "size": [3, 3, 0.2]})
    target = _entity("slab", "static", slab, place, {"kind": "box", "size": slab})
    body = _entity(
        "ball",
        "dynamic",
        [2 * radius] * 3,
        ball,
        {"kind": "sphere", "radius": radius},
        physics={"category": "rigid", "linear_velocity": velocity},
    )
    blow = float(
        f"{0.002 * 7850 * 4 / 3 * math.pi * radius**3:.4g}"
    )  # changes the ball's speed by 2 mm/s: a touch that is no noise
    beat = {"text": case["text"], "owner": "rigid", "subject": "ball", "observe": False, "frames": [max(0, hit - 3), hit + 4],
            "predicate": {"kind": "contact", "a": "ball", "b": "slab", "min_impulse": blow}}  # fmt: skip
    spec = {
        "title": "Impact",
        "spec_version": "2",
        "claims": {
            "ball": {"quote": "steel ball", "type": "property", "by": ["/entities/ball"]},
            "slab": {"quote": "slab", "type": "thing", "by": ["/entities/slab"]},
            "steel": {"quote": "steel", "nth": 2, "type": "property", "by": ["/entities/slab"]},
            "floor": {"quote": "floor", "type": "thing", "by": ["/entities/floor"]},
        },
        "story": {"beats": {"hit": beat}},
        "materials": {"steel": {"density": 7850, "substance": "steel", "friction": 0.3, "rolling_friction": 0.002}},
        "entities": {"floor": floor, "slab": target, "ball": body},
        "shots": {"only": {"frames": [0, last], "covers": [], "subjects": ["floor"], "keys": {"a": {"frame": 0, "position": [1.5, -3, 1.5], "target": [0, 0, 0], "fov_deg": 40}}}},
        "simulation": {"fps": FPS, "frames": last + 1, "solvers": {"rigid": {"engine": "mujoco", "members": ["floor", "slab", "ball"], "settings": settings}}},
        "look": {"width": 64, "height": 64, "samples": 2},
    }  # fmt: skip
    return "A steel ball beside a slab of steel on a floor.", spec


def measure(seeds: Sequence[int], names: Sequence[str] = ()) -> dict[str, Any]:
    """Every kind of scene (or those named) once per seed and arm."""
    data = json.loads((SKILL / "evals" / "cases.json").read_text())
    runs: dict[str, list[dict[str, Any]]] = {arm: [] for arm in ARMS}
    for seed in seeds:
        for name in names or data:
            for arm in ARMS:
                prompt, spec = scene(data[name], random.Random(f"{name} {seed}"), arm)
                with tempfile.TemporaryDirectory() as folder:
                    judged = Trial(Path(folder) / "w", prompt, spec).judge()
                settings = spec["simulation"]["solvers"]["rigid"]["settings"]
                failing = [r.id for r in judged.rows]
                print(f"settings {name} {seed} {arm} {settings}: {failing or 'passes'}", file=sys.stderr)
                runs[arm].append({"case": name, "seed": seed, "passed": judged.passed, "open": failing, **settings})
    arms = {
        a: {"probes": len(r), "passed_first": round(sum(x["passed"] for x in r) / max(1, len(r)), 3)} for a, r in runs.items()
    }
    return {"arms": arms, "runs": runs}
