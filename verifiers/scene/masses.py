"""Declared masses against what the visible volume of a body may weigh of its substances (R154).

The audit asks this of shapes whose volume the specification tells; meshes from files are known only once they are built.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ...worlds.errors import EvidenceError
from ...worlds.spec import RigidPhysics
from ...worlds.weights import LEAST_WALL, ROUNDING, allowed
from ..rows.corrections import correction, pointer
from ..rows.findings import Finding
from .hidden import hidden_parts, nested_lumps

if TYPE_CHECKING:
    from ...worlds.built import TriangleMesh
    from ...worlds.candidate import Candidate
    from ...worlds.spec import Entity

__all__ = ["declares_mass", "mass_finding"]


def declares_mass(entity: Entity) -> bool:
    """True if an entity's mass is its own and not that of its material and volume; ropes are judged by the audit alone."""
    return isinstance(entity.physics, RigidPhysics) and entity.physics.mass is not None and entity.generator is None


def mass_finding(candidate: Candidate, name: str) -> Finding:
    """Judge whether the declared mass of an entity is one that its substances allow.

    Raises:
        EvidenceError: its surfaces bound no volume.
    """
    spec, entity = candidate.spec, candidate.spec.entities[name]
    physics = entity.physics
    assert isinstance(physics, RigidPhysics)
    assert physics.mass is not None
    built = candidate.entity(name)
    pieces, seen, hidden = [], [], hidden_parts(candidate, name)
    for part in built.parts:
        own = entity.parts.get(part.part)
        volume = _volume(part.render) - sum(abs(s.volume) for s in nested_lumps(candidate, name, part))
        if not np.isfinite(volume) or volume <= 0.0:
            raise EvidenceError(f"the surface of {name}/{part.part} bounds no volume; call place_object")
        pieces.append((volume, spec.materials[(own.material if own else None) or entity.material].substance))
        seen += [] if part.part in hidden else pieces[-1:]
    weights = allowed(pieces)._replace(most=allowed(seen).most)
    if entity.breakable is not None:  # pieces fill the body and do not lie in one another
        weights = weights._replace(least=sum(allowed([p]).least for p in pieces))
    least = weights.hollow if physics.hollow else weights.least
    heavy = physics.mass > (1.0 + ROUNDING) * weights.most
    low = (1.0 - ROUNDING) * least
    light = physics.mass < low
    volume, substances = sum(v for v, _ in pieces), " and ".join(dict.fromkeys(k for _, k in pieces))
    place = pointer("entities", name, "physics", "mass")
    shell = f", hollow with a wall of at least {LEAST_WALL:g} m" if physics.hollow else ""
    return Finding(
        "fail" if heavy or light else "pass",
        f"{name!r} weighs {physics.mass:g} kg; {volume:.4g} m^3 of {substances}{shell} weighs {least:.4g} to {weights.most:.4g} kg",
        physics.mass,
        (1.0 + ROUNDING) * weights.most if heavy else low,
        hints=(
            correction(
                "the declared mass is not that of the body's volume of its substances",
                "mass",
                f"Leave the mass of {name!r} out (density x volume), or give {least:.4g} to {weights.most:.4g} kg; "
                "a closed shell says physics.hollow true, what is open is built of thinner parts.",
                pointers=(place,),
                patch=({"op": "remove", "path": place},),
            ),
        ),
        evidence={"volume_m3": volume, "substances": substances, "least_kg": least, "most_kg": weights.most},
        comparison="<=" if heavy else ">=",
        frames=(0, 0),
        extra=physics.model_dump(mode="json"),
    )


def _volume(mesh: TriangleMesh) -> float:
    """Volume that a closed surface bounds [m^3], by the divergence theorem."""
    corners = np.asarray(mesh.vertices, dtype=np.float64)
    corner = (corners - corners.mean(axis=0))[np.asarray(mesh.faces)]
    return abs(float(np.einsum("ij,ij->i", corner[:, 0], np.cross(corner[:, 1], corner[:, 2])).sum())) / 6.0
