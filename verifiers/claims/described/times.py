"""Words of the time of day against the height of the sun in `look` (`claim:time:<claim>`). Durations are quantities.

The sun of a film stands at 2 to 90 degrees, and is seen in the sky `sunsky` alone; the sky `night` has the moon's light, and no other time of day.

- *dawn*, *dusk*: up to 6 degrees above the horizon, as far as civil twilight reaches below it (U.S. Naval Observatory, Astronomical Almanac).
- *noon*: from 30 degrees. Own choice: the sun of noon is lower in the winter of the middle latitudes; there say so by an elevation as a quantity.
- *evening*: up to 20 degrees; own choice: the last two hours before sunset outside the tropics.
- *morning*, *afternoon*, *day*: the sun is up.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from .answers import Answer, finding_of
from .bounds import ALONG

if TYPE_CHECKING:
    from ....worlds.candidate import Candidate
    from ....worlds.described import Word
    from ...rows.findings import Finding

__all__ = ["BANDS", "judge"]

BANDS: dict[str, tuple[float, float]] = {
    "dawn": (-6.0, 6.0),
    "dusk": (-6.0, 6.0),
    "noon": (30.0, 90.0),
    "morning": (0.0, 60.0),
    "afternoon": (0.0, 60.0),
    "evening": (-6.0, 20.0),
    "day": (0.0, 90.0),
    "night": (-90.0, -6.0),
}
"""Least and greatest elevation of the sun [deg] by word."""
COMPASS = {"dawn": 1, "morning": 1, "dusk": -1, "evening": -1}
"""Side of the sky, east 1 or west -1, where the world has a landscape and so a compass: x is east there."""


def judge(candidate: Candidate, name: str, words: list[Word]) -> Finding:
    """The finding on whether the sun stands where the words have it."""
    spec, look = candidate.spec, candidate.spec.look
    answers = []
    for word in words:
        low, high = BANDS[word.term]
        height = look.sun_elevation_deg
        east = math.cos(math.radians(look.sun_azimuth_deg)) * COMPASS.get(word.term, 0)
        bound = low if height < low else high
        if word.term == "night":
            ok = look.sky == "night"
            text = f"the sky is {look.sky}" + ("" if ok else f", which is no night as {word.text!r} has it: take sky night")
        elif look.sky != "sunsky":
            ok, text = False, f"the sky is {look.sky}, which shows no sun: take sky sunsky, or waive the word"
        elif spec.terrains and east < -ALONG:
            side = "east" if COMPASS[word.term] > 0 else "west"
            ok, text = (
                False,
                f"the sun stands at an azimuth of {look.sun_azimuth_deg:g} deg from east, {word.text!r} has it in the {side}",
            )
        else:
            ok = low <= height <= high
            text = f"the sun stands at {height:g} deg, {word.text!r} asks for {low:g} to {high:g}"
        answers.append(Answer(word.text, ok, text, height, bound, "in", "deg"))
    action = "set the sun where the words have it; only rows of what is seen are then stale"
    return finding_of(
        spec.claims[name].quote, answers, group="look", action=action, pointers=("/look/sun_elevation_deg", "/look/sky")
    )
