"""Kinds of rooms: furniture by function, and small things by what they lie on (R95).

Room areas, least widths and aspects are own choices within the ranges of Infinigen Indoors (arXiv:2406.11824) and Neufert's Architects' Data.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

__all__ = ["KINDS", "RoomKind", "Wish"]

Rule = Literal["wall", "free", "around", "before", "facing", "beside", "flat", "hung", "pairs", "line"]


@dataclass(frozen=True)
class Wish:
    """Furniture that a room has, in order of importance."""

    generators: tuple[str, ...]
    """One of these."""
    rule: Rule = "wall"
    """wall: back to a wall; free: in the room; around, before, facing, beside: relative to `to`; flat: on the floor, walked over; hung: on a
    wall; pairs, line: in two rows along the room, or one in the middle."""
    count: tuple[int, int] = (1, 1)
    to: str = ""
    """Generator of the thing that it belongs to."""
    use: float = 0.0
    """Depth of floor before it from which it is used [m]."""
    height: float = 0.0
    """Height above the floor of the middle of what hangs on a wall [m]."""
    parameters: Mapping[str, Any] = field(default_factory=dict)
    under: float = 0.0
    """It is as high as the room less this [m]; 0 for things of their own height."""


@dataclass(frozen=True)
class RoomKind:
    """A kind of room."""

    area: float
    """[m^2]"""
    width: float
    """Least clear side [m]."""
    aspect: float
    daylight: bool
    floor: str
    """Material of its floor."""
    wishes: tuple[Wish, ...]
    clutter: Mapping[str, tuple[str, ...]]
    """Small things by the generator of what they lie on; "" for any."""
    loose: tuple[str, ...] = ()
    """Small things on the floor along the walls."""
    height: float = 2.6
    """From floor to ceiling where nothing is asked for [m]."""
    walls: str = "gypsum_plaster"
    """Material of its walls."""
    gate: tuple[float, float] | None = None
    """Clear width and height of its doors to the outside, with two leaves [m]; None for doors as asked for."""
    high: bool = False
    """Its windows are under the ceiling."""


def _w(*generators: str, **more: Any) -> Wish:
    return Wish(tuple(generators), **more)


BOOKS = ("book", "row_of_books", "book", "vase", "chest", "jar", "flower_pot", "toy_duck", "lantern", "bowl")
TABLEWARE = (
    "plate",
    "glass",
    "bowl",
    "mug",
    "wine_glass",
    "jug",
    "saucer",
    "fork",
    "knife",
    "spoon",
    "apple",
    "pear",
    "banana",
    "loaf",
    "cheese_wheel",
)
PICTURES = _w("picture_frame", rule="hung", count=(1, 3), height=1.55)

KINDS: Mapping[str, RoomKind] = {
    "living": RoomKind(
        24.0, 3.0, 2.0, True, "oak",
        (
            _w("sofa", use=0.4),
            _w("table", rule="before", to="sofa", parameters={"width": 1.0, "depth": 0.55, "height": 0.42, "apron": 0.05}),
            _w("television", rule="facing", to="sofa", use=0.5),
            _w("bookcase", count=(2, 3), use=0.5),
            _w("armchair", rule="wall", count=(1, 2), use=0.4),
            _w("upright_piano", count=(0, 1), use=0.7),
            _w("cupboard", use=0.6),
            _w("chest_of_drawers", use=0.6),
            _w("floor_lamp", count=(1, 2)),
            _w("round_table", count=(1, 1), parameters={"diameter": 0.5, "height": 0.55}),
            _w("rug", rule="flat"),
            _w("wall_shelf", rule="hung", count=(1, 2), height=1.5),
            _w("wall_clock", rule="hung", count=(0, 1), height=1.7),
            PICTURES,
        ),
        {
            "bookcase": BOOKS,
            "wall_shelf": BOOKS,
            "television": ("jar", "vase", "book"),
            "": ("vase", "bowl", "book", "mug", "table_lamp", "wine_glass", "apple", "lantern"),
        },
        ("basket", "flower_pot", "building_blocks", "toy_car"),
    ),
    "kitchen": RoomKind(
        13.0, 2.2, 2.2, True, "terracotta",
        (
            _w("sink_unit", use=0.9),
            _w("stove", use=0.9),
            _w("fridge", use=0.9),
            _w("kitchen_base", count=(2, 4), use=0.9),
            _w("table", rule="free", parameters={"width": 1.1, "depth": 0.75}),
            _w("chair", "stool", rule="around", to="table", count=(2, 4)),
            _w("wall_cabinet", rule="hung", count=(1, 2), height=1.75),
            _w("wall_shelf", rule="hung", count=(1, 2), height=1.5),
            _w("wall_clock", rule="hung", height=1.9),
            PICTURES,
        ),
        {
            "table": TABLEWARE,
            "wall_shelf": ("jar", "mug", "bowl", "plate", "tin_can", "jug", "glass"),
            "wall_cabinet": ("jar", "mug", "bowl", "tin_can", "glass"),
            "fridge": ("chest", "basket", "bowl", "tin_can"),
            "stove": ("cooking_pot", "kettle", "frying_pan"),
            "": ("kettle", "jar", "chopping_board", "bowl", "jug", "tin_can", "mug", "teapot", "apple", "pear", "carrot", "loaf", "knife", "spoon", "rolling_pin"),
        },
        ("bucket", "wooden_crate", "basket"),
    ),
    "bedroom": RoomKind(
        15.0, 2.7, 2.0, True, "oak",
        (
            _w("bed", use=0.6),
            _w("bedside_table", rule="beside", to="bed", count=(1, 2)),
            _w("wardrobe", use=0.7),
            _w("chest_of_drawers", count=(1, 2), use=0.7),
            _w("bookcase", count=(1, 2), use=0.5),
            _w("chair", count=(1, 1)),
            _w("wall_mirror", rule="hung", height=1.5),
            _w("rug", rule="flat"),
            _w("wall_shelf", rule="hung", count=(1, 2), height=1.6),
            PICTURES,
        ),
        {
            "bed": (),
            "bookcase": BOOKS,
            "wall_shelf": BOOKS,
            "bedside_table": ("table_lamp", "book", "glass", "candle"),
            "wardrobe": ("chest", "suitcase", "basket"),
            "": ("book", "jar", "vase", "candle", "chest", "mug", "towels", "toy_duck"),
        },
        ("suitcase", "basket", "cardboard_box", "building_blocks"),
    ),
    "bathroom": RoomKind(
        6.5, 1.8, 2.2, False, "porcelain",
        (
            _w("bathtub", use=0.6),
            _w("washbasin", use=0.7),
            _w("toilet", use=0.6),
            _w("cupboard", use=0.5, parameters={}),
            _w("stool"),
            _w("bookcase", use=0.5),
            _w("wall_mirror", rule="hung", height=1.5),
            _w("wall_shelf", rule="hung", count=(2, 3), height=1.4),
            _w("wall_cabinet", rule="hung", height=1.6),
            _w("rug", rule="flat"),
        ),
        {"": ("jar", "towels", "mug", "bowl", "toy_duck", "chest", "tin_can", "candle", "glass", "flower_pot", "vase", "jug", "basket")},
        ("bucket", "basket"),
    ),
    "hall": RoomKind(
        9.5, 1.3, 6.0, False, "limestone",
        (
            _w("coat_rack"),
            _w("chest_of_drawers", use=0.6),
            _w("bench", use=0.4),
            _w("bookcase", count=(1, 2), use=0.5),
            _w("wall_mirror", rule="hung", height=1.5),
            _w("wall_shelf", rule="hung", count=(2, 3), height=1.5),
            _w("wall_clock", rule="hung", height=1.8),
            PICTURES,
        ),
        {
            "bookcase": BOOKS,
            "": ("vase", "bowl", "chest", "book", "lantern", "jar", "flower_pot", "basket", "jug"),
        },
        ("suitcase", "basket", "cardboard_box", "bucket"),
    ),
    "study": RoomKind(
        11.0, 2.4, 2.0, True, "oak",
        (
            _w("desk"),
            _w("chair", rule="before", to="desk"),
            _w("bookcase", count=(2, 4), use=0.5),
            _w("filing_cabinet", use=0.6),
            _w("armchair", use=0.4),
            _w("round_table", parameters={"diameter": 0.5, "height": 0.55}),
            _w("floor_lamp"),
            _w("rug", rule="flat"),
            _w("wall_shelf", rule="hung", count=(1, 2), height=1.5),
            _w("wall_clock", rule="hung", height=1.8),
            PICTURES,
        ),
        {
            "bookcase": BOOKS,
            "wall_shelf": BOOKS,
            "desk": ("table_lamp", "book", "mug", "chest", "jar", "apple"),
            "chair": (),
            "": ("book", "vase", "chest", "mug", "jar", "lantern", "flower_pot"),
        },
        ("cardboard_box", "basket", "suitcase", "wooden_crate"),
    ),
    "workshop": RoomKind(
        18.0, 3.0, 2.0, True, "concrete_c30",
        (
            _w("workbench", count=(1, 2), use=0.9),
            _w("bookcase", count=(2, 3), use=0.6),
            _w("cupboard", count=(1, 2), use=0.6),
            _w("table", rule="free", parameters={"width": 1.2, "depth": 0.8, "leg": 0.08, "top": 0.045}),
            _w("stool", count=(1, 2)),
            _w("ladder", count=(0, 0)),
            _w("barrel", count=(1, 2)),
            _w("wall_shelf", rule="hung", count=(2, 3), height=1.5),
            _w("wall_clock", rule="hung", height=1.9),
        ),
        {"": ("hammer", "saw", "spanner", "screwdriver", "tin_can", "jar", "chest", "toolbox", "mug", "lantern", "bucket", "rope_coil", "wooden_crate", "axe")},
        ("bucket", "wooden_crate", "cardboard_box", "toolbox", "basket"),
    ),
    "store": RoomKind(
        6.0, 1.6, 3.0, False, "concrete_c30",
        (_w("bookcase", count=(2, 4), use=0.6), _w("cupboard", count=(1, 2), use=0.6), _w("barrel", count=(0, 2))),
        {"": ("tin_can", "jar", "chest", "bucket", "basket", "jug", "cooking_pot", "wooden_crate", "lantern", "flower_pot", "rope_coil", "bowl")},
        ("wooden_crate", "cardboard_box", "bucket", "basket"),
    ),
    "corridor": RoomKind(
        12.0, 1.6, 40.0, False, "limestone",
        (PICTURES, _w("wall_mirror", rule="hung", count=(0, 1), height=1.5), _w("wall_clock", rule="hung", count=(0, 1), height=1.8)),
        {},
        ("flower_pot",),
    ),
    "stairs": RoomKind(9.0, 1.9, 9.0, False, "limestone", (), {}),
    "barn": RoomKind(
        54.0, 5.0, 1.8, False, "concrete_c30",
        (
            _w("hopper", count=(0, 1), use=0.6),
            _w("trough", count=(1, 2), use=0.6),
            _w("workbench", use=0.9),
            _w("log_pile", count=(1, 2)),
            _w("barrel", count=(3, 5)),
            _w("firewood_stack", count=(1, 2)),
            _w("wall_shelf", rule="hung", count=(1, 2), height=1.6),
        ),
        {"": ("bucket", "lantern", "hammer", "rope_coil", "axe", "saw", "wooden_crate"), "trough": (), "hopper": ()},
        ("wooden_crate", "bucket", "basket", "wooden_crate", "watering_can", "pumpkin"),
        3.4, "larch", (2.6, 2.6), True,
    ),
    "museum": RoomKind(
        84.0, 6.5, 2.2, True, "marble",
        (
            _w("column", rule="pairs", count=(6, 6), under=0.02, parameters={"material": "limestone"}),
            _w("display_case", rule="line", count=(3, 3), use=0.8, parameters={"stand": "plinth"}),
            _w("display_case", rule="wall", count=(3, 5), use=0.8, parameters={"stand": "plinth"}),
            _w("bench", rule="wall", count=(2, 3), use=0.5),
            _w("picture_frame", rule="hung", count=(5, 8), height=1.6),
        ),
        {"display_case": ("vase", "jug", "bowl", "jar", "toy_duck", "candlestick", "wine_glass", "anvil"), "bench": ()},
        (),
        4.4, "gypsum_plaster", (1.9, 2.5), True,
    ),
}  # fmt: skip
