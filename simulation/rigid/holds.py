"""Bodies that nothing moves: held ones and those on authored paths.

They stay free bodies of the model, with an armature so large that no contact moves them, so that contacts see their
velocity and a release changes no structure. Everything MuJoCo derives from inertia is kept consistent with that:
`dof_M0` (simple bodies use it instead of the armature), `body_invweight0` (scales the softness of contacts) and the
tolerance (the solver divides by the trace of the inertia).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ...worlds.arrays import F64

__all__ = ["DEALT", "FIXED", "HOLD_FACTOR", "MOVING", "Holds"]

HOLD_FACTOR = 1e6
"""Armature of a fixed body, in multiples of the heaviest moving body: contacts see a fixed body to 1e-6. Poses of fixed
bodies are written anew in every step (paths) or frame (holds), so that nothing adds up."""
DEALT = 1 << 29
"""contype of flexes that hold a part of an elastic body's surface, which all geoms meet and no other flex does."""
MOVING, FIXED = (1, 3 | DEALT), (2, 1 | DEALT)
"""contype and conaffinity: moving bodies meet everything, fixed ones only moving ones."""
NEVER = -1e6
"""Margin [m] of an explicit pair of two fixed bodies: no contact is ever that deep."""


class Holds:
    """Writes what is fixed into the model.

    Args:
        model: the compiled model; static geoms already carry `FIXED`.
        dofs: degrees of freedom per moving entity.
        bodies: MuJoCo bodies per moving entity.
    """

    def __init__(self, model: Any, dofs: dict[str, list[int]], bodies: dict[str, list[int]]) -> None:
        self.model, self.dofs, self.bodies = model, dofs, bodies
        self._armature, self._m0 = model.dof_armature.copy(), model.dof_M0.copy()
        self._invweight = model.body_invweight0.copy()
        self._pair_margin = model.pair_margin.copy()
        self._tolerance = float(model.opt.tolerance)
        moving = np.array(sorted({b for group in bodies.values() for b in group}), dtype=np.int64)
        masses = model.body_mass[moving]
        self._lightest, heaviest = float(masses.min(initial=np.inf)), float(masses.max(initial=0.0))
        self._weight = np.zeros(model.nv)
        reach = np.zeros(model.nbody)
        np.maximum.at(reach, model.geom_bodyid, model.geom_rbound + np.linalg.norm(model.geom_pos, axis=1))
        for dof in range(model.nv):
            joint = model.dof_jntid[dof]
            turns = model.jnt_type[joint] in (1, 3) or (model.jnt_type[joint] == 0 and dof - model.jnt_dofadr[joint] >= 3)
            arm = float(reach[model.dof_bodyid[dof]]) if turns else 1.0
            self._weight[dof] = HOLD_FACTOR * heaviest * max(arm, 1e-3) ** 2
        self.geoms = {e: np.flatnonzero(np.isin(model.geom_bodyid, b)) for e, b in bodies.items()}
        self.fixed: frozenset[str] | None = None

    def armature(self, dofs: Any) -> F64:
        """Armature of fixed degrees of freedom [kg or kg m^2]."""
        return np.asarray(self._weight[dofs])

    def fix(self, fixed: frozenset[str]) -> None:
        """Fix these entities and free all others."""
        if fixed == self.fixed:
            return
        self.fixed, model = fixed, self.model
        model.dof_armature[:], model.dof_M0[:] = self._armature, self._m0
        model.body_invweight0[:] = self._invweight
        for entity, dofs in self.dofs.items():
            held = entity in fixed
            contype, affinity = FIXED if held else MOVING
            model.geom_contype[self.geoms[entity]], model.geom_conaffinity[self.geoms[entity]] = contype, affinity
            model.body_contype[self.bodies[entity]], model.body_conaffinity[self.bodies[entity]] = contype, affinity
            if held:
                model.dof_armature[dofs] += self._weight[dofs]
                model.dof_M0[dofs] += self._weight[dofs]
                model.body_invweight0[self.bodies[entity]] = 0.0
        model.pair_margin[:] = self._pair_margin
        if model.npair:
            both = (model.geom_contype[model.pair_geom1] == FIXED[0]) & (model.geom_contype[model.pair_geom2] == FIXED[0])
            model.pair_margin[both] = NEVER
        extra = float(sum(self._weight[self.dofs[e]].sum() for e in fixed))
        native = 3.0 * self._lightest
        model.opt.tolerance = self._tolerance * (native / (native + extra)) if extra > 0 else self._tolerance
