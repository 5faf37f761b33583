"""Entries that use the engines; a nursery of them loads what that of the real jobs loads."""

import hashlib
import sys

from worldagent.workflow.jobs import WARM

__all__ = ["WARM", "computed", "loaded"]


def loaded(payload, context):
    """True if the engines were there before the entry began."""
    return {name: name in sys.modules for name in WARM}


def computed(payload, context):
    """Digests of what the engines compute: BLAS products, Warp launches, MuJoCo steps, a Mitsuba picture."""
    import mujoco
    import numpy as np
    from worldagent.geometry.launch import warp
    from worldagent.rendering.tracer.variant import Variant, load_mitsuba

    rng = np.random.default_rng(7)
    a, b = rng.standard_normal((400, 300)), rng.standard_normal((300, 500))
    product = a @ b
    solved = np.linalg.solve(a.T @ a, b)
    wp = warp()
    values = wp.array(product.ravel(), dtype=wp.float64, device="cpu")
    keys = wp.array(np.arange(product.size, dtype=np.int32), device="cpu")
    wp.utils.array_scan(keys, keys, inclusive=True)
    model = mujoco.MjModel.from_xml_string(
        "<mujoco><worldbody><geom type='plane' size='5 5 1'/><body pos='0 0 1'><freejoint/><geom size='.1'/></body></worldbody></mujoco>"
    )
    data = mujoco.MjData(model)
    data.qvel[:] = 0.3
    for _ in range(500):
        mujoco.mj_step(model, data)
    # The one that every machine has: a busy machine may prove a faster one in one process and not in the other.
    mi = load_mitsuba(Variant("scalar_rgb", "for a test", None))
    scene = mi.load_dict(
        {
            "type": "scene",
            "integrator": {"type": "path"},
            "sensor": {
                "type": "perspective",
                "to_world": mi.ScalarTransform4f().look_at([0, -4, 0], [0, 0, 0], [0, 0, 1]),
                # Box-filtered as all pictures here: wider filters add up blocks of threads in the order in which they end.
                "film": {"type": "hdrfilm", "width": 8, "height": 8, "rfilter": {"type": "box"}},
            },
            "light": {"type": "constant"},
            "ball": {"type": "sphere"},
        }
    )
    picture = np.array(mi.render(scene, spp=4, seed=3))
    parts = {
        "picture": picture,
        "product": product,
        "solved": solved,
        "values": values.numpy(),
        "scan": keys.numpy(),
        "state": data.qpos,
    }
    return {name: hashlib.sha256(part.tobytes()).hexdigest() for name, part in parts.items()}
