"""Arrays of the sheets of one instance and of the solids that they meet, on a device."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ...geometry.launch import chosen_device, warp
from ...worlds.arrays import F64, I32
from ..passes import Passes
from .mesh import adjacency
from .setup import ClothSetup
from .soft_solids import SoftSolids

if TYPE_CHECKING:
    from ..boundaries import BodyState

__all__ = ["ClothArrays"]


class ClothArrays:
    """Places, velocities and laws: vertices of the sheets first, then those of the solids.

    Args:
        setup: what does not change.

    Attributes:
        n: vertices of the sheets.
        total: vertices in all.
        loads: forces of others at the sheets' vertices, until told anew (n, 3) [N].
        holder: row of the body that holds each vertex; -1: the world, -2: nothing.
    """

    def __init__(self, setup: ClothSetup) -> None:
        self.setup = setup
        self.device = chosen_device(setup.device)
        self.passes = Passes(self.device)
        offsets = np.cumsum([0, *(len(s.mass) for s in setup.sheets)])
        self.n = int(offsets[-1])
        self.faces = np.concatenate([s.faces + o for s, o in zip(setup.sheets, offsets, strict=False)]).astype(np.int32)
        self.mass = np.concatenate([s.mass for s in setup.sheets])
        hinges = np.concatenate([s.hinges + o for s, o in zip(setup.sheets, offsets, strict=False)]).astype(np.int32)
        self._solids(setup)
        self._soft = SoftSolids(setup.boundaries, self.solid_row)
        self.loads: F64 | None = None
        self._lay(setup, hinges)
        self._hold(setup)
        self._clock_bodies()

    def _solids(self, setup: ClothSetup) -> None:
        """Vertices of the boundaries behind those of the sheets."""
        at, vertices, faces, owner, rows = self.n, [], [], [], []
        for row, boundary in enumerate(setup.boundaries):
            mesh = boundary.mesh
            vertices.append(np.asarray(mesh.vertices, dtype=np.float64))
            faces.append(np.asarray(mesh.faces, dtype=np.int32) + at)
            owner.append(np.full(len(mesh.faces), row, dtype=np.int32))
            rows.append(np.full(len(mesh.vertices), row, dtype=np.int32))
            at += len(mesh.vertices)
        self.total = at
        self.solid_place = np.concatenate(vertices) if vertices else np.empty((0, 3))
        self.solid_faces = np.concatenate(faces) if faces else np.empty((0, 3), np.int32)
        self.solid_body = np.concatenate(owner) if owner else np.empty(0, np.int32)
        self.solid_row = np.concatenate(rows) if rows else np.empty(0, np.int32)

    def _array(self, values: Any, kind: Any) -> Any:
        return warp().array(np.ascontiguousarray(values), dtype=kind, device=self.device)

    def _lay(self, setup: ClothSetup, hinges: I32) -> None:
        wp, a, sheets = warp(), self._array, setup.sheets
        n, total = self.n, self.total
        position = np.concatenate([*(s.position for s in sheets), self.solid_place])
        law = np.concatenate([np.column_stack([s.modulus[:, :3] * s.area[:, None], s.modulus[:, 3]]) for s in sheets])
        corners, ends = adjacency(self.faces, n), adjacency(hinges, n)
        radius = np.concatenate(
            [*(np.full(len(s.mass), r) for s, r in zip(sheets, setup.shell, strict=True)), np.zeros(total - n)]
        )
        drag = np.concatenate([np.tile(d, (len(s.faces), 1)) for s, d in zip(sheets, setup.drag, strict=True)])
        speed = np.zeros((total, 3))
        if setup.velocity is not None:
            speed[:n] = setup.velocity
        self.blown = bool((drag > 0).any())
        self.x, self.v, self.u = a(position, wp.vec3d), a(speed[:n], wp.vec3d), a(speed, wp.vec3d)
        self.target = a(position, wp.vec3d)
        self.masses, self._radius = a(self.mass, wp.float64), a(radius, wp.float64)
        self.face_array = a(self.faces, wp.vec3i)
        self.rest = a(np.concatenate([s.inverse_rest for s in sheets]), wp.vec4d)
        self.law = a(law, wp.vec4d)
        self.force = wp.zeros(2 * len(self.faces), dtype=wp.vec3d, device=self.device)
        self.hinges = a(hinges, wp.vec4i)
        weight = np.concatenate([s.hinge_weight for s in sheets])
        self.weight, self.weights = a(weight, wp.vec4d), a(weight.ravel(), wp.float64)
        self.hinge_law = a(np.concatenate([s.hinge_law for s in sheets]), wp.vec3d)
        self.pull = wp.zeros(max(len(hinges), 1), dtype=wp.vec3d, device=self.device)
        self.corners = (a(corners.start, wp.int32), a(corners.items, wp.int32))
        self.ends = (a(ends.start, wp.int32), a(ends.items, wp.int32))
        self.drag = a(drag, wp.vec2d)
        self.air = wp.zeros(len(self.faces), dtype=wp.vec4d, device=self.device)
        self._blast = wp.zeros(len(self.faces), dtype=wp.vec3d, device=self.device)
        self._pulled = a(np.tile(setup.gravity, (n, 1)), wp.vec3d)
        self.acceleration = a(np.tile(setup.gravity, (n, 1)), wp.vec3d)
        self.reaction = wp.zeros(n, dtype=wp.vec3d, device=self.device)
        self.clock = wp.zeros(3, dtype=wp.float64, device=self.device)
        self.host_hinges, self.host_weight = hinges, weight
        starts = np.cumsum([0, *(len(s.mass) for s in sheets)])
        self.host_edges = np.concatenate([s.edges + o for s, o in zip(sheets, starts, strict=False)])
        self.host_lengths = np.concatenate([s.edge_length for s in sheets])

    def _hold(self, setup: ClothSetup) -> None:
        """Who leads which vertices: held ones of the sheets and those of moving solids."""
        wp, a = warp(), self._array
        self.holder = np.full(self.n, -2, dtype=np.int32)
        vertex, row, place = [], [], []
        target = self.x.numpy().copy()
        for hold in setup.holds:
            self.holder[hold.vertices] = hold.boundary
            if hold.boundary < 0:
                target[hold.vertices] = hold.place
            else:
                vertex.append(hold.vertices)
                row.append(np.full(len(hold.vertices), hold.boundary))
                place.append(hold.place)
        moving = [b.motion != "static" and not b.deforming for b in setup.boundaries]
        solid = np.flatnonzero(np.array(moving, dtype=bool)[self.solid_row]) if len(self.solid_row) else np.empty(0, int)
        vertex.append((self.n + solid).astype(np.int32))
        row.append(self.solid_row[solid])
        place.append(self.solid_place[solid])
        self.target.assign(target)
        inverse = np.concatenate([np.where(self.holder == -2, 1.0 / self.mass, 0.0), np.zeros(self.total - self.n)])
        self.inverse = a(inverse, wp.float64)
        self.held: I32 = np.flatnonzero(self.holder != -2).astype(np.int32)
        self._led = (
            a(np.concatenate(vertex).astype(np.int32), wp.int32), a(np.concatenate(row).astype(np.int32), wp.int32),
            a(np.concatenate(place).reshape(-1, 3), wp.vec3d),
        )  # fmt: skip
        self.led_count = sum(len(v) for v in vertex)

    def _clock_bodies(self) -> None:
        wp, count = warp(), max(len(self.setup.boundaries), 1)
        self._rotation = wp.zeros(count, dtype=wp.mat33d, device=self.device)
        self._origin, self._center, self._velocity, self._spin = (
            wp.zeros(count, dtype=wp.vec3d, device=self.device) for _ in range(4)
        )

    def _kin(self, setup: ClothSetup) -> I32:
        """A number for each vertex, the same for those that were one before a tear."""
        starts = np.cumsum([0, *(len(s.mass) for s in setup.sheets)])
        own = [np.arange(len(s.mass)) if s.kin is None else s.kin for s in setup.sheets]
        return np.concatenate([k + o for k, o in zip(own, starts, strict=False)]).astype(np.int32)

    def place_solids(self, bodies: BodyState) -> None:
        """Put every solid's vertices where its body is."""
        if self.total > self.n:
            rotation, origin = bodies.rotation[self.solid_row], bodies.position[self.solid_row]
            place = np.einsum("nij,nj->ni", rotation, self.solid_place) + origin
            self._soft.place(bodies, place)
            whole = self.x.numpy().copy() if self.device != "cpu" else self.x.numpy()
            whole[self.n :] = place
            if self.device != "cpu":
                self.x.assign(whole)

    def _take_bodies(self, bodies: BodyState, span: float) -> None:
        if len(self.setup.boundaries) == 0:
            return
        self._rotation.assign(bodies.rotation)
        self._origin.assign(bodies.position)
        self._center.assign(bodies.center)
        self._velocity.assign(bodies.velocity)
        self._spin.assign(bodies.angular_velocity)
        if self._soft.rows:
            speeds, inverse = self.u.numpy(), self.inverse.numpy()
            self._soft.aim(bodies, span, self.x.numpy()[self.n :], speeds[self.n :])
            self._soft.lightness(bodies, inverse[self.n :])
            if self.device != "cpu":
                self.u.assign(speeds)
                self.inverse.assign(inverse)
