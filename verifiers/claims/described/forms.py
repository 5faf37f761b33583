"""Words of size, shape, weight and slope against what is built (`claim:property:<claim>`), at frame 0.

Shape by the three extents of a body, long, middle and short:

- *long*, *thin*, *flat*, *tall*: the limits of Zingg, Th. (1935), Beitrag zur Schotteranalyse: middle / long or short / middle below 2/3.
- *round*, *square*: its outline along one of its axes, by the circularity 4 pi A / P^2 of Cox, E. P. (1927), A method of assigning numerical and
  percentage values to the degree of roundness of sand grains, Journal of Paleontology 1(3), and by the share of its rectangle that it fills;
  *spherical*, *cubic*: along all three.

Size and weight by the bodies of the same noun (`worlds/described.py`), from which they must differ by a just noticeable difference: 2.9 % of a
length and 2 % of a weight: Teghtsoonian, R. (1971), On the exponents in Stevens' law and the constant in Ekman's law, Psychological Review 78(1).

Slope by the classes of the Soil Survey Manual (USDA Handbook 18, 2017, table 3-1): steep from 20 % on, nearly level up to 3 %.
"""

from __future__ import annotations

import math
from functools import partial
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ....worlds.claim_targets import named_in, targets_of
from ....worlds.described import alike
from ....worlds.errors import EvidenceError
from ...ledgers.motion import entity_mass
from ...rows.findings import Finding
from .answers import Answer, finding_of
from .bounds import CIRCLE, FELT, LEVEL, NOTICED, SQUARE, STEEP, ZINGG
from .lands import slopes

if TYPE_CHECKING:
    from collections.abc import Callable

    from ....worlds.arrays import F64
    from ....worlds.candidate import Candidate
    from ....worlds.described import Word

__all__ = ["Form", "form_of", "judge"]

TURNED = 1e-3
"""[1] Own choice: least upward part of a face's normal that counts for its slope."""


class Form(NamedTuple):
    """A body as it stands at frame 0."""

    extents: tuple[float, float, float]
    """Long, middle and short extent [m], in the frame of the least box."""
    round: tuple[float, float, float]
    """Circularity of its outlines, the greatest first."""
    square: tuple[float, float, float]
    """Squareness of its outlines, the greatest first: the less of ratio of sides and filled share."""
    height: float
    """[m]"""
    width: float
    """The lesser of its level extents [m]."""
    slope: float
    """Median over the area of its upward faces, tangent."""

    @property
    def size(self) -> float:
        """Diagonal [m]."""
        return math.sqrt(sum(e * e for e in self.extents))


def judge(candidate: Candidate, name: str, words: list[Word]) -> Finding:
    """The finding on whether bodies or land have the form that the words of a claim say."""
    spec, quote = candidate.spec, candidate.spec.claims[name].quote
    bodies = [n for n in named_in(spec, name, "entities") if n in spec.entities]
    answers = []
    for word in words:
        if not bodies:
            answers.append(_of_land(candidate, name, word))
        elif word.term == "alike":
            answers.append(_all_alike(candidate, name, word, bodies))
        else:
            others = alike(spec, name, word.term)
            answers.append(min((_of_body(candidate, word, b, others) for b in bodies), key=lambda a: bool(a.ok)))
    places = [f"/entities/{b}/parts" for b in bodies] or targets_of(spec.claims, name)
    action = "build it as the words say, or claim the words of the body that they are about"
    return finding_of(quote, answers, group="shape" if bodies else "terrain", action=action, pointers=places, entities=bodies)


def form_of(candidate: Candidate, body: str) -> Form:
    """The form of a body at frame 0.

    Raises:
        EvidenceError: it is not built, or its shape is unknown.
    """
    return candidate.memo(("form", body), partial(_form_of, candidate, body))


def _form_of(candidate: Candidate, body: str) -> Form:
    points = candidate.vertices(body, 0)
    if len(points) < 4 or not np.isfinite(points).all():
        raise EvidenceError(f"entity {body!r} has no finite shape at frame 0")
    turned = candidate.pose(body, 0, candidate.entity(body).bodies[0].name).inverse().apply(points)
    about = points - points.mean(axis=0)
    principal = about @ np.linalg.eigh(about.T @ about)[1]
    local = min((turned, principal), key=lambda p: float(np.prod(np.ptp(p, axis=0))))
    outlines = [_outline(np.delete(local, axis, axis=1)) for axis in range(3)]
    level = about[:, :2] @ np.linalg.eigh(about[:, :2].T @ about[:, :2])[1]
    extents = sorted(map(float, np.ptp(local, axis=0)), reverse=True)
    return Form(
        (extents[0], extents[1], max(extents[2], 1e-9)),
        _ranked(o[0] for o in outlines),
        _ranked(o[1] for o in outlines),
        float(np.ptp(points[:, 2])),
        max(float(np.ptp(level, axis=0).min()), 1e-9),
        _slope(candidate, body),
    )


def _ranked(values: object) -> tuple[float, float, float]:
    first, second, third = sorted(map(float, values), reverse=True)  # type: ignore[call-overload]
    return first, second, third


def _outline(points: F64) -> tuple[float, float]:
    """Circularity and squareness of the outline of points, shape (n, 2)."""
    from scipy.spatial import ConvexHull, QhullError

    wide, tall = np.ptp(points, axis=0)
    if min(wide, tall) <= 1e-9:
        return 0.0, 0.0
    try:
        hull = ConvexHull(points)
    except QhullError:
        return 0.0, 0.0
    area, around = float(hull.volume), float(hull.area)  # of a plane figure: its area and its perimeter
    return 4.0 * math.pi * area / around**2, min(min(wide, tall) / max(wide, tall), area / (wide * tall))


def _slope(candidate: Candidate, body: str) -> float:
    """Median slope over the area of the faces that look up, as seen from above."""
    slopes_, areas = [np.zeros(0)], [np.zeros(0)]
    for part in candidate.entity(body).parts:
        corner = candidate.surface(body, part.part, 0)[part.render.faces]
        normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
        size = np.linalg.norm(normal, axis=1)
        up = normal[:, 2] > TURNED * size
        areas.append(normal[up, 2])
        slopes_.append(np.linalg.norm(normal[up, :2], axis=1) / normal[up, 2])
    slope, area = np.concatenate(slopes_), np.concatenate(areas)
    if not len(slope):
        return 0.0
    order = np.argsort(slope)
    return float(slope[order][np.searchsorted(np.cumsum(area[order]), 0.5 * area.sum())])


# ---------------------------------------------------------------- words


_SHAPES: dict[str, tuple[Callable[[Form], float], float, bool, str]] = {
    "round": (lambda f: f.round[0], CIRCLE, True, "its roundest outline has a circularity of"),
    "spherical": (lambda f: min(f.round[2], f.extents[2] / f.extents[0]), SQUARE, True, "the least of its circularities and ratios of extents is"),
    "square": (lambda f: f.square[0], SQUARE, True, "its most square outline is square by"),
    "cubic": (lambda f: f.square[2], SQUARE, True, "its least square outline is square by"),
    "flat": (lambda f: f.extents[2] / f.extents[1], ZINGG, False, "short / middle extent is"),
    "long": (lambda f: f.extents[1] / f.extents[0], ZINGG, False, "middle / long extent is"),
    "thin": (lambda f: min(f.extents[2] / f.extents[1], f.extents[1] / f.extents[0]), ZINGG, False, "the least ratio of its extents is"),
    "tall": (lambda f: f.width / max(f.height, 1e-9), ZINGG, False, "width / height is"),
    "steep": (lambda f: f.slope, STEEP, True, "its upper faces have a slope of"),
    "level": (lambda f: f.slope, LEVEL, False, "its upper faces have a slope of"),
}  # fmt: skip
"""By word: what is measured, its bound, whether it must be more, and what it is called."""
_SIZES: dict[str, tuple[Callable[[Form], float], bool, str]] = {
    "small": (lambda f: f.size, False, "diagonal"),
    "big": (lambda f: f.size, True, "diagonal"),
    "short": (lambda f: f.extents[0], False, "longest extent"),
    "long": (lambda f: f.extents[0], True, "longest extent"),
    "thick": (lambda f: f.extents[2], True, "shortest extent"),
    "thin": (lambda f: f.extents[2], False, "shortest extent"),
    "tall": (lambda f: f.height, True, "height"),
}
"""By word: what is compared with others, whether it must be more, and what it is called."""


def _of_body(candidate: Candidate, word: Word, body: str, others: list[str]) -> Answer:
    """One word of one body: by its own shape, or by comparison with others of its kind."""
    own = _shaped(candidate, word, body) if word.term in _SHAPES else None
    if own is not None and (own.ok or word.term not in _SIZES or not others):
        return own
    compared = _compared(candidate, word, body, others)
    return compared if own is None or compared.ok else own


def _shaped(candidate: Candidate, word: Word, body: str) -> Answer:
    measure, bound, more, called = _SHAPES[word.term]
    value = measure(form_of(candidate, body))
    ok = value >= bound if more else value <= bound
    text = f"of {body!r} {called} {value:.3g}, {word.text!r} asks for {'>=' if more else '<='} {bound:.3g}"
    return Answer(word.text, ok, text, value, bound, ">=" if more else "<=")


def _compared(candidate: Candidate, word: Word, body: str, others: list[str]) -> Answer:
    if word.term in ("heavy", "light"):
        more, called, unit, least = word.term == "heavy", "mass", "kg", FELT
        values = {n: entity_mass(candidate, n) for n in (body, *others)}
    else:
        measure, more, called = _SIZES[word.term]
        unit, least = "m", NOTICED
        values = {n: measure(form_of(candidate, n)) for n in (body, *others)}
    nearest = (max if more else min)(others, key=values.__getitem__)
    bound = values[nearest] * (1.0 + least if more else 1.0 / (1.0 + least))
    ok = values[body] >= bound if more else values[body] <= bound
    text = f"{called} of {body!r} is {values[body]:.4g} {unit}, of {nearest!r}, another of its kind, {values[nearest]:.4g} {unit}"
    return Answer(word.text, ok, text, values[body], bound, ">=" if more else "<=", unit)


def _all_alike(candidate: Candidate, name: str, word: Word, bodies: list[str]) -> Answer:
    """Bodies of the same size: all extents within a just noticeable difference."""
    known = [*bodies, *alike(candidate.spec, name, word.term)]
    extents = np.array([form_of(candidate, n).extents for n in known])
    apart = float((extents.max(axis=0) / extents.min(axis=0)).max()) - 1.0
    text = f"extents of {len(known)} bodies differ by {apart:.2%} at most"
    return Answer(word.text, apart <= NOTICED, text, apart, NOTICED, "<=")


def _of_land(candidate: Candidate, name: str, word: Word) -> Answer:
    """Slope of the land that a claim names: nine tenths of it are less steep than what is steep, half of it is level."""
    found = np.concatenate([slopes(candidate, p) for p in targets_of(candidate.spec.claims, name) if p.startswith("/terrains/")])
    if not len(found):
        raise EvidenceError("no land lies where the claim points")
    steep = word.term == "steep"
    value, bound = float(np.quantile(found, 0.9 if steep else 0.5)), STEEP if steep else LEVEL
    text = f"{'a tenth' if steep else 'half'} of the land is {'steeper' if steep else 'less steep'} than {value:.3g}"
    return Answer(word.text, value >= bound if steep else value <= bound, text, value, bound, ">=" if steep else "<=")
