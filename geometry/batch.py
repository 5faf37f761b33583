"""Signed clearance of very many pairs and poses at once, by kernels; convex overlaps and mere touches by `clearance`.

A list that is worth less than `EFFORT` goes through `clearance` altogether, without importing Warp. Both routes give the
same value within `query_noise`, depths within their precision (`depth.PRECISION`); which one is taken depends on the lists given to one `Forest`, never on time.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..worlds.arrays import F64, I32, rotation_matrix
from .clearance import EXACT, NOISE, SMALL_WORK, Care, measure, relative_poses
from .convex_batch import MANY, convex_clearances
from .depth import PRECISION
from .forest import Forest
from .launch import chosen_device, launch, load, warp
from .polytopes import Relative, repeats

if TYPE_CHECKING:
    from .solids import Solid

__all__ = ["BatchClearance", "ConvexGaps", "clearance_batch", "convex_gaps"]

EFFORT = 3.0
"""[s] Own choice: a list that one core would need longer for than this goes to the kernels. Importing Warp and loading
compiled kernels costs about 1.5 s, compiling them at first use some 10 s more."""
COSTLY, CHEAP = 150e-6, 15e-6
"""[s] One query of `clearance` on one core, measured: through fcl, and for small convex bodies over many poses."""
SETUP = 500e-6
"""[s] Own estimate: what each pair of bodies costs besides, however few its poses."""
DEPTHS = 6
"""Own choice: after so many overlaps of bodies that are not convex, 0.1 to 2 s each, the rest goes to the kernels (2 ms each)."""
PORTION = 16
"""Queries of one pair measured before the overlaps are counted again."""
DEPTH_SLICE = 8
"""Depths of one slice on the CPU: each takes some milliseconds."""
SHALLOW = -2.0
"""Told in place of a depth that is not over what is of interest."""
ALIKE = 1e-3
"""[1] Own choice: bodies whose sizes differ by more of the greater are not in one place; such that are differ by rounding."""
FEW_OF = 0.5
"""[1] Own choice: share of the solids up to which trees are grown for those alone that queries are about; all queries to come need their own."""
CHUNK = 65_536
"""Queries held at once: about 30 MB of poses and results."""


class _Queries(NamedTuple):
    """Which solids, and where: positions [m], shape (n, 3), and unit quaternions, shape (n, 4)."""

    pairs: I32
    poses_a: tuple[F64, F64]
    poses_b: tuple[F64, F64]
    skip_above: F64
    """[m], shape (n,)."""
    enough: F64
    """Depth [m] that ends a search, shape (n,)."""
    idle: F64
    """Depth [m] up to which none is of interest, shape (n,)."""

    def take(self, rows: NDArray[np.intp] | slice) -> _Queries:
        (pa, qa), (pb, qb) = self.poses_a, self.poses_b
        return _Queries(
            self.pairs[rows],
            (pa[rows], qa[rows]),
            (pb[rows], qb[rows]),
            self.skip_above[rows],
            self.enough[rows],
            self.idle[rows],
        )

    def chunks(self) -> Iterator[tuple[slice, _Queries, Relative]]:
        for start in range(0, len(self.pairs), CHUNK):
            part = slice(start, min(start + CHUNK, len(self.pairs)))
            some = self.take(part)
            yield part, some, relative_poses(some.poses_a, some.poses_b)


class BatchClearance(NamedTuple):
    """Answers of a batch, in the order of its queries."""

    distance: F64
    """Signed clearance [m], shape (n,); above `skip_above` a lower bound that is above it too."""
    computed: int
    """Queries that were computed: those that do not repeat the relative pose before them."""
    exact: int
    """Number of these that `clearance` measured."""


def clearance_batch(
    solids: Sequence[Solid] | Forest,
    pairs: NDArray[np.integer[Any]],
    poses_a: tuple[F64, F64],
    poses_b: tuple[F64, F64],
    *,
    skip_above: float | F64,
    care: Care = EXACT,
    device: str | None = None,
) -> BatchClearance:
    """Signed clearance of many (solid, solid, poses) at once.

    Every value up to `skip_above` is that of `signed_clearance` within `query_noise`. Queries that repeat the pair and
    the relative pose of the one before are answered by it, so give those of one pair one after the other.

    Args:
        solids: the bodies, or a `Forest` of them.
        pairs: indices of the first and the second solid of each query, shape (n, 2).
        poses_a: positions (n, 3) and unit quaternions (n, 4) of the first.
        poses_b: the same of the second.
        skip_above: distance [m] beyond which a lower bound is enough, one for all or shape (n,).
        care: how exactly depths are wanted.
        device: `cpu`, `cuda`, ...; default as `launch.chosen_device` says. On a GPU every list goes to the kernels.
    """
    own = solids.solids if isinstance(solids, Forest) else tuple(solids)
    where = chosen_device(device)
    pairs = np.asarray(pairs, dtype=np.int32).reshape(-1, 2)
    count = len(pairs)
    limit = np.broadcast_to(np.asarray(skip_above, dtype=np.float64), (count,))
    deep, shallow = (np.broadcast_to(np.asarray(v, dtype=np.float64), (count,)) for v in (care.enough, care.idle))
    asked = _Queries(pairs, poses_a, poses_b, limit, deep, shallow)
    anchor = np.empty(count, dtype=np.intp)
    for part, some, poses in asked.chunks():
        anchor[part] = part.start + repeats(poses, some.pairs)
    # One that asks farther, deeper or more exactly than the query it repeats is answered by itself.
    farther = np.flatnonzero((limit > limit[anchor]) | (deep > deep[anchor]) | (shallow < shallow[anchor]))
    anchor[farther] = farther
    compute = np.flatnonzero(anchor == np.arange(count))
    chosen = asked.take(compute)
    value, computed = np.empty(count), len(compute)
    forest = solids if isinstance(solids, Forest) else Forest(own)
    exact = 0
    for route in (_convex, _one_by_one) if where == "cpu" else ():
        done, some_values = route(forest, chosen, care.tolerance)
        value[compute[done]] = some_values
        exact += len(done)
        left = np.ones(len(compute), dtype=bool)
        left[done] = False
        compute, chosen = compute[left], chosen.take(np.flatnonzero(left))
    if len(compute):
        value[compute], more = _by_kernels(forest, chosen, where, care.tolerance)
        exact += more
    return BatchClearance(value[anchor], computed, exact)


class ConvexGaps(NamedTuple):
    """Clearances of convex solids, in the order of the queries."""

    distance: F64
    """Signed clearance [m], shape (n,); above `skip_above` a lower bound that is above it too."""
    point_a: F64
    """Point of the surface of the first in the world [m], shape (n, 3); not of lower bounds."""
    point_b: F64
    answered: NDArray[np.bool_]
    """False where `signed_clearance` has to be asked."""


def convex_gaps(
    forest: Forest, pairs: NDArray[np.intp], poses_a: tuple[F64, F64], poses_b: tuple[F64, F64], *, skip_above: float
) -> ConvexGaps | None:
    """Signed clearance of pairs of convex solids with its points; None where compiled loops are not worth loading.

    Args:
        forest: the solids.
        pairs: indices of the first and the second solid of each query, shape (n, 2).
        poses_a: positions (n, 3) and unit quaternions (n, 4) of the first.
        poses_b: the same of the second.
        skip_above: distance [m] beyond which a lower bound is enough.
    """
    count = len(pairs)
    if len(forest.solids) < MANY and count < MANY:
        return None
    convex = forest.convex
    rows = np.flatnonzero(convex.fit[pairs].all(axis=1))
    (pa, qa), (pb, qb) = poses_a, poses_b
    poses = relative_poses((pa[rows], qa[rows]), (pb[rows], qb[rows]))
    above, enough = np.full(len(rows), skip_above), np.full(len(rows), np.inf)
    found = convex_clearances(convex, pairs[rows].astype(np.int32), poses, skip_above=above, enough=enough)
    turn = rotation_matrix(qb[rows])
    answer = ConvexGaps(np.full(count, np.nan), np.zeros((count, 3)), np.zeros((count, 3)), np.zeros(count, dtype=bool))
    answer.distance[rows], answer.answered[rows] = found.value, found.answered
    for points, local in ((answer.point_a, found.point_a), (answer.point_b, found.point_b)):
        points[rows] = np.einsum("nij,nj->ni", turn, local) + pb[rows]
    return answer


def _effort(solids: Sequence[Solid], pairs: I32) -> float:
    """Seconds that `clearance` would need on one core, roughly."""
    few, count = np.unique(pairs, axis=0, return_counts=True)
    setup = len(few) * SETUP
    if setup + len(pairs) * COSTLY < EFFORT:
        return 0.0
    return setup + float(
        sum(n * (CHEAP if _small(solids[i], solids[j]) else COSTLY) for (i, j), n in zip(few, count, strict=True))
    )


def _small(a: Solid, b: Solid) -> bool:
    return len(a.faces) * len(b.vertices) + len(b.faces) * len(a.vertices) <= 2 * SMALL_WORK and a.convex and b.convex


def _by_pair(pairs: I32, rows: NDArray[np.intp]) -> list[tuple[tuple[int, int], NDArray[np.intp]]]:
    """The queries in `rows` of each pair."""
    if len(rows) == 0:
        return []
    order = rows[np.lexsort((rows, pairs[rows, 1], pairs[rows, 0]))]
    cut = np.flatnonzero((np.diff(pairs[order], axis=0) != 0).any(axis=1)) + 1
    return [((int(pairs[g[0], 0]), int(pairs[g[0], 1])), g) for g in np.split(order, cut)]


def _convex(forest: Forest, asked: _Queries, tolerance: float) -> tuple[NDArray[np.intp], F64]:
    """Queries of convex pairs answered by compiled loops, and their values [m]; none of a list of few pairs, unless a longer one came before."""
    del tolerance  # depths of these are exact
    few = len(asked.pairs) < MANY or len(np.unique(asked.pairs, axis=0)) < MANY
    if few and "convex" not in vars(forest):
        return np.empty(0, dtype=np.intp), np.empty(0)
    convex = forest.convex
    rows = np.flatnonzero(convex.fit[asked.pairs].all(axis=1))
    some = asked.take(rows)
    poses = relative_poses(some.poses_a, some.poses_b)
    found = convex_clearances(convex, some.pairs, poses, skip_above=some.skip_above, enough=some.enough)
    return rows[found.answered], found.value[found.answered]


def _one_by_one(forest: Forest, asked: _Queries, tolerance: float) -> tuple[NDArray[np.intp], F64]:
    """Queries answered by `measure`, and their values [m]; none where that takes too long, and not all where too many overlap."""
    done: list[NDArray[np.intp]] = []
    values: list[F64] = []
    solids = forest.solids
    if "cpu" in forest.on_device or _effort(solids, asked.pairs) >= EFFORT:
        return np.empty(0, dtype=np.intp), np.empty(0)
    for (i, j), rows in _by_pair(asked.pairs, np.arange(len(asked.pairs))):
        a, b = solids[i], solids[j]
        convex = a.convex and b.convex
        portions = [rows] if convex else np.split(rows, range(PORTION, len(rows), PORTION))
        for portion in portions:
            if forest.overlaps > DEPTHS:
                break
            some = asked.take(portion)
            poses = relative_poses(some.poses_a, some.poses_b)
            values.append(measure(a, b, poses, skip_above=some.skip_above, care=Care(tolerance, some.enough, some.idle)))
            done.append(portion)
            forest.overlaps += 0 if convex else int((values[-1] < 0.0).sum())
    return np.concatenate([np.empty(0, dtype=np.intp), *done]), np.concatenate([np.empty(0), *values])


def _by_kernels(forest: Forest, asked: _Queries, device: str, tolerance: float) -> tuple[F64, int]:
    from . import clearance_kernels as kernels

    load(kernels.nearest, device)
    forest, used = _asked_about(forest, asked.pairs, device)
    asked = asked._replace(pairs=used)
    wood = wood_on(forest, device)
    solids = forest.solids
    size = np.array([s.size for s in solids])
    value, exact = np.empty(len(asked.pairs)), 0
    for part, some, poses in asked.chunks():
        pairs = some.pairs
        touch = NOISE * (size[pairs[:, 0]] + size[pairs[:, 1]])
        distance, found, held = descend(wood, pairs, poses, touch, some.skip_above, device)
        rows = np.flatnonzero((found & (distance <= touch)) | held)
        distance = np.where(found, distance, np.maximum(distance, np.nextafter(some.skip_above, np.inf)))
        both_convex = np.array([solids[i].convex and solids[j].convex for i, j in pairs[rows]], dtype=bool)
        rough = rows[~both_convex]
        depth = depths(wood, pairs, poses, touch, rough, device, care=Care(tolerance, some.enough, some.idle))
        distance[rough[depth > 0.0]] = -depth[depth > 0.0]
        settled = (depth == SHALLOW) & _settled(solids, size, pairs[rough])
        distance[rough[settled]] = -some.idle[rough[settled]]
        left = np.concatenate([rows[both_convex], rough[(depth < 0.0) & ~settled]])
        for (i, j), same in _by_pair(pairs, left):
            care = Care(tolerance, some.enough[same], some.idle[same])
            distance[same] = measure(solids[i], solids[j], poses.take(same), care=care)
        value[part] = distance
        exact += len(left)
    return value, exact


def _asked_about(forest: Forest, pairs: I32, device: str) -> tuple[Forest, I32]:
    """A forest of the solids that queries are about alone, and those in it, where few of many are and no trees stand yet."""
    used, places = np.unique(pairs, return_inverse=True)
    if device in forest.on_device or len(used) > FEW_OF * len(forest.solids):
        return forest, pairs
    return Forest([forest.solids[k] for k in used]), places.reshape(pairs.shape).astype(np.int32)


def _settled(solids: Sequence[Solid], size: F64, pairs: I32) -> NDArray[np.bool_]:
    """True for pairs of which nothing more is asked where no depth is over what is of interest: they are not in one place, nor both open.

    Bodies in one place overlap fully without a point of either inside the other; only such of one size can be.
    """
    closed = np.array([(solids[i].closed, solids[j].closed) for i, j in pairs], dtype=bool).reshape(-1, 2)
    alike = np.abs(size[pairs[:, 0]] - size[pairs[:, 1]]) <= ALIKE * size[pairs].max(axis=1, initial=0.0)
    return np.asarray(closed.any(axis=1) & ~(closed.all(axis=1) & alike))


def depths(
    wood: Any,
    pairs: I32,
    poses: Relative,
    noise: F64,
    rows: NDArray[np.intp],
    device: str,
    *,
    care: Care = EXACT,
) -> F64:
    """Depth [m] of the queries in `rows`, which touch or overlap; -1 where `clearance` must tell, `SHALLOW` where it is not over `care.idle`."""
    if len(rows) == 0:
        return np.empty(0)
    from .depth_kernels import deepest

    wp = warp()
    depth = wp.zeros(len(rows), dtype=wp.float64, device=device)
    query = [
        *_sent(pairs, poses, device),
        _put(noise, wp.float64, device),
        care.tolerance,
        PRECISION,
        *(
            _put(np.broadcast_to(np.asarray(v, dtype=np.float64), len(pairs)), wp.float64, device)
            for v in (care.enough, care.idle)
        ),
        _put(rows.astype(np.int32), wp.int32, device),
    ]
    launch(deepest, len(rows), [wood, *query, depth], device=device, slice_size=DEPTH_SLICE)
    return np.asarray(depth.numpy())


def _put(values: NDArray[Any], dtype: Any, device: str) -> Any:
    return warp().array(np.ascontiguousarray(values), dtype=dtype, device=device, copy=device != "cpu")


def _sent(pairs: I32, poses: Relative, device: str) -> list[Any]:
    """Solids and poses of queries on the device."""
    wp = warp()
    return [
        _put(pairs[:, 0], wp.int32, device),
        _put(pairs[:, 1], wp.int32, device),
        _put(poses.rotation, wp.mat33d, device),
        _put(poses.translation, wp.vec3d, device),
    ]


def wood_on(forest: Forest, device: str) -> Any:
    """The forest on a device, as the kernels take it."""
    from . import clearance_kernels as kernels

    if device in forest.on_device:
        return forest.on_device[device]
    wp = warp()
    wood, trees = kernels.Wood(), forest.trees
    for name, values, dtype in (
        ("lower", trees.lower, wp.vec3d),
        ("upper", trees.upper, wp.vec3d),
        ("link", trees.link, wp.int32),
        ("span", trees.span, wp.int32),
        ("corners", forest.corners, wp.mat33d),
        ("face", forest.face, wp.int32),
        ("first_face", forest.first_face, wp.int32),
        ("heads", forest.heads, wp.vec3d),
        ("first_head", forest.first_head, wp.int32),
        ("volume", forest.volume, wp.int32),
    ):
        setattr(wood, name, wp.array(np.ascontiguousarray(values), dtype=dtype, device=device))
    forest.on_device[device] = wood
    return wood


def descend(
    wood: Any, pairs: I32, poses: Relative, touch: F64, skip_above: F64, device: str, *, slice_size: int | None = None
) -> tuple[F64, NDArray[np.bool_], NDArray[np.bool_]]:
    """Run both kernels over one chunk.

    Returns:
        Distance [m] of the soups, shape (n,); whether it is exact (else a lower bound beyond `skip_above`); whether a
        component of one that does not touch the other lies inside it.
    """
    from . import clearance_kernels as kernels

    wp = warp()

    count = len(pairs)
    query = _sent(pairs, poses, device)
    distance = wp.empty(count, dtype=wp.float64, device=device)
    face_a, face_b = (wp.empty(count, dtype=wp.int32, device=device) for _ in range(2))
    launch(
        kernels.nearest,
        count,
        [wood, *query, _put(touch, wp.float64, device), _put(skip_above, wp.float64, device), distance, face_a, face_b],
        device=device,
        slice_size=slice_size,
    )
    gap, found = distance.numpy(), face_a.numpy() >= 0
    free = np.flatnonzero(~(found & (gap <= touch))).astype(np.int32)
    held = wp.zeros(len(free), dtype=wp.int32, device=device)
    launch(kernels.contained, len(free), [wood, *query, _put(free, wp.int32, device), held], device=device, slice_size=slice_size)
    inside = np.zeros(count, dtype=bool)
    inside[free] = held.numpy() != 0
    return gap, found, inside
