"""Generators of assets as `inspect_world` tells them."""

from __future__ import annotations

from typing import Any

from ..worlds.errors import InputError
from .answers import answer, call, paged

__all__ = ["assets"]

IN_FULL = 3
"""Generators whose parameters are told when as few are found."""
FIRST = 12
"""Generators that a query returns at most, those first that fit best."""


def assets(query: str, *, offset: int, limit: int) -> dict[str, Any]:
    """Generators that a query finds by words; parameters, sizes and surfaces of the best ones; without a query all names.

    Raises:
        InputError: nothing is found.
    """
    from ..construction.assets.registry import GENERATORS, MODULES, found

    if not query.strip():
        families = {m.__name__.rpartition(".")[2]: [g.name for g in m.GENERATORS] for m in MODULES}
        text = f"{len(GENERATORS)} generators by family; place_object(asset={{'generator': name, ...}}) makes one"
        return answer({"part": "assets", "families": families}, text, call("inspect_world", part="assets", query="oak chair"))
    names = found(query)
    if not names:
        raise InputError(f"no generator is found by {query[:60]!r}; inspect_world(part='assets') names all {len(GENERATORS)}")
    exact = [n for n in names if n == query.strip().lower().replace(" ", "_")]
    page, place = paged(exact or names[:FIRST], offset, limit)
    told = {n: _entry(n, full=k < IN_FULL) for k, n in enumerate(page)}
    then = (
        f"place_object(world=..., entity='my_{page[0]}', asset={{'generator': {page[0]!r}, 'parameters': {{...}}, 'seed': 1}}, on=..., at=...); "
        f"inspect_world(part='assets', query=NAME) tells the parameters of any other"
    )
    return answer({"part": "assets", "generators": told, **place}, f"{len(page)} generators found by {query[:60]!r}", then)


def _entry(name: str, *, full: bool) -> dict[str, Any]:
    from ..construction.assets.documents import asset_size
    from ..construction.assets.registry import generator

    kind = generator(name)
    if not full:
        return {"summary": kind.summary}
    made = kind.make({}, 0)
    return {
        "summary": kind.summary,
        "parameters": {k: _field(f) for k, f in kind.model.model_json_schema()["properties"].items()},
        "motion": kind.motion,
        "size": [round(v, 3) for v in asset_size(made)],
        **({"bodies": [b for b in made.bodies if b]} if len(made.bodies) > 1 else {}),
        **({"surfaces": {k: round(float(p.center[2]), 3) for k, p in made.places.items()}} if made.places else {}),
    }


def _field(field: dict[str, Any]) -> str:
    """A parameter in one line: default, range or choices, meaning."""
    about = field.get("description", "")
    if "enum" in field:
        return f"{field['default']!r} of {field['enum']}; {about}".rstrip("; ")
    if "minimum" in field:
        return f"{field['default']} in {field['minimum']}..{field['maximum']}; {about}"
    return f"{field['default']!r}; {about}"
