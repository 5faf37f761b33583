"""Write `worlds/prompts/data/colours.json`: places of the eleven basic colour terms, from the colour survey of xkcd.

`uv run python packaging/colour_anchors.py`, with matplotlib, which carries the survey's table (its answers are CC0). A name of the survey is a
place of a term where it is that term alone, or that term behind a word of lightness or strength.
"""

from __future__ import annotations

import json
from importlib.metadata import version
from pathlib import Path

MODIFIERS = (
    "dark", "darkish", "deep", "almost", "medium", "off", "lightish", "light", "pale", "bright", "vivid", "vibrant",
    "neon", "strong", "rich", "dull", "faded", "muted", "dusty", "pastel", "soft",
)  # fmt: skip
"""Words that say how light or strong a colour is, and no other colour; what is very dark or very light is as much black or white."""
TERMS = {"violet": "purple", "gray": "grey"} | {
    name: name for name in ("black", "white", "grey", "red", "orange", "yellow", "green", "blue", "purple", "pink", "brown")
}
"""The basic term of each name: Berlin, B., and Kay, P. (1969), Basic Color Terms."""
LEFT_OUT = frozenset(("off blue", "off green", "off yellow", "pale grey"))
"""Names in which `off` makes another colour, and a grey of #fdfdfe."""


def anchors() -> dict[str, dict[str, str]]:
    """Places of each term: names of the survey with their sRGB values."""
    from matplotlib._color_data import XKCD_COLORS

    found: dict[str, dict[str, str]] = {}
    for key, value in XKCD_COLORS.items():
        name = key.removeprefix("xkcd:")
        modifier, _, last = name.rpartition(" ")
        if last in TERMS and name not in LEFT_OUT and (not modifier or modifier in MODIFIERS):
            found.setdefault(TERMS[last], {})[name] = value
    return {term: dict(sorted(found[term].items())) for term in sorted(found)}


if __name__ == "__main__":
    data = {
        "source": {
            "survey": "Munroe, R. (2010), Color Survey Results, xkcd.com/color/rgb, CC0 1.0: the sRGB value that most of 222500 people gave each name",
            "terms": "Berlin, B., and Kay, P. (1969), Basic Color Terms: Their Universality and Evolution",
            "table": f"matplotlib {version('matplotlib')}",
        },
        "anchors": anchors(),
    }
    path = Path(__file__).parents[1] / "worlds/prompts/data/colours.json"
    path.write_text(json.dumps(data, indent=1) + "\n", encoding="utf-8")
