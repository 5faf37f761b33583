"""Lines of the approximation register about elastic bodies (R62, R68)."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from ....worlds.instances import coupled_groups, soft_met
from ....worlds.spec import ElasticPhysics
from ...ledgers.exchanged import partners

if TYPE_CHECKING:
    from ....worlds.candidate import Candidate
    from ....worlds.spec import WorldSpec

__all__ = ["elastic_lines"]

LOST = 0.5 * (2 * math.pi) ** 2
"""Loss of a swing of 1 Hz per second and second of step: implicit positions of first order take w^2 h / 2 (measured:
tests/physics/test_elastic.py)."""
CELLS_FOR_SELF = 3
"""Cells along an axis from which on parts of one body are kept apart."""
SURFACE = 1e-6
"""Relative difference of volumes from which on a cut surface is another than the declared one."""


def elastic_lines(candidate: Candidate) -> list[dict[str, str]]:
    """Lines of every elastic body."""
    found: list[dict[str, str]] = []
    entities = candidate.spec.entities
    soft = {n: e.physics for n, e in entities.items() if isinstance(e.physics, ElasticPhysics)}
    for name, physics in soft.items():
        cells = _cells(candidate, name)
        found.append(
            {
                "what": f"{name!r} deforms on {cells} cells with quadratic displacements, its strain linear in a frame that turns with each",
                "effect": "beams of one cell across are up to 5 % too stiff; beyond strains of about 0.3 it is not rubber",
            }
        )
        found += _steps(candidate, name) + _touches(candidate, name)
        lost = _lost(candidate, name)
        if lost > SURFACE:
            found.append(
                {
                    "what": f"the surface of {name!r} is that of its simulation mesh",
                    "effect": f"it holds {lost:.2%} less or more than the declared solid; mass is that of the solid",
                }
            )
        if physics.yield_strain > 0:
            found.append(
                {
                    "what": f"{name!r} yields at an elastic strain of {physics.yield_strain:g}, one strain per cell",
                    "effect": "dents smaller than a cell come back; recorded strain energy counts what yielding dissipated as stored",
                }
            )
    if soft:
        first = next(iter(soft))
        found += _met(candidate, first)
    return found


def _steps(candidate: Candidate, name: str) -> list[dict[str, str]]:
    """Lines about the damping of its swings by implicit steps."""
    steps = [i.settings.step for i in candidate.spec.simulation.rigid.values() if name in i.members]
    return [
        {
            "what": f"implicit steps of {name!r} are up to {step:g} s long and damp it beside its own damping",
            "effect": f"a swing of 1 Hz loses {LOST * step:.2%} of its amplitude in a second, of 5 Hz 25 times that",
        }
        for step in steps
    ]


def _touches(candidate: Candidate, name: str) -> list[dict[str, str]]:
    """Lines about its contacts with others and with itself."""
    found = [
        {
            "what": f"what touches {name!r} meets its nodes, each alone; restitution is theirs, not the body's",
            "effect": "the coarser the cells, the more energy an impact takes; how high it bounces follows from stiffness and damping",
        }
    ]
    meshes = [p.simulation for p in candidate.entity(name).parts if p.simulation is not None]
    if meshes and max(int(c) for c in meshes[0].cells) < CELLS_FOR_SELF:
        found.append(
            {
                "what": f"{name!r} does not meet itself: it has fewer than {CELLS_FOR_SELF} cells along every axis",
                "effect": f"folds pass through each other; category:elastic:self:{name} finds them",
            }
        )
    return found


def _met(candidate: Candidate, first: str) -> list[dict[str, str]]:
    """Who meets elastic bodies, and how."""
    found, spec = [], candidate.spec
    for name, instance in spec.simulation.solvers.items():
        if name in spec.simulation.rigid:
            continue
        if not soft_met(spec, name):
            text = f"{instance.moves[0]} of {name!r} does not meet elastic bodies ({first!r})"
            text += "; of engine dfsph it would" if instance.engine == "flip" else ""
            found.append({"what": text, "effect": "omitted in both directions: they pass through each other"})
        elif any(name in group for group in coupled_groups(spec)):
            text = f"{name!r} takes the surfaces of elastic bodies as giving way like their vertices alone within an exchange"
            found.append({"what": text, "effect": f"energy that the exchange makes or loses is told by {_told_by(spec, name)}"})
        else:
            text = f"{name!r} is pushed by elastic bodies ({first!r}) and does not push them"
            found.append({"what": text, "effect": "omitted reaction: they fall through what cannot hold them back"})
    return found


def _told_by(spec: WorldSpec, name: str) -> str:
    """Id of the row that judges the energy of an instance coupled with elastic bodies."""
    plan = spec.simulation
    if name in plan.liquid or name in plan.particles:
        return f"category:{plan.solvers[name].moves[0]}:energy:{name}"
    owner = next((r for r in plan.rigid if name in partners(spec, r)), None)
    if owner is not None and all(other in plan.cloth for other in partners(spec, owner)):
        return f"category:elastic:together:{owner}"
    return f"category:cloth:energy:{name}"


def _cells(candidate: Candidate, name: str) -> str:
    meshes = [p.simulation for p in candidate.entity(name).parts if p.simulation is not None]
    return " x ".join(str(int(c)) for c in meshes[0].cells) if meshes else "no"


def _lost(candidate: Candidate, name: str) -> float:
    """Share of the declared volume that the simulation mesh misses."""
    from ....worlds.simulation_mesh import volumes

    built = candidate.entity(name)
    held = sum(float(volumes(p.simulation.vertices, p.simulation.tets).sum()) for p in built.parts if p.simulation is not None)
    return abs(held / sum(b.volume for b in built.bodies) - 1.0)
