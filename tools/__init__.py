"""Floor 7: the MCP tools. One tool, one file, one typed function; listed here explicitly, in the order of the loop."""

from ..workflow.context import Handover, Picture, ToolBinding, ToolContext, ToolReply
from ..workflow.links import WORLD_VIEW
from ..workflow.motion_replies import motion_reply, sketch_reply
from ..workflow.tried_words import CHECK_SCOPES, INSPECT_PARTS, RENDER_KINDS
from .bake_sim import bake_sim
from .build_interior import build_interior, interior_reply
from .build_terrain import build_terrain, landscape_reply
from .edit_spec import edit_spec
from .inspect_world import inspect_world
from .job import job
from .place_object import place_object, placed_reply
from .probe_sim import probe_sim
from .render_shot import film_reply, picture_reply, render_shot
from .run_checks import run_checks, verdict_reply

__all__ = ["TOOLS", "Handover", "Picture", "ToolBinding", "ToolContext", "ToolReply"]


_SEEN = {"ui": {"resourceUri": WORLD_VIEW}}
"""Beside the long wait and the verdict, hosts of MCP Apps show the world itself; other tools are called too often for that."""


def _found_by(words: str) -> dict[str, str]:
    """`_meta` of a tool: words by which Claude Code's search for tools finds it."""
    return {"anthropic/searchHint": words}


TOOLS: tuple[ToolBinding, ...] = (
    ToolBinding(
        edit_spec,
        "Create or edit a world",
        read_only=False,
        meta=_found_by("create a physics world, scene or simulation from a prompt; edit its specification"),
    ),
    ToolBinding(
        build_terrain,
        "Make the ground",
        read_only=False,
        jobs={"terrain": landscape_reply},
        meta=_found_by("terrain, landscape, ground, hills, rivers, lakes, erosion, plants, height field"),
    ),
    ToolBinding(
        build_interior,
        "Make rooms",
        read_only=False,
        jobs={"interior": interior_reply},
        meta=_found_by("interior, room, flat, house, kitchen, office, walls, doors, windows, furniture, floor plan"),
    ),
    ToolBinding(
        place_object,
        "Build, place and check objects",
        read_only=False,
        idempotent=True,
        jobs={"placing": placed_reply},
        meta=_found_by("place, move, copy, scatter or float objects and groups; check overlap and support"),
    ),
    ToolBinding(
        probe_sim,
        "Probe the simulation",
        read_only=False,
        idempotent=True,
        jobs={"probe": motion_reply, "sketch": sketch_reply},
        meta=_found_by("short test run of a rigid-body simulation"),
    ),
    ToolBinding(
        bake_sim,
        "Bake the simulation",
        read_only=False,
        idempotent=True,
        jobs={"bake": motion_reply},
        meta={**_found_by("run the whole physics simulation"), **_SEEN},
    ),
    ToolBinding(
        run_checks,
        "Run checks and acceptance",
        read_only=False,
        idempotent=True,
        open_world=True,
        jobs={"check": verdict_reply, "review": verdict_reply, "accept": verdict_reply},
        words={"scope": CHECK_SCOPES},
        meta={**_found_by("verify a world, acceptance, requirements matrix"), **_SEEN},
    ),
    ToolBinding(
        render_shot,
        "Look at the world",
        read_only=False,
        idempotent=True,
        pictures=True,
        jobs={"final": film_reply, "picture": picture_reply},
        words={"kind": RENDER_KINDS},
        meta=_found_by("render pictures, contact sheet, plots, final video of a world"),
    ),
    ToolBinding(
        inspect_world,
        "Read a world's data",
        read_only=True,
        idempotent=True,
        words={"part": INSPECT_PARTS},
        meta=_found_by("read a world's specification, rows, measurements, states, records"),
    ),
    ToolBinding(
        job,
        "Look after jobs",
        read_only=False,
        idempotent=True,
        meta=_found_by("progress, wait for or cancel a probe, bake, check or rendering"),
    ),
)
