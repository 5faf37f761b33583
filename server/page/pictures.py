"""Pictures of a world for the page: what there is, in words, and small versions of it."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ...worlds.errors import EvidenceError, InputError, LimitError
from ...worlds.folder import WorldFolder, safe_join

__all__ = ["PICTURE_TYPES", "SHEETS", "picture_list", "picture_path", "thumbnail"]

PICTURE_TYPES: Mapping[str, str] = {".png": "image/png", ".jpg": "image/jpeg", ".jpeg": "image/jpeg"}
MAX_BYTES = 16_000_000
MAX_PIXELS = 16_000_000
THUMBNAIL = (360, 270)
"""Box that a thumbnail fits in [pixels]."""

_SHOT = re.compile(r"^(?P<kind>[a-z_]+)_(?P<revision>\d{4,})_(?P<frame>\d{5,})_(?P<view>[\w-]+)$")
_SHEET = re.compile(r"^(?P<kind>probe|bake|final)_(?P<freeze>[0-9a-f]{8})$")
_KINDS = {
    "preview": "Preview",
    "still": "Path-traced still",
    "contact_sheet": "Contact sheet",
    "ids": "Entities by colour",
    "ledger": "Plots of energy, momentum, gaps and contacts",
    "plan": "Plan",
    "section": "Section",
    "probe": "Contact sheet of the probe",
    "bake": "Contact sheet of the bake",
    "final": "Contact sheet of the film",
}
SHEETS = ("final", "bake", "probe", "contact_sheet")
"""Kinds that show the whole motion at a glance."""
_OVER_TIME = ("contact_sheet", "ledger")


def picture_list(folder: WorldFolder, revisions: tuple[int, Mapping[str, int]] = (0, {})) -> list[dict[str, Any]]:
    """Pictures of a world, the newest first, each with what it shows in words.

    Args:
        folder: the world.
        revisions: the present revision, and the revision of each freeze by the first 8 digits of its hash.
    """
    if not folder.pictures.is_dir():
        return []
    found = []
    for path in folder.pictures.iterdir():
        if path.suffix.lower() in PICTURE_TYPES and path.is_file() and not path.name.startswith("."):
            stat = path.stat()
            found.append((stat.st_mtime_ns, path.name, stat.st_size))
    found.sort(key=lambda f: (-f[0], f[1]))
    return [{"name": name, "at": at / 1e9, "version": at, "bytes": size, **_words(name, *revisions)} for at, name, size in found]


def _words(name: str, now: int, freezes: Mapping[str, int]) -> dict[str, Any]:
    stem = Path(name).stem
    if (shot := _SHOT.match(stem)) is not None and shot["kind"] in _KINDS:
        revision = int(shot["revision"])
        when = "" if shot["kind"] in _OVER_TIME else f", frame {int(shot['frame'])}"
        view = "" if shot["kind"] in (*_OVER_TIME, "plan", "section") else f", view {shot['view']}"
        alt, kind = f"{_KINDS[shot['kind']]}{when}{view}", shot["kind"]
    elif (sheet := _SHEET.match(stem)) is not None:
        found = freezes.get(sheet["freeze"])
        alt, kind = f"{_KINDS[sheet['kind']]} {sheet['freeze']}", sheet["kind"]
        if found is None:
            return {"kind": kind, "alt": alt}
        revision = found
    else:
        return {"kind": "other", "alt": f"Picture {name}"}
    at = {"frame": int(shot["frame"])} if shot is not None and kind not in _OVER_TIME else {}
    older = {"older": True} if now and revision < now else {}
    return {"kind": kind, "alt": f"{alt}, revision {revision}", "revision": revision, **at, **older}


def picture_path(folder: WorldFolder, name: str) -> Path:
    """File of a picture.

    Raises:
        InputError: It is no picture of this world.
        LimitError: It is too large to send.
    """
    path = safe_join(folder.pictures, name)
    if path.suffix.lower() not in PICTURE_TYPES or not path.is_file():
        raise InputError(f"there is no picture {name!r}; the page lists those there are")
    if path.stat().st_size > MAX_BYTES:
        raise LimitError(f"picture {name!r} has {path.stat().st_size} bytes, at most {MAX_BYTES} are sent")
    return path


def thumbnail(path: Path) -> bytes:
    """A small JPEG of a picture.

    Raises:
        EvidenceError: It is no picture or a damaged one.
        LimitError: It has too many pixels.
    """
    import cv2
    import numpy as np

    data = path.read_bytes()
    width, height = _size(data)
    if width * height > MAX_PIXELS:
        raise LimitError(f"picture {path.name!r} has {width} x {height} pixels, at most {MAX_PIXELS} are opened")
    image = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR) if width * height else None
    if image is None:
        raise EvidenceError(f"picture {path.name!r} is damaged")
    scale = min(1.0, THUMBNAIL[0] / image.shape[1], THUMBNAIL[1] / image.shape[0])
    size = max(1, round(image.shape[1] * scale)), max(1, round(image.shape[0] * scale))
    _, encoded = cv2.imencode(".jpg", cv2.resize(image, size, interpolation=cv2.INTER_AREA), [cv2.IMWRITE_JPEG_QUALITY, 80])
    return encoded.tobytes()


def _size(data: bytes) -> tuple[int, int]:
    """Width and height that a PNG or JPEG states, before anything is decoded; (0, 0) if it is neither."""
    if data[:8] == b"\x89PNG\r\n\x1a\n" and data[12:16] == b"IHDR":
        return int.from_bytes(data[16:20], "big"), int.from_bytes(data[20:24], "big")
    at = 2 if data[:2] == b"\xff\xd8" else len(data)
    while at + 9 <= len(data) and data[at] == 0xFF:
        marker, length = data[at + 1], int.from_bytes(data[at + 2 : at + 4], "big")
        if 0xC0 <= marker <= 0xCF and marker not in (0xC4, 0xC8, 0xCC):
            return int.from_bytes(data[at + 7 : at + 9], "big"), int.from_bytes(data[at + 5 : at + 7], "big")
        at += 2 + length
    return 0, 0
