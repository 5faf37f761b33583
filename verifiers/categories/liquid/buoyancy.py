"""Upward push of a liquid on bodies that move freely, against the weight of the liquid that each displaces (R102).

The push is that of the displaced liquid, less what the body's own acceleration and drag take, and what gaps under it that are too
narrow for particles keep from a body that lies there and is too heavy to be lifted anyway.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ....worlds.arrays import F64, rotation_matrix
from ...rows.findings import Finding
from .about import COLUMN, Hull, Surroundings, hull_of, others_than
from .bounds import ADDED, BUOYANCY, DRAG, ROUGH, STREAMS
from .corrections import refine, shorter_step
from .footing import unwetted
from .samples import shares_under
from .solids import rows_within

if TYPE_CHECKING:
    from .bodies import Bodies
    from .frames import Frame, Liquid

__all__ = ["Buoyancy"]

WINDOW_SECONDS = 0.25
RING = 3.0
"""[spacings] Liquid up to this far from a body's box tells the level about it."""


@dataclass(frozen=True)
class _Lift:
    """Mean push on one body over every window of frames; arrays have the shape (frames,) and are NaN where no window can be judged."""

    row: int
    """Row of the body among the boundaries."""
    push: F64
    """Upward push [N]."""
    wanted: F64
    """Weight of the displaced liquid [N]."""
    excess: F64
    """By how much the push is outside of what is possible, over the weight of the liquid that the whole body displaces."""
    kept_out: float
    """Most lift that gaps under it keep from a body too heavy to rise [N]."""
    light: NDArray[np.bool_]
    """Where gaps under it are too narrow for particles, and it would rise if they were not."""

    @property
    def worst(self) -> float:
        """Largest excess; 0 where no window can be judged."""
        return float(np.nanmax(self.excess, initial=0.0))


class Buoyancy:
    """Finding on the upward push on bodies: sees every frame, then compares with the recorded impulses."""

    def __init__(self, liquid: Liquid, bodies: Bodies) -> None:
        self.liquid, self.bodies = liquid, bodies
        self.judged = [i for i, free in enumerate(bodies.free) if free]
        """Rows of bodies that forces move."""
        self.sheets = {i for i in self.judged if liquid.candidate.spec.entities[bodies.entities[i]].physics.category == "cloth"}
        """They displace nothing."""
        self.hulls = {i: hull_of(liquid, bodies.names[i]) for i in self.judged if i not in self.sheets}
        self.walls = {e: others_than(liquid, e) for e in {bodies.entities[i] for i in self.hulls}}
        self.sunk: list[F64] = []
        self.flow: list[F64] = []
        self.level: list[F64] = []

    def see(self, frame: Frame) -> None:
        """Take in the next frame: of every free body its share in the liquid, and the liquid's speed and level about it.

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
        self.sunk.append(sunk)
        self.flow.append(flow)
        self.level.append(levels)

    def _hull(self, row: int, index: int) -> Hull:
        entity, body = self.bodies.names[row].split("/")
        position, quaternion = self.liquid.candidate.track(entity, body)
        turn, hull = rotation_matrix(quaternion[index]).T, self.hulls[row]
        return Hull(hull.inside @ turn + position[index], hull.skin @ turn + position[index])

    def finding(self, impulse: F64) -> Finding:
        """Judge whether every push is that of the displaced liquid, after the last frame.

        Args:
            impulse: what the liquid gave to every boundary over each frame, shape (frames, b, 6) [N s, N m s].
        """
        window = max(2, round(WINDOW_SECONDS / self.liquid.duration))
        lifts = self._lifts(impulse, window)
        judged = sum(int((~np.isnan(lift.excess)).sum()) for lift in lifts)
        if not judged:
            return Finding("not_applicable", "no freely moving, two-way coupled body lies in liquid with a plain level")
        kept_out = {self.bodies.entities[lift.row]: lift.kept_out for lift in lifts if lift.kept_out > 0.0}
        evidence = {"lift_kept_out_n": kept_out}
        # Of equals, the first body.
        lift = max(lifts, key=lambda found: found.worst)
        text, light = f"the push on bodies is that of the displaced liquid ({judged} windows)", False
        if lift.worst > 0.0:
            k = int(np.nanargmax(lift.excess))
            text = f"{self._told(lift.row)} is pushed up by {lift.push[k]:.4g} N over frames {k - window}..{k}, displaced liquid gives {lift.wanted[k]:.4g} N"
            light = bool(lift.light[k])
        if light:
            text += "; gaps under it are too narrow for the particles, and it would float up if they were not"
        elif kept_out:
            text += "; " + ", ".join(
                f"{n} lies over gaps too narrow for the particles, up to {f:.3g} N of lift" for n, f in kept_out.items()
            )
        if lift.worst <= BUOYANCY:
            return Finding("pass", text, lift.worst, BUOYANCY, "1", evidence=evidence)
        narrow, few = "the gap under the body is too narrow for the particles", "too few particles push the body, each too hard"
        hints = (
            refine(self.liquid, narrow if light else few),
            shorter_step(self.liquid, "the body moves too far in a step"),
        )
        frame = int(np.argmax(np.nan_to_num(lift.excess, nan=0.0) > BUOYANCY))
        entity = self.bodies.entities[lift.row]
        return Finding("fail", text, lift.worst, BUOYANCY, "1", entity, frame, hints, evidence)

    def _lifts(self, impulse: F64, window: int) -> list[_Lift]:
        """Lift of every body that is coupled both ways and displaces liquid; none where nothing pulls all of it one way."""
        if self.liquid.strength < 1e-6 or self.liquid.attracted:
            return []
        sunk, flow, level = (np.array(x).reshape(len(impulse), len(self.judged)) for x in (self.sunk, self.flow, self.level))
        return [
            self._lift(row, impulse[:, row, :3] @ self.liquid.up, sunk[:, column], flow[:, column], level[:, column], window)
            for column, row in enumerate(self.judged)
            if row not in self.sheets and self.bodies.coupled(row) == "two_way"
        ]

    def _lift(self, row: int, upward: F64, sunk: F64, flow: F64, level: F64, window: int) -> _Lift:
        """Lift of one body, from the upward impulse on it [N s] and from what was seen about it, each of the shape (frames,)."""
        excess, push, wanted = self._excess(row, upward, sunk, flow, window)
        narrow = self._kept_out(row, (excess > BUOYANCY) & (push < wanted), level)
        # What lies there whether lifted or not moves alike; what should rise and does not is wrong.
        heavy = self.bodies.mass[row] * self.liquid.strength >= wanted
        excess = np.where(heavy, np.maximum(excess - narrow / self._full(row), 0.0), excess)
        return _Lift(row, push, wanted, excess, float(narrow[heavy].max(initial=0.0)), (narrow > 0.0) & ~heavy)

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
