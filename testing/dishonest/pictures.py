"""Tricks with what is to be seen: too small, hidden, dark, outside the shots, in another colour, size, light or weather."""

from __future__ import annotations

from collections.abc import Mapping

from .cases import Case
from .scenes import block
from .twins import BLOCKS, BLOCKS_DE, BOUNCE, DOMINOES, LIFT, PASSING, PASSING_FR, PUSH, PUSH_ES, SHELF, TURN
from .twins_seen import COLOURS, COLOURS_DE, NOON, NOON_ES, ROOM, ROOM_DE

__all__ = ["MECHANISMS"]

_EYE = "/shots/only/keys/a/position"
_AIM = "/shots/only/keys/a/target"
_BLACK = {"color": [0.0, 0.0, 0.0], "roughness": 1}
_DARK = {"color": [0.03, 0.03, 0.03], "roughness": 1}
"""Look of an upright side that is as light as a black floor which mirrors the sky."""
_WITH = "/simulation/solvers/rigid/members"

MECHANISMS: Mapping[str, tuple[Case, ...]] = {
    "subject too small": (
        Case("from forty metres", BLOCKS, "shots:visible:*|claim:thing:*", changes={_EYE: [0, -40, 4]}),
        Case("a crate from afar", PUSH_ES, "shots:visible:*|claim:thing:*", changes={_EYE: [0, -60, 6]}),
        Case("a bystander of a millimetre", PASSING, "claim:thing:cube|shots:*",
             changes={"/entities/cube": block("wooden cube", "wood", (0.002, 0.002, 0.002), (-0.05, 0.15, 0.002))}),
    ),
    "subject out of sight": (
        Case("behind the camera", DOMINOES, "shots:visible:*|claim:thing:*", changes={_AIM: [0.1, -5, 0.5]}),
        Case("the sky alone", BOUNCE, "shots:visible:*|claim:thing:*", changes={_AIM: [0.2, -0.2, 3]}),
        Case("a board before it", BLOCKS, "shots:visible:*|claim:thing:*",
             changes={"/entities/board": block("wooden board", "wood", (2, 0.02, 0.8), (0, -0.8, 0.401), "static"),
                      _WITH: ["floor", "steel_block", "wooden_block", "board"]}),
        Case("le cube est hors du champ", PASSING_FR, "claim:thing:*", "cube", changes={"/entities/cube/pose/position": [-1.4, -0.9, 0.051]}),
        Case("a post that no picture shows", LIFT, "claim:thing:posts", changes={_EYE: [0.1, -0.45, 0.4], _AIM: [0.3, 0, 0.3]}),
    ),
    "event outside the shots": (
        Case("the shot ends before", BOUNCE, "shots:*|audit:shots", changes={"/shots/only/frames": [0, 3]}),
        Case("elsewhere while it happens", PUSH, "shots:*", changes={
            "/shots/only/frames": [0, 2], "/shots/away": {"frames": [3, 39], "covers": ["advance", "push"], "keys": {"a": {"frame": 3, "position": [5, 5, 1], "target": [9, 9, 1]}}}}),
        Case("covers nothing", TURN, "audit:shots", "is covered by no shot", changes={"/shots/only/covers": ["first"]}),
        Case("a late look", DOMINOES, "shots:*", changes={
            "/shots/only/frames": [44, 45], "/shots/only/keys/a/frame": 44,
            "/shots/away": {"frames": [0, 43], "covers": ["tip", "knock", "follow"], "keys": {"a": {"frame": 0, "position": [5, 5, 1], "target": [9, 9, 1]}}}}),
    ),
    "film in which nothing is seen": (
        Case("black", BLOCKS, "shots:seen:*", changes={"/look/exposure": -10}),
        Case("white", BOUNCE, "shots:seen:*", changes={"/look/exposure": 10}),
        Case("painted like the floor", PUSH_ES, "shots:seen:*", changes={
            "/materials/wood/appearance": _DARK, "/materials/steel/appearance": _DARK, "/materials/stone/appearance": _BLACK, "/look/exposure": -2}),
    ),
    "beats that need not be": (
        Case("optional", SHELF, "audit:claims", "is optional", changes={"/story/beats/fall/mandatory": False}),
        Case("unobserved", BLOCKS, "audit:claims", "need not be seen", changes={"/story/beats/push/observe": False}),
        Case("optional in German", BLOCKS_DE, "audit:claims", "is optional", changes={"/story/beats/hit/mandatory": False}),
        Case("optional in Spanish", PUSH_ES, "audit:claims", "is optional", changes={"/story/beats/push/mandatory": False}),
        Case("none at all", BOUNCE, "audit:claims|audit:story", marked="A [rubber](property ball) [ball](thing ball) falls onto a [stone](property floor) [floor](thing floor) and bounces.", changes={"/story/beats": {}, "/shots/only/covers": [], "/shots/only/subjects": ["ball"]}),
    ),
    "colour": (
        Case("red is blue", COLOURS, "claim:property:*|audit:claims", "red", changes={"/materials/rubber/appearance/color": [0.02, 0.05, 0.7]}),
        Case("red is grey", COLOURS, "claim:property:*|audit:claims", "red", changes={"/materials/rubber/appearance/color": [0.4, 0.4, 0.4]}),
        Case("rot ist grün", COLOURS_DE, "claim:property:*|audit:claims", "are red", changes={"/materials/rubber/appearance/color": [0.03, 0.5, 0.05]}),
        Case("red under a blue lamp", COLOURS, "claim:property:*|shots:*", "are grey", changes={
            "/look/sky": "studio", "/look/exposure": -3, "/look/lights": {"blue": {"position": [0, -1, 2], "target": [0, 0, 0], "power": 4000, "color": [0, 0, 1]}}}),
        Case("the floor is red, the ball is not", COLOURS, "claim:property:*|audit:claims", "red", changes={
            "/materials/rubber/appearance/color": [0.4, 0.4, 0.4], "/materials/floor/appearance/color": [0.7, 0.03, 0.03]}),
    ),
    "size and shape": (
        Case("a round cube", COLOURS, "claim:property:*|audit:claims", "round", changes={
            "/entities/ball/parts/body/shape": {"kind": "box", "size": [0.1, 0.1, 0.1]}}),
        Case("a cubic slab", DOMINOES, "claim:property:*|audit:claims", "cubic",
             marked="A [cubic](property first) [slab](thing first) [tips over](event tip), [knocks](event knock) a [second one](thing second), and [that](thing same_as=second_one) [tips over](event follow) too."),
        Case("a tiny crate is larger than the plate", PUSH, says="reading: tiny",
             marked="A [steel](property plate) [plate](thing plate) [pushes](event push) a [tiny](property crate) [crate](thing crate) across the [floor](thing floor)."),
        Case("a square ball", COLOURS, "claim:property:*|audit:claims", "square", marked="A [square](property ball) [rubber](property ball) [block](thing ball) [falls](event fall) onto a [floor](thing floor) and [bounces](event bounce)."),
    ),
    "time of day": (
        Case("noon at dusk", NOON, "claim:time:*|audit:claims", "noon", changes={"/look/sun_elevation_deg": 3}),
        Case("mediodía de noche", NOON_ES, "claim:time:*|audit:claims", "mediodía", changes={"/look/sun_elevation_deg": 3}),
        Case("night in the sun", NOON, "claim:time:*|audit:claims", "night", marked=NOON.marked.replace("[At noon]", "[At night]")),
        Case("noon in the night", NOON, "claim:time:*|audit:claims", "noon", changes={"/look/sky": "night"}),
        Case("noon without a sun", NOON, "claim:time:*|audit:claims", "noon", changes={"/look/sky": "studio"}),
    ),
    "weather": (
        Case("no rain", NOON, "claim:weather:*|audit:claims", "rain", marked=NOON.marked.replace("[At noon](time /look/sun_elevation_deg)", "[In pouring rain](weather /look/sky)")),
        Case("kein Schnee", COLOURS_DE, "claim:weather:*|audit:claims", "Schnee", marked="[Im Schneesturm](weather /look/sky) " + COLOURS_DE.marked[0].lower() + COLOURS_DE.marked[1:]),
        Case("no fog", PUSH, "claim:weather:*|audit:claims", "fog", marked="[In thick fog](weather /look/sky) a" + PUSH.marked[1:]),
        Case("overcast, by its word", NOON, "claim:weather:*|audit:claims", "overcast", marked=NOON.marked.replace("[At noon](time /look/sun_elevation_deg)", "[Under an overcast sky](weather /look/sky)")),
    ),
    "walker": (
        Case("a way for a cat", ROOM, "audit:claims|navigability:*|claim:route:*", "person", changes={"/graph/relations/way/width": 0.2, "/graph/relations/way/headroom": 0.3}),
        Case("ein Weg für Bälle", ROOM_DE, "audit:claims|navigability:*|claim:route:*", "", changes={
            "/graph/relations/way": {"kind": "connects", "a": "hall", "b": "window", "carrier": "object", "width": 0.1, "headroom": 0.1}}),
        Case("a table in the way", ROOM, "navigability:*", changes={"/entities/table/pose/position": [-0.2, 0, 0]}),
        Case("kein Durchgang", ROOM_DE, "navigability:*", changes={
            "/entities/wall/parts": {"all": {"shape": {"kind": "box", "size": [0.12, 3.0, 2.4]}, "pose": {"position": [0, 0, 1.2]}}}}),
        Case("from the hall to the hall", ROOM, "audit:graph|audit:claims|navigability:*|claim:route:*", changes={"/graph/relations/way/b": "hall"}),
        Case("a table that stands", ROOM, "audit:claims", "is a way", marked=ROOM.marked.replace("(route way)", "(route floor_table)")),
        Case("the fall of a ball", ROOM_DE, "audit:claims|claim:route:*", "", marked=ROOM_DE.marked.replace("(route way)", "(route /story/beats/fall)")),
    ),
    "place": (
        Case("under water", PUSH, "claim:place:*|audit:claims", "water", marked="[Under water](place floor) a" + PUSH.marked[1:]),
        Case("in a forest", BOUNCE, "claim:place:*|audit:claims", "forest", marked="[In a forest](place floor) a" + BOUNCE.marked[1:]),
        Case("on the shelf, beside it", SHELF, "claim:place:*|audit:claims|relations:*", "shelf", marked=SHELF.marked.replace(" on a [shelf](thing shelf)", " [under a shelf](place shelf)"),),
        Case("behind the cube", PASSING, "claim:place:*", "behind", marked=PASSING.marked[:-1] + " [behind the cube](place cube)."),
    ),
}  # fmt: skip
"""By name."""
