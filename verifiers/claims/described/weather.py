"""Words of weather against what is simulated or lit (`claim:weather:<claim>`).

- Wind by the scale of Beaufort with the speeds of the World Meteorological Organization, Guide to Instruments and Methods of Observation
  (WMO-No. 8), Vol. I, chapter 5: a field that is at work during the film has a speed in the band of the word, or of the number that it gives.
- Rain and snow fall: half of the matter of an entity of drops or grains goes down at once, rain at 2 m/s at least, the speed of a drop of 0.5 mm:
  Gunn, R. and Kinzer, G. D. (1949), The terminal velocity of fall for water droplets in stagnant air, Journal of Meteorology 6; snow at 0.3 m/s:
  Locatelli, J. D. and Hobbs, P. V. (1974), Fall speeds and masses of solid precipitation particles, Journal of Geophysical Research 79. Snow may
  also lie on the land.
- Sun and cloud are the sky of `look`. Fog and lightning this build cannot draw.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from ....worlds.errors import EvidenceError
from ....worlds.prompts.languages import language_of
from ....worlds.prompts.numbers import number_in, quantity_in
from ....worlds.spec.fields import FieldDriver, TurbulenceField, VortexField, WindField
from ...categories.loose import Loose
from ...categories.registry import judge_of
from ...land.grounds import land_of
from .answers import Answer, finding_of
from .bounds import LYING, SWELLS

if TYPE_CHECKING:
    from ....worlds.candidate import Candidate
    from ....worlds.described import Word
    from ...rows.findings import Finding

__all__ = ["BEAUFORT", "WIND_WORDS", "judge"]

BEAUFORT = (0.3, 1.6, 3.4, 5.5, 8.0, 10.8, 13.9, 17.2, 20.8, 24.5, 28.5, 32.7)
"""Least speed of the forces 1 to 12 [m/s]."""
WIND_WORDS: dict[str, tuple[int, int]] = {
    "calm": (0, 0),
    "breeze": (2, 6),
    "wind": (1, 12),
    "gust": (1, 12),
    "gale": (7, 9),
    "storm": (9, 12),
    "hurricane": (12, 12),
}
"""Least and greatest force of a word; storms begin with the strong gale, which other languages call so."""
FALL = {"rain": 2.0, "snow": 0.3}
"""[m/s] Speeds of the least drop and flake."""
WET = frozenset(("water", "ice", "other"))
"""Substances of what falls as rain or snow."""
SKIES = {"sunny": "sunsky", "overcast": "overcast"}
NO_WAY = {
    "fog": "this build draws no fog: the air of its pictures is clear but for distance; waive the word with this reason",
    "thunder": "this build has no lightning or thunder; waive the word with this reason",
}


def judge(candidate: Candidate, name: str, words: list[Word]) -> Finding:
    """The finding on whether the weather of the words is there."""
    spec, quote = candidate.spec, candidate.spec.claims[name].quote
    answers = []
    for word in words:
        if word.term in WIND_WORDS:
            answers.append(_wind(candidate, quote, word))
        elif word.term in FALL:
            answers.append(_falling(candidate, word))
        elif word.term in SKIES:
            wanted = SKIES[word.term]
            answers.append(
                Answer(word.text, spec.look.sky == wanted, f"the sky is {spec.look.sky}, {word.text!r} asks for {wanted}")
            )
        else:
            answers.append(Answer(word.text, False, NO_WAY[word.term]))
    drawn = all(w.term in SKIES for w in words)
    action = "give the world that weather: a sky, a wind field of that speed, or drops that fall"
    pointers = ("/look/sky",) if drawn else ("/simulation/drivers",)
    return finding_of(quote, answers, group="look" if drawn else "drivers", action=action, pointers=pointers)


# ---------------------------------------------------------------- wind


def _wind(candidate: Candidate, quote: str, word: Word) -> Answer:
    speeds = {n: _speed(d) for n, d in _fields(candidate).items()}
    low, high = _band(candidate, quote, word)
    if word.term == "calm":
        strongest = max((s[1] for s in speeds.values()), default=0.0)
        return Answer(word.text, strongest < high, f"the strongest wind is {strongest:.3g} m/s", strongest, high, "<=", "m/s")
    if not speeds:
        return Answer(word.text, False, f"no field moves the air; {word.text!r} asks for {low:.3g} m/s", 0.0, low, ">=", "m/s")
    best = min(speeds, key=lambda n: max(low - speeds[n][1], speeds[n][0] - high, 0.0))
    least, most = speeds[best]
    ok = most >= low and least <= high
    text = f"field {best!r} blows with {most:.3g} m/s, {word.text!r} asks for {low:.3g} to {high:.3g}"
    if ok and word.term == "gust" and not _comes_and_goes(candidate, best):
        return Answer(
            word.text,
            False,
            f"field {best!r} blows evenly; a gust swells (gust >= {SWELLS:g}) or comes and goes (start, rise, end)",
        )
    return Answer(word.text, ok, text, most, low if most < low else high, "in", "m/s")


def _fields(candidate: Candidate) -> dict[str, FieldDriver]:
    """Fields of moving air that are at work during the film."""
    last = candidate.spec.simulation.frames / candidate.spec.simulation.fps
    found = {n: d for n, d in candidate.spec.simulation.drivers.items() if isinstance(d, FieldDriver)}
    return {n: d for n, d in found.items() if _speed(d)[1] > 0.0 and d.start < last and (d.end is None or d.end > 0.0)}


def _speed(driver: FieldDriver) -> tuple[float, float]:
    """Least and greatest speed of the air [m/s], gusts included."""
    field = driver.field
    if isinstance(field, WindField):
        speed = math.dist(field.velocity, (0.0, 0.0, 0.0))
        return speed * (1.0 - field.gust), speed * (1.0 + field.gust)
    if isinstance(field, TurbulenceField | VortexField):
        return abs(field.speed), abs(field.speed)
    return 0.0, 0.0


def _band(candidate: Candidate, quote: str, word: Word) -> tuple[float, float]:
    """Least and greatest speed that a word asks for [m/s]: by its quantity, its force, or itself."""
    language = language_of(candidate.spec.prompt)
    quantity, number = quantity_in(quote, language), number_in(quote, language)
    if quantity is not None and quantity.unit == "m/s":
        return quantity.low, quantity.high
    first, last = WIND_WORDS[word.term]
    if quantity is None and number is not None and 0 <= number <= 12 and number == int(number):
        first = last = int(number)
    low = 0.0 if first == 0 else BEAUFORT[first - 1]
    return low, math.inf if last >= 12 else BEAUFORT[last]


def _comes_and_goes(candidate: Candidate, name: str) -> bool:
    driver = candidate.spec.simulation.drivers[name]
    assert isinstance(driver, FieldDriver)
    swells = isinstance(driver.field, TurbulenceField) or (isinstance(driver.field, WindField) and driver.field.gust >= SWELLS)
    return swells or driver.start > 0.0 or driver.end is not None or driver.rise > 0.0


# ---------------------------------------------------------------- what falls


def _falling(candidate: Candidate, word: Word) -> Answer:
    """The answer to whether drops or flakes fall, or snow lies."""
    bound = FALL[word.term]
    if word.term == "snow" and _snowy(candidate):
        return Answer(word.text, True, f"snow lies on {LYING:.0%} of a landscape at least")
    speeds = {n: _fall(candidate, n) for n in _drops(candidate)}
    if not speeds:
        return Answer(
            word.text,
            False,
            f"nothing of water or ice falls; {word.text!r} asks for an emitter or inflow of drops",
            0.0,
            bound,
            ">=",
            "m/s",
        )
    best = max(speeds, key=speeds.__getitem__)
    text = f"half of {best!r} falls with {speeds[best]:.3g} m/s at its best frame"
    return Answer(word.text, speeds[best] >= bound, text, speeds[best], bound, ">=", "m/s")


def _drops(candidate: Candidate) -> list[str]:
    """Entities of drops or grains, of water or ice."""
    materials = candidate.spec.materials
    found = [n for n, e in candidate.spec.entities.items() if e.physics.shape == "loose" and e.material in materials]
    return [n for n in found if materials[candidate.spec.entities[n].material].substance in WET]


def _fall(candidate: Candidate, entity: str) -> float:
    """Greatest over the frames of the median speed downward [m/s].

    Raises:
        EvidenceError: no cache holds it.
    """
    judge_ = judge_of(candidate.spec, entity)
    if not isinstance(judge_, Loose):
        raise EvidenceError(f"{entity!r} is of a category whose drops are not recorded")
    solver, _, row = judge_.held(candidate, entity)
    downward = [-s.velocity[:, 2] for s in judge_.samples(candidate, solver, row) if len(s.velocity)]
    return max((float(np.median(v)) for v in downward), default=0.0)


def _snowy(candidate: Candidate) -> bool:
    for name in candidate.spec.terrains:
        saved = land_of(candidate, name).saved
        if "snow" in saved.names and float(np.nanmean(saved.field("snow"))) >= LYING:
            return True
    return False
