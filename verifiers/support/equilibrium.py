"""Judges whether bodies that touch can rest: contact forces within friction cones that balance every weight.

One linear program per group of touching free bodies that rest, three where one does not, none where weight alone holds them (`support/piles.py`). Friction pyramids enclose the cones, joints and held bodies give
any force, so that a missing balance is a proof; a balance that exists says only that rest is possible. Rigid contact
forces with friction as a linear program: Erdmann (1994), doi:10.1177/027836499401300306; Livesley (1978),
doi:10.1002/nme.1620121207.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...worlds.arrays import F64, cross
from ...worlds.errors import EvidenceError
from .piles import rests_by_weight
from .touching import Contacts

__all__ = ["Balance", "Group", "solve"]

CONE_EDGES = 8
"""Edges of a friction pyramid. One face looks downhill, where the pyramid is exact; in between it is up to 8 % too wide."""
MOVES = 16
"""Directions in which a centre of mass may move; the measured way is at most 2 % too long."""
ROUGH = 4.0
"""Friction with which tipping is judged: the largest that a material may have."""
LEVEL = 1e-6
"""Sine of the slope of a contact below which it has no downhill direction."""
DEAR = 1e3
"""Own choice: cost of a force that nothing gives, per weight and size, so that moving a centre of mass comes first."""
ENOUGH = 1e-6
"""Share of a weight below which nothing is missing: the tolerance of the solver."""
OTHERS = 0.01
"""Own choice: cost of what is missing for a body that nothing says is at rest, against 1 for one that is."""


class Balance(NamedTuple):
    """Lack of support of a body that is to rest."""

    shift: float
    """Distance that its centre of mass must move, seen along gravity, so that it does not tip on the roughest contacts [m]."""
    way: F64
    """That move [m], shape (3,)."""
    missing: float
    """Force, as a share of its weight, that friction and contact cannot give once it does not tip."""

    @property
    def whole(self) -> bool:
        """True if it lacks nothing where it is."""
        return self.shift <= 0.0 and self.missing <= ENOUGH


@dataclass(frozen=True)
class Group:
    """Free bodies that touch each other, and every contact of theirs at one frame."""

    members: tuple[str, ...]
    contacts: tuple[tuple[str, str, Contacts], ...]
    """(pushed body, pushing body, contacts); the pushing one may be no member and then gives any force."""
    centers: F64
    """Centres of mass [m], shape (members, 3)."""
    weights: F64
    """[N], shape (members,)."""
    sizes: F64
    """Half diagonals [m], shape (members,)."""
    down: F64
    """Unit vector along gravity, shape (3,)."""

    def without(self, a: str, b: str) -> Group:
        """The same bodies as if two entities did not touch."""
        kept = tuple(c for c in self.contacts if {c[0], c[1]} != {a, b})
        return Group(self.members, kept, self.centers, self.weights, self.sizes, self.down)

    def alone(self, member: str) -> Group:
        """One of the bodies, on the others as if they could give any force."""
        index = [self.members.index(member)]
        kept = tuple(c for c in self.contacts if member in c[:2])
        return Group((member,), kept, self.centers[index], self.weights[index], self.sizes[index], self.down)

    def of(self, members: Collection[str]) -> Group:
        """Some of the bodies, as if the others were not there."""
        index = [i for i, m in enumerate(self.members) if m in members]
        gone = set(self.members) - set(members)
        kept = tuple(c for c in self.contacts if not {c[0], c[1]} & gone)
        picked = self.centers[index], self.weights[index], self.sizes[index]
        return Group(tuple(self.members[i] for i in index), kept, *picked, self.down)


def solve(group: Group, *, claimed: Iterable[str] = (), shift: float = 0.0) -> dict[str, Balance]:
    """Lack of support of every body of a group.

    Args:
        group: the bodies.
        claimed: bodies that are said to be at rest; the others may move if that spares these. Default all.
        shift: error of the centres of mass and contact points that is allowed for [m].
    """
    if rests_by_weight(group):
        return {m: Balance(0.0, np.zeros(3), 0.0) for m in group.members}
    said = set(claimed) or set(group.members)
    cost = np.array([1.0 if m in said else OTHERS for m in group.members])
    ways = _around(group.down)
    # Most groups rest as they are, which one program shows.
    missing = _missing(group, cost)
    moves = np.zeros((len(missing), 3))
    if missing.max() > ENOUGH:
        moves = _tipping(group, cost, ways)
        missing = _gripping(group, cost, ways, np.linalg.norm(moves, axis=1) + shift)
    return {
        m: Balance(float(np.linalg.norm(move)), move, float(lack))
        for m, move, lack in zip(group.members, moves, missing, strict=True)
    }


def _around(down: F64) -> F64:
    """Unit vectors across gravity, shape (MOVES, 3)."""
    axis = np.array([1.0, 0.0, 0.0]) if abs(down[0]) < 0.7 else np.array([0.0, 1.0, 0.0])
    first = axis - (axis @ down) * down
    first /= np.linalg.norm(first)
    turns = np.arange(MOVES) * 2.0 * np.pi / MOVES
    return np.asarray(np.cos(turns)[:, None] * first + np.sin(turns)[:, None] * cross(down, first))


def _pushes(group: Group, friction: float | None) -> Any:
    """Wrench on every body per unit of each contact force >= 0, sparse (6 x members, n); `friction` replaces that of all contacts.

    Forces are in units of the group's weight, moments about each body's centre of mass in units of its size.
    """
    row = {m: 6 * i for i, m in enumerate(group.members)}
    entries: list[tuple[NDArray[np.intp], NDArray[np.intp], F64]] = []
    start = 0
    for pushed, pushing, contacts in group.contacts:
        count = len(contacts.points)
        forces = _forces(group, contacts, contacts.friction if friction is None else np.full(count, friction))
        each = forces.shape[1]
        column = start + np.arange(count * each).reshape(count, each)
        for name, sign in ((pushed, 1.0), (pushing, -1.0)):
            if name in row:
                i = row[name] // 6
                arm = (contacts.points - group.centers[i]) / group.sizes[i]
                turn = cross(arm[:, None], forces)
                values = sign * np.concatenate([forces, turn], axis=2)
                rows = np.broadcast_to(row[name] + np.arange(6), values.shape)
                entries.append((rows.ravel(), np.broadcast_to(column[..., None], values.shape).ravel(), values.ravel()))
        start += count * each
    return _sparse(entries, 6 * len(group.members), start)


def _sparse(entries: list[tuple[NDArray[np.intp], NDArray[np.intp], F64]], rows: int, columns: int) -> Any:
    from scipy.sparse import coo_matrix

    if not entries:
        return coo_matrix((rows, columns))
    i, j, values = (np.concatenate(part) for part in zip(*entries, strict=True))
    return coo_matrix((values, (i, j)), shape=(rows, columns))


def _forces(group: Group, contacts: Contacts, friction: F64) -> F64:
    """Edges of the friction pyramid of each contact, shape (contacts, CONE_EDGES, 3)."""
    normal = contacts.normals
    downhill = group.down - (normal @ group.down)[:, None] * normal
    level = np.linalg.norm(downhill, axis=1) < LEVEL
    spare = np.where(np.abs(normal[:, :1]) < 0.7, [[1.0, 0.0, 0.0]], [[0.0, 1.0, 0.0]])
    along = np.where(level[:, None], cross(normal, spare), downhill)
    along /= np.linalg.norm(along, axis=1)[:, None]
    across = cross(normal, along)
    turns = (np.arange(CONE_EDGES) + 0.5) * 2.0 * np.pi / CONE_EDGES
    width = (friction / np.cos(np.pi / CONE_EDGES))[:, None, None]
    tangent = np.cos(turns)[None, :, None] * along[:, None] + np.sin(turns)[None, :, None] * across[:, None]
    return np.asarray(normal[:, None] + width * tangent)


def _moves(group: Group, ways: F64) -> Any:
    """Moment that the weight gains per move of the centre of mass [body sizes], sparse (6 x members, members x MOVES)."""
    from scipy.sparse import diags, kron

    block = np.zeros((6, len(ways)))
    block[3:] = cross(ways, group.down).T
    return kron(diags(group.weights / group.weights.sum()), block)


def _helpers(count: int, *, torque: bool) -> Any:
    """Wrenches that nothing gives: forces at every centre of mass and, if asked for, moments; sparse (6 x members, n)."""
    from scipy.sparse import identity, kron

    steps = np.array([(x, y, z) for x in (-1, 0, 1) for y in (-1, 0, 1) for z in (-1, 0, 1) if x or y or z], dtype=np.float64)
    steps /= np.linalg.norm(steps, axis=1)[:, None]
    block = np.zeros((6, len(steps) * (2 if torque else 1)))
    block[:3, : len(steps)] = steps.T
    if torque:
        block[3:, len(steps) :] = steps.T
    return kron(identity(count), block)


def _tipping(group: Group, cost: F64, ways: F64) -> F64:
    """Least moves of the centres of mass across gravity [m], shape (members, 3), that stop tipping on the roughest contacts."""
    from scipy.sparse import hstack

    push = _pushes(group, ROUGH)
    moves, lift = _moves(group, ways), _helpers(len(group.members), torque=False)
    dear = np.full(lift.shape[1], DEAR * group.sizes.max())
    price = np.concatenate([np.zeros(push.shape[1]), np.repeat(cost * group.sizes, len(ways)), dear])
    found = _minimum(price, hstack([push, moves, lift]), _load(group))
    each = found[push.shape[1] :][: moves.shape[1]].reshape(len(group.members), len(ways))
    return np.asarray(group.sizes[:, None] * (each @ ways))


def _missing(group: Group, cost: F64) -> F64:
    """Least force and moment that nothing gives where all stay as they are, as a share of each body's weight, shape (members,)."""
    from scipy.sparse import hstack

    push, lift = _pushes(group, None), _helpers(len(group.members), torque=True)
    each = lift.shape[1] // len(group.members)
    price = np.concatenate([np.zeros(push.shape[1]), np.repeat(cost, each)])
    # Of a program of this form a presolve takes longer than it spares.
    found = _minimum(price, hstack([push, lift]), _load(group), presolve=False)
    share = group.weights / group.weights.sum()
    return np.asarray(found[push.shape[1] :].reshape(-1, each).sum(axis=1) / share)


def _gripping(group: Group, cost: F64, ways: F64, shifts: F64) -> F64:
    """Least force and moment that nothing gives, as a share of each body's weight, shape (members,)."""
    from scipy.sparse import coo_matrix, hstack, identity, kron

    count = len(group.members)
    push = _pushes(group, None)
    moves, lift = _moves(group, ways), _helpers(count, torque=True)
    share = group.weights / group.weights.sum()
    each = lift.shape[1] // count
    price = np.concatenate([np.zeros(push.shape[1] + moves.shape[1]), np.repeat(cost, each)])
    spent = kron(identity(count), np.ones((1, len(ways))))
    total = hstack([coo_matrix((count, push.shape[1])), spent, coo_matrix((count, lift.shape[1]))]).tocsr()
    found = _minimum(price, hstack([push, moves, lift]), _load(group), (total, shifts / group.sizes))
    return np.asarray(found[-count * each :].reshape(count, each).sum(axis=1) / share)


def _load(group: Group) -> F64:
    """Forces and torques that the contacts must give, in units of the group's weight, shape (6 x members,)."""
    load = np.zeros((len(group.members), 6))
    load[:, :3] = -(group.weights / group.weights.sum())[:, None] * group.down
    return load.reshape(-1)


def _minimum(price: F64, matrix: Any, load: F64, limit: tuple[Any, F64] | None = None, *, presolve: bool = True) -> F64:
    """Cheapest solution >= 0; one exists always, because missing forces can be bought.

    Raises:
        EvidenceError: the solver gives none.
    """
    from scipy.optimize import linprog

    less = {} if limit is None else {"A_ub": limit[0], "b_ub": limit[1]}
    options = {"presolve": presolve}
    found = linprog(price, A_eq=matrix.tocsr(), b_eq=load, bounds=(0.0, None), method="highs", options=options, **less)
    if found.x is None and not presolve:
        return _minimum(price, matrix, load, limit)
    if found.x is None:
        raise EvidenceError(f"the balance of contact forces has no numeric solution: {found.message}")
    return np.asarray(found.x)
