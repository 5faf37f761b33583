"""Plates of the present bake for the page: which show what, and one of them as a picture."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from ...workflow.standing import Standing
from ...worlds.errors import EvidenceError, InputError
from ...worlds.folder import WorldFolder
from ...worlds.ledger import Ledger
from ...worlds.plates import Plates
from ...worlds.provenance import recipes
from ...worlds.spec import WorldSpec

__all__ = ["plate_list", "plate_picture"]

MOST_BYTES = 400_000
"""Format of a plate's picture."""


def _present(folder: WorldFolder, ledger: Ledger, where: Standing, spec: WorldSpec) -> tuple[Path, Plates] | None:
    """Plates of the present bake in the present light, and their folder; None where there are none that hold."""
    baked = where.step("baked")
    if baked.state not in ("done", "failed"):
        return None
    for freeze in (f["freeze"] for f in ledger.freezes(500)):
        bake = ledger.bake(freeze)
        if bake is not None and (bake["revision"], bake["at"]) == (baked.revision, baked.at):
            place = folder.candidate(freeze) / "bake" / "plates"
            try:
                found = Plates.open(place)
            except EvidenceError:  # rows of the plates say it
                return None
            holds = found is not None and (found.recipe, found.cache) == (recipes(spec)["seen"], bake["digest"])
            return (place, found) if found is not None and holds else None
    return None


def plate_list(folder: WorldFolder, ledger: Ledger, where: Standing, spec: WorldSpec) -> list[dict[str, Any]]:
    """Plates with the body and the frame that each shows, as data of the page."""
    found = _present(folder, ledger, where, spec)
    if found is None:
        return []
    place, plates = found
    at = (place / "index.json").stat().st_mtime
    return [
        {
            "plate": k,
            "version": plates.digests[k][:16],
            "subject": view.subject,
            "frame": view.frame,
            "alt": f"{view.subject} in the light of the film, frame {view.frame}, shot {view.shot}",
            "at": at,
        }
        for k, view in enumerate(plates.views)
    ]


def plate_picture(folder: WorldFolder, ledger: Ledger, where: Standing, spec: WorldSpec, number: str) -> tuple[bytes, str]:
    """Picture of a plate, with its subject, and its format.

    Raises:
        InputError: there is no such plate.
        EvidenceError: it is damaged.
    """
    from ...rendering import encode

    found = _present(folder, ledger, where, spec)
    if found is None or not (number.isascii() and number.isdecimal() and int(number) < len(found[1].views)):
        raise InputError(f"there is no plate {number[:20]!r} of the present bake; the prompt on the page names those there are")
    place, plates = found
    made = encode(plates.read(place, plates.views[int(number)]).shown.mean(axis=0).round().astype("uint8"), MOST_BYTES)
    return made.data, made.format
