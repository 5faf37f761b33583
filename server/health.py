"""Proofs that a library works here, each run in a process of its own: `python -m worldagent.server.health NAME`.

A wheel for the wrong processor or a broken driver may end the process; only the proof dies then.
"""

from __future__ import annotations

import json
import os
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

__all__ = ["PROOFS"]


def _mujoco() -> str:
    import mujoco

    xml = '<mujoco><worldbody><body pos="0 0 1"><freejoint/><geom size=".1"/></body></worldbody></mujoco>'
    model = mujoco.MjModel.from_xml_string(xml)
    data = mujoco.MjData(model)
    for _ in range(100):
        mujoco.mj_step(model, data)
    fallen = 1 - data.qpos[2]
    expected = 0.5 * 9.81 * data.time**2
    if abs(fallen - expected) > 0.02 * expected:
        raise RuntimeError(f"a body fell {fallen:.4f} m instead of {expected:.4f} m")
    return f"mj_step: a body falls {fallen:.4f} m in {data.time:.2f} s"


def _fcl() -> str:
    import fcl
    import numpy as np

    one = fcl.CollisionObject(fcl.Sphere(0.5), fcl.Transform())
    other = fcl.CollisionObject(fcl.Sphere(0.5), fcl.Transform(np.eye(3), np.array([3.0, 0.0, 0.0])))
    gap = fcl.distance(one, other, fcl.DistanceRequest(), fcl.DistanceResult())
    if abs(gap - 2.0) > 1e-4:
        raise RuntimeError(f"distance of two spheres is {gap} m instead of 2 m")
    return f"distance {gap:.4f} m"


def _mitsuba() -> str:
    import numpy as np

    from ..rendering.tracer.variant import choose_variant, load_mitsuba

    chosen = choose_variant()
    mi = load_mitsuba(chosen)
    film = {"type": "hdrfilm", "width": 8, "height": 8}
    view = mi.ScalarTransform4f().look_at([0, -4, 0], [0, 0, 0], [0, 0, 1])
    scene = mi.load_dict(
        {
            "type": "scene",
            "integrator": {"type": "path"},
            "sensor": {"type": "perspective", "to_world": view, "film": film},
            "light": {"type": "constant"},
            "ball": {"type": "sphere"},
        }
    )
    grey = float(np.array(mi.render(scene, spp=4))[4, 4, 0])
    if not 0.05 < grey < 1.0:
        raise RuntimeError(f"a grey ball has the brightness {grey} under a white sky")
    return f"{chosen.name} rendered a ball; {chosen.why}"


def _llvm() -> str:
    from ..rendering.tracer.variant import choose_variant

    chosen = choose_variant()
    if chosen.llvm_path is None and not chosen.name.startswith("cuda"):
        raise RuntimeError(f"{chosen.why}; rendering uses the slower {chosen.name}")
    return chosen.llvm_path or "not needed with CUDA"


def _oidn() -> str:
    import numpy as np
    import pyoidn

    picture = np.full((16, 16, 3), 0.5, dtype=np.float32)
    out = np.asarray(pyoidn.denoise(picture, hdr=True, quality="balanced"))
    if out.shape != picture.shape or not np.allclose(out, 0.5, atol=0.05):
        raise RuntimeError("a grey picture did not stay grey")
    return "a grey picture stays grey"


def _video() -> str:
    import cv2
    import numpy as np

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "proof.webm"
        writer = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"VP90"), 24.0, (64, 64))
        for shade in range(4):
            writer.write(np.full((64, 64, 3), 60 * shade, dtype=np.uint8))
        writer.release()
        reader = cv2.VideoCapture(str(path))
        count = 0
        while reader.read()[0]:
            count += 1
    if count != 4:
        raise RuntimeError(f"wrote 4 frames of VP9, read back {count}")
    return "VP9: 4 frames written and read back"


def _warp() -> str:
    from ..geometry.launch import load, warp

    wp = warp()
    from ..geometry.clearance_kernels import nearest
    from ..geometry.depth_kernels import deepest
    from .warm_kernel import double

    values = wp.array([1.0, 2.0, 3.0], dtype=float, device="cpu")
    wp.launch(double, dim=3, inputs=[values], device="cpu")
    if values.numpy().tolist() != [2.0, 4.0, 6.0]:
        raise RuntimeError("a kernel gave wrong numbers")
    load(nearest, "cpu")
    load(deepest, "cpu")
    return f"a kernel ran on the CPU, those of clearances are compiled; cache {wp.config.kernel_cache_dir}"


PROOFS: dict[str, Callable[[], str]] = {
    "mujoco": _mujoco,
    "python-fcl": _fcl,
    "mitsuba": _mitsuba,
    "libllvm": _llvm,
    "oidn": _oidn,
    "video": _video,
    "warp": _warp,
}
"""Proof by name: returns what was shown, raises where it fails."""


def _main(name: str) -> int:
    wire = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)
    try:
        answer = {"ok": True, "detail": PROOFS[name]()}
    except Exception as error:
        answer = {"ok": False, "detail": f"{type(error).__name__}: {error}"}
    wire.write(json.dumps(answer) + "\n")
    wire.close()
    return 0 if answer["ok"] else 1


if __name__ == "__main__":
    sys.exit(_main(sys.argv[1]))
