"""Do the rules of thumb of `world-building` help? Worlds built by a script from short briefs, with the rules and without.

The briefs are data in `skills/world-building/evals/cases.json`, the rules in `skills/world-building/rules.json`: gaps to
supports, pitch of a row, room in beat intervals, start speed against friction, how long a body stays supported, how
far the camera stands. Without them the script takes the first value that comes to mind (`NAIVE`). Sizes are drawn by seed.
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

from ..worlds.spec import RigidSettings
from .trial import Trial

__all__ = ["NAIVE", "build", "measure"]

SKILL = Path(__file__).resolve().parent.parent / "skills" / "world-building"
NAIVE: dict[str, Any] = {
    "gap_skins": 0,
    "row_pitch_of_height": 1.0,
    "beat_margin_frames": 0,
    "settle_frames": 0,
    "speed_margin": 1.0,
    "supports_until_moved": False,
    "camera": None,
}
"""Bodies exactly on each other, dominoes a height apart, beats just as estimated, a camera in the corner of the room."""
CORNER = {"position": [3.0, -3.0, 2.0], "target": [0.0, 0.0, 0.0], "fov_deg": 40}
WORDS = {"Wooden": "wood", "steel": "steel", "stone": "stone"}
"""Material by its word in the prompt."""
G, FPS = 9.81, 24
FRICTION = 0.3
SETTINGS = RigidSettings(step=2.5e-4)
Document = dict[str, Any]


def _box(role: str, material: str, size: Sequence[float], at: Sequence[float], **more: Any) -> Document:
    pose = {"position": [round(v, 6) for v in at]}
    shape = {"kind": "box", "size": list(size)}
    return {
        "role": role,
        "motion": "dynamic",
        "material": material,
        "dimensions": {"size": list(size)},
        "pose": pose,
        "parts": {"body": {"shape": shape}},
        **more,
    }


def _ball(role: str, radius: float, at: Sequence[float], speed: float) -> Document:
    made = _box(
        role,
        "steel",
        [2 * radius] * 3,
        at,
        physics={
            "category": "rigid",
            "linear_velocity": [round(speed, 4), 0, 0],
            "angular_velocity": [0, round(speed / radius, 3), 0],
        },
    )
    return {**made, "parts": {"body": {"shape": {"kind": "sphere", "radius": radius}}}}


class _Draft:
    """Specification made from a brief: entities, relations, one beat."""

    def __init__(self, rules: Mapping[str, Any]) -> None:
        self.rules = rules
        self.gap = rules["gap_skins"] * SETTINGS.skin
        self.entities: Document = {}
        self.relations: Document = {}
        self.beats: Document = {}
        self.extent = 0.0
        """Height of what the picture must show [m]."""

    def put(self, name: str, entity: Document, on: str) -> None:
        """Add an entity on a support; all of these worlds' bodies are moved by the beats."""
        self.entities[name] = entity
        frames = {"frames": [0, 0]} if self.rules["supports_until_moved"] else {}
        self.relations[f"on_{name}"] = {"kind": "supports", "a": on, "b": name, **frames}

    def beat(
        self, name: str, subject: str, at: float, predicate: Document, *, last: float | None = None, causes: Sequence[str] = ()
    ) -> None:
        """Add a beat that is expected at a time [s], or between two."""
        margin = self.rules["beat_margin_frames"]
        first, end = round(FPS * at), round(FPS * (at if last is None else last))
        self.beats[name] = {
            "text": name,
            "owner": "rigid",
            "subject": subject,
            "frames": [max(0, first - margin), end + margin],
            "predicate": predicate,
            "causes": list(causes),
        }

    def document(self) -> Document:
        """The specification."""
        last = max(b["frames"][1] for b in self.beats.values()) + max(1, self.rules["settle_frames"])
        camera = dict(CORNER)
        if self.rules["camera"] is not None:
            r = self.rules["camera"]
            # A subject of height h fills a share s of the picture at distance h / (2 s tan(fov / 2)).
            away = self.extent / (2 * r["height_of_picture"] * math.tan(math.radians(r["fov_deg"]) / 2))
            camera = {
                "position": [0.0, -away, r["elevation"] * away],
                "target": [0.0, 0.0, self.extent / 2],
                "fov_deg": r["fov_deg"],
            }
        floor = {**_box("floor", "stone", [6, 6, 0.2], [0, 0, -0.1]), "motion": "static"}
        names = ["floor", *self.entities]
        all_of = {"floor": floor, **self.entities}
        made = {kind: [f"/entities/{n}" for n, e in all_of.items() if e["material"] == kind] for kind in WORDS.values()}
        return {
            "title": "From a brief",
            "spec_version": "2",
            "claims": {
                **{word: {"quote": word, "type": "property", "by": made[kind]} for word, kind in WORDS.items() if made[kind]},
                "floor": {"quote": "floor", "type": "thing", "by": ["/entities/floor"]},
            },
            "story": {"beats": self.beats},
            "materials": {
                "steel": {"density": 7850, "substance": "steel", "friction": FRICTION, "rolling_friction": 0.0005},
                "wood": {"density": 600, "substance": "wood", "friction": FRICTION},
                "stone": {"density": 2600, "substance": "stone", "friction": FRICTION},
            },
            "entities": all_of,
            "graph": {"relations": self.relations},
            "shots": {"only": {"frames": [0, last], "covers": list(self.beats), "keys": {"a": {"frame": 0, **camera}}}},
            "simulation": {
                "fps": FPS,
                "frames": last + 1,
                "solvers": {"rigid": {"engine": "mujoco", "members": names, "settings": SETTINGS.model_dump(mode="json")}},
            },
            "look": {"width": 160, "height": 90, "samples": 2},
        }


def _blow(mass: float) -> float:
    """Impulse [N s] that changes the speed of a mass [kg] by 2 mm/s: a touch that is no noise."""
    return float(f"{0.002 * mass:.4g}")


def _push(draft: _Draft, drawn: Mapping[str, float]) -> None:
    size, way = drawn["size"], drawn["size"] * drawn["way_of_size"]
    # The striker must come with speed to spare: v^2 = 2 mu g (way + half the size, for the push).
    speed = math.sqrt(draft.rules["speed_margin"] * 2 * FRICTION * G * (way + size))
    z = size / 2 + draft.gap
    draft.put(
        "striker",
        _box(
            "steel block",
            "steel",
            [size] * 3,
            [-way - size, 0, z],
            physics={"category": "rigid", "linear_velocity": [round(speed, 4), 0, 0]},
        ),
        "floor",
    )
    draft.put("target", _box("wooden block", "wood", [size] * 3, [0, 0, z]), "floor")
    time = (speed - math.sqrt(max(0.0, speed**2 - 2 * FRICTION * G * way))) / (FRICTION * G)
    draft.beat("hit", "target", time, {"kind": "contact", "a": "striker", "b": "target", "min_impulse": _blow(600 * size**3)})
    draft.extent = size


def _row(draft: _Draft, drawn: Mapping[str, float]) -> None:
    height, count = drawn["height"], round(drawn["count"])
    pitch, thick = draft.rules["row_pitch_of_height"] * height, height / 6
    radius = height / 4
    for k in range(count):
        draft.put(
            f"d{k}", _box(f"domino {k}", "wood", [thick, height / 2, height], [k * pitch, 0, height / 2 + draft.gap]), "floor"
        )
    block = 0.5 * height
    # The ball rolls on a block, so that it hits at three quarters of the height.
    draft.put(
        "block",
        _box("block", "stone", [4 * radius, height, block], [-thick / 2 - 4.5 * radius, 0, block / 2 + draft.gap]),
        "floor",
    )
    speed = math.sqrt(draft.rules["speed_margin"] * G * height)
    draft.put("ball", _ball("steel ball", radius, [-thick / 2 - 4 * radius, 0, block + 2 * draft.gap + radius], speed), "block")
    wave = 0.9 * math.sqrt(G * height)
    fall = 2 * math.sqrt(height / G)
    draft.beat(
        "knock", "d0", 3 * radius / speed, {"kind": "contact", "a": "ball", "b": "d0", "min_impulse": _blow(600 * height**3 / 12)}
    )
    draft.beat(
        "last",
        f"d{count - 1}",
        0.0,
        {"kind": "tilts", "entity": f"d{count - 1}", "min": 0.6},
        last=(count - 1) * pitch / wave + fall,
        causes=["knock"],
    )
    draft.extent = height


def _tower(draft: _Draft, drawn: Mapping[str, float]) -> None:
    size, count, way = drawn["size"], round(drawn["count"]), drawn["size"] * drawn["way_of_size"]
    for k in range(count):
        draft.put(
            f"box{k}",
            _box(f"box {k}", "wood", [size] * 3, [0, 0, (k + 0.5) * size + (k + 1) * draft.gap]),
            "floor" if k == 0 else f"box{k - 1}",
        )
    radius = 0.3 * size
    speed = draft.rules["speed_margin"] * 1.5
    draft.put("ball", _ball("steel ball", radius, [-size / 2 - way - radius, 0, radius + draft.gap], speed), "floor")
    draft.beat("hit", "box0", way / speed, {"kind": "contact", "a": "ball", "b": "box0", "min_impulse": _blow(600 * size**3)})
    draft.extent = count * size


KINDS = {"push": _push, "row": _row, "tower": _tower}


def build(name: str, case: Mapping[str, Any], rng: random.Random, rules: Mapping[str, Any]) -> tuple[str, Document]:
    """(prompt, specification) of one drawn brief under some rules."""
    drawn = {k: round(rng.uniform(*v), 3) for k, v in case.items() if isinstance(v, list)}
    draft = _Draft(rules)
    KINDS[name](draft, drawn)
    return "Wooden and steel things on a stone floor.", draft.document()


def measure(seeds: Sequence[int], names: Sequence[str] = ()) -> dict[str, Any]:
    """Every brief (or those named) once per seed, with and without the rules."""
    data = json.loads((SKILL / "evals" / "cases.json").read_text())
    arms = {"with": json.loads((SKILL / "rules.json").read_text()), "without": NAIVE}
    runs: dict[str, list[dict[str, Any]]] = {arm: [] for arm in arms}
    for seed in seeds:
        for name in names or data:
            for arm, rules in arms.items():
                prompt, spec = build(name, data[name], random.Random(f"{name} {seed}"), rules)
                with tempfile.TemporaryDirectory() as folder:
                    judged = Trial(Path(folder) / "w", prompt, spec).judge()
                failing = [r.id for r in judged.rows]
                print(f"building {name} {seed} {arm}: {judged.stage} {failing or 'passes'}", file=sys.stderr)
                runs[arm].append({"case": name, "seed": seed, "passed": judged.passed, "stage": judged.stage, "open": failing})
    figures = {
        a: {
            "worlds": len(r),
            "passed_first": round(sum(x["passed"] for x in r) / max(1, len(r)), 3),
            "mean_open_rows": round(sum(len(x["open"]) for x in r) / max(1, len(r)), 2),
        }
        for a, r in runs.items()
    }
    return {"arms": figures, "runs": runs}
