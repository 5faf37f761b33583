"""Arrays of a particle liquid on a device: what is carried from step to step, and room for the work of one step."""

from __future__ import annotations

from typing import Any

import numpy as np

from ....geometry.launch import warp
from ....worlds.arrays import F64
from ...passes import Passes
from .step_slots import Slot

__all__ = ["FIELDS", "Store", "Work"]

FIELDS = {
    "x": ("vec3", np.float32),
    "v": ("vec3", np.float32),
    "identity": ("int32", np.int32),
    "fluid": ("int32", np.int32),
    "volume": ("float32", np.float32),
    "temperature": ("float32", np.float32),
    "pressure": ("float32", np.float32),
    "push": ("float32", np.float32),
    "held": ("float32", np.float32),
}
"""Fields of `grid_kernels.Particles`: Warp's type and NumPy's."""
ROOM = 40
"""Neighbours that a list has room for at first; water at rest has 27 to 33."""
GROWTH = 1.3


class Store:
    """Particles in the order of their cells; `now` is the state, `spare` takes the next order."""

    def __init__(self, device: str, columns: dict[str, Any]) -> None:
        self.device = device
        self.count = 0
        self.capacity = 0
        self.now: Any = None
        self.spare: Any = None
        self.replace(columns)

    def _particles(self, capacity: int) -> Any:
        from .grid_kernels import Particles

        wp = warp()
        made = Particles()
        for name, (kind, _) in FIELDS.items():
            setattr(made, name, wp.zeros(capacity, dtype=getattr(wp, kind), device=self.device))
        return made

    def replace(self, columns: dict[str, Any]) -> None:
        """Take these particles instead; makes room where there is too little."""
        self.count = len(columns["x"])
        if self.now is None or self.count > self.capacity:
            self.capacity = max(64, int(GROWTH * self.count) if self.capacity else self.count)
            self.now, self.spare = self._particles(self.capacity), self._particles(self.capacity)
        if self.count:
            for name, (_, dtype) in FIELDS.items():
                values = np.ascontiguousarray(columns[name], dtype=dtype)
                getattr(self.now, name)[: self.count].assign(values)

    def append(self, columns: dict[str, Any]) -> None:
        """Take these particles too, after the others."""
        wp, old, before = warp(), self.now, self.count
        self.count = before + len(columns["x"])
        if self.count > self.capacity:
            self.capacity = max(64, int(GROWTH * self.count))
            self.now, self.spare = self._particles(self.capacity), self._particles(self.capacity)
            for name in FIELDS if before else ():
                wp.copy(getattr(self.now, name), getattr(old, name), count=before)
        for name, (_, dtype) in FIELDS.items():
            getattr(self.now, name)[before : self.count].assign(np.ascontiguousarray(columns[name], dtype=dtype))

    def drop(self, count: int) -> dict[str, Any]:
        """Let the last `count` particles go; copies of their fields."""
        first, end = self.count - count, self.count
        self.count = first
        return {name: getattr(self.now, name)[first:end].numpy().copy() for name in FIELDS}

    def columns(self) -> dict[str, Any]:
        """Copies of all fields."""
        return {name: getattr(self.now, name)[: self.count].numpy().copy() for name in FIELDS}

    def swap(self) -> None:
        """The next order becomes the state."""
        self.now, self.spare = self.spare, self.now


class Work:
    """Room for one step of up to `capacity` particles with up to `room` neighbours each.

    Args:
        passes: of the device.
        capacity: particles.
        cells: of the grid.
        steepest: largest component that a gradient V grad W can have [1/m].
        room: neighbours.
    """

    def __init__(self, passes: Passes, capacity: int, cells: int, *, steepest: float, room: int = ROOM) -> None:
        from .list_kernels import STEPS
        from .solve_kernels import Sums, Totals
        from .step_kernels import Tally

        wp, device = warp(), passes.device

        def zeros(count: int | tuple[int, int], kind: Any) -> Any:
            return wp.zeros(count, dtype=kind, device=device)

        self.device, self.capacity = device, capacity
        self._packed = packs(device, capacity)
        self._unit = steepest / STEPS if self._packed else 1.0
        self.key, self.index = zeros(2 * capacity, wp.int32), zeros(2 * capacity, wp.int32)
        self.span = zeros(cells, wp.vec2i)
        self.count, self.touched, self.leaving = (zeros(capacity, wp.int32) for _ in range(3))
        self.grow(room)
        self.start = zeros(capacity, wp.int32)
        self.fill, self.stiffness, self.firm, self.lightness, self.rate, self.b, self.y = (
            zeros(capacity, wp.float32) for _ in range(7)
        )
        self.moving, self.none, self.viscosity = (zeros(capacity, wp.float32) for _ in range(3))
        self.lean, self.lift, self.borne, self.a, self.way = (zeros(capacity, wp.vec3) for _ in range(5))
        self.swift = zeros(capacity, wp.vec4) if self._packed and device != "cpu" else None
        """Accelerations as `solve_gpu_kernels.py` keeps them, which goes over packed lists on a GPU; else None."""
        parts = passes.parts(capacity)
        self.sums, self.partial = zeros(capacity, Sums), zeros(parts, Totals)
        self.going = zeros(1, wp.int32)
        self.last_y, self.last_r = zeros(capacity, wp.float32), zeros(capacity, wp.float32)
        self.tallies, self.tally = zeros(parts, Tally), zeros(1, Tally)
        self.longest, self.most = zeros(parts, wp.int32), zeros(2, wp.int32)
        self._numbers = np.zeros(max(Slot) + 1, dtype=np.float32)
        self.settings = zeros(len(self._numbers), wp.float32)
        """Numbers that kernels read and write, by `Slot`."""
        self.ended = zeros((2, len(self._numbers)), wp.float32)
        """The same at the end of the velocity and of the density solve."""

    def put(self, **numbers: float) -> None:
        """Note numbers by the names of `Slot`, for `send`."""
        for name, value in numbers.items():
            self._numbers[Slot[name]] = value

    def send(self) -> None:
        """Write the noted numbers to the device, over what kernels wrote."""
        self.settings.assign(self._numbers)

    def grow(self, room: int) -> None:
        """Neighbour lists with this much room; neighbour k of particle i stands at i row + k stride."""
        wp = warp()
        self.room = room
        row, stride = (room, 1) if self.device == "cpu" else (1, self.capacity)
        near = wp.zeros(self.capacity * room, dtype=wp.vec2i if self._packed else wp.vec4, device=self.device)
        self.lists: list[Any] = [self.count, near, row, stride, self._unit]
        """Arguments of kernels over lists: lengths, neighbours, row, stride, unit of their gradients."""


def packs(device: str, capacity: int) -> bool:
    """True if lists of so many particles are packed (`list_kernels.py`)."""
    from .list_kernels import MOST_PACKED

    return device != "cpu" and capacity <= MOST_PACKED


def cells_of(lower: F64, upper: F64, h: float, most: int) -> tuple[int, int, int]:
    """Cells of size h along each axis of a box with a margin; the longest axes are wrapped until there are at most `most`."""
    size = [max(3, int(np.ceil(extent / h)) + 3) for extent in np.asarray(upper) - np.asarray(lower)]
    while size[0] * size[1] * size[2] > most:
        longest = int(np.argmax(size))
        if size[longest] <= 3:
            break
        size[longest] = max(3, (size[longest] + 1) // 2)
    return size[0], size[1], size[2]
