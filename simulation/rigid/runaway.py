"""Words for a motion that ran away: MuJoCo gives up where nothing is where it can be."""

from __future__ import annotations

from typing import Any

import numpy as np

__all__ = ["gave_up"]

RUNAWAY = 1e3
"""[m/s, rad/s] Own choice: a speed beyond which a motion ran away."""


def gave_up(model: Any, data: Any, error: Exception, *, frame: int, step: float, solver: str) -> str:
    """Text of an error of the engine: the body that is fastest, and what to change.

    Args:
        model: of MuJoCo.
        data: its state, as the error left it.
        error: what it said.
        frame: that was to be reached.
        step: in force [s].
        solver: id of the instance.
    """
    speeds = np.nan_to_num(np.abs(data.qvel), nan=np.inf)
    fastest = int(speeds.argmax()) if len(speeds) else 0
    place = f"/simulation/solvers/{solver}/settings/step"
    if not len(speeds) or speeds[fastest] < RUNAWAY:
        said = str(error).splitlines()[0]
        return f"the rigid engine gave up at frame {frame} ({said}); fewer collision pieces near each other help, or a shorter {place} than {step:g} s"
    name = model.body(int(model.dof_bodyid[fastest])).name
    return (
        f"the motion of {name!r} ran away before frame {frame} ({speeds[fastest]:.3g} m/s or rad/s at a step of {step:g} s), so that the rigid engine gave "
        f"up. Thin or light links that are pinched, stiff springs and strong motors do that: give a rope a larger radius and fewer segments, a "
        f"spring more damping, or halve {place}"
    )
