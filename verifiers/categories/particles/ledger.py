"""Numbers, mass, momentum and energy of particles, and whether the records are theirs (R65, R103).

Momentum: its change over a frame is what gravity, fields and walls gave, less what left. Energy: kinetic, of spin, of height and
stored in contacts, less the work of fields and of moving walls, never grows by more than `limits.energy_growth` of what is in play;
dashpots, friction and rolling only take from it. What contacts among grains store by their depth is worked out here from the overlaps by
Hertz's law; what those with bodies store, and the springs that resist slip and rolling, no frame shows: they are as recorded. So is the
work of moving walls, as far as what they gave and how they moved at the frames about it allows.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import numpy as np

from ....worlds.arrays import F64
from ...rows.corrections import bake_again, halve_step
from ...rows.findings import Finding
from ..rigid.books import energy_scale, largest_growth
from ..soft_solids import soft_walls
from .bounds import HELD, MASS, MOMENTUM, RECORDS, STRAY
from .contacts import stored_energy
from .frames import matched
from .questions import BOOKS, IDENTITY

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ....worlds.cache import Cache
    from ...rows.questions import Question
    from .frames import Swarm, SwarmFrame

__all__ = ["Books", "Identity"]


class Identity:
    """Who is there, from frame to frame."""

    questions: ClassVar[Mapping[str, Question]] = IDENTITY

    def __init__(self, swarm: Swarm) -> None:
        self.swarm = swarm
        self.wrong: tuple[int, str] | None = None
        self.outside: tuple[int, int, float] | None = None
        self.beyond = 0.0
        self.number: list[int] = []
        self.highest = -1

    def see(self, now: SwarmFrame, before: SwarmFrame | None) -> None:
        """Look at one frame."""
        self.number.append(now.count)
        reach = (
            np.maximum(self.swarm.lower - now.position, now.position - self.swarm.upper).max(axis=1, initial=-np.inf)
            if now.count
            else np.zeros(0)
        )
        out = reach > STRAY * self.swarm.radius
        if now.count:
            self.beyond = max(self.beyond, float(reach.max()))
        if out.any() and self.outside is None:
            self.outside = (now.index, int(out.sum()), float(reach.max()))
        if self.wrong is None:
            self.wrong = self._wrong(now, before)
        self.highest = max(self.highest, int(now.identity.max(initial=-1)))

    def _wrong(self, now: SwarmFrame, before: SwarmFrame | None) -> tuple[int, str] | None:
        if len(np.unique(now.identity)) != now.count:
            return now.index, "two particles have the same id"
        if before is None:
            return None
        here, there = matched(now, before)
        if (now.radius[here] != before.radius[there]).any():
            return now.index, "a particle changes its radius"
        if (now.member[here] != before.member[there]).any():
            return now.index, "a particle changes its member"
        new = np.setdiff1d(np.arange(now.count), here)
        if len(new) and int(now.identity[new].min()) <= self.highest:
            return now.index, "an id comes back that was gone"
        if len(new) and self.swarm.granular:
            return now.index, "grains come out of nothing"
        return None

    def findings(self) -> dict[str, Finding]:
        """Findings on the three questions by name."""
        again = (bake_again(),)
        ok = Finding("pass", f"{self.number[0]} to {self.number[-1]} particles keep their ids, sizes and members", 0.0, 0.0, "1")
        if self.wrong is not None:
            ok = Finding("fail", f"{self.wrong[1]} at frame {self.wrong[0]}", 1.0, 0.0, "1", frame=self.wrong[0], hints=again)
        far = STRAY * self.swarm.radius
        inside = Finding(
            "pass", f"particles reach {max(self.beyond, 0.0):.3g} m beyond the domain at most", max(self.beyond, 0.0), far, "m"
        )
        if self.outside is not None:
            frame, count, reach = self.outside
            text = f"{count} particles are outside the domain at frame {frame}, up to {reach:.3g} m"
            inside = Finding("fail", text, reach, far, "m", frame=frame, hints=again)
        return {"identity": ok, "counts": self._counts(), "domain": inside}

    def _counts(self) -> Finding:
        s = self.swarm
        came, died, left = (s.record(f"{n}_count") for n in ("inflow", "died", "outflow"))
        expected = self.number[0] + came - died - left
        off = np.abs(np.array(self.number) - expected)
        off = np.maximum(off, s.record("lost"))
        declared, emitters = self._declared()
        off = np.maximum(off, np.maximum(np.abs(came - declared) - emitters, 0.0).round(6))
        frame = int(np.argmax(off > 0)) if (off > 0).any() else None
        text = f"{self.number[0]} particles at first, {came[-1]:.0f} came of {declared[-1]:.0f} declared, {died[-1]:.0f} died, {left[-1]:.0f} left the domain, {self.number[-1]} are there"
        if frame is not None:
            text = f"{off[frame]:.0f} particles are missing or too many at frame {frame}: {text}"
        return Finding(
            "pass" if frame is None else "fail", text, float(off.max()), 0.0, "1", frame=frame,
            hints=(halve_step(s.candidate, s.solver, "grains were thrown out by forces too strong for the step"), bake_again()) if frame is not None else (),
        )  # fmt: skip

    def _declared(self) -> tuple[F64, int]:
        """Number that emitters are to have let out by every frame, and number of emitters: each may be off by one."""
        s = self.swarm
        time = s.duration * np.arange(len(self.number))
        total, emitters = np.zeros(len(time)), 0
        for driver in s.candidate.spec.simulation.drivers.values():
            if driver.kind == "emitter" and driver.entity in s.members:
                last = time[-1] if driver.end is None else driver.end
                total += driver.rate * np.maximum(np.minimum(time, last) - driver.start, 0.0)
                emitters += 1
        return total, emitters


class Books:
    """Mass, momentum and energy."""

    questions: ClassVar[Mapping[str, Question]] = BOOKS

    def __init__(self, swarm: Swarm) -> None:
        self.swarm = swarm
        self.mass: list[float] = []
        self.momentum: list[F64] = []
        self.kinetic: list[float] = []
        self.turning: list[float] = []
        self.potential: list[float] = []
        self.among: list[float] = []
        self.volume: list[float] = []
        self.given: list[F64] = []
        self.work: list[float] = []
        self.doubt: list[float] = []
        self._walls = _walls_of(swarm)
        self._soft = soft_walls(swarm.candidate, swarm.solver) if swarm.granular else {}

    def see(self, now: SwarmFrame, before: SwarmFrame | None) -> None:
        """Add one frame up."""
        s = self.swarm
        self.mass.append(float(now.mass.sum()))
        self.momentum.append(now.mass @ now.velocity if now.count else np.zeros(3))
        self.kinetic.append(0.5 * float(now.mass @ (now.velocity**2).sum(axis=1)))
        self.turning.append(0.2 * float((now.mass * now.radius**2) @ (now.spin**2).sum(axis=1)))
        self.potential.append(-float(now.mass @ (now.position @ s.gravity)))
        self.among.append(stored_energy(s, now) if s.granular else 0.0)
        self.volume.append(float((4.0 / 3.0 * np.pi * now.radius**3).sum()))
        data = s.exchange(now.index)
        weight = 0.5 * (self.mass[-1] + self.mass[-2]) if before is not None else 0.0
        self.given.append(
            s.gravity * weight * s.duration
            + data["exchange/reaction"][:, :3].sum(axis=0)
            + data["field/impulse"].sum(axis=0)
            - data["outflow/momentum"]
        )
        work, doubt = self._wall_work(now.index, data["exchange/reaction"])
        self.work.append(work)
        self.doubt.append(doubt)

    def _wall_work(self, frame: int, reaction: F64) -> tuple[float, float]:
        """Work of moving walls on the particles, and its uncertainty [J]."""
        work = doubt = 0.0
        for row, cache, at in self._walls:
            velocity, spin = (cache.series(n)[:, at] for n in ("velocity", "angular_velocity"))
            if frame == 0:
                continue
            for j, v in ((reaction[row, :3], velocity), (reaction[row, 3:], spin)):
                work += float(j @ (0.5 * (v[frame - 1] + v[frame])))
                doubt += float(np.linalg.norm(j) * 0.5 * np.linalg.norm(v[frame] - v[frame - 1]))
            # Before it hits within a frame, a body may have fallen for as long as that.
            doubt += float(np.linalg.norm(reaction[row, :3]) * np.linalg.norm(self.swarm.gravity) * self.swarm.duration)
        for row, name in enumerate(self.swarm.cache.index.colliders):
            soft = self._soft.get(name.split("/", 1)[0])
            if soft is not None and frame > 0 and reaction[row, :3].any():
                # Which vertices were pushed is not told: any of them.
                speeds = 0.5 * (soft.velocities(frame - 1) + soft.velocities(frame))
                mean = speeds.mean(axis=0)
                work += float(reaction[row, :3] @ mean)
                spread = float(np.linalg.norm(speeds - mean, axis=1).max())
                doubt += float(np.linalg.norm(reaction[row, :3])) * spread
        return work, doubt

    def findings(self) -> dict[str, Finding]:
        """Findings on the four questions by name."""
        return {"mass": self._mass(), "records": self._records(), "momentum": self._momentum(), "energy": self._energy()}

    def _mass(self) -> Finding:
        s = self.swarm
        mass = np.array(self.mass)
        expected = mass[0] + s.record("inflow_mass") - s.record("died_mass") - s.record("domain_outflow")
        scale = max(float(np.abs(expected).max(initial=0.0)), float(mass.max(initial=0.0)), 1e-12)
        off = np.abs(mass - expected) / scale
        frame = int(np.argmax(off > MASS)) if (off > MASS).any() else None
        text = f"mass is {mass[-1]:.6g} kg at the end, off by {off.max():.2g} of it at most"
        return _finding(frame, text, float(off.max()), MASS)

    def _records(self) -> Finding:
        s = self.swarm
        momentum = np.array(self.momentum)
        flow = max(float(np.linalg.norm(momentum, axis=1).max(initial=0.0)), 1e-3 * max(self.mass, default=0.0), 1e-12)
        energy = max(max(self.kinetic) + float(np.ptp(self.potential)), 1e-9)
        own = {
            "kinetic_energy": (self.kinetic, energy), "potential_energy": (self.potential, max(energy, 0.1 * abs(self.potential[0]))),
            "rotation_energy": (self.turning, energy), "mass": (self.mass, max(self.mass)), "volume": (self.volume, max(self.volume)),
            **{f"momentum_{a}": (momentum[:, i], flow) for i, a in enumerate("xyz")},
        }  # fmt: skip
        off = {n: np.abs(s.record(n) - np.asarray(v)) / max(scale, 1e-30) for n, (v, scale) in own.items()}
        if s.granular:
            # Contacts with bodies add to those among grains; springs hold what they hold, but never less than nothing.
            among = np.asarray(self.among)
            short = np.maximum(among - s.record("contact_energy"), -s.record("spring_energy"))
            off["contact_energy"] = RECORDS * np.maximum(short, 0.0) / (HELD * (among + 0.01 * among.max(initial=1e-12)))
        worst = max(off, key=lambda n: float(np.nan_to_num(off[n], nan=np.inf).max()))
        wrong = ~(off[worst] <= RECORDS)
        frame = int(np.argmax(wrong)) if wrong.any() else None
        text = f"records are those of the particles; largest deviation {off[worst].max():.2g} of what is in play ({worst})"
        if frame is not None:
            text = f"record {worst} is off by {off[worst][frame]:.3g} of what is in play at frame {frame}"
        return _finding(frame, text, float(off[worst].max()), RECORDS)

    def _momentum(self) -> Finding:
        if not self.swarm.granular:
            return Finding("not_applicable", "flying particles are judged one by one (flight); their number changes")
        momentum, given = np.array(self.momentum), np.array(self.given)
        change = np.diff(momentum, axis=0)
        scale = np.maximum(np.cumsum(np.linalg.norm(given[1:], axis=1)) / np.arange(1, len(given)), 1e-12)
        size = np.array(self.mass)[1:] * np.linalg.norm(self.swarm.gravity) * self.swarm.duration
        # Gravity is taken to act for half the frame on what comes or goes in it; it may act for all of it, or not at all.
        flow = sum(np.abs(np.diff(self.swarm.record(n))) for n in ("inflow_mass", "died_mass", "domain_outflow"))
        doubt = 0.5 * flow * np.linalg.norm(self.swarm.gravity) * self.swarm.duration
        missed = np.maximum(np.linalg.norm(change - given[1:], axis=1) - doubt, 0.0)
        off = missed / np.maximum(np.maximum(scale, size), 1e-12)
        if not len(off):
            return Finding("not_applicable", "there is only one frame")
        frame = int(np.argmax(off > MOMENTUM)) + 1 if (off > MOMENTUM).any() else None
        text = f"momentum is explained to {off.max():.2g} of what acts in a frame"
        if frame is not None:
            text = f"{off[frame - 1]:.3g} of the impulse of frame {frame} has no source"
        return _finding(frame, text, float(off.max()), MOMENTUM)

    def _energy(self) -> Finding:
        s = self.swarm
        if not s.granular:
            return Finding("not_applicable", "flying particles are judged one by one (flight)")
        kinetic = np.array(self.kinetic) + np.array(self.turning)
        mass, potential = np.array(self.mass), np.array(self.potential)
        # What frames tell of the work of walls is loose where they hit within one: as recorded, but no more than that allows.
        given = np.minimum(np.diff(s.record("wall_work"), prepend=0.0), np.array(self.work) + np.array(self.doubt))
        work = s.record("driver_work") + np.cumsum(given)
        # What leaves takes its energy along: judged while nothing has.
        left = s.record("outflow_count") > 0
        last = int(np.argmax(left)) if left.any() else len(mass)
        stored, springs = np.maximum(self.among, s.record("contact_energy")), s.record("spring_energy")
        energy = (kinetic + potential + stored + springs - work)[:last]
        weight = float(mass.max(initial=0.0)) * float(np.linalg.norm(s.gravity))
        scale = energy_scale(kinetic, potential, weight)
        bound = s.candidate.spec.simulation.limits.energy_growth
        growth, low, high = largest_growth(energy)
        over = energy - np.minimum.accumulate(energy) > bound * scale
        frame = int(np.argmax(over)) if over.any() else None
        text = f"energy rises by at most {growth:.3g} J (frames {low}..{high}), {growth / scale:.2%} of the {scale:.3g} J in play"
        hints = (
            (halve_step(s.candidate, s.solver, "contacts put energy in: the step is too long"), bake_again())
            if frame is not None
            else ()
        )
        return Finding(
            "pass" if frame is None else "fail", text, growth / scale, bound, "1", frame=frame, hints=hints,
            evidence={
                "growth_J": growth, "scale_J": scale, "stored_J": float(stored.max()), "springs_J": float(springs.max()),
                "judged_frames": last,
            },
        )  # fmt: skip


def _walls_of(swarm: Swarm) -> list[tuple[int, Cache, int]]:
    """Rows of moving walls with their caches and rows there."""
    found = []
    for row, name in enumerate(swarm.cache.index.colliders):
        place = swarm.candidate.cache_row(*name.split("/", 1))
        if place is not None:
            found.append((row, place[0], place[1]))
    return found


def _finding(frame: int | None, text: str, measured: float, bound: float) -> Finding:
    """Finding on a relative deviation that is over its bound from a frame on; None where it never is."""
    hints = () if frame is None else (bake_again(),)
    return Finding("pass" if frame is None else "fail", text, measured, bound, "1", frame=frame, hints=hints)
