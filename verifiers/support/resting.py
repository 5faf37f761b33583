"""Judges whether a body that is to stay where it is at frame 0 can: it does not tip, and friction suffices."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ...worlds.arrays import F64
from ..rows.answers import row_of
from ..rows.corrections import correction, let_settle, move_by, pointer, set_value
from ..rows.findings import Finding
from .bounds import LEVEL_CONTACT, MISSING, OUTSIDE
from .equilibrium import Balance, Group, solve
from .graph import group_of, rolling
from .questions import BALANCE, GRIP
from .touching import hull_corners

if TYPE_CHECKING:
    from ...worlds.requirements import Row
    from ..scene.surfaces import Surfaces
    from .graph import SupportGraph

__all__ = ["outside", "rest_rows"]

SPARE = 1.2
"""[1] Own choice: a suggested friction is this much more than what would just do, and is looked for in steps of it."""
LEAST_FRICTION, MOST_FRICTION = 0.1, 1.2
"""[1] Own choice: where the search begins; rubber on a dry road, beyond which no friction is suggested."""


def rest_rows(graph: SupportGraph, entity: str, claimed: Sequence[str]) -> list[Row]:
    """Rows `support:balance` and `support:grip` of one body at frame 0; none where joints or drivers hold it.

    Args:
        graph: of the first frame.
        entity: the body.
        claimed: every body that is said to stay.
    """
    surfaces = graph.surfaces
    surfaces.require(entity)
    found = _balances(graph, entity, claimed)
    if found is None:
        return []
    group, balance, way = found
    touched = [c[1] if c[0] == entity else c[0] for c in group.contacts if entity in c[:2] and len(c[2].points)]
    if not touched:
        return []  # the relation's own row says that nothing carries it
    concerned = (entity, *touched)
    proof = {"carriers": touched, "group": list(group.members)[:20]}
    answers = (
        (BALANCE, _tips(surfaces, concerned, balance.shift, way)),
        (GRIP, _grip(surfaces, concerned, balance.missing, _rougher(surfaces, group, entity, claimed, balance.missing))),
    )
    candidate = surfaces.candidate
    return [row_of(candidate, q, (entity,), replace(f, evidence=proof, frames=(0, 0)), entities=concerned) for q, f in answers]


def _tips(surfaces: Surfaces, concerned: tuple[str, ...], shift: float, way: F64) -> Finding:
    entity, *touched = concerned
    bound = OUTSIDE + max(rolling(surfaces, n) for n in concerned)
    # Contact of what is sunk lies at its rim: only out of there it shows where it stands.
    sunk = any(surfaces.first.get((a, b), 0.0) < -surfaces.noise(a, b) for t in touched for a, b in ((entity, t), (t, entity)))
    where = f"{abs(shift) * 1e3:.4g} mm {'outside' if shift > 0 else 'inside'}"
    ok = shift <= bound
    return Finding(
        "pass" if ok else "fail",
        f"the centre of mass of {entity!r} lies {where} of where contact with {', '.join(touched)} can hold it",
        shift,
        bound,
        hints=()
        if ok
        else (
            move_by(
                surfaces.candidate,
                entity,
                None if sunk else way,
                f"{entity!r} overhangs its support and tips over",
                f"Take {entity!r} out of its support first, which its row interpenetration tells of."
                if sunk
                else f"Move {entity!r} at least {shift * 1e3:.4g} mm towards the middle of its support, or widen that.",
            ),
            *let_settle(surfaces.candidate, entity),
        ),
        predicate=f"the centre of mass of {entity}, seen along gravity, lies within {bound:g} m of where its contacts can hold it",
    )


def _rougher(surfaces: Surfaces, group: Group, entity: str, claimed: Sequence[str], missing: float) -> float | None:
    """Friction of its material with which a body that slips would rest, with some to spare; None where none does."""
    spec = surfaces.candidate.spec
    material = spec.materials.get(spec.entities[entity].material)
    if missing <= MISSING or material is None:
        return None
    friction = max(LEAST_FRICTION, material.friction_at_rest)
    while friction < MOST_FRICTION:
        friction = min(MOST_FRICTION, SPARE * friction)
        tried = tuple(
            (a, b, c._replace(friction=np.maximum(c.friction, friction)) if entity in (a, b) else c) for a, b, c in group.contacts
        )
        if solve(replace(group, contacts=tried), claimed=claimed, shift=OUTSIDE)[entity].missing <= MISSING:
            return float(f"{min(MOST_FRICTION, SPARE * friction):.2g}")
    return None


def _grip(surfaces: Surfaces, concerned: tuple[str, ...], missing: float, enough: float | None) -> Finding:
    """The finding about friction; `enough` of the body's material would hold it [1], None where no friction does."""
    spec, entity, ok = surfaces.candidate.spec, concerned[0], missing <= MISSING
    materials = dict.fromkeys(spec.entities[n].material for n in concerned)
    place = pointer("materials", spec.entities[entity].material, "friction")
    raised = "or" if enough is None else f"to {enough:g}, or"
    return Finding(
        "pass" if ok else "fail",
        f"contact and friction lack {missing:.2%} of the weight of {entity!r}",
        missing,
        MISSING,
        hints=()
        if ok
        else (
            correction(
                f"{entity!r} slides: its support is too steep or too smooth",
                "material",
                f"Raise the friction of {' or '.join(map(repr, materials))} {raised} make the support less steep.",
                pointers=tuple(pointer("materials", m, "friction") for m in materials),
                patch=() if enough is None else set_value(place, enough),
            ),
        ),
        predicate=f"contact forces within friction bear {entity} at rest: at most {MISSING:g} of its weight is missing",
        extra=[[spec.materials[m].friction_at_rest for m in materials if m in spec.materials], list(spec.simulation.gravity)],
    )


def _balances(graph: SupportGraph, entity: str, claimed: Sequence[str]) -> tuple[Group, Balance, F64] | None:
    """The body's group, what it lacks, and a way [m] to the middle of its support; each group is solved once."""
    known = graph.resting
    if entity not in known:
        group = group_of(graph, entity, 0)
        if group is None:
            return None
        simple = _standing(group)
        if simple:
            found = {entity: simple[0]}
        elif graph.rest_together(group.members, 0):
            found = {m: Balance(0.0, np.zeros(3), 0.0) for m in group.members}
        else:
            found = solve(group, claimed=claimed, shift=OUTSIDE)
        for name, balance in found.items():
            known[name] = (group, balance, simple[1] if simple else _middle(group, name, balance))
    return known[entity]


def _standing(group: Group) -> tuple[Balance, F64] | None:
    """A single body on level contacts: rests where its centre of mass is above their polygon, whatever the friction.

    Returns its signed distance to the polygon, negative inside, and the way to its middle; None for all other cases.
    """
    contacts = [c for c in group.contacts if len(c[2].points)]
    if len(group.members) > 1 or not contacts:
        return None
    signs = [1.0 if c[0] == group.members[0] else -1.0 for c in contacts]
    normals = np.concatenate([s * c[2].normals for s, c in zip(signs, contacts, strict=True)])
    if (normals @ group.down > -np.sqrt(1.0 - LEVEL_CONTACT * LEVEL_CONTACT)).any():
        return None
    side = np.linalg.svd(group.down[None])[2][1:]
    flat = (np.concatenate([c[2].points for c in contacts]) - group.centers[0]) @ side.T
    back = np.asarray(flat.mean(axis=0) @ side)
    return Balance(outside(flat), back, 0.0), back


def _middle(group: Group, entity: str, balance: Balance) -> F64:
    """Twice the least way, but at least that and the allowance: to where it stands surely."""
    length = float(np.linalg.norm(balance.way))
    return balance.way * (1.0 + max(1.0, OUTSIDE / length)) if length > 0.0 else balance.way


def outside(points: F64) -> float:
    """Signed distance of the origin outside the convex hull of points in the plane [m]; negative inside."""
    corners = points[hull_corners(points)]
    ahead = np.roll(corners, -1, axis=0)
    along = ahead - corners
    square = np.maximum(np.einsum("ni,ni->n", along, along), np.finfo(float).tiny)
    t = np.clip(-np.einsum("ni,ni->n", corners, along) / square, 0.0, 1.0)
    distance = float(np.linalg.norm(corners + t[:, None] * along, axis=1).min())
    turns = along[:, 0] * -corners[:, 1] - along[:, 1] * -corners[:, 0]
    inside = len(corners) > 2 and ((turns > 0.0).all() or (turns < 0.0).all())
    return -distance if inside else distance
