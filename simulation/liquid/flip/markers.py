"""The marker particles: what moves lives on the device in the order of columns, what stays with a particle lives on the host."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....geometry.launch import warp
from ....worlds.arrays import F64, I32
from ...grids.runner import Runner
from ..engine import Particles
from . import column_kernels as columns
from . import transfer_kernels as kernels

__all__ = ["Markers"]

PARTS = 8
"""Parts that are sorted side by side on the CPU; the order does not depend on it."""


class Markers:
    """Particles of one run; positions on the device are in cells from the grid's origin."""

    def __init__(self, run: Runner, origin: F64, cell: float, density: float, *, apic: bool) -> None:
        self.run = run
        self.origin, self.cell, self.density = origin, cell, density
        self.apic = apic
        self.total = 0
        """Rows on the device, removed particles included until the next sort."""
        self.dead = 0
        self.next = 0
        self.identity: I32 = np.zeros(0, np.int32)
        self.fluid: I32 = np.zeros(0, np.int32)
        self.volume: F64 = np.zeros(0)
        self.temperature: F64 = np.zeros(0)

    @property
    def live(self) -> int:
        """Particles that are still there."""
        return self.total - self.dead

    @property
    def position(self) -> Any:
        """(x, y, z, volume) in cells."""
        return self.run.array("position", self.total, warp().vec4)

    @property
    def velocity(self) -> Any:
        """(u, v, w) [m/s] and pressure [Pa]."""
        return self.run.array("velocity", self.total, warp().vec4)

    @property
    def slot(self) -> Any:
        """Where a particle's other properties stand on the host."""
        return self.run.array("slot", self.total, warp().int32)

    @property
    def affine(self) -> Any:
        """Velocity gradients of APIC [m/s per cell]."""
        return self.run.array("affine", self.total if self.apic else 1, warp().mat33)

    def add(self, new: Particles) -> None:
        """Append particles; their identities are theirs from now on."""
        wp, n = warp(), len(new.position)
        if not n:
            return
        position, velocity = np.zeros((n, 4), np.float32), np.zeros((n, 4), np.float32)
        position[:, :3] = (new.position - self.origin) / self.cell
        position[:, 3] = new.volume / self.cell**3
        velocity[:, :3] = new.velocity
        first = len(self.identity)
        self._append("position", position, wp.vec4)
        self._append("velocity", velocity, wp.vec4)
        self._append("slot", np.arange(first, first + n, dtype=np.int32), wp.int32)
        if self.apic:
            self._append("affine", np.zeros((n, 3, 3), np.float32), wp.mat33)
        self.total += n
        self.identity = np.concatenate([self.identity, new.identity])
        self.fluid = np.concatenate([self.fluid, new.fluid])
        self.volume = np.concatenate([self.volume, new.volume])
        self.temperature = np.concatenate([self.temperature, new.temperature])
        self.next = max(self.next, int(new.identity.max()) + 1)

    def _append(self, name: str, values: NDArray[Any], dtype: Any) -> None:
        before = self.run.array(name, max(1, self.total), dtype)
        held = self.run.read(before, self.total) if before.size < self.total + len(values) else None
        target = self.run.array(name, self.total + len(values), dtype)
        if held is not None and len(held):
            warp().copy(target, warp().array(held, dtype=dtype, device=self.run.device), count=len(held))
        source = warp().array(np.ascontiguousarray(values), dtype=dtype, device=self.run.device)
        warp().copy(target, source, dest_offset=self.total, count=len(values))

    def sort(self, nx: int, ny: int) -> Any:
        """Put the rows in the order of their columns and let go of removed ones; first row of each column."""
        wp, run, n = warp(), self.run, self.total
        order, head = self._order(nx, ny)
        before = [self.position, self.velocity, self.slot]
        after = [run.array(name, n, kind) for name, kind in (("position2", wp.vec4), ("velocity2", wp.vec4), ("slot2", wp.int32))]
        run(kernels.permute, n, [order, *before, *after], grain=16384)
        for name in ("position", "velocity", "slot"):
            run.swap(name, name + "2")
        if self.apic:
            before_affine, after_affine = self.affine, run.array("affine2", n, wp.mat33)
            run(kernels.permute_affine, n, [order, before_affine, after_affine], grain=16384)
            run.swap("affine", "affine2")
        self.total, self.dead = self.live, 0
        if len(self.identity) > 2 * self.total + 4096:
            slot = run.read(self.slot, self.total)
            self.identity, self.fluid = self.identity[slot], self.fluid[slot]
            self.volume, self.temperature = self.volume[slot], self.temperature[slot]
            run.upload("slot", np.arange(self.total, dtype=np.int32), wp.int32)
        return head

    def _order(self, nx: int, ny: int) -> tuple[Any, Any]:
        """Rows in the order of their columns (those of one column stay as they were, removed ones come last) and first of each."""
        wp, run, n, many = warp(), self.run, self.total, nx * ny
        head = run.array("head", many + 1, wp.int32)
        if run.device == "cpu" and PARTS * many <= n:
            keys, order = run.array("keys", n, wp.int32), run.array("order", n, wp.int32)
            part = -(-n // PARTS)
            tallies = run.array("tallies", PARTS * (many + 1), wp.int32)
            run(columns.tally, PARTS, [n, part, self.position, nx, ny, keys, tallies], grain=1)
            run(columns.stack, 1, [PARTS, many, tallies, head])
            run(columns.deal, PARTS, [n, part, many, keys, tallies, order], grain=1)
            return order, head
        keys, order = run.array("keys", 2 * n, wp.int32), run.array("order", 2 * n, wp.int32)
        run(columns.find_keys, n, [self.position, nx, ny, keys, order], grain=16384)
        wp.utils.radix_sort_pairs(keys, order, n)
        run(columns.find_heads, n, [keys, n, many, head], grain=16384)
        return order, head

    def particles(self) -> Particles:
        """Copies of all that are there, in the order of their columns at the start of the last step."""
        run, n = self.run, self.total
        position, velocity = run.read(self.position, n), run.read(self.velocity, n)
        here = position[:, 3] > 0.0
        slot = run.read(self.slot, n)[here]
        return Particles(
            self.origin + self.cell * position[here, :3].astype(np.float64),
            velocity[here, :3].astype(np.float64),
            self.identity[slot],
            self.fluid[slot],
            self.volume[slot],
            np.full(len(slot), self.density),
            velocity[here, 3].astype(np.float64),
            self.temperature[slot],
        )

    def dump(self) -> dict[str, NDArray[Any]]:
        """All state, as arrays."""
        run, n = self.run, self.total
        state = {
            "position": run.read(self.position, n),
            "velocity": run.read(self.velocity, n),
            "slot": run.read(self.slot, n),
            "identity": self.identity,
            "fluid": self.fluid,
            "volume": self.volume,
            "temperature": self.temperature,
            "counts": np.array([self.dead, self.next], dtype=np.int64),
        }
        if self.apic:
            state["affine"] = run.read(self.affine, n)
        return state

    def load(self, state: dict[str, NDArray[Any]]) -> None:
        """Take the state of `dump` back."""
        wp, run = warp(), self.run
        self.total = len(state["position"])
        run.upload("position", state["position"], wp.vec4)
        run.upload("velocity", state["velocity"], wp.vec4)
        run.upload("slot", state["slot"], wp.int32)
        if self.apic:
            run.upload("affine", state["affine"], wp.mat33)
        self.identity, self.fluid = state["identity"].copy(), state["fluid"].copy()
        self.volume, self.temperature = state["volume"].copy(), state["temperature"].copy()
        self.dead, self.next = (int(value) for value in state["counts"])
