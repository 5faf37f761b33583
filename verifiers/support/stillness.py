"""Which entities never move."""

from __future__ import annotations

import numpy as np

from ...worlds.arrays import pose_of
from ...worlds.spec import PathDriver, WorldSpec
from .bounds import TURNED

__all__ = ["is_still"]


def is_still(spec: WorldSpec, name: str) -> bool:
    """True if an entity never moves: it is static, or kinematic and its path stays in one place."""
    entity = spec.entities[name]
    if entity.motion != "kinematic":
        return entity.motion == "static"
    for driver in spec.simulation.drivers.values():
        if isinstance(driver, PathDriver) and driver.entity == name:
            places = [pose_of(key.pose) for key in driver.keys.values()]
            first = places[0]
            way = max(float(np.linalg.norm(p.position - first.position)) for p in places)
            # The two signs of a quaternion are one rotation.
            turn = max(1.0 - abs(float(p.quaternion @ first.quaternion)) for p in places)
            if way > spec.simulation.limits.support_drift or turn > 0.5 * TURNED**2:
                return False
    return any(isinstance(d, PathDriver) and d.entity == name for d in spec.simulation.drivers.values())
