"""The bytes of a checkpoint: MAGIC, the SHA-256 of what follows, and that: a head, the contact memory, the engine's state."""

from __future__ import annotations

import hashlib
import io
import json
from typing import Any, NamedTuple

import numpy as np

from ...worlds.arrays import F64
from ...worlds.errors import EngineError

__all__ = ["Held", "pack", "read_state", "unpack", "write_state"]

MAGIC = b"WARS3"
SEAL_BYTES = 32


class Held(NamedTuple):
    """What a checkpoint holds."""

    head: dict[str, Any]
    contacts: bytes
    """Memory of the contact monitor."""
    state: F64
    """MuJoCo's integration state."""


def pack(held: Held) -> bytes:
    """The bytes of a checkpoint."""
    buffer = io.BytesIO()
    np.lib.format.write_array(buffer, held.state, allow_pickle=False)
    front = json.dumps(held.head).encode()
    sizes = len(front).to_bytes(4, "little"), len(held.contacts).to_bytes(4, "little")
    body = b"".join((sizes[0], front, sizes[1], held.contacts, buffer.getvalue()))
    return b"".join((MAGIC, hashlib.sha256(body).digest(), body))


def unpack(state: bytes, frame: int) -> Held:
    """What the checkpoint taken at `frame` holds.

    Raises:
        EngineError: the bytes are damaged, or no checkpoint of a rigid instance.
    """
    if state[: len(MAGIC)] != MAGIC:
        raise EngineError("not a checkpoint of a rigid instance; delete the candidate's checkpoints and bake again")
    start = len(MAGIC) + SEAL_BYTES
    if hashlib.sha256(state[start:]).digest() != state[len(MAGIC) : start]:
        raise EngineError(f"the checkpoint of frame {frame} is damaged; delete it and bake again")
    size = int.from_bytes(state[start : start + 4], "little")
    at = start + 4 + size
    head = json.loads(state[start + 4 : at])
    length = int.from_bytes(state[at : at + 4], "little")
    values = np.lib.format.read_array(io.BytesIO(state[at + 4 + length :]), allow_pickle=False)
    return Held(head, state[at + 4 : at + 4 + length], values)


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
        EngineError: it belongs to another model.
    """
    import mujoco

    spec = int(mujoco.mjtState.mjSTATE_INTEGRATION)
    if len(state) != mujoco.mj_stateSize(model, spec):
        raise EngineError("checkpoint belongs to another model; delete the candidate's checkpoints and bake again")
    mujoco.mj_resetData(model, data)
    mujoco.mj_setState(model, data, state, spec)
