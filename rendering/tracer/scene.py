"""A candidate as a Mitsuba scene that is loaded once and then only moved from frame to frame."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...geometry.camera import Camera
from ...worlds.arrays import F32, F64
from ...worlds.candidate import Candidate
from ..categories.charring import Charring
from ..categories.layer import GLOWS, Fog, VolumeLayer
from ..categories.liquid.wet_look import Wetness
from ..categories.registry import layers_of
from ..land.scenery import scenery_shapes
from .batches import batches_of
from .clear_path import clear_path
from .lights import lamp_shape, light_dicts
from .materials import BURNT, FILM, PANE, bsdf_of, toned
from .meshes import mesh_of
from .textures import pattern_tiles
from .variant import load_mitsuba

__all__ = ["Features", "SceneRenderer"]

PATH_DEPTH, ROULETTE = 24, 5
"""Longest light path in segments, so that white rooms keep their light (0.8^24 is 0.5 %), and from where on paths of little weight are
ended; glass needs `GLASS_DEPTH`."""
GLASS_DEPTH = 32
FOG_DEPTH, FOG_ROULETTE = 32, 12
"""The same where there is gas, of which each scattering is a segment, and from where on paths of little weight are ended."""
RAYS_PER_PASS = 4_000_000
"""Camera rays per launch; bounds the memory of the vectorised variants."""


class Features(NamedTuple):
    """Guides of the denoiser, and where the picture shows matter. Each (height, width, 3)."""

    albedo: F32
    normals: F32


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
        layers = layers_of(candidate)
        layers.refuse_undrawn()
        bodies = [part for *_, part in layers.parts]
        materials, open_materials = {p.material for p in bodies}, {p.material for p in bodies if not p.closed}
        looks = {name: candidate.spec.materials[name].appearance for name in sorted(materials)}
        tiles = {name: pattern_tiles(look.pattern, look.color, seed=k) for k, (name, look) in enumerate(looks.items())}
        self._wetness, known = Wetness(candidate), dict[str, F64]()
        batches = batches_of(candidate, layers, tiles, self._wetness, Charring(candidate))
        self._moving = [batch for kind, batch in batches.items() if kind.moving]
        self._still = [batch for kind, batch in batches.items() if not kind.moving]
        self._wet = [batch for kind, batch in batches.items() if kind.wets]
        self._burning = [batch for kind, batch in batches.items() if kind.burns]
        panes = {
            batch.name: kind.moving
            for kind, batch in batches.items()
            if looks[kind.material].transmission >= PANE and not kind.lamp
        }
        self._panes, self._windows = list(panes), not all(panes.values())
        scene: dict[str, Any] = {"type": "scene", **(light_dicts(mi, candidate) if lights is None else lights)}
        bsdfs: dict[tuple[str, str, bool, float, bool], Any] = {}
        for kind, batch in batches.items():
            if kind.lamp:
                scene[batch.name] = lamp_shape(
                    mi, candidate.spec.look.lamps[kind.lamp], batch.name, batch.surface, batch.placed(candidate, frame)
                )
                continue
            key = (kind.material, kind.layer, kind.wets, kind.tone, kind.burns)
            if key not in bsdfs:
                look, tile = toned(looks[kind.material], tiles[kind.material].get(kind.layer), kind.tone)
                bsdfs[key] = bsdf_of(
                    mi, look, tile, open_surface=kind.material in open_materials, wets=kind.wets, burns=kind.burns
                )
            positions, normals = batch.placed(candidate, frame)
            film = {FILM: batch.film(self._wetness, frame, known)} if kind.wets else None
            film = {BURNT: batch.char(frame)} if kind.burns else film
            surface = batch.surface
            corners = (positions, surface.faces)
            scene[batch.name] = mesh_of(mi, batch.name, corners, bsdfs[key], normals=normals, uv=surface.uv, attributes=film)
        scenery = scenery_shapes(mi, candidate, eyes)
        self.outdoors = bool(scenery)
        scene |= scenery
        self._loose = layers.loose
        self._volumes = [layer for layer in self._loose if isinstance(layer, VolumeLayer)]
        if self._loose or self._windows:
            # Shapes of loose matter are new in every frame; all the rest stays loaded, and panes are known by themselves.
            scene = {k: mi.load_dict(v) if isinstance(v, dict) else v for k, v in scene.items()}
        self._fixed = scene
        self._frame = frame
        self._without: str | None = None
        self._posed: dict[str, bytes] = {}
        self._glassy = any(look.transmission > 0 for look in looks.values())
        self._load(frame)
        self._aov = mi.load_dict({"type": "aov", "aovs": "albedo:albedo,normal:sh_normal"})
        self._depth = mi.load_dict({"type": "aov", "aovs": "depth:depth"})

    def _load(self, frame: int, without: str | None = None) -> None:
        """Load the scene with the loose matter of a frame but of the entity left out, and the tracer that knows it."""
        mi = self.mi
        made = [(layer, layer.traced(mi, frame)) for layer in self._loose]
        # A shape of loose matter is named after its kind and its entity.
        away = {name for _, one in made for name in (*one.shapes, *one.clear, *one.fogs) if name.partition("-")[2] == without}
        shapes = {name: shape for _, one in made for name, shape in one.shapes.items() if name not in away}
        clear = {name: absorbed for _, one in made for name, absorbed in one.clear.items() if name not in away}
        self._fogs: dict[str, Fog] = {name: fog for _, one in made for name, fog in one.fogs.items() if name not in away}
        self._firm = {**self._fixed, **{name: shape for name, shape in shapes.items() if name not in self._fogs}}
        self._bare: Any = None
        self.scene = mi.load_dict({**self._fixed, **shapes})
        self._parameters = mi.traverse(self.scene)
        depth = GLASS_DEPTH if self._glassy or clear else PATH_DEPTH
        behind_panes = self._panes and any(one.shapes.keys() - one.fogs for layer, one in made if not layer.opaque)
        if self._fogs:
            self._path = mi.load_dict({"type": "volpath", "max_depth": FOG_DEPTH, "rr_depth": FOG_ROULETTE})
        elif not self._scalar and (clear or behind_panes or self._windows):
            faces, panes = [shapes[name] for name in clear], [self._fixed[name] for name in self._panes]
            self._path = clear_path(mi, faces, list(clear.values()), panes, depth)
        else:
            self._path = mi.load_dict({"type": "path", "max_depth": depth, "rr_depth": ROULETTE})

    def pose(self, frame: int, without: str | None = None) -> None:
        """Move every body to where it is at `frame`, and leave one entity out."""
        if (frame, without) == (self._frame, self._without):
            return
        if self._loose:
            self._load(frame, without)
        known: dict[str, F64] = {}
        for batch in self._wet:
            self._parameters[f"{batch.name}.{FILM}"] = batch.film(self._wetness, frame, known)
        for batch in self._burning:
            self._parameters[f"{batch.name}.{BURNT}"] = batch.char(frame)
        if self._wet or self._burning:
            self._parameters.update()
        changed = {self._without, without} if without != self._without else set()
        moved = [*self._moving, *(b for b in self._still if b.entities & changed)]
        if moved:
            placed = {batch.name: batch.placed(self.candidate, frame, without) for batch in moved}
            for name, (positions, _) in placed.items():
                self._parameters[f"{name}.vertex_positions"] = positions.ravel()
            self._parameters.update()
            # New positions alone make Mitsuba compute normals anew, and normals set to what they were count as not
            # set: hence after the positions, so that a picture does not depend on the frames before it.
            for name, (_, normals) in placed.items():
                self._parameters[f"{name}.vertex_normals"] = normals.ravel()
            self._parameters.update()
            self._posed |= {batch.name: batch.place_digest(placed[batch.name][0], without) for batch in moved}
        self._frame, self._without = frame, without

    def standing(self) -> bytes | None:
        """Where all that may move is, but for what is left out, as bytes; None where more than places changes from frame to frame."""
        if self._loose or self._wet or self._burning:
            return None
        return repr(sorted(self._posed.items())).encode()

    def draws(self, entity: str) -> bool:
        """True if an entity is a shape of its own that can be left out; the ground of a landscape is drawn with its land."""
        return any(entity in b.entities for b in (*self._moving, *self._still)) or any(entity in x.entities for x in self._loose)

    def _sensor(self, camera: Camera, samples: int) -> Any:
        mi = self.mi
        place = mi.ScalarTransform4f().look_at(
            origin=[float(v) for v in camera.position], target=[float(v) for v in camera.target], up=camera.axes[1].tolist()
        )
        eye = np.asarray(camera.position)
        around = [fog.medium for fog in self._fogs.values() if (eye > fog.low).all() and (eye < fog.high).all()]
        return mi.load_dict(
            {
                "type": "perspective",
                **({"medium": around[0]} if around else {}),
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

    def _render(self, integrator: Any, camera: Camera, samples: int, seed: int, scene: Any = None) -> F32:
        """Average of as many passes as the ray budget asks for."""
        scene = self.scene if scene is None else scene
        most = max(1, RAYS_PER_PASS // (camera.width * camera.height))
        passes = -(-samples // most)
        shares = [samples // passes + (k < samples % passes) for k in range(passes)]
        total: Any = None
        for k, share in enumerate(shares):
            sensor = self._sensor(camera, share)
            image = self.mi.render(scene, sensor=sensor, integrator=integrator, spp=share, seed=seed + 7919 * k)
            weighted = np.array(image, dtype=np.float32) * (share / samples)
            total = weighted if total is None else total + weighted
        return np.asarray(total, dtype=np.float32)

    def radiance(self, camera: Camera, samples: int, *, seed: int = 0) -> F32:
        """Path-traced radiance, shape (height, width, 3), box-filtered as the denoiser needs it."""
        found = self._render(self._path, camera, samples, seed)
        # Mitsuba's media do not glow: their own light is added along the sight, and falls on all else from `GLOWS`.
        if any(name.startswith(GLOWS) for name in self._firm):
            spans = self._spans(camera)
            for layer in self._volumes:
                for entity in (e for e in layer.entities if e != self._without):
                    found = found + layer.glowing(self._frame, camera, spans, entity).astype(np.float32)
        return found

    def _spans(self, camera: Camera) -> F64:
        """Depths from the eye to the first hit along the viewing axis [m], shape (height, width, 2)."""
        along = -(camera.rays()[1] @ camera.axes[2])
        depth = self.depth(camera)
        return np.stack([np.zeros_like(along), np.where(depth > 0, depth, np.inf) * along], axis=-1)

    def features(self, camera: Camera) -> Features:
        """First-hit albedo and shading normals; gas before them has an albedo and no normal."""
        channels = self._first_hit(self._aov, camera)
        albedo, normals = channels[..., -6:-3], channels[..., -3:]
        if self._fogs:
            spans = self._spans(camera)
            for layer in self._volumes:
                for entity, color in zip(layer.entities, layer.colors.astype(np.float32), strict=True):
                    if entity != self._without:
                        left = np.exp(-layer.depths(self._frame, camera, spans, entity)).astype(np.float32)[..., None]
                        albedo, normals = albedo * left + color * (1 - left), normals * left
        return Features(np.ascontiguousarray(albedo), np.ascontiguousarray(normals))

    def depth(self, camera: Camera) -> F32:
        """Distance of the first hit [m], 0 where there is none; shape (height, width)."""
        return np.ascontiguousarray(self._first_hit(self._depth, camera)[..., -1])

    def panes(self, camera: Camera) -> NDArray[np.bool_] | None:
        """Where a pane is the first hit, shape (height, width); None in a world without panes."""
        if not self._panes:
            return None
        mi, scene = self.mi, self._matter()
        origin, ways = camera.rays()
        across = ways.reshape(-1, 3)
        if self._scalar:
            hits = (scene.ray_intersect(mi.Ray3f(mi.Point3f(*origin), mi.Vector3f(*way))) for way in across)
            found = np.array([hit.is_valid() and hit.shape.id() in self._panes for hit in hits])
        else:
            ray = mi.Ray3f(mi.Point3f(*map(float, origin)), mi.Vector3f(*across.T.astype(np.float32)))
            hit = scene.ray_intersect_preliminary(ray).shape
            own = [np.array(hit == mi.ShapePtr(shape)) for shape in scene.shapes() if shape.id() in self._panes]
            found = np.any(own, axis=0)
        return np.asarray(found.reshape(ways.shape[:2]))

    def _matter(self) -> Any:
        """The scene without the boxes of gas, whose faces are no matter.

        It shares its shapes with the whole one, so that it lives as long: lights that are shapes (hot liquids) hold on to the scene that was
        loaded last, and a picture after that one was gone ended the process.
        """
        if not self._fogs:
            return self.scene
        if self._bare is None:
            self._bare = self.mi.load_dict(self._firm)
        return self._bare

    def _first_hit(self, integrator: Any, camera: Camera) -> F32:
        """Channels of the first hit.

        Mitsuba 3.9's `aov` integrator allocates per sample in the scalar variant, and threads fight over the heap:
        one sample on one thread is the fastest there (measured: 0.65 s against 2.2 s at 640x360).
        """
        scene = self._matter()
        if not self._scalar:
            return self._render(integrator, camera, 4, 17, scene)
        import drjit

        threads = drjit.thread_count()
        drjit.set_thread_count(1)
        try:
            return self._render(integrator, camera, 1, 17, scene)
        finally:
            drjit.set_thread_count(threads)
