"""Benchmark `render`: time of a 1080p frame, and how close a denoised 16-sample picture is to a converged one."""

from __future__ import annotations

import json
import math
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np

from ..construction import build_entity
from ..worlds.arrays import euler_to_quaternion, quaternion_product
from ..worlds.cache import Cache, CacheIndex, write_container
from ..worlds.candidate import Candidate
from ..worlds.spec import WorldSpec

__all__ = ["run", "workbench"]

FPS = 24
DOMINOES = 24
DOMINO = (0.012, 0.036, 0.07)
"""Thickness, width, height [m]."""
PITCH = 0.034
TOP = 0.80
"""Height of the bench's top [m]."""
RAMP = (0.42, 0.10, 0.16)
BALL_RADIUS = 0.024


def _material(density: float, substance: str, **look: Any) -> dict[str, Any]:
    return {"density": density, "substance": substance, "appearance": look}


def _entity(
    role: str, motion: str, material: str, size: tuple[float, ...], position: tuple[float, ...], parts: Any
) -> dict[str, Any]:
    return {
        "role": role,
        "motion": motion,
        "material": material,
        "dimensions": {"size": size, "tolerance": 0.1},
        "pose": {"position": position},
        "parts": parts,
    }


def _bowl() -> dict[str, Any]:
    outer = [(0.035, 0.0), (0.06, 0.006), (0.092, 0.03), (0.108, 0.07), (0.112, 0.075)]
    inner = [(0.106, 0.073), (0.086, 0.035), (0.056, 0.014), (0.0, 0.01)]
    return {"kind": "revolution", "profile": [(0.0, 0.0), *outer, *inner], "segments": 96}


def _specification(sky: str, frames: int) -> WorldSpec:
    legs = {
        f"leg{k}": {"shape": {"kind": "box", "size": (0.06, 0.06, TOP - 0.04)}, "pose": {"position": (x, y, (TOP - 0.04) / 2)}}
        for k, (x, y) in enumerate(((-0.82, -0.29), (0.82, -0.29), (-0.82, 0.29), (0.82, 0.29)))
    }
    top = {"top": {"shape": {"kind": "box", "size": (1.8, 0.7, 0.04)}, "pose": {"position": (0, 0, TOP - 0.02)}}}
    entities: dict[str, Any] = {
        "bench": _entity("workbench", "static", "oak", (1.8, 0.7, TOP), (0, 0, 0), top | legs),
        "ramp": _entity(
            "ramp the ball rolls down",
            "static",
            "pine",
            RAMP,
            (-0.60, 0, TOP + RAMP[2] / 2),
            {"body": {"shape": {"kind": "wedge", "size": RAMP}}},
        ),
        "ball": _entity(
            "steel ball",
            "dynamic",
            "steel",
            (2 * BALL_RADIUS,) * 3,
            (-0.76, 0, 1),
            {"body": {"shape": {"kind": "sphere", "radius": BALL_RADIUS}}},
        ),
        "bowl": _entity("bowl", "static", "ceramic", (0.224, 0.224, 0.075), (0.74, -0.02, TOP), {"body": {"shape": _bowl()}}),
        "crate": _entity(
            "toy crate",
            "static",
            "red",
            (0.1, 0.1, 0.1),
            (-0.15, 0.24, TOP + 0.05),
            {"body": {"shape": {"kind": "box", "size": (0.1, 0.1, 0.1)}}},
        ),
        "can": _entity(
            "paint can",
            "static",
            "blue",
            (0.09, 0.09, 0.12),
            (0.12, 0.25, TOP + 0.06),
            {"body": {"shape": {"kind": "cylinder", "radius": 0.045, "height": 0.12}}},
        ),
        "glass": _entity(
            "glass ball",
            "static",
            "glass",
            (0.08, 0.08, 0.08),
            (0.34, 0.22, TOP + 0.04),
            {"body": {"shape": {"kind": "sphere", "radius": 0.04}}},
        ),
    }
    for k in range(DOMINOES):
        entities[f"domino{k:02d}"] = _entity(
            "domino",
            "dynamic",
            "maple" if k % 2 else "walnut",
            DOMINO,
            (-0.28 + k * PITCH, 0, TOP + DOMINO[2] / 2),
            {"body": {"shape": {"kind": "box", "size": DOMINO}}},
        )
    return WorldSpec.model_validate(
        {
            "title": "Workbench",
            "prompt": "A steel ball rolls down a ramp and topples a row of dominoes.",
            "materials": {
                "oak": _material(700, "wood", color=(0.40, 0.24, 0.12), roughness=0.45, pattern="wood", pattern_scale=0.12),
                "pine": _material(500, "wood", color=(0.62, 0.43, 0.23), roughness=0.5, pattern="wood", pattern_scale=0.1),
                "maple": _material(700, "wood", color=(0.66, 0.48, 0.29), roughness=0.4, pattern="wood"),
                "walnut": _material(650, "wood", color=(0.20, 0.10, 0.05), roughness=0.4, pattern="wood"),
                "steel": _material(7850, "steel", color=(0.62, 0.62, 0.64), roughness=0.18, metallic=1.0),
                "ceramic": _material(2400, "ceramic", color=(0.80, 0.80, 0.78), roughness=0.2),
                "red": _material(900, "plastic", color=(0.65, 0.06, 0.04), roughness=0.35),
                "blue": _material(2700, "aluminium", color=(0.05, 0.16, 0.45), roughness=0.3, metallic=0.2),
                "glass": _material(2500, "glass", color=(0.95, 0.98, 0.97), roughness=0.03, transmission=1.0),
            },
            "entities": entities,
            "shots": {
                "wide": {
                    "frames": (0, frames - 1),
                    "keys": {"start": {"frame": 0, "position": (-0.35, -1.55, 1.42), "target": (0.02, 0.0, 0.83), "fov_deg": 38}},
                    "subjects": ["ball"],
                }
            },
            "simulation": {"fps": FPS, "frames": frames},
            "look": {"sky": sky, "sun_azimuth_deg": -125, "sun_elevation_deg": 42},
        }
    )


def _ball(frame: int) -> tuple[Any, Any]:
    """Authored stand-in for a roll: down the slope, then along the bench until the first domino."""
    slope = math.atan2(RAMP[2], RAMP[0])
    travelled = min(0.5 * 2.2 * (frame / FPS) ** 2, 0.42 + 0.06)
    start = np.array([-0.60 - RAMP[0] / 2, 0.0, TOP + RAMP[2]])
    along = np.array([math.cos(slope), 0, -math.sin(slope)])
    normal = np.array([math.sin(slope), 0, math.cos(slope)])
    on_ramp = min(travelled, 0.40)
    place = start + (0.03 + on_ramp) * along + BALL_RADIUS * normal
    place = place + np.array([travelled - on_ramp, 0, 0])
    place[2] = max(place[2], TOP + BALL_RADIUS)
    return place, euler_to_quaternion((0.0, travelled / BALL_RADIUS, 0.0))


def _domino(k: int, frame: int) -> tuple[Any, Any]:
    """Authored stand-in for a topple: turns about its lower edge, one after the other."""
    hit = 15 + 1.6 * k
    angle = float(np.clip(((frame - hit) / 7.0), 0, 1) ** 2 * math.radians(67))
    pivot = np.array([-0.28 + k * PITCH + DOMINO[0] / 2, 0.0, TOP])
    turn = euler_to_quaternion((0.0, angle, 0.0))
    arm = np.array([-DOMINO[0] / 2, 0, DOMINO[2] / 2])
    rotated = np.array(
        [arm[0] * math.cos(angle) + arm[2] * math.sin(angle), 0, arm[2] * math.cos(angle) - arm[0] * math.sin(angle)]
    )
    return pivot + rotated, quaternion_product(turn, np.array([1.0, 0, 0, 0]))


def workbench(folder: Path, *, frames: int = 60, sky: str = "sunsky") -> Candidate:
    """A bench with a ramp, a steel ball, dominoes and a bowl; the motion is authored, not simulated."""
    spec = _specification(sky, frames)
    built = {name: build_entity(spec, name, folder / "assets") for name in spec.entities}
    bodies = ("ball/body", *(f"domino{k:02d}/body" for k in range(DOMINOES)))
    cache = Cache(folder / "cache")
    cache.write_index(CacheIndex("rigid", "authored", FPS, frames, bodies, (), (), (), "", {}))
    for frame in range(frames):
        poses = [_ball(frame), *(_domino(k, frame) for k in range(DOMINOES))]
        energy = 0.5 * (frame / FPS) ** 2
        write_container(
            cache.path(frame),
            {
                "position": np.stack([p for p, _ in poses]),
                "quaternion": np.stack([q for _, q in poses]),
                "contact/pair": np.zeros((frame % 5, 2), np.int32),
                "contact/min_gap": np.full(frame % 5, 1e-4),
                "record/kinetic_energy": np.array(energy),
                "record/potential_energy": np.array(3.0 - 1.1 * energy),
                "record/momentum_x": np.array(0.2 * frame / FPS),
            },
        )
    return Candidate(folder, spec, built, "full", {"rigid": cache}, digest="authored")


def psnr_db(picture: Any, reference: Any) -> float:
    """Peak signal-to-noise ratio of two 8-bit pictures [dB]."""
    error = float(np.mean((picture.astype(np.float64) - reference.astype(np.float64)) ** 2))
    return 10 * math.log10(255.0**2 / max(error, 1e-12))


def run() -> dict[str, Any]:
    """Measure; progress goes to stderr."""
    from ..rendering.frames import FrameRenderer
    from ..rendering.tracer.variant import choose_variant

    variant = choose_variant()
    with tempfile.TemporaryDirectory() as folder:
        candidate = workbench(Path(folder), frames=48)
        renderer = FrameRenderer(candidate)
        print(f"variant {variant.name}: {variant.why}", file=sys.stderr)
        renderer.render(20, width=1920, height=1080, samples=16)
        begin = time.perf_counter()
        renderer.render(21, width=1920, height=1080, samples=16)
        seconds = time.perf_counter() - begin
        print(f"1080p, 16 samples: {seconds:.2f} s", file=sys.stderr)
        small = renderer.render(20, width=320, height=180, samples=16)
        reference = renderer.render(20, width=320, height=180, samples=2048, denoise=False)
        raw = renderer.render(20, width=320, height=180, samples=16, denoise=False)
    return {
        "name": "render",
        "seconds_per_frame_1080p": round(seconds, 3),
        "psnr_db": round(psnr_db(small, reference), 2),
        "psnr_db_without_denoiser": round(psnr_db(raw, reference), 2),
        "variant": variant.name,
    }


if __name__ == "__main__":
    print(json.dumps(run()))
