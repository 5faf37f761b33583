# mypy: ignore-errors
"""A kernel that tells what a zone of waves aims at, for tests."""

import warp as wp
from worldagent.simulation.liquid.zone_kernels import Zones, aim

wp.set_module_options({"enable_backward": False})


@wp.kernel
def aims(
    first: wp.int32,
    z: Zones,
    state: wp.array(dtype=wp.float32),
    wave: wp.array(dtype=wp.vec4),
    pace: wp.array(dtype=wp.vec4),
    x: wp.array(dtype=wp.vec3),
    velocity: wp.array(dtype=wp.vec3),
    force: wp.array(dtype=wp.vec3),
):
    i = first + wp.tid()
    found = aim(z, x[i], state, wave, pace)
    velocity[i] = found.velocity
    force[i] = found.force
