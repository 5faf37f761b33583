"""A candidate as a Mitsuba scene that is loaded once and then only moved from frame to frame."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from ...geometry.camera import Camera
from ...worlds.arrays import F32, F64, rotation_matrix
from ...worlds.built import BuiltPart
from ...worlds.candidate import Candidate
from ...worlds.spec import Appearance
from ..categories.deforming import SoftPart, soft_part
from ..categories.liquid.meshes import liquids_of
from ..categories.liquid.shapes import liquid_shapes
from ..categories.liquid.wet_look import Link, Wetness, darkened, film_at
from ..categories.particles.shapes import grain_shapes
from ..land.scenery import cut_from, landscapes_of, scenery_shapes
from ..shades import brick_tone
from ..views import active, part_frame
from .clear_path import liquid_integrator
from .lights import light_dicts
from .surfaces import Surface, textured_surfaces
from .textures import Tile, pattern_tiles
from .variant import load_mitsuba

__all__ = ["Features", "SceneRenderer"]

PATH_DEPTH = 5
"""Longest light path in segments; glass needs `GLASS_DEPTH`."""
GLASS_DEPTH = 9
FILM = "vertex_film"
"""Attribute of meshes: share of a liquid's film that is left on them."""
FILM_ROUGHNESS = 0.12
"""Most that a surface under a film has; own choice."""
PANE = 0.5
"""Transmission from which on light crosses a solid beside liquids."""
RAYS_PER_PASS = 4_000_000
"""Camera rays per launch; bounds the memory of the vectorised variants."""


class Features(NamedTuple):
    """What guides the denoiser, and where the picture shows matter. Each (height, width, 3)."""

    albedo: F32
    normals: F32


@dataclass(frozen=True)
class _Batch:
    """All parts of one material layer that move, or all that do not, as one mesh."""

    name: str
    bodies: tuple[tuple[str, str], ...]
    """(entity, body) that own vertices."""
    owner: Any
    """Index into `bodies` per vertex."""
    surface: Surface
    links: tuple[tuple[int, tuple[Link, ...]], ...] = ()
    """Of wetted parts in the order of their vertices: how many, and whence their film; empty where nothing gets wet."""
    soft: tuple[SoftPart, ...] = ()
    """Parts that deform."""

    def film(self, wetness: Wetness, frame: int, known: dict[str, F64]) -> F32:
        """Share of the film of a liquid at every vertex, shape (v,)."""
        return np.concatenate([film_at(wetness, list(links), count, frame, known) for count, links in self.links])

    def placed(self, candidate: Candidate, frame: int) -> tuple[F32, F32]:
        """World positions and normals at a frame; entities that do not exist then shrink to a point."""
        poses = [candidate.pose(entity, frame, body) for entity, body in self.bodies]
        turns = rotation_matrix(np.stack([p.quaternion for p in poses]))
        shown = np.array([active(candidate, entity, frame) for entity, _ in self.bodies], dtype=np.float64)
        shifts = np.stack([p.position for p in poses])
        local = self.surface.positions * shown[self.owner, None]
        positions = np.einsum("nij,nj->ni", turns[self.owner], local) + shifts[self.owner]
        normals = np.einsum("nij,nj->ni", turns[self.owner], self.surface.normals)
        for part in self.soft:
            if active(candidate, part.entity, frame):
                positions[part.rows], normals[part.rows] = part.placed(candidate, frame)
        return positions.astype(np.float32), normals.astype(np.float32)


def _joined(surfaces: list[Surface]) -> Surface:
    starts = np.cumsum([0, *(len(s.positions) for s in surfaces)])
    return Surface(
        np.concatenate([s.positions for s in surfaces]),
        np.concatenate([s.normals for s in surfaces]),
        np.concatenate([s.uv for s in surfaces]),
        np.concatenate([s.faces + start for s, start in zip(surfaces, starts, strict=False)]),
    )


def _batches(
    candidate: Candidate, tiles: dict[str, dict[str, Tile]], wetness: Wetness
) -> dict[tuple[str, str, bool, bool, float], _Batch]:
    """Batches by (material, layer, moving, ever wet, tone)."""
    found: dict[tuple[str, str, bool, bool, float], list[tuple[str, BuiltPart, Surface]]] = {}
    wet = wetness.entities()
    scenery = landscapes_of(candidate)
    for entity in sorted(candidate.built):
        if cut_from(candidate, entity) in scenery or entity in (*candidate.liquids, *candidate.particulates):
            continue
        changing = candidate.moves(entity) or candidate.spec.entities[entity].active is not None
        for part in candidate.built[entity].parts:
            look = candidate.spec.materials[part.material].appearance
            layers = textured_surfaces(
                part.render,
                smooth=part.smooth,
                tiles=tiles[part.material],
                pattern=look.pattern,
                scale=look.pattern_scale,
                frame=part_frame(candidate, entity, part),
                key=f"{entity}/{part.part}",
            )
            wets = entity in wet and look.transmission < PANE and entity not in candidate.deforming
            tone = brick_tone(candidate.spec, entity, part.part)
            for layer, surface in layers.items():
                fine = wetness.refined(entity, part.body, part.part, surface) if wets else surface
                found.setdefault((part.material, layer, changing, wets, tone), []).append((entity, part, fine))
    batches = {}
    for key, pieces in found.items():
        bodies = tuple(dict.fromkeys((entity, part.body) for entity, part, _ in pieces))
        index = {name: k for k, name in enumerate(bodies)}
        owner = np.concatenate([np.full(len(s.positions), index[entity, part.body]) for entity, part, s in pieces])
        name = f"{'moving' if key[2] else 'static'}-{key[0]}-{key[1]}{'-wet' if key[3] else ''}"
        name += f"-{round(100 * key[4])}" if key[4] != 1.0 else ""
        links = [(len(s.positions), tuple(wetness.links(e, p.body, p.part, s))) for e, p, s in pieces] if key[3] else []
        starts = np.cumsum([0, *(len(s.positions) for *_, s in pieces)])
        soft = [soft_part(e, p, s, int(k)) for (e, p, s), k in zip(pieces, starts, strict=False) if e in candidate.deforming]
        batches[key] = _Batch(name, bodies, owner, _joined([s for *_, s in pieces]), tuple(links), tuple(soft))
    return batches


def _toned(look: Appearance, tile: Tile | None, tone: float) -> tuple[Appearance, Tile | None]:
    """An appearance and its tile so many times lighter."""
    if tone == 1.0:
        return look, tile
    lit = look.model_copy(update={"color": tuple(min(1.0, tone * c) for c in look.color)})
    return lit, None if tile is None else replace(tile, image=np.minimum(tone * tile.image, 1.0).astype(np.float32))


def _bsdf(mi: Any, look: Appearance, tile: Tile | None, *, open_surface: bool, wets: bool = False) -> Any:
    """Principled BSDF of an appearance; open surfaces show both sides, those that get wet blend to their wet look by their film."""
    described = _described(mi, look, tile, wet=False)
    if wets:
        weight = {"type": "mesh_attribute", "name": FILM}
        described = {"type": "blendbsdf", "weight": weight, "dry": described, "wet": _described(mi, look, tile, wet=True)}
    if open_surface and look.transmission == 0:
        return mi.load_dict({"type": "twosided", "bsdf": described})
    return mi.load_dict(described)


def _described(mi: Any, look: Appearance, tile: Tile | None, *, wet: bool) -> dict[str, Any]:
    """Description of a principled BSDF. A film smooths what is rough, and darkens what is no metal."""
    dark = wet and look.metallic < 0.5
    color: dict[str, Any] = {"type": "rgb", "value": darkened(look.color).tolist() if dark else list(look.color)}
    if tile is not None:
        image = darkened(tile.image).astype(np.float32) if dark else tile.image
        color = {
            "type": "bitmap",
            "bitmap": mi.Bitmap(np.ascontiguousarray(image)),
            "raw": True,
            "wrap_mode": "repeat",
            "filter_type": "nearest" if tile.sharp else "bilinear",
        }
    description: dict[str, Any] = {
        "type": "principled",
        "base_color": color,
        "roughness": max(min(look.roughness, FILM_ROUGHNESS) if wet else look.roughness, 0.03),
    }
    if look.metallic > 0:
        description["metallic"] = look.metallic
    if look.transmission > 0:
        description |= {"spec_trans": look.transmission, "eta": 1.5}
    else:
        description["specular"] = 0.5
    return description


def _mesh(mi: Any, name: str, surface: Surface, positions: F32, normals: F32, bsdf: Any, film: F32 | None = None) -> Any:
    """Build a mesh object, with the film on its vertices where it gets wet. The only place that knows Mitsuba's mesh API (it changes in 3.10)."""
    properties = mi.Properties()
    properties["mesh_bsdf"] = bsdf
    mesh = mi.Mesh(
        name,
        len(positions),
        len(surface.faces),
        props=properties,
        has_vertex_normals=True,
        has_vertex_texcoords=True,
    )
    if film is not None:
        mesh.add_attribute(FILM, 1, film)
    parameters = mi.traverse(mesh)
    parameters["vertex_positions"] = positions.ravel()
    parameters["vertex_normals"] = normals.ravel()
    parameters["vertex_texcoords"] = surface.uv.astype(np.float32).ravel()
    parameters["faces"] = surface.faces.astype(np.uint32).ravel()
    parameters.update()
    return mesh


class SceneRenderer:
    """One candidate loaded into Mitsuba. `pose` moves it to a frame; `radiance` and `features` take pictures.

    Meshes are merged by material, so a scene of thousands of parts has a dozen shapes; only vertices of the
    moving batches are rewritten between frames, so that nothing is recompiled. `lights` replaces the world's sky,
    ground and lights by other Mitsuba dictionaries; `eyes` are places of cameras besides those of the shot plan [m].
    """

    def __init__(
        self, candidate: Candidate, *, frame: int = 0, lights: dict[str, Any] | None = None, eyes: Sequence[F64] = ()
    ) -> None:
        self.candidate = candidate
        self.mi = mi = load_mitsuba()
        self._scalar = mi.variant().startswith("scalar")
        solid = [
            p for name, b in candidate.built.items() if name not in (*candidate.liquids, *candidate.particulates) for p in b.parts
        ]
        materials, open_materials = {p.material for p in solid}, {p.material for p in solid if not p.closed}
        looks = {name: candidate.spec.materials[name].appearance for name in sorted(materials)}
        tiles = {name: pattern_tiles(look.pattern, look.color, seed=k) for k, (name, look) in enumerate(looks.items())}
        self._moving: list[_Batch] = []
        self._wet: list[_Batch]
        self._panes: list[str] = []
        scene: dict[str, Any] = {"type": "scene", **(light_dicts(mi, candidate) if lights is None else lights)}
        self._wetness, self._wet, known = Wetness(candidate), [], dict[str, F64]()
        bsdfs: dict[tuple[str, str, bool, float], Any] = {}
        for (material, layer, moving, wets, tone), batch in sorted(_batches(candidate, tiles, self._wetness).items()):
            if (material, layer, wets, tone) not in bsdfs:
                both = material in open_materials
                look, tile = _toned(looks[material], tiles[material].get(layer), tone)
                bsdfs[material, layer, wets, tone] = _bsdf(mi, look, tile, open_surface=both, wets=wets)
            positions, normals = batch.placed(candidate, frame)
            film = batch.film(self._wetness, frame, known) if wets else None
            scene[batch.name] = _mesh(mi, batch.name, batch.surface, positions, normals, bsdfs[material, layer, wets, tone], film)
            if moving:
                self._moving.append(batch)
            if wets:
                self._wet.append(batch)
            if looks[material].transmission >= PANE:
                self._panes.append(batch.name)
        scenery = scenery_shapes(mi, candidate, eyes)
        self.outdoors = bool(scenery)
        scene |= scenery
        self._liquids = liquids_of(candidate)
        self._fresh = bool(self._liquids or candidate.particle_caches)
        if self._fresh:
            # Faces of liquids and places of grains are new in every frame; all the rest stays loaded.
            scene = {k: mi.load_dict(v) if isinstance(v, dict) else v for k, v in scene.items()}
        self._fixed = scene
        self._frame = frame
        self._glassy = any(look.transmission > 0 for look in looks.values())
        self._load(frame)
        self._aov = mi.load_dict({"type": "aov", "aovs": "albedo:albedo,normal:sh_normal"})
        self._depth = mi.load_dict({"type": "aov", "aovs": "depth:depth"})

    def _load(self, frame: int) -> None:
        """Load the scene with the liquids of a frame, and the tracer that knows them."""
        mi = self.mi
        liquid = liquid_shapes(mi, self._liquids, frame)
        self.scene = mi.load_dict({**self._fixed, **liquid.shapes, **grain_shapes(mi, self.candidate, frame)})
        self._parameters = mi.traverse(self.scene)
        depth = GLASS_DEPTH if self._glassy or liquid.clear else PATH_DEPTH
        if not self._scalar and (liquid.clear or (liquid.shapes and self._panes)):
            faces, panes = [liquid.shapes[name] for name in liquid.clear], [self._fixed[name] for name in self._panes]
            self._path = liquid_integrator(mi, faces, list(liquid.clear.values()), panes, depth)
        else:
            self._path = mi.load_dict({"type": "path", "max_depth": depth, "rr_depth": depth})

    def pose(self, frame: int) -> None:
        """Move every body to where it is at `frame`."""
        if frame == self._frame:
            return
        if self._fresh:
            self._load(frame)
        known: dict[str, F64] = {}
        for batch in self._wet:
            self._parameters[f"{batch.name}.{FILM}"] = batch.film(self._wetness, frame, known)
        if self._wet:
            self._parameters.update()
        if self._moving:
            placed = {batch.name: batch.placed(self.candidate, frame) for batch in self._moving}
            for name, (positions, _) in placed.items():
                self._parameters[f"{name}.vertex_positions"] = positions.ravel()
            self._parameters.update()
            # New positions alone make Mitsuba compute normals anew, and normals set to what they were count as not
            # set: hence after the positions, so that a picture does not depend on the frames before it.
            for name, (_, normals) in placed.items():
                self._parameters[f"{name}.vertex_normals"] = normals.ravel()
            self._parameters.update()
        self._frame = frame

    def _sensor(self, camera: Camera, samples: int) -> Any:
        mi = self.mi
        place = mi.ScalarTransform4f().look_at(
            origin=[float(v) for v in camera.position], target=[float(v) for v in camera.target], up=camera.axes[1].tolist()
        )
        return mi.load_dict(
            {
                "type": "perspective",
                "to_world": place,
                "fov": float(camera.fov_deg),
                "fov_axis": "y",
                "near_clip": 1e-3,
                "far_clip": 1e6,
                "sampler": {"type": "independent", "sample_count": samples},
                "film": {
                    "type": "hdrfilm",
                    "width": camera.width,
                    "height": camera.height,
                    "pixel_format": "rgb",
                    "component_format": "float32",
                    "rfilter": {"type": "box"},
                },
            }
        )

    def _render(self, integrator: Any, camera: Camera, samples: int, seed: int) -> F32:
        """Average of as many passes as the ray budget asks for."""
        most = max(1, RAYS_PER_PASS // (camera.width * camera.height))
        passes = -(-samples // most)
        shares = [samples // passes + (k < samples % passes) for k in range(passes)]
        total: Any = None
        for k, share in enumerate(shares):
            sensor = self._sensor(camera, share)
            image = self.mi.render(self.scene, sensor=sensor, integrator=integrator, spp=share, seed=seed + 7919 * k)
            weighted = np.array(image, dtype=np.float32) * (share / samples)
            total = weighted if total is None else total + weighted
        return np.asarray(total, dtype=np.float32)

    def radiance(self, camera: Camera, samples: int, *, seed: int = 0) -> F32:
        """Path-traced radiance, shape (height, width, 3), box-filtered as the denoiser needs it."""
        return self._render(self._path, camera, samples, seed)

    def features(self, camera: Camera) -> Features:
        """First-hit albedo and shading normals."""
        channels = self._first_hit(self._aov, camera)
        return Features(np.ascontiguousarray(channels[..., -6:-3]), np.ascontiguousarray(channels[..., -3:]))

    def depth(self, camera: Camera) -> F32:
        """Distance of the first hit [m], 0 where there is none; shape (height, width)."""
        return np.ascontiguousarray(self._first_hit(self._depth, camera)[..., -1])

    def _first_hit(self, integrator: Any, camera: Camera) -> F32:
        """Channels of the first hit.

        Mitsuba 3.9's `aov` integrator allocates per sample in the scalar variant, and threads fight over the heap:
        one sample on one thread is the fastest there (measured: 0.65 s against 2.2 s at 640x360).
        """
        if not self._scalar:
            return self._render(integrator, camera, 4, 17)
        import drjit

        threads = drjit.thread_count()
        drjit.set_thread_count(1)
        try:
            return self._render(integrator, camera, 1, 17)
        finally:
            drjit.set_thread_count(threads)
