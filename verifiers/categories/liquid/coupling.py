"""Whether a liquid and bodies gave each other what each says it got (R66, R67, R102).

- `exchange`: for every boundary and frame, what the liquid gave and what it lost itself add up to zero (`REACTION` of the scale).
- `received`: what a two-way coupled rigid instance, or cloth, received is what the liquid gave.
- `declared`: bodies that move freely and get pushed by the liquid are coupled both ways, or the omission is declared one-way.
- `buoyancy`: the upward push on a body is that of the water it displaces, less what its own acceleration and drag take, and what
  gaps under it that are too narrow for particles keep from a body that lies there and is too heavy to be lifted anyway.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import numpy as np
from numpy.typing import NDArray

from ....worlds.arrays import F64, rotation_matrix
from ....worlds.errors import EvidenceError
from ...ledgers.exchanged import partners
from ...rows.corrections import bake_again, correction
from ...rows.findings import Finding
from .about import COLUMN, Hull, Surroundings, hull_of, others_than
from .bodies import Bodies, exchanged
from .bounds import ADDED, BUOYANCY, DRAG, FELT, REACTION, ROUGH, STREAMS
from .footing import unwetted
from .questions import COUPLING
from .rows import coarse, longer_step
from .samples import shares_under
from .solids import rows_within

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ....worlds.cache import Cache
    from ....worlds.requirements import Correction
    from ...rows.questions import Question
    from .frames import Frame, Liquid, Step

__all__ = ["Coupling", "coupled"]

WINDOW_SECONDS = 0.25
RING = 3.0
"""[spacings] Liquid up to this far from a body's box tells the level about it."""


def coupled(liquid: Liquid, entity: str) -> str:
    """`two_way`, `one_way`, or `` where nothing is declared between the liquid and the instance that moves the entity."""
    plan = liquid.candidate.spec.simulation
    owners = {n for n, s in plan.solvers.items() if entity in s.members}
    found = [
        c.direction for c in plan.couplings.values() if {c.source, c.target} & owners and liquid.solver in (c.source, c.target)
    ]
    return "two_way" if "two_way" in found else "one_way" if found else ""


class Coupling:
    """Exchange with every boundary."""

    questions: ClassVar[Mapping[str, Question]] = COUPLING

    def __init__(self, liquid: Liquid) -> None:
        self.liquid, self.bodies = liquid, Bodies(liquid)
        self.impulse: list[F64] = []
        self.reaction: list[F64] = []
        self.received: list[F64] = []
        self.judged = [i for i, free in enumerate(self.bodies.free) if free]
        self.sheets = {
            i for i in self.judged if liquid.candidate.spec.entities[self.bodies.entities[i]].physics.category == "cloth"
        }
        """They displace nothing."""
        self.hulls = {i: hull_of(liquid, self.bodies.names[i]) for i in self.judged if i not in self.sheets}
        self.walls = {e: others_than(liquid, e) for e in {self.bodies.entities[i] for i in self.hulls}}
        self.sunk: list[F64] = []
        self.flow: list[F64] = []
        self.level: list[F64] = []

    def see(self, step: Step) -> None:
        """Read one frame."""
        count = self.bodies.count
        self.impulse.append(exchanged(step.now, "impulse", count))
        self.reaction.append(exchanged(step.now, "reaction", count))
        self.received.append(self._received(step.now.index))
        sunk, flow, level = self._about(step.now)
        self.sunk.append(sunk)
        self.flow.append(flow)
        self.level.append(level)

    def _received(self, index: int) -> F64:
        """What the rigid side says it got, shape (b, 6); NaN where no coupled body is behind the boundary."""
        result = np.full((self.bodies.count, 6), np.nan)
        for row, soft in self.bodies.deforming.items():
            if row in self.sheets and partners(self.liquid.candidate.spec, soft.cache.index.solver) == (self.liquid.solver,):
                # A cloth's books have no moments: of these, the liquid's own stand.
                result[row] = self.impulse[-1][row]
                result[row, :3] = _loads(soft.cache, index)
        for row, name in enumerate(self.bodies.names):
            held = self.liquid.candidate.cache_row(*name.split("/"))
            if held is None or not self.bodies.free[row] or coupled(self.liquid, self.bodies.entities[row]) != "two_way":
                continue
            if len(partners(self.liquid.candidate.spec, held[0].index.solver)) > 1:
                continue  # what it received is the sum over several partners
            cache, body = held
            given = cache.read(index, ("exchange/impulse",))["exchange/impulse"]
            if np.shape(given) != (len(cache.index.bodies), 6):
                raise EvidenceError(
                    f"exchange/impulse of {cache.index.solver!r} has shape {np.shape(given)} at frame {index}; bake again"
                )
            result[row] = given[body]
        return result

    def _about(self, frame: Frame) -> tuple[F64, F64, F64]:
        """Of every free body, the share in the liquid, its speed there [m/s], and its level [m]; NaN where no level is plain to see.

        Nothing of a body that no liquid touches is in it, wherever the level is.
        """
        sunk, flow = np.full(len(self.judged), np.nan), np.zeros(len(self.judged))
        levels = np.full(len(self.judged), np.nan)
        seen = _seen(self.liquid, frame) if self.judged else np.zeros((0, 2))
        heights = frame.position @ self.liquid.up
        for column, row in enumerate(self.judged):
            if row in self.sheets:
                continue
            entity, body = self.bodies.names[row].split("/")
            hull = self._hull(row, frame.index)
            near = _ring(self.liquid, seen, hull.inside)
            about = Surroundings(self.liquid, self.walls[entity], frame.index, hull, frame.position)
            flow[column] = _flow(frame, near)
            if not about.touched.any():
                sunk[column] = 0.0
                continue
            tops = about.tops(frame.position, seen, heights, near, COLUMN * self.liquid.spacing)
            level = _level(self.liquid, frame, tops)
            if level is not None:
                step = float(np.cbrt(self.liquid.candidate.body(entity, body).volume / len(hull.inside)))
                share = shares_under(hull.inside @ self.liquid.up, level, step)
                sunk[column] = float((share * about.wet(share > 0.0, hull.skin @ self.liquid.up < level)).mean())
                levels[column] = level
        return sunk, flow, levels

    def _hull(self, row: int, index: int) -> Hull:
        entity, body = self.bodies.names[row].split("/")
        position, quaternion = self.liquid.candidate.track(entity, body)
        turn, hull = rotation_matrix(quaternion[index]).T, self.hulls[row]
        return Hull(hull.inside @ turn + position[index], hull.skin @ turn + position[index])

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
            "buoyancy": self._buoyancy(impulse),
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
        hints: tuple[Correction, ...] = (bake_again(), longer_step(self.liquid, "the two sides do not step together"))
        evidence = {"given": other[frame, row].tolist(), name: one[frame, row].tolist()}
        return Finding("fail", text, value if np.isfinite(value) else None, REACTION, "1", entity, frame, hints, evidence)

    def _declared(self, impulse: F64) -> Finding:
        push = np.linalg.norm(impulse[:, :, :3], axis=2)
        weight = self.bodies.mass * max(self.liquid.strength, 1e-6) * self.liquid.duration
        omitted: dict[str, float] = {}
        for row in self.judged:
            share = float(push[:, row].max() / weight[row])
            kind = coupled(self.liquid, self.bodies.entities[row])
            if kind == "two_way" or share < FELT:
                continue
            omitted[self.bodies.entities[row]] = share
            if not kind:
                entity, frame = self.bodies.entities[row], int(np.argmax(push[:, row] >= FELT * weight[row]))
                rigid = next((n for n, s in self.liquid.candidate.spec.simulation.rigid.items() if entity in s.members), "")
                value = {"source": self.liquid.solver, "target": rigid, "direction": "two_way", "variables": ["motion", "wrench"]}
                hint = correction(
                    "no coupling carries the liquid's push to the body", "drivers", f"couple {self.liquid.solver} and {rigid} both ways",
                    pointers=("/simulation/couplings",), patch=({"op": "add", "path": f"/simulation/couplings/{self.liquid.solver}_{rigid}", "value": value},),
                )  # fmt: skip
                text = f"{self.liquid.solver} pushes {entity} with {share:.3g} of its weight and does not move it: no coupling is declared"
                return Finding("fail", text, share, FELT, "1", entity, frame, (hint,))
        if omitted:
            text = f"one-way, declared as an approximation: {', '.join(f'{n} misses up to {s:.3g} of its weight' for n, s in omitted.items())}"
            return Finding("pass", text, evidence={"omitted_share_of_weight": omitted})
        if not self.judged:
            return Finding("not_applicable", "no boundary moves freely")
        return Finding(
            "pass", f"{len(self.judged)} free bodies are coupled both ways or stay dry", evidence={"omitted_share_of_weight": {}}
        )

    def _buoyancy(self, impulse: F64) -> Finding:
        window = max(2, round(WINDOW_SECONDS / self.liquid.duration))
        sunk = np.array(self.sunk).reshape(len(impulse), len(self.judged))
        flow = np.array(self.flow).reshape(len(impulse), len(self.judged))
        level = np.array(self.level).reshape(len(impulse), len(self.judged))
        kept_out: dict[str, float] = {}
        light = False
        worst, culprit, when, judged, told = 0.0, None, None, 0, ""
        for column, row in enumerate(self.judged):
            if (
                row in self.sheets
                or coupled(self.liquid, self.bodies.entities[row]) != "two_way"
                or self.liquid.strength < 1e-6
                or self.liquid.attracted
            ):
                continue
            excess, push, wanted = self._excess(
                row, impulse[:, row, :3] @ self.liquid.up, sunk[:, column], flow[:, column], window
            )
            narrow = self._kept_out(row, (excess > BUOYANCY) & (push < wanted), level[:, column])
            # What lies there whether lifted or not moves alike; what should rise and does not is wrong.
            heavy = self.bodies.mass[row] * self.liquid.strength >= wanted
            if (narrow[heavy] > 0.0).any():
                kept_out[self.bodies.entities[row]] = float(narrow[heavy].max())
            excess = np.where(heavy, np.maximum(excess - narrow / self._full(row), 0.0), excess)
            known = ~np.isnan(excess)
            judged += int(known.sum())
            if known.any() and np.nanmax(excess) > worst:
                k = int(np.nanargmax(excess))
                worst, told = (
                    float(excess[k]),
                    f"{self._told(row)} is pushed up by {push[k]:.4g} N over frames {k - window}..{k}, displaced liquid gives {wanted[k]:.4g} N",
                )
                culprit = self.bodies.entities[row]
                when = int(np.argmax(np.nan_to_num(excess, nan=0.0) > BUOYANCY)) if worst > BUOYANCY else None
                light = bool(narrow[k] > 0.0 and not heavy[k])
        if not judged:
            return Finding("not_applicable", "no freely moving, two-way coupled body lies in liquid with a plain level")
        text = told or f"the push on bodies is that of the displaced liquid ({judged} windows)"
        if light:
            text += "; gaps under it are too narrow for the particles, and it would float up if they were not"
        elif kept_out:
            text += "; " + ", ".join(
                f"{n} lies over gaps too narrow for the particles, up to {f:.3g} N of lift" for n, f in kept_out.items()
            )
        hints = (
            coarse(
                self.liquid,
                "the gap under the body is too narrow for the particles"
                if light
                else "too few particles push the body, each too hard",
            ),
            longer_step(self.liquid, "the body moves too far in a step"),
        )
        return Finding(
            "pass" if worst <= BUOYANCY else "fail",
            text,
            worst,
            BUOYANCY,
            "1",
            culprit if worst > BUOYANCY else None,
            when,
            hints if worst > BUOYANCY else (),
            {"lift_kept_out_n": kept_out},
        )

    def _told(self, row: int) -> str:
        """The body's name: of the entity, and of the piece where it has several."""
        entity, body = self.bodies.names[row].split("/")
        return entity if len(self.liquid.candidate.entity(entity).bodies) == 1 else f"{body} of {entity}"

    def _full(self, row: int) -> float:
        """Weight of the liquid that a whole body displaces [N]."""
        volume = self.liquid.candidate.body(*self.bodies.names[row].split("/")).volume
        return float(self.liquid.rest_density.max()) * volume * self.liquid.strength

    def _kept_out(self, row: int, asked: NDArray[np.bool_], level: F64) -> F64:
        """Most that gaps too narrow for the liquid can take of the push on a body [N], shape (frames,); 0 where nobody asks."""
        weight = float(self.liquid.rest_density.max()) * self.liquid.strength
        name = self.bodies.names[row]
        volumes = [
            unwetted(self.liquid, name, k, float(level[k])) if ask and np.isfinite(level[k]) else 0.0
            for k, ask in enumerate(asked)
        ]
        return weight * np.array(volumes)

    def _excess(self, row: int, upward: F64, sunk: F64, flow: F64, window: int) -> tuple[F64, F64, F64]:
        """By how much the mean push of a window is outside of what is possible, over the weight of water that the whole body displaces; push; buoyancy [N]."""
        liquid, frames = self.liquid, len(upward)
        density = float(liquid.rest_density.max())
        entity, body = self.bodies.names[row].split("/")
        volume = self.liquid.candidate.body(entity, body).volume
        size = np.ptp(self.hulls[row].inside, axis=0) + 1e-9
        section = float(np.sort(size)[1:].prod())
        speed = np.linalg.norm(self.bodies.motion[0][:, row], axis=1) + flow
        rise = self.bodies.motion[0][:, row] @ liquid.up
        excess, push, wanted = (np.full(frames, np.nan) for _ in range(3))
        for k in range(window, frames):
            span = slice(k - window, k + 1)
            if np.isnan(sunk[span]).any() or sunk[span].max() < 0.02:
                continue
            time = window * liquid.duration
            push[k] = float(upward[k - window + 1 : k + 1].sum()) / time
            displaced = density * volume * float(sunk[span].mean())
            wanted[k] = displaced * liquid.strength
            speeding = (rise[k] - rise[k - window]) / time
            ends = [displaced * (liquid.strength - c * speeding) for c in ADDED]
            drag = DRAG * 0.5 * density * section * float(speed[span].max()) ** 2
            blur = density * liquid.strength * section * 0.5 * liquid.spacing
            # In still liquid drag pushes against the motion only; what streams by lifts or sucks.
            streams = float(flow[span].max()) > STREAMS
            low = min(ends) - blur - (drag if streams or rise[span].max() > 0.0 else 0.0)
            high = max(ends) + blur + (drag if streams or rise[span].min() < 0.0 else 0.0)
            excess[k] = max(low - push[k], push[k] - high, 0.0) / self._full(row)
        return excess, push, wanted


def _loads(cache: Cache, index: int) -> F64:
    """Impulse that a cloth says others gave it over a frame, shape (3,) [N s]."""
    names = tuple(f"record/load_impulse_{axis}" for axis in "xyz")
    held = [cache.read(k, names) for k in (max(index - 1, 0), index)]
    return np.array([float(held[1][n]) - float(held[0][n]) for n in names])


def _flat(liquid: Liquid) -> F64:
    """Two directions across `up`, shape (2, 3)."""
    flat = np.eye(3)[np.argsort(np.abs(liquid.up))[:2]]
    return np.asarray(flat - np.outer(flat @ liquid.up, liquid.up))


def _seen(liquid: Liquid, frame: Frame) -> F64:
    """Places of all particles seen along `up`, shape (n, 2)."""
    return np.asarray(frame.position @ _flat(liquid).T)


def _ring(liquid: Liquid, seen: F64, points: F64) -> NDArray[np.intp]:
    """Which particles lie about points."""
    s, here = liquid.spacing, points @ _flat(liquid).T
    low, high = here.min(axis=0), here.max(axis=0)
    rows = rows_within(seen, np.nextafter(low - RING * s, np.inf), np.nextafter(high + RING * s, -np.inf))
    gap = np.maximum(low - seen[rows], seen[rows] - high).max(axis=1, initial=-np.inf)
    return np.asarray(rows[(gap > 0.5 * s) & (gap < RING * s)])


def _flow(frame: Frame, near: NDArray[np.intp]) -> float:
    return float(np.sqrt(np.mean(frame.squared[near]))) if len(near) else 0.0


def _level(liquid: Liquid, frame: Frame, tops: NDArray[np.intp]) -> float | None:
    """Height of the surface that the highest particles of columns tell."""
    top = frame.position[tops] @ liquid.up
    if len(top) < 8 or float(np.quantile(top, 0.9) - np.quantile(top, 0.1)) > 2.0 * ROUGH * liquid.spacing:
        return None
    # The highest of a column lies half a particle under the surface.
    return float(np.median(top)) + 0.5 * liquid.pitch
