"""Lines of the approximation register about surfaces that are drawn and met otherwise than they are, one line for many alike (R68)."""

from __future__ import annotations

from collections.abc import Iterator

from ...worlds.candidate import Candidate

__all__ = ["surface_lines"]

FINE = 1e-3
"""Own choice [m]: a collider that departs by less is told together with all such; a third of the gap that counts as contact by default."""
NAMED = 3
"""Parts that a line names."""


def surface_lines(candidate: Candidate) -> Iterator[dict[str, str]]:
    """Parts that are drawn only, by entity; colliders that are not the visible surface: by entity, and fine ones in one line."""
    fine: list[tuple[float, str, tuple[float, float]]] = []
    for name, entity in candidate.spec.entities.items():
        drawn = [part for part, p in entity.parts.items() if not p.collides]
        if drawn:
            noun = f"part {name}/{drawn[0]} is" if len(drawn) == 1 else f"{len(drawn)} parts of {name!r} are"
            named = "" if len(drawn) == 1 else f" ({_first(drawn)})"
            yield {
                "what": f"{noun} drawn only{named}",
                "effect": "other bodies pass through it" if len(drawn) == 1 else "other bodies pass through them",
            }
        built = candidate.built[name].parts if name in candidate.built else ()
        parts = [(max(made.deviation), f"{name}/{made.part}", made.deviation) for made in built if max(made.deviation) > 0]
        fine += [part for part in parts if part[0] < FINE]
        coarse = [part for part in parts if part[0] >= FINE]
        if coarse:
            yield _colliders(coarse)
    if fine:
        yield _colliders(fine)


def _colliders(parts: list[tuple[float, str, tuple[float, float]]]) -> dict[str, str]:
    """One line for colliders of several parts, the worst named first."""
    parts = sorted(parts, reverse=True)
    outside, inside = (max(deviation[side] for _, _, deviation in parts) for side in (0, 1))
    names = [name for _, name, _ in parts]
    what = f"proxy collider of {names[0]}" if len(names) == 1 else f"proxy colliders of {len(names)} parts ({_first(names)})"
    return {"what": what, "effect": f"collision surface up to {outside:.2g} m outside and {inside:.2g} m inside the visible one"}


def _first(names: list[str]) -> str:
    more = len(names) - NAMED
    return ", ".join(names[:NAMED]) + (f" and {more} more" if more > 0 else "")
