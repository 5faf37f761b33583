"""MuJoCo's integration state as an array."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...worlds.arrays import F64

__all__ = ["read_state", "write_state"]


def read_state(model: Any, data: Any) -> F64:
    """MuJoCo's integration state."""
    import mujoco

    spec = int(mujoco.mjtState.mjSTATE_INTEGRATION)
    state = np.empty(mujoco.mj_stateSize(model, spec))
    mujoco.mj_getState(model, data, state, spec)
    return state


def write_state(model: Any, data: Any, state: F64) -> None:
    """Continue from an integration state.

    Raises:
        ValueError: it belongs to another model.
    """
    import mujoco

    spec = int(mujoco.mjtState.mjSTATE_INTEGRATION)
    if len(state) != (size := mujoco.mj_stateSize(model, spec)):
        raise ValueError(f"{len(state)} numbers for a model of {size}")
    mujoco.mj_resetData(model, data)
    mujoco.mj_setState(model, data, state, spec)
