"""Arrays of grains on a device: their state, lists of neighbours and pairs with bodies, twice: in use, and for the next order."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...geometry.launch import warp

__all__ = ["FIELDS", "Buffer"]

FIELDS = {
    "place": ("vec4i", np.int32, 4),
    "left": ("vec3", np.float32, 3),
    "motion": ("vec4", np.float32, 4),
    "spin": ("vec3", np.float32, 3),
    "rest": ("vec3", np.float32, 3),
    "rest_spin": ("vec3", np.float32, 3),
    "identity": ("int32", np.int32, 1),
    "start": ("vec4i", np.int32, 4),
    "air": ("vec4", np.float32, 4),
    "pull": ("vec3", np.float32, 3),
    "blown": ("vec3", np.float32, 3),
}
"""Fields of `grain_kernels.State`: Warp's type, NumPy's, and columns."""
ROOM = 16
"""Neighbours that a list has room for at first."""
TRIANGLES = 8
NEAR_BODIES = 3


class Buffer:
    """State and lists of up to `capacity` grains. Neighbour k of grain i stands at i row + k stride."""

    def __init__(self, device: str, capacity: int, room: int = ROOM, pairs: int = 0) -> None:
        from .grain_kernels import State

        wp = warp()
        self.device, self.capacity = device, capacity
        self.state = State()
        for name, (kind, _, _) in FIELDS.items():
            setattr(self.state, name, wp.zeros(capacity, dtype=getattr(wp, kind), device=device))
        self.count = wp.zeros(capacity, dtype=wp.int32, device=device)
        self.wall_first = wp.zeros(capacity + 1, dtype=wp.int32, device=device)
        self.wall_count = wp.zeros(capacity + 1, dtype=wp.int32, device=device)
        self.near_bodies = NEAR_BODIES
        self.found = wp.zeros((capacity, NEAR_BODIES), dtype=wp.int32, device=device)
        self.total = wp.zeros(1, dtype=wp.int32, device=device)
        self.pair_count = 0
        self.grow(room)
        self.grow_pairs(max(pairs, 64), TRIANGLES)

    def grow(self, room: int) -> None:
        """Neighbour lists with this much room."""
        wp = warp()
        self.room = room
        self.row, self.stride = (room, 1) if self.device == "cpu" else (1, self.capacity)
        self.near = wp.zeros(self.capacity * room, dtype=wp.int32, device=self.device)
        self.spring = wp.zeros(self.capacity * room, dtype=wp.vec3, device=self.device)
        self.roll = wp.zeros(self.capacity * room, dtype=wp.vec3, device=self.device)

    def grow_bodies(self, most: int) -> None:
        """Room for so many bodies near one grain."""
        wp = warp()
        self.near_bodies = most
        self.found = wp.zeros((self.capacity, most), dtype=wp.int32, device=self.device)

    def grow_pairs(self, pairs: int, triangles: int) -> None:
        """Room for so many pairs with so many triangles each."""
        from .wall_kernels import SLOTS, Pairs

        wp = warp()
        self.pair_room, self.triangles = pairs, triangles
        made = Pairs()
        made.grain, made.body, made.count = (wp.zeros(pairs, dtype=wp.int32, device=self.device) for _ in range(3))
        made.triangle = wp.zeros((pairs, triangles), dtype=wp.int32, device=self.device)
        made.way, made.spring, made.roll = (wp.zeros((pairs, SLOTS), dtype=wp.vec3, device=self.device) for _ in range(3))
        made.depth = wp.zeros((pairs, SLOTS), dtype=wp.float32, device=self.device)
        made.worked = wp.zeros(pairs, dtype=wp.float64, device=self.device)
        made.force, made.torque, made.turn, made.given, made.twisted = (
            wp.zeros(pairs, dtype=wp.vec3d, device=self.device) for _ in range(5)
        )
        made.face = wp.zeros((pairs, SLOTS), dtype=wp.int32, device=self.device)
        made.share, made.load = (wp.zeros((pairs, SLOTS), dtype=wp.vec3d, device=self.device) for _ in range(2))
        self.pairs = made
        self.key, self.value = (wp.zeros(2 * pairs, dtype=wp.int32, device=self.device) for _ in range(2))
        self.grain = wp.zeros(pairs, dtype=wp.int32, device=self.device)
        self.at = wp.zeros(pairs, dtype=wp.int32, device=self.device)

    def columns(self, count: int) -> dict[str, Any]:
        """Copies of all fields of the first `count` grains."""
        return {name: getattr(self.state, name)[:count].numpy().copy() for name in FIELDS}

    def assign(self, columns: dict[str, Any]) -> None:
        """Take these grains."""
        for name, (_, dtype, width) in FIELDS.items():
            values = np.ascontiguousarray(columns[name], dtype=dtype)
            if len(values):
                getattr(self.state, name)[: len(values)].assign(values if width > 1 else values.reshape(-1))
