"""Lines of the approximation register about force fields and air (R18, R63)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...worlds.fields import acting_on, carried_by, field_drivers
from ...worlds.quoting import listed
from ..categories.registry import JUDGES, judged

if TYPE_CHECKING:
    from ...worlds.spec import WorldSpec

__all__ = ["field_lines"]

NAMED = 12
"""Own choice: of entities without air, so many are named."""


def _airless(spec: WorldSpec) -> list[dict[str, str]]:
    """Who moves without any medium."""
    aired = {n for d in field_drivers(spec).values() if d.field.kind != "attraction" for n in acting_on(spec, d)}
    aired |= {n for n in spec.entities if carried_by(spec, n)}
    bare = sorted(n for n, e in spec.entities.items() if e.motion == "dynamic" and n not in aired)
    if not bare:
        return []
    whom = f" for {listed(bare, NAMED)}" if aired else ": no field declares a medium"
    return [
        {"what": f"no air{whom}", "effect": "nothing slows what falls, flies or swings but the damping that is declared for it"}
    ]


def field_lines(spec: WorldSpec) -> list[dict[str, str]]:
    """Lines of the approximation register about force fields."""
    found = _airless(spec)
    for name, driver in field_drivers(spec).items():
        felt = acting_on(spec, driver)
        if driver.field.kind != "attraction":
            found.append(
                {
                    "what": f"the medium of field {name!r} is given, not simulated",
                    "effect": "nothing slows, shades or stirs it: what it moves does not act back on it; it bears nothing, so nothing is "
                    "buoyed up in it",
                }
            )
            acted = {judge.name for n, judge in judged(spec).items() if n in felt}
            found += [
                {"what": words[0].format(name), "effect": words[1]}
                for judge in JUDGES.values()
                if judge.name in acted and (words := judge.in_fields) is not None
            ]
        deaf = sorted(n for n, e in spec.entities.items() if e.motion == "dynamic" and n not in felt)
        if deaf and driver.entities is None:
            found.append({"what": f"field {name!r} does not act on {', '.join(deaf)}", "effect": "their engines read no fields"})
        spared = sorted(set(acting_on(spec, driver.model_copy(update={"entities": None}))) - set(felt))
        if spared:
            found.append(
                {"what": f"field {name!r} is declared for {', '.join(felt)} alone", "effect": f"it spares {', '.join(spared)}"}
            )
    return found
