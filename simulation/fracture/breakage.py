"""Loads on bonded pieces, the bonds that break under them, and what is recorded of it."""

from __future__ import annotations

import base64
import json
import math
from dataclasses import dataclass, field
from enum import Enum
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from threadpoolctl import ThreadpoolController

from ...worlds.arrays import F64
from ...worlds.bonds import WORLD, components
from ...worlds.fracture import SHARES
from .clusters import Cluster, clusters_of
from .network import BondNetwork
from .stiffness import Stiffness

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from ...worlds.built import BuiltEntity
    from ...worlds.spec import Breakable, WorldSpec
    from ..rigid.model import RigidModel

__all__ = ["Breakage", "Fate"]

TOGETHER = 0.6
"""Bonds of the two pieces at the worst bond that are loaded to this share of it break with it. A load that grows breaks bonds
one after the other, and what it does to the others depends on those that broke; so the load of all others is found anew."""
CHANGE = (0.005, 0.1, 0.5)
"""Change of a load, in parts of the largest one last solved for, that asks for a new solution: the first where a bond is about to
break, plus the second times what loads must grow by until one does, at most the third."""
FAINT = 1e-9
"""Loads below this share of a cluster's weight are none."""
FAINT_CAUSE = 1e-3
"""Loads below this share of a piece's weight are not what breaks a bond."""
LASTING = 100.0
"""Contact times after which a load counts as lasting: the pieces' inertia no longer carries a part of it."""
MOST_RETAKES = 8
"""How often a step is taken again with what broke in it apart, where another body struck it."""
FEW_RETAKES = 1
"""The same where only pieces of the body itself push one another. With none, what is bonded to the world swallows the blow."""
NO_CAUSE = -1
PARTNER = -2
"""As a cause: what liquids, cloth or grains of a two-way coupling give."""


@dataclass
class _Body:
    """One breakable entity."""

    built: BuiltEntity
    breakable: Breakable
    network: BondNetwork
    centers: F64
    mass: F64
    inertia: F64
    whole: Any
    load: F64
    """Contact forces and torques about the pieces' centres, smoothed over the contact time, entity's frame, shape (n, 6)."""
    lasting: F64
    """The same, smoothed over `LASTING` contact times."""
    cause: Any
    """Collider that loaded each piece last, shape (n,)."""
    pressing: F64
    """Contact force on each piece in the last step in which it had one, shape (n, 6)."""
    partner: Any
    """Tree of the model that a piece touched then; -1: none, or none that may sleep, shape (n,)."""
    ids: Any
    """Body of the model that holds each piece, shape (n,)."""
    middle: F64
    """Centre of mass of each piece's cluster, entity's frame [m], shape (n, 3)."""
    factors: dict[tuple[str, float], Stiffness] = field(default_factory=dict)
    """Per cluster and share of the contact time its stiffness; 0: under lasting loads."""
    solved: dict[str, tuple[F64, float]] = field(default_factory=dict)
    """Per cluster the loads last solved for, both kinds side by side, and the largest ratio found."""
    clusters: list[Cluster] = field(default_factory=list)
    bonded: list[Cluster] = field(default_factory=list)
    """Those of them that have bonds."""


@dataclass
class _Break:
    time: float
    bond: int
    point: F64
    cause: int
    ratio: float
    energy: float
    case: int


@dataclass
class _Case:
    """Loads under which bonds broke at one moment."""

    rows: Any
    loads: F64
    """Lasting and sudden, shape (n, 12)."""
    spin: F64


class Fate(Enum):
    """What becomes of the clusters in a step."""

    WHOLE = "whole"
    AGAIN = "again"
    """Some fell apart; the step is to be taken again with the pieces apart."""
    AFTER = "after"
    """Some fall apart at its end."""


class _Pushed(NamedTuple):
    """Contacts of one entity's pieces in a step."""

    force: F64
    """Forces and torques about the pieces' centres, entity's frame, shape (n, 6)."""
    cause: Any
    """Collider that pushes each piece most; -1: none, shape (n,)."""
    tree: Any
    """Tree of the model that it belongs to; -1: it cannot move, shape (n,)."""


class Breakage:
    """Bonds of all breakable members of a rigid instance.

    A contact force acts on the bonds as its mean over the contact time tau: dL / dt = (F - L) / tau. An impulse J loads them
    with J / tau whatever the step; a lasting force F with F. What changes within `LASTING` tau meets the pieces' inertia as
    well, so that a blow is felt near where it hits; what lasts, and gravity, is in equilibrium with the bonds alone and, in
    clusters that move, with their acceleration.

    Args:
        spec: the specification.
        built: built entities.
        members: of the instance.
    """

    def __init__(self, spec: WorldSpec, built: Mapping[str, BuiltEntity], members: Sequence[str]) -> None:
        self.gravity = np.array(spec.simulation.gravity)
        self.names = tuple(m for m in members if spec.entities[m].breakable is not None and built[m].bonds is not None)
        self._bodies = [_body(spec, built[n], n) for n in self.names]
        counts = [len(b.whole) for b in self._bodies]
        self._first_bond = np.concatenate([[0], np.cumsum(counts)]).astype(np.int64)
        self._first_piece = np.concatenate([[0], np.cumsum([len(b.mass) for b in self._bodies])]).astype(np.int64)
        # Its threads would spin between the small products here for longer than they work in them.
        self._blas = ThreadpoolController().select(user_api="blas")
        self.energy = 0.0
        """Elastic energy of the bonds that broke since frame 0, or their toughness where that is more [J]."""
        self.begin()

    def __bool__(self) -> bool:
        return bool(self.names)

    def whole(self) -> dict[str, Any]:
        """Which bonds hold, per entity."""
        return {n: b.whole.copy() for n, b in zip(self.names, self._bodies, strict=True)}

    def clusters(self, entity: str) -> list[Cluster]:
        """Present clusters of a member."""
        return list(self._bodies[self.names.index(entity)].clusters)

    def bind(self, rigid: RigidModel) -> None:
        """Work with this model, whose bodies are the clusters of the present bonds."""
        model = rigid.model
        self._row_of_geom = np.full(model.ngeom, -1, dtype=np.int64)
        self._entity_of_geom = np.full(model.ngeom, -1, dtype=np.int64)
        row = {name: k for k, name in enumerate(rigid.bodies)}
        self._rows_of = [np.array([row[f"{b.built.entity}/{p.name}"] for p in b.built.bodies]) for b in self._bodies]
        self._collider_of_geom, self._names = rigid.geom_collider, rigid.colliders
        self._tree_of_geom = model.body_treeid[model.geom_bodyid]
        self._tree_of_body = np.array(model.body_treeid)
        self._ids: list[dict[str, int]] = []
        for index, body in enumerate(self._bodies):
            # Another model has other trees, all of them awake.
            body.partner[:] = -1
            entity = body.built.entity
            body.clusters = clusters_of(body.built, body.whole)
            body.bonded = [c for c in body.clusters if c.fixed or len(c.pieces) > 1]
            self._ids.append({c.name: model.body(c.name).id for c in body.clusters})
            row = {b.name: k for k, b in enumerate(body.built.bodies)}
            bonded = np.zeros(len(body.mass), dtype=bool)
            for cluster in body.clusters:
                own = list(cluster.pieces)
                body.ids[own], body.middle[own] = self._ids[index][cluster.name], cluster.center
                bonded[own] = cluster.fixed or len(own) > 1
            for part in body.built.parts:
                for k in range(len(part.collision)):
                    if bonded[row[part.body]]:  # what is loose has no bonds to load
                        geom = model.geom(f"{entity}/{part.part}/{k}").id
                        self._row_of_geom[geom], self._entity_of_geom[geom] = row[part.body], index
            # What belongs to clusters that are no more is forgotten.
            alive = {c.name: len(c.pieces) for c in body.clusters}
            body.factors = _inherited(body)
            body.solved = {k: s for k, s in body.solved.items() if alive.get(k) == len(s[0])}

    # ------------------------------------------------------------------ frames and checkpoints

    def begin(self) -> None:
        """Start a frame."""
        self._breaks: list[_Break] = []
        self._cases: list[_Case] = []
        self._times: list[float] = []
        self._peak = [np.zeros(len(b.whole)) for b in self._bodies]
        self._given = [np.zeros((len(b.mass), 6)) for b in self._bodies]

    def memory(self) -> bytes:
        """Bonds, loads and causes as bytes."""
        held = [[_text(b.whole.astype(np.uint8)), _text(b.load), _text(b.lasting), _text(b.cause)] for b in self._bodies]
        return json.dumps([self.energy, held]).encode()

    def recall(self, memory: bytes) -> bool:
        """Return to a memory; whether other clusters come of it, so that the model must be made anew."""
        self.energy, held = json.loads(memory)
        changed = False
        for body, (whole, load, lasting, cause) in zip(self._bodies, held, strict=True):
            now = _array(whole, np.uint8).astype(bool)
            changed |= bool((now != body.whole).any())
            body.whole = now
            body.load = _array(load, np.float64).reshape(-1, 6)
            body.lasting = _array(lasting, np.float64).reshape(-1, 6)
            body.cause = _array(cause, np.int64)
            # Solutions are not part of a checkpoint: the run that goes on forgets them as well.
            body.factors, body.solved = {}, {}
        self.begin()
        return changed

    def sleepers(self) -> list[tuple[F64, Any]]:
        """What lies on the pieces and may be asleep, for `lay`."""
        return [(b.pressing.copy(), b.partner.copy()) for b in self._bodies]

    def lay(self, sleepers: list[tuple[F64, Any]]) -> None:
        """Put back what lay on the pieces of the same model."""
        for body, (pressing, partner) in zip(self._bodies, sleepers, strict=True):
            body.pressing, body.partner = pressing.copy(), partner.copy()

    # ------------------------------------------------------------------ per step

    def watch(
        self, data: Any, time: float, dt: float, still: frozenset[str], *, retakes: int = 0, others: F64 | None = None
    ) -> Fate:
        """Load the bonds with the contact forces of the step that ends at `time` [s]; what becomes of clusters.

        Args:
            data: state with solved contacts, before the integration.
            time: end of the step.
            dt: its length [s].
            still: entities that something holds; their bonds do not break.
            retakes: how often this step was taken already.
            others: wrenches of partners on the instance's bodies about their centres, world axes, shape (rows, 6) [N, N m].

        The step is taken again with the pieces apart, or what strikes them would feel the whole body: `MOST_RETAKES` times where
        another body strikes, `FEW_RETAKES` times where loose pieces push others off, through faces that crumble. What breaks after
        that goes apart at the step's end.
        """
        with self._blas.limit(limits=1):
            return self._watch(data, time, dt, still, retakes, others)

    def _watch(self, data: Any, time: float, dt: float, still: frozenset[str], retakes: int, others: F64 | None) -> Fate:
        pushed = self._with_partners(self._contacts(data), others, data)
        apart, struck = False, False
        known = [(b.load, b.lasting, b.cause) for b in self._bodies]
        for index, body in enumerate(self._bodies):
            share = -math.expm1(-dt / body.breakable.bond.contact_time)
            force, cause = self._felt(body, pushed.get(index), data)
            before = body.load
            body.load = before * (1 - share) if force is None else before + share * (force - before)
            body.lasting = body.lasting + share / LASTING * (body.load - body.lasting)
            if cause is not None:
                body.cause = np.where(cause != NO_CAUSE, cause, body.cause)
            if body.built.entity in still:
                continue
            # Every cluster is judged, whatever became of the others.
            for cluster in body.bonded:
                if self._judge(index, cluster, data, time):
                    apart, struck = True, struck or self._struck(body, cluster)
        again = apart and retakes < (MOST_RETAKES if struck else FEW_RETAKES)
        if again:
            # The step is taken again, with the pieces apart.
            for body, (load, lasting, cause) in zip(self._bodies, known, strict=True):
                body.load, body.lasting, body.cause = load, lasting, cause
        else:
            for index, body in enumerate(self._bodies):
                force, _ = self._felt(body, pushed.get(index), data)
                if force is not None:
                    self._given[index] += dt * self._in_world(index, force, data)
                self._remember(body, pushed.get(index), data)
        if not apart:
            return Fate.WHOLE
        return Fate.AGAIN if again else Fate.AFTER

    def _felt(self, body: _Body, pushed: _Pushed | None, data: Any) -> tuple[F64 | None, Any]:
        """Forces on an entity's pieces: those of listed contacts, and where they or what lies on them sleep, whose contacts are not,
        the last ones."""
        resting = self._asleep(body.partner, data) | self._asleep(self._tree_of_body[body.ids], data)
        if not resting.any():
            return (None, None) if pushed is None else (pushed.force, pushed.cause)
        force = np.zeros_like(body.pressing) if pushed is None else pushed.force.copy()
        resting &= ~force.any(axis=1)
        force[resting] = body.pressing[resting]
        return force, None if pushed is None else pushed.cause

    @staticmethod
    def _asleep(trees: Any, data: Any) -> Any:
        """Which of these trees sleep; -1 is none."""
        if not len(data.tree_asleep):
            return np.zeros(len(trees), dtype=bool)
        return (trees >= 0) & (data.tree_asleep[np.maximum(trees, 0)] >= 0)

    def _remember(self, body: _Body, pushed: _Pushed | None, data: Any) -> None:
        """Keep the contacts of this step for when they are no longer listed; what is awake and touches nothing has none."""
        own = self._tree_of_body[body.ids]
        gone = (own >= 0) & ~self._asleep(own, data) & ~self._asleep(body.partner, data)
        body.pressing[gone], body.partner[gone] = 0.0, NO_CAUSE
        if pushed is not None:
            touched = pushed.force.any(axis=1)
            body.pressing[touched], body.partner[touched] = pushed.force[touched], pushed.tree[touched]

    def _contacts(self, data: Any) -> dict[int, _Pushed]:
        """What contacts do to the pieces of each entity that has any."""
        if not data.ncon or not data.nefc:
            return {}
        contact = data.contact
        geoms = contact.geom
        hit = (self._entity_of_geom[geoms] >= 0).any(axis=1) & (contact.efc_address >= 0)
        hit[hit] = data.efc_force[contact.efc_address[hit]] != 0.0
        if not hit.any():
            return {}
        rows, sizes = contact.efc_address[hit], contact.dim[hit]
        frames, points, geoms = contact.frame[hit].reshape(-1, 3, 3), contact.pos[hit], geoms[hit]
        inner = np.stack([data.efc_force[rows + k] for k in range(3)], axis=1)
        force = np.einsum("nij,ni->nj", frames, inner)
        moment = np.zeros_like(force)
        rolling = np.flatnonzero(sizes > 3)
        if len(rolling):
            inner = np.stack([data.efc_force[rows[rolling] + k] for k in (3, 4, 5)], axis=1)
            moment[rolling] = np.einsum("nij,ni->nj", frames[rolling], inner)
        found: dict[int, _Pushed] = {}
        for side, sign in ((0, -1.0), (1, 1.0)):
            mine = geoms[:, side]
            for index in np.unique(self._entity_of_geom[mine]).tolist():
                if index < 0:
                    continue
                body = self._bodies[index]
                none = np.full(len(body.mass), NO_CAUSE)
                total, cause, tree = found.setdefault(index, _Pushed(np.zeros((len(body.mass), 6)), none, none.copy()))
                take = np.flatnonzero(self._entity_of_geom[mine] == index)
                piece = self._row_of_geom[mine[take]]
                turn, origin = self._placed(index, data, piece)
                local = np.einsum("nji,nj->ni", turn, sign * force[take])
                arm = np.einsum("nji,nj->ni", turn, points[take] - origin)
                twist = np.einsum("nji,nj->ni", turn, sign * moment[take]) + np.cross(arm, local)
                np.add.at(total, piece, np.concatenate([local, twist], axis=1))
                order = np.argsort(np.linalg.norm(local, axis=1), kind="stable")
                pressing = order[np.linalg.norm(local[order], axis=1) > 0]
                cause[piece[pressing]] = self._collider_of_geom[geoms[take[pressing], 1 - side]]
                tree[piece[pressing]] = self._tree_of_geom[geoms[take[pressing], 1 - side]]
        return found

    def _with_partners(self, pushed: dict[int, _Pushed], others: F64 | None, data: Any) -> dict[int, _Pushed]:
        """Contacts, and what liquids, cloth and grains do to the pieces: no collider of the instance is the cause of that."""
        for index, body in enumerate(self._bodies if others is not None else ()):
            assert others is not None
            turn, _ = self._placed(index, data, np.arange(len(body.mass)))
            given = others[self._rows_of[index]]
            own = np.concatenate(
                [np.einsum("nji,nj->ni", turn, given[:, :3]), np.einsum("nji,nj->ni", turn, given[:, 3:])], axis=1
            )
            if not own.any():
                continue
            none = np.full(len(body.mass), NO_CAUSE)
            known = pushed.get(index) or _Pushed(np.zeros_like(own), none, none.copy())
            more = np.linalg.norm(own[:, :3], axis=1) > np.linalg.norm(known.force[:, :3], axis=1)
            pushed[index] = _Pushed(known.force + own, np.where(more, PARTNER, known.cause), known.tree)
        return pushed

    def _placed(self, index: int, data: Any, piece: Any) -> tuple[F64, F64]:
        """Rotations (n, 3, 3) and centres (n, 3) of pieces in the world."""
        body = self._bodies[index]
        turn = data.xmat[body.ids[piece]].reshape(-1, 3, 3)
        return turn, data.xpos[body.ids[piece]] + np.einsum("nij,nj->ni", turn, body.centers[piece] - body.middle[piece])

    def _in_world(self, index: int, force: F64, data: Any) -> F64:
        turn, _ = self._placed(index, data, np.arange(len(force)))
        return np.concatenate([np.einsum("nij,nj->ni", turn, force[:, :3]), np.einsum("nij,nj->ni", turn, force[:, 3:])], axis=1)

    # ------------------------------------------------------------------ bonds

    def _judge(self, index: int, cluster: Cluster, data: Any, time: float) -> bool:
        """Break what a cluster's load breaks; whether it fell apart.

        What the world still holds is judged again at once: what pushes it pushes no less where other pieces give way. What
        came off is pushed less, and waits for the step to be taken again.
        """
        if not self._break(index, cluster, data, time):
            return False
        body, todo = self._bodies[index], [cluster]
        while todo:
            held = set(todo.pop().pieces)
            for part in clusters_of(body.built, body.whole):
                if part.fixed and part.pieces[0] in held and self._break(index, part, data, time):
                    todo.append(part)
        return True

    def _break(self, index: int, cluster: Cluster, data: Any, time: float) -> bool:
        """Break what the load of a cluster breaks until it falls apart; whether it does."""
        body = self._bodies[index]
        if len(cluster.pieces) == 1 and not cluster.fixed:
            return False
        pieces = np.array(cluster.pieces)
        lasting = body.lasting[pieces]
        loads = np.concatenate([lasting, body.load[pieces] - lasting], axis=1)
        known = body.solved.get(cluster.name)
        if known is not None:
            # Its own weight loads what the world holds.
            weight = cluster.mass * max(float(np.linalg.norm(self.gravity)), 1.0)
            least = weight / len(pieces) if cluster.fixed else FAINT * weight
            allowed = min(CHANGE[0] + CHANGE[1] * (1.0 / max(known[1], 1e-9) - 1.0), CHANGE[2])
            scale = max(float(np.abs(known[0]).max(initial=0.0)), least)
            if float(np.abs(loads - known[0]).max(initial=0.0)) <= allowed * scale:
                return False
        owner = int(body.ids[cluster.pieces[0]])
        turn = data.xmat[owner].reshape(3, 3)
        spin = np.zeros(3) if cluster.fixed else turn.T @ data.cvel[owner, :3]
        total = lasting + self._own_forces(body, cluster, lasting, turn, spin)
        case = -1
        shares = SHARES if np.abs(loads[:, 6:]).max(initial=0.0) > 0 else (0.0,)
        while True:
            stiffness = self._stiffness(body, cluster, 0.0)
            steady = body.network.carry(stiffness, total)
            for share in shares:
                force = steady
                if share:
                    force = steady + body.network.carry(self._stiffness(body, cluster, share), loads[:, 6:])
                ratio, energy = body.network.limit(stiffness.faces, force)
                worst = float(ratio.max(initial=0.0))
                if worst > 1.0:
                    break
            if worst <= 1.0:
                peak = self._peak[index]
                peak[stiffness.bonds] = np.maximum(peak[stiffness.bonds], ratio)
                body.solved[cluster.name] = (loads.copy(), worst)
                return False
            ends = body.network.bonds.pieces[stiffness.bonds]
            around = np.isin(ends, [e for e in ends[int(ratio.argmax())] if e != WORLD]).any(axis=1)
            broken = np.flatnonzero(around & (ratio > 1.0) & (ratio >= TOGETHER * worst))
            if case < 0:
                case = self._keep_case(index, pieces, loads, spin, time)
            self._note(index, cluster, stiffness.bonds[broken], ratio[broken], energy[broken], case, data, time)
            body.whole[stiffness.bonds[broken]] = False
            body.solved.pop(cluster.name, None)
            if self._fell_apart(body, cluster):
                return True

    def _stiffness(self, body: _Body, cluster: Cluster, share: float) -> Stiffness:
        """A cluster's stiffness under loads that act for a share of the contact time; 0: for ever."""
        key, pieces = (cluster.name, share), np.array(cluster.pieces)
        known = body.factors.get(key)
        if known is None or not known.follow(pieces, body.whole):
            within = share * body.breakable.bond.contact_time
            known = Stiffness(body.network, pieces, body.whole, held=cluster.fixed, within=within)
            body.factors[key] = known
        return known

    def _own_forces(self, body: _Body, cluster: Cluster, loads: F64, turn: F64, spin: F64) -> F64:
        """Gravity, or inertia against the loads where the cluster is free to move; cluster's pieces, shape (n, 6)."""
        pieces = np.array(cluster.pieces)
        mass = body.mass[pieces]
        own = np.zeros((len(pieces), 6))
        if cluster.fixed:
            own[:, :3] = mass[:, None] * (turn.T @ self.gravity)
            return own
        arm = body.centers[pieces] - cluster.center
        force = loads[:, :3].sum(axis=0)
        torque = loads[:, 3:].sum(axis=0) + np.cross(arm, loads[:, :3]).sum(axis=0)
        gain = np.linalg.solve(cluster.inertia, torque - np.cross(spin, cluster.inertia @ spin))
        speedup = force / cluster.mass + np.cross(gain, arm) + np.cross(spin, np.cross(spin, arm))
        own[:, :3] = -mass[:, None] * speedup
        own[:, 3:] = -(body.inertia[pieces] @ gain + np.cross(spin, body.inertia[pieces] @ spin))
        return own

    def _fell_apart(self, body: _Body, cluster: Cluster) -> bool:
        labels, fixed = components(len(body.mass), body.network.bonds, body.whole)
        own = labels[list(cluster.pieces)]
        return bool((own != own[0]).any() or fixed[own[0]] != cluster.fixed)

    def _keep_case(self, index: int, pieces: Any, loads: F64, spin: F64, time: float) -> int:
        loaded = np.flatnonzero(np.abs(loads).max(axis=1) > 0)
        rows = self._first_piece[index] + pieces[loaded]
        self._cases.append(_Case(rows, loads[loaded].copy(), spin.copy()))
        self._times.append(time)
        return len(self._cases) - 1

    def _note(
        self, index: int, cluster: Cluster, broken: Any, ratio: F64, energy: F64, case: int, data: Any, time: float
    ) -> None:
        """Record bonds that break, with the energy that they hold when the growing load reaches their strength."""
        body = self._bodies[index]
        owner = int(body.ids[cluster.pieces[0]])
        turn, origin = (
            data.xmat[owner].reshape(3, 3),
            data.xpos[owner] - data.xmat[owner].reshape(3, 3) @ body.middle[cluster.pieces[0]],
        )
        cause = self._cause(body, cluster)
        first = int(self._first_bond[index])
        for bond, times, held in zip(broken.tolist(), ratio.tolist(), energy.tolist(), strict=True):
            at = origin + turn @ body.network.bonds.point[bond]
            spent = held / times**2
            self.energy += spent
            self._breaks.append(_Break(time, first + bond, at, cause, times, spent, case))
            self._peak[index][bond] = max(self._peak[index][bond], times)

    def _cause(self, body: _Body, cluster: Cluster) -> int:
        """Collider that pushes the cluster most; none where its own weight outdoes that."""
        pieces = np.array(cluster.pieces)
        strength = np.abs(body.load[pieces]).max(axis=1)
        heaviest = int(strength.argmax())
        weight = float(np.linalg.norm(self.gravity)) * float(body.mass[pieces].mean())
        return int(body.cause[pieces[heaviest]]) if strength[heaviest] > FAINT_CAUSE * weight else NO_CAUSE

    def _struck(self, body: _Body, cluster: Cluster) -> bool:
        """Whether another body pushes the cluster most, or its own weight."""
        cause = self._cause(body, cluster)
        return cause < 0 or self._names[cause] != body.built.entity

    # ------------------------------------------------------------------ output

    def arrays(self) -> dict[str, Any]:
        """Channels `bond/*`, `break/*`, `case/*` and `load/*` of the frame."""
        breaks, cases = self._breaks, self._cases
        given = np.concatenate(self._given) if self._given else np.zeros((0, 6))
        loaded = np.flatnonzero(given.any(axis=1))
        counts = np.array([len(c.rows) for c in cases], dtype=np.int64)
        return {
            "bond/broken": np.concatenate([~b.whole for b in self._bodies]).astype(np.uint8),
            "bond/stress": np.concatenate(self._peak).astype(np.float32),
            "break/time": np.array([b.time for b in breaks]),
            "break/bond": np.array([b.bond for b in breaks], dtype=np.int32),
            "break/point": np.array([b.point for b in breaks], dtype=np.float64).reshape(-1, 3),
            "break/cause": np.array([b.cause for b in breaks], dtype=np.int32),
            "break/ratio": np.array([b.ratio for b in breaks], dtype=np.float64),
            "break/energy": np.array([b.energy for b in breaks], dtype=np.float64),
            "break/case": np.array([b.case for b in breaks], dtype=np.int32),
            "case/count": counts.astype(np.int32),
            "case/spin": np.array([c.spin for c in cases], dtype=np.float64).reshape(-1, 3),
            "case/piece": (np.concatenate([c.rows for c in cases]) if cases else np.zeros(0)).astype(np.int32),
            "case/load": (np.concatenate([c.loads for c in cases]) if cases else np.zeros((0, 12))).astype(np.float64),
            "load/piece": loaded.astype(np.int32),
            "load/impulse": given[loaded],
        }


def _body(spec: WorldSpec, built: BuiltEntity, name: str) -> _Body:
    breakable = spec.entities[name].breakable
    assert breakable is not None
    assert built.bonds is not None
    centers = np.array([b.pose.apply(b.center[None])[0] for b in built.bodies])
    mass, inertia = np.array([b.mass for b in built.bodies]), np.array([b.inertia for b in built.bodies])
    return _Body(
        built=built,
        breakable=breakable,
        network=BondNetwork(built.bonds, centers, breakable.bond, mass, inertia),
        centers=centers,
        mass=mass,
        inertia=inertia,
        whole=np.ones(len(built.bonds), dtype=bool),
        load=np.zeros((len(built.bodies), 6)),
        pressing=np.zeros((len(built.bodies), 6)),
        partner=np.full(len(built.bodies), NO_CAUSE, dtype=np.int64),
        ids=np.zeros(len(built.bodies), dtype=np.int64),
        middle=np.zeros((len(built.bodies), 3)),
        lasting=np.zeros((len(built.bodies), 6)),
        cause=np.full(len(built.bodies), NO_CAUSE, dtype=np.int64),
    )


def _inherited(body: _Body) -> dict[tuple[str, float], Stiffness]:
    """What is known of the stiffness of clusters, handed to the largest part of each that is left."""
    found: dict[tuple[str, float], Stiffness] = {}
    for (_, share), stiffness in body.factors.items():
        parts = [c for c in body.clusters if c.pieces[0] in stiffness.pieces and c.fixed == stiffness.held]
        if parts:
            found[max(parts, key=lambda c: len(c.pieces)).name, share] = stiffness
    return found


def _text(values: Any) -> str:
    return base64.b64encode(np.ascontiguousarray(values).tobytes()).decode()


def _array(text: str, kind: Any) -> Any:
    return np.frombuffer(base64.b64decode(text), dtype=kind).copy()
