"""The schema of a specification in short lines, part by part: what a model needs to write its first world.

The JSON Schema of a world is some 90 kB because every union is written out wherever it is used. Here a part is one
type with a line for each field: `type, range; default or required; meaning`. Names that begin with a capital letter
are parts themselves.
"""

from __future__ import annotations

import difflib
import json
import re
from collections.abc import Iterator, Mapping
from functools import cache
from typing import Any

from .errors import InputError

__all__ = ["described", "known_parts", "overview"]

UNIONS = {
    "Predicate": "Reaches",
    "Shape": "Box",
    "Physics": "RigidPhysics",
    "Region": "BoxRegion",
    "Relation": "Supports",
    "Joint": "HingeJoint",
    "Driver": "MotorDriver",
    "SolverInstance": "RigidInstance",
    "Robustness": "Perturbed",
    "Layer": "Noise",
}
"""Names for unions, each by one of its members."""
ROOT = "World"
NESTED = 6
"""A part brings the parts that only it needs along, at most so many."""
LONGEST = 7900
"""Characters of a union: its longest members are then named only, and told when they are asked for."""
SHORT_DEFAULT = 40
LEAST_STEM = 4
"""Letters of a word from which on parts are looked for by the beginning and end of their name."""
SLIP, LIKE = 0.75, 0.5
"""Likenesses to a name of what is a slip of the pen, and of what may be meant where nothing else fits."""
NAMED = 4
"""Parts that are offered for a word."""
MANY = 256
"""Items beyond which a largest number is not told. Own choice: nobody writes so many by hand."""
UNSAID = 1e9
"""Bounds that only keep numbers finite are left out."""
_FIRST = tuple(
    f"one of {u}" for u in ("SolverInstance", "Driver", "Physics", "Predicate", "Shape", "Region", "Relation", "Joint")
)
"""In which order parts of one name are told, by where they stand."""
_ID = "^[A-Za-z][A-Za-z0-9_-]{0,63}$"
_BOUNDS = {"minimum": ">=", "exclusiveMinimum": ">", "maximum": "<=", "exclusiveMaximum": "<"}


@cache
def _schema() -> dict[str, Any]:
    from .spec import WorldSpec

    return WorldSpec.model_json_schema()


@cache
def _members() -> dict[str, tuple[str, ...]]:
    """Types of every named union."""
    found = {}
    for node in _nodes(_schema()):
        names = tuple(_ref(o) for o in node.get("oneOf", ()) if "$ref" in o)
        for union, member in UNIONS.items():
            if member in names:
                found[union] = names
    return found


def _nodes(node: Any) -> Iterator[dict[str, Any]]:
    if isinstance(node, dict):
        yield node
        for value in node.values():
            yield from _nodes(value)
    elif isinstance(node, list):
        for value in node:
            yield from _nodes(value)


def _ref(node: Mapping[str, Any]) -> str:
    return str(node["$ref"]).rsplit("/", 1)[-1]


def known_parts() -> tuple[str, ...]:
    """Names that `described` takes."""
    return (ROOT, *UNIONS, *sorted(_schema()["$defs"]))


def overview() -> dict[str, Any]:
    """The top level of a specification and where to read on."""
    return {
        "fields": _fields(_schema()),
        "unions": {name: f"one of {', '.join(_kind(m) for m in members)}" for name, members in _members().items()},
    }


def described(part: str, document: Any = None) -> dict[str, Any]:
    """One part in short lines, with the parts that only it needs.

    Args:
        part: a name of `known_parts`, what a kind, an engine or a category is called in a specification (`release`, `dem`), or a JSON
            pointer into one, such as `/simulation/solvers`. Of several parts of a name one is told and the others are named.
        document: the specification, which tells which member of a union the pointer leads through; else the first that fits.

    Raises:
        InputError: there is no such part.
    """
    name, others = (_by_pointer(part, document), []) if part.startswith("/") else _meant(part)
    if name in (ROOT, ""):
        return overview()
    if name in _members():
        return _union(name)
    if name not in _schema()["$defs"]:
        raise InputError(
            f"the schema has no part {part!r}{_hint(name)} Parts: {', '.join((ROOT, *UNIONS))}, and every name they mention"
        )
    found: dict[str, Any] = {"type": name}
    if others:
        found |= {"stands": _home(name), "see_also": [f"{k} ({_home(k)})" for k in others]}
    found |= _type(name)
    nested = [n for n in _mentioned(_schema()["$defs"][name]) if n not in UNIONS][:NESTED]
    if nested:
        found["parts"] = {n: _type(n) for n in nested}
    return found


def _meant(word: str) -> tuple[str, list[str]]:
    """The part that a word means, itself where there is none, and others that it may mean.

    A part's own name means that part. Other words are what a specification calls a kind, an engine or a category: what is simulated goes
    before what is asked of it, and layers of terrain, whose names are those of what shaped it, come last.
    """
    same = [k for k in known_parts() if word.lower() in (k.lower(), *_kinds(_schema()["$defs"].get(k, {})))]
    if not same or word in (ROOT, *UNIONS):
        return word, []
    told = sorted(
        same, key=lambda k: (k != word, _FIRST.index(_home(k)) if _home(k) in _FIRST else len(_FIRST), _home(k) == "one of Layer")
    )
    if told[0] in (ROOT, *UNIONS):
        return told[0], []
    near = [] if word == told[0] else _near(word)
    return told[0], [k for k in dict.fromkeys((*told, *near)) if k != told[0]][:NAMED]


def _hint(name: str) -> str:
    """Parts that a word may mean, each with where it stands: by name, kind, beginning or end of their name; slips; by their fields; by what they
    are about; else by likeness."""
    told = [f"{k} ({_home(k)})" for k in _near(name)] or _alike(name, SLIP) or _speaking_of(name) or _alike(name, LIKE)
    return f"; did you mean {' or '.join(told)}?" if told else ""


def _alike(name: str, cutoff: float) -> list[str]:
    folded = {k.lower(): k for k in known_parts()}
    return [folded[c] for c in difflib.get_close_matches(name.lower(), folded, n=3, cutoff=cutoff)]


def _speaking_of(name: str) -> list[str]:
    """Parts with a field of that name, or of one that begins with it, and parts whose description has the word."""
    stem = name.lower().removesuffix("s")
    parts = {k: node for k, node in _schema()["$defs"].items() if k in known_parts()}
    fields = [
        f"{field} of {k} ({_home(k)})"
        for k, node in parts.items()
        for field in node.get("properties", {})
        if field.removesuffix("s") == stem or field.startswith(f"{stem}_")
    ]
    word = re.compile(rf"\b{re.escape(stem)}s?\b", re.IGNORECASE)
    about = [f"{k} ({_home(k)})" for k, node in parts.items() if word.search(node.get("description", ""))]
    about = sorted(about, key=lambda told: "Predicate" in told)[: NAMED // 2]
    return [*fields[: NAMED - len(about)], *about]


def _near(name: str) -> list[str]:
    """Parts of which a word is the kind or the beginning or end of the name."""
    folded = {k.lower(): k for k in known_parts()}
    word = name.lower()
    stem = word.removesuffix("s")
    kinds = {k: _kinds(node) for k, node in _schema()["$defs"].items()}

    def rank(part: str) -> tuple[bool, bool, bool]:
        return (
            part.lower() != stem,
            not kinds.get(part, set()) & {word, stem},
            not part.endswith(("Physics", "Instance", "Driver")),
        )

    found = [k for f, k in folded.items() if kinds.get(k, set()) & {word, stem} or f.startswith(stem) or f.endswith(stem)]
    return sorted(found, key=rank)[:NAMED] if len(stem) >= LEAST_STEM else []


def _kinds(node: Mapping[str, Any]) -> set[str]:
    fields = (node.get("properties", {}).get(k, {}) for k in ("kind", "category", "engine"))
    return {str(value) for f in fields for value in f.get("enum", [f["const"]] if "const" in f else [])}


def _home(name: str) -> str:
    """Where a part stands: the union that it is one of, else the part that mentions it."""
    union = next((u for u, members in _members().items() if name in members), None)
    if union is not None:
        return f"one of {union}"
    wanted = UNIONS.get(name, name)
    known = {ROOT: _schema()} | dict(_schema()["$defs"])
    own = {k: v for k, v in known.items() if k not in ("$defs", name)}
    for other, node in own.items():
        if any(_ref(n) == wanted for n in _nodes(node.get("properties", {})) if "$ref" in n):
            return f"in {other}"
    return "by itself"


def _union(name: str) -> dict[str, Any]:
    """A union: the fields that all its members share said once, then each member's own."""
    options = {_kind(m): _type(m) for m in _members()[name]}
    first, *others = (o["fields"] for o in options.values())
    shared = {k: line for k, line in first.items() if k != "kind" and all(o.get(k) == line for o in others)} if others else {}
    own = {kind: {**o, "fields": {k: v for k, v in o["fields"].items() if k not in shared}} for kind, o in options.items()}
    found = {"union": name, **({"shared": shared} if shared else {}), "options": own}
    kinds = dict(zip(options, _members()[name], strict=True))
    for kind in sorted(own, key=lambda k: len(json.dumps(own[k])), reverse=True):
        if len(json.dumps(found)) < LONGEST:
            break
        own[kind] = {**{k: re.split(r"[.:;] ", v)[0] for k, v in own[kind].items() if k == "about"}, "part": kinds[kind]}
    return found


def _type(name: str) -> dict[str, Any]:
    node = _schema()["$defs"][name]
    about = " ".join(str(node.get("description", "")).split())
    return {**({"about": about} if about else {}), "fields": _fields(node)}


def _fields(node: Mapping[str, Any]) -> dict[str, str]:
    required = set(node.get("required", ()))
    return {name: _line(field, required=name in required) for name, field in node.get("properties", {}).items()}


def _line(field: Mapping[str, Any], *, required: bool) -> str:
    words = [_words(field)]
    default = json.dumps(field.get("default"), separators=(",", ":"))
    if "const" not in field:
        if required:
            words.append("required")
        elif default not in ("null", "{}", "[]", '""') and len(default) <= SHORT_DEFAULT:
            words.append(f"default {default}")
    about = " ".join(str(field.get("description", "")).split())
    return "; ".join((*words, *([about] if about else [])))


def _words(node: Mapping[str, Any]) -> str:
    """A type with its range in a few words."""
    if "$ref" in node:
        return _ref(node)
    if "const" in node:
        return json.dumps(node["const"])
    if "enum" in node:
        return " | ".join(json.dumps(v) for v in node["enum"])
    options = node.get("oneOf") or node.get("anyOf")
    if options:
        union = next((n for n, members in _members().items() if members == tuple(_ref(o) for o in options if "$ref" in o)), None)
        return union or " | ".join(dict.fromkeys(_words(o) for o in options))
    kind = node.get("type")
    if kind == "array":
        return _array(node)
    if kind == "object":
        inner = next(iter(node.get("patternProperties", {}).values()), None) or node.get("additionalProperties")
        return f"{{id: {_words(inner)}{_most(node.get('maxProperties'))}}}" if isinstance(inner, dict) else "object"
    bounds = " and ".join(f"{sign} {node[key]:g}" for key, sign in _BOUNDS.items() if abs(node.get(key, UNSAID)) < UNSAID)
    plain = "id" if node.get("pattern") == _ID else {"string": "text"}.get(str(kind), str(kind))
    return f"{plain} {bounds}".strip()


def _array(node: Mapping[str, Any]) -> str:
    if "prefixItems" in node:
        parts = [_words(i) for i in node["prefixItems"]]
        return f"[{len(parts)} x {parts[0]}]" if len(set(parts)) == 1 else f"[{', '.join(parts)}]"
    items = _words(node.get("items", {}))
    low, high = node.get("minItems"), node.get("maxItems")
    many = f"{low} x " if low is not None and low == high else ""
    most = _most(high) if "$ref" in node.get("items", {}) else ""
    return f"[{many}{items}{'' if many else ', ...' + most}]"


def _most(count: int | None) -> str:
    """Largest number of items, where there is one that is met."""
    return "" if count is None or count > MANY else f", <= {count}"


def _kind(name: str) -> str:
    """Name of a union's member in a specification; of one that has several, all of them."""
    fields = _schema()["$defs"][name]["properties"]
    said: dict[str, Any] = next(
        (f for k in ("kind", "category", "engine") if {"const", "enum"} & set(f := fields.get(k, {}))), {}
    )
    return ", ".join(map(str, said.get("enum", [said.get("const", name)])))


def _mentioned(node: Mapping[str, Any]) -> list[str]:
    """Names of types below a node, without what only unions mention."""
    members = {m for names in _members().values() for m in names}
    return list(dict.fromkeys(n for found in _nodes(node) if "$ref" in found and (n := _ref(found)) not in members))


def _by_pointer(pointer: str, document: Any = None) -> str:
    """The part that stands at a pointer; ids of collections are skipped."""
    node: Mapping[str, Any] = _schema()
    name = ROOT
    tokens = [t for t in pointer.split("/") if t]
    for number, token in enumerate(tokens):
        document = document.get(token) if isinstance(document, Mapping) else None
        inner = next(iter(node.get("patternProperties", {}).values()), None)
        field = inner if inner is not None else node.get("properties", {}).get(token)
        if field is None:
            raise InputError(
                f"the schema has nothing at {pointer!r} below {name}; it has {', '.join(node.get('properties', {})) or 'no fields'}"
            )
        union = _words(field)
        if "$ref" in field:
            name = _ref(field)
            node = _schema()["$defs"][name]
        elif union in UNIONS:
            name = _member(union, tokens[number + 1 : number + 2], document)
            if name == union:
                return union
            node = _schema()["$defs"][name]
        else:
            node = field
    if "patternProperties" in node:
        return _by_pointer(f"{pointer}/*")
    return name


def _member(union: str, rest: list[str], document: Any) -> str:
    """The member of a union that a pointer goes on into, by what stands there; the union itself where none is meant."""
    members = _members()[union]
    if not rest or union == "Predicate":
        return union
    said = [document.get(k) for k in ("kind", "category", "engine")] if isinstance(document, Mapping) else []
    fits = [m for m in members if rest[0] in _schema()["$defs"][m]["properties"]]
    return next((m for m in fits if _kinds(_schema()["$defs"][m]) & set(said)), fits[0] if fits and not any(said) else union)
