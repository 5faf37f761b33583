"""Lines of the approximation register about bodies that break (R68)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ....physics.drag import area_vectors
from ....worlds.bonds import WORLD
from ....worlds.categories.fracture.pieces import crumble_of
from ....worlds.fields import fields_of
from ...register.factors import times

if TYPE_CHECKING:
    from ....worlds.arrays import F64
    from ....worlds.built import BuiltEntity
    from ....worlds.candidate import Candidate
    from ....worlds.categories.fracture.models import Breakable

__all__ = ["fracture_lines"]

TOGETHER = 0.6
"""Share of the load of the worst bond from which its neighbours break with it (`simulation/fracture/breaking.py`)."""


def fracture_lines(candidate: Candidate) -> list[dict[str, str]]:
    """Lines of every breakable entity."""
    found = []
    for name, entity in candidate.spec.entities.items():
        if entity.breakable is None:
            continue
        pattern, bond = entity.breakable.pattern.kind, entity.breakable.bond
        pieces = len(candidate.built[name].bodies) if name in candidate.built else 0
        found += [
            {
                "what": f"{name!r} is cut beforehand into {pieces} pieces ({pattern})",
                "effect": "it breaks along their faces only; pieces themselves never break",
            },
            {
                "what": f"bonded pieces of {name!r} are one rigid body; stresses are those of equilibrium, blows spread over "
                f"{bond.contact_time:g} s with the inertia of the pieces",
                "effect": "no waves; what is bonded to the world takes up momentum without moving; a body on an authored path does "
                "not meet it until it breaks",
            },
            {
                "what": f"energy that breaks bonds of {name!r} is recorded and not taken from the motion",
                "effect": "pieces fly a little too fast; an inelastic blow loses far more",
            },
        ]
        found.append(
            {
                "what": f"pieces of {name!r} that lay tight in one another press each other apart by no more than stood on them",
                "effect": "faces that crumble carry no more than their bonds bore",
            }
        )
        found += _together(candidate, name)
        found += _blown(candidate, name)
        if name in candidate.built:
            found.append(
                {
                    "what": f"faces of {name!r} crumble over {crumble_of(entity.breakable, candidate.built[name]):.2g} m",
                    "effect": "broken pieces may lie that deep in one another; the dust has no mass of its own",
                }
            )
            found += _crumbles(name, entity.breakable, candidate.built[name])
    return found


def _crumbles(name: str, breakable: Breakable, built: BuiltEntity) -> list[dict[str, str]]:
    """Crumble that is declared larger than it is by default."""
    bond = breakable.bond
    usual = crumble_of(breakable.model_copy(update={"bond": bond.model_copy(update={"crumble": None})}), built)
    if bond.crumble is None or not bond.crumble > usual > 0.0:
        return []
    what = f"crumble of {name!r} is {bond.crumble:g} m, {times(bond.crumble, usual)} m"
    return [{"what": what, "effect": "its pieces may lie as deep in one another"}]


def _together(candidate: Candidate, name: str) -> list[dict[str, str]]:
    """Bonds around the worst one that go with it in one step, though its breaking might have eased them."""
    bonds = candidate.built[name].bonds if name in candidate.built else None
    if bonds is None or not len(bonds):
        return []
    inner = bonds.pieces[:, 1] != WORLD
    count = np.bincount(np.concatenate([bonds.pieces[:, 0], bonds.pieces[inner, 1]]))
    most = int((count[bonds.pieces[:, 0]] - 1 + np.where(inner, count[bonds.pieces[:, 1]] - 1, 0)).max())
    return [
        {
            "what": f"bonds of {name!r} at the two pieces of the one that is loaded most break with it where they bear more than their "
            f"strength and more than {TOGETHER:g} of its share",
            "effect": f"up to {most} of the {len(bonds)} bonds go at once that may have held, had the load been found anew after each",
        }
    ]


def _blown(candidate: Candidate, name: str) -> list[dict[str, str]]:
    """Lines about fields: they load no bonds, and air meets pieces that stand behind one another."""
    fields = fields_of(candidate.spec, name)
    if not fields:
        return []
    listed = ", ".join(fields.names)
    found = [
        {
            "what": f"fields ({listed}) load no bonds of {name!r}",
            "effect": "no wind breaks it, however strong; what it blows against it may",
        }
    ]
    if fields.has_medium and name in candidate.built:
        built = candidate.built[name]
        pieces = [(b.pose, np.concatenate([p.render.vertices for p in built.parts_of(b.name)])) for b in built.bodies]
        single = sum(_area(points) for _, points in pieces)
        whole = _area(np.concatenate([pose.apply(points) for pose, points in pieces]))
        found.append(
            {
                "what": f"air of {listed} meets every piece of {name!r} as if it stood alone",
                "effect": "while it is whole, and in heaps, it is pushed too hard, as a mean over all directions up to "
                f"{single / max(whole, 1e-300):.1f} times as hard",
            }
        )
    return found


def _area(points: F64) -> float:
    """Surface of the convex hull of points [m^2]: what bodies show to the flow is a quarter of it, as a mean over directions (Cauchy)."""
    return float(np.linalg.norm(area_vectors(points), axis=1).sum())
