"""Colour words against rendered pixels (`claim:property:colour:<claim>`), in the final light.

A pixel has the basic colour term whose places of the survey (`worlds/prompts/data/colours.json`) are nearest to it in CIELAB: the rule of
the nearest focal colour, as Regier, T., Kay, P. and Khetarpal, N. (2007), Color naming reflects optimal partitions of color space, PNAS 104,
doi:10.1073/pnas.0610341104, and of Rosch Heider's prototypes before it. Light is taken out twice, as an eye does:

- its *colour*, by von Kries: each channel is divided by what the plate shows for reflectance 1. That is measured on the bodies around, whose
  reflectance the specification says: plain, opaque, not metallic. Where there are none, the light counts as white.
- its *strength*: a face that turns towards the light is brighter, one in the shade darker. A hue may be read up to three stops brighter and one
  darker than the light of the bodies around has it; black, white and grey in the brighter half of the pixels alone, nearly as they are.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from functools import cache, partial
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ....worlds.arrays import F64
from ....worlds.claim_targets import targets_of
from ....worlds.described import coloured_bodies, judged_words
from ....worlds.errors import EvidenceError
from ....worlds.plates import MOST_PLATES, plates_folder
from ....worlds.prompts.descriptions import anchors
from ...rows.answers import row_of
from ...rows.corrections import correction, pointer
from ...rows.findings import Finding
from ...shots.bounds import SEEN_PIXELS
from ...shots.difference import lab_of, linear
from ...shots.seen import AGAIN, plates_now
from ...shots.sight import sight_of
from ...shots.wanted import wanted
from .bounds import AMONG, COLOURED
from .questions import COLOUR

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ....worlds.candidate import Candidate
    from ....worlds.plates import View
    from ....worlds.requirements import Row
    from ....worlds.spec import WorldSpec
    from ...shots.wanted import Wanted

__all__ = ["check", "colour_ids", "named", "reflected"]

HUES = np.exp2([-1.0, 0.0, 1.0, 2.0, 3.0])
"""Strengths of the light at which a hue may be read. Own choice: a face that looks at the sun gets up to twice what level ground gets, and
one in the shade of a clear day an eighth."""
NEUTRALS = {"black": np.exp2([-2.0, -1.0, 0.0]), "white": np.exp2([0.0, 1.0]), "grey": np.exp2([-0.5, 0.0, 0.5])}
"""The same for what has no hue, of the brighter half of the pixels; own choice."""
REFERENCES = 40
"""Own choice: bodies at most on which the light is measured."""
REFERENCE_PIXELS = 100
"""Own choice: pixels from which on the light is known."""
DULL = 0.05
"""[1] Own choice: least reflectance, and least value of a pixel, that tells the light of a channel."""
CLIPPED = 0.95
"""[1] Own choice: a pixel above tells nothing: the picture ends there."""
CLEAR, SHINY = 0.5, 0.5
"""Own choice: what lets through or mirrors so much shows other colours than its own."""


class _Light(NamedTuple):
    """Light of a plate, as it shows reflectance 1."""

    level: F64
    """Linear, shape (3,)."""
    told: str


def colour_ids(spec: WorldSpec) -> frozenset[str]:
    """Ids of the rows of colour, which plates answer."""
    return frozenset(COLOUR.row_id((c,)) for c in coloured_bodies(spec))


def check(candidate: Candidate) -> list[Row]:
    """One row per claim with a word of colour."""
    rows = []
    for name, bodies in coloured_bodies(candidate.spec).items():
        question, plan = COLOUR, None
        try:
            plan = wanted(candidate)
            question = replace(COLOUR, mandatory=not set(bodies) & set(plan.beyond))
        except EvidenceError:  # the row says so
            pass
        extra = candidate.spec.claims[name].model_dump(mode="json")
        rows.append(row_of(candidate, question, (name,), partial(_claim, candidate, name, bodies, plan), extra=extra))
    return rows


def _claim(candidate: Candidate, name: str, bodies: list[str], plan: Wanted | None) -> Finding:
    plates = plates_now(candidate)
    words = [w for w in judged_words(candidate.spec, name) if w.kind == "colour"]
    asked = list(dict.fromkeys(w.term for w in words))
    told = Finding(
        "unverified", "", entities=tuple(bodies), extra=[plates.digest, candidate.spec.claims[name].model_dump(mode="json")]
    )
    plan, found = plan or wanted(candidate), list[tuple[float, float, Finding]]()
    for body in bodies:
        view = plan.shown.get(body)
        if view is None or view not in plates.views:
            why = "no picture shows it" if view is None else plates.left.get(body, "no plate shows it there")
            why = f"a world has {MOST_PLATES} plates at most, of others first" if body in plan.beyond else why
            return replace(told, text=f"{body!r} was not looked at: {why}; show it in a shot, then {AGAIN}")
        share, bound, finding = _body(candidate, name, asked, view, told)
        if finding.status == "unverified":
            return finding
        found.append((share, bound, finding))
    return min(found, key=lambda f: f[0] - f[1])[2]


def _body(candidate: Candidate, name: str, asked: list[str], view: View, told: Finding) -> tuple[float, float, Finding]:
    """Share of a body's pixels that have a colour, its bound, and the finding."""
    plates, sight = plates_now(candidate), sight_of(candidate)
    mask = sight.mask(view.subject, view.shot, view.frame, plates.size).visible
    if int(mask.sum()) < SEEN_PIXELS:
        text = f"{view.subject!r} shows {int(mask.sum())} pixels in its best plate, too few to name a colour: bring the camera nearer"
        return 0.0, 0.0, replace(told, text=text, frame=view.frame)
    shown = linear(plates.read(plates_folder(candidate), view).shown).mean(axis=0)
    light = _light(candidate, view, shown)
    pixels = reflected(shown[mask], light.level)
    shares = {term: named(pixels, (term,)) for term in asked}
    share = named(pixels, asked)
    missing = [t for t in asked if len(asked) > 1 and shares[t] < AMONG]
    bound = COLOURED * _part_share(candidate, name, view.subject)
    middle = np.median(shown[mask], axis=0)
    quote, seen = candidate.spec.claims[name].quote, _most(pixels)
    text = f"{share:.0%} of the pixels of {view.subject!r} in shot {view.shot!r} at frame {view.frame} are {' or '.join(asked)}; most are {seen}, {light.told}"
    evidence = {
        "quote": quote,
        "shares": shares,
        "light": light.level.tolist(),
        "median_linear": middle.tolist(),
        "most": seen,
        "shot": view.shot,
    }
    ok = share >= bound and not missing
    place = pointer("materials", candidate.spec.entities[view.subject].material, "appearance", "color")
    hint = correction(
        f"{quote!r} shows as {seen}",
        "look",
        f"give its material the colour that the prompt names, or light it so that it shows: {quote!r}",
        pointers=(place, "/look/lights"),
    )
    text = text if not missing else f"{text}; {missing[0]} has {shares[missing[0]]:.0%}"
    value, least = (shares[missing[0]], AMONG) if missing else (share, bound)
    done = replace(
        told, status="pass" if ok else "fail", text=text, measured=value, bound=least, frame=view.frame, evidence=evidence
    )
    return value, least, replace(done, entity=None if ok else view.subject, hints=() if ok else (hint,))


def _part_share(candidate: Candidate, name: str, body: str) -> float:
    """Share of a body's surface in the parts that a claim names; 1 where it names the whole."""
    start = f"/entities/{body}/parts/"
    pointers = [p for p in targets_of(candidate.spec.claims, name) if p.startswith(f"/entities/{body}")]
    parts = {p.removeprefix(start).split("/")[0] for p in pointers if p.startswith(start)}
    if not parts or f"/entities/{body}" in pointers:
        return 1.0
    area = {p.part: _area(p.render.vertices, p.render.faces) for p in candidate.entity(body).parts}
    return sum(a for n, a in area.items() if n in parts) / max(sum(area.values()), 1e-12)


def _area(vertices: F64, faces: NDArray[np.integer]) -> float:
    corner = vertices[faces]
    return 0.5 * float(np.linalg.norm(np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]), axis=1).sum())


# ---------------------------------------------------------------- light


def _light(candidate: Candidate, view: View, shown: F64) -> _Light:
    """Light of a plate: the median over the pixels of the bodies around, of each channel."""
    sight, size = sight_of(candidate), (shown.shape[1], shown.shape[0])
    ratios = []
    for body in _references(candidate, view.subject):
        color = np.array(_color(candidate, body))
        pixels = shown[sight.mask(body, view.shot, view.frame, size).visible]
        pixels = pixels[(pixels.max(axis=1) < CLIPPED) & (pixels.max(axis=1) > DULL)]
        ratios.append(pixels / color)
    known = np.concatenate(ratios) if ratios else np.empty((0, 3))
    if len(known) < REFERENCE_PIXELS:
        return _Light(np.ones(3), "no plain body around tells the light, so that it counts as white")
    level = np.maximum(np.median(known, axis=0), 1e-3)
    hue = level / level.max()
    return _Light(level, f"in light of colour ({', '.join(f'{c:.2f}' for c in hue)}), measured on the bodies around")


def _references(candidate: Candidate, subject: str) -> list[str]:
    """Bodies that tell the light: of one material that is plain, opaque, not metallic, and dark in no channel."""
    found = [n for n in candidate.solids if n != subject and _color(candidate, n) is not None]
    return found[:REFERENCES]


def _color(candidate: Candidate, body: str) -> tuple[float, float, float] | None:
    """Reflectance of a body of one plain material, linear; None of others."""
    entity, materials = candidate.spec.entities[body], candidate.spec.materials
    made = {entity.material if p.material is None else p.material for p in entity.parts.values()} or {entity.material}
    look = materials[next(iter(made))].appearance if len(made) == 1 and made <= set(materials) else None
    if look is None or look.pattern != "plain" or look.metallic >= SHINY or look.transmission >= CLEAR or min(look.color) < DULL:
        return None
    return look.color


def reflected(pixels: F64, level: F64) -> F64:
    """Reflectance of pixels, linear, shape (n, 3), that a light of a level shows, shape (3,)."""
    return pixels / level


# ---------------------------------------------------------------- names


@cache
def _places() -> tuple[tuple[str, ...], F64]:
    """Basic term of each place of the survey, and the place in CIELAB, shape (n, 3). Every neutral between its dark and light grey is grey."""
    found = [(term, _rgb(value)) for term, names in anchors().items() for value in names.values()]
    terms, places = [t for t, _ in found], lab_of(linear(np.array([rgb for _, rgb in found], dtype=np.uint8)))
    light = sorted(float(p[0]) for t, p in zip(terms, places, strict=True) if t == "grey")
    between = np.arange(light[0], light[-1], 5.0)
    greys = np.stack([between, 0.0 * between, 0.0 * between], axis=1)
    return (*terms, *("grey" for _ in between)), np.concatenate([places, greys])


def _rgb(text: str) -> tuple[int, int, int]:
    return int(text[1:3], 16), int(text[3:5], 16), int(text[5:7], 16)


def _terms(reflectance: F64) -> NDArray[np.str_]:
    """Nearest basic term of each reflectance, linear, shape (..., 3)."""
    terms, places = _places()
    color = lab_of(np.clip(reflectance, 0.0, 1.0))
    nearest = ((color[..., None, :] - places) ** 2).sum(axis=-1).argmin(axis=-1)
    found: NDArray[np.str_] = np.array(terms)[nearest]
    return found


def named(pixels: F64, asked: Iterable[str]) -> float:
    """Share of pixels, as reflectances, shape (n, 3), that can be called by one of some terms."""
    bright = pixels[pixels.sum(axis=1) >= np.median(pixels.sum(axis=1))]
    hues = [t for t in asked if t not in NEUTRALS]
    best = 0.0
    any_hue = np.zeros(len(pixels), dtype=bool)
    for gain in HUES if hues else ():
        # No surface throws back more than it gets: what would clip is no reading.
        any_hue |= np.isin(_terms(pixels * gain), hues) & ((gain <= 1.0) | (pixels.max(axis=1) * gain <= 1.0))
    best = float(any_hue.mean())
    for term in [t for t in asked if t in NEUTRALS]:
        best = max(best, *(float((_terms(bright * gain) == term).mean()) for gain in NEUTRALS[term]))
    both = [t for t in asked if t in NEUTRALS]
    if len(both) > 1:
        best = max(best, float(np.isin(_terms(pixels), both).mean()))
    return best


def _most(pixels: F64) -> str:
    """The commonest term of pixels at the light as it is."""
    terms, counts = np.unique(_terms(pixels), return_counts=True)
    return str(terms[int(counts.argmax())])
