"""Particles that fly alone: gravity, drag and fields between hits; at a surface they bounce, stick or die (R65).

They do not meet each other and push nothing: the approximation is declared. A step is straight; what a way meets first is asked of
the bodies' surfaces in their own frames, at their places at its start and at its end.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ...geometry.launch import chosen_device, launch, warp
from ...physics.drag import Medium, sphere_drag_rate
from ...worlds.arrays import F64
from ...worlds.fields import Dragged
from ..boundaries import BodyState, Surround
from ..sealed import from_bytes, to_bytes
from .frames import FramedParticles
from .scatter import emitted, scattered
from .scene import surround_for
from .setup import GrainReport

__all__ = ["SolverFlight"]

BOUNCES = 3
"""Hits of one particle within a step; after the last it waits for the next."""
FIELDS = ("position", "velocity", "radius", "kind", "identity", "life", "stuck", "local")
FREE = -1


class SolverFlight(FramedParticles):
    """Sparks, dust, rain, ash."""

    @property
    def surround(self) -> Surround:
        """The bodies that it meets."""
        return self._surround

    def set_up(self) -> None:
        """Particles of the volumes, at random places; the surfaces."""
        wp = warp()
        self._surround = surround_for(self.spec, self.built, self.name)
        self.device = chosen_device(self.instance.settings.device)
        self._trees = [
            wp.Mesh(
                points=wp.array(np.asarray(b.mesh.vertices, dtype=np.float32), dtype=wp.vec3, device=self.device),
                indices=wp.array(np.ascontiguousarray(b.mesh.faces, dtype=np.int32).ravel(), dtype=wp.int32, device=self.device),
            )
            for b in self._surround.boundaries
        ]
        self._ids = wp.array(np.array([t.id for t in self._trees] or [0], dtype=np.uint64), dtype=wp.uint64, device=self.device)
        names = [b.name.split("/", 1)[0] for b in self._surround.boundaries]
        self._friction = np.array([b.friction for b in self._surround.boundaries])
        self._bounce = np.array(
            [
                min(
                    (
                        self.spec.materials[p.material or self.spec.entities[n].material].restitution
                        for p in self.spec.entities[n].parts.values()
                    ),
                    default=0.0,
                )
                for n in names
            ]
        )
        self.low, self.high = (self.origin + s * 0.5 * np.array(self.instance.settings.domain.size) for s in (-1, 1))
        self.emitters = {
            k: d for k, d in self.spec.simulation.drivers.items() if d.kind == "emitter" and d.entity in self.members
        }
        self.out = dict.fromkeys(self.emitters, 0)
        self.next_identity = 0
        self.now: dict[str, Any] = self._empty(0)
        for k, member in enumerate(self.members):
            self._add(scattered(self.spec, self.built[member], member, k))

    def _empty(self, n: int) -> dict[str, Any]:
        return {
            "position": np.zeros((n, 3)), "velocity": np.zeros((n, 3)), "radius": np.zeros(n), "kind": np.zeros(n, np.int32),
            "identity": np.zeros(n, np.int32), "life": np.zeros(n), "stuck": np.full(n, FREE, np.int32), "local": np.zeros((n, 3)),
        }  # fmt: skip

    def _add(self, new: dict[str, Any]) -> None:
        n = len(new["radius"])
        more = self._empty(n) | new | {"identity": self.next_identity + np.arange(n, dtype=np.int32)}
        self.next_identity += n
        self.now = {name: np.concatenate([self.now[name], more[name]]) for name in FIELDS}

    def begin_motion(self) -> None:
        """Give the declared velocities."""
        declared = np.array([self.physics(k).linear_velocity for k in range(len(self.members))], dtype=np.float64)
        self.now["velocity"] = self.now["velocity"] + declared[self.now["kind"]]

    def max_stable_dt(self) -> float:
        """Longest step [s]."""
        return float(getattr(self.instance.settings, "max_step", 2e-3))

    # ------------------------------------------------------------------ steps

    def exchange(self, seconds: float, bodies: BodyState, time: float) -> GrainReport:
        """One step of `seconds` from `time`."""
        reaction = np.zeros((len(self._surround.boundaries), 6))
        spans = np.full(len(self.now["radius"]), seconds)
        before = len(spans)
        for row, (name, driver) in enumerate(self.emitters.items()):
            if name in self._done.without:
                continue
            made, born, self.out[name] = emitted(self.spec, driver, row, self.out[name], time, time + seconds, self.members)
            if len(born):
                self._add(made)
                spans = np.concatenate([spans, time + seconds - born])
        mass = self._masses()
        came = len(spans) - before, float(mass[before:].sum())
        blown, work = self._accelerate(spans, time, mass)
        dead = self._travel(spans, bodies, seconds, mass, reaction)
        self._follow(bodies, seconds, mass, reaction, spans)
        self.now["life"] = self.now["life"] - spans
        dead |= self.now["life"] <= 0
        died = int(dead.sum()), float(mass[dead].sum())
        out = ~dead & ((self.now["position"] < self.low) | (self.now["position"] > self.high)).any(axis=1)
        left = np.array([out.sum(), mass[out].sum(), *(mass[out] @ self.now["velocity"][out])])
        lost = mass[dead] @ self.now["velocity"][dead]
        left[2:] += lost
        speed = float(np.linalg.norm(self.now["velocity"], axis=1).max(initial=0.0))
        kept = ~(dead | out)
        self.now = {name: values[kept] for name, values in self.now.items()}
        return GrainReport(
            dt=seconds, impulse=np.zeros_like(reaction), reaction=reaction, fastest=speed, blown=blown, work=work, left=left, came=came,
            died=died,
        )  # fmt: skip

    def _masses(self) -> F64:
        result: F64 = 4.0 / 3.0 * np.pi * self.density[self.now["kind"]] * self.now["radius"] ** 3
        return result

    def _accelerate(self, spans: F64, time: float, mass: F64) -> tuple[F64, float]:
        """Gravity, drag and fields over the step; impulse per member and work of drag and fields."""
        now, gravity = self.now, np.array(self.spec.simulation.gravity)
        blown, work = np.zeros((len(self.members), 3)), 0.0
        free = now["stuck"] == FREE
        velocity = now["velocity"].copy()
        velocity[free] += spans[free, None] * gravity
        for k, fields in enumerate(self.fields):
            own = np.flatnonzero(free & (now["kind"] == k))
            if not fields or time < 0 or not len(own):
                continue
            before = velocity[own].copy()
            span = spans[own, None]
            velocity[own] += span * fields.acceleration(now["position"][own], time)
            medium: Medium = fields.medium(now["position"][own], time)
            pace = sphere_drag_rate(medium, now["radius"][own], mass[own], velocity[own])[:, None]
            rate = pace * span
            dragged = Dragged(velocity[own], mass[own], (rate / (1.0 + rate))[:, 0], pace[:, 0], float(span.max()))
            felt = fields.answer(now["position"][own], time, dragged)
            flow = medium.velocity if felt is None else medium.velocity + felt.change
            velocity[own] = (velocity[own] + rate * flow) / (1.0 + rate)
            if felt is not None:
                felt.take(mass[own, None] * rate * (flow - velocity[own]))
            given = mass[own, None] * (velocity[own] - before)
            blown[k] = given.sum(axis=0)
            work += float((given * 0.5 * (velocity[own] + before)).sum())
        now["velocity"] = velocity
        return blown, work

    def _travel(self, spans: F64, bodies: BodyState, seconds: float, mass: F64, reaction: F64) -> Any:
        """Straight ways with hits; returns who died."""
        now = self.now
        dead = np.zeros(len(spans), dtype=bool)
        moving = np.flatnonzero(now["stuck"] == FREE)
        left = spans[moving].copy()
        policy = np.array([self.physics(k).on_hit for k in range(len(self.members))])
        restitution = np.array([self.spec.materials[self.spec.entities[m].material].restitution for m in self.members])
        friction = np.array([self.spec.materials[self.spec.entities[m].material].friction for m in self.members])
        for bounce in range(BOUNCES):
            if not len(moving):
                break
            start = now["position"][moving]
            end = start + left[:, None] * now["velocity"][moving]
            share, body, normal = self._meet(start, end, now["radius"][moving], bodies, seconds)
            met = body >= 0
            now["position"][moving[~met]] = end[~met]
            hit, rows = moving[met], body[met]
            if not len(hit):
                break
            turn, arm = bodies.rotation[rows], np.zeros((len(hit), 3))
            out = np.einsum("nij,nj->ni", turn, normal[met])
            place = start[met] + share[met, None] * (end - start)[met]
            arm = place - bodies.center[rows]
            wall = bodies.velocity[rows] + np.cross(bodies.angular_velocity[rows], arm)
            was = now["velocity"][hit].copy()
            slip = was - wall
            closing = (slip * out).sum(axis=1)
            along = slip - closing[:, None] * out
            e = np.minimum(self._bounce[rows], restitution[now["kind"][hit]])
            mu = np.maximum(self._friction[rows], friction[now["kind"][hit]])
            slide = np.linalg.norm(along, axis=1)
            kept = np.maximum(0.0, 1.0 - mu * (1 + e) * np.abs(closing) / np.maximum(slide, 1e-12))
            after = wall + along * kept[:, None] - (e * closing)[:, None] * out
            sticks, dies = policy[now["kind"][hit]] == "stick", policy[now["kind"][hit]] == "die"
            after[sticks | dies] = wall[sticks | dies]
            now["velocity"][hit] = after
            now["position"][hit] = place
            given = mass[hit, None] * (after - was)
            np.add.at(reaction, rows, np.concatenate([given, np.cross(arm, given)], axis=1))
            now["stuck"][hit[sticks]] = rows[sticks]
            now["local"][hit[sticks]] = np.einsum("nji,nj->ni", turn[sticks], place[sticks] - bodies.position[rows[sticks]])
            dead[hit[dies]] = True
            on = ~(sticks | dies)
            left = (left[met] * (1.0 - share[met]))[on]
            moving = hit[on]
            if bounce == BOUNCES - 1:
                break
        return dead

    def _meet(self, start: F64, end: F64, radius: F64, bodies: BodyState, seconds: float) -> tuple[Any, ...]:
        """First surface that each way meets: share of the way, body (-1: none), normal in the body's frame. After a bounce, bodies are where they
        were at the start of the step."""
        n, b = len(start), len(self._surround.boundaries)
        if not b:
            return np.full(n, 2.0), np.full(n, -1), np.zeros((n, 3))
        from scipy.spatial.transform import Rotation

        from . import flight_kernels as kernels

        wp = warp()
        now, turn = bodies.position - self.origin, Rotation.from_matrix(bodies.rotation)
        step = Rotation.from_rotvec(bodies.angular_velocity * seconds)
        arm = bodies.center - bodies.position
        then = bodies.center + bodies.velocity * seconds - step.apply(arm) - self.origin
        arrays = [
            wp.array(v, dtype=kind, device=self.device)
            for v, kind in (
                (now, wp.vec3d), (turn.as_quat(), wp.quatd), (then, wp.vec3d), ((step * turn).as_quat(), wp.quatd),
                (start - self.origin, wp.vec3d), (end - self.origin, wp.vec3d), (radius, wp.float64),
            )
        ]  # fmt: skip
        share, body = wp.zeros(n, dtype=wp.float32, device=self.device), wp.zeros(n, dtype=wp.int32, device=self.device)
        normal = wp.zeros(n, dtype=wp.vec3d, device=self.device)
        launch(kernels.meet, n, [b, self._ids, *arrays, share, body, normal], device=self.device)
        return share.numpy().astype(float), body.numpy(), normal.numpy()

    def _follow(self, bodies: BodyState, seconds: float, mass: F64, reaction: F64, spans: F64) -> None:
        """Particles that stick go with their bodies."""
        from scipy.spatial.transform import Rotation

        now = self.now
        held = np.flatnonzero(now["stuck"] != FREE)
        if not len(held):
            return
        rows = now["stuck"][held]
        step = Rotation.from_rotvec(bodies.angular_velocity * seconds).as_matrix()
        turned = step @ bodies.rotation
        center = bodies.center + bodies.velocity * seconds
        origin = center - np.einsum("nij,nj->ni", step, bodies.center - bodies.position)
        place = origin[rows] + np.einsum("nij,nj->ni", turned[rows], now["local"][held])
        arm = place - center[rows]
        speed = bodies.velocity[rows] + np.cross(bodies.angular_velocity[rows], arm)
        given = mass[held, None] * (speed - now["velocity"][held] - spans[held, None] * np.array(self.spec.simulation.gravity))
        fresh = np.abs(given).sum(axis=1) >= 0
        np.add.at(reaction, rows[fresh], np.concatenate([given, np.cross(arm, given)], axis=1)[fresh])
        now["position"][held], now["velocity"][held] = place, speed

    # ------------------------------------------------------------------ state

    def columns(self) -> dict[str, Any]:
        """The present state."""
        n = len(self.now["radius"])
        held = {k: self.now[k] for k in ("position", "velocity", "radius", "kind", "identity")}
        return {**held, "spin": np.zeros((n, 3)), "mass": self._masses()}

    def pack(self) -> bytes:
        """State of the engine."""
        counts = np.array([self.out[k] for k in self.emitters], dtype=np.int64)
        return to_bytes({**self.now, "out": counts, "next_identity": np.int64(self.next_identity)})

    def unpack(self, state: bytes) -> None:
        """Continue from such a state."""
        found = from_bytes(state, (*FIELDS, "out", "next_identity"))
        self.now = {name: found[name] for name in FIELDS}
        self.out = dict(zip(self.emitters, map(int, found["out"]), strict=True))
        self.next_identity = int(found["next_identity"])
