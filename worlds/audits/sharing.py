"""Things that two spans speak of: each has bodies of its own, and a part of one stands for a thing only where the words say part (R131, R155)."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations

from ..claims import Reading
from ..part_words import says_part
from ..problems import Problem
from ..spec import WorldSpec

__all__ = ["sharing_problems"]


def sharing_problems(spec: WorldSpec, reading: Reading) -> Iterator[Problem]:
    """Things that are the same bodies or parts as another, and parts that stand for what moves as one with the rest."""
    told: dict[str, dict[str, set[str]]] = {}
    of: dict[str, str] = {}
    for name, claim in spec.claims.items():
        if claim.type != "thing" or claim.same_as is not None or claim.waived is not None:
            continue
        for pointer in claim.by:
            first = of.setdefault(pointer, name)
            if first != name:
                quote = spec.claims[first].quote
                text = (
                    f"{claim.quote!r} and {quote!r} are both {pointer}; give each its own, or same_as {first!r} if they are one thing, "
                    f"in marked text [{claim.quote}](thing same_as={first})"
                )
                if len(claim.by) < len(spec.claims[first].by):
                    text += (
                        f"; if it is some of them alone, [{claim.quote}](thing {' '.join(map(_shown, claim.by))} same_as={first})"
                    )
                yield Problem(f"/claims/{name}/by", text)
            keys = pointer.strip("/").split("/")
            if keys[0] == "entities" and keys[1] in spec.entities:
                parts = set(keys[3:4]) if keys[2:3] == ["parts"] else set(spec.entities[keys[1]].parts)
                told.setdefault(keys[1], {}).setdefault(name, set()).update(parts)
    for entity, claims in told.items():
        yield from _parts(spec, reading, entity, claims)


def _shown(pointer: str) -> str:
    """A thing as it is written in marked text: an entity by its id."""
    return pointer.removeprefix("/entities/") if pointer.count("/") == 2 else pointer


def _parts(spec: WorldSpec, reading: Reading, entity: str, claims: dict[str, set[str]]) -> Iterator[Problem]:
    """Problems of the claims of one entity, each with the parts that it names."""
    whole, still = set(spec.entities[entity].parts), spec.entities[entity].motion == "static"
    single = {name for name, parts in claims.items() if parts < whole and len(spec.claims[name].by) == 1 and not still}
    for name in sorted(single):
        if len(claims) == 1 and not says_part(spec, reading.spans, name, reading.language):
            part = next(iter(claims[name]))
            text = f"{spec.claims[name].quote!r} is judged by {part!r}, one part of {entity!r}, and its words do not say that it is a part: "
            yield Problem(f"/claims/{name}/by", text + f"name {entity!r}, or give the thing an entity of its own")
    for (a, one), (b, two) in combinations(claims.items(), 2):
        if (still and not one & two) or any(
            says_part(spec, reading.spans, n, reading.language) for n in (a, b) if claims[n] < whole
        ):
            continue
        if one == two == whole and set(spec.claims[a].by) & set(spec.claims[b].by):
            continue  # told above
        text = f"{spec.claims[b].quote!r} and {spec.claims[a].quote!r} are both of the one body {entity!r}, and no words say that one is a part of the other: "
        yield Problem(f"/claims/{b}/by", text + f"give each an entity of its own, or same_as {a!r} if they are one thing")
