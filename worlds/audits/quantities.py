"""Claims of a quantity against the numbers that they name: of something that the prompt names, of the right dimension, and bound on the right side (R131, R155).

"A 2 m beam" is no distance of the camera and no size of a body that no words speak of. `at most` asks for an upper bound, which no `min` is;
`at least` for a lower one. What is measured is compared in `verifiers/claims/quantities.py`.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Literal

import regex

from ..bound_fields import spoken_of
from ..claim_targets import named_in
from ..errors import InputError
from ..predicates import Not
from ..predicates.registry import PREDICATES
from ..problems import Problem
from ..prompts.descriptions import meanings
from ..prompts.languages import REVIEWED, language_of
from ..prompts.marks import occurrence
from ..prompts.numbers import Quantity
from ..prompts.units import folded, units_of
from ..quantities import quantity_said
from ..references import references
from ..spec import Claim, SpecModel, WorldSpec
from .leaves import DIMENSIONS, dimension_at, leaf_at
from .quantity_targets import ACROSS, INSTEAD, SIZES, is_setting, target_problems

__all__ = ["in_unit", "quantity_problems", "side_of"]

_BRACKETS = regex.compile(r"\[([^\[\]]+)\]")
_SPEAK = ("thing", "count", "property", "place", "weather")
_WATCHED = {
    "en": "camera lens fov fps frames view eye zoom shot filmed seen sun light lamp look looking",
    "de": "kamera objektiv blick bild bilder einstellung sonne licht lampe brennweite",
    "fr": "caméra objectif vue image images plan soleil lumière lampe",
    "es": "cámara lente objetivo vista imagen toma sol luz lámpara",
    "it": "telecamera camera obiettivo vista inquadratura ripresa sole luce lampada",
    "pt": "câmera câmara lente objetiva vista imagem tomada sol luz lâmpada",
    "nl": "camera lens beeld zicht opname zon licht lamp",
    "ru": "камера камеры камеру объектив кадр кадра вид солнце свет лампа",
    "zh": "相机 镜头 摄像机 视角 帧 太阳 阳光 光",
    "ja": "カメラ レンズ 視点 フレーム 太陽 光",
}
"""Words of the camera and of light, by language: only beside one of them is a number of `/shots` or `/look` meant. Reviewed by hand."""


_HEIGHT = {
    "en": "high tall height", "de": "hoch hohe hoher hohes hohen höhe", "fr": "haut haute hauts hautes hauteur", "es": "alto alta altos altas altura",
    "it": "alto alta alti alte altezza", "pt": "alto alta altos altas altura", "nl": "hoog hoge hoogte", "ru": "высотой высота высоты", "zh": "高", "ja": "高さ 高い",
}  # fmt: skip
"""Words of height by language. Reviewed by hand."""


_SIZES = SIZES | {"of"}
"""Words behind a length that make it one of a body, or of what follows."""
_ACROSS = frozenset([ACROSS, "in"])
"""Words that do so where no article follows: `8 cm across` is a size, `8 cm across a floor` a way."""
_ARTICLES = frozenset(["a", "an", "the", "its", "their", "his", "her", "this", "that", "one", "two", "some", "every", "each"])


def quantity_problems(spec: WorldSpec, document: Any, name: str, claim: Claim) -> Iterator[Problem]:
    """Problems of one claim of a quantity."""
    place, wanted = f"/claims/{name}/by", quantity_said(spec, name)
    leaves = {p: leaf_at(document, p) for p in claim.by}
    none = [p for p, value in leaves.items() if value is None]
    if none:
        yield Problem(place, f"a quantity is judged by numbers, and {none[0]!r} is none; give the pointer of a single number")
        return
    for pointer, value in leaves.items():
        stranger = _of_nothing_claimed(spec, pointer)
        if stranger is not None:
            yield Problem(place, f"{claim.quote!r} is judged by {pointer}, {stranger}")
            continue
        misplaced = list(target_problems(spec, name, pointer))
        yield from misplaced
        if wanted is None or misplaced:
            continue
        other = _other_dimension(spec, document, pointer, wanted)
        if other is not None:
            text = f"{claim.quote!r} is a {wanted.dimension} [{wanted.unit}], and {pointer} is a {other}; name a number that is a {wanted.dimension}"
            yield Problem(place, text)
            continue
        have = in_unit(spec, pointer, value or 0.0, wanted)
        if not wanted.low <= have <= wanted.high:
            said = f"at {wanted.how[3:]} " if wanted.how.startswith("at ") else ""
            text = f"{claim.quote!r} says {said}{wanted.value:g} {wanted.unit} ({wanted.low:g} to {wanted.high:g}), {pointer} is {have:g}"
            yield Problem(place, text)
            continue
        yield from _one_sided(spec, name, pointer, wanted)
        yield from _height(spec, name, pointer)
        yield from _way(spec, name, pointer, wanted)


def in_unit(spec: WorldSpec, pointer: str, value: float, wanted: Quantity) -> float:
    """A number of the specification in the unit of the quantity: frames as seconds, degrees as radians."""
    if wanted.dimension == "time" and (pointer.endswith(("/frames", "/frames/0", "/frames/1"))):
        return value / spec.simulation.fps
    if wanted.dimension == "angle" and pointer.endswith("_deg"):
        return math.radians(value)
    return abs(value) if wanted.value >= 0 else value


def _other_dimension(spec: WorldSpec, document: Any, pointer: str, wanted: Quantity) -> str | None:
    """Dimension of the number at a pointer, where it is not the wanted one."""
    have = dimension_at(document, pointer) or _declared(spec, pointer)
    return None if have is None or have == wanted.dimension else have


def _declared(spec: WorldSpec, pointer: str) -> str | None:
    """Dimension, else unit, by the one unit in brackets of the description of a field, as `drag on the body [N s/m]`; None where it has none."""
    keys = pointer.strip("/").split("/")
    while keys[-1].isdigit():
        keys.pop()
    at: Any = spec
    for key in keys[:-1]:
        at = at.get(key) if isinstance(at, Mapping) else at[int(key)] if isinstance(at, (list, tuple)) else getattr(at, key, None)
    field = type(at).model_fields.get(keys[-1]) if isinstance(at, SpecModel) else None
    units = {u.replace("^", "") for u in _BRACKETS.findall(field.description or "")} if field is not None else set()
    return DIMENSIONS.get(*units, *units) if len(units) == 1 else None


def _height(spec: WorldSpec, name: str, pointer: str) -> Iterator[Problem]:
    """A height that is judged by a level extent of a body that stands upright as it is described."""
    keys = pointer.strip("/").split("/")
    if keys[0] != "entities" or keys[1] not in spec.entities or keys[-2:-1] != ["size"] or keys[-1] == "2":
        return
    pose, words = spec.entities[keys[1]].pose, _HEIGHT.get(language_of(spec.prompt) or "", "").split()
    quote = spec.claims[name].quote
    # `a block [6 cm](quantity) tall` and `[6 cm tall](quantity)` say the same.
    said = [folded(u.text) for u in units_of(quote)] + _beside(spec, name)[1][:1]
    if pose.euler is None and pose.quaternion is None and any(w in said or (not w.isascii() and w in quote) for w in words):
        upright = "/".join(["", *keys[:-1], "2"])
        yield Problem(f"/claims/{name}/by", f"{quote!r} says how high, and {pointer} is a level extent; name {upright}")


def _beside(spec: WorldSpec, name: str) -> tuple[str, list[str]]:
    """Text before the quote of a claim, and the words behind it; nothing where the quote is not in the prompt."""
    claim = spec.claims[name]
    try:
        start, end = occurrence(spec.prompt, claim.quote, claim.nth)
    except InputError:
        return "", []
    return spec.prompt[:start], [folded(u.text) for u in units_of(spec.prompt[end:])]


def _way(spec: WorldSpec, name: str, pointer: str, wanted: Quantity) -> Iterator[Problem]:
    """A length or a time right behind the words of an event, judged by the size of a body: `[rolls](event) [8 cm](quantity)` is how far."""
    if (
        not pointer.startswith("/entities/")
        or "/size/" not in pointer
        or wanted.dimension != "length"
        or language_of(spec.prompt) != "en"
    ):
        return
    before, behind = _beside(spec, name)
    for other, claim in spec.claims.items():
        if claim.type != "event" or not before.rstrip().endswith(claim.quote) or _is_size(behind):
            continue
        quote = spec.claims[name].quote
        text = (
            f"{quote!r} stands right behind {claim.quote!r} and says how far, and {pointer} is the size of a body; name a bound of what {other!r} "
            "names, as `min` of a displacement in /story"
        )
        yield Problem(f"/claims/{name}/by", text)
        return


def _is_size(behind: Sequence[str]) -> bool:
    """True if the words behind a length make it one of a body."""
    first, second = (*behind[:2], "", "")[:2]
    return first in _SIZES or (first in _ACROSS and second not in _ARTICLES)


# ---------------------------------------------------------------- sides


def side_of(spec: WorldSpec, pointer: str) -> Literal["least", "most", "value"]:
    """The side on which the number at a pointer bounds what is measured; `value` where it is the thing itself."""
    keys = pointer.strip("/").split("/")
    if keys[0] != "story" or len(keys) < 5:
        return "value"
    if keys[3] == "frames":
        return "least" if keys[4] == "0" else "most"
    told = getattr(spec.story, keys[1], {}).get(keys[2])
    at: Any = told.predicate if told is not None else None
    turned = bool(getattr(told, "never", False))
    for key in keys[4:-1]:
        turned ^= isinstance(at, Not)
        at = at[int(key)] if isinstance(at, list) and key.isdigit() and int(key) < len(at) else getattr(at, key, None)
    turned ^= isinstance(at, Not)
    info = PREDICATES.get(str(getattr(at, "kind", "")))
    tightens = info.tightens.get(keys[-1], "none") if info is not None else "none"
    if tightens == "none":
        return "value"
    return "least" if (tightens == "up") != turned else "most"


def _one_sided(spec: WorldSpec, name: str, pointer: str, wanted: Quantity) -> Iterator[Problem]:
    """A quantity of the least or the most that is bound on the other side."""
    asked = {"at least": "least", "at most": "most"}.get(wanted.how)
    side = side_of(spec, pointer)
    if asked is None or side in (asked, "value") or _denied(spec, pointer):
        return
    quote, field = spec.claims[name].quote, "min" if asked == "least" else "max"
    text = f"{quote!r} says at {asked} {wanted.value:g} {wanted.unit}, and {pointer} is the {side} that is asked: more of it would pass as well"
    if asked == "least":
        text = text.replace("more of it", "less of it")
    text += f"; give the number as `{field}` of a `displacement`, `separation` or `speed`, or as the bound of a requirement with never: true"
    yield Problem(f"/claims/{name}/by", text)


def _denied(spec: WorldSpec, pointer: str) -> bool:
    """True where a claim of a negation says that what a requirement asks for never happens: `[not](negation) [more than 8 cm](quantity)`."""
    keys = pointer.strip("/").split("/")
    if keys[:2] != ["story", "requirements"]:
        return False
    told = spec.story.requirements.get(keys[2])
    negations = [n for n, c in spec.claims.items() if c.type == "negation" and c.waived is None]
    return told is not None and told.never and any(keys[2] in named_in(spec, n, "story/requirements") for n in negations)


# ---------------------------------------------------------------- whose it is


def _of_nothing_claimed(spec: WorldSpec, pointer: str) -> str | None:
    """Why a number is of nothing that the words of the prompt speak of; None where it is."""
    keys = pointer.strip("/").split("/")
    root = keys[0]
    if is_setting(pointer) and not (keys[-1] == "fps" and _watched(spec)):
        return f"a setting of a solver, of the checks or of the look, or time before the first frame, which says nothing of what is to be seen: {INSTEAD}"
    if root in ("shots", "look"):
        return (
            None
            if _watched(spec)
            else (
                f"which is {'the camera' if root == 'shots' else 'light and picture'}, and no words of the prompt speak of that: "
                "name a number of the thing that it is said of, as /entities/<id>/dimensions/size/0"
            )
        )
    if root == "terrains":
        named = any(keys[1] in named_in(spec, n, "terrains") for n, c in spec.claims.items() if c.type != "quantity")
        return None if named else f"of a land {keys[1]!r} that no other claim names: claim the words of it as a thing or place"
    bodies = _bodies_of(spec, keys)
    if bodies is None:
        return None
    loose = {n for n in bodies if n in spec.entities and spec.entities[n].physics.shape == "loose"}
    if bodies and not loose and not set(bodies) & spoken_of(spec, types=_SPEAK):
        return f"of {bodies[0]!r}, which no claim of a thing names: name a number of what the words are about, or claim the words of it as a thing"
    return None


def _bodies_of(spec: WorldSpec, keys: Sequence[str]) -> list[str] | None:
    """Entities that the number at a pointer is of; None where it is of the world as a whole or judged elsewhere."""
    plan = spec.simulation
    if keys[0] == "entities":
        return [keys[1]]
    if keys[0] == "materials":
        return [n for n, e in spec.entities.items() if keys[1] in (e.material, *(p.material for p in e.parts.values()))]
    holders: dict[str, Any] = {
        "joints": plan.joints,
        "drivers": plan.drivers,
        "contacts": plan.contacts,
        "relations": spec.graph.relations,
    }
    item = holders.get(keys[1], {}).get(keys[2]) if len(keys) > 2 else None
    if not isinstance(item, SpecModel):
        return None
    return [v for _, target, v in references(item, "") if target in ("entity", "node") and v in spec.entities] or None


def _watched(spec: WorldSpec) -> bool:
    """True where words of the prompt speak of camera or light, or no list of its language could tell."""
    language = language_of(spec.prompt)
    if language not in REVIEWED:
        return True
    listed = set(_WATCHED[language].split())
    if language in ("zh", "ja"):
        return any(word in spec.prompt for word in listed)
    return bool(listed & {folded(u.text) for u in units_of(spec.prompt)}) or any(
        meanings(spec.prompt, language, kind) for kind in ("look", "time")
    )
