"""Judges whether a liquid and bodies gave each other what each says it got (R66, R67, R102).

- `exchange`: for every boundary and frame, what the liquid gave and what it lost itself add up to zero (`REACTION` of the scale).
- `received`: what a two-way coupled rigid instance, or cloth, received is what the liquid gave.
- `declared`: bodies that move freely and get pushed by the liquid are coupled both ways, or the omission is declared one-way.
- `buoyancy`: the upward push on a body is that of the water it displaces (`buoyancy.py`).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import numpy as np

from ....worlds.arrays import F64
from ....worlds.errors import EvidenceError
from ...ledgers.exchanged import partners
from ...rows.corrections import bake_again, couple_both_ways, halve_step
from ...rows.findings import Finding
from .bodies import Bodies, exchanged
from .bounds import FELT, REACTION
from .buoyancy import Buoyancy
from .questions import COUPLING

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ....worlds.cache import Cache
    from ....worlds.requirements import Correction
    from ...rows.questions import Question
    from .frames import Liquid, Step

__all__ = ["Coupling"]


class Coupling:
    """Exchange with every boundary."""

    questions: ClassVar[Mapping[str, Question]] = COUPLING

    def __init__(self, liquid: Liquid) -> None:
        self.liquid, self.bodies = liquid, Bodies(liquid)
        self.impulse: list[F64] = []
        self.reaction: list[F64] = []
        self.received: list[F64] = []
        self.buoyancy = Buoyancy(liquid, self.bodies)

    def see(self, step: Step) -> None:
        """Read one frame."""
        count = self.bodies.count
        self.impulse.append(exchanged(step.now, "impulse", count))
        self.reaction.append(exchanged(step.now, "reaction", count))
        self.received.append(self._received(step.now.index))
        self.buoyancy.see(step.now)

    def _received(self, index: int) -> F64:
        """Impulse and its moment that the bodies' own instances recorded, shape (b, 6) [N s, N m s]; NaN where no coupled body is behind the boundary."""
        result = np.full((self.bodies.count, 6), np.nan)
        for row, soft in self.bodies.deforming.items():
            if row in self.buoyancy.sheets and partners(self.liquid.candidate.spec, soft.cache.index.solver) == (
                self.liquid.solver,
            ):
                # A cloth's ledger has no moments: of these, the liquid's own stand.
                result[row] = self.impulse[-1][row]
                result[row, :3] = _loads(soft.cache, index)
        for row, name in enumerate(self.bodies.names):
            held = self.liquid.candidate.cache_row(*name.split("/"))
            if held is None or not self.bodies.free[row] or self.bodies.coupled(row) != "two_way":
                continue
            if len(partners(self.liquid.candidate.spec, held[0].index.solver)) > 1:
                continue  # what it received is the sum over several coupled solvers
            cache, body = held
            given = cache.read(index, ("exchange/impulse",))["exchange/impulse"]
            if np.shape(given) != (len(cache.index.bodies), 6):
                raise EvidenceError(
                    f"exchange/impulse of {cache.index.solver!r} has shape {np.shape(given)} at frame {index}; bake again"
                )
            result[row] = given[body]
        return result

    def findings(self) -> dict[str, Finding]:
        """All four."""
        if not self.bodies.count:
            none = Finding("not_applicable", "no solid bounds the liquid")
            return dict.fromkeys(self.questions, none)
        impulse, reaction = np.array(self.impulse), np.array(self.reaction)
        return {
            "exchange": self._compare("exchange", -reaction, impulse, "the liquid's own loss through"),
            "received": self._compare("received", np.array(self.received), impulse, "what was received by"),
            "declared": self._declared(impulse),
            "buoyancy": self.buoyancy.finding(impulse),
        }

    def _compare(self, name: str, one: F64, other: F64, what: str) -> Finding:
        """Two accounts of the same impulses, shape (frames, b, 6); NaN is not judged."""
        if np.isnan(one).all():
            return Finding("not_applicable", "no body is coupled both ways with this liquid alone")
        size = np.maximum(self.bodies.reach, 1e-9)
        unit = np.stack([np.ones_like(size)] * 3 + [size] * 3, axis=1)
        weight = self.liquid.strength * self.liquid.duration * float(self.liquid.rest_density.max()) * self.liquid.spacing**3
        largest = np.abs(np.nan_to_num(other / unit)).max(axis=(0, 2))
        scale = np.maximum(np.maximum(largest, np.abs(np.nan_to_num(one / unit)).max(axis=(0, 2))), weight)
        error = np.abs((one - other) / unit).max(axis=2) / scale
        error = np.where(np.isnan(one).any(axis=2), -np.inf, np.nan_to_num(error, nan=np.inf))
        value = float(error.max())
        over = error > REACTION
        if not over.any():
            return Finding(
                "pass",
                f"{what} boundaries agrees with what was given, within {max(value, 0.0):.2g}",
                max(value, 0.0),
                REACTION,
                "1",
            )
        frame = int(np.argmax(over.any(axis=1)))
        row = int(np.argmax(error[frame]))
        entity = self.bodies.entities[row]
        text = f"{what} {entity} at frame {frame} differs from what was given by {error[frame, row]:.3g} of its largest impulse"
        hints: tuple[Correction, ...] = (
            bake_again(),
            halve_step(self.liquid.candidate, self.liquid.solver, "the two sides do not step together"),
        )
        evidence = {"given": other[frame, row].tolist(), name: one[frame, row].tolist()}
        return Finding("fail", text, value if np.isfinite(value) else None, REACTION, "1", entity, frame, hints, evidence)

    def _declared(self, impulse: F64) -> Finding:
        push = np.linalg.norm(impulse[:, :, :3], axis=2)
        weight = self.bodies.mass * max(self.liquid.strength, 1e-6) * self.liquid.duration
        omitted: dict[str, float] = {}
        for row in self.buoyancy.judged:
            share = float(push[:, row].max() / weight[row])
            kind = self.bodies.coupled(row)
            if kind == "two_way" or share < FELT:
                continue
            omitted[self.bodies.entities[row]] = share
            if not kind:
                entity, frame = self.bodies.entities[row], int(np.argmax(push[:, row] >= FELT * weight[row]))
                rigid = next((n for n, s in self.liquid.candidate.spec.simulation.rigid.items() if entity in s.members), "")
                hint = couple_both_ways(self.liquid.solver, rigid, "no coupling carries the liquid's push to the body")
                text = f"{self.liquid.solver} pushes {entity} with {share:.3g} of its weight and does not move it: no coupling is declared"
                return Finding("fail", text, share, FELT, "1", entity, frame, (hint,))
        if omitted:
            text = f"one-way, declared as an approximation: {', '.join(f'{n} misses up to {s:.3g} of its weight' for n, s in omitted.items())}"
            return Finding("pass", text, evidence={"omitted_share_of_weight": omitted})
        if not self.buoyancy.judged:
            return Finding("not_applicable", "no boundary moves freely")
        return Finding(
            "pass",
            f"{len(self.buoyancy.judged)} free bodies are coupled both ways or stay dry",
            evidence={"omitted_share_of_weight": {}},
        )


def _loads(cache: Cache, index: int) -> F64:
    """Impulse that a cloth says others gave it over a frame, shape (3,) [N s]."""
    names = tuple(f"record/load_impulse_{axis}" for axis in "xyz")
    held = [cache.read(k, names) for k in (max(index - 1, 0), index)]
    return np.array([float(held[1][n]) - float(held[0][n]) for n in names])
