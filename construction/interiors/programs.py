"""Kinds of rooms: furniture by function in order of importance, and small things by what they lie on (R95).

Room areas, least widths and aspects are own choices within the ranges of Infinigen Indoors (arXiv:2406.11824) and Neufert's Architects' Data.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from .wishes import RoomKind, Wish

__all__ = ["KINDS", "NOTHING_ON", "SMALL"]

NOTHING_ON = frozenset(
    ("sofa", "armchair", "chair", "stool", "piano_stool", "bench", "bed", "toilet", "bathtub", "shower_tray", "washbasin", "rug", "barrel",
     "bucket", "suitcase", "cardboard_box", "coat_rack", "basket", "flower_pot")
)  # fmt: skip
"""Things on which nothing lies where the kind of room does not say what."""
SMALL: Mapping[str, Mapping[str, Any]] = {
    "chest": {"width": 0.24, "depth": 0.16, "height": 0.09},
    "basket": {"diameter": 0.22, "height": 0.12, "bow": False},
    "cardboard_box": {"width": 0.3, "depth": 0.2, "height": 0.14},
    "cushion": {"side": 0.3, "thickness": 0.1},
    "lantern": {"width": 0.11, "height": 0.18},
    "table_lamp": {"height": 0.38, "shade": 0.22},
    "vase": {"height": 0.2},
    "flower_pot": {"height": 0.12, "diameter": 0.13},
    "towels": {"width": 0.28, "depth": 0.2},
    "blanket": {"width": 0.34, "depth": 0.26},
    "toolbox": {"width": 0.36, "depth": 0.18, "height": 0.2},
    "wooden_crate": {"width": 0.34, "depth": 0.22, "height": 0.16},
    "candlestick": {"candle": 0.0},
    "bottle": {"stopper": "none"},
}
"""Parameters of things where they lie on others."""


def _w(*generators: str, **more: Any) -> Wish:
    return Wish(tuple(generators), **more)


def _widths(*values: float) -> tuple[dict[str, float], ...]:
    return tuple({"width": v} for v in values)


def _pictures(count: int, most: int = 0) -> Wish:
    sizes: tuple[dict[str, float], ...] = (
        {},
        {"width": 0.4, "height": 0.5},
        {"width": 0.24, "height": 0.32},
        {"width": 0.2, "height": 0.2},
    )
    return _w("picture_frame", rule="hung", count=(count, max(count, most)), height=1.6, sizes=sizes)


def _shelf(count: int, most: int = 0, *, height: float = 1.35) -> Wish:
    return _w("wall_shelf", rule="hung", count=(count, max(count, most)), height=height, sizes=_widths(0.8, 0.6, 0.45, 0.3))


def _upper(count: int = 1, most: int = 0) -> Wish:
    """Shelves over other shelves."""
    return _w(
        "wall_shelf",
        rule="above",
        to="wall_shelf",
        count=(count, max(count, most)),
        height=1.95,
        sizes=_widths(0.8, 0.6, 0.45, 0.3),
    )


def _bookcase(count: int = 1, most: int = 0, *, depth: float = 0.28, use: float = 0.45) -> Wish:
    return _w(
        "bookcase", count=(count, max(count, most)), use=use, parameters={"depth": depth}, sizes=_widths(0.9, 0.7, 0.55, 0.4)
    )


def _rug(*sizes: tuple[float, float]) -> Wish:
    return _w("rug", rule="flat", sizes=tuple({"width": w, "depth": d} for w, d in sizes))


PICTURES = _pictures(1, 3)
MIRROR = _w("wall_mirror", rule="hung", height=1.5, sizes=({}, {"width": 0.4, "height": 0.6}, {"width": 0.3, "height": 0.4}))
CLOCK = _w("wall_clock", rule="hung", height=1.95)
CHAIRS = _w("chair", rule="around", to="table", count=(2, 4), seat=True)
CHEST = _w("chest_of_drawers", use=0.5, sizes=_widths(0.9, 0.7, 0.6))
SHOWER = {"of": "shower_tray", "width": 0.75, "depth": 0.75}
CUPBOARD = _w("cupboard", use=0.5, sizes=({}, {"width": 0.7}, {"width": 0.5, "depth": 0.32}))
BOOKS = (
    "book", "row_of_books", "pile_of_books", "vase", "chest", "jar", "flower_pot", "toy_duck", "lantern", "bowl", "candlestick", "candle", "mug",
)  # fmt: skip
TABLEWARE = (
    "plate", "glass", "bowl", "mug", "wine_glass", "jug", "saucer", "fork", "knife", "spoon", "apple", "pear", "banana", "loaf", "cheese_wheel",
    "bottle", "teapot", "pizza", "candlestick",
)  # fmt: skip
STORES = ("jar", "mug", "bowl", "plate", "tin_can", "jug", "glass", "saucer", "wine_glass", "teapot", "bottle")
WASH = (
    "jar", "towels", "mug", "bowl", "toy_duck", "chest", "tin_can", "candle", "glass", "flower_pot", "vase", "jug", "basket", "bottle",
    "candlestick",
)  # fmt: skip
TOOLS = (
    "hammer", "saw", "spanner", "screwdriver", "tin_can", "jar", "chest", "toolbox", "mug", "lantern", "rope_coil", "wooden_crate", "axe", "bottle",
    "book", "basket", "candle",
)  # fmt: skip
SUPPLIES = (
    "tin_can", "jar", "chest", "basket", "jug", "cooking_pot", "wooden_crate", "lantern", "flower_pot", "rope_coil", "bowl", "bottle", "teapot",
    "kettle", "candle", "towels", "pumpkin", "cardboard_box",
)  # fmt: skip

KINDS: Mapping[str, RoomKind] = {
    "living": RoomKind(
        24.0, 3.0, 2.0, True, "oak",
        (
            _w("sofa", use=0.4, seat=True, sizes=_widths(2.0, 1.6)),
            _w("table", rule="before", to="sofa", parameters={"depth": 0.5, "height": 0.42, "apron": 0.05}, sizes=_widths(1.0, 0.8)),
            _w("cupboard", rule="facing", to="sofa", use=0.5, parameters={"height": 0.6, "fronts": "flat"}, sizes=_widths(1.3, 1.0)),
            _w("television", rule="on", to="cupboard", sizes=({"diagonal": 1.1}, {"diagonal": 0.9})),
            _bookcase(),
            _shelf(1, 2),
            _pictures(2, 3),
            _w("armchair", use=0.3, seat=True),
            _w("floor_lamp"),
            _bookcase(1, 2),
            _w("round_table", sizes=({"diameter": 0.5, "height": 0.55}, {"diameter": 0.4, "height": 0.55})),
            CHEST,
            _w("wall_clock", rule="hung", height=1.8),
            _rug((2.0, 1.4), (1.6, 1.0), (1.2, 0.8), (0.9, 0.6)),
            _w("upright_piano", count=(0, 1), use=0.7),
        ),
        {
            "bookcase": BOOKS,
            "wall_shelf": BOOKS,
            "cupboard": ("jar", "vase", "book", "chest", "candlestick", "lantern"),
            "table": ("mug", "book", "bowl", "apple", "wine_glass", "candle", "saucer", "glass", "pear"),
            "upright_piano": ("vase", "candlestick", "book"),
            "": ("vase", "bowl", "book", "mug", "table_lamp", "wine_glass", "apple", "lantern", "chest", "candle"),
        },
        ("basket", "flower_pot", "building_blocks", "toy_car"),
    ),
    "kitchen": RoomKind(
        13.0, 2.2, 2.2, True, "terracotta",
        (
            _w("sink_unit", rule="row", use=0.7, sizes=_widths(0.9, 0.7)),
            _w("stove", rule="row", use=0.7),
            _w("fridge", rule="row", use=0.7),
            _w("kitchen_base", rule="row", use=0.7, sizes=_widths(0.6, 0.4)),
            _w("table", rule="free", sizes=({"width": 1.1, "depth": 0.75}, {"width": 0.8, "depth": 0.7}, {"width": 0.7, "depth": 0.6})),
            CHAIRS,
            _w("wall_cabinet", rule="hung", height=1.82, sizes=_widths(0.6, 0.45, 0.35)),
            _shelf(1, height=1.55),
            _w("wall_cabinet", rule="hung", count=(1, 2), height=1.82, sizes=_widths(0.6, 0.45, 0.35)),
            _w("kitchen_base", rule="row", count=(1, 2), use=0.7, sizes=_widths(0.6, 0.4)),
            CLOCK,
            _pictures(1, 2),
        ),
        {
            "table": TABLEWARE,
            "wall_shelf": STORES,
            "wall_cabinet": STORES,
            "fridge": ("jar", "bowl", "tin_can", "cheese_wheel", "jug", "bottle", "apple", "pear"),
            "stove": ("cooking_pot", "kettle", "frying_pan"),
            "": (
                "kettle", "jar", "chopping_board", "bowl", "jug", "tin_can", "mug", "teapot", "apple", "pear", "carrot", "loaf", "knife", "spoon",
                "rolling_pin", "plate", "bottle",
            ),
        },
        ("bucket", "wooden_crate", "basket"),
    ),
    "bedroom": RoomKind(
        15.0, 2.7, 2.0, True, "oak",
        (
            _w("bed", use=0.5, seat=True, sizes=_widths(1.4, 1.2, 0.9)),
            _w("bedside_table", rule="beside", to="bed"),
            _w("wardrobe", use=0.6, sizes=_widths(1.6, 1.2, 0.8)),
            _shelf(1),
            _w("wall_mirror", rule="hung", height=1.5, sizes=({}, {"width": 0.4, "height": 0.6})),
            CHEST,
            _bookcase(),
            _pictures(1, 3),
            _w("chair", seat=True, use=0.2),
            _rug((2.0, 1.4), (1.6, 1.0), (1.2, 0.8), (0.9, 0.6)),
            _shelf(1),
            _bookcase(1, 1),
            _w("bedside_table", rule="beside", to="bed", count=(0, 1)),
        ),
        {
            "bookcase": BOOKS,
            "wall_shelf": BOOKS,
            "bedside_table": ("table_lamp", "book", "glass", "candle", "mug", "jar"),
            "wardrobe": ("chest", "basket", "towels", "blanket"),
            "chair": ("book", "towels"),
            "": ("book", "jar", "vase", "candle", "chest", "mug", "towels", "toy_duck", "blanket", "candlestick", "lantern"),
        },
        ("suitcase", "basket", "building_blocks"),
    ),
    "bathroom": RoomKind(
        6.5, 1.8, 2.2, False, "porcelain",
        (
            _w("washbasin", use=0.5),
            _w("toilet", use=0.5),
            _w("bathtub", use=0.4, sizes=({}, {"length": 1.5, "width": 0.7}, {"length": 1.4, "width": 0.68}, SHOWER)),
            _w("wall_mirror", rule="above", to="washbasin", height=1.5, sizes=({"width": 0.4, "height": 0.6}, {"width": 0.4, "height": 0.5})),
            _bookcase(depth=0.24, use=0.4),
            _shelf(2),
            _upper(2),
            _w("cupboard", use=0.4, parameters={"depth": 0.3, "height": 0.9}, sizes=_widths(0.7, 0.5)),
            _w("wall_cabinet", rule="hung", height=1.65, parameters={"depth": 0.25}, sizes=_widths(0.6, 0.45, 0.35)),
            _w("stool", seat=True),
            _shelf(1, 2),
            _upper(),
            _rug((0.9, 0.6), (0.7, 0.5)),
        ),
        {"stool": ("towels",), "": WASH},
        ("bucket", "basket"),
        floor_share=0.58,
    ),
    "hall": RoomKind(
        9.5, 1.55, 5.0, False, "limestone",
        (
            _bookcase(depth=0.26, use=0.3),
            _w("coat_rack", sizes=({}, {"reach": 0.24})),
            _shelf(1),
            _w("cupboard", use=0.35, parameters={"depth": 0.28, "height": 0.9}, sizes=_widths(0.8, 0.6, 0.5)),
            _upper(),
            MIRROR,
            _shelf(1),
            _upper(),
            _w("barrel", parameters={"height": 0.5, "diameter": 0.26, "open": True}),
            _w("table", use=0.3, parameters={"depth": 0.4, "height": 0.8, "leg": 0.04}, sizes=_widths(0.8, 0.6, 0.5)),
            _pictures(2, 3),
            _w("stool", seat=True),
            _shelf(1),
            _upper(),
            CLOCK,
            _rug((1.8, 0.6), (1.3, 0.55), (0.9, 0.5), (0.7, 0.5)),
            _bookcase(0, 1, depth=0.24, use=0.3),
            _shelf(1, 2),
            _w("bench", use=0.3, seat=True, parameters={"depth": 0.34}, sizes=_widths(1.2, 0.9)),
        ),
        {
            "bookcase": BOOKS,
            "bench": ("basket", "blanket"),
            "stool": ("basket", "towels", "book"),
            "": (
                "vase", "bowl", "chest", "book", "lantern", "jar", "flower_pot", "basket", "jug", "candlestick", "pile_of_books", "towels", "mug",
                "candle", "tin_can",
            ),
        },
        ("suitcase", "basket", "bucket"),
    ),
    "study": RoomKind(
        11.0, 2.4, 2.0, True, "oak",
        (
            _w("desk", sizes=_widths(1.4, 1.2, 1.05)),
            _w("chair", rule="before", to="desk", seat=True),
            _bookcase(2),
            _w("filing_cabinet", use=0.5, sizes=({}, {"drawers": 3}, {"drawers": 2})),
            _shelf(1, 2),
            _w("armchair", use=0.3, seat=True, sizes=({}, {"width": 0.72, "depth": 0.76})),
            _w("floor_lamp"),
            _pictures(1, 3),
            _w("round_table", sizes=({"diameter": 0.5, "height": 0.55}, {"diameter": 0.4, "height": 0.55})),
            CLOCK,
            _rug((1.6, 1.0), (1.2, 0.8), (0.9, 0.6)),
            _bookcase(0, 1),
        ),
        {
            "bookcase": BOOKS,
            "wall_shelf": BOOKS,
            "desk": ("table_lamp", "book", "mug", "chest", "jar", "apple", "pile_of_books", "glass"),
            "": ("book", "vase", "chest", "mug", "jar", "lantern", "flower_pot", "pile_of_books"),
        },
        ("basket", "suitcase", "flower_pot"),
    ),
    "workshop": RoomKind(
        18.0, 3.0, 2.0, True, "concrete_c30",
        (
            _w("workbench", use=0.8, sizes=_widths(1.6, 1.3)),
            _bookcase(1, use=0.5),
            _w("cupboard", use=0.5, sizes=({}, {"width": 0.7})),
            _w("table", rule="free", parameters={"leg": 0.08, "top": 0.045}, sizes=({"width": 1.2, "depth": 0.8}, {"width": 0.9, "depth": 0.6})),
            _shelf(2),
            _w("stool", count=(1, 2), seat=True),
            _bookcase(1, use=0.5),
            _w("barrel", count=(1, 2), sizes=({}, {"height": 0.6, "diameter": 0.42})),
            _shelf(1),
            _w("workbench", count=(0, 1), use=0.8),
            CLOCK,
        ),
        {"": TOOLS},
        ("bucket", "wooden_crate", "toolbox", "basket"),
    ),
    "store": RoomKind(
        6.0, 1.6, 3.0, False, "concrete_c30",
        (
            _bookcase(2, use=0.5),
            CUPBOARD,
            _shelf(1),
            _bookcase(1, 2, use=0.5),
            _w("barrel", count=(0, 2), sizes=({}, {"height": 0.6, "diameter": 0.42})),
            _shelf(0, 2),
        ),
        {"": SUPPLIES},
        ("wooden_crate", "cardboard_box", "bucket", "basket"),
    ),
    "corridor": RoomKind(
        12.0, 1.6, 40.0, False, "limestone",
        (PICTURES, replace(MIRROR, count=(0, 1)), replace(CLOCK, count=(0, 1))),
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
            _shelf(1, 2, height=1.6),
        ),
        {"": ("bucket", "lantern", "hammer", "rope_coil", "axe", "saw", "wooden_crate"), "trough": (), "hopper": ()},
        ("wooden_crate", "bucket", "basket", "wooden_crate", "watering_can", "pumpkin"),
        height=3.4, walls="larch", gate=(2.6, 2.6), high=True,
    ),
    "museum": RoomKind(
        84.0, 6.5, 2.2, True, "marble",
        (
            _w("column", rule="pairs", count=(6, 6), under=0.02, parameters={"material": "limestone"}),
            _w("display_case", rule="line", count=(3, 3), use=0.8, parameters={"stand": "plinth"}),
            _w("display_case", count=(3, 5), use=0.8, parameters={"stand": "plinth"}),
            _w("bench", count=(2, 3), use=0.5, seat=True),
            _pictures(5, 8),
        ),
        {"display_case": ("vase", "jug", "bowl", "jar", "toy_duck", "candlestick", "wine_glass", "anvil"), "bench": ()},
        height=4.4, gate=(1.9, 2.5), high=True,
    ),
}  # fmt: skip
