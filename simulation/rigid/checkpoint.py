"""MuJoCo's integration state as an array."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...worlds.arrays import F64
from ...worlds.errors import EngineError
from ..sealed import from_bytes, to_bytes
from .distances import settle_kinematics

__all__ = ["at_rest", "lay_down", "read_state", "write_state"]


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


def at_rest(data: Any, relaxation: float) -> bytes:
    """The coordinates of a state, and what contacts bear in it, without its speeds; `relaxation`: how far skins were opened [m]."""
    return to_bytes({"qpos": data.qpos, "forces": data.qacc_warmstart, "relaxation": np.float64(relaxation)})


def lay_down(model: Any, data: Any, state: bytes) -> float:
    """Start from a state at rest; returns its relaxation [m].

    Raises:
        EngineError: the bytes are no such state, or of other bodies.
    """
    found = from_bytes(state, ("qpos", "forces", "relaxation"))
    if len(found["qpos"]) != model.nq or len(found["forces"]) != model.nv:
        raise EngineError(f"a settled state of {len(found['qpos'])} coordinates for bodies of {model.nq}; probe again")
    data.qpos[:], data.qvel[:], data.qacc_warmstart[:] = found["qpos"], 0.0, found["forces"]
    settle_kinematics(model, data)
    return float(found["relaxation"])
