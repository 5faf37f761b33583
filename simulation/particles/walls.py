"""Bodies that grains meet, on the device: their surfaces and motion, and which grains are near."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...geometry.launch import warp
from ...worlds.arrays import F64
from ..boundaries import BodyState
from ..passes import ALONE, BLOCK, Passes
from .lists import Buffer
from .setup import GrainSetup
from .soft_walls import SoftWalls

__all__ = ["Walls"]


def quaternions(matrices: F64) -> F64:
    """Quaternions (x, y, z, w) of rotation matrices, shape (n, 3, 3) -> (n, 4) (Shepperd 1978)."""
    m = np.asarray(matrices, dtype=np.float64)
    trace = np.trace(m, axis1=1, axis2=2)
    size = np.stack([m[:, 0, 0], m[:, 1, 1], m[:, 2, 2], trace], axis=1)
    result = np.zeros((len(m), 4))
    for n, largest in enumerate(np.argmax(size, axis=1)):
        a = m[n]
        if largest == 3:
            q = np.array([a[2, 1] - a[1, 2], a[0, 2] - a[2, 0], a[1, 0] - a[0, 1], 1.0 + trace[n]])
        else:
            i, j, k = int(largest), (int(largest) + 1) % 3, (int(largest) + 2) % 3
            q = np.zeros(4)
            q[i] = 1.0 - trace[n] + 2.0 * a[i, i]
            q[j], q[k], q[3] = a[j, i] + a[i, j], a[k, i] + a[i, k], a[k, j] - a[j, k]
        result[n] = q / np.linalg.norm(q)
    return result


class Walls:
    """All bodies of one instance of grains."""

    def __init__(self, setup: GrainSetup, origin: F64, device: str) -> None:
        from .wall_kernels import Bodies

        wp = warp()
        self.setup, self.origin, self.device = setup, origin, device
        self.count = b = len(setup.boundaries)
        self.width = 1 if device == "cpu" else BLOCK
        rows = max(b, 1)
        made = Bodies()
        kinds = {
            "position": wp.vec3d, "rotation": wp.quatd, "center": wp.vec3d, "velocity": wp.vec3d, "spin": wp.vec3d,
            "lightness": wp.float64, "mobility": wp.mat33d, "turning": wp.mat33d, "acceleration": wp.vec3d, "impulse": wp.vec3d, "twist": wp.vec3d,
            "reach": wp.float64, "drift": wp.float64, "closed": wp.int32, "mesh": wp.uint64, "offset": wp.int32,
            "soft": wp.int32,
        }  # fmt: skip
        for name, kind in kinds.items():
            setattr(made, name, wp.zeros(rows, dtype=kind, device=device))
        self.bodies = made
        vertices, corners, offsets, faces, base = [np.zeros((1, 3))], [], [], 0, 1
        self.meshes = []
        self.reach = np.zeros(rows)
        ids = np.zeros(rows, dtype=np.uint64)
        for k, boundary in enumerate(setup.boundaries):
            mesh = boundary.mesh
            offsets.append(faces)
            corners.append(np.asarray(mesh.faces) + base)
            vertices.append(np.asarray(mesh.vertices, dtype=float))
            faces, base = faces + len(mesh.faces), base + len(mesh.vertices)
            tree = wp.Mesh(
                points=wp.array(np.asarray(mesh.vertices, dtype=np.float32), dtype=wp.vec3, device=device),
                indices=wp.array(np.ascontiguousarray(mesh.faces, dtype=np.int32).ravel(), dtype=wp.int32, device=device),
            )
            self.meshes.append(tree)
            ids[k] = tree.id
            center = setup.centers[k] if setup.centers else np.zeros(3)
            self.reach[k] = float(np.linalg.norm(np.asarray(mesh.vertices) - center, axis=1).max())
        made.mesh.assign(ids)
        if b:
            made.reach.assign(self.reach)
            made.rotation.assign(np.tile([0.0, 0.0, 0.0, 1.0], (b, 1)))
            made.offset.assign(np.array(offsets, dtype=np.int32))
            made.soft.assign(np.array([int(x.deforming) for x in setup.boundaries], dtype=np.int32))
            made.closed.assign(np.array([int(x.closed) for x in setup.boundaries], dtype=np.int32))
        self.vertex = wp.array(np.concatenate(vertices), dtype=wp.vec3d, device=device)
        made.speed = wp.zeros(len(self.vertex), dtype=wp.vec3d, device=device)
        made.yields = wp.zeros(len(self.vertex), dtype=wp.float64, device=device)
        joined = np.concatenate(corners).astype(np.int32).ravel() if b else np.zeros(3, dtype=np.int32)
        self.corner = wp.array(joined, dtype=wp.int32, device=device)
        self.span = wp.zeros(rows, dtype=wp.vec2i, device=device)
        self.drift = wp.zeros(1, dtype=wp.float32, device=device)
        self.reaction = wp.zeros((rows, 7), dtype=wp.float64, device=device)
        self.soft = SoftWalls(self, setup)
        self._rigid = np.array([not x.deforming for x in setup.boundaries], dtype=bool)

    def begin(self, state: BodyState | None) -> float:
        """Take the bodies as they are at the start of an exchange; the greatest speed of a surface [m/s]."""
        self.reaction.zero_()
        if not self.count:
            return 0.0
        assert state is not None
        made = self.bodies
        # Where a body is not quite where its grains left it, the lists hold for less long.
        shift = np.linalg.norm(state.center - self.origin - made.center.numpy()[: self.count], axis=1)
        turned = quaternions(state.rotation)
        turn = 2.0 * np.arccos(np.clip(np.abs((turned * made.rotation.numpy()[: self.count]).sum(axis=1)), 0.0, 1.0))
        made.drift.assign(made.drift.numpy() + np.where(self._rigid, shift + self.reach * turn, 0.0))
        made.position.assign(state.position - self.origin)
        made.center.assign(state.center - self.origin)
        made.rotation.assign(turned)
        mobility, turning = state.mobilities()
        for name, values in (
            ("velocity", state.velocity), ("spin", state.angular_velocity), ("lightness", state.inverse_mass),
            ("mobility", mobility), ("turning", turning), ("acceleration", state.acceleration),
        ):  # fmt: skip
            rigid = self._rigid.reshape(-1, *(1,) * (values.ndim - 1))
            getattr(made, name).assign(np.ascontiguousarray(np.where(rigid, values, 0.0), dtype=np.float64))
        made.impulse.zero_()
        made.twist.zero_()
        speed = np.linalg.norm(state.velocity, axis=1) + self.reach * np.linalg.norm(state.angular_velocity, axis=1)
        return max(float(speed[self._rigid].max(initial=0.0)), self.soft.begin(state))

    def end(self) -> F64:
        """Impulses on the bodies since the exchange began, shape (b, 6)."""
        found: F64 = np.concatenate([self.bodies.impulse.numpy(), self.bodies.twist.numpy()], axis=1)[: self.count]
        return found

    def taken(self, run: Passes, buffer: Buffer) -> F64:
        """Impulses on the grains from the bodies since the exchange began, and the work of the bodies' motion on them, shape (b, 7)."""
        self.settle(run, buffer)
        found: F64 = self.reaction.numpy()[: self.count].copy()
        return found

    def settle(self, run: Passes, buffer: Buffer) -> None:
        """Add up what pairs gave so far, before their lists go."""
        from . import body_kernels as kernels

        if self.count and buffer.pair_count:
            inputs = [self.width, buffer.pairs, self.span, self.reaction]
            run("settle", kernels.settle, self.count * self.width, inputs, smallest=ALONE)()

    def passes(self, run: Passes, now: Buffer, laws: Any, density: Any, unit: float, dt: Any, clock: Any) -> list[Any]:
        """Contacts of one step."""
        from . import wall_kernels as kernels

        if not self.count or not now.pair_count:
            return []
        room = now.pair_count if self.device == "cpu" else now.pair_room
        inputs = [
            now.total, now.state, self.bodies, now.pairs, self.vertex, self.corner, laws, density,
            self._unit(unit), dt, clock,
        ]  # fmt: skip
        return [run("walls", kernels.walls, room, inputs, smallest=32)]

    def moves(self, run: Passes, now: Buffer, dt: Any, clock: Any) -> list[Any]:
        """Motion of the bodies over one step."""
        from . import body_kernels as kernels

        if not self.count:
            return []
        inputs = [self.width, self.span, now.pairs, self.bodies, dt, clock]
        return [
            run("bodies", kernels.move_bodies, self.count * self.width, inputs, smallest=ALONE),
            *self.soft.passes(run, now, dt, clock),
            run("farthest", kernels.farthest, 1, [self.count, self.bodies, self.drift], smallest=ALONE),
        ]

    def _unit(self, unit: float) -> Any:
        return self.__dict__.setdefault("_unit_kept", warp().float64(unit))

    def list_pairs(self, grains: Any, old: Buffer, new: Buffer, *, known: bool) -> None:
        """List which grains are near which bodies, and the triangles that they may meet."""
        from . import pair_kernels as kernels

        if not self.count:
            return
        wp, run, n = warp(), grains.passes, grains.count
        self.soft.refit()
        unit, skin = self._unit(grains.unit), self.__dict__.setdefault("_skin_kept", wp.float64(grains.skin))
        while True:
            near = [new.state, self.bodies, self.count, unit, skin, new.near_bodies, new.found, new.wall_count]
            run("near_walls", kernels.near_walls, n, near)()
            most = grains.greatest(new.wall_count, n)
            if most <= new.near_bodies:
                break
            new.grow_bodies(most + 1)
        wp.utils.array_scan(new.wall_count[: n + 1], new.wall_first[: n + 1], inclusive=False)
        last = n - 1
        total = int(new.wall_first[last:n].numpy()[0] + new.wall_count[last:n].numpy()[0])
        if total > new.pair_room:
            new.grow_pairs(int(1.5 * total) + 64, new.triangles)
        new.pair_count = total
        new.total.fill_(total)
        self.span.zero_()
        self.bodies.drift.zero_()
        self.drift.zero_()
        if not total:
            self.soft.forget()
            return
        inputs = [new.wall_first, new.wall_count, new.found, new.near_bodies, new.key, new.value, new.grain]
        run("enlist", kernels.enlist, n, inputs)()
        wp.utils.radix_sort_pairs(new.key, new.value, total)
        run("place_pairs", kernels.place_pairs, total, [new.key, new.value, new.grain, new.pairs, new.at])()
        run("runs_of", kernels.runs_of, total, [total, new.pairs, self.span])()
        while True:
            run("triangles", kernels.triangles, total, [new.state, self.bodies, new.pairs, unit, skin, new.triangles])()
            most = int(new.pairs.count[:total].numpy().max())
            if most <= new.triangles:
                break
            new.grow_pairs(new.pair_room, 4 * (-(-(most + 2) // 4)))
            run(
                "enlist",
                kernels.enlist,
                n,
                [new.wall_first, new.wall_count, new.found, new.near_bodies, new.key, new.value, new.grain],
            )()
            wp.utils.radix_sort_pairs(new.key, new.value, total)
            run("place_pairs", kernels.place_pairs, total, [new.key, new.value, new.grain, new.pairs, new.at])()
        then = [grains._index, old.wall_first, old.wall_count, old.at, old.pairs, new.pairs, int(known and old.pair_count > 0)]
        run("carry", kernels.carry, total, then)()
        if self.soft.count:
            self.soft.list_near(new.pairs, total)
