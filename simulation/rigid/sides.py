"""The two sides of a contact as one number each: geoms first, deforming bodies after them."""

from __future__ import annotations

from typing import Any

import numpy as np

__all__ = ["sides_of"]


def sides_of(model: Any, contact: Any) -> Any:
    """Sides of every contact, shape (n, 2): index of the geom, or number of geoms + index of the elastic body."""
    geoms = contact.geom
    return np.where(geoms >= 0, geoms, model.ngeom + model.flex_group[contact.flex]) if model.nflex else geoms
