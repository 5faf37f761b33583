"""Plates: small pictures of a bake in the light of its film, with and without a subject, kept beside its caches.

`plates/index.json` says what they show and what they were made from, `plates/frame_000000.npz` holds one plate each: the pictures
`with` and `without` the subject, 8-bit sRGB, shape (seeds, height, width, 3).
"""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from .arrays import U8
from .cache import DAMAGE, digest_arrays, read_container, write_container
from .errors import EvidenceError
from .folder import write_atomically
from .provenance import recipes

if TYPE_CHECKING:
    from .candidate import Candidate
    from .spec import Look

__all__ = ["MOST_PLATES", "SEEDS", "Plate", "Plates", "View", "files_of", "plate_pictures", "plate_size", "plates_folder"]

MOST_PLATES = 24
"""Own choice: plates of a world at most; about half a minute of two cores."""
PIXELS = 320 * 180
"""Own choice: pixels of a plate; a subject of the default `limits.visible_pixels` has 23 of them."""
SEEDS = 2
"""Pictures of each kind: the fewest that tell their noise."""


class View(NamedTuple):
    """A plate's subject, and the shot and frame that show it."""

    subject: str
    shot: str
    frame: int


class Plate(NamedTuple):
    """Pictures of one view, 8-bit sRGB, shape (SEEDS, height, width, 3)."""

    shown: U8
    """With the subject."""
    bare: U8
    """Without it."""


def plate_size(look: Look) -> tuple[int, int]:
    """Width and height of a plate [pixels], in the aspect of the film."""
    height = max(1, round(math.sqrt(PIXELS * look.height / look.width)))
    return max(1, round(PIXELS / height)), height


def plates_folder(candidate: Candidate) -> Path:
    """Folder of the plates of a candidate's bake."""
    return (candidate.folder / candidate.artifact).parent / "plates"


@dataclass(frozen=True)
class Plates:
    """The plates of a bake, and what they were made from."""

    recipe: str
    """Recipe of the artifact `seen` (`provenance.py`): what of the specification shows in a picture."""
    cache: str
    """Digest of the caches that they show."""
    renderer: Mapping[str, str]
    """Versions of the program that made them."""
    size: tuple[int, int]
    """Width and height [pixels]."""
    samples: int
    """Paths per pixel."""
    views: tuple[View, ...] = ()
    digests: tuple[str, ...] = ()
    """Digest of the pictures of each view."""
    left: Mapping[str, str] = field(default_factory=dict)
    """Subjects that were not looked at, and why."""

    @staticmethod
    def open(folder: Path) -> Plates | None:
        """Plates of a folder; None where nothing was made.

        Raises:
            EvidenceError: its index is damaged.
        """
        path = folder / "index.json"
        if not path.exists():
            return None
        try:
            data = json.loads(path.read_text())
            wide, tall = data["size"]
            views = tuple(View(str(s), str(n), int(k)) for s, n, k in data["views"])
            digests = tuple(str(d) for d in data["digests"])
            if len(views) != len(digests) or len(views) > MOST_PLATES:
                raise ValueError(f"{len(views)} views and {len(digests)} digests; at most {MOST_PLATES} of both")
            return Plates(
                recipe=str(data["recipe"]),
                cache=str(data["cache"]),
                renderer={str(k): str(v) for k, v in data["renderer"].items()},
                size=(int(wide), int(tall)),
                samples=int(data["samples"]),
                views=views,
                digests=digests,
                left={str(k): str(v) for k, v in data["left"].items()},
            )
        except DAMAGE as error:
            text = f"the plates have no readable index.json ({error}); call run_checks(scope='full'), which makes them anew"
            raise EvidenceError(text) from error

    def write(self, folder: Path) -> None:
        """Write the index."""
        write_atomically(folder / "index.json", json.dumps(asdict(self), indent=1, sort_keys=True).encode())

    def same_making(self, other: Plates) -> bool:
        """True if both are pictures of one bake in one light, made by one program."""
        return (self.recipe, self.cache, dict(self.renderer), self.size, self.samples) == (
            other.recipe,
            other.cache,
            dict(other.renderer),
            other.size,
            other.samples,
        )

    def added(self, folder: Path, view: View, plate: Plate) -> Plates:
        """These and one more, written."""
        digest = write_container(_path(folder, len(self.views)), {"with": plate.shown, "without": plate.bare})
        more = replace(self, views=(*self.views, view), digests=(*self.digests, digest))
        more.write(folder)
        return more

    def read(self, folder: Path, view: View) -> Plate:
        """The pictures of a view.

        Raises:
            EvidenceError: there are none, or they are damaged or altered.
        """
        if view not in self.views:
            raise EvidenceError(f"no plate shows {view.subject!r} at frame {view.frame} of shot {view.shot!r}")
        place = self.views.index(view)
        found = read_container(_path(folder, place))
        if digest_arrays(found) != self.digests[place]:
            raise EvidenceError(f"the plate of {view.subject!r} at frame {view.frame} was altered; call run_checks(scope='full')")
        shape = (SEEDS, self.size[1], self.size[0], 3)
        for name in ("with", "without"):
            picture = found.get(name)
            if picture is None or picture.shape != shape or picture.dtype != np.uint8:
                raise EvidenceError(f"the plate of {view.subject!r} at frame {view.frame} holds no pictures of shape {shape}")
        return Plate(found["with"], found["without"])

    @cached_property
    def digest(self) -> str:
        """SHA-256 over what they were made from and what they show, hex."""
        return hashlib.sha256(json.dumps(asdict(self), sort_keys=True).encode()).hexdigest()


def plate_pictures(candidate: Candidate) -> dict[View, U8]:
    """Pictures of the plates that show this very bake in its present light, in the order in which they were wanted.

    Those with their subject, 8-bit sRGB, shape (height, width, 3), the mean of their seeds; none where a plate is damaged.
    """
    folder = plates_folder(candidate)
    try:
        plates = Plates.open(folder)
        if plates is None or (plates.recipe, plates.cache) != (recipes(candidate.spec)["seen"], candidate.digest):
            return {}
        return {v: plates.read(folder, v).shown.mean(axis=0).round().astype(np.uint8) for v in plates.views}
    except EvidenceError:  # rows of the plates say what is wrong with them
        return {}


def _path(folder: Path, place: int) -> Path:
    return folder / f"frame_{place:06d}.npz"


def files_of(folder: Path) -> Sequence[Path]:
    """Files that hold the plates of a folder, as a bundle takes them along; none where nothing was made.

    Raises:
        EvidenceError: their index is damaged.
    """
    found = Plates.open(folder)
    return () if found is None else [folder / "index.json", *(_path(folder, k) for k in range(len(found.views)))]
