"""The specification that the scripted agent of `domino_run` proposes, before its mistakes are put in."""

from __future__ import annotations

import math
from typing import Any

from ..worlds.claim_marks import with_claims

__all__ = ["PROMPT", "domino_spec"]

PROMPT = (
    "A steel ball is released at the top of a wooden ramp on a workbench, rolls down and strikes the first of twenty dominoes. "
    "The chain runs around a corner, the last domino tips a seesaw, and the seesaw throws a small wooden cube into a bowl on the floor."
)
CLAIMS = (
    "A [steel](property ball) [ball](thing ball) is [released](event release) at the top of a [wooden](property ramp) [ramp](thing ramp) on a "
    "[workbench](thing bench), [rolls down](event release) and [strikes](event strike) [the first](thing d01) of [twenty dominoes](count {}). "
    "[The chain runs around a corner](event corner chain), [the last domino](thing d20) [tips](event tip) a [seesaw](thing beam fulcrum), "
    "and the [seesaw](thing same_as=seesaw) [throws](event throw) a [small wooden](property cube) [cube](thing cube) [into](route catch) a "
    "[bowl](thing bowl) on the [floor](thing floor)."
)
"""The prompt, marked; `{}` stands for the ids of the dominoes."""
TOP = 0.72
"""Height of the bench top [m]."""
DOMINO = (0.01, 0.03, 0.06)
SPACING = 0.028
COUNT = 20
SKIN = 0.0004
GAP = 2 * SKIN
BALL = 0.014
FRAMES = 84
NEAR, FAR, BEAM, LIP, LIP_DEPTH = 0.055, 0.107, 0.004, 0.008, 0.005
"""Arms of the seesaw from its pivot, thickness of its board, height and depth of its lip [m]."""
TILT, SWING = 0.65, 0.18
"""Slope of the waiting arm, and how far its hinge lets it swing [rad]."""
CHEEK, CHEEK_GAP = 0.003, 0.002
"""Thickness of the plates beside the beam that hold its axle, and their distance from it [m]."""


def _box(size: tuple[float, float, float]) -> dict[str, Any]:
    return {"kind": "box", "size": list(size)}


def _entity(
    role: str, motion: str, material: str, size: tuple[float, float, float], shape: dict[str, Any], position: Any, **more: Any
) -> dict[str, Any]:
    return {
        "role": role,
        "motion": motion,
        "material": material,
        "dimensions": {"size": [round(s, 6) for s in size]},
        "pose": {"position": [round(float(p), 6) for p in position], **more.pop("turn", {})},
        "parts": {"body": {"shape": shape}},
        **more,
    }


def _chain() -> list[tuple[float, float, float]]:
    """(x, y, heading) of the dominoes: eight straight, six around a quarter circle, six straight."""
    x, y, heading, places = -0.10, -0.03, 0.0, []
    for k in range(COUNT):
        places.append((x, y, heading))
        turn = math.pi / 12 if 7 <= k < 13 else 0.0
        x += SPACING * math.cos(heading + turn / 2)
        y += SPACING * math.sin(heading + turn / 2)
        heading += turn
    return places


def _bench() -> dict[str, Any]:
    legs = {
        f"leg{i}": {"shape": _box((0.06, 0.06, TOP - 0.04)), "pose": {"position": [sx * 0.52, sy * 0.30, (TOP - 0.04) / 2]}}
        for i, (sx, sy) in enumerate(((-1, -1), (1, -1), (1, 1), (-1, 1)))
    }
    return {
        "role": "workbench that carries the run",
        "motion": "static",
        "material": "bench_wood",
        "dimensions": {"size": [1.2, 0.75, TOP]},
        "nominal_diagonal": 1.6,
        "parts": {"top": {"shape": _box((1.2, 0.75, 0.04)), "pose": {"position": [0, 0, TOP - 0.02]}}, **legs},
    }


def _seesaw(pivot: tuple[float, float], height: float) -> tuple[dict[str, Any], dict[str, Any], dict[str, Any]]:
    """Bent beam with a lip at its far end, fulcrum, and a hinge whose stops end the swing before the arm is level."""
    width = 0.03
    cos, sin = math.cos(TILT), math.sin(TILT)
    lip_at = (FAR - LIP_DEPTH / 2, BEAM / 2 + LIP / 2)
    arm = {"shape": _box((width, FAR, BEAM)), "pose": {"position": [0, FAR / 2 * cos, -FAR / 2 * sin], "euler": [-TILT, 0, 0]}}
    lip = {
        "shape": _box((width, LIP_DEPTH, LIP)),
        "pose": {"position": [0, lip_at[0] * cos + lip_at[1] * sin, -lip_at[0] * sin + lip_at[1] * cos], "euler": [-TILT, 0, 0]},
    }
    # The far upper corner of the lip reaches farthest out, the far lower corner of the arm lowest.
    size = (width, NEAR + FAR * cos + (BEAM / 2 + LIP) * sin, BEAM / 2 + FAR * sin + BEAM / 2 * cos)
    beam = {
        "role": "seesaw: a level paddle, and an arm sloping down to a lip that holds the cube",
        "motion": "dynamic",
        "material": "balsa",
        "dimensions": {"size": [round(v, 6) for v in size]},
        "pose": {"position": [pivot[0], pivot[1], TOP + height]},
        "parts": {
            # The paddle outweighs the empty arm and not the loaded one: the seesaw stays tipped after the throw.
            "paddle": {"shape": _box((width, NEAR, BEAM)), "pose": {"position": [0, -NEAR / 2, 0]}, "material": "dark_wood"},
            "arm": arm,
            "lip": lip,
        },
    }
    apex = height - BEAM - 0.004
    profile = [[-0.014, -apex / 2], [0.014, -apex / 2], [0.002, apex / 2], [-0.002, apex / 2]]
    fulcrum = _entity(
        "fulcrum of the seesaw, with two cheeks beside the beam that hold its axle",
        "static",
        "dark_wood",
        (0.028, height + CHEEK, 2 * (width / 2 + CHEEK_GAP + CHEEK)),
        {"kind": "extrusion", "polygon": profile, "height": 0.02},
        (pivot[0], pivot[1], TOP + apex / 2),
        turn={"euler": [round(math.pi / 2, 12), 0, round(math.pi / 2, 12)]},
    )
    # In its frame y is up and z runs along the axle.
    low, side = -apex / 2, width / 2 + CHEEK_GAP + CHEEK / 2
    fulcrum["parts"]["foot"] = {
        "shape": _box((0.028, 0.004, 2 * side + CHEEK)),
        "pose": {"position": [0, round(low + 0.002, 6), 0]},
    }
    for name, sign in (("left", -1), ("right", 1)):
        at = [0, round(low + (height + CHEEK) / 2, 6), round(sign * side, 6)]
        fulcrum["parts"][f"{name}_cheek"] = {"shape": _box((0.008, round(height + CHEEK, 6), CHEEK)), "pose": {"position": at}}
    hinge = {
        "kind": "hinge",
        "parent": "fulcrum",
        "child": "beam",
        "anchor": [pivot[0], pivot[1], TOP + height],
        "axis": [1, 0, 0],
        "range": [0, SWING],
        "damping": 1e-6,
    }
    return beam, fulcrum, hinge


def domino_spec(bowl_at: tuple[float, float] = (0.203, 0.57)) -> dict[str, Any]:
    """The specification without its prompt, as `edit_spec` takes it."""
    places = _chain()
    last_x, last_y, _ = places[-1]
    pivot = (round(last_x, 6), round(last_y + 0.101, 6))
    height = 0.032
    beam, fulcrum, hinge = _seesaw(pivot, height)
    cube = 0.018
    # The cube lies on the board, one gap above it and one gap before the lip.
    along, up = FAR - LIP_DEPTH - GAP - cube / 2, BEAM / 2 + GAP + cube / 2
    cube_at = (
        pivot[0],
        pivot[1] + along * math.cos(TILT) + up * math.sin(TILT),
        TOP + height - along * math.sin(TILT) + up * math.cos(TILT),
    )
    ramp_length, ramp_low, ramp_high = 0.30, 0.035, 0.125
    slope = math.atan2(ramp_high - ramp_low, ramp_length)
    ramp_end = places[0][0] - 0.035
    ball_back = ramp_length - 0.03
    ball_at = (
        ramp_end - ball_back + (BALL + GAP) * math.sin(slope),
        places[0][1],
        TOP + GAP + ramp_low + ball_back * math.tan(slope) + (BALL + GAP) * math.cos(slope),
    )
    middle = (ramp_high + 0.0) / 2
    ramp = _entity(
        "wooden ramp",
        "static",
        "dark_wood",
        (ramp_length, ramp_high, 0.08),
        {
            "kind": "extrusion",
            "polygon": [
                [-ramp_length / 2, -middle],
                [ramp_length / 2, -middle],
                [ramp_length / 2, ramp_low - middle],
                [-ramp_length / 2, ramp_high - middle],
            ],
            "height": 0.08,
        },
        (ramp_end - ramp_length / 2, places[0][1], TOP + middle),
        turn={"euler": [round(math.pi / 2, 12), 0, 0]},
    )
    entities: dict[str, Any] = {
        "floor": _entity("workshop floor", "static", "concrete", (6, 6, 0.1), _box((6, 6, 0.1)), (0, 0, -0.05)),
        "bench": _bench(),
        "ramp": ramp,
        "ball": _entity("steel ball", "dynamic", "steel", (2 * BALL,) * 3, {"kind": "sphere", "radius": BALL}, ball_at, nominal_diagonal=0.05),
        **{
            f"d{k + 1:02d}": _entity(
                f"domino {k + 1}", "dynamic", "domino_wood", DOMINO, _box(DOMINO), (x, y, TOP + GAP + DOMINO[2] / 2),
                **({"turn": {"euler": [0, 0, round(h, 9)]}} if h else {}), nominal_diagonal=0.068,
            )
            for k, (x, y, h) in enumerate(places)
        },
        "fulcrum": fulcrum,
        "beam": beam,
        "cube": _entity("small wooden cube", "dynamic", "light_wood", (cube,) * 3, _box((cube,) * 3), cube_at, turn={"euler": [-TILT, 0, 0]}),
        "bowl": _entity(
            "bowl that catches the cube", "dynamic", "ceramic", (0.36, 0.36, 0.11),
            {"kind": "revolution", "segments": 32, "profile": [[0, 0], [0.09, 0], [0.18, 0.1], [0.18, 0.11], [0.17, 0.11], [0.085, 0.012], [0, 0.012]]},
            (*bowl_at, GAP), nominal_diagonal=0.5,
        ),
    }  # fmt: skip
    dominoes = [f"d{k + 1:02d}" for k in range(COUNT)]
    supports = {f"on_bench_{n}": {"kind": "supports", "a": "bench", "b": n} for n in ("ramp", "fulcrum", *dominoes)}
    relations: dict[str, Any] = {
        "bench_on_floor": {"kind": "supports", "a": "floor", "b": "bench"},
        "ball_on_ramp": {"kind": "supports", "a": "ramp", "b": "ball", "frames": [0, 3]},
        **supports,
        "cube_on_beam": {"kind": "supports", "a": "beam", "b": "cube"},
        "bowl_on_floor": {"kind": "supports", "a": "floor", "b": "bowl"},
        "beam_on_fulcrum": {"kind": "interacts", "a": "fulcrum", "b": "beam"},
        "ball_hits_first": {"kind": "interacts", "a": "ball", "b": "d01"},
        "last_hits_beam": {"kind": "interacts", "a": "d20", "b": "beam"},
    }
    regions = {"in_bowl": {"kind": "cylinder", "center": [0, 0, 0.06], "radius": 0.165, "height": 0.11, "relative_to": "bowl"}}
    topple = {"kind": "topples", "entity": "each", "min_angle": 0.7}
    beats: dict[str, Any] = {
        "release": {"text": "the ball is released and starts to roll", "owner": "let_go", "subject": "ball", "frames": [8, 12],
                    "predicate": {"kind": "rolls", "entity": "ball"}},
        "strike": {"text": "the ball strikes the first domino", "owner": "rigid", "subject": "d01", "frames": [8, 24], "causes": ["release"],
                   "predicate": {"kind": "hits", "entity": "ball", "other": "d01"}},
        "corner": {"text": "the chain runs around the corner", "owner": "rigid", "subject": "d14", "frames": [16, 40], "causes": ["strike"],
                   "predicate": {**topple, "entity": "d14"}},
        "chain": {"text": "all twenty dominoes fall", "owner": "rigid", "subject": "d20", "frames": [16, 44], "causes": ["strike", "corner"],
                  "predicate": {"kind": "and", "of": [
                      {"kind": "count", "entities": dominoes[:-1], "min": COUNT - 1, "predicate": topple},
                      {"kind": "tilts", "entity": "d20", "min": 0.3}]}},
        "tip": {"text": "the last domino tips the seesaw", "owner": "rigid", "subject": "beam", "frames": [24, 44], "causes": ["corner"],
                "predicate": {"kind": "and", "of": [{"kind": "hits", "entity": "d20", "other": "beam"}, {"kind": "tilts", "entity": "beam", "min": 0.08}]}},
        "throw": {"text": "the seesaw throws the cube", "owner": "rigid", "subject": "cube", "frames": [26, 42], "causes": ["tip"],
                  "predicate": {"kind": "and", "of": [
                      {"kind": "rises", "entity": "cube", "min": 0.02},
                      {"kind": "separation", "a": "cube", "b": "beam", "min": 0.02, "when": "eventually"}]}},
        "catch": {"text": "the cube lands in the bowl and stays", "owner": "rigid", "subject": "cube", "frames": [34, FRAMES - 1], "causes": ["throw"],
                  "predicate": {"kind": "reaches", "entity": "cube", "region": "in_bowl", "when": "end"}},
    }  # fmt: skip
    shots = {
        "ramp_shot": {
            "frames": [0, 16], "covers": ["release", "strike"], "subjects": ["ball", "d01"], "intent": "the ball on its ramp and what waits for it",
            "keys": {"a": {"frame": 0, "position": [-0.42, -0.62, 0.98], "target": [-0.22, -0.03, 0.79], "fov_deg": 34},
                     "b": {"frame": 16, "position": [-0.12, -0.62, 0.98], "target": [-0.08, -0.03, 0.75], "fov_deg": 34}},
        },
        "chain_shot": {
            "frames": [17, 27], "covers": ["strike", "corner", "chain"], "subjects": ["d14"], "intent": "the wave runs round the corner",
            "keys": {"a": {"frame": 17, "position": [0.62, -0.42, 1.12], "target": [0.08, 0.02, 0.74], "fov_deg": 34},
                     "b": {"frame": 27, "position": [0.72, -0.2, 1.08], "target": [0.16, 0.16, 0.74], "fov_deg": 34}},
        },
        "throw_shot": {
            "frames": [28, 38], "covers": ["chain", "corner", "tip", "throw"], "subjects": ["beam", "cube"],
            "intent": "the last dominoes tip the seesaw, the cube takes off",
            "keys": {"a": {"frame": 28, "position": [0.85, 0.5, 0.95], "target": [0.2, 0.36, 0.74], "fov_deg": 34},
                     "b": {"frame": 38, "position": [0.85, 0.6, 0.92], "target": [0.2, 0.44, 0.66], "fov_deg": 34}},
        },
        "catch_shot": {
            "frames": [39, FRAMES - 1], "covers": ["throw", "catch"], "subjects": ["cube", "bowl"], "intent": "the cube falls into the bowl on the floor",
            "keys": {"a": {"frame": 39, "position": [0.8, 0.95, 0.75], "target": [0.2, 0.58, 0.22], "fov_deg": 40},
                     "b": {"frame": 52, "position": [0.62, 0.9, 0.62], "target": [0.2, 0.61, 0.05], "fov_deg": 34},
                     "c": {"frame": FRAMES - 1, "position": [0.56, 0.86, 0.58], "target": [0.2, 0.61, 0.04], "fov_deg": 34}},
        },
    }  # fmt: skip
    spec = {
        "title": "Domino run on a workbench",
        "story": {"semantics": "a chain reaction on a workbench", "beats": beats},
        "materials": {
            "steel": {
                "density": 7850,
                "substance": "steel",
                "friction": 0.4,
                "restitution": 0.3,
                "appearance": {"color": [0.75, 0.76, 0.78], "metallic": 1, "roughness": 0.15},
            },
            "domino_wood": {
                "density": 1000,
                "substance": "wood",
                "friction": 0.3,
                "appearance": {"color": [0.8, 0.16, 0.1], "roughness": 0.35},
            },
            "bench_wood": {
                "density": 650,
                "substance": "wood",
                "friction": 0.5,
                "appearance": {"color": [0.62, 0.43, 0.26], "pattern": "wood", "pattern_scale": 0.12},
            },
            "dark_wood": {
                "density": 700,
                "substance": "wood",
                "friction": 0.4,
                "appearance": {"color": [0.33, 0.19, 0.1], "pattern": "wood", "pattern_scale": 0.06},
            },
            "balsa": {
                "density": 160,
                "substance": "wood",
                "friction": 0.35,
                "appearance": {"color": [0.9, 0.8, 0.6], "pattern": "wood", "pattern_scale": 0.05},
            },
            "light_wood": {
                "density": 300,
                "substance": "wood",
                "friction": 0.35,
                "appearance": {"color": [0.95, 0.75, 0.35], "roughness": 0.6},
            },
            "concrete": {
                "density": 2300,
                "substance": "concrete",
                "friction": 0.7,
                "appearance": {"color": [0.5, 0.5, 0.5], "pattern": "concrete", "pattern_scale": 0.8},
            },
            "ceramic": {
                "density": 2300,
                "substance": "ceramic",
                "friction": 0.5,
                "appearance": {"color": [0.12, 0.3, 0.55], "roughness": 0.15},
            },
        },
        "entities": entities,
        "graph": {"regions": regions, "relations": relations},
        "shots": shots,
        "simulation": {
            "fps": 24,
            "frames": FRAMES,
            "preroll": 0.1,
            "solvers": {"rigid": {"engine": "mujoco", "members": list(entities), "settings": {"step": 4e-4, "skin": SKIN}}},
            "joints": {"hinge": hinge},
            "drivers": {"let_go": {"kind": "release", "entity": "ball", "time": 0.17}},
        },
        "look": {"sky": "studio", "samples": 16, "width": 640, "height": 360},
    }
    return with_claims(spec, PROMPT, CLAIMS.format(" ".join(dominoes)))
