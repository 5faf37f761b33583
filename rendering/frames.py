"""Rendered frames: single pictures and resumable sequences."""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Callable, Mapping, Sequence
from functools import cached_property
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

from ..geometry.camera import Camera
from ..worlds.arrays import U8
from ..worlds.candidate import Candidate
from ..worlds.canonical import digest_of, source_digest
from ..worlds.errors import EngineError, InputError
from ..worlds.plates import SEEDS, Plate, View
from ..worlds.spec import Shot
from .land.haze import hazed
from .tracer.denoise import denoise, meter, tonemap
from .tracer.scene import SceneRenderer
from .tracer.variant import choose_variant
from .views import camera_for, shot_of

__all__ = ["FrameRenderer", "exposures", "frame_path", "frame_recipe", "render_frame", "render_sequence", "renderer_versions"]

METER_WIDTH = 160
METER_SAMPLES = 8
SAME_LIGHT = 2.0
"""[stops] Own choice: meters of two shots that differ by less see the same light; a lit room is 5 to 8 stops darker than the day outside."""
NIGHT_STOPS = -1.5
"""Own choice: a night is exposed this much darker than the meter has it, so that it is seen to be one."""
SEED = 1
"""One seed for all frames: what noise is left stands still instead of boiling."""


def frame_path(folder: Path, frame: int) -> Path:
    """File of a frame of a rendered sequence."""
    return folder / f"frame_{frame:06d}.png"


def _check_frame(candidate: Candidate, frame: int) -> None:
    if not 0 <= frame <= candidate.last_frame:
        raise InputError(f"frame {frame} is not in 0..{candidate.last_frame}; choose one of these or bake further")


def exposures(metered: Mapping[str, float]) -> dict[str, float]:
    """One exposure for the shots of the same light: what the meter asks of each differs by what stands before it, not by the light.

    Shots whose meters lie within `SAME_LIGHT` of one another, sorted, share the geometric mean; a room and the land before it do not.
    """
    found: dict[str, float] = {}
    group: list[str] = []
    for name in sorted(metered, key=lambda n: metered[n]):
        if group and math.log2(metered[name] / metered[group[-1]]) > SAME_LIGHT:
            found |= _shared(metered, group)
            group = []
        group.append(name)
    return found | _shared(metered, group)


def _shared(metered: Mapping[str, float], group: Sequence[str]) -> dict[str, float]:
    if len(group) == 1:
        return {group[0]: metered[group[0]]}
    mean = math.exp(sum(math.log(metered[name]) for name in group) / max(len(group), 1))
    return dict.fromkeys(group, mean)


class FrameRenderer:
    """Renders frames of one candidate; keeps the scene and the exposure of its shots between frames."""

    def __init__(self, candidate: Candidate, *, camera: Camera | None = None) -> None:
        self.candidate = candidate
        self._scene = SceneRenderer(candidate, eyes=() if camera is None else (camera.position,))
        self._unshot: float | None = None
        self._bare: dict[Any, list[U8]] = {}

    def _gain(self, shot: str | None, frame: int, camera: Camera | None) -> float:
        """Exposure of a shot, or of another camera: one for all that stand in the same light, see `exposures`.

        Each is metered once, a shot at its first frame, so that it does not pump.
        """
        if camera is not None:
            height = max(1, round(METER_WIDTH * camera.height / camera.width))
            own = self._metered(Camera(camera.position, camera.target, camera.fov_deg, METER_WIDTH, height), frame)
            near = [g for g in self._shot_gains.values() if abs(math.log2(g / own)) <= SAME_LIGHT]
            return min(near, key=lambda g: abs(math.log2(g / own)), default=own)
        if shot is not None:
            return self._shot_gains[shot]
        if self._unshot is None:
            self._unshot = self._metered(self._small_view(None, 0), 0)
        return self._unshot

    @cached_property
    def _shot_gains(self) -> dict[str, float]:
        """Exposure by shot."""
        last = self.candidate.last_frame
        first = {name: min(shot.frames[0], last) for name, shot in self.candidate.spec.shots.items()}
        return exposures({name: self._metered(self._small_view(name, frame), frame) for name, frame in first.items()})

    def _small_view(self, shot: str | None, frame: int) -> Camera:
        look = self.candidate.spec.look
        height = round(METER_WIDTH * look.height / look.width)
        return camera_for(self.candidate, frame, shot=shot, width=METER_WIDTH, height=height)

    def _metered(self, view: Camera, frame: int) -> float:
        """Factor on the radiance that the meter asks for, with the stops of the look."""
        look = self.candidate.spec.look
        self._scene.pose(frame)
        radiance = self._scene.radiance(view, METER_SAMPLES, seed=SEED)
        features = self._scene.features(view)
        # Denoised first: the mean logarithm of noisy pixels is too low.
        stops = look.exposure + (NIGHT_STOPS if look.sky == "night" else 0.0)
        return meter(denoise(radiance, features), features.normals, self._scene.panes(view)) * math.pow(2.0, stops)

    def render(
        self,
        frame: int,
        *,
        shot: str | None = None,
        camera: Camera | None = None,
        width: int | None = None,
        height: int | None = None,
        samples: int | None = None,
        denoise: bool = True,
    ) -> U8:
        """One picture, shape (height, width, 3); see `render_frame`."""
        _check_frame(self.candidate, frame)
        look = self.candidate.spec.look
        width, height, samples = width or look.width, height or look.height, samples or look.samples
        if camera is None:
            shot = shot if shot is not None else shot_of(self.candidate.spec, frame)
            view = camera_for(self.candidate, frame, shot=shot, width=width, height=height)
        else:
            view = camera
        gain = self._gain(shot, frame, camera)
        self._scene.pose(frame)
        radiance = self._scene.radiance(view, samples, seed=SEED)
        if denoise:
            radiance = _denoised(radiance, self._scene, view)
        return self._developed(view, radiance, gain, SEED)

    def _developed(self, view: Camera, radiance: Any, gain: float, seed: int) -> U8:
        if self._scene.outdoors:
            radiance = hazed(self._scene, view, radiance, seed=seed)
        return tonemap(radiance, gain=gain)

    def plate(self, view: View, *, size: tuple[int, int], samples: int) -> Plate:
        """The pictures of a view with and without its subject, exposed and denoised like the film's, each from two seeds.

        Raises:
            InputError: there is no such frame or shot, or the subject is drawn with its landscape.
        """
        _check_frame(self.candidate, view.frame)
        if not self._scene.draws(view.subject):
            raise InputError(f"{view.subject!r} is drawn with its landscape and can't be left out of a picture")
        camera = camera_for(self.candidate, view.frame, shot=view.shot, width=size[0], height=size[1])
        gain = self._gain(view.shot, view.frame, None)
        self._scene.pose(view.frame)
        shown = self._of_each_seed(camera, samples, gain)
        self._scene.pose(view.frame, view.subject)
        # Where the subject alone moves, one bare picture serves all frames of a camera that stands still.
        place, eye = self._scene.standing(), np.concatenate([camera.position, camera.target])
        key = (place, view.subject, size, samples, gain, eye.tobytes(), camera.fov_deg, camera.roll)
        bare = self._bare.get(key) if place is not None else None
        if bare is None:
            bare = self._bare[key] = self._of_each_seed(camera, samples, gain)
        self._scene.pose(view.frame)
        return Plate(np.stack(shown), np.stack(bare))

    def _of_each_seed(self, camera: Camera, samples: int, gain: float) -> list[U8]:
        """Pictures of the scene as it is posed, one per seed."""
        features, pictures = self._scene.features(camera), list[U8]()
        for seed in range(SEED, SEED + SEEDS):
            radiance = denoise(self._scene.radiance(camera, samples, seed=seed), features)
            pictures.append(self._developed(camera, radiance, gain, seed))
        return pictures


def renderer_versions() -> dict[str, str]:
    """Versions of everything that decides a picture of the same scene."""
    return {
        "source": source_digest(Path(__file__).parent),
        "variant": choose_variant().name,
        **{name: version(name) for name in ("mitsuba", "pyoidn")},
    }


def _denoised(radiance: Any, scene: SceneRenderer, view: Camera) -> Any:
    return denoise(radiance, scene.features(view))


def render_frame(
    candidate: Candidate,
    frame: int,
    *,
    shot: str | None = None,
    camera: Camera | None = None,
    width: int | None = None,
    height: int | None = None,
    samples: int | None = None,
    denoise: bool = True,
) -> U8:
    """Render one frame as an 8-bit sRGB picture, shape (height, width, 3).

    Args:
        candidate: what to render.
        frame: frame index.
        shot: id of the shot whose camera to use; default the one that covers the frame, else an automatic view.
        camera: use this camera instead (its own width and height count).
        width: pixels; default the specification's.
        height: pixels; default the specification's.
        samples: paths per pixel; default the specification's.
        denoise: run Open Image Denoise.

    Raises:
        InputError: the frame or the shot does not exist, or nothing is built.
    """
    return FrameRenderer(candidate, camera=camera).render(
        frame, shot=shot, camera=camera, width=width, height=height, samples=samples, denoise=denoise
    )


def frame_recipe(candidate: Candidate, frame: int, *, width: int, height: int, samples: int, denoise: bool = True) -> str:
    """Hash of all that a sequence's frame is derived from."""
    spec = candidate.spec
    name = shot_of(spec, frame)
    variant = choose_variant()
    return digest_of(
        {
            "frame": frame,
            "picture": [width, height, samples, denoise],
            "shot": None if name is None else _seen_of(spec.shots[name]),
            "shots": {k: _seen_of(s) for k, s in spec.shots.items()},
            "look": spec.look.model_dump(mode="json"),
            "appearance": {k: m.appearance.model_dump(mode="json") for k, m in spec.materials.items()},
            "poses": {k: [e.pose.model_dump(mode="json"), e.active, e.motion] for k, e in spec.entities.items()},
            "built": {k: b.recipe for k, b in candidate.built.items()},
            "digest": candidate.digest,
            "stage": candidate.stage,
        },
        variant.name,
        source_digest(Path(__file__).parent),
    )


def _seen_of(shot: Shot) -> dict[str, Any]:
    """Fields that decide a shot's pictures: of the others, since all shots of one light share their exposure."""
    found: dict[str, Any] = shot.model_dump(mode="json", exclude={"covers", "subjects", "intent"})
    return found


def _done(path: Path, recipe: str) -> bool:
    """True if a finished frame with this recipe is there, undamaged."""
    try:
        note = json.loads(path.with_suffix(".json").read_text())
        return bool(note["recipe"] == recipe and note["sha256"] == hashlib.sha256(path.read_bytes()).hexdigest())
    except (OSError, ValueError, KeyError, TypeError):
        return False


def _write(path: Path, image: U8, note: dict[str, Any]) -> None:
    import cv2

    good, data = cv2.imencode(".png", image[..., ::-1])
    if not good:
        raise EngineError(f"OpenCV could not encode {path.name}; check the picture size {image.shape}")
    raw = data.tobytes()
    for target, content in (
        (path, raw),
        (path.with_suffix(".json"), json.dumps(note | {"sha256": hashlib.sha256(raw).hexdigest()}, indent=1).encode()),
    ):
        temporary = target.with_suffix(target.suffix + ".tmp")
        temporary.write_bytes(content)
        temporary.replace(target)


def render_sequence(
    candidate: Candidate,
    out_dir: Path,
    *,
    frames: Sequence[int] | None = None,
    width: int | None = None,
    height: int | None = None,
    samples: int | None = None,
    denoise: bool = True,
    progress: Callable[[int, int, str], None] | None = None,
    cancelled: Callable[[], bool] | None = None,
) -> list[Path]:
    """Render frames to `out_dir/frame_000000.png`, ...; frames that are there with the same recipe are kept.

    Args:
        candidate: what to render.
        out_dir: folder of the pictures and of one JSON note per picture with its recipe.
        frames: frame indices; default all that the candidate has.
        width: pixels; default the specification's.
        height: pixels; default the specification's.
        samples: paths per pixel; default the specification's.
        denoise: run Open Image Denoise.
        progress: told (frames done, frames in all, what happens).
        cancelled: asked before every frame; when it says yes, the frames so far are returned.

    Returns:
        The files that are complete, in the order of `frames`.
    """
    look = candidate.spec.look
    width, height, samples = width or look.width, height or look.height, samples or look.samples
    wanted = list(range(candidate.frame_count)) if frames is None else list(frames)
    for frame in wanted:
        _check_frame(candidate, frame)
    out_dir.mkdir(parents=True, exist_ok=True)
    finished: list[Path] = []
    renderer: FrameRenderer | None = None
    for count, frame in enumerate(wanted):
        if cancelled is not None and cancelled():
            break
        path = frame_path(out_dir, frame)
        recipe = frame_recipe(candidate, frame, width=width, height=height, samples=samples, denoise=denoise)
        if not _done(path, recipe):
            if progress is not None:
                progress(count, len(wanted), f"rendering frame {frame}" if renderer is not None else "loading the scene")
            renderer = renderer or FrameRenderer(candidate)
            image = renderer.render(frame, width=width, height=height, samples=samples, denoise=denoise)
            note = {"recipe": recipe, "frame": frame, "variant": choose_variant().name, "samples": samples}
            _write(path, image, note)
        finished.append(path)
        if progress is not None:
            progress(count + 1, len(wanted), f"frame {frame} done")
    return finished
