"""Implicit steps of sheets: Newton's method for the mean velocity, by conjugate gradients that know the sheet at rest.

The unknown u is the mean velocity of the step h. Forces F are looked at theta of the way, where the vertices move with u as well:

    m (u - v) / theta = h F(x + theta h u, u),    x' = x + h u,    v' = v + (u - v) / theta.

theta = 1/2 is the implicit midpoint rule, 1 backward Euler. Sums of momentum are exact whatever the iterations leave over: what is left
of a free sheet is taken out as one velocity of all of it, that of a held one is borne by what holds it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import scipy.sparse as sp
from scipy.sparse.csgraph import connected_components

from ...geometry.launch import warp
from ...worlds.arrays import F64, I32
from . import force_kernels as forces
from . import tangent_kernels as tangents
from .factor import Preconditioner, bending_matrix
from .mesh import Sheet
from .solve_kernels import gradients, turned

if TYPE_CHECKING:
    from ..passes import Passes

__all__ = ["THETA", "Implicit"]

THETA = 0.55
"""Own choice: what a step takes from a swing of angular frequency w is (theta - 1/2) w^2 h of it in a second."""
CLOSE = 1e-2
"""Share of what is unbalanced, measured by the preconditioner, at which conjugate gradients end."""
MOST = 60
"""Their steps at most."""
TURN = 0.2
"""Own choice: turn [rad] of an edge up to which Newton's method goes on; strain is off by half the square of what a step turns."""
FINE = 0.01
"""Turn at which it ends: strains are then off by 5e-5 at most. With one step and 0.2, a flag in a gust doubled its energy in 2 s."""
ROUNDS = 4
"""Its steps at most."""
KNOWN = 8
"""Lengths of step for which matrices are kept."""


class Implicit:
    """The implicit solve of one run.

    Args:
        passes: where its kernels are kept.
        state: arrays of the engine by name (x, v, u, mass, inverse, clock, target, faces, rest, law, force, hinges, hinge_law, weights, pull,
            corners, ends, acceleration).
        sheets: at rest.
        faces: of all sheets.
        held: vertices that are led.
    """

    def __init__(self, passes: Passes, state: dict[str, Any], sheets: tuple[Sheet, ...], faces: I32, held: I32) -> None:
        wp, device = warp(), passes.device
        self.passes, self.state = passes, state
        self.n, self.faces, self.held = len(state["v"]), faces, held
        free = np.ones(self.n, dtype=bool)
        free[held] = False
        self._preconditioner = Preconditioner(sheets, np.flatnonzero(free).astype(np.int32))
        self.mass = np.concatenate([s.mass for s in sheets])
        self._pattern(faces, device)
        self._bend = [
            sp.triu(sp.block_diag([bending_matrix(s, s.hinge_law[:, 0] * share(s)) for s in sheets]), format="csr")
            for share in (lambda s: np.ones(len(s.hinges)), lambda s: s.hinge_law[:, 2])
        ]
        self._pieces(faces, free)
        starts = np.cumsum([0, *(len(s.mass) for s in sheets)])
        self._edges = np.concatenate([s.edges + o for s, o in zip(sheets, starts, strict=False)])
        self._length = np.concatenate([s.edge_length for s in sheets])
        area = np.concatenate([s.area for s in sheets])
        count = len(faces)
        self._area = wp.array(area, dtype=wp.float64, device=device)
        self._along, self._across, self._mixed = (wp.zeros(count, dtype=wp.mat33d, device=device) for _ in range(3))
        self._warps, self._wefts = (wp.zeros(count, dtype=wp.vec3d, device=device) for _ in range(2))
        self.frames = wp.zeros(self.n, dtype=wp.mat33d, device=device)
        self._felt = wp.zeros(count, dtype=wp.mat33d, device=device)
        self.drag = wp.zeros(self.n, dtype=wp.mat33d, device=device)
        self.middle, self.left, self.before, self.mean = (wp.zeros(self.n, dtype=wp.vec3d, device=device) for _ in range(4))
        self._change = np.zeros((self.n, 3))
        self._dt, self._blown = (0.0, THETA), False
        self._known: dict[tuple[float, float], tuple[Any, ...]] = {}
        self.theta = THETA
        """Parameter of the theta rule for steps from now on."""
        self.rest: F64 = np.empty((0, 3))
        """Diagonal of what the system is preconditioned with, in the order of its factor (free vertices, 3)."""
        self.solves = 0

    def _pattern(self, faces: I32, device: str) -> None:
        """Blocks of the matrix, diagonal first and then those of the upper half, and the corners that add up to each."""
        wp, n = warp(), self.n
        rows, columns = np.repeat(faces, 3, axis=1).ravel().astype(np.int64), np.tile(faces, (1, 3)).ravel()
        items = np.arange(len(rows), dtype=np.int32)
        kept = rows <= columns
        key = np.where(rows == columns, rows, n + rows * n + columns)[kept]
        items = items[kept]
        order = np.argsort(key, kind="stable")
        unique, count = np.unique(key[order], return_counts=True)
        places = np.zeros(len(unique) + 1, dtype=np.int32)
        places[1:] = np.cumsum(count)
        # Every vertex has a triangle, so the diagonal is whole.
        upper = unique[n:] - n
        self._column = (upper % n).astype(np.int32)
        self._start = np.searchsorted(upper // n, np.arange(n + 1)).astype(np.int32)
        self._items = (wp.array(places, dtype=wp.int32, device=device), wp.array(items[order], dtype=wp.int32, device=device))
        self._blocks = wp.zeros(len(unique), dtype=wp.mat33d, device=device)

    def _pieces(self, faces: I32, free: Any) -> None:
        """Connected pieces of the sheets, and whether any vertex of each is held."""
        ends = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]]])
        links = sp.coo_matrix((np.ones(len(ends)), (ends[:, 0], ends[:, 1])), shape=(self.n, self.n))
        count, piece = connected_components(links, directed=False)
        held = np.bincount(piece, weights=~free, minlength=count) > 0
        self._loose = [np.flatnonzero(piece == k).astype(np.int32) for k in np.flatnonzero(~held)]
        self._bound = [(np.flatnonzero((piece == k) & free), np.flatnonzero((piece == k) & ~free)) for k in np.flatnonzero(held)]

    # ------------------------------------------------------------------ step

    def feel(self, x: Any, v: Any, faces: Any, air: Any, drag: Any, corners: tuple[Any, Any]) -> None:
        """Take how the air's force falls with the sheets' velocities."""
        p = self.passes
        p("damp_air", tangents.damp_air, len(self.faces), [x, v, faces, air, drag, self._felt])()
        p("catch_damping", tangents.catch_damping, self.n, [*corners, self._felt, self.drag])()
        self._blown = True

    def prepare(self, dt: float) -> None:
        """Take a length of step."""
        # Equal shares of a time differ in their last digits.
        dt = float(f"{dt:.9g}")
        key = self._dt = (dt, self.theta)
        if key not in self._known:
            if len(self._known) >= KNOWN:
                self._known.pop(next(iter(self._known)))
            self._known[key] = self._made(self.theta * dt)
        self._order, self._factor, self.rest, self._stiff, self._bends = self._known[key]

    def _made(self, step: float) -> tuple[Any, ...]:
        order, factor = self._preconditioner.factor(step)
        place = np.searchsorted(self._preconditioner.free, order)
        rest = np.stack([m.diagonal() for m in self._preconditioner.matrices(step)], axis=1)[place]
        bend = (step * step * self._bend[0] + step * self._bend[1]).tocsr()
        bend.sort_indices()
        upper = sp.triu(bend, k=1, format="csr")
        bends = (upper.indptr.astype(np.int32), upper.indices.astype(np.int32), np.asarray(upper.data, dtype=np.float64))
        return order, factor, rest, bend.diagonal(), bends

    def step(self, dt: float) -> bool:
        """Find the mean velocity of a step from where it starts; whether it can be trusted."""
        s = self.state
        warp().copy(self.before, s["v"])
        self.passes("guess", tangents.guess, self.n, [s["v"], s["x"], s["target"], s["inverse"], s["clock"], s["u"]])()

        self.prepare(dt)
        for round_ in range(ROUNDS):
            self.look()
            change = self._change if round_ == 0 else np.zeros_like(self._change)
            taken = gradients(self.matrix(), self.factor(), self.left.numpy(), change, CLOSE, MOST)
            s["u"].numpy()[: self.n] += change
            self.solves += taken
            turn = self.turned(dt, change)
            if taken >= MOST or turn >= TURN:
                return False
            if turn < FINE:
                return True
        return False

    def turned(self, dt: float, change: F64) -> float:
        """Largest turn or stretch of an edge by a change of the mean velocities, about [1]."""
        return self.theta * dt * float(turned(self._edges, self._length, change))

    def settle(self, dt: float) -> F64:
        """Give what the solve left over where it belongs; the impulse on what holds vertices, at theirs (k, 3) [N s]."""
        wp, s = warp(), self.state
        u, left = s["u"].numpy(), self.left.numpy()
        for piece in self._loose:
            u[piece] += self._rigid(piece, left, dt)
        wp.copy(self.mean, s["u"], count=self.n)
        felt = left[self.held] / self.theta
        felt -= self.mass[self.held, None] * (u[self.held] - self.before.numpy()[self.held])
        for free, held in self._bound:
            rows = np.searchsorted(self.held, held)
            share = self.mass[held] / self.mass[held].sum()
            felt[rows] += share[:, None] * (left[free].sum(axis=0) / self.theta)
        return np.asarray(felt)

    def _rigid(self, piece: I32, left: F64, dt: float) -> F64:
        """Velocities (k, 3) of a free piece as a rigid body that leave none of its momentum and angular momentum over."""
        place = self.middle.numpy()[piece]
        mass = self.mass[piece]
        arm = place - mass @ place / mass.sum()
        moves = np.zeros((len(piece), 3, 6))
        moves[:, :, :3] = np.eye(3)
        for k in range(3):
            moves[:, :, 3 + k] = np.cross(np.eye(3)[k], arm)
        inertia = mass[:, None, None] * np.eye(3) + self.theta * dt * self.drag.numpy()[piece]
        whole = np.einsum("nia,nij,njb->ab", moves, inertia, moves)
        # A sheet of vertices in one line does not turn about it.
        found = np.linalg.lstsq(whole, np.einsum("nia,ni->a", moves, left[piece]), rcond=1e-12)[0]
        return np.asarray(moves @ found)

    def look(self) -> None:
        """Forces and their changes where the vertices are now taken to be."""
        s, p, n, count = self.state, self.passes, self.n, len(self.faces)
        made = [
            p("ahead", tangents.ahead, n, [self.theta, s["clock"], s["x"], s["u"], self.middle]),
            p("membrane", forces.membrane, count, [self.middle, s["u"], s["faces"], s["rest"], s["law"], s["force"]]),
            p("tangent", tangents.tangent, count, [self.theta, s["clock"], self.middle, s["faces"], s["rest"], s["law"], self._along, self._across, self._mixed, self._warps, self._wefts]),
            p("block", tangents.block, len(self._blocks), [*self._items, s["rest"], self._along, self._across, self._mixed, self._blocks]),
            p("frame", tangents.frame, n, [*s["corners"], self._area, self._warps, self._wefts, self.frames]),
        ]  # fmt: skip
        if s["hinges"] is not None:
            made.append(
                p(
                    "bending",
                    forces.bending,
                    len(s["hinges"]),
                    [self.middle, s["u"], s["hinges"], s["weight"], s["hinge_law"], s["pull"]],
                )
            )
        made.append(
            p("unbalanced", tangents.unbalanced, n, [self.theta, s["v"], s["u"], s["mass"], *s["corners"], s["force"], *s["ends"], s["weights"], s["pull"],
              s["acceleration"], self.drag, s["inverse"], s["clock"], self.left])
        )  # fmt: skip
        for one in made:
            one()

    def factor(self) -> tuple[Any, ...]:
        """The preconditioner of the system."""
        return self._order, self.frames.numpy(), *self._factor

    def matrix(self) -> tuple[Any, ...]:
        """The system: diagonal blocks, those of the upper half, and bending."""
        blocks, n = self._blocks.numpy(), self.n
        diagonal = blocks[:n].copy()
        for k in range(3):
            diagonal[:, k, k] += self.mass + self._stiff
        if self._blown:
            diagonal += self.theta * self._dt[0] * self.drag.numpy()
        return diagonal, self._start, self._column, blocks[n:], *self._bends

    def end(self) -> None:
        """Velocities after the step, when vertices have moved with the mean ones."""
        s = self.state
        self.passes("regain", tangents.regain, self.n, [self.theta, s["inverse"], self.before, self.mean, s["v"]])()
