# mypy: disable-error-code="arg-type, operator"
"""A path tracer that knows liquids: refraction and absorption where one looks through, straight light for what lies within.

Ordinary path tracing reaches the sun from under water only by chance. Here the faces of clear liquids bend light as long as
a path has met nothing rough since the eye; from then on light crosses them straight, weakened by what they reflect and by
the way inside (Beer-Lambert). So ground under water is lit without noise, and without caustics; panes of glass count alike.
Of diffuse light inside, the share 1 - 1/n^2 that cannot leave is mirrored, and radiance is divided by n^2 where it comes out:
what lies under water looks darker, as it does. Vectorised variants only.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ...worlds.arrays import F64

__all__ = ["IOR", "clear_path"]

IOR = 1.333
"""Refractive index of water; other liquids differ by less than 0.15."""
PANE_IOR = 1.5
"""Refractive index of window glass and of clear plastics."""
FACES = 10
"""Most faces of liquids that light towards a point crosses."""
_made: dict[str, type] = {}


def clear_path(mi: Any, shapes: list[Any], absorption: list[F64], panes: list[Any], depth: int) -> Any:
    """Integrator for a scene.

    Args:
        mi: Mitsuba with a vectorised variant.
        shapes: those that are faces of clear liquids.
        absorption: of each [1/m], shape (3,).
        panes: shapes of clear solids, which light towards a rough surface crosses straight as well.
        depth: longest path in segments; faces of liquids count for none of them beyond three times as many.
    """
    import drjit as dr

    if mi.variant() not in _made:
        _made[mi.variant()] = _defined(mi)
    integrator = _made[mi.variant()](mi.Properties())
    integrator.shapes = [mi.ShapePtr(shape) for shape in shapes]
    integrator.absorption = [mi.Color3f(*np.asarray(a, dtype=float).tolist()) for a in absorption]
    integrator.panes = [mi.ShapePtr(shape) for shape in panes]
    integrator.depth = depth
    # As literals they would make every frame a program of its own, compiled anew.
    dr.make_opaque(integrator.shapes, integrator.absorption, integrator.panes)
    return integrator


def _defined(mi: Any) -> type:
    import drjit as dr

    class ClearPath(mi.SamplingIntegrator):  # type: ignore[misc]
        """Path tracer that knows faces of clear liquids and panes; see the module's text."""

        shapes: list[Any]
        absorption: list[Any]
        panes: list[Any]
        depth: int

        pane = _pane
        face = _face
        towards = dr.syntax(_towards)
        sample = dr.syntax(_sample)

    return ClearPath


def _pane(self: Any, shape: Any) -> Any:
    """True for a pane."""
    import mitsuba as mi

    found = mi.Bool(False)
    for pointer in self.panes:
        found |= shape == pointer
    return found


def _face(self: Any, shape: Any) -> Any:
    """True for a shape that is a liquid's face, with that liquid's absorption [1/m]."""
    import drjit as dr
    import mitsuba as mi

    found, value = mi.Bool(False), mi.Color3f(0)
    for pointer, own in zip(self.shapes, self.absorption, strict=True):
        hit = shape == pointer
        found |= hit
        value = dr.select(hit, own, value)
    return found, value


def _towards(self: Any, scene: Any, start: Any, ds: Any, within: Any, active: Any) -> Any:
    """Share of light that comes straight from a sampled place on an emitter to a surface."""
    import drjit as dr  # functions that drjit rewrites see no names of enclosing ones
    import mitsuba as mi

    ray = start.spawn_ray_to(ds.p)
    left = mi.Float(ray.maxt)
    share = mi.Color3f(1)
    inside = mi.Color3f(within)
    count = mi.UInt32(0)
    active = mi.Bool(active)
    while active:
        si = scene.ray_intersect(ray, mi.RayFlags.Minimal, active)
        hit = active & si.is_valid()
        liquid, sigma = self.face(si.shape)
        crossed = liquid | self.pane(si.shape)
        share = dr.select(hit & ~crossed, 0, share)
        hit &= crossed
        normal = dr.dot(ray.d, si.n)
        share[hit] = share * dr.exp(-dr.select(liquid & (normal > 0), sigma, inside) * si.t)
        reflected, _, _, _ = mi.fresnel(dr.abs(normal), dr.select(liquid, IOR, PANE_IOR))
        share[hit] = share * (1 - reflected)
        share[active & ~hit] = share * dr.exp(-inside * dr.minimum(left, 1e6))
        inside[hit & liquid] = dr.select(normal < 0, sigma, 0)
        left[hit] = left - si.t
        ray.o[hit] = ray.o + ray.d * (si.t * (1 + 2e-6) + 1e-5)
        ray.maxt[hit] = left - 1e-5
        count += 1
        active = hit & (count < FACES) & (left > 1e-4)
    return share


class _Turn(NamedTuple):
    """Light that goes on at a face."""

    mirrored: Any
    passed: Any
    """Share that is not reflected on a straight way."""
    kept: Any
    """Share of diffuse light inside that can leave."""
    spread: Any
    """Ratio of the indices of refraction along a bent way."""
    ahead: Any
    """Direction in the world."""


def _turned(si: Any, direction: Any, normal: Any, liquid: Any, straight: Any, chance: Any) -> _Turn:
    """Turn of light that meets a face; `normal` is the cosine between them, `chance` a random number in 0..1."""
    import drjit as dr
    import mitsuba as mi

    bare, bent, _, ratio = mi.fresnel(-dr.dot(direction, si.sh_frame.n), IOR)
    outer, _, _, _ = mi.fresnel(dr.abs(normal), dr.select(liquid, IOR, PANE_IOR))
    within = liquid & (normal > 0)
    held = dr.select(within, 1 - 1 / IOR**2, 0)
    mirrored = chance < dr.select(straight, held, bare)
    local = si.to_local(direction)
    refracted = si.to_world(mi.refract(-local, bent, ratio))
    bounced = si.to_world(mi.Vector3f(local.x, local.y, -local.z))
    ahead = dr.select(mirrored, bounced, dr.select(straight, direction, refracted))
    return _Turn(mirrored, 1 - outer, 1 - held, ratio, ahead)


def _share(scene: Any, si: Any, origin: Any, density: Any, sharp: Any) -> Any:
    """Weight of light that a path meets by chance, beside what sampled emitters give (Veach & Guibas 1995)."""
    import drjit as dr
    import mitsuba as mi

    before = dr.zeros(mi.Interaction3f)
    before.p = origin
    ds = mi.DirectionSample3f(scene, si, before)
    other = scene.pdf_emitter_direction(before, ds, ~sharp)
    return dr.select(sharp, 1, density / dr.maximum(density + other, 1e-20))


class _Aimed(NamedTuple):
    """Light of a sampled emitter on a surface: the product of the factors, where usable."""

    usable: Any
    value: Any
    emitted: Any
    shade: Any
    balance: Any


def _aimed(self: Any, scene: Any, si: Any, bsdf: Any, chance: Any, inside: Any, smooth: Any) -> _Aimed:
    """A sampled emitter, seen straight through faces and panes; `chance` are two random numbers in 0..1."""
    import drjit as dr
    import mitsuba as mi

    es, emitted = scene.sample_emitter_direction(si, chance, False, smooth)
    usable = smooth & (es.pdf != 0)
    shade = self.towards(scene, si, es, inside, usable)
    value, density = bsdf.eval_pdf(mi.BSDFContext(), si, si.to_local(es.d), usable)
    balance = dr.select(es.delta, 1, es.pdf / dr.maximum(es.pdf + density, 1e-20))
    return _Aimed(usable, value, emitted, shade, balance)


def _sample(self: Any, scene: Any, sampler: Any, ray_: Any, medium: Any = None, active: Any = True) -> Any:
    """Radiance along rays."""
    import drjit as dr
    import mitsuba as mi

    ray = mi.Ray3f(ray_)
    context = mi.BSDFContext()
    light, weight = mi.Color3f(0), mi.Color3f(1)
    inside = mi.Color3f(0)
    origin = mi.Point3f(0)
    density = mi.Float(1)
    sharp, straight, seen = mi.Bool(True), mi.Bool(False), mi.Bool(False)
    depth, faces = mi.UInt32(0), mi.UInt32(0)
    active = mi.Bool(active)
    while active:
        si = scene.ray_intersect(ray, mi.RayFlags.All, depth == 0, active)
        hit = si.is_valid()
        seen |= hit
        liquid, sigma = self.face(si.shape)
        liquid &= hit
        normal = dr.dot(ray.d, si.n)
        way = dr.select(hit, si.t, 0)
        weight *= dr.exp(-dr.select(liquid & (normal > 0), sigma, inside) * way)

        emitter = si.emitter(scene)
        share = _share(scene, si, origin, density, sharp)
        lit = active & ~liquid
        light[lit] = light + weight * emitter.eval(si, lit) * share
        active &= hit & (depth + 1 < self.depth) & (faces < 3 * self.depth)

        # A face of a liquid: bend or mirror, or go straight on.
        at_face = active & (liquid | (straight & self.pane(si.shape)))
        turn = _turned(si, ray.d, normal, liquid, straight, sampler.next_1d(active))
        through = at_face & ~turn.mirrored
        weight[through & straight] = weight * turn.passed / turn.kept
        weight[through & ~straight] = weight * dr.square(turn.spread)
        # Sampled emitters are reached by straight ways only: nothing else accounts for mirrored ones.
        sharp |= at_face & straight & turn.mirrored
        inside[through & liquid] = dr.select(normal < 0, sigma, 0)
        faces[at_face] = faces + 1

        # Any other surface.
        rough = active & ~at_face
        bsdf = si.bsdf(ray)
        smooth = rough & mi.has_flag(bsdf.flags(), mi.BSDFFlags.Smooth)
        aimed = _aimed(self, scene, si, bsdf, sampler.next_2d(active), inside, smooth)
        light[aimed.usable] = light + weight * aimed.value * aimed.emitted * aimed.shade * aimed.balance
        bs, factor = bsdf.sample(context, si, sampler.next_1d(active), sampler.next_2d(active), rough)
        weight[rough] = weight * factor
        origin[rough] = si.p
        density[rough] = bs.pdf
        sharp[rough] = mi.has_flag(bs.sampled_type, mi.BSDFFlags.Delta)
        straight[rough & mi.has_flag(bs.sampled_type, mi.BSDFFlags.Reflection) & ~sharp] = True
        depth[rough] = depth + 1

        onward = dr.select(at_face, turn.ahead, si.to_world(bs.wo))
        ray = si.spawn_ray(onward)
        active &= dr.max(weight) > 1e-4
    return light, seen, []
