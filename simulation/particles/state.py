"""Checkpoints of grains: all of them in their present order, and what their contacts stored."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ...geometry.launch import warp
from ..sealed import from_bytes, to_bytes
from .grain_kernels import MET
from .lists import FIELDS

if TYPE_CHECKING:
    from .engine import Grains

__all__ = ["pack", "unpack"]

KEPT = ("place", "left", "motion", "spin", "rest", "rest_spin", "identity")


def pack(engine: Grains) -> bytes:
    """The full state; nothing is rounded."""
    b, n = engine.now, engine.count
    columns = b.columns(n)
    found: dict[str, Any] = {name: columns[name] for name in KEPT}
    grain, other, spring, roll = (np.zeros(0, np.int32), np.zeros(0, np.int32), np.zeros((0, 3)), np.zeros((0, 3)))
    pair, way, wall_spring, wall_roll = np.zeros((0, 2), np.int32), np.zeros((0, 4, 3)), np.zeros((0, 4, 3)), np.zeros((0, 4, 3))
    depth = np.zeros((0, 4))
    if engine.listed and n:
        count = b.count[:n].numpy()
        rows = np.repeat(np.arange(n), count)
        slot = np.concatenate([np.arange(c) for c in count]) if n else np.zeros(0)
        at = (rows * b.row + slot * b.stride).astype(np.int64)
        near = b.near.numpy()[at]
        met = near >= MET
        grain, other = rows[met].astype(np.int32), (near[met] & (MET - 1)).astype(np.int32)
        spring, roll = b.spring.numpy()[at[met]], b.roll.numpy()[at[met]]
        m = b.pair_count
        if m:
            p = b.pairs
            kept = np.abs(p.way[:m].numpy()).any(axis=(1, 2))
            pair = np.stack([p.grain[:m].numpy(), p.body[:m].numpy()], axis=1)[kept]
            way, wall_spring, wall_roll, depth = (x[:m].numpy()[kept] for x in (p.way, p.spring, p.roll, p.depth))
    contacts = {"grain": grain, "other": other, "spring": spring, "roll": roll}
    walls = {"pair": pair, "way": way, "wall_spring": wall_spring, "wall_roll": wall_roll, "wall_depth": depth}
    return to_bytes({**found, **contacts, **walls, "time": np.float64(engine.time), "speed": np.float64(engine.speed)})


def unpack(engine: Grains, state: bytes) -> None:
    """Continue from a checkpoint of an engine with the same setup.

    Raises:
        EngineError: these are not the bytes of such a checkpoint.
        ValueError: it holds more grains than there are.
    """
    found = from_bytes(state, (*KEPT, "grain", "pair"))
    n, columns = len(found["place"]), {name: found[name] for name in KEPT}
    if n > engine.now.capacity:
        raise ValueError(f"{n} grains for an engine of {engine.now.capacity}")
    empty = {name: np.zeros((n, width) if width > 1 else n, dtype=dtype) for name, (_, dtype, width) in FIELDS.items()}
    engine.now.assign(empty | columns)
    engine.count = n
    _put_contacts(engine, found, n)
    _put_pairs(engine, found, n)
    engine.time, engine.speed = float(found["time"]), float(found["speed"])
    engine.forget_lists()


def _put_contacts(engine: Grains, found: dict[str, Any], n: int) -> None:
    """Lists that hold nothing but the contacts."""
    b = engine.now
    count = np.bincount(found["grain"], minlength=n).astype(np.int32)
    if len(count) and count.max(initial=0) > b.room:
        b.grow(4 * (-(-int(count.max() + 2) // 4)))
    first = np.concatenate([[0], np.cumsum(count)])[:-1]
    slot = np.arange(len(found["grain"])) - np.repeat(first, count)
    at = found["grain"].astype(np.int64) * b.row + slot * b.stride
    size = b.capacity * b.room
    near, spring, roll = np.zeros(size, np.int32), np.zeros((size, 3), np.float32), np.zeros((size, 3), np.float32)
    near[at] = found["other"] | MET
    spring[at], roll[at] = found["spring"], found["roll"]
    b.near.assign(near)
    b.spring.assign(spring)
    b.roll.assign(roll)
    if n:
        b.count[:n].assign(count)


def _put_pairs(engine: Grains, found: dict[str, Any], n: int) -> None:
    """Pairs that are in contact, grain by grain."""
    b, m = engine.now, len(found["pair"])
    b.pair_count = m
    warp()
    if m > b.pair_room:
        b.grow_pairs(2 * m, b.triangles)
    count = np.bincount(found["pair"][:, 0], minlength=n).astype(np.int32) if m else np.zeros(n, np.int32)
    first = (np.cumsum(count) - count).astype(np.int32)
    if n:
        b.wall_count[:n].assign(count)
        b.wall_first[:n].assign(first)
    if not m:
        return
    # Place e of the grain-wise order holds the pair's place among all.
    order = np.argsort(found["pair"][:, 0], kind="stable").astype(np.int32)
    b.at[:m].assign(order)
    b.pairs.grain[:m].assign(np.ascontiguousarray(found["pair"][:, 0]))
    b.pairs.body[:m].assign(np.ascontiguousarray(found["pair"][:, 1]))
    kept = {"way": "way", "spring": "wall_spring", "roll": "wall_roll", "depth": "wall_depth"}
    for name, values in ((n, found[k]) for n, k in kept.items()):
        getattr(b.pairs, name)[:m].assign(np.ascontiguousarray(values, dtype=np.float32))
    for name in ("given", "twisted"):
        getattr(b.pairs, name).zero_()
