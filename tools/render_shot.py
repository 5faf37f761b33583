"""Tool render_shot: pictures of a world."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import Field

from ..workflow.context import Link, Picture, ToolContext, ToolReply
from ..worlds.errors import EvidenceError, InputError
from ..worlds.folder import write_atomically

if TYPE_CHECKING:
    from ..execution import Job
    from ..geometry import Camera
    from ..workflow.session import Session
    from ..worlds.arrays import U8
    from ..worlds.candidate import Candidate
    from ..worlds.folder import WorldFolder

__all__ = ["film_reply", "render_shot"]

LEDGER_SIZE = (1200, 1000)
"""Pixels of a ledger plot: six panels with legends."""

_FILM_KINDS = {"webm": "video/webm", "mp4": "video/mp4"}

Kind = Literal["preview", "still", "contact_sheet", "ids", "ledger", "plan", "section", "field", "final"]


def render_shot(
    context: ToolContext,
    world: Annotated[str, Field(description="World id")],
    kind: Annotated[
        Kind,
        Field(
            description="preview: quick shaded frame; still: path-traced frame; contact_sheet: frames over time; ids: frame coloured and "
            "labelled by entity; ledger: plots of energy, momentum, ...; plan / section: measured drawings; field: map of a landscape; final: path-traced video"
        ),
    ] = "preview",
    frame: Annotated[int, Field(ge=0, description="Frame index, for single pictures")] = 0,
    shot: Annotated[str | None, Field(description="Shot id whose camera to use; default the one that covers the frame")] = None,
    camera: Annotated[
        dict[str, Any] | list[float] | None,
        Field(
            description="Own camera instead: {'position': [x, y, z], 'look_at': 'entity id'} or 'target': [x, y, z] in place of look_at, "
            "and 'fov_deg' if not 40; or six numbers, position and target [m]"
        ),
    ] = None,
    frames: Annotated[list[int] | None, Field(description="For contact_sheet: which frames", max_length=25)] = None,
    field: Annotated[
        str | None,
        Field(
            description="For field: hillshade, height, slope, basin_depth, accumulation, moisture, cover, ...; unknown ones list all"
        ),
    ] = None,
    terrain: Annotated[str | None, Field(description="For field: id under /terrains; default the only one")] = None,
    stage: Annotated[
        Literal["best", "static", "probe", "full"],
        Field(description="What to show: default the bake, else the probe, else frame 0"),
    ] = "best",
    width: Annotated[
        int | None,
        Field(ge=64, le=1920, description="Pixels (of a whole contact sheet's tile); default 640, for final the specification's"),
    ] = None,
    height: Annotated[int | None, Field(ge=64, le=1080, description="Pixels; default 360, for final the specification's")] = None,
    samples: Annotated[int | None, Field(ge=1, le=1024, description="Paths per pixel for still and final")] = None,
    wait_s: Annotated[float, Field(ge=0, le=240, description="For final: seconds to wait before a job id is returned")] = 30.0,
) -> ToolReply:
    """Look at the world: a picture comes back inline, beside a line of JSON; or make the final film.

    Takes seconds, except final. field works as soon as build_terrain(terrain=...) has built the landscape, final after acceptance,
    the others as soon as the audit passes. Frames are indices (frame k at k / fps s); own cameras in m. Use it for composition, light and understanding what happened.
    Not for judging geometry or motion: numbers do that better (run_checks, inspect_world). final renders every frame into a
    video, as a resumable job with an estimate; refused without acceptance of this very candidate.
    Returns: JSON text (summary, file, frame, camera), the picture (JPEG or PNG, at most 700 kB) and a link to it; for final
    also a link to the film with its size and length, or a job_id when it takes longer than wait_s. Next: inspect_world.
    """
    from ..workflow.session import Session

    session = Session.open(context.workspace, world)
    if kind == "final":
        return _final(context, session, width, height, samples, wait_s)
    if kind == "field":
        return _field(session, terrain, field or "hillshade", width, height)
    from ..workflow.measurements import latest_candidate

    session.require_audit("rendering")
    candidate = latest_candidate(session, stage)
    state = frame
    if candidate.stage == "static" and camera is None and frame < session.spec.simulation.frames:
        # Before any motion is known, the camera's way can be seen all the same: frame 0 from where the camera will be.
        state = 0
    if state > candidate.last_frame:
        raise InputError(f"frame {frame} is out of range; the {candidate.stage} candidate has frames 0..{candidate.last_frame}")
    from ..worlds.hints import did_you_mean

    if shot is not None and shot not in session.spec.shots:
        raise InputError(
            f"unknown shot {shot!r}{did_you_mean(shot, session.spec.shots) or ';'} the world has {sorted(session.spec.shots)}"
        )
    from ..rendering import shot_of
    from ..workflow.answers import answer
    from ..workflow.own_camera import buried, own_camera
    from ..worlds.canonical import digest_of

    data: dict[str, Any] = {"world": world, "revision": session.revision, "kind": kind, "source": candidate.artifact}
    wide, tall = LEDGER_SIZE if kind == "ledger" else (640, 360)
    size = width or wide, height or tall
    unjudged = session.shown(candidate, candidate.last_frame if kind == "contact_sheet" else state)
    own = None if camera is None else own_camera(candidate, camera, state, *size)
    image = _picture(candidate, kind, state, shot, own, frames, *size, samples, seen_from=frame)
    warnings = [] if own is None else buried(candidate, own)
    warnings += [unjudged] if unjudged else []
    if state != frame:
        warnings.append("nothing is simulated yet: the state of frame 0, seen from this frame's camera")
    view = shot or ("camera" + digest_of(camera)[:6] if camera is not None else "auto")
    name = f"{kind}_{session.revision:04d}_{frame:05d}_{view}.{'png' if image.format == 'png' else 'jpg'}"
    write_atomically(session.folder.pictures / name, image.data)
    at = ""
    if kind not in ("contact_sheet", "ledger"):
        time = round(frame / session.spec.simulation.fps, 4)
        data |= {"frame": frame, "time": time}
        at = f" of frame {frame} ({time:g} s)"
    data |= {
        "file": f"pictures/{name}",
        "camera": "own" if camera is not None else shot or shot_of(session.spec, frame) or "automatic",
    }
    link = Link(name, f"worldagent://worlds/{world}/pictures/{name}", f"image/{image.format}", len(image.data))
    text = f"{kind}{at}, from the {candidate.stage} candidate, camera {data['camera']}"
    then = "judge by numbers: inspect_world(part='state' or 'matrix')"
    return ToolReply(answer(data, text, then, warnings), pictures=(image,), links=(link,))


def _field(session: Session, terrain: str | None, field: str, width: int | None, height: int | None) -> ToolReply:
    from ..rendering import encode, field_map
    from ..workflow.answers import answer
    from ..worlds.landscape import open_landscape

    known = sorted(session.spec.terrains)
    name = terrain or (known[0] if len(known) == 1 else None)
    if name not in session.spec.terrains:
        raise InputError(
            f"terrain {name!r}: the world has {known}; kind='field' needs one that build_terrain(terrain=...) has built"
        )
    land = open_landscape(session.folder.root, session.spec, name)
    image = encode(field_map(land, field, width=width or 900, height=height or 700))
    file = f"field_{name}_{field}.{'png' if image.format == 'png' else 'jpg'}"
    write_atomically(session.folder.pictures / file, image.data)
    world = session.folder.id
    data = {"world": world, "kind": "field", "field": field, "terrain": name, "file": f"pictures/{file}"}
    link = Link(file, f"worldagent://worlds/{world}/pictures/{file}", f"image/{image.format}", len(image.data))
    told = answer(
        data, f"{field} of the landscape {name!r}, north up", "numbers: build_terrain's reply, inspect_world(part='matrix')"
    )
    return ToolReply(told, pictures=(Picture(image.data, image.format),), links=(link,))


def _picture(
    candidate: Candidate,
    kind: Kind,
    frame: int,
    shot: str | None,
    camera: Camera | None,
    frames: list[int] | None,
    width: int,
    height: int,
    samples: int | None,
    *,
    seen_from: int,
) -> Picture:
    import math

    import numpy as np

    from .. import rendering
    from ..worlds.limits import check_cap

    view = camera
    if view is None and seen_from != frame:
        view = rendering.camera_for(candidate, seen_from, shot=shot, width=width, height=height)
    if kind == "contact_sheet":
        chosen = frames or sorted(set(np.linspace(0, candidate.last_frame, 9).round().astype(int).tolist()))
        bad = [k for k in chosen if not 0 <= k <= candidate.last_frame]
        if bad:
            raise InputError(f"frames {bad} are out of range; allowed 0..{candidate.last_frame}")
        # Tiles are shrunk to fit the sheet: no use in drawing them larger.
        across = max(1, math.ceil(math.sqrt(len(chosen))))
        tile = min(width, 1920 // across)
        width, height = tile, max(64, round(height * tile / width))
        renderer = rendering.PreviewRenderer(candidate)
        fps = candidate.spec.simulation.fps
        images = [
            rendering.preview(candidate, k, shot=shot, camera=view, width=width, height=height, renderer=renderer) for k in chosen
        ]
        return Picture(rendering.contact_sheet(images, [f"frame {k}  {k / fps:.2f} s" for k in chosen]), "jpeg")
    if kind == "ledger":
        image = _ledger(candidate, width, height)
    elif kind == "plan":
        image = rendering.plan_view(candidate, frame)
    elif kind == "section":
        image = rendering.section_view(candidate, frame)
    elif kind == "ids":
        image = rendering.id_view(candidate, frame, shot=shot, camera=view, width=width, height=height)
    elif kind == "still":
        check_cap("still_samples", width * height * (samples or candidate.spec.look.samples), what="this picture")
        image = rendering.render_frame(candidate, frame, shot=shot, camera=view, width=width, height=height, samples=samples)
    else:
        image = rendering.preview(candidate, frame, shot=shot, camera=view, width=width, height=height)
    encoded = rendering.encode(image)
    return Picture(encoded.data, encoded.format)


def _ledger(candidate: Candidate, width: int, height: int) -> U8:
    """The account of the verifiers; the solver's bare records where a channel for it is missing."""
    from .. import rendering
    from ..verifiers.ledgers.accounts import account_of

    try:
        account = account_of(candidate)
    except EvidenceError:
        return rendering.plot_ledger(candidate, width=max(width, 640), height=max(height, 480))
    return rendering.plot_account(candidate, account, width=width, height=height)


def _final(
    context: ToolContext, session: Session, width: int | None, height: int | None, samples: int | None, wait_s: float
) -> ToolReply:
    from ..construction import build_world
    from ..simulation.freeze import freeze_hash
    from ..workflow.estimates import film_estimate
    from ..workflow.jobs import require_acceptance
    from ..workflow.waiting import start_and_wait
    from ..worlds.limits import check_film

    built, _ = build_world(session.folder, session.spec)
    freeze = freeze_hash(session.spec, built)
    require_acceptance(session, freeze)
    size = {"width": width, "height": height, "samples": samples}
    check_film(session.spec, context.workspace, **size)
    key = f"final:{freeze}:{session.revision}:{width}:{height}:{samples}"
    look = session.spec.look
    estimate = film_estimate(
        context.jobs,
        frames=session.spec.simulation.frames,
        width=width or look.width,
        height=height or look.height,
        samples=samples or look.samples,
    )
    data = start_and_wait(context, session, "final", size, wait_s=wait_s, key=key)
    if "state" in data:
        data["estimate_s"] = estimate
    return _film_reply(session.folder, data)


def film_reply(job: Job) -> ToolReply:
    """Reply for a final sequence that has ended."""
    from pathlib import Path

    from ..workflow.waiting import ended_data
    from ..worlds.folder import WorldFolder

    return _film_reply(WorldFolder(Path(job.payload["folder"])), ended_data(job))


def _film_reply(folder: WorldFolder, data: dict[str, Any]) -> ToolReply:
    from ..workflow.answers import answer, job_answer

    head = {"world": folder.id, "kind": "final"}
    if "state" in data:
        told = job_answer(data)
        warnings = [] if data["estimate_s"] else ["how long it takes shows in the progress after the first frame"]
        return ToolReply(answer({**told, **head}, told["summary"], told["next"], warnings))
    name = data["picture"]
    sheet = Picture((folder.pictures / name).read_bytes(), "jpeg")
    base = f"worldagent://worlds/{folder.id}"
    size, seconds = data["bytes"], data["duration_s"]
    film = Link("film", f"{base}/film", _FILM_KINDS[data["video"].rpartition(".")[2]], size, f"{seconds:g} s, {data['codec']}")
    text = f"film of {data['frames']} frames, {seconds:g} s, {data['width']} x {data['height']}, {size / 1e6:.1f} MB"
    then = "the film is the delivery: read it by its link, or from the world folder"
    notes = [data["note"]] if data["note"] else []
    told = answer({**head, **{k: v for k, v in data.items() if k != "note"}}, text, then, notes)
    return ToolReply(told, pictures=(sheet,), links=(Link(name, f"{base}/pictures/{name}", "image/jpeg"), film))
