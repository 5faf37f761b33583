"""Corrections of an overlap: what makes contact impossible first, then a wrong start, then resolution."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...worlds.categories.fracture.audit import crumble_limit
from ...worlds.categories.fracture.pieces import crumble_of
from ...worlds.categories.registry import CATEGORIES
from ..rows.corrections import LEAST_STEP, correction, pointer, set_value
from .bounds import CRUMBLE_FACTOR, SKIN_FACTOR, SKIN_MAX, SKIN_SHARE

if TYPE_CHECKING:
    from ...worlds.requirements import Correction
    from ...worlds.spec import WorldSpec
    from ..scene.surfaces import Surfaces

__all__ = ["filled_corrections", "finer_contact", "not_colliding", "overlap_corrections", "solver_of", "standing_out"]

Pair = tuple[str, str]


def solver_of(surfaces: Surfaces, *entities: str) -> str | None:
    """The rigid instance that has all of the entities as members; None where none has."""
    for name, solver in surfaces.candidate.spec.simulation.rigid.items():
        if set(entities) <= set(solver.members):
            return name
    return None


def standing_out(surfaces: Surfaces, entity: str) -> float:
    """Largest distance of an entity's collision surface outside the visible one [m]."""
    return max((part.deviation[0] for part in surfaces.candidate.entity(entity).parts), default=0.0)


def filled_corrections(surfaces: Surfaces, order: Pair) -> list[Correction]:
    """Ranked: let what is drawn collide instead of its hull, that of the body first whose collision stands out the farthest."""
    found = []
    for entity in sorted(order, key=lambda n: -standing_out(surfaces, n)):
        for name, part in surfaces.candidate.spec.entities[entity].parts.items():
            if part.shape.kind == "mesh" and part.shape.collision == "hull":
                path = pointer("entities", entity, "parts", name, "shape", "collision")
                found.append(
                    correction(
                        f"the hull of {entity}/{name} collides, and it fills what is drawn open",
                        "shape",
                        f"Let {entity}/{name} collide as it is drawn: collision 'decompose'.",
                        pointers=(path,),
                        patch=set_value(path, "decompose"),
                    )
                )
    return found or [
        correction(
            f"the collision of {order[0]!r} or {order[1]!r} stands out from what is drawn",
            "shape",
            f"Build {order[0]!r} and {order[1]!r} of parts that are convex, or draw what they push with.",
            pointers=tuple(pointer("entities", n, "parts") for n in order),
        )
    ]


def overlap_corrections(
    surfaces: Surfaces, order: Pair, parts: tuple[Pair, Pair], bad: NDArray[np.intp], depth: float, *, tunnel: bool
) -> list[Correction]:
    """Ranked: what makes contact impossible first, then a wrong start, then resolution."""
    mover, other = order
    spec = surfaces.candidate.spec
    found = not_colliding(surfaces, parts)
    if any(c.group == "shape" for c in found):
        return found  # what does not collide passes through at any step
    if bad[0] == 0:
        found.append(
            correction(
                "the two overlap before anything moves",
                "placement",
                f"Move {mover!r} by {depth * 1e3:.4g} mm out of {other!r}; see the row interpenetration:{mover}:{other}.",
                pointers=(pointer("entities", mover, "pose"),),
            )
        )
    if spec.entities[mover].motion == "kinematic":
        plan = spec.simulation.drivers
        drivers = [pointer("simulation", "drivers", n) for n, d in plan.items() if getattr(d, "entity", "") == mover]
        found.append(
            correction(
                f"the authored path of {mover!r} leads through {other!r}",
                "drivers",
                f"Change the path of {mover!r} near frame {bad[0]} to stay {depth * 1e3:.4g} mm farther from {other!r}.",
                pointers=tuple(drivers),
            )
        )
    solver = solver_of(surfaces, mover, other)
    if solver is None:
        found.append(
            correction(
                "no solver instance has both as members, so they cannot feel each other",
                "shape",
                f"List {mover!r} and {other!r} as members of one solver instance.",
                pointers=("/simulation/solvers",),
            )
        )
        return found
    return [*found, *_crumbled(surfaces, order, depth), *finer_contact(surfaces, solver, depth, tunnel=tunnel)]


def not_colliding(surfaces: Surfaces, parts: tuple[Pair, Pair]) -> list[Correction]:
    """Reasons why the engine does not keep two entities apart at all, given the part of each that overlaps."""
    spec = surfaces.candidate.spec
    found = []
    for entity, part in parts:
        content = spec.entities[entity].parts.get(part)
        if content is not None and not content.collides:
            path = pointer("entities", entity, "parts", part, "collides")
            found.append(
                correction(
                    f"part {part!r} of {entity!r} does not collide",
                    "shape",
                    f"Let {entity}/{part} collide, or move it out of the way.",
                    pointers=(path,),
                    patch=set_value(path, True),
                )
            )
    for name, joint in spec.simulation.joints.items():
        if {joint.parent, joint.child} == {entity for entity, _ in parts} and getattr(joint, "collide", True) is False:
            path = pointer("simulation", "joints", name, "collide")
            found.append(
                correction(
                    f"joint {name!r} switches contacts between its two bodies off",
                    "joints",
                    f"Set `collide` of joint {name!r}, or declare the overlap at the joint as `fastened` with its depth.",
                    pointers=(path,),
                    patch=set_value(path, True),
                )
            )
    return found


def _crumbled(surfaces: Surfaces, order: Pair, depth: float) -> list[Correction]:
    """Let faces crumble as far as pieces of one body were pressed together, where the audit allows it."""
    entity = surfaces.candidate.spec.entities[order[0]]
    if order[0] != order[1] or entity.breakable is None:
        return []
    most, now = crumble_limit(entity), crumble_of(entity.breakable, surfaces.candidate.entity(order[0]))
    if depth > most:
        return []
    path = pointer("entities", order[0], "breakable", "bond", "crumble")
    wanted = math.floor(min(most, CRUMBLE_FACTOR * depth) * 1e6) / 1e6
    return [
        correction(
            f"pieces of {order[0]!r} are pressed together further than the {now * 1e3:.4g} mm that their faces crumble",
            "bonds",
            f"Let faces crumble over {wanted * 1e3:.4g} mm, the overlap and some to spare; at most {most * 1e3:.4g} mm.",
            pointers=(path,),
            patch=set_value(path, wanted),
        )
    ]


def _refused(spec: WorldSpec, solver: str, skin: float) -> bool:
    """True if the schema or the audit would not take this skin [m]."""
    # Two skins must stay below the contact tolerance.
    if skin > min(SKIN_MAX, SKIN_SHARE * spec.simulation.limits.contact_gap / 2):
        return True
    rigid = spec.simulation.rigid[solver]
    wider = rigid.model_copy(update={"settings": rigid.settings.model_copy(update={"skin": skin})})
    plan = spec.simulation.model_copy(update={"solvers": {**spec.simulation.solvers, solver: wider}})
    changed = spec.model_copy(update={"simulation": plan})
    place = pointer("simulation", "solvers", solver, "settings", "skin")
    audits = [c.audit for c in CATEGORIES.values() if c.audit is not None]
    return any(p.pointer == place for audit in audits for p in audit.problems(changed))


def finer_contact(surfaces: Surfaces, solver: str, depth: float, *, tunnel: bool) -> list[Correction]:
    """A thicker skin and a shorter step, the one first that suits a pass through (`tunnel`) or a mere overlap of `depth` [m]."""
    settings = surfaces.candidate.spec.simulation.rigid[solver].settings
    path = pointer("simulation", "solvers", solver, "settings")
    skin = math.ceil((settings.skin + SKIN_FACTOR * depth) * 1e5) / 1e5
    wider = correction(
        "the collision skin is thinner than the overlap that one step allows",
        "contact",
        f"Raise the skin of solver {solver!r} from {settings.skin * 1e3:.4g} mm to {skin * 1e3:.4g} mm "
        f"(+ {SKIN_FACTOR:g} x the overlap of {depth * 1e3:.4g} mm).",
        pointers=(path + "/skin",),
        patch=set_value(path + "/skin", skin),
    )
    offered = [] if _refused(surfaces.candidate.spec, solver, skin) else [wider]
    step = max(LEAST_STEP["step"], settings.step / (4.0 if tunnel else 2.0))
    if step == settings.step and (settings.speculative or not tunnel):
        return offered
    finer = correction(
        "the bodies pass through each other within few steps" if tunnel else "the step is too long for this contact",
        "step",
        f"Cut the step of solver {solver!r} from {settings.step:g} s to {step:g} s"
        + (" and switch `speculative` contacts on." if tunnel and not settings.speculative else "."),
        pointers=(path + "/step", path + "/speculative"),
        patch=set_value(path + "/step", step) + (set_value(path + "/speculative", True) if tunnel else ()),
    )
    return [finer, *offered] if tunnel else [*offered, finer]
