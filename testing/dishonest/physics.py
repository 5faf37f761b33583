"""Tricks with the motion: a helping hand, a hidden hold, another gravity, a motion that is less than the words say."""

from __future__ import annotations

from collections.abc import Mapping

from .cases import GONE, Case
from .scenes import block
from .twins import BLOCKS, BLOCKS_DE, BOUNCE, DOMINOES, LIFT, PASSING, PUSH, PUSH_ES, SHELF, SHELF_DE, TURN

__all__ = ["MECHANISMS"]

_WITH = "/simulation/solvers/rigid/members"
_DRIVE = "/simulation/drivers/"
_CONTACT = {"kind": "contact", "a": "steel_block", "b": "wooden_block"}

MECHANISMS: Mapping[str, tuple[Case, ...]] = {
    "weaker motion": (
        Case("rolls, and slides on ice", PASSING, "beat:roll|claim:event:*", changes={
            "/entities/ball/physics/angular_velocity": [0, 0, 0], "/materials/steel/friction": 0.0, "/materials/wood/friction": 0.01, "/materials/stone/friction": 0.01}),
        Case("slides, and rests", BLOCKS, "beat:*", changes={"/entities/steel_block/physics/linear_velocity": [0.05, 0, 0]}),
        Case("falls off, and stays on the edge", SHELF, "beat:fall", changes={"/entities/ball/physics/linear_velocity": [0.3, 0, 0], "/entities/ball/physics/angular_velocity": [0, 15, 0]}),
        Case("topples, and rocks back", DOMINOES, "beat:*", changes={"/entities/first/physics/angular_velocity": [0, 0.6, 0], "/entities/first/physics/linear_velocity": [0.09, 0, 0]}),
        Case("bounces, and lies", BOUNCE, "beat:bounce", changes={"/materials/rubber/restitution": 0.0}),
        Case("lifts, and brings it down", LIFT, "beat:*", changes={
            "/simulation/drivers/drive/keys": {"k0": {"time": 0, "pose": {"position": [0, 0, 0.1]}}, "k1": {"time": 0.5, "pose": {"position": [0, 0, 0.17]}}, "k2": {"time": 2, "pose": {"position": [0, 0, 0.17]}}}}),
        Case("falls, and is lowered", TURN, "beat:*|audit:*", changes={
            "/entities/late/motion": "kinematic", "/simulation/drivers/latch_late": {"kind": "path", "entity": "late", "keys": {
                "k0": {"time": 0, "pose": {"position": [0.2, 0, 0.45]}}, "k1": {"time": 0.75, "pose": {"position": [0.2, 0, 0.45]}}, "k2": {"time": 1.2, "pose": {"position": [0.2, 0, 0.105]}}}}}),
        Case("thrown down", DOMINOES, "beat:*|audit:*", changes={"/entities/second/physics": {"category": "rigid", "linear_velocity": [1, 0, 2], "angular_velocity": [0, 6, 0]}}),
    ),
    "hidden driver": (
        Case("a torque on the second slab", DOMINOES, "audit:story|beat:driven:*", changes={
            _DRIVE + "help": {"kind": "force", "entity": "second", "torque": [0, 3, 0], "start": 0.3, "end": 0.8}}),
        Case("a force on the pushed block", BLOCKS, "audit:story|beat:driven:*", changes={
            _DRIVE + "help": {"kind": "force", "entity": "wooden_block", "force": [6, 0, 0], "start": 0.1, "end": 1.0}}),
        Case("a wind on the last block", SHELF_DE, "audit:story|beat:driven:*", changes={
            _DRIVE + "help": {"kind": "force", "entity": "b3", "force": [2, 0, 0], "start": 0.1, "end": 0.6}}),
        Case("a hand behind the crate", PUSH_ES, "audit:story|beat:driven:*|causal:without:*", changes={
            _DRIVE + "help": {"kind": "force", "entity": "crate", "force": [60, 0, 0], "start": 0.05, "end": 0.6}}),
        Case("a pusher that no beat tells of", BLOCKS_DE, "audit:story|beat:driven:*", changes={
            "/entities/pusher": block("pusher", "wood", (0.6, 0.04, 0.04), (0.1, 0.13, 0.05), "kinematic"),
            _WITH: ["floor", "steel_block", "wooden_block", "pusher"],
            _DRIVE + "help": {"kind": "path", "entity": "pusher", "keys": {"k0": {"time": 0, "pose": {"position": [0.1, 0.13, 0.05]}}, "k1": {"time": 0.1, "pose": {"position": [0.1, 0.05, 0.05]}}, "k2": {"time": 1.3, "pose": {"position": [0.1, 0.05, 0.05]}}}}}),
        Case("a motion of its own", SHELF, "audit:story", "starts with", changes={"/entities/b3/physics": {"category": "rigid", "linear_velocity": [0.6, 0, 0]}}),
    ),
    "hidden hold": (
        Case("a weld to a point of space", BOUNCE, "audit:reach|support:anchor:*", changes={
            _DRIVE + "latch": GONE, "/story/beats/fall/owner": "rigid", "/simulation/joints": {"nail": {"kind": "weld", "child": "ball", "anchor": [0, 0, 0.5]}}}),
        Case("a spring that nobody sees", SHELF, "audit:reach|support:anchor:*|support:joint:*|beat:driven:*", changes={
            "/simulation/joints": {"spring": {"kind": "spring", "child": "b3", "parent_point": [1.0, 0, 0.326], "child_point": [0.2045, 0, 0.326], "stiffness": 20, "rest_length": 0.1}}}),
        Case("in the air by a word", TURN, "audit:ownership", "afloat", changes={_DRIVE + "latch_late": GONE, "/story/beats/second/owner": "rigid", "/entities/late/afloat": "it simply hangs there"}),
        Case("a shelf in the air", SHELF_DE, "support:*", changes={"/entities/shelf/parts/body/shape/size": [0.8, 0.3, 0.1], "/entities/shelf/dimensions/size": [0.8, 0.3, 0.1], "/entities/shelf/pose/position": [-0.18, 0, 0.25]}),
        Case("a skin of two centimetres", DOMINOES, "audit:bounds|support:*", changes={"/simulation/solvers/rigid/settings/skin": 0.02}),
    ),
    "static thing that moves": (
        Case("the crate is static", PUSH, "audit:*|beat:push|interpenetration:*|contact:*", changes={"/entities/crate/motion": "static"}),
        Case("the beam is static", LIFT, "audit:*|beat:lift|contact:*", changes={"/entities/beam/motion": "static"}),
        Case("the last block is on a path", SHELF, "audit:*|beat:driven:fall|beat:fall", changes={
            "/entities/b3/motion": "kinematic", _DRIVE + "path": {"kind": "path", "entity": "b3", "keys": {
                "k0": {"time": 0, "pose": {"position": [0.2045, 0, 0.326]}}, "k1": {"time": 0.4, "pose": {"position": [0.4, 0, 0.326]}}, "k2": {"time": 0.8, "pose": {"position": [0.4, 0, 0.05]}}}}}),
        Case("der Klotz ist fest", BLOCKS_DE, "beat:*|audit:*", changes={"/entities/wooden_block/motion": "static"}),
    ),
    "vacuous event": (
        Case("it lies already", DOMINOES, "beat:*", changes={
            "/entities/second/pose": {"position": [0.3, 0, 0.021], "euler": [0, 1.5707963, 0]}, "/story/beats/follow/predicate": {"kind": "topples", "entity": "second"}}),
        Case("it touches from the start", BLOCKS, "beat:vacuous:*|beat:*|causal:*", changes={
            "/entities/steel_block/pose/position": [-0.2515, 0, 0.051], "/story/beats/hit/predicate": _CONTACT, "/story/beats/hit/frames": [0, 10]}),
        Case("on the floor from the start", SHELF, "beat:*|support:*", changes={"/entities/b3/pose/position": [0.4, 0, 0.026]}),
        Case("frames after it happened", BOUNCE, "beat:*", changes={"/story/beats/fall/frames": [30, 41], "/story/beats/bounce/frames": [32, 41]}),
        Case("frames beyond the end", TURN, "audit:story", "end after the last frame", changes={"/story/beats/blow/frames": [60, 80]}),
    ),
    "other nature": (
        Case("a tenth of gravity", BOUNCE, says="gravity", changes={"/simulation/gravity": [0, 0, -3.0], "/story/beats/bounce/frames": [6, 40], "/story/beats/fall/frames": [3, 24]}),
        Case("gravity sideways", BLOCKS, says="degrees off straight down", changes={"/simulation/gravity": [2.0, 0, -9.81]}),
        Case("friction of nothing", PUSH_ES, "audit:*|beat:*|support:*|claim:*", changes={"/simulation/contacts": {"ice": {"a": "crate", "b": "floor", "friction": 0.0}}}),
        Case("a ball that bounces for ever", BOUNCE, says="have together a restitution of 1:", changes={"/materials/rubber/restitution": 1.0, "/materials/floor/restitution": 1.0}),
        Case("a film in slow motion", TURN, says="gravity", changes={"/simulation/gravity": [0, 0, -6.0], "/story/beats/first/frames": [3, 14], "/story/beats/second/frames": [16, 32]}),
    ),
    "mass": (
        Case("a crate of a milligram", PUSH, "audit:masses|scale:mass:*", changes={"/entities/crate/physics": {"category": "rigid", "mass": 1e-6}}),
        Case("a steel ball of a gram", PASSING, "audit:masses|scale:mass:*", changes={"/entities/ball/physics/mass": 0.001}),
        Case("wood as light as air", SHELF, "audit:density:wood", changes={"/materials/wood/density": 1.3}),
        Case("a beam of a ton", LIFT, "audit:masses|scale:mass:*", changes={"/entities/beam/physics": {"category": "rigid", "mass": 1000}}),
        Case("ein Klotz wie ein Haus", BLOCKS_DE, "audit:density:steel", changes={"/materials/steel/density": 90000}),
    ),
    "event proven by an or": (
        Case("or it rests", BOUNCE, "audit:claims|beat:branches:*", changes={"/story/beats/bounce/predicate": {"kind": "or", "of": [
            {"kind": "bounces", "entity": "ball", "min": 3.0}, {"kind": "lands", "entity": "ball"}, {"kind": "contact", "a": "ball", "b": "floor"}]}}),
        Case("or nothing", SHELF, "audit:claims|beat:branches:*", changes={"/story/beats/fall/predicate": {"kind": "or", "of": [{"kind": "falls", "entity": "b3", "min": 9}, {"kind": "supported", "entity": "b3"}]}}),
        Case("one of two", TURN, "audit:claims|beat:branches:*", changes={"/story/beats/second/predicate": {"kind": "or", "of": [{"kind": "falls", "entity": "late"}, {"kind": "spins", "entity": "late"}]}}),
        Case("a count of none", SHELF_DE, "audit:claims|beat:*", changes={"/story/beats/fall/predicate": {"kind": "count", "entities": ["b3"], "min": 0, "predicate": {"kind": "falls", "entity": "each"}}}),
        Case("not not", DOMINOES, "audit:claims|beat:*", changes={"/story/beats/follow/predicate": {"kind": "not", "predicate": {"kind": "spins", "entity": "second"}}}),
    ),
    "bound above noise": (
        Case("a touch of nothing", BLOCKS, says="is met by any touch", changes={"/story/beats/hit/predicate": {**_CONTACT, "min_impulse": 0.0}}),
        Case("a shift of a micrometre", PUSH, "audit:bounds|audit:claims", changes={"/story/beats/push/predicate": {"kind": "and", "of": [{"kind": "pushes", "entity": "plate", "other": "crate"}, {"kind": "displacement", "entity": "crate", "min": 1e-6}]}}),
        Case("a tilt of a hair", DOMINOES, "audit:bounds|audit:claims", changes={"/story/beats/follow/predicate": {"kind": "topples", "entity": "second", "min_angle": 0.001}}),
        Case("limits of the checks", SHELF, says="limit energy_growth is", changes={"/simulation/limits": {"energy_growth": 0.2, "support_drift": 0.05}}),
        Case("a crossing of its own place", PASSING, says="judged as crosses", changes={"/story/beats/roll/predicate": {"kind": "crosses", "entity": "ball", "point": [-0.399, 0, 0], "normal": [1, 0, 0]}}),
    ),
}  # fmt: skip
"""By name."""
