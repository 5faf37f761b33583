"""Surfaces that deform in a particle liquid: where they are, how their vertices give way to pressure, and what they get.

How a vertex moves without the liquid is not known to it: neither the elastic forces nor the contacts of the body. It is taken from the
last step, v - v_last - ease J_last, so that a surface at rest under a steady pressure is expected to stay, and only what the pressure
changes by moves it. With `ease` at least three quarters of what vertices truly answer, this is stable however light they are against the liquid
on them; more damps (the roots of one mode with ratio r of masses: (1 + b r) s^2 + 2 r (1 - b) s + r (b - 1) = 0).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ....geometry.launch import warp
from ....worlds.arrays import F64
from ...boundaries import BodyState
from ..boundary import Sampled
from ..engine import LiquidSetup

if TYPE_CHECKING:
    from ...passes import Passes
    from .bodies import Coupling
    from .store import Work

__all__ = ["SoftSurfaces"]

REACH = 4.0
"""[spacings] Farthest that a pair's particle is from the surface: from a sample by a support, and that from the surface by DEPTH."""
GIVE = 0.1
"""[spacings] What the liquid's force alone would move a vertex by in a step: pressure then comes to what the surface bears before the
liquid has noticed that it gave way. Light cloth under a pool asks for it; elastic bodies do not."""
LARGEST = 10.0
"""Accelerations of vertices count up to so many times gravity: those of impacts end with the step."""


class _Last(NamedTuple):
    """State of one surface after the last step."""

    speed: F64
    """At its start (v, 3) [m/s]."""
    force: F64
    """Force of the liquid on the vertices (v, 3) [N]."""
    seconds: float
    pull: float
    """Acceleration that the liquid alone would give its vertices, mean over the force [m/s^2]."""
    near: float
    """1 where liquid is within reach."""


class SoftSurfaces:
    """All deforming boundaries of one liquid.

    Args:
        setup: what does not change.
        sampled: samples of every boundary; those of the deforming ones lie on faces.
        rows: boundary of each of the moving samples.
        origin: of the engine's coordinates.
        passes: prepared kernels.
    """

    def __init__(self, setup: LiquidSetup, sampled: list[Sampled], rows: Any, origin: F64, passes: Passes) -> None:
        wp, device = warp(), passes.device
        self.origin, self.passes, self._spacing = origin, passes, setup.spacing
        self._largest = LARGEST * float(np.linalg.norm(setup.gravity))
        self._gravity = np.asarray(setup.gravity, dtype=float)
        boundaries = setup.boundaries
        self.rows = [k for k, b in enumerate(boundaries) if b.deforming]
        self._thin = {k for k in self.rows if not boundaries[k].closed}
        counts = [len(b.mesh.vertices) if b.deforming else 0 for b in boundaries]
        starts = np.cumsum([0, *counts])
        self.slices = {k: slice(int(starts[k]), int(starts[k + 1])) for k in self.rows}
        self.count = int(starts[-1])
        self.reacts = False
        size = max(self.count, 1)
        self.deforms = wp.array([int(b.deforming) for b in boundaries] or [0], dtype=wp.int32, device=device)
        self._start = wp.array(starts[: max(len(boundaries), 1)].astype(np.int32), dtype=wp.int32, device=device)
        self.x, self.velocity, self.start, self.acceleration, self._change = (
            wp.zeros(size, dtype=wp.vec3, device=device) for _ in range(5)
        )
        self._ease, self.bound, self._load = (wp.zeros(size, dtype=wp.float32, device=device) for _ in range(3))
        self._impulse = wp.zeros(size, dtype=wp.vec3d, device=device)
        self._spans = wp.zeros(size + 1, dtype=wp.vec2i, device=device)
        self._room = 0
        self._last: dict[int, _Last] = {}
        self._state: BodyState | None = None
        made = [_on_faces(boundaries[k].mesh, sampled[k], int(starts[k])) for k in self.rows]
        own = np.flatnonzero(np.isin(rows, self.rows)).astype(np.int32)
        self._samples = len(own)
        self._places: list[Any] = []
        if self._samples:
            columns = [np.concatenate([m[c] for m in made]) for c in range(4)]
            kinds = (wp.vec3i, wp.vec3, wp.vec3, wp.vec2)
            self._places = [wp.array(c, dtype=k, device=device) for c, k in zip(columns, kinds, strict=True)]
            self._places.append(wp.array(own, dtype=wp.int32, device=device))

    # ------------------------------------------------------------------ at the start of a step

    def begin(self, state: BodyState, dt: float, local: Any, volume: Any) -> None:
        """Take vertices as they are at the start of a step of `dt` seconds; lay the samples on them."""
        if not self.count:
            return
        from . import soft_kernels as kernels

        place, speed, change = (np.zeros((self.count, 3)) for _ in range(3))
        ease = np.zeros(self.count)
        for row, own in self.slices.items():
            place[own], speed[own] = state.vertices[row]
            if row in state.vertex_lightness:
                ease[own] = state.vertex_give.get(row, state.vertex_lightness[row])
                change[own] = self._expected(row, speed[own], ease[own], dt)
        self._state, self.reacts = state, bool(ease.any())
        self.x.assign((place - self.origin).astype(np.float32))
        self.velocity.assign(speed.astype(np.float32))
        self.start.assign(speed.astype(np.float32))
        self._change.assign(change.astype(np.float32))
        self._ease.assign(ease.astype(np.float32))
        self._impulse.zero_()
        self._spans.zero_()
        if self._samples:
            corner, weights, offset, rest, rows = self._places
            inputs = [corner, weights, offset, rest, rows, self.x, local, volume]
            self.passes("lay_samples", kernels.lay_samples, self._samples, inputs)()

    def _expected(self, row: int, speed: F64, ease: F64, dt: float) -> F64:
        """Change of velocity over a step by everything but the liquid, (v, 3) [m/s]."""
        last = self._last.get(row)
        if last is None:
            return np.where(ease[:, None] > 0.0, dt * self._gravity, 0.0)
        gain = (speed - last.speed) / last.seconds
        if row not in self._thin:
            size = np.linalg.norm(gain, axis=1, keepdims=True)
            gain *= np.minimum(1.0, self._largest / np.maximum(size, 1e-300))
        return np.asarray(np.where(ease[:, None] > 0.0, dt * (gain - ease[:, None] * last.force), 0.0))

    def lay_surface(self, row: int, mesh: Any) -> None:
        """Move the points of a mesh to where the surface is."""
        own = self.slices[row]
        warp().copy(mesh.points, self.x, src_offset=own.start, count=own.stop - own.start)
        mesh.refit()

    def longest(self, bodies: BodyState) -> float:
        """Largest step beside surfaces as light and as stiff as these [s]: what the liquid touches sets the pace."""
        steps = [float(np.sqrt(GIVE * self._spacing / last.pull)) for last in self._last.values() if last.pull > 0.0]
        steps += [pace for row, pace in bodies.vertex_pace.items() if row in self._last and self._last[row].near > 0.0]
        return min(steps, default=np.inf)

    # ------------------------------------------------------------------ pairs

    def attach(self, coupling: Coupling, surfaces: Any, work: Work) -> None:
        """Find where each pair is on its surface, and how its vertices give way together."""
        if not (self.count and coupling.total):
            return
        from . import grid_kernels
        from . import soft_kernels as kernels

        wp, run, total, pairs = warp(), self.passes, coupling.total, coupling.pairs
        if self._room < total:
            self._room = int(1.5 * total)
            self._key, self._order = (wp.zeros(6 * self._room, dtype=wp.int32, device=run.device) for _ in range(2))
        reach = REACH * self._spacing
        near = [coupling._x, surfaces, coupling.bodies, self._start, reach, self.count, pairs, self._key, self._order]
        run("attach", kernels.attach, total, near)()
        wp.utils.radix_sort_pairs(self._key, self._order, 3 * total)
        run("soft_spans", grid_kernels.spans, 3 * total, [3 * total, self._key, self._spans])()
        self._lists = [pairs, self._order, self._spans, self._ease]
        inputs = [coupling._volume, work.lightness, *self._lists, self.bound, self._load]
        run("weigh", kernels.weigh, self.count, inputs)()
        run("soften", kernels.soften, total, [self._load, pairs])()
        if self._thin:
            w, h = work, 2.0 * self._spacing
            sums = [w.fill, w.lean, w.stiffness]
            run(
                "cut", kernels.cut, coupling._n, [coupling._x, coupling._volume, w.lightness, pairs, surfaces, h, *w.lists, *sums]
            )()

    def slow(self, coupling: Coupling, work: Work) -> None:
        """Let friction of the pairs not reverse what light vertices do against the liquid in one step."""
        if not (self.reacts and coupling.total):
            return
        from . import soft_kernels as kernels

        pairs, order, spans, ease = self._lists
        inputs = [coupling._volume, work.viscosity, work.settings, pairs, order, spans, ease, self._load]
        self.passes("slow", kernels.slow, self.count, inputs)()
        self.passes("thicken_walls", kernels.thicken_walls, coupling.total, [self._load, pairs])()

    # ------------------------------------------------------------------ impulses

    def kick(self) -> None:
        """Velocity of the vertices by everything but the liquid."""
        if self.reacts:
            from . import soft_kernels as kernels

            self.passes("kick_vertices", kernels.kick_vertices, self.count, [self._change, self.velocity])()

    def pull(self, p: Any, volume: Any) -> list[Callable[[], None]]:
        """Pass that finds how the vertices are accelerated by pressure; none where they are not."""
        if not self.reacts:
            return []
        from . import soft_kernels as kernels

        return [self.passes("pull", kernels.pull, self.count, [volume, p, *self._lists, self.acceleration])]

    def press(self, coupling: Coupling, p: Any) -> None:
        """Give the vertices the impulses of a pressure solve that has ended."""
        if self.count and coupling.total:
            from . import soft_kernels as kernels

            inputs = [coupling._volume, p, coupling.pairs, coupling.pair_force]
            self.passes("press", kernels.press, coupling.total, inputs)()
            self.take(coupling, coupling.pair_force)

    def take(self, coupling: Coupling, force: Any) -> None:
        """Give the vertices the impulses of forces of the pairs."""
        if self.count and coupling.total:
            from . import soft_kernels as kernels

            inputs = [force, coupling._work.settings, *self._lists, self.velocity, self._impulse]
            self.passes("take", kernels.take, self.count, inputs)()

    def given(self, impulse: F64, dt: float) -> dict[int, F64]:
        """Impulse on each vertex of the reacting surfaces in the step, by row (v, 3) [N s]; kept for the next one.

        Args:
            impulse: of all boundaries, linear and angular about their centres (b, 6).
            dt: the step [s].
        """
        found: dict[int, F64] = {}
        state = self._state
        if not self.count or state is None:
            return found
        whole, ease, reached = self._impulse.numpy(), self._ease.numpy(), self._spans.numpy()
        for row, own in self.slices.items():
            if row not in state.vertex_lightness:
                continue
            places, speeds = state.vertices[row]
            got = _whole(whole[own], places, ease[own], impulse[row], state.center[row])
            found[row] = got
            force = got / dt
            size = np.linalg.norm(force, axis=1)
            pull = float(size**2 @ ease[own] / max(float(size.sum()), 1e-300))
            near = float((reached[own, 1] > reached[own, 0]).any())
            self._last[row] = _Last(np.array(speeds), force, dt, pull, near)
        return found

    # ------------------------------------------------------------------ state

    def pack(self) -> dict[str, F64]:
        """State that the next step goes on from."""
        found: dict[str, F64] = {}
        for row, last in self._last.items():
            pace = np.array([last.seconds, last.pull, last.near])
            found |= {f"soft{row}_speed": last.speed, f"soft{row}_force": last.force, f"soft{row}_pace": pace}
        return found

    def unpack(self, found: dict[str, Any]) -> None:
        """Go on from such a state."""
        self._last = {
            row: _Last(found[f"soft{row}_speed"], found[f"soft{row}_force"], *(float(k) for k in found[f"soft{row}_pace"]))
            for row in self.rows
            if f"soft{row}_speed" in found
        }


def _whole(got: F64, places: F64, ease: F64, impulse: F64, center: F64) -> F64:
    """Impulses of vertices (v, 3) [N s] whose sum and moment are just those of the body.

    A force acts at its particle, up to a spacing off the surface: what its moment lacks there goes to all free vertices as a turn of the
    whole (inertia 1/ease), of no net force; and so does what rounding left.
    """
    free = ease > 0.0
    if not free.any():
        return got
    mass, arm = np.where(free, 1.0 / np.where(free, ease, 1.0).astype(np.float64), 0.0), places - center
    middle = mass @ arm / mass.sum()
    result = got + (mass / mass.sum())[:, None] * (impulse[:3] - got.sum(axis=0))
    lacking = impulse[3:] - np.cross(arm, result).sum(axis=0)
    own = arm - middle
    inertia = float((mass * (own**2).sum(axis=1)).sum()) * np.eye(3) - np.einsum("n,ni,nj->ij", mass, own, own)
    turn = np.linalg.lstsq(inertia, lacking, rcond=1e-9)[0]
    return np.asarray(result + mass[:, None] * np.cross(turn, own))


def _on_faces(mesh: Any, sampled: Sampled, start: int) -> tuple[Any, Any, Any, Any]:
    """Corners, weights, offsets in the frames of their faces, volumes and areas of samples."""
    faces = mesh.faces[sampled.face]
    corner = mesh.vertices[faces]
    one = corner[:, 1] - corner[:, 0]
    normal = np.cross(one, corner[:, 2] - corner[:, 0])
    size = np.linalg.norm(normal, axis=1)
    n = normal / np.maximum(size, 1e-300)[:, None]
    one = one / np.maximum(np.linalg.norm(one, axis=1), 1e-300)[:, None]
    way = sampled.position - np.einsum("nk,nkd->nd", sampled.weights, corner)
    offset = np.stack([(way * axis).sum(axis=1) for axis in (one, np.cross(n, one), n)], axis=1)
    rest = np.stack([sampled.volume, 0.5 * size], axis=1)
    return (
        (faces + start).astype(np.int32),
        sampled.weights.astype(np.float32),
        offset.astype(np.float32),
        rest.astype(np.float32),
    )
