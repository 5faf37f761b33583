"""Bodies in a particle liquid: their samples, the pairs (particle, body), and the impulses that both give each other."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ....geometry.launch import warp
from ....worlds.arrays import F64
from ....worlds.errors import InputError
from ...boundaries import BodyState
from ...passes import ALONE, FEW
from ..boundary import Sampled
from ..engine import LiquidSetup
from .samples import Samples, stays
from .soft import SoftSurfaces

if TYPE_CHECKING:
    from ...passes import Passes
    from .store import Work

__all__ = ["Coupling"]

ROOM = 1024
"""Pairs that there is room for at first."""


class _State:
    """State of the bodies in a step, in one block of memory: one copy to a GPU instead of nine."""

    WIDTHS: ClassVar[dict[str, int]] = {
        "center": 3, "velocity": 3, "spin": 3, "lightness": 1, "mobility": 9, "turning": 9, "acceleration": 3, "rotation": 9, "position": 3,
    }  # fmt: skip

    def __init__(self, count: int, device: str) -> None:
        wp = warp()
        kinds = {1: wp.float32, 3: wp.vec3, 9: wp.mat33}
        self._count = count
        self._block = wp.zeros(count * sum(self.WIDTHS.values()), dtype=wp.float32, device=device)
        self.arrays: dict[str, Any] = {}
        at = self._block.ptr
        for name, width in self.WIDTHS.items():
            self.arrays[name] = part = wp.array(ptr=at, dtype=kinds[width], shape=count, device=device)
            part.block = self._block  # whoever reads a part, also through `numpy()`, keeps the block's memory
            at += 4 * count * width

    def assign(self, values: dict[str, F64]) -> None:
        """Take the values of all bodies; a row each."""
        self._block.assign(np.concatenate([np.asarray(values[n], dtype=np.float32).reshape(-1) for n in self.WIDTHS]))


class Coupling:
    """All boundaries of one liquid and what passes between them and the particles in a step."""

    def __init__(self, setup: LiquidSetup, sampled: list[Sampled], origin: F64, passes: Passes, cells: int) -> None:
        from .boundary_kernels import Bodies

        wp = warp()
        self.setup, self.sampled, self.origin, self.passes = setup, sampled, origin, passes
        self.device = passes.device
        self.count = b = len(setup.boundaries)
        self._least = LEAST_STIFFNESS / (max(f.density for f in setup.fluids) * setup.spacing**2)
        self.lanes, self.width = (4 if self.device == "cpu" else 8 * passes.width), passes.width
        self.parts = self.lanes // self.width
        self._arms = [float(np.linalg.norm(s.position, axis=1).max()) if len(s.position) else None for s in sampled]
        """Largest distance of a body's samples from its centre [m]."""
        rows = np.concatenate([np.full(len(s.position), k) for k, s in enumerate(sampled)] or [np.zeros(0)]).astype(np.int32)
        self._fixed_rows = [k for k, one in enumerate(setup.boundaries) if stays(one)]
        fixed = np.isin(rows, self._fixed_rows)
        local = np.concatenate([s.position for s in sampled] or [np.zeros((0, 3))])
        volume = np.concatenate([s.volume for s in sampled] or [np.zeros(0)])
        shifted = np.where(fixed[:, None], local - origin, local)
        self.fixed = Samples(self.device, shifted[fixed], volume[fixed], rows[fixed], cells)
        self.moving = Samples(self.device, local[~fixed], volume[~fixed], rows[~fixed], cells)
        self._moving_rows = rows[~fixed]
        self.placed: tuple[Any, Any] = (np.zeros((0, 3, 3)), np.zeros((0, 3)))
        """Rotations and positions of the bodies in this step."""
        self.bodies = s = Bodies()
        size = max(b, 1)
        self._state = _State(size, self.device)
        for name in ("center", "velocity", "spin", "lightness", "mobility", "turning"):
            setattr(s, name, self._state.arrays[name])
        self.soft = SoftSurfaces(setup, sampled, self._moving_rows, origin, passes)
        s.deforms, s.vertex_velocity, s.vertex_start = self.soft.deforms, self.soft.velocity, self.soft.start
        s.friction = wp.array([one.friction for one in setup.boundaries] or [0.0], dtype=wp.float32, device=self.device)
        self.rotation, self.position, self.acceleration = (
            self._state.arrays[n] for n in ("rotation", "position", "acceleration")
        )
        self.linear, self.angular = (wp.zeros(size, dtype=wp.vec3, device=self.device) for _ in range(2))
        self.force, self.torque = (wp.zeros(size * self.parts, dtype=wp.vec3d, device=self.device) for _ in range(2))
        self.reach = wp.zeros(size * self.parts, dtype=wp.vec2d, device=self.device)
        self._ledger = wp.zeros((4, size), dtype=wp.vec3d, device=self.device)
        self.impulse = [self._ledger[0], self._ledger[1]]
        self.reaction_sum = [self._ledger[2], self._ledger[3]]
        self._room = 0
        self._make_room(ROOM)
        self.total = 0
        self.reacts = False

    def fastest(self, bodies: BodyState) -> float:
        """Largest speed of a moving surface [m/s], bounded by its samples' distance from the centre."""
        fastest = 0.0
        for k, (boundary, arm) in enumerate(zip(self.setup.boundaries, self._arms, strict=True)):
            if boundary.motion == "static" and not boundary.deforming:
                continue
            if k in bodies.vertices:
                fastest = max(fastest, float(np.linalg.norm(bodies.vertices[k][1], axis=1).max(initial=0.0)))
                continue
            if arm is not None:
                turning = arm * np.linalg.norm(bodies.angular_velocity[k])
                fastest = max(fastest, float(np.linalg.norm(bodies.velocity[k]) + turning))
        return fastest

    def _make_room(self, room: int) -> None:
        from .boundary_kernels import Pairs

        wp = warp()
        self._room = room
        self.pairs = Pairs()  # another one, so that no graph goes on with the arrays of the last
        self.pairs.particle, self.pairs.body = (wp.zeros(room, dtype=wp.int32, device=self.device) for _ in range(2))
        self.pairs.slope, self.pairs.borne = (wp.zeros(room, dtype=wp.vec3, device=self.device) for _ in range(2))
        self.pairs.drag = wp.zeros(room, dtype=wp.float32, device=self.device)
        self.pairs.give = wp.ones(room, dtype=wp.float32, device=self.device)  # all, where nothing deforms
        self.pairs.corner = wp.zeros(room, dtype=wp.vec3i, device=self.device)
        self.pairs.share = wp.zeros(room, dtype=wp.vec3, device=self.device)
        self.pair_force, self.pair_return = (wp.zeros(room, dtype=wp.vec3, device=self.device) for _ in range(2))
        self.key, self.order = (wp.zeros(2 * room, dtype=wp.int32, device=self.device) for _ in range(2))
        self.spans = wp.zeros(max(self.count, 1), dtype=wp.vec2i, device=self.device)

    def begin(self, state: BodyState, grid: list[Any], dt: float) -> None:
        """Take the bodies' state at the start of a step of `dt` seconds and carry their samples there."""
        if self.count == 0:
            return
        position = np.asarray(state.position, dtype=float) - self.origin
        rotation = np.array(state.rotation, dtype=float)
        if self.fixed.count and not self.fixed._sorted:
            wp = warp()
            self._require_placed(state)
            here = wp.zeros(self.count, dtype=wp.mat33, device=self.device)
            here.assign(np.tile(np.eye(3, dtype=np.float32), (self.count, 1, 1)))
            self.fixed.arrange(self.passes, "fixed", here, wp.zeros(self.count, dtype=wp.vec3, device=self.device), grid)
        elif not self.fixed.count:
            self.fixed.arrange(self.passes, "fixed", None, None, grid)
        self.soft.begin(state, dt, self.moving.local, self.moving.volume)
        position[self.soft.rows], rotation[self.soft.rows] = 0.0, np.eye(3)
        self.placed = rotation.astype(np.float32), position.astype(np.float32)
        mobile = np.asarray(state.inverse_mass) > 0
        moving = np.array([not (stays(b) or b.deforming) for b in self.setup.boundaries])
        mobility, turning = state.mobilities()
        self._state.assign({
            "rotation": rotation,
            "position": position,
            "center": np.asarray(state.center) - self.origin,
            "velocity": np.asarray(state.velocity) * moving[:, None],
            "spin": np.asarray(state.angular_velocity) * moving[:, None],
            "lightness": np.where(mobile, np.linalg.norm(mobility, 2, axis=(1, 2)), 0.0) * moving,
            "mobility": mobility * moving[:, None, None],
            "turning": turning * moving[:, None, None],
            "acceleration": np.asarray(state.acceleration) * moving[:, None],
        })  # fmt: skip
        self.reacts = bool((mobile & moving).any())
        self._ledger.zero_()
        self.moving.arrange(self.passes, "moving", self.rotation, self.position, grid)

    def _require_placed(self, state: BodyState) -> None:
        for row in self._fixed_rows:
            if not (np.allclose(state.rotation[row], np.eye(3)) and np.allclose(state.position[row], 0.0)):
                name = self.setup.boundaries[row].name
                raise InputError(f"the static boundary {name!r} comes with a pose; give its mesh in the world's frame")

    def count_pairs(self, work: Work, x: Any, volume: Any, h: float, n: int) -> None:
        """Count the pairs of each particle; their number is the second of `work.most`, and is to be `total`."""
        from . import pair_kernels as kernels

        w, run = work, self.passes
        self._work, self._x, self._volume, self._n = work, x, volume, n
        self.pairs.start, self.pairs.touched = w.start, w.touched
        if self.count:
            run("count_pairs", kernels.count_pairs, n, [x, self.fixed.arranged, self.moving.arranged, h, w.touched], block=FEW)()
            warp().utils.array_scan(w.touched[:n], w.start[:n], inclusive=False)
            run("sum_pairs", kernels.sum_pairs, 1, [n, w.start, w.touched, w.most], block=FEW)()

    def meet(self, work: Work, lift: Any, surfaces: Any, h: float) -> None:
        """Find the pairs, add the bodies to fill and gradients, and finish the diagonal of the solves."""
        from . import grid_kernels, reaction_kernels
        from . import pair_kernels as kernels

        wp, w, run = warp(), work, self.passes
        x, volume, n = self._x, self._volume, self._n
        fixed, moving = self.fixed.arranged, self.moving.arranged
        if self.total > self._room:
            self._make_room(int(1.5 * self.total))
            self.pairs.start, self.pairs.touched = w.start, w.touched
        if self.total:
            inputs = [x, fixed, moving, self.bodies, surfaces, self.setup.spacing, h, lift, self.pairs, w.fill, w.lean]
            run("fill_pairs", kernels.fill_pairs, n, inputs, block=FEW)()
            run("list_pairs", kernels.list_pairs, self.total, [self.pairs, self.key, self.order], block=FEW)()
            wp.utils.radix_sort_pairs(self.key, self.order, self.total)
            self.spans.zero_()
            run("pair_spans", grid_kernels.spans, self.total, [self.total, self.key, self.spans])()
            self.soft.attach(self, surfaces, w)
        if self.total and self.reacts:
            run(
                "reach",
                reaction_kernels.reach,
                self.count * self.lanes,
                [self.lanes, self.width, x, volume, self.pairs, self.order, self.spans, self.bodies, self.reach],
                smallest=ALONE,
            )()
        run(
            "finish",
            reaction_kernels.finish_factors,
            n,
            [
                self.parts,
                x,
                w.lean,
                w.lightness,
                self.pairs,
                self.bodies,
                self.reach,
                self.soft.bound,
                self._least,
                w.stiffness,
                w.firm,
            ],
        )()
        self.taken = w.none

    def moving_walls(self) -> None:
        """Write what bodies at their present velocity take away from D into `work.moving`."""
        from . import reaction_kernels as kernels

        w, s = self._work, self.bodies
        if self.total:
            self.passes(
                "carry",
                kernels.carry,
                self._n,
                [self._x, self.pairs, s, s.velocity, s.spin, s.vertex_velocity, w.moving],
            )()
        else:
            w.moving.zero_()

    def reaction(self, p: Any, *, moves: bool) -> list[Callable[[], None]]:
        """Passes of one iteration: how the pressure accelerates bodies, and what that takes away from D; none where it moves none."""
        from . import reaction_kernels as kernels

        self.taken = self._work.none
        if not (moves and self.total and (self.reacts or self.soft.reacts)):
            return []
        w, s, run = self._work, self.bodies, self.passes
        self.taken = w.moving
        return [
            self._lanes("wrench", kernels.PRESSED, p),
            run(
                "react",
                kernels.react,
                self.count,
                [self.parts, s, self.force, self.torque, self.linear, self.angular],
            ),
            *self.soft.pull(p, self._volume),
            run(
                "taken",
                kernels.carry,
                self._n,
                [self._x, self.pairs, s, self.linear, self.angular, self.soft.acceleration, w.moving],
            ),
        ]

    def book(self, p: Any) -> None:
        """Add the impulses of a solve that has ended to the sums of both sides, and to the bodies' velocities."""
        from . import reaction_kernels as kernels

        if not self.total:
            return
        self._lanes("ledger", kernels.FELT, p)()
        self._account(self.reaction_sum, moves=False)
        self._lanes("book", kernels.PRESSED, p)()
        self._account(self.impulse, moves=True)
        self.soft.press(self, p)

    def _lanes(self, name: str, kind: int, p: Any = None, value: Any = None) -> Callable[[], None]:
        """Sums of the pairs' forces on each body, by pressures `p` or as `value` gives them."""
        from . import reaction_kernels as kernels

        inputs = [
            kind, self.lanes, self.width, self._x, self._volume, self._work.lightness, p, value, self.pairs, self.order, self.spans,
            self.bodies.center, self.force, self.torque,
        ]  # fmt: skip
        return self.passes(name, kernels.lanes_of, self.count * self.lanes, inputs, smallest=ALONE)

    def _account(self, sums: list[Any], *, moves: bool) -> None:
        from . import reaction_kernels as kernels

        self.passes(
            f"account{int(moves)}",
            kernels.account,
            self.count,
            [self.parts, self.bodies, self.force, self.torque, self._work.settings, int(moves), *sums],
        )()

    def bear(self, v: Any) -> None:
        """Let pressure go on behind walls and bodies as before them; both sides are booked."""
        from . import boundary_kernels as kernels

        w = self._work
        inputs = [self._volume, w.lightness, self.pairs, w.settings, w.borne, v, self.pair_force, self.pair_return]
        self.passes("bear", kernels.bear, self._n, inputs)()
        self.rubbed()

    def rub(self, v: Any) -> None:
        """Work out the friction forces of all pairs at velocities v."""
        from . import viscous_kernels as kernels

        if self.total:
            w, s = self._work, self.bodies
            for sign, force in ((1.0, self.pair_force), (-1.0, self.pair_return)):
                inputs = [self._x, v, self._volume, w.viscosity, self.pairs, s, sign, force]
                self.passes(f"rub{sign}", kernels.rub, self._n, inputs)()

    def rubbed(self) -> None:
        """Give those forces to the bodies and to the sums of both sides."""
        from . import reaction_kernels as kernels

        if not self.total:
            return
        for name, value, sums in (("back", self.pair_return, self.reaction_sum), ("rubbed", self.pair_force, self.impulse)):
            self._lanes(name, kernels.GIVEN, value=value)()
            self._account(sums, moves=name == "rubbed")
        self.soft.take(self, self.pair_force)

    def advance(self) -> None:
        """Velocity of the bodies by everything but the liquid."""
        from . import reaction_kernels as kernels

        if self.count:
            inputs = [self.acceleration, self._work.settings, self.bodies.velocity]
            self.passes("kick", kernels.kick, self.count, inputs)()

    def wrenches(self) -> tuple[F64, F64]:
        """Impulses given to the bodies and taken by the liquid, (b, 6) each."""
        given, turned, taken, returned = self._ledger.numpy()[:, : self.count]
        return np.concatenate([given, turned], axis=1), np.concatenate([taken, returned], axis=1)


LEAST_STIFFNESS = 1e-3
"""In units of 1/(density spacing^2), where liquid at rest has 0.5: below it a particle has nothing to press against."""
