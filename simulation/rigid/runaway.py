"""Words for a motion that ran away: MuJoCo gives up where nothing is where it can be."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...worlds.errors import EngineError

__all__ = ["gave_up"]

TOUCHING = 8
"""Entities that an error names at most."""
RUNAWAY = 1e3
"""[m/s, rad/s] Own choice: a speed beyond which a motion ran away."""


def gave_up(model: Any, data: Any, error: Exception, *, frame: int, step: float, solver: str) -> EngineError:
    """An error of the engine in words: the body that is fastest, what touches it, and what to change.

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
        text = f"the rigid engine gave up at frame {frame} ({said}); fewer collision pieces near each other help, or a shorter {place} than {step:g} s"
        return EngineError(text, where={"solver": solver, "frame": frame})
    body = int(model.dof_bodyid[fastest])
    name = model.body(body).name
    text = (
        f"the motion of {name!r} ran away before frame {frame} ({speeds[fastest]:.3g} m/s or rad/s at a step of {step:g} s), so that the rigid engine gave "
        f"up. Thin or light links that are pinched, stiff springs and strong motors do that: give a rope a larger radius and fewer segments, a "
        f"spring more damping, or halve {place}"
    )
    at = [float(v) for v in data.xpos[body]]
    where = {
        "solver": solver,
        "frame": frame,
        "entities": _with(model, data, body),
        "place": at if np.isfinite(at).all() else None,
    }
    return EngineError(text, where=where)


def _with(model: Any, data: Any, body: int) -> list[str]:
    """Entity of a body, then those that it touches in the last step."""
    pairs = model.geom_bodyid[data.contact.geom[: data.ncon]] if data.ncon else np.zeros((0, 2), dtype=int)
    touching = pairs[(pairs == body).any(axis=1)].ravel().tolist()
    names = [model.body(int(b)).name.partition("/")[0] for b in (body, *touching)]
    return [n for n in dict.fromkeys(names) if n and n != "world"][:TOUCHING]
