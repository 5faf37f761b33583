"""A small candidate with authored motion, rendered with the variant that exists everywhere."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.construction import build_entity
from worldagent.rendering.tracer.variant import ENV_VARIANT
from worldagent.worlds.cache import Cache, CacheIndex, write_container
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.spec import WorldSpec

FRAMES = 6
FPS = 24


@pytest.fixture(autouse=True, scope="module")
def _scalar() -> Any:
    """One variant for these tests alone: other tests of the same process start servers, which choose their own."""
    before = os.environ.get(ENV_VARIANT)
    os.environ[ENV_VARIANT] = "scalar_rgb"
    yield
    if before is None:
        del os.environ[ENV_VARIANT]
    else:
        os.environ[ENV_VARIANT] = before


def _entity(
    motion: str, material: str, size: tuple[float, ...], position: tuple[float, ...], shape: dict[str, Any]
) -> dict[str, Any]:
    return {
        "role": "thing",
        "motion": motion,
        "material": material,
        "dimensions": {"size": size},
        "pose": {"position": position},
        "parts": {"body": {"shape": shape}},
    }


def _specification(sky: str) -> dict[str, Any]:
    plain = {"density": 800, "appearance": {"color": (0.5, 0.5, 0.5), "roughness": 0.6}}
    return {
        "title": "Slide",
        "prompt": "A ball slides past a block.",
        "materials": {
            "wood": {"density": 600, "appearance": {"color": (0.5, 0.3, 0.15), "pattern": "wood"}},
            "red": {"density": 900, "appearance": {"color": (0.8, 0.05, 0.03)}},
            "grey": plain,
        },
        "entities": {
            "table": _entity("static", "wood", (2, 1, 0.1), (0, 0, -0.05), {"kind": "box", "size": (2, 1, 0.1)}),
            "ball": _entity("dynamic", "red", (0.2, 0.2, 0.2), (-0.5, -0.1, 0.1), {"kind": "sphere", "radius": 0.1}),
            "block": _entity("static", "grey", (0.2, 0.2, 0.3), (0, 0.25, 0.15), {"kind": "box", "size": (0.2, 0.2, 0.3)}),
        },
        "graph": {
            "regions": {
                "goal": {"kind": "box", "min": (0.4, -0.2, 0), "max": (0.7, 0.1, 0.3)},
                "start": {"kind": "cylinder", "center": (-0.5, -0.1, 0.1), "radius": 0.15, "height": 0.2},
            },
            "relations": {"way": {"kind": "connects", "a": "start", "b": "goal"}},
        },
        "story": {
            "beats": {
                "slides": {
                    "text": "the ball slides",
                    "owner": "rigid",
                    "subject": "ball",
                    "frames": (1, 4),
                    "predicate": {"kind": "reaches", "entity": "ball", "region": "goal"},
                }
            }
        },
        "shots": {
            "all": {
                "frames": (0, FRAMES - 1),
                "keys": {"a": {"frame": 0, "position": (-0.4, -2.4, 1.2), "target": (0, 0, 0.05), "fov_deg": 40}},
            }
        },
        "simulation": {"fps": FPS, "frames": FRAMES, "solvers": {"rigid": {"engine": "mujoco", "members": ["ball"]}}},
        "look": {"sky": sky, "width": 128, "height": 72, "samples": 2},
    }


@pytest.fixture(scope="session")
def make_candidate(tmp_path_factory: pytest.TempPathFactory) -> Callable[..., Candidate]:
    """Builds the candidate; `change` may edit the specification's dictionary first."""

    def make(sky: str = "overcast", change: Callable[[dict[str, Any]], None] | None = None) -> Candidate:
        folder: Path = tmp_path_factory.mktemp("world")
        data = _specification(sky)
        if change is not None:
            change(data)
        spec = WorldSpec.model_validate(data)
        built = {name: build_entity(spec, name, folder / "assets") for name in spec.entities}
        cache = Cache(folder / "cache")
        cache.write_index(CacheIndex("rigid", "authored", FPS, FRAMES, ("ball/body",), (), (), (), "", {}))
        for k in range(FRAMES):
            energy = 0.1 * k
            write_container(
                cache.path(k),
                {
                    "position": np.array([[-0.5 + 0.2 * k, -0.1, 0.1]]),
                    "quaternion": np.array([[1.0, 0, 0, 0]]),
                    "contact/pair": np.zeros((k % 3, 2), np.int32),
                    "contact/min_gap": np.full(k % 3, 2e-4),
                    "record/kinetic_energy": np.array(energy),
                    "record/potential_energy": np.array(1.0 - energy),
                },
            )
        return Candidate(folder, spec, built, "full", {"rigid": cache}, digest="authored")

    return make


@pytest.fixture(scope="session")
def candidate(make_candidate: Callable[..., Candidate]) -> Candidate:
    return make_candidate()
