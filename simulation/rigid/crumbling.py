"""Contacts among the pieces of a breakable body.

Pieces touch without a gap before their bonds break, which is deep inside their summed skins. So only what is nearer than
`NEXT_TO` of the skins is pushed apart, and that slowly: a broken wall must not burst.

Rigid pieces in a tight fit would also jam: a brick that is hit off its middle cannot turn, and hands the blow on to the whole
wall within one step. In a real wall the mortar at its faces crumbles. So over a small distance (`crumble_of`) a contact point
of a face that two pieces shared carries no more than the bond bore (`crumbled_force`); beyond, the pieces meet as all bodies.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...worlds.arrays import F64, pose_of
from ...worlds.categories.fracture.pieces import bonded_pairs, crumble_of, crumbled_force, piece_overlap
from ..fracture.clusters import matter

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from ...worlds.built import BuiltEntity
    from ...worlds.spec import WorldSpec

__all__ = ["Crumbling", "Weak", "make_crumbling", "scale_rows"]

OUT_SPEED = 0.1
"""[m/s] Fast debris of a coarse step may lie deep in what it hit; it is pushed out no faster than this."""
OUTWARDS = 0.1
"""Depth that counts for pushing pieces apart, in parts of their summed skins at most; or, where that is more,
as deep as bears what stood on a piece (`_columns`): in long steps contacts are soft. A wall whose pieces push one another apart
by more than they must bear creeps out of itself."""
APART = 25.0
"""Acceleration [m/s^2] with which pieces are pushed apart that shared no face or are deeper than faces crumble."""
STOP = 0.9
"""Part of the distance over which faces crumble after which they meet as all bodies: what closes on it stops within a step."""
NEXT_TO = 0.02
"""Distance to which pieces are pushed apart, in parts of their summed skins."""
EXCESS = 1.2
"""A contact may carry so many times what it can before it is solved again."""
STIFFNESS_OF_STEP = 32.0
"""Growth of a contact's softness from which on it matters: d / (1 - d) of the constant impedance."""
SOFTEST = 1e6
"""A contact grows softer by no more than this: what is that soft carries nothing."""
HARDENING = 0.7
"""A contact that carries less than it can becomes harder by no more than this per step, or its force alternates from step to step."""
HARD = 2.0
"""Softness below which a contact is as hard as others."""


class Weak(NamedTuple):
    """Contacts of a step among pieces that shared a face: n in the step, w of them at faces that crumble."""

    rows: NDArray[np.int32]
    """Normal rows of those whose faces crumble, among the constraints, shape (w,)."""
    limit: F64
    """Most that each of them carries [N], shape (w,)."""
    pair: NDArray[np.int64]
    """The two pieces of each, as first * count + second, shape (w,)."""
    point: F64
    """[m], shape (w, 3)."""
    soft: F64
    """Softness of each by now over that of other contacts, shape (w,); written in place."""
    slack: F64
    """Speed at which each contact of the step may close [m/s], shape (n,): what would have crumbled altogether within the step meets as
    all bodies, but only after as much as is left to crumble."""
    tight: NDArray[np.bool_]
    """Contacts of the step among pieces of one body that are no deeper than faces crumble, shape (n,). Deeper ones meet as all
    bodies: met as softly as these, a heavy body would press them ever farther through each other."""


class _Soft(NamedTuple):
    """Contacts that crumbled in the step before, sorted by pair."""

    pair: NDArray[np.int64]
    point: F64
    soft: F64


class Crumbling:
    """Pieces of breakable bodies among the geoms of a model.

    Args:
        piece: piece of each geom, all bodies counted through; -1: none, shape (ngeom,).
        body: breakable body of each geom; -1: none, shape (ngeom,).
        shared: pairs of pieces that share a face, as first * count + second, sorted.
        count: number of pieces.
        distance: how far shared faces crumble, per body [m].
        force: most that a contact point carries meanwhile, per body [N].
        overlap: how deep pieces may lie in one another, per body [m].
        column: what a contact point of each piece may have to bear at rest, shape (count,) [N].
    """

    def __init__(
        self,
        piece: NDArray[np.int64],
        body: NDArray[np.int64],
        shared: NDArray[np.int64],
        count: int,
        distance: F64,
        force: F64,
        overlap: F64,
        column: F64,
    ) -> None:
        self.overlap, self.column = overlap, column
        self.piece, self.body, self.shared, self.count = piece, body, shared, count
        self.distance, self.force = distance, force
        self._known: _Soft | None = None

    def overlap_of(self, geoms: Any) -> F64:
        """Greatest allowed overlap of pairs of geoms, shape (n, 2), [m], shape (n,)."""
        return np.asarray(np.where(self.among(geoms), self.overlap[np.maximum(self.body[geoms[:, 0]], 0)], 0.0))

    def among(self, geoms: Any) -> NDArray[np.bool_]:
        """Which pairs of geoms, shape (n, 2), are pieces of one body, shape (n,)."""
        first, second = self.body[geoms[:, 0]], self.body[geoms[:, 1]]
        return np.asarray((first >= 0) & (first == second))

    def crumbling(self, data: Any, geoms: Any, points: F64, rows: NDArray[np.int32], dt: float) -> Weak | None:
        """Keep contacts among pieces from bursting; those whose faces crumble, None where there are none.

        Args:
            data: state after `mj_step1`.
            geoms: of the contacts, shape (n, 2).
            points: where they are [m], shape (n, 3).
            rows: their normal rows, shape (n,).
            dt: time step [s].
        """
        first, second = self.body[geoms[:, 0]], self.body[geoms[:, 1]]
        any_ = (first >= 0) | (second >= 0)
        if not any_.any():
            return None
        self._calm(data, rows[any_])
        own = np.flatnonzero(self.among(geoms))
        if not len(own):
            return None
        at, body = rows[own], self.body[geoms[own, 0]]
        one, two = self.piece[geoms[own, 0]], self.piece[geoms[own, 1]]
        key = np.minimum(one, two) * self.count + np.maximum(one, two)
        kin = np.zeros(len(own), dtype=bool)
        if len(self.shared):
            kin = self.shared[np.minimum(np.searchsorted(self.shared, key), len(self.shared) - 1)] == key
        skins, gap = data.efc_margin[at], data.efc_pos[at]
        stiffness = data.efc_KBIP[at, 0] * data.efc_KBIP[at, 2]
        most = OUT_SPEED * data.efc_KBIP[at, 1] / stiffness
        depth = np.maximum(NEXT_TO * skins - gap, 0.0)
        column = np.maximum(self.column[one], self.column[two]) * data.efc_R[at]
        bearing = np.minimum(depth, np.maximum(OUTWARDS * skins, column / stiffness))
        apart = np.minimum(depth - np.where(kin, self.distance[body], 0.0), APART / stiffness)
        wanted = np.minimum(np.maximum(bearing, apart), most)
        data.efc_aref[at] += stiffness * (np.maximum(gap - skins, -most) + wanted)
        left = np.maximum(gap + STOP * self.distance[body], 0.0)
        weak = kin & (left + np.minimum(data.efc_vel[at], 0.0) * dt > 0.0)
        slack, tight = np.zeros(len(rows)), np.zeros(len(rows), dtype=bool)
        slack[own] = np.where(kin & ~weak, left / dt, 0.0)
        tight[own] = gap >= -STOP * self.distance[body]
        return Weak(at[weak], self.force[body[weak]], key[weak], points[own[weak]], np.ones(int(weak.sum())), slack, tight)

    def _calm(self, data: Any, rows: NDArray[np.int32]) -> None:
        """Let depth come out of contacts of pieces no faster than `OUT_SPEED`."""
        stiffness = data.efc_KBIP[rows, 0] * data.efc_KBIP[rows, 2]
        depth = data.efc_pos[rows] - data.efc_margin[rows]
        most = OUT_SPEED * data.efc_KBIP[rows, 1] / stiffness
        data.efc_aref[rows] += stiffness * np.minimum(depth + most, 0.0)

    def crumble(self, data: Any, weak: Weak, felt: NDArray[np.bool_]) -> bool:
        """Soften contacts that carry more than they can; whether there were any, so that the step is to be solved again.

        Args:
            data: state with the forces of the step.
            weak: what `crumbling` found.
            felt: which of them to look at, shape (w,).
        """
        force = data.efc_force[weak.rows]
        over = felt & (force > EXCESS * weak.limit)
        if not over.any():
            return False
        grown = force[over] / weak.limit[over] * np.where(weak.soft[over] > 1.0, 1.0, STIFFNESS_OF_STEP)
        weak.soft[over] *= grown
        _soften(data, weak.rows[over], grown)
        return True

    # ------------------------------------------------------------------ from step to step

    @property
    def fresh(self) -> bool:
        """True if nothing is known of the step before."""
        return self._known is None

    def forget(self) -> None:
        """A frame starts: what crumbled is no part of a checkpoint."""
        self._known = None

    def take_over(self, other: Crumbling) -> None:
        """Go on after the model before, whose pieces are the same."""
        self._known = other._known

    def recall(self, data: Any, weak: Weak) -> None:
        """Start a step with contacts as soft as they were: the ones nearest to those that crumbled, pair by pair."""
        known = self._known
        if known is None or not len(known.pair):
            return
        place = np.minimum(np.searchsorted(known.pair, weak.pair), len(known.pair) - 1)
        order = np.flatnonzero(known.pair[place] == weak.pair)
        order = order[np.argsort(weak.pair[order], kind="stable")]
        pairs = weak.pair[order]
        low, high = np.searchsorted(pairs, known.pair, "left"), np.searchsorted(pairs, known.pair, "right")
        nearest, least = np.full(len(low), -1), np.full(len(low), np.inf)
        for k in range(int((high - low).max(initial=0))):
            at = order[np.minimum(low + k, len(order) - 1)]
            far = np.where(low + k < high, np.linalg.norm(weak.point[at] - known.point, axis=1), np.inf)
            nearest, least = np.where(far < least, at, nearest), np.minimum(far, least)
        found = nearest >= 0
        if not found.any():
            return
        np.maximum.at(weak.soft, nearest[found], known.soft[found])
        part = weak.soft > 1.0
        _soften(data, weak.rows[part], weak.soft[part])

    def remember(self, data: Any, weak: Weak) -> None:
        """Keep how soft contacts are to be in the next step, by what they carry in this one."""
        share = data.efc_force[weak.rows] / weak.limit
        over = share > EXCESS
        change = np.where(over, share, np.clip(share, HARDENING, 1.0))
        soft = np.where(weak.soft > 1.0, weak.soft * change, np.where(over, STIFFNESS_OF_STEP * share, 1.0))
        kept = np.flatnonzero(soft > HARD)
        kept = kept[np.argsort(weak.pair[kept], kind="stable")]
        self._known = _Soft(weak.pair[kept], weak.point[kept], np.minimum(soft[kept], SOFTEST))


def scale_rows(data: Any, rows: NDArray[np.int32], factor: F64 | float) -> None:
    """Make constraints at these rows so many times softer."""
    data.efc_R[rows] *= factor
    data.efc_D[rows] /= factor
    if data.nisland:
        # The solver works on copies sorted by island.
        inner = data.map_efc2iefc[rows]
        data.iefc_R[inner] *= factor
        data.iefc_D[inner] /= factor


def _soften(data: Any, rows: NDArray[np.int32], factor: F64) -> None:
    """Make contacts at these normal rows so many times softer."""
    for row in range(3):
        scale_rows(data, rows + row, factor)


def make_crumbling(
    spec: WorldSpec,
    built: Mapping[str, BuiltEntity],
    colliders: Sequence[str],
    geom_names: Sequence[str],
    geom_entity: Mapping[str, str],
) -> Crumbling | None:
    """Crumbling of the breakable bodies of a model; None where it has none."""
    names = [c for c in colliders if built[c].bonds is not None]
    if not names:
        return None
    starts = np.cumsum([0, *(len(built[n].bodies) for n in names)])
    count = int(starts[-1])
    pairs = list(zip(names, starts.tolist(), strict=False))
    row = {f"{n}/{b.name}": start + k for n, start in pairs for k, b in enumerate(built[n].bodies)}
    of_part = {f"{n}/{p.part}": row[f"{n}/{p.body}"] for n in names for p in built[n].parts}
    shared = [(bonded_pairs(built[n]) + start) @ np.array([count, 1]) for n, start in pairs]
    limits = [(b, built[n]) for n in names if (b := spec.entities[n].breakable) is not None]
    return Crumbling(
        np.array([of_part.get(g.rsplit("/", 1)[0], -1) for g in geom_names], dtype=np.int64),
        np.array([names.index(geom_entity[g]) if geom_entity[g] in names else -1 for g in geom_names], dtype=np.int64),
        np.sort(np.concatenate(shared)).astype(np.int64),
        count,
        np.array([crumble_of(*pair) for pair in limits]),
        np.array([crumbled_force(*pair) for pair in limits]),
        np.array([piece_overlap(*pair) for pair in limits]),
        np.concatenate([_columns(spec, built[n]) for n in names]),
    )


def _columns(spec: WorldSpec, built: BuiltEntity) -> F64:
    """Greatest load on a contact point of each piece, shape (pieces,) [N]: the weight of a column as wide as the piece from it to
    the top of the body that it was part of, twice for faces wider than high, by the four points that a face has at least."""
    gravity = np.array(spec.simulation.gravity)
    strength = float(np.linalg.norm(gravity))
    mass, centers, _ = matter(built)
    edge = np.cbrt([b.volume for b in built.bodies])
    height = pose_of(spec.entities[built.entity].pose).apply(centers) @ (-gravity / max(strength, 1e-12))
    above = (height + edge / 2).max() - height
    return np.asarray(0.5 * mass / edge * above * strength)
