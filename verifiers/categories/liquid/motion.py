"""Motion of a liquid's particles from frame to frame: no jumps, no speed from nowhere, free fall where nothing touches (R99, R105).

- `jumps`: every particle's displacement in a frame is what its velocities at both ends, and bodies that pass it, allow.
- `spikes`: no particle is faster than the energy of the liquid, of inflows and of bodies allows (Bernoulli; jets `JET` times).
- `trapped`: no liquid jitters within a spacing for long (moving fluid caught between surfaces).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import numpy as np
from numpy.typing import NDArray

from ....worlds.errors import EvidenceError
from ...rows.corrections import bake_again, out_of_solids
from ...rows.findings import Finding
from .bodies import Bodies
from .bounds import FEW_TRAPPED, JET, JITTER_SECONDS, JITTER_WAY, JUMP, LIMIT, SPIKES, TRAPPED
from .corrections import give_room, shorter_step, squeezed
from .questions import MOTION, TRAPPED_PARTICLES
from .rows import first_over, place
from .solids import pieces_of

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ....worlds.requirements import Correction
    from ...rows.questions import Question
    from .frames import Frame, Liquid, Rows, Step

__all__ = ["Motion", "Trapped"]


class Motion:
    """Displacements and speeds."""

    questions: ClassVar[Mapping[str, Question]] = MOTION

    def __init__(self, liquid: Liquid) -> None:
        self.liquid, self.bodies = liquid, Bodies(liquid)
        self.allowed = JUMP[liquid.plan.engine]
        self.jump: list[float] = []
        self.worst_jump: tuple[float, int, list[float], float, list[float]] | None = None
        self.over: list[float] = []
        self.count: list[float] = []
        self.top = -np.inf
        self.lowest = np.inf
        self.given = 0.0
        self.spike: tuple[float, int, list[float], float, float] | None = None

    def see(self, step: Step) -> None:
        """Measure one frame."""
        self._jumps(step)
        self._spikes(step)

    def _jumps(self, step: Step) -> None:
        frame, before = step.now, step.before
        if before is None or not len(step.here):
            self.jump.append(0.0)
            return
        h, s = step.duration, self.liquid.spacing
        moved = frame.position[step.here] - before.position[step.there]
        v0, v1 = before.velocity[step.there], frame.velocity[step.here]
        missed = np.linalg.norm(moved - 0.5 * h * (v0 + v1), axis=1)
        speeds = before.speed[step.there] + frame.speed[step.here]
        allowed = 0.5 * h * (speeds + (self.liquid.strength + self._pulled(frame)) * h)
        excess = (missed - allowed) / s
        far = np.flatnonzero(excess > self.allowed)
        if len(far):
            # What a body pushes ahead of itself and leaves within a frame went with it, and is slow at both ends.
            excess[far] -= h * self.bodies.pushes(frame.position[step.here[far]], frame.index) / s
        worst = int(np.argmax(excess))
        self.jump.append(max(0.0, float(excess[worst])))
        if self.worst_jump is None and excess[worst] > self.allowed:
            self.worst_jump = (
                float(np.linalg.norm(moved[worst])),
                int((excess > self.allowed).sum()),
                place(frame.position[step.here[worst]]),
                float(speeds[worst]),
                place(before.position[step.there[worst]]),
            )

    def _between(self, frame: int | None, where: list[float]) -> list[str]:
        """Parts of different bodies within a spacing of where a jump began, one of which moves: they squeeze what is between them."""
        from ....geometry import distance_to_surface

        before = max((frame or 1) - 1, 0)
        point, reach = np.array([where]), self.liquid.spacing
        found: dict[tuple[str, str], tuple[float, str, bool]] = {}
        for piece in pieces_of(self.liquid.candidate):
            low, high = piece.box(before)
            if (low > point[0] + reach).any() or (high < point[0] - reach).any():
                continue
            gap = float(distance_to_surface(piece.solid, piece.local(point, before)).distance[0])
            if gap <= reach:
                key, told = (piece.entity, piece.body), (gap, f"{piece.entity}/{piece.part}", not piece.still)
                found[key] = min(told, found.get(key, told))
        near = sorted(found.values())
        return [name for _, name, _ in near[:2]] if any(moves for *_, moves in near[:2]) else []

    def _pulled(self, frame: Frame) -> float:
        """Largest acceleration of an attracting field at a particle [m/s^2]."""
        return (
            max(float(np.linalg.norm(self.liquid.pull(frame, ending=e), axis=1).max(initial=0.0)) for e in (True, False))
            if self.liquid.fields
            else 0.0
        )

    def _spikes(self, step: Step) -> None:
        frame, liquid = step.now, self.liquid
        if not frame.count:
            self.over.append(0.0)
            self.count.append(0.0)
            return
        height = frame.position @ liquid.up
        self.top, self.lowest = max(self.top, float(height.max())), min(self.lowest, float(height.min()))
        if step.before is None:
            self.given = max(self.given, frame.fastest)
        for name, driver in liquid.inflows.items():
            if liquid.active(name, max(1, frame.index)):
                self.given = max(self.given, driver.flow_speed)
                self.top = max(self.top, float(liquid.inflow_frame(name)[0] @ liquid.up))
        self.given = max(self.given, 2.0 * float(self.bodies.moving[frame.index]))
        if liquid.fields:
            velocity, _ = liquid.air(frame)
            self.given = max(self.given, float(np.linalg.norm(velocity, axis=1).max()))
            self.given += self._pulled(frame) * liquid.duration
        fall = max(self.top - self.lowest, 0.0) + 2.0 * liquid.spacing
        allowed = JET * np.sqrt(self.given**2 + 2.0 * liquid.strength * fall) + 0.05
        speed = frame.speed
        ratio = speed / allowed
        worst = int(np.argmax(ratio))
        self.over.append(float(ratio[worst]))
        self.count.append(float((ratio > 1.0).sum()) / frame.count)
        if self.spike is None and (ratio[worst] > LIMIT or self.count[-1] > max(SPIKES, 1.0 / frame.count)):
            self.spike = (
                float(speed[worst]),
                int((ratio > 1.0).sum()),
                place(frame.position[worst]),
                float(allowed),
                float(ratio[worst]),
            )

    def findings(self) -> dict[str, Finding]:
        """Jumps and spikes."""
        if not self.over:
            raise EvidenceError("the cache holds no frame")
        found = first_over(np.array(self.jump), self.allowed, "spacings", "displacement beyond what velocities explain")
        hints: tuple[Correction, ...] = (shorter_step(self.liquid, "the step is too long", found.frame), bake_again())
        evidence: dict[str, object] = {}
        if self.worst_jump is not None:
            moved, count, where, speed, began = self.worst_jump
            evidence = {"place": where, "particles": count, "displacement_m": moved, "speed_sum": speed, "began": began}
            between = self._between(found.frame, began)
            if len(between) > 1:
                evidence["between"] = between
                hints = (hints[0], squeezed(self.liquid, between, began), *hints[1:])
        jumps = Finding(found.status, found.text, found.measured, self.allowed, "spacings", None, found.frame, hints, evidence)
        return {"jumps": jumps, "spikes": self._found_spikes()}

    def _found_spikes(self) -> Finding:
        over, share = np.array(self.over), np.array(self.count)
        if self.spike is None:
            text = f"the fastest particle reaches {over.max():.3g} of {JET:g} times what energy allows; {share.max():.2g} of them exceed it"
            return Finding("pass", text, float(over.max()), LIMIT, "1")
        speed, count, where, allowed, ratio = self.spike
        frame = next(k for k in range(len(over)) if over[k] > LIMIT or share[k] > SPIKES)
        text = (
            f"{count} particles are too fast at frame {frame}: {speed:.3g} m/s at {where}, where energy allows {allowed:.3g} m/s"
        )
        hints = (
            shorter_step(self.liquid, "the step is too long for the flow", frame),
            out_of_solids(self.liquid.members, "a solid overlaps the liquid at the start and throws it"),
        )
        return Finding(
            "fail",
            text,
            max(ratio, float(over.max())),
            LIMIT,
            "1",
            None,
            frame,
            hints,
            {"place": where, "speed": speed, "share": float(share.max())},
        )


class Trapped:
    """Particles that stay where they are and yet move."""

    questions: ClassVar[Mapping[str, Question]] = TRAPPED_PARTICLES

    def __init__(self, liquid: Liquid) -> None:
        self.liquid = liquid
        self.window = max(3, round(JITTER_SECONDS / liquid.duration))
        self.identity = np.zeros(0, dtype=np.int64)
        self.anchor = np.zeros((0, 3))
        self.since: NDArray[np.intp] = np.zeros(0, dtype=np.intp)
        self.way = np.zeros(0)
        self.share: list[float] = []
        self.first: tuple[int, int, list[float]] | None = None

    def see(self, step: Step) -> None:
        """Follow every particle's way since it last left its place."""
        frame = step.now
        anchor, since, way = frame.position.copy(), np.full(frame.count, frame.index, dtype=np.intp), np.zeros(frame.count)
        here: Rows = step.here
        if step.before is not None and len(here):
            at = np.searchsorted(self.identity, frame.identity[here])
            speed = 0.5 * (frame.speed[here] + step.before.speed[step.there])
            stays = np.linalg.norm(frame.position[here] - self.anchor[at], axis=1) < self.liquid.spacing
            rows, at, speed = here[stays], at[stays], speed[stays]
            anchor[rows], since[rows] = self.anchor[at], self.since[at]
            way[rows] = self.way[at] + speed * step.duration
        self.identity, self.anchor, self.since, self.way = frame.identity, anchor, since, way
        long = frame.index - since >= self.window
        rate = way / np.maximum(frame.index - since, 1) * self.window
        bad = long & (rate > JITTER_WAY * self.liquid.spacing)
        self.share.append(float(bad.sum()) / max(frame.count, 1))
        if self.first is None and bad.sum() > max(FEW_TRAPPED, TRAPPED * frame.count):
            self.first = (frame.index, int(bad.sum()), place(np.median(frame.position[bad], axis=0)))

    def findings(self) -> dict[str, Finding]:
        """The largest share, and where."""
        if len(self.share) <= self.window:
            return {"trapped": Finding("not_applicable", f"the sequence is shorter than {JITTER_SECONDS:g} s")}
        most = max(self.share)
        if self.first is None:
            return {"trapped": Finding("pass", f"at most {most:.2g} of the particles jitter in their place", most, TRAPPED, "1")}
        index, count, where = self.first
        text = f"{count} particles jitter within a spacing at frame {index}, about {where}: moving fluid is caught there"
        hints = (
            give_room(self.liquid, where),
            shorter_step(self.liquid, "the pressure solve does not converge there"),
        )
        return {"trapped": Finding("fail", text, most, TRAPPED, "1", None, index, hints, {"place": where, "particles": count})}
