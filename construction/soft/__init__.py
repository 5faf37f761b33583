"""Simulation meshes of elastic bodies: tetrahedra that fill the visible solid, on a lattice of cells."""

from .build import soft_part
from .lattice import LATTICE_CELLS, cells_of

__all__ = ["LATTICE_CELLS", "cells_of", "soft_part"]
