"""Rigid bodies on MuJoCo."""

from .solver import SolverRigid

__all__ = ["SolverRigid"]
