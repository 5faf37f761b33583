"""A gas that feels what it carries: what drag takes out of it is taken from its faces, and both give way within a step (R66, R67).

Two fluids whose masses stand as 1 to `load`, the second slowed at a rate k by the first, come to the speed of both together at k (1 + load)
(F. E. Marble, Annual Review of Fluid Mechanics 2, 1970, 397, doi:10.1146/annurev.fl.02.010170.002145; Crowe, Sharma and Stock 1977,
doi:10.1115/1.3448756, spread what particles lose over the cells about them). Before a step of what is carried each face is told who will pull at
it, and tells the mean velocity that it will have while they do; with these the particles make their step, and what they say that they got is taken
from the faces, pair by pair. A face ends between the velocities of gas and particles however heavy these are.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...geometry.launch import warp
from ...worlds.arrays import F64
from ..grids.runner import Runner
from . import reaction_kernels as kernels
from .engine import Gas, GasReport
from .fields import PACKED

if TYPE_CHECKING:
    from ...worlds.fields import Dragged
    from .settings import GasSettings, Side
    from .solids import Solids

__all__ = ["Felt", "YieldingGas"]

KICK, EASE = "reaction/kick", "reaction/ease"
GRAIN = 256
"""Own choice: items or faces worth a thread of a CPU."""


class _Sorted(NamedTuple):
    """Items as kernels have them."""

    items: Any
    span: Any
    order: NDArray[np.int64]
    faces: int
    """Elements of the span."""


class Felt:
    """Items that a gas drags for a time: how it gives way to them, asked before, and what they got, told after.

    Attributes:
        change: by how much the velocity that each meets is another than that now, in the mean over that time [m/s], shape (n, 3).
        stopping: rate at which these would stop the most loaded face if they stood [1/s].
    """

    def __init__(self, pay: Callable[[F64, float], None], foreseen: F64, change: F64, stopping: float) -> None:
        self._pay, self._foreseen, self.change, self.stopping = pay, foreseen, change, stopping

    def take(self, impulse: F64, *, back: bool = False) -> None:
        """Take from the gas what items got of it [N s], shape (n, 3), in the order in which they were asked about; or give that `back`."""
        self._pay(-impulse - self._foreseen, -1.0 if back else 1.0)


class YieldingGas(Gas):
    """As `Gas`, felt by and feeling what it carries."""

    packed = (*PACKED, "kick", "ease")
    """Names of what `pack` returns."""

    def __init__(self, shape: tuple[int, int, int], cell: float, sides: Sequence[Side], settings: GasSettings | None = None, **known: Any) -> None:  # fmt: skip
        super().__init__(shape, cell, sides, settings, **known)
        wp = warp()
        zeros = np.zeros((self.elements, 3))
        self._kick, self._ease = (self.run.upload(n, zeros, wp.vec3d) for n in (KICK, EASE))
        self._given, self._taken = (self.run.upload(f"reaction/{n}", zeros, wp.vec3d) for n in ("given", "taken"))
        self._before = self.run.array("reaction/before", self.elements, wp.vec3)
        self._mass, self._part = (self.run.array(f"reaction/{n}", self.elements, wp.vec3d) for n in ("mass", "part"))
        self._warmth = self.run.array("reaction/warmth", self.elements, wp.float32)
        self._wraps = np.array([s == "periodic" for s in sides[::2]])
        self._once = Runner(self.run.device)
        self._left = 0.0
        self.open(0.0)

    def open(self, seconds: float, time: float = 0.0) -> None:
        """Begin a span of so many seconds at a time [s], in which it is asked and told, and at whose end it makes a step as long."""
        wp, expands = warp(), int(self.settings.expands)
        opened = [self._densities(), self._room, self._opening, self._mass, self._part]
        self.run(kernels.face_masses, self.elements, [self._box, self.cell**3, self.density, expands, *opened])
        self.run.upload("reaction/warmth", self._scalar(self.temperature), wp.float32)
        wp.copy(self._before, self._face("velocity"), count=self.elements)
        self._left, self.opened = seconds, time

    def begin(self) -> None:
        """Count anew what it was given."""
        self._given.zero_()

    # ------------------------------------------------------------ questions

    def _placed(self, points: F64) -> tuple[NDArray[np.int32], F64]:
        """Bases of items and their ways beyond, (n, 3) each; points [cells] beyond the box count at its sides."""
        last = np.array(self.shape) - 1
        middle = np.asarray(points, dtype=np.float64) - 0.5
        middle = np.where(self._wraps, np.mod(middle, last + 1), np.clip(middle, 0.0, last))
        base = np.minimum(np.floor(middle), np.where(self._wraps, last, np.maximum(last - 1, 0))).astype(np.int32)
        return base, middle - base

    def look(self, points: F64, since: float = 0.0) -> tuple[F64, F64]:
        """Velocity [m/s] at points [cells], (n, 3), `since` seconds after the span began; temperature [K] and soot [kg/m^3], (n, 2)."""
        wp, run, many = warp(), self._once, len(points)
        base, way = self._placed(points)
        at = [run.upload("reaction/base", base, wp.vec3i), run.upload("reaction/way", way, wp.vec3d)]
        out = [run.array("reaction/flow", many, wp.vec3d), run.array("reaction/held", many, wp.vec2d)]
        fields = [self._face("velocity"), self._kick, self._ease, since, self._warmth, self._cells("state")]
        run(kernels.look, many, [self._box, *at, *fields, *out], grain=GRAIN)
        return run.read(out[0], many), run.read(out[1], many)

    def ask(self, points: F64, dragged: Dragged, since: float = 0.0) -> Felt:
        """Its answer to items at points [cells], shape (n, 3), while drag acts on them, from `since` seconds after the span began."""
        velocity, mass, share, rate, seconds, _ = dragged
        wp, run, many = warp(), self._once, len(points)
        held = self._sorted(points, velocity, mass, share)
        items, span, order, faces = held
        run(kernels.norms, many, [self._box, items, self._part], grain=GRAIN)
        load, stiff = run.array("reaction/load", faces, wp.vec3d), run.array("reaction/stiff", faces, wp.float64)
        rates = run.upload("reaction/rate", np.asarray(rate, np.float64)[order], wp.float64)
        run(kernels.loads, faces, [self._box, span, items, rates, self._mass, self._part, load, stiff], grain=GRAIN)
        run(kernels.shares, many, [self._box, span, items, load], grain=GRAIN)
        mean, change = (wp.empty(faces, dtype=wp.vec3d, device=run.device) for _ in range(2))
        gas = [self._mass, self._part, self._face("velocity"), self._kick, self._ease, since, 0.5 * seconds]
        run(kernels.ahead, faces, [self._box, span, items, *gas, mean, change], grain=GRAIN)
        out = [run.array(f"reaction/{n}", many, wp.vec3d) for n in ("seen", "changed")]
        run(kernels.meet, many, [self._box, span, items, self._part, mean, change, *out], grain=GRAIN)
        seen, changed = (np.empty((many, 3)) for _ in range(2))
        seen[order], changed[order] = (run.read(one, many) for one in out)
        # What meets no open face along an axis gives it nothing.
        meets = np.empty((many, 3))
        meets[order] = run.read(items.inverse, many)
        foreseen = np.where(meets > 0.0, (mass * share)[:, None] * (velocity - seen), 0.0)
        return Felt(partial(self._pay, held, mean), foreseen, changed, float(run.read(stiff, faces).max(initial=0.0)))

    def _sorted(self, points: F64, velocity: F64, mass: F64, share: F64) -> _Sorted:
        """Items sorted by base, and the span of their faces."""
        wp, run = warp(), self._once
        base, way = self._placed(points)
        low = np.where(self._wraps, 0, base.min(axis=0))
        size = np.where(self._wraps, self.shape, base.max(axis=0) + 3 - low)
        size = np.minimum(size, np.array(self.shape) + 1 - low)
        span = kernels.Span()
        span.low, span.size = wp.vec3i(*map(int, low)), wp.vec3i(*map(int, size))
        x, y, z = (base - low).T.astype(np.int64)
        where = (x * size[1] + y) * size[2] + z
        order = np.argsort(where, kind="stable")
        faces = int(np.prod(size))
        items = kernels.Items()
        for name, values, kind in (
            ("base", base[order], wp.vec3i), ("way", way[order], wp.vec3d), ("velocity", velocity[order], wp.vec3d),
            ("mass", mass[order], wp.float64), ("share", share[order], wp.float64),
            ("starts", np.concatenate([[0], np.cumsum(np.bincount(where, minlength=faces))]).astype(np.int32), wp.int32),
        ):  # fmt: skip
            setattr(items, name, wp.array(np.ascontiguousarray(values), dtype=kind, device=run.device))
        items.inverse, items.bound = (wp.zeros(len(points), dtype=wp.vec3d, device=run.device) for _ in range(2))
        return _Sorted(items, span, order, faces)

    def _pay(self, held: _Sorted, mean: Any, rest: F64, sign: float) -> None:
        """Give faces what was foreseen by their `mean` velocities, and a rest [N s] besides, shape (n, 3) as items were asked about."""
        wp, run = warp(), self._once
        more = wp.array(np.ascontiguousarray(rest[held.order]), dtype=wp.vec3d, device=run.device)
        gas = [self._mass, self._part, mean]
        run(kernels.spread, held.faces, [self._box, held.span, held.items, *gas, more, sign, self._kick], grain=GRAIN)

    # ------------------------------------------------------------ steps

    def _push(self, name: str, seconds: float) -> None:
        """Forces on a velocity, and what it was given, evenly over the step."""
        super()._push(name, seconds)
        portion = 1.0 if self._left <= seconds * (1.0 + 1e-9) else seconds / self._left
        self._left = max(self._left - seconds, 0.0)
        self.run(kernels.give, self.elements, [portion, self._mass, self._kick, self._face(name), self._given, self._taken])

    def step(self, seconds: float, solids: Solids | None = None) -> GasReport:
        """As of `Gas`; what the flow takes back of what it was given is taken to go on."""
        report = super().step(seconds, solids)
        self.run(kernels.unfold, self.elements, [seconds, self._before, self._face("velocity"), self._taken, self._ease])
        return report

    # ------------------------------------------------------------ output

    @property
    def owed(self) -> F64:
        """Momentum that it was given and its velocities have not taken yet [N s], shape (3,)."""
        kick, mass = (self.run.read(one, self.elements) for one in (self._kick, self._mass))
        return np.asarray((kick * mass).sum(axis=0))

    @property
    def gained(self) -> F64:
        """Momentum that its velocities took since `begin` [N s], shape (3,)."""
        return np.asarray(self.run.read(self._given, self.elements).sum(axis=0))

    def measured(self) -> dict[str, Any]:
        """Channels of a frame."""
        return {"gas_returned": self.returned(), "gas_gained": self.gained}

    def returned(self) -> NDArray[np.float32]:
        """(nx, ny, nz, 3) the same by cell and volume [N s/m^3]: a face's belongs to both its cells by their parts of it."""
        given, room = self._whole(self._given), self._at.room[tuple(slice(0, n) for n in self.shape)].astype(np.float64)
        found = np.zeros((*self.shape, 3))
        for axis in range(3):
            n = self.shape[axis]
            face = np.moveaxis(given[tuple(slice(0, m + int(a == axis)) for a, m in enumerate(self.shape))][..., axis], axis, 0)
            if self._wraps[axis]:
                face = np.concatenate([face[:n], face[:1]])
            own = np.moveaxis(room, axis, 0)
            around = np.concatenate([own[-1:] * self._wraps[axis], own, own[:1] * self._wraps[axis]])
            both = np.maximum(around[:-1] + around[1:], 1e-30)
            cells = own * (face[:-1] / both[:-1] + face[1:] / both[1:])
            found[..., axis] = np.moveaxis(cells, 0, axis)
        return (found / self.cell**3).astype(np.float32)

    def _whole(self, array: Any) -> F64:
        return np.asarray(self.run.read(array, self.elements)).reshape(*(n + 1 for n in self.shape), 3)

    # ------------------------------------------------------------ state

    def pack(self) -> dict[str, Any]:
        """As of `Gas`, and what its velocities have not taken yet."""
        return {**super().pack(), "kick": self._whole(self._kick), "ease": self._whole(self._ease)}

    def unpack(self, found: Mapping[str, Any]) -> None:
        """Continue from such a state."""
        super().unpack(found)
        for name in (KICK, EASE):
            self.run.upload(name, found[name.removeprefix("reaction/")].reshape(-1, 3), warp().vec3d)
