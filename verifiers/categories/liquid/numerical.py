"""Numerical health of liquid instances (R105): rows `numerical:<what>:<solver>`, beside those of rigid ones."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ....worlds.errors import EvidenceError
from ...rows.corrections import bake_again, double_iterations, halve_step
from ...rows.findings import Finding
from .bounds import CAPPED, COVER, LOST
from .corrections import refine
from .questions import NUMBERS
from .rows import first_over

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ...rows.questions import Question
    from .frames import Liquid, Step

__all__ = ["Numbers"]

RECORDS = ("steps", "step", "iterations_pressure", "iterations_divergence", "iterations_capped", "lost", "max_speed",
           "density_error_mean", "density_error_max")  # fmt: skip


class Numbers:
    """Counters of every frame."""

    questions: ClassVar[Mapping[str, Question]] = NUMBERS

    def __init__(self, liquid: Liquid) -> None:
        self.liquid = liquid
        self.rows: list[list[float]] = []
        self.fastest: list[float] = []
        self.infinite: tuple[int, str, int] | None = None
        self.miscounted: tuple[int, str] | None = None
        self.total = 0

    def see(self, step: Step) -> None:
        """Look at the numbers of one frame."""
        frame, held = step.now, step.now.others
        missing = [n for n in RECORDS if f"record/{n}" not in held]
        if missing:
            raise EvidenceError(f"frame {frame.index} lacks record/{missing[0]}; bake again")
        self.rows.append([float(held[f"record/{n}"]) for n in RECORDS])
        self.fastest.append(frame.fastest)
        for name, array in held.items():
            if array.dtype.kind == "f":
                self.total += array.size
                bad = ~np.isfinite(array)
                if bad.any() and self.infinite is None:
                    self.infinite = (frame.index, name, int(bad.sum()))
        if self.miscounted is None:
            text = self._miscount(held)
            self.miscounted = (frame.index, text) if text else None

    def _miscount(self, held: Mapping[str, Any]) -> str:
        liquid = self.liquid
        count = len(held["particle/id"])
        for name, array in held.items():
            if name.startswith("particle/") and len(array) != count:
                return f"{name} has {len(array)} rows, there are {count} particles"
        flows = liquid.drivers
        for name in ("inflow/mass", "outflow/mass"):
            wanted = [d for d in flows if d in (liquid.inflows if name == "inflow/mass" else liquid.outflows)]
            if name in held and len(held[name]) not in (len(wanted), len(flows)):
                return f"{name} has {len(held[name])} rows, the index names {len(wanted)}"
        plan = liquid.candidate.spec.simulation
        if set(liquid.members) != set(plan.liquid[liquid.solver].members):
            return f"the cache holds {', '.join(liquid.members)}, planned are {', '.join(plan.liquid[liquid.solver].members)}"
        if set(flows) != set(liquid.inflows) | set(liquid.outflows):
            return f"the index names drivers {', '.join(flows) or 'none'}, planned are {', '.join([*liquid.inflows, *liquid.outflows]) or 'none'}"
        return ""

    def findings(self) -> dict[str, Finding]:
        """All counters."""
        if not self.rows:
            raise EvidenceError("the cache holds no frame")
        limit = self.liquid.candidate.spec.simulation.limits.max_speed
        column = dict(zip(RECORDS, np.array(self.rows).T, strict=True))
        speed = np.maximum(np.array(self.fastest), np.nan_to_num(column["max_speed"], nan=np.inf))
        longest = float(np.nanmax(column["step"], initial=0.0)) or np.inf
        step = halve_step(self.liquid.candidate, self.liquid.solver, "the step is too long for the flow", in_force=longest)
        found = {
            "finite": Finding("pass", f"{self.total} numbers are finite", 0.0, 0.0, "numbers"),
            "counts": Finding("pass", f"{len(self.rows)} frames have the rows that they need", 0.0, 0.0, "rows"),
            "speed": first_over(speed, limit, "m/s", "speed", (step,)),
            "lost": first_over(
                column["lost"],
                LOST,
                "1",
                "number of lost particles",
                (step, refine(self.liquid, "walls are thinner than the liquid resolves")),
            ),
            "iterations": self._iterations(column),
            "counters": self._counters(column),
        }
        if self.infinite is not None:
            frame, name, count = self.infinite
            found["finite"] = Finding(
                "fail",
                f"{count} numbers of {name} are not finite at frame {frame}",
                float(count),
                0.0,
                "numbers",
                None,
                frame,
                (step,),
                {"channel": name},
            )
        if self.miscounted is not None:
            frame, text = self.miscounted
            found["counts"] = Finding(
                "fail", f"{text} (frame {frame})", None, None, "", None, frame, (bake_again("the cache does not fit its plan"),)
            )
        return found

    def _iterations(self, column: Mapping[str, Any]) -> Finding:
        steps, capped = column["steps"], column["iterations_capped"]
        total = float(steps.sum())
        if not np.isfinite(total) or not np.isfinite(capped).all():
            return Finding("fail", "step counts are not finite", frame=int(np.argmax(~np.isfinite(steps + capped))))
        if total <= 0:
            raise EvidenceError(f"instance {self.liquid.solver!r} records no solver steps")
        share = float(capped.sum()) / total
        over = np.cumsum(capped) > CAPPED * total
        candidate, now = self.liquid.candidate, self.liquid.plan.settings.iterations
        hints = (
            halve_step(candidate, self.liquid.solver, "the step is too long for the pressure solve"),
            double_iterations(candidate, self.liquid.solver, "the pressure solve does not converge"),
        )
        frame = int(np.argmax(over)) if over.any() else None
        text = f"{share:.2%} of {total:.0f} steps ended at the iteration cap of {now}"
        return Finding("pass" if share <= CAPPED else "fail", text, share, CAPPED, "1", None, frame, hints)

    def _counters(self, column: Mapping[str, Any]) -> Finding:
        h, longest = self.liquid.duration, self.liquid.plan.settings.max_step
        steps, step = column["steps"][1:], column["step"][1:]
        wrong = ~(np.abs(steps * step - h) <= COVER * h) & ~((steps == 0) & (step == 0))
        wrong |= ~(step <= longest * (1 + COVER)) | ~(column["iterations_capped"][1:] <= 2 * steps)
        negative = (np.array(self.rows)[1:] < 0).any(axis=1)
        bad = wrong | negative
        if bad.any():
            frame = int(np.argmax(bad)) + 1
            text = f"frame {frame} records {steps[frame - 1]:g} steps of {step[frame - 1]:.4g} s for {h:.4g} s (longest allowed {longest:g} s), {column['iterations_capped'][frame]:g} capped"
            return Finding("fail", text, None, None, "", None, frame, (bake_again("counters are impossible"),))
        return Finding(
            "pass", f"steps of at most {step.max(initial=0.0):.3g} s cover all frames", float(step.max(initial=0.0)), longest, "s"
        )
