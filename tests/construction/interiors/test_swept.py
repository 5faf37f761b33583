"""Room that joints sweep: nothing is placed where something opens, or could not open itself."""

from __future__ import annotations

import itertools
import math
from pathlib import Path

import numpy as np
import pytest
from worldagent.construction.assets.posing import posed
from worldagent.construction.interiors.arrangement import Arrangement, Frame
from worldagent.construction.interiors.fittings import windows_in
from worldagent.construction.interiors.floor_space import FloorSpace, Spot
from worldagent.construction.interiors.furnishing import Furnished, furnished
from worldagent.construction.interiors.pieces import Stock, made_piece
from worldagent.construction.interiors.plans import Rect
from worldagent.construction.interiors.swept import ENOUGH, Volume
from worldagent.construction.interiors.walls import Opening
from worldagent.construction.interiors.wishes import RoomKind, Wish
from worldagent.construction.primitives import build_shape
from worldagent.worlds.arrays import pose_of

WALL = 0.12
ROOM = Rect(0.0, 0.0, 3.0, 2.2)
WINDOW = Opening("window", "window", "x", (1.5, 2.2 + WALL / 2), 1.2, 0.9, 2.1, ("room", "outside"))
FRAME = Frame("room", 2.6, 1e-3)


def _room(*openings: Opening) -> Arrangement:
    space = FloorSpace(ROOM, list(openings), WALL)
    return Arrangement(FRAME, space, np.random.default_rng(0), fixtures=windows_in(space))


@pytest.mark.parametrize("name", ["wall_cabinet", "fridge", "stove", "shower_tray", "chest_of_drawers", "toilet", "window"])
def test_a_swept_volume_holds_what_moves_all_over_its_way_and_little_more(name: str) -> None:
    """Law: of every joint, at positions between those that were looked at, all corners of what moves lie in it."""
    own = made_piece(name, {}, 1)
    for joint, shape in own.made.joints.items():
        if shape.range is None:
            continue
        end = min(shape.range[1], ENOUGH if shape.kind == "hinge" else math.inf)
        for share in (0.13, 0.37, 0.71, 1.0):
            at = posed(own.made, {joint: share * end})
            moved = [p for body, b in at.bodies.items() if b is not own.made.bodies[body] for p in b.parts.values()]
            for part in moved:
                corners = pose_of(part.pose).apply(build_shape(part.shape, Path()).render.vertices)
                inside = (own.swept.low <= corners[:, None] + 1e-9) & (corners[:, None] - 1e-9 <= own.swept.high)
                boxes = np.asarray(inside.all(axis=2))
                assert boxes.any(axis=1).all(), (joint, share)
    low, high = own.swept.around
    foot = own.foot
    assert low[0] > foot.x0 - 0.02
    assert high[0] < foot.x1 + 0.02, "nothing opens beyond the sides"
    assert high[1] < foot.y1 + 0.02, "nor behind"


def test_volumes_meet_where_boxes_of_both_overlap() -> None:
    one = Volume(np.array([[0.0, 0.0, 0.0], [2.0, 0.0, 0.0]]), np.array([[1.0, 1.0, 1.0], [3.0, 1.0, 1.0]]))
    between = Volume(np.array([[1.2, 0.0, 0.0]]), np.array([[1.8, 1.0, 1.0]]))
    assert not one.meets(between)
    assert one.meets(between.placed(0.3, 0.0, 0.0, 0.0))
    assert not one.meets(between.placed(0.3, 0.0, 1.0, 0.0))
    turned = between.placed(0.0, 0.0, 0.0, math.pi / 2)
    assert turned.low[0] == pytest.approx([-1.0, 1.2, 0.0])
    assert turned.high[0] == pytest.approx([0.0, 1.8, 1.0])


def test_a_screen_is_not_put_where_a_sash_swings_and_a_low_bench_is() -> None:
    room, screen = _room(WINDOW), made_piece("television", {"diagonal": 1.1}, 1)
    assert room.barred(screen, (1.5, 1.9, 0.6), 0.0) == "the sashes of a window"
    assert room.barred(screen, (1.5, 1.9, 0.0), 0.0) is None, "it is lower than the sill"
    assert _room().barred(screen, (1.5, 1.9, 0.6), 0.0) is None


def test_nothing_stands_in_the_board_under_a_window() -> None:
    """Law: a worktop as high as the sill is stopped by the board before it, one that is lower than both skins is not."""
    room = _room(WINDOW)
    base = made_piece("kitchen_base", {}, 1)
    assert room.barred(base, (1.5, 1.85, 1e-3), 0.0) == "a window"
    assert room.barred(base, (1.5, 1.85, -3e-3), 0.0) is None


def test_a_shelf_does_not_hang_where_a_cabinet_opens_and_a_cabinet_not_where_a_shelf_hangs() -> None:
    cabinet, shelf = made_piece("wall_cabinet", {"width": 0.6}, 1), made_piece("wall_shelf", {"width": 0.6}, 1)
    beside = (2.95, 1.5, 1.6)
    room = _room()
    room.put(cabinet, Spot(2.6, 2.2, 0), 1.4, "walls", still=True)
    assert room.barred(shelf, beside, -math.pi / 2) == "what opens of a wall_cabinet"
    room = _room()
    room.put(shelf, Spot(2.95, 1.5, 3), 1.6, "walls", still=True)
    assert room.barred(cabinet, (2.6, 2.2, 1.4), 0.0) == "a wall_shelf, as it opens,"


def test_a_drawer_needs_the_floor_before_it() -> None:
    chest = made_piece("chest_of_drawers", {}, 1)
    assert _room().barred(chest, (1.5, 1.9, 0.0), 0.0) is None
    assert _room().barred(chest, (1.5, 0.4, 0.0), 0.0) == "the walls, as it opens,"


def _furnished(kind: RoomKind, seed: int) -> Furnished:
    rng = np.random.default_rng(seed)
    return furnished(FRAME, kind, FloorSpace(ROOM, [WINDOW], WALL), Stock(rng), density=0.5, rng=rng)


def test_whatever_the_seed_all_that_opens_in_a_crowded_room_can() -> None:
    """Law: no thing stands or hangs in what another sweeps."""
    cupboard = Wish(("cupboard",), use=0.5, parameters={"height": 0.6})
    kind = RoomKind(
        6.0, 2.0, 3.0, False, "oak",
        (cupboard, Wish(("television",), rule="on", to="cupboard"), Wish(("wall_cabinet",), rule="hung", height=1.7, count=(2, 2)),
         Wish(("wall_shelf",), rule="hung", height=1.5, count=(4, 4), sizes=({"width": 0.6}, {"width": 0.3}))),
        {}, floor_share=1.0,
    )  # fmt: skip
    hung = 0
    for seed in range(8):
        found = _furnished(kind, seed)
        hung += sum(t.carrier == "walls" for t in found.standing)
        windows = [(w.name, w.swept, w.solid) for w in windows_in(FloorSpace(ROOM, [WINDOW], WALL))]
        things = [(t.id, t.swept, t.solid) for t in found.standing]
        for (a, opens, _), (b, _, stands) in itertools.permutations([*windows, *things], 2):
            assert not opens.meets(stands), (seed, a, b)
    assert hung >= 30


def test_what_finds_no_place_because_something_opens_there_is_told() -> None:
    kind = RoomKind(6.0, 2.0, 3.0, False, "oak", (Wish(("chest_of_drawers",)),), {}, floor_share=3.0)
    rng = np.random.default_rng(0)
    space = FloorSpace(Rect(0.0, 0.0, 1.2, 0.6), [], WALL)
    found = furnished(FRAME, kind, space, Stock(rng), density=0.0, rng=rng)
    assert found.standing == []
    assert found.lacking == ["room: a chest_of_drawers found no place: the walls, as it opens, stood in the way"]
