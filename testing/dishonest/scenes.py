"""Small worlds in which something happens that words can tell truly or falsely. Times in frames of 1/24 s, lengths in metres."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from .cases import Document

__all__ = [
    "ball",
    "beat",
    "block",
    "blocks",
    "bounce",
    "dominoes",
    "in_turn",
    "lift",
    "passing",
    "push",
    "room",
    "scene",
    "shelf",
]

SKIN = 0.0005
"""Collision skin of every part [m]."""
GAP = 2 * SKIN
STEEL = {
    "density": 7850, "substance": "steel", "friction": 0.3, "rolling_friction": 0.0005, "restitution": 0.1,
    "appearance": {"color": [0.7, 0.71, 0.73], "metallic": 1, "roughness": 0.3},
}  # fmt: skip
MATERIALS: Mapping[str, Document] = {
    "steel": STEEL,
    "wood": {"density": 600, "substance": "wood", "friction": 0.3, "appearance": {"color": [0.6, 0.4, 0.22], "pattern": "wood"}},
    "stone": {"density": 2600, "substance": "stone", "friction": 0.4, "appearance": {"color": [0.45, 0.45, 0.43]}},
    "rubber": {"density": 1100, "substance": "rubber", "friction": 0.8, "restitution": 0.75, "appearance": {"color": [0.7, 0.03, 0.03]}},
    "floor": {"density": 2600, "substance": "stone", "friction": 0.4, "restitution": 0.75, "appearance": {"color": [0.45, 0.45, 0.43]}},
    "grip": {"density": 600, "substance": "wood", "friction": 0.8, "appearance": {"color": [0.6, 0.4, 0.22], "pattern": "wood"}},
    "foam": {"density": 30, "substance": "foam", "friction": 0.6, "appearance": {"color": [0.9, 0.9, 0.85]}},
    "glass": {"density": 2500, "substance": "glass", "friction": 0.3, "appearance": {"color": [0.6, 0.8, 0.8]}},
}  # fmt: skip
"""By id."""
Place = Sequence[float]


def block(role: str, material: str, size: Place, at: Place, motion: str = "dynamic", **more: Any) -> Document:
    """A box of full extents `size` whose centre is at `at`."""
    return _body(role, material, size, at, motion, {"kind": "box", "size": list(size)}, **more)


def ball(role: str, material: str, radius: float, at: Place, motion: str = "dynamic", **more: Any) -> Document:
    """A ball."""
    return _body(role, material, (2 * radius,) * 3, at, motion, {"kind": "sphere", "radius": radius}, **more)


def _body(role: str, material: str, size: Place, at: Place, motion: str, shape: Document, **more: Any) -> Document:
    velocity, spin = more.pop("velocity", None), more.pop("spin", None)
    physics = {"linear_velocity": velocity, "angular_velocity": spin}
    made = {
        "role": role, "motion": motion, "material": material, "dimensions": {"size": list(size)},
        "pose": {"position": list(at)}, "parts": {"body": {"shape": shape}}, **more,
    }  # fmt: skip
    started = {k: list(v) for k, v in physics.items() if v is not None}
    return made | ({"physics": {"category": "rigid", **started}} if started else {})


def beat(text: str, subject: str, frames: tuple[int, int], predicate: Document, *causes: str, owner: str = "rigid") -> Document:
    """An event of the story."""
    return {
        "text": text, "owner": owner, "subject": subject, "frames": list(frames), "predicate": predicate, "causes": list(causes),
    }  # fmt: skip


def scene(
    title: str,
    entities: Mapping[str, Document],
    beats: Mapping[str, Document],
    *,
    frames: int,
    eye: Place,
    target: Place,
    touching: Sequence[tuple[str, str]] = (),
    drivers: Mapping[str, Document] | None = None,
    **plan: Any,
) -> Document:
    """A specification without prompt and claims: one rigid solver, one camera that stands still, light of a studio."""
    used = {e["material"] for e in entities.values()}
    return {
        "title": title,
        "story": {"beats": dict(beats)},
        "materials": {k: v for k, v in MATERIALS.items() if k in used},
        "entities": dict(entities),
        "graph": {"relations": {f"{a}_{b}": {"kind": "interacts", "a": a, "b": b} for a, b in touching}},
        "shots": {
            "only": {
                "frames": [0, frames - 1], "covers": list(beats), "intent": "all of it",
                "keys": {"a": {"frame": 0, "position": list(eye), "target": list(target), "fov_deg": 40}},
            }
        },
        "simulation": {
            "fps": 24, "frames": frames,
            "solvers": {"rigid": {"engine": "mujoco", "members": list(entities), "settings": {"step": 0.0005, "skin": SKIN}}},
            "drivers": dict(drivers or {}), **plan,
        },
        "look": {"sky": "studio", "width": 112, "height": 64, "samples": 4},
    }  # fmt: skip


def ground(material: str = "stone", size: float = 3.0) -> Document:
    """A static slab whose top is z = 0."""
    return block("stone floor", material, (size, 2, 0.1), (0, 0, -0.05), "static")


def blocks() -> Document:
    """A steel block slides into a wooden one, which slides on."""
    side = (0.1, 0.1, 0.1)
    z = 0.05 + GAP
    return scene(
        "Two blocks",
        {
            "floor": ground(),
            "steel_block": block("steel block that slides and hits", "steel", side, (-0.35, 0, z), velocity=(1.5, 0, 0)),
            "wooden_block": block("wooden block that is pushed", "wood", side, (-0.15, 0, z)),
        },
        {
            "slide": beat("the steel block slides", "steel_block", (0, 6), {"kind": "slides", "entity": "steel_block"}),
            "hit": beat("it hits the wooden block", "wooden_block", (1, 10), {"kind": "hits", "entity": "steel_block", "other": "wooden_block"}, "slide"),
            "push": beat("the wooden block slides on", "wooden_block", (3, 22), {"kind": "and", "of": [
                {"kind": "slides", "entity": "wooden_block"},
                {"kind": "displacement", "entity": "wooden_block", "axis": [1, 0, 0], "min": 0.08, "when": "end"},
            ]}, "hit"),
        },
        frames=32, eye=(-0.1, -1.2, 0.45), target=(0, 0, 0.05), touching=[("steel_block", "wooden_block")],
    )  # fmt: skip


def shelf() -> Document:
    """A steel ball rolls into three wooden blocks on a shelf, and the last one falls off."""
    top, edge, radius = 0.3, 0.22, 0.02
    names = ("b1", "b2", "b3")
    return scene(
        "Three blocks",
        {
            "floor": ground(),
            "shelf": block("stone shelf", "stone", (0.8, 0.3, top), (edge - 0.4, 0, top / 2), "static"),
            "ball": ball("steel ball", "steel", radius, (-0.2, 0, top + GAP + radius), velocity=(1, 0, 0), spin=(0, 1 / radius, 0)),
            **{n: block(f"wooden block {k + 1}", "wood", (0.03, 0.05, 0.05), (round(edge - 0.0155 - 0.034 * (2 - k), 6), 0, top + GAP + 0.025))
               for k, n in enumerate(names)},
        },
        {
            "roll": beat("the ball rolls", "ball", (0, 6), {"kind": "rolls", "entity": "ball"}),
            "strike": beat("it hits the first block", "b1", (1, 10), {"kind": "hits", "entity": "ball", "other": "b1"}, "roll"),
            "fall": beat("the last block falls off the shelf", "b3", (4, 22), {"kind": "falls", "entity": "b3", "min": 0.15}, "strike"),
        },
        frames=34, eye=(0.25, -1.3, 0.55), target=(0.15, 0, 0.2), touching=[("ball", "b1")],
    )  # fmt: skip


def dominoes() -> Document:
    """A wooden slab topples against a second one, which topples too."""
    size = (0.04, 0.1, 0.3)
    z = 0.15 + GAP
    return scene(
        "Two slabs",
        {
            "floor": ground("stone"),
            "first": block("wooden slab that is given a start", "grip", size, (-0.1, 0, z), velocity=(0.375, 0, 0), spin=(0, 2.5, 0)),
            "second": block("wooden slab that is hit", "grip", size, (0.08, 0, z)),
        },
        {
            "tip": beat("the first slab tips", "first", (0, 18), {"kind": "tips", "entity": "first"}),
            "knock": beat("it knocks the second", "second", (2, 20), {"kind": "hits", "entity": "first", "other": "second"}, "tip"),
            "follow": beat("the second slab falls", "second", (4, 34), {"kind": "tips", "entity": "second"}, "knock"),
        },
        frames=46, eye=(0.1, -1.7, 0.5), target=(0.1, 0, 0.12), touching=[("first", "second")],
    )  # fmt: skip


def bounce() -> Document:
    """A rubber ball is let go, falls onto a stone floor and bounces."""
    return scene(
        "Rubber ball",
        {"floor": ground("floor"), "ball": ball("red rubber ball", "rubber", 0.05, (0, 0, 0.5))},
        {
            "fall": beat("the ball is let go and falls", "ball", (3, 12), {"kind": "falls", "entity": "ball"}, owner="latch"),
            "bounce": beat("it bounces off the floor", "ball", (6, 26), {"kind": "bounces", "entity": "ball", "other": "floor"}, "fall"),
        },
        frames=42, eye=(0.2, -1.6, 0.5), target=(0, 0, 0.22), touching=[("ball", "floor")],
        drivers={"latch": _latch("ball", 0.125)},
    )  # fmt: skip


def _latch(name: str, time: float) -> Document:
    """Holds a body until a time [s]."""
    return {"kind": "release", "entity": name, "time": time}


def _path(name: str, *keys: tuple[float, Place]) -> Document:
    made = {f"k{i}": {"time": t, "pose": {"position": list(at)}} for i, (t, at) in enumerate(keys)}
    return {"kind": "path", "entity": name, "keys": made}


def push() -> Document:
    """A steel plate on a path pushes a wooden crate along the floor."""
    return scene(
        "Pushed crate",
        {
            "floor": ground(),
            "plate": block("steel plate that pushes", "steel", (0.04, 0.16, 0.16), (-0.18, 0, 0.09), "kinematic"),
            "crate": block("wooden crate", "wood", (0.2, 0.2, 0.2), (0, 0, 0.1 + GAP)),
        },
        {
            "advance": beat("the plate moves forward", "plate", (0, 12), {"kind": "displacement", "entity": "plate", "axis": [1, 0, 0], "min": 0.1}, owner="drive"),
            "push": beat("it pushes the crate", "crate", (3, 26), {"kind": "pushes", "entity": "plate", "other": "crate", "min": 0.2}, "advance"),
        },
        frames=40, eye=(0.1, -1.7, 0.6), target=(0.1, 0, 0.1), touching=[("plate", "crate")],
        drivers={"drive": _path("plate", (0.0, (-0.18, 0, 0.09)), (0.7, (0.11, 0, 0.09)), (2.0, (0.11, 0, 0.09)))},
    )  # fmt: skip


def lift() -> Document:
    """A steel platform on a path lifts a wooden beam off two posts."""
    keys = ((0.0, (0, 0, 0.1)), (0.2, (0, 0, 0.12)), (0.9, (0, 0, 0.4)), (1.1, (0, 0, 0.42)), (2.0, (0, 0, 0.42)))
    post = (0.06, 0.16, 0.2)
    return scene(
        "Lift",
        {
            "floor": ground(),
            "left_post": block("stone post", "stone", post, (-0.2, 0, 0.1), "static"),
            "right_post": block("stone post", "stone", post, (0.2, 0, 0.1), "static"),
            "platform": block("steel platform that rises", "steel", (0.2, 0.16, 0.05), (0, 0, 0.1), "kinematic"),
            "beam": block("wooden beam", "grip", (0.46, 0.12, 0.1), (0, 0, 0.25 + GAP)),
        },
        {
            "rise": beat("the platform rises", "platform", (0, 12), {"kind": "displacement", "entity": "platform", "axis": [0, 0, 1], "min": 0.05}, owner="drive"),
            "lift": beat("it lifts the beam", "beam", (3, 30), {"kind": "lifts", "entity": "platform", "other": "beam"}, "rise"),
        },
        frames=44, eye=(0.3, -2.0, 0.7), target=(0, 0, 0.32), touching=[("platform", "beam")],
        drivers={"drive": _path("platform", *keys)},
    )  # fmt: skip


def in_turn() -> Document:
    """A steel ball is let go and falls onto one wooden block, later a second ball onto another."""
    return scene(
        "Two balls",
        {
            "floor": ground(),
            "early": ball("steel ball that falls first", "steel", 0.04, (-0.2, 0, 0.45)),
            "late": ball("steel ball that is held longer", "steel", 0.04, (0.2, 0, 0.45)),
            "left": block("wooden block under the first ball", "wood", (0.16, 0.16, 0.06), (-0.2, 0, 0.03 + GAP)),
            "right": block("wooden block under the second ball", "wood", (0.16, 0.16, 0.06), (0.2, 0, 0.03 + GAP)),
        },
        {
            "first": beat("the first ball falls", "early", (3, 12), {"kind": "falls", "entity": "early"}, owner="latch_early"),
            "knock": beat("it hits the left block", "left", (5, 16), {"kind": "hits", "entity": "early", "other": "left"}, "first"),
            "second": beat("the second ball falls", "late", (16, 28), {"kind": "falls", "entity": "late"}, owner="latch_late"),
            "blow": beat("it hits the right block", "right", (20, 34), {"kind": "hits", "entity": "late", "other": "right"}, "second"),
        },
        frames=52, eye=(0, -1.7, 0.5), target=(0, 0, 0.2), touching=[("early", "left"), ("late", "right")],
        drivers={"latch_early": _latch("early", 0.125), "latch_late": _latch("late", 0.75)},
    )  # fmt: skip


def passing() -> Document:
    """A steel ball rolls past a wooden cube and hits a wall."""
    radius = 0.04
    return scene(
        "Near miss",
        {
            "floor": ground(),
            "ball": ball("steel ball", "steel", radius, (-0.4, 0, radius + GAP), velocity=(1.2, 0, 0), spin=(0, 1.2 / radius, 0)),
            "cube": block("wooden cube beside the way", "wood", (0.1, 0.1, 0.1), (-0.05, 0.15, 0.05 + GAP)),
            "wall": block("wooden board that stands in the way", "wood", (0.06, 0.2, 0.2), (0.3, 0, 0.1 + GAP)),
        },
        {
            "roll": beat("the ball rolls", "ball", (0, 14), {"kind": "rolls", "entity": "ball"}),
            "strike": beat("it hits the board", "wall", (8, 20), {"kind": "hits", "entity": "ball", "other": "wall"}, "roll"),
        },
        frames=39, eye=(0, -1.5, 0.7), target=(0, 0, 0.05), touching=[("ball", "wall")],
    )  # fmt: skip


def room() -> Document:
    """A doorway and a table in a room that a person can walk through; a rubber ball is let go beside the way and bounces."""
    legs = {f"leg{k}": {"shape": {"kind": "box", "size": [0.06, 0.06, 0.7]}, "pose": {"position": [x, y, 0.35]}}
            for k, (x, y) in enumerate([(-0.45, -0.25), (0.45, -0.25), (0.45, 0.25), (-0.45, 0.25)])}  # fmt: skip
    table = block("wooden table", "wood", (1.0, 0.6, 0.74), (0.5, 1.0, 0), "static")
    table["parts"] = {"top": {"shape": {"kind": "box", "size": [1.0, 0.6, 0.04]}, "pose": {"position": [0, 0, 0.72]}}, **legs}
    wall = block("stone wall with a doorway", "stone", (0.12, 3.0, 2.4), (-0.8, 0, 0), "static")
    wall["parts"] = {
        "south": {"shape": {"kind": "box", "size": [0.12, 1.0, 2.4]}, "pose": {"position": [0, -1.0, 1.2]}},
        "north": {"shape": {"kind": "box", "size": [0.12, 1.0, 2.4]}, "pose": {"position": [0, 1.0, 1.2]}},
        "lintel": {"shape": {"kind": "box", "size": [0.12, 1.0, 0.3]}, "pose": {"position": [0, 0, 2.25]}},
    }
    floor = block("stone floor", "floor", (5, 3, 0.1), (0, 0, -0.05), "static")
    made = scene(
        "Room",
        {"floor": floor, "wall": wall, "table": table, "ball": ball("red rubber ball", "rubber", 0.08, (0.6, -0.9, 0.6))},
        {
            "fall": beat("the ball is let go and falls", "ball", (3, 12), {"kind": "falls", "entity": "ball"}, owner="latch"),
            "bounce": beat("it bounces off the floor", "ball", (6, 26), {"kind": "bounces", "entity": "ball", "other": "floor"}, "fall"),
        },
        frames=42, eye=(2.3, -0.3, 1.5), target=(0, -0.1, 0.55), touching=[("ball", "floor")],
        drivers={"latch": _latch("ball", 0.125)},
    )  # fmt: skip
    made["shots"]["only"]["keys"]["a"]["fov_deg"] = 70
    made["graph"]["regions"] = {
        "hall": {"kind": "box", "min": [-2.3, -0.4, -0.05], "max": [-1.6, 0.4, 0.1]},
        "window": {"kind": "box", "min": [1.6, -0.4, -0.05], "max": [2.3, 0.4, 0.1]},
    }
    made["graph"]["relations"] |= {
        "way": {"kind": "connects", "a": "hall", "b": "window", "carrier": "walker", "width": 0.8, "headroom": 2.0},
        "floor_table": {"kind": "supports", "a": "floor", "b": "table"},
        "floor_wall": {"kind": "supports", "a": "floor", "b": "wall"},
    }
    return made
