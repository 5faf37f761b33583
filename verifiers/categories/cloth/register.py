"""Lines of the approximation register about cloth."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from ....worlds.categories.cloth.facts import exchange_of, grids_of, touching_distance
from ....worlds.errors import EvidenceError
from ....worlds.fields import fields_of
from ....worlds.instances import carriers_of, cloth_of, coupled_groups, felt_by, soft_met

if TYPE_CHECKING:
    from ....worlds.candidate import Candidate
    from ....worlds.spec import WorldSpec

__all__ = ["cloth_lines"]

LOST = 0.05 * (2 * math.pi) ** 2
"""Loss of a swing of 1 Hz per second and second of step: the theta rule at 0.55 takes 0.05 w^2 h."""


PUSHED = 0.1, 0.2
"""Share of an overlap of two contact shells that a step takes back; and the greatest speed with which it does [m/s]."""


def cloth_lines(candidate: Candidate) -> list[dict[str, str]]:
    """Lines of every cloth instance."""
    spec = candidate.spec
    found: list[dict[str, str]] = []
    for name, instance in spec.simulation.cloth.items():
        for member in instance.members:
            found += _sheet(spec, member, instance.settings.margin)
        if any(fields_of(spec, m).has_medium for m in instance.members) and not _felt(spec, name):
            found.append(
                {
                    "what": f"the air is not moved by {name!r}; it pushes each triangle by their relative velocity",
                    "effect": "no wake, no lift of a whole sail or flag beyond what single faces feel",
                }
            )
        found.append(
            {
                "what": f"sheets of {name!r} that may meet something are damped, if by no more, by 1.5 % of what ends their fastest swing",
                "effect": "swings between neighbouring vertices fade within some tens of swings, slower ones in proportion less",
            }
        )
        found += [*_contacts(spec, name), *_grains(spec, name), *_steps(spec, name), *_forced(candidate, name)]
        coupled = {s for g in coupled_groups(spec) if name in g for s in g}
        for rigid, other in spec.simulation.rigid.items():
            if rigid not in coupled and any(spec.entities[m].motion == "dynamic" for m in other.members if m in spec.entities):
                found.append(
                    {
                        "what": f"the cloth {name!r} is pushed by bodies of {rigid!r} and does not push them",
                        "effect": "omitted reaction: nothing is caught, carried or held by it",
                    }
                )
    return found


def _felt(spec: WorldSpec, name: str) -> bool:
    """True if the one medium that blows at sheets is simulated and feels them."""
    return any(name in felt_by(spec, c) for c in carriers_of(spec, name))


def _steps(spec: WorldSpec, name: str) -> Iterator[dict[str, str]]:
    """Losses of swings by long steps; on a GPU there are short ones alone, and beside elastic bodies none of those with contacts."""
    settings = spec.simulation.cloth[name].settings
    if settings.integrator != "implicit" or settings.device != "cpu":
        return
    step = min(settings.max_step, exchange_of(spec, name))
    yield {
        "what": f"where {name!r} meets nothing its steps are up to {step:.3g} s long",
        "effect": f"a swing of 1 Hz loses up to {LOST * step:.2%} of its amplitude in a second, of 5 Hz 25 times that",
    }
    if not set(soft_met(spec, name)) - _ignored(spec, name):
        yield {
            "what": f"where {name!r} touches something and moves slowly its steps are up to {step:.3g} s long",
            "effect": f"a swing of 1 Hz loses up to {10 * LOST * step:.1%} of its amplitude in a second",
        }


def _forced(candidate: Candidate, name: str) -> Iterator[dict[str, str]]:
    """Changes of places and speeds by contacts, beside impulses."""
    yield {
        "what": f"ways of vertices of {name!r} are cut short where they would cross something",
        "effect": f"momentum is lost there; {_cut(candidate, name)}",
    }
    share, fastest = PUSHED
    yield {
        "what": f"layers of {name!r} that are nearer than they touch are pushed apart by {share:.0%} of that in a step, at {fastest:g} m/s at most",
        "effect": f"they stay too near for some ten steps, and part with up to {fastest:g} m/s that no impact gave",
    }


def _cut(candidate: Candidate, name: str) -> str:
    """Sentence about the momentum lost so, as recorded."""
    cache = candidate.cloth_caches.get(name)
    if cache is None:
        return "how much is known after a probe"
    try:
        lost = np.stack([cache.series(f"record/cut_impulse_{axis}") for axis in "xyz"], axis=1).astype(np.float64)
        count = int(np.asarray(cache.series("record/cut_vertices")).sum())
    except EvidenceError as error:
        return f"how much is not known: {error}"
    size = np.linalg.norm(lost, axis=1)
    frame = int(size.argmax())
    return f"{size[frame]:.2g} N s in all by frame {frame}, where it is most, at {count} vertices in all frames and exchanges"


def _ignored(spec: WorldSpec, name: str) -> set[str]:
    """Entities that the sheets of an instance pass through: what one of them ignores."""
    return {
        e for m in spec.simulation.cloth[name].members if (p := spec.entities[m].physics).category == "cloth" for e in p.ignores
    }


def _contacts(spec: WorldSpec, name: str) -> Iterator[dict[str, str]]:
    """Lines that hold for all sheets of an instance alike."""
    members = [m for m in spec.simulation.cloth[name].members if spec.entities[m].physics.category == "cloth"]
    listed = ", ".join(repr(m) for m in members)
    yield {
        "what": f"what meets the cloth {name!r} does not bounce off it",
        "effect": "restitution of the materials counts for nothing",
    }
    rough = {spec.materials[spec.entities[m].material].friction for m in members}
    if len(rough) > 1:
        yield {
            "what": f"all sheets of {name!r} rub alike, with a friction of {max(rough):g} at least",
            "effect": f"{listed} have the friction of the roughest of them",
        }
    for other in sorted(_ignored(spec, name)):
        yield {"what": f"{listed} of {name!r} do not meet {other!r}", "effect": "they pass through it"}
    if not any(getattr(spec.entities[m].physics, "self_collision", True) for m in members):
        yield {
            "what": f"sheets of {name!r} do not meet themselves or each other",
            "effect": f"folds and sheets of {listed} pass through each other",
        }


def _grains(spec: WorldSpec, name: str) -> Iterator[dict[str, str]]:
    """Lines about other matter that meets it."""
    plan = spec.simulation
    for other, instance in plan.solvers.items():
        if other in plan.rigid or other == name:
            continue
        kind = instance.moves[0]
        if name not in cloth_of(spec, other):
            yield {
                "what": f"the {kind} of {other!r} and the cloth {name!r} do not meet",
                "effect": "omitted in both directions: they pass through each other",
            }
        elif kind == "liquid":
            yield {
                "what": f"the cloth {name!r} takes no room in the liquid of {other!r} and does not soak",
                "effect": "drops hang on it only by its surface; its weight stays that of dry cloth",
            }
        burns = other in plan.gas
        if name in cloth_of(spec, other) and not burns and not any({name, other} <= g for g in coupled_groups(spec)):
            yield {
                "what": f"the cloth {name!r} carries and pushes the {kind} of {other!r} and does not feel it",
                "effect": "omitted reaction: the cloth does not sag under it",
            }


def _sheet(spec: WorldSpec, member: str, margin: float | None) -> Iterator[dict[str, str]]:
    entity = spec.entities[member]
    physics = entity.physics
    if physics.category != "cloth":
        return
    shortest = min((edge for _, edge in grids_of(entity)), default=None)
    if shortest is not None:
        apart = touching_distance(physics.thickness, shortest, margin)
        yield {
            "what": f"layers of {member!r} touch at {apart:.3g} m, solids at half of it; its thickness is {physics.thickness:g} m",
            "effect": f"folds lie up to {max(apart - physics.thickness, 0.0):.3g} m too far apart and bend over no less than {shortest:.3g} m",
        }
    if physics.tear is not None:
        yield {
            "what": f"{member!r} tears along the edges of its triangles, at the mean pull around a vertex",
            "effect": f"tears turn no finer than its triangles ({shortest or 0.0:.3g} m), and their two lips pass through each other",
        }
    for holder in sorted({pin.to for pin in physics.pins.values() if pin.to is not None}):
        yield {
            "what": f"triangles of {member!r} that hang on {holder!r} do not meet it",
            "effect": "beside its pins the sheet may pass through what holds it",
        }
    yield {
        "what": f"{member!r} stretches, shears and bends in proportion to its load",
        "effect": "fabric that gives way at first and stiffens, or keeps its creases, is not simulated",
    }
    if physics.bend_stiffness > 0 and any(p.shape.kind == "sheet" for p in entity.parts.values()):
        yield {
            "what": f"how {member!r} bends depends on the way that its triangles lie",
            "effect": "a clamped plate sinks by 1.28 of its law along its squares and by 0.82 along their diagonals",
        }
