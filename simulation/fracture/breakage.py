"""Loads on bonded pieces and what becomes of their bonds, step by step."""

from __future__ import annotations

import base64
import json
import math
from contextlib import nullcontext
from enum import Enum
from typing import TYPE_CHECKING, Any

import numpy as np
from threadpoolctl import ThreadpoolController

from ...worlds.arrays import F64
from .breaking import Breaker
from .clusters import Cluster, clusters_of
from .pieces import NO_CAUSE, pieces_of
from .pushes import Pushes
from .records import Records

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from contextlib import AbstractContextManager

    from ...worlds.built import BuiltEntity
    from ...worlds.spec import WorldSpec
    from ..rigid.model import RigidModel

__all__ = ["Breakage", "Fate"]

LASTING = 100.0
"""Contact times after which a load counts as lasting: the pieces' inertia no longer carries a part of it."""
MOST_RETAKES = 8
"""Most times that a step is taken again with what broke in it apart, where another body struck it."""
FEW_RETAKES = 1
"""The same where only pieces of the body itself push one another. With none, what is bonded to the world swallows the blow."""


class Fate(Enum):
    """The fate of the clusters in a step."""

    WHOLE = "whole"
    AGAIN = "again"
    """Some fell apart; the step is to be taken again with the pieces apart."""
    AFTER = "after"
    """Some fall apart at its end."""


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
        self.names = tuple(m for m in members if spec.entities[m].breakable is not None and built[m].bonds is not None)
        self._bodies = [pieces_of(spec, built[n], n) for n in self.names]
        self._pushes, self._records = Pushes(self._bodies), Records(self._bodies)
        gravity = np.array(spec.simulation.gravity)
        self._breakers = [Breaker(body, k, gravity, self._records) for k, body in enumerate(self._bodies)]
        self._blas = ThreadpoolController().select(user_api="blas")

    def __bool__(self) -> bool:
        return bool(self.names)

    @property
    def energy(self) -> float:
        """Energy of the bonds that broke since frame 0 [J]."""
        return self._records.energy

    def whole(self) -> dict[str, Any]:
        """Which bonds hold, per entity."""
        return {n: b.whole.copy() for n, b in zip(self.names, self._bodies, strict=True)}

    def clusters(self, entity: str) -> list[Cluster]:
        """Present clusters of a member."""
        return list(self._bodies[self.names.index(entity)].clusters)

    def bind(self, rigid: RigidModel) -> None:
        """Work with this model, whose bodies are the clusters of the present bonds."""
        self._colliders = rigid.colliders
        for body in self._bodies:
            names = [c.name for c in clusters_of(body.built, body.whole)]
            body.bind({name: rigid.model.body(name).id for name in names})
        self._pushes.bind(rigid)

    # ------------------------------------------------------------------ frames and checkpoints

    def begin(self) -> None:
        """Start a frame."""
        self._records.begin()

    def arrays(self) -> dict[str, Any]:
        """Channels `bond/*`, `break/*`, `case/*` and `load/*` of the frame."""
        return self._records.arrays()

    def memory(self) -> bytes:
        """Bonds, loads and causes as bytes."""
        held = [[_text(b.whole.astype(np.uint8)), _text(b.load), _text(b.lasting), _text(b.cause)] for b in self._bodies]
        return json.dumps([self.energy, held]).encode()

    def recall(self, memory: bytes) -> bool:
        """Return to a memory; whether other clusters come of it, so that the model must be made anew."""
        self._records.energy, held = json.loads(memory)
        changed = False
        for body, (whole, load, lasting, cause) in zip(self._bodies, held, strict=True):
            now = _array(whole, np.uint8).astype(bool)
            changed |= bool((now != body.whole).any())
            body.whole = now
            body.load = _array(load, np.float64).reshape(-1, 6)
            body.lasting = _array(lasting, np.float64).reshape(-1, 6)
            body.cause = _array(cause, np.int64)
            body.forget()
        self.begin()
        return changed

    def sleepers(self) -> tuple[F64, Any]:
        """Forces of bodies that lie on the pieces and may be asleep, for `lay`."""
        return self._pushes.sleepers()

    def lay(self, sleepers: tuple[F64, Any]) -> None:
        """Put back what lay on the pieces of the same model."""
        self._pushes.lay(sleepers)

    # ------------------------------------------------------------------ per step

    def alone(self) -> AbstractContextManager[Any]:
        """Within it BLAS works in one thread: its threads would spin between the small products here for longer than they work."""
        return self._blas.limit(limits=1) if self else nullcontext()

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
            others: wrenches of coupled solvers on the instance's bodies about their centres, world axes, shape (rows, 6) [N, N m].

        The step is taken again with the pieces apart, or what strikes them would feel the whole body: `MOST_RETAKES` times where
        another body strikes, `FEW_RETAKES` times where loose pieces push others off, through faces that crumble. What breaks after
        that goes apart at the step's end.
        """
        pushed, felt = self._pushes.found(data, others)
        apart, struck = False, False
        known = [(b.load, b.lasting, b.cause) for b in self._bodies]
        for index, (body, breaker) in enumerate(zip(self._bodies, self._breakers, strict=True)):
            part = slice(int(self._pushes.first[index]), int(self._pushes.first[index + 1]))
            share = -math.expm1(-dt / body.breakable.bond.contact_time)
            body.load = body.load + share * (felt.force[part] - body.load)
            body.lasting = body.lasting + share / LASTING * (body.load - body.lasting)
            body.cause = np.where(felt.cause[part] != NO_CAUSE, felt.cause[part], body.cause)
            if body.built.entity in still:
                continue
            # Every cluster is judged, whatever became of the others.
            for cluster in body.changed(time):
                if breaker.judge(cluster, data, time):
                    apart, struck = True, struck or self._struck(breaker, cluster)
        again = apart and retakes < (MOST_RETAKES if struck else FEW_RETAKES)
        if again:
            # The step is taken again, with the pieces apart.
            for body, (load, lasting, cause) in zip(self._bodies, known, strict=True):
                body.load, body.lasting, body.cause = load, lasting, cause
        else:
            self._records.given(dt * self._pushes.in_world(felt.force, data))
            self._pushes.remember(pushed, data)
        if not apart:
            return Fate.WHOLE
        return Fate.AGAIN if again else Fate.AFTER

    def _struck(self, breaker: Breaker, cluster: Cluster) -> bool:
        """True if another body pushes the cluster most, or its own weight."""
        cause = breaker.cause(cluster)
        return cause < 0 or self._colliders[cause] != cluster.entity


def _text(values: Any) -> str:
    return base64.b64encode(np.ascontiguousarray(values).tobytes()).decode()


def _array(text: str, kind: Any) -> Any:
    return np.frombuffer(base64.b64decode(text), dtype=kind).copy()
