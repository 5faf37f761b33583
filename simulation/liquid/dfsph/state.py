"""Checkpoints: all particles in their present order, and the counters, as one file of arrays."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ...sealed import from_bytes, to_bytes
from ..engine import by_inflow
from .store import FIELDS

if TYPE_CHECKING:
    from .engine import Dfsph

__all__ = ["pack", "unpack"]


def pack(engine: Dfsph) -> bytes:
    """The full state. Particles are kept as they are, so nothing is rounded and the engine goes on from just these bytes."""
    counters: dict[str, Any] = {
        "time": np.float64(engine.time),
        "speed": np.float64(engine.speed),
        "pressed": np.float64(engine.pressed),
        "full": np.float64(engine.full),
        "relaxation": np.array(engine.solves.relaxation, dtype=np.float64),
        "steps": np.int64(engine.steps),
        "lost": np.int64(engine.lost),
        "next_identity": np.int64(engine.next_identity),
        "layers": np.array(engine.layers, dtype=np.int64),
        "inflows": np.array([m.inflow.name for m in engine.mouths], dtype=str),
    }
    return to_bytes({**engine.store.columns(), **counters, **engine.coupling.soft.pack()})


def unpack(engine: Dfsph, state: bytes) -> None:
    """Continue from a checkpoint of an engine with the same setup, or with inflows that this one lacks: they give nothing more.

    Raises:
        EngineError: these are not the bytes of such a checkpoint.
        ValueError: it is of another liquid.
    """
    found = from_bytes(state, (*FIELDS, "layers", "inflows"))
    layers = by_inflow(found["inflows"], found["layers"], engine.setup.inflows)
    engine.store.replace({name: found[name] for name in FIELDS})
    engine.coupling.soft.unpack(found)
    engine.time, engine.speed = float(found["time"]), float(found["speed"])
    engine.pressed = float(found["pressed"])
    engine.steps, engine.lost = int(found["steps"]), int(found["lost"])
    engine.next_identity = int(found["next_identity"])
    engine.full = float(found["full"])
    engine.solves.relaxation = [float(k) for k in found["relaxation"]]
    engine.layers = [int(k) for k in layers]
