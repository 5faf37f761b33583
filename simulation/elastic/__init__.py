"""Elastic bodies: the lattice of quadratic cells that carries a simulation mesh."""

from .lattice import Lattice

__all__ = ["Lattice"]
