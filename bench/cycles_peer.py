"""A picture of ours beside Cycles' (Blender, GPL, a process of its own) of the same meshes, materials, lights and camera.

    python -P -m worldagent.bench.cycles_peer --flat 41 --room living --out pictures
    python -P -m worldagent.bench.cycles_peer --flat 41 --room kitchen --eye 1 2 1.5 --target 3 4 0.8 --out pictures
    python -P -m worldagent.bench.cycles_peer --recorded gas/kettle --frame 48 --out pictures    # bakes it first

Writes `ours.png` and `cycles.png`, both exposed by our meter and developed alike, and prints times and how far the two differ. What a body
looks like goes over as a principled material with its texture, the sky as a picture, sun and lamps by their power, gas as a volume that
takes, scatters and gives the same light. Liquids, land, wetness and the glow of solids are left out of Cycles' picture.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import shutil
import subprocess
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np

from ..geometry.camera import Camera
from ..rendering.categories.charring import Charring
from ..rendering.categories.liquid.wet_look import Wetness
from ..rendering.categories.registry import layers_of
from ..rendering.tracer.batches import batches_of
from ..rendering.tracer.lights import LUMINANCE, lamp_radiance, light_dicts
from ..rendering.tracer.materials import toned
from ..rendering.tracer.textures import pattern_tiles
from ..rendering.tracer.variant import load_mitsuba
from ..rendering.views import camera_for
from ..worlds.arrays import F32, F64
from ..worlds.candidate import Candidate
from .cycles_gas import export_gases
from .cycles_scene import SCRIPT
from .mantaflow import ENV_BLENDER

__all__ = ["cycles", "exported"]

SKY_ROWS = 512
"""Rows of the picture of the sky."""


def exported(candidate: Candidate, frame: int, camera: Camera, folder: Path) -> None:
    """Write meshes, textures, sky, lights and camera of one frame as files that Blender's script reads."""
    mi = load_mitsuba()
    spec, layers, wetness = candidate.spec, layers_of(candidate), Wetness(candidate)
    looks = {name: m.appearance for name, m in spec.materials.items()}
    tiles = {name: pattern_tiles(look.pattern, look.color, seed=k) for k, (name, look) in enumerate(sorted(looks.items()))}
    scene: dict[str, Any] = {"meshes": [], "panels": [], "suns": []}
    for number, (kind, batch) in enumerate(batches_of(candidate, layers, tiles, wetness, Charring(candidate)).items()):
        positions, normals = batch.placed(candidate, frame)
        look, tile = toned(looks[kind.material], tiles[kind.material].get(kind.layer), kind.tone)
        told: dict[str, Any] = {
            "color": look.color, "roughness": max(look.roughness, 0.03), "metallic": look.metallic, "transmission": look.transmission,
        }  # fmt: skip
        if kind.lamp:
            told["radiance"] = lamp_radiance(spec.look.lamps[kind.lamp], positions, batch.surface.faces).tolist()
        if tile is not None:
            told |= {"texture": f"tile{number}.exr", "sharp": tile.sharp}
            mi.Bitmap(np.ascontiguousarray(tile.image, dtype=np.float32)).write(str(folder / told["texture"]))
        faces = batch.surface.faces
        # Textures begin at the top left here and at the bottom left there.
        uv = batch.surface.uv[faces.ravel()] * [1.0, -1.0] + [0.0, 1.0]
        name = f"mesh{number}"
        arrays = {"positions": positions, "normals": normals, "faces": faces.astype(np.int32), "uv": uv.astype(np.float32)}
        for what, values in arrays.items():
            (folder / f"{name}.{what}").write_bytes(np.ascontiguousarray(values).tobytes())
        scene["meshes"].append({"name": name, **told})
    lights = light_dicts(mi, candidate)
    mi.Bitmap(_sky(mi, lights["sky"])).write(str(folder / "sky.exr"))
    for light in spec.look.lights.values():
        scene["panels"].append(
            {"position": light.position, "target": light.target, "size": light.size, "power": light.power, "color": light.color}
        )
    if "sun" in lights:
        scene["suns"].append(_sun_of(mi, lights["sun"], camera))
    scene["volumes"] = export_gases(candidate, frame, folder)
    if "ground" in lights:
        scene["ground"] = {
            "level": float(np.array(lights["ground"]["to_world"].matrix)[2, 3]),
            "color": _mean_color(lights["ground"]),
        }
    scene["camera"] = {
        "position": list(map(float, camera.position)), "axes": camera.axes.tolist(), "fov_deg": camera.fov_deg, "size": [camera.width, camera.height],
    }  # fmt: skip
    (folder / "scene.json").write_text(json.dumps(scene))


def _sky(mi: Any, emitter: dict[str, Any]) -> F32:
    """Radiance of a sky by direction, shape (rows, 2 rows, 3): row 0 is the zenith, column u looks to azimuth 180 deg - 360 deg u."""
    rows, columns = SKY_ROWS, 2 * SKY_ROWS
    scene = mi.load_dict({"type": "scene", "sky": emitter})
    elevation = 0.5 * np.pi - (np.arange(rows) + 0.5) * np.pi / rows
    azimuth = np.pi - 2.0 * np.pi * (np.arange(columns) + 0.5) / columns
    ways = np.stack(
        [
            np.cos(elevation)[:, None] * np.cos(azimuth),
            np.cos(elevation)[:, None] * np.sin(azimuth),
            np.broadcast_to(np.sin(elevation)[:, None], (rows, columns)),
        ],
        axis=-1,
    ).reshape(-1, 3)
    found: F32
    if mi.variant().startswith("scalar"):
        si = mi.SurfaceInteraction3f()
        values = []
        for way in ways:
            si.wi = mi.Vector3f(*(-way))
            values.append(np.array(scene.environment().eval(si)))
        found = np.array(values, dtype=np.float32)
    else:
        import drjit

        si = drjit.zeros(mi.SurfaceInteraction3f, len(ways))
        si.wi = mi.Vector3f(*(-ways.T.astype(np.float32)))
        found = np.array(scene.environment().eval(si), dtype=np.float32).T
    return np.ascontiguousarray(found.reshape(rows, columns, 3))


def _mean_color(ground: dict[str, Any]) -> list[float]:
    """Reflectance of the added ground, without its mottles."""
    look = ground["bsdf"]["reflectance"]
    if look["type"] == "rgb":
        return list(look["value"])
    found: list[float] = np.array(look["bitmap"]).mean(axis=(0, 1)).tolist()
    return found


def _sun_of(mi: Any, disk: dict[str, Any], camera: Camera) -> dict[str, Any]:
    """Direction, apparent size and irradiance of a far disk [W/m^2]."""
    place = np.array(disk["to_world"].matrix)
    away = place[:3, 3] - np.asarray(camera.target)
    distance, radius = float(np.linalg.norm(away)), float(np.linalg.norm(place[:3, 0]))
    half = math.atan2(radius, distance)
    radiance = np.array(disk["emitter"]["radiance"]["value"])
    return {
        "towards": (away / distance).tolist(),
        "angle": 2.0 * half,
        "irradiance": (radiance * math.pi * math.sin(half) ** 2).tolist(),
    }


def cycles(folder: Path, samples: int) -> tuple[F32, float]:
    """Radiance of Cycles' picture of what `exported` wrote, shape (height, width, 3), and the seconds it took.

    Raises:
        FileNotFoundError: blender is not installed.
        RuntimeError: it made no picture.
    """
    blender = os.environ.get(ENV_BLENDER) or shutil.which("blender")
    if blender is None:
        raise FileNotFoundError(f"blender is not installed; ${ENV_BLENDER} may name it (Debian package blender 3.4.1)")
    script = folder / "cycles_scene.py"
    script.write_text(SCRIPT, encoding="utf-8")
    began = time.perf_counter()
    ended = subprocess.run(
        [blender, "-b", "-P", str(script), "--", str(folder), str(samples)], capture_output=True, text=True, check=False
    )
    took = time.perf_counter() - began
    made = folder / "cycles.exr"
    if not made.is_file():
        raise RuntimeError(f"blender made no picture: {(ended.stderr or ended.stdout)[-1500:]}")
    return np.array(load_mitsuba().Bitmap(str(made)), dtype=np.float32)[..., :3], took


def compare(candidate: Candidate, frame: int, camera: Camera, out: Path, samples: int) -> dict[str, Any]:
    """Render both pictures into a folder; seconds, and the difference of their logarithms after blurring (a stop is 1.0)."""
    import cv2

    from ..rendering.tracer.denoise import denoise, meter, tonemap
    from ..rendering.tracer.scene import SceneRenderer

    out.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        exported(candidate, frame, camera, Path(folder))
        theirs, took = cycles(Path(folder), samples)
    began = time.perf_counter()
    scene = SceneRenderer(candidate, frame=frame)
    ours = scene.radiance(camera, samples)
    spent = time.perf_counter() - began
    features = scene.features(camera)
    pictures = {"ours": denoise(ours, features), "cycles": denoise(theirs, features)}
    gain = meter(pictures["ours"], features.normals, scene.panes(camera))
    for name, radiance in pictures.items():
        cv2.imwrite(str(out / f"{name}.png"), tonemap(radiance, gain=gain)[..., ::-1])
    light = [np.log2(np.maximum(cv2.GaussianBlur(p @ LUMINANCE.astype(np.float32), (0, 0), 4), 1e-6)) for p in pictures.values()]
    apart = light[0] - light[1]
    return {
        "ours_s": round(spent, 1), "cycles_s": round(took, 1), "samples": samples, "size": [camera.width, camera.height],
        "median_stops_brighter": round(float(np.median(apart)), 3), "median_stops_apart": round(float(np.median(np.abs(apart))), 3),
        "share_within_half_a_stop": round(float((np.abs(apart) < 0.5).mean()), 3),
    }  # fmt: skip


def _room_camera(candidate: Candidate, room: str, size: tuple[int, int]) -> Camera:
    """The look across a room of a flat from 1.55 m over its floor, of those from its corners the one with the least in the way."""
    from ..rendering.tracer.scene import SceneRenderer

    scene, (low, high) = SceneRenderer(candidate), _room_box(candidate, room)
    looks = []
    for corner in ((0, 0), (0, 1), (1, 0), (1, 1)):
        eye, target = (
            np.array([*(low[a] + s * (high[a] - low[a]) for a, s in enumerate(c)), low[2]]) for c in (corner, (0.5, 0.5))
        )
        inward = (target - eye) / np.linalg.norm(target - eye)
        looks.append(Camera(eye + 0.7 * inward + [0, 0, 1.55], target + inward + [0, 0, 0.7], 62.0, *size))
    small = [Camera(c.position, c.target, c.fov_deg, 64, 36) for c in looks]
    free = [float(np.percentile(np.where((d := scene.depth(c)) > 0, d, 1e3), 10)) for c in small]
    return looks[int(np.argmax(free))]


def _room_box(candidate: Candidate, room: str) -> tuple[F64, F64]:
    """Bounds of what stands in a room of a flat [m]."""
    names = [n for n in candidate.built if f"_{room}_" in n]
    points = np.concatenate([candidate.vertices(n, 0) for n in names])
    return points.min(axis=0), points.max(axis=0)


def _flat(number: int, *, ceiling: bool) -> Candidate:
    """A flat of the list of `bench interiors`, built in a folder that stays until the process ends."""
    from ..construction import build_world
    from ..construction.interiors.build import build_interior
    from ..workflow.creation import create
    from ..workflow.interiors import interior_operations
    from ..worlds.patch import apply_patch
    from .interiors import GAP, NAME, flat_of

    root = Path(tempfile.mkdtemp(prefix="cycles-peer-"))
    session, _ = create(root, NAME, "A furnished flat.", {"simulation": {"frames": 2}})
    asked = flat_of(number).model_copy(update={"ceiling": ceiling})
    operations = interior_operations(session.spec, NAME, asked, build_interior(NAME, asked, gap=GAP))
    session.commit(apply_patch(session.spec, operations), patch=operations)
    return Candidate(session.folder.root, session.spec, build_world(session.folder, session.spec)[0], "static")


def _recorded(name: str, frame: int, root: Path) -> Candidate:
    """A world that a skill records, simulated up to a frame in a folder; a run that is there already is taken."""
    from ..construction import build_world
    from ..simulation.schedule import run_frames
    from ..testing.defects.accepted import recorded
    from ..worlds.folder import WorldFolder

    worlds = dict(recorded())
    if name not in worlds:
        raise SystemExit(f"no recorded world {name!r}; there are {', '.join(sorted(worlds))}")
    root.mkdir(parents=True, exist_ok=True)
    built, _ = build_world(WorldFolder(root), worlds[name])
    caches = run_frames(worlds[name], built, root / "run", frames=frame + 1)
    return Candidate(root, worlds[name], built, "probe", caches)


def _chosen(given: argparse.Namespace) -> tuple[Candidate, Camera]:
    """The candidate that was asked for, and the camera."""
    size = tuple(given.size)
    if given.recorded:
        root = given.folder or Path(tempfile.mkdtemp(prefix="cycles-peer-"))
        candidate = _recorded(given.recorded, given.frame, root)
        camera = camera_for(candidate, given.frame, shot=given.shot, width=size[0], height=size[1])
    else:
        candidate = _flat(given.flat, ceiling=given.ceiling)
        camera = _room_camera(candidate, given.room, size)
    if given.eye:
        camera = Camera(np.array(given.eye), np.array(given.target), camera.fov_deg, *size)
    return candidate, camera


def main(argv: list[str] | None = None) -> None:
    """Render one picture with both and print the figures as JSON."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--flat", type=int, default=41, help="number of the flat")
    parser.add_argument("--room", default="living", help="its room")
    parser.add_argument("--ceiling", action="store_true", help="with a ceiling: windows and lamps light the room")
    parser.add_argument("--recorded", help="a world that a skill records, in place of a flat, as gas/kettle")
    parser.add_argument("--frame", type=int, default=0, help="of that world")
    parser.add_argument("--shot", help="of that world; default: the one that covers the frame")
    parser.add_argument("--folder", type=Path, help="where that world is simulated; default: a new one")
    parser.add_argument("--eye", type=float, nargs=3, help="place of the camera [m]; default: a corner of the room")
    parser.add_argument("--target", type=float, nargs=3, help="what it looks at [m]")
    parser.add_argument("--size", type=int, nargs=2, default=(960, 540), help="pixels")
    parser.add_argument("--samples", type=int, default=64, help="of a pixel")
    parser.add_argument("--out", type=Path, required=True, help="folder for the pictures")
    given = parser.parse_args(argv)
    candidate, camera = _chosen(given)
    print(json.dumps(compare(candidate, given.frame, camera, given.out, given.samples)))


if __name__ == "__main__":
    main()
