"""Air far from a gas: the whole declared box on coarse cells, which tells an active box what pushes at its inner sides and flows beyond them.

Air that nothing has reached has no eddies and one density, so that its flow is as smooth as it is far away. Before each projection the coarse
velocities are carried on, those in the active box are replaced by what flows through its faces, and all are projected: the pressure found
there stands at the inner sides in the projection of the active box.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ...geometry.launch import warp
from ...worlds.arrays import F64
from ..grids.columns import vec6i
from . import far_kernels as kernels
from .engine import MOTION, Gas
from .settings import GasSettings
from .solids import Solids
from .window_kernels import extents

if TYPE_CHECKING:
    from collections.abc import Sequence

    from .settings import Side
    from .window import Cells, Window

__all__ = ["MANY", "FarGas", "NearGas", "coarse"]

MANY = 4
"""Cells across a coarse one."""
CLOSE = 1e-3
"""Own choice: largest divergence of coarse cells, as a share of the largest speed per cell."""
FEW = 12
"""Own choice: most iterations of a coarse solve."""


def coarse(solids: Solids, shape: Cells) -> Solids:
    """Open shares of coarse cells between the solids of a whole box; beyond it nothing is open."""
    counts = [-(-n // MANY) for n in shape]
    room = _blocks(_padded(solids.room[tuple(slice(0, n) for n in shape)], counts))
    openings: list[NDArray[np.float32]] = []
    speeds: list[NDArray[np.float32]] = []
    for axis in range(3):
        planes = np.minimum(MANY * np.arange(counts[axis] + 1), shape[axis])
        others = tuple(slice(0, n) for a, n in enumerate(shape) if a != axis)
        for values, found in ((solids.opening, openings), (solids.velocity, speeds)):
            at = np.moveaxis(values[..., axis], axis, 0)[planes][(slice(None), *others)]
            whole = _padded(at, [len(planes), *(c for a, c in enumerate(counts) if a != axis)], first=1)
            mean = whole.reshape(len(planes), whole.shape[1] // MANY, MANY, whole.shape[2] // MANY, MANY).mean(axis=(2, 4))
            found.append(np.moveaxis(np.pad(mean, ((0, 0), (0, 1), (0, 1))), 0, axis))
    filled = np.pad(room, ((0, 1),) * 3)
    return Solids(filled.astype(np.float32), *(np.stack(f, axis=-1).astype(np.float32) for f in (openings, speeds)))


def _padded(values: NDArray[np.float32], counts: Sequence[int], first: int = 0) -> NDArray[np.float32]:
    """Cells up to whole coarse ones along the axes from `first` on, filled with 0."""
    wanted = [n if a < first else MANY * n for a, n in enumerate(counts)]
    return np.pad(values, [(0, w - n) for w, n in zip(wanted, values.shape, strict=True)])


def _blocks(values: NDArray[np.float32]) -> NDArray[np.float32]:
    a, b, c = (n // MANY for n in values.shape)
    return np.asarray(values.reshape(a, MANY, b, MANY, c, MANY).mean(axis=(1, 3, 5)), np.float32)


class FarGas(Gas):
    """The coarse cells of a whole box.

    Args:
        shape: fine cells of the whole box.
        cell: their size [m].
        sides: of the whole box.
        settings: of the engine.
        solids: of the whole box.
        moves: whether these will move.
        device: where it runs.
    """

    def __init__(
        self, shape: Cells, cell: float, sides: Sequence[Side], settings: GasSettings, *, solids: Solids, moves: bool, device: str | None
    ) -> None:  # fmt: skip
        self.fine = shape
        plain = replace(settings, fuel=None, confinement=0.0, viscosity=0.0, diffusivity=0.0)
        count = (-(-shape[0] // MANY), -(-shape[1] // MANY), -(-shape[2] // MANY))
        super().__init__(count, MANY * cell, sides, plain, solids=coarse(solids, shape), moves=moves, device=device)

    def turn(self, solids: Solids, seconds: float) -> None:
        """Take over solids of the whole box that reach another place at the end of a step."""
        self._turn(coarse(solids, self.fine), seconds)

    @property
    def box(self) -> Any:
        """Its cells, for kernels."""
        return self._box

    @property
    def speeds(self) -> Any:
        """Its velocities, on the device."""
        return self._face("velocity")

    def rest(self) -> None:
        """Solids stay as they are."""
        if self._turned:
            self._stand(self._at)

    def meet(self, near: NearGas, name: str) -> None:
        """Go on by the time since the last projection, take over what an active box holds, project, and push at its inner sides.

        Args:
            near: the active box.
            name: of its velocity, which is about to be projected.
        """
        raw = "velocity/raw" if name == "velocity/middle" else "velocity"
        if raw == name and self.settings.scheme == "reflection":
            self._carry((1.0, "velocity/middle", "velocity/raw"), "velocity/middle", near.ahead, raw)
        else:
            self._carry("velocity", "velocity", near.ahead, "velocity/raw")
            self.run.swap(raw, "velocity/raw")
        box, _, _, room, state, expansion = near.held(name)
        at = [self._box, box, MANY, near.low]
        self.collect(near, name, raw)
        own = [self._cells("state"), self._expansion]
        self.run(kernels.collect_cells, self.elements, [*at, room, state, expansion, *own], grain=64)
        if raw != name:
            warp().copy(self._face(name), self._face(raw), count=self.elements)
        fastest = max(near.fastest(name), 1e-9)
        self.solve(CLOSE * fastest, FEW, name, share=0.1 * CLOSE)
        near.pressed(self._box, self._room, self.projection.pressure, self._face(name), name)

    def collect(self, near: NearGas, name: str = "velocity", into: str = "velocity") -> None:
        """Take over what flows through the faces of an active box."""
        box, opening, velocity = near.held(name)[:3]
        inputs = [self._box, box, MANY, near.low, opening, velocity, self._face(into)]
        self.run(kernels.collect_faces, self.elements, inputs, grain=256)


class NearGas(Gas):
    """A gas in an active box, whose inner sides feel the air beyond.

    Args:
        window: the active box.
        whole: cells of the declared box.
        far: the coarse cells of that.
        sides: of the declared box.
        cell: size of cells [m].
        settings: of the engine.
        known: as of `Gas`.
    """

    def __init__(
        self,
        window: Window,
        whole: Cells,
        far: FarGas | None,
        sides: Sequence[Side],
        cell: float,
        settings: GasSettings,
        **known: Any,
    ) -> None:
        wp = warp()
        self.window, self.far = window, far
        self.low = wp.vec3i(*window.low)
        inner = window.inner(whole)
        self._inner = vec6i(*inner)
        if far is not None and any(inner):
            self.pressing = (far.meet,)
        self.ahead = 0.0
        """Time that a velocity about to be projected has gone on [s]."""
        super().__init__(window.shape, cell, window.sides(whole, sides), settings, **known)

    def fill(self, before: Window) -> None:
        """Let the air that did not lie in the active box before flow as the coarse cells tell."""
        if self.far is None:
            return
        wp = warp()
        start, end = (wp.vec3i(*(a - b for a, b in zip(at, self.window.low, strict=True))) for at in before)
        for name in MOTION:
            inputs = [self.far.box, self._box, MANY, self.low, start, end, self.far.speeds, self._face(name)]
            self.run(kernels.fill, self.elements, inputs, grain=1024)

    def extents(self, least: F64, quick: float) -> NDArray[np.int32]:
        """(nx + 1, ny + 1, 2) first cell of each row along z that holds more than the least (4,) of a quantity, or is quicker, and the end of them."""
        rows = (self.shape[0] + 1) * (self.shape[1] + 1)
        out = self.run.array("extents", 2 * rows, warp().int32)[: 2 * rows].reshape((rows, 2))
        inputs = [self._box, warp().vec4(*least), quick, self._cells("state"), self._face("velocity"), out]
        self.run(extents, rows, inputs, grain=128)
        return np.array(out.numpy()).reshape(self.shape[0] + 1, self.shape[1] + 1, 2)

    def held(self, name: str) -> tuple[Any, ...]:
        """Fields that coarse cells take over: cells, open shares and speeds of faces, rooms, amounts and expansion of cells."""
        return self._box, self._opening, self._face(name), self._room, self._cells("state"), self._expansion

    def fastest(self, name: str) -> float:
        """Fastest speed of a face along an axis [m/s]."""
        return self._fastest(name)

    def _step(self, seconds: float, held: NDArray[np.float32] | None) -> Any:
        self.ahead = 0.5 * seconds if self.settings.scheme == "reflection" else seconds
        return super()._step(seconds, held)

    def pressed(self, box: Any, room: Any, pressure: Any, speeds: Any, name: str) -> None:
        """Take over what stands and flows beyond its inner sides.

        Args:
            box: coarse cells.
            room: of them.
            pressure: of them.
            speeds: of their faces.
            name: of the velocity that is about to be projected.
        """
        for axis in range(3):
            count = 2 * self.shape[(axis + 1) % 3] * self.shape[(axis + 2) % 3]
            at = [axis, box, self._box, MANY, self.low, self._inner]
            lift = self.projection.lifts[axis]
            self.run(kernels.press, count, [*at, room, pressure, lift, self._face(name)])
            self.run(kernels.tell, count, [*at, speeds, self._box.beyond])
