"""Floor 6: the MCP tools. One tool, one file, one typed function; listed here explicitly, in the order of the loop."""

from .bake_sim import bake_sim
from .build_terrain import build_terrain
from .context import Handover, Picture, ToolBinding, ToolContext, ToolReply
from .edit_spec import edit_spec
from .inspect_world import inspect_world
from .job import job
from .place_object import place_object
from .probe_sim import motion_reply, probe_sim
from .render_shot import film_reply, render_shot
from .run_checks import run_checks, verdict_reply

__all__ = ["TOOLS", "Handover", "Picture", "ToolBinding", "ToolContext", "ToolReply"]

TOOLS: tuple[ToolBinding, ...] = (
    ToolBinding(edit_spec, "Create or edit a world", read_only=False),
    ToolBinding(build_terrain, "Make the ground", read_only=False),
    ToolBinding(place_object, "Build, place and check objects", read_only=False, idempotent=True),
    ToolBinding(probe_sim, "Probe the simulation", read_only=False, idempotent=True, jobs={"probe": motion_reply}),
    ToolBinding(bake_sim, "Bake the simulation", read_only=False, idempotent=True, jobs={"bake": motion_reply}),
    ToolBinding(
        run_checks,
        "Run checks and acceptance",
        read_only=False,
        idempotent=True,
        jobs={"check": verdict_reply, "accept": verdict_reply},
    ),
    ToolBinding(render_shot, "Look at the world", read_only=False, idempotent=True, pictures=True, jobs={"final": film_reply}),
    ToolBinding(inspect_world, "Read a world's data", read_only=True, idempotent=True),
    ToolBinding(job, "Look after jobs", read_only=False, idempotent=True),
)
