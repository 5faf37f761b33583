"""Checkpoints: all particles in their present order, and the counters, as one file of arrays."""

from __future__ import annotations

import io
import zipfile
from typing import TYPE_CHECKING, Any

import numpy as np

from ....worlds.errors import EvidenceError
from .store import FIELDS

if TYPE_CHECKING:
    from .engine import Dfsph

__all__ = ["pack", "unpack"]

FORMAT = 3


def pack(engine: Dfsph) -> bytes:
    """The full state. Particles are kept as they are, so nothing is rounded and the engine goes on from just these bytes."""
    out = io.BytesIO()
    counters: dict[str, Any] = {
        "time": np.float64(engine.time),
        "speed": np.float64(engine.speed),
        "pressed": np.float64(engine.pressed),
        "full": np.float64(engine.full),
        "relaxation": np.array(engine.relaxation, dtype=np.float64),
        "steps": np.int64(engine.steps),
        "lost": np.int64(engine.lost),
        "next_identity": np.int64(engine.next_identity),
        "layers": np.array(engine.layers, dtype=np.int64),
        "format": np.int64(FORMAT),
    }
    np.savez(out, **engine.store.columns(), **{**counters, **engine.coupling.soft.pack()})
    return out.getvalue()


def unpack(engine: Dfsph, state: bytes) -> None:
    """Continue from a checkpoint of an engine with the same setup.

    Raises:
        EvidenceError: these are not the bytes of such a checkpoint.
    """
    try:
        with np.load(io.BytesIO(state), allow_pickle=False) as data:
            found: dict[str, Any] = {name: data[name] for name in data.files}
        if int(found["format"]) != FORMAT or len(found["layers"]) != len(engine.layers):
            raise EvidenceError("the checkpoint is of another liquid or of another version; start from frame 0")
        columns = {name: found[name] for name in FIELDS}
    except (KeyError, ValueError, OSError, EOFError, zipfile.BadZipFile) as error:
        raise EvidenceError(f"the checkpoint of a liquid cannot be read ({error}); start from frame 0") from error
    engine.store.replace(columns)
    engine.coupling.soft.unpack(found)
    engine.time, engine.speed = float(found["time"]), float(found["speed"])
    engine.pressed = float(found["pressed"])
    engine.steps, engine.lost = int(found["steps"]), int(found["lost"])
    engine.next_identity = int(found["next_identity"])
    engine.full = float(found["full"])
    engine.relaxation = [float(k) for k in found["relaxation"]]
    engine.layers = [int(k) for k in found["layers"]]
