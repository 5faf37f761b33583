"""The engines: which solver runs an instance. A new one is a folder beside these and a line here."""

from __future__ import annotations

from collections.abc import Mapping
from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ..worlds.spec import WorldSpec

__all__ = ["ENGINES", "solver_class"]

ENGINES: Mapping[str, tuple[str, str]] = {
    "mujoco": (".rigid.solver", "SolverRigid"),
    "dfsph": (".liquid.solver", "SolverLiquid"),
    "flip": (".liquid.solver", "SolverLiquid"),
    "gas": (".gas.solver", "SolverGas"),
    "shell": (".cloth.solver", "SolverCloth"),
    "dem": (".particles.solver", "SolverGrains"),
    "ballistic": (".particles.flight", "SolverFlight"),
}
"""Module and class of the solver of each engine that an instance can name. Loaded when needed: they compile kernels.

`SolverRigid` is made from (spec, built, name, *, intervention, media, coupled: whether others push its bodies); every other one is a
`coupled_solver.CoupledSolver`, made from (spec, built, name, *, intervention, media, recipe, caches: of the instances that it reads; None where
a coupling tells it the bodies).
"""


def solver_class(spec: WorldSpec, name: str) -> Any:
    """The class of the solver of an instance."""
    module, solver = ENGINES[spec.simulation.solvers[name].engine]
    return getattr(import_module(module, __package__), solver)
