"""Freeze (R78): the hash of everything that a bake depends on, and the candidate folder it names."""

from __future__ import annotations

import json
from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path

from ..worlds.ablation import ablation
from ..worlds.built import BuiltEntity
from ..worlds.canonical import digest_of, source_changed, source_digest, spec_digest
from ..worlds.folder import WorldFolder, write_atomically
from ..worlds.slices import motion_slice
from ..worlds.spec import WorldSpec

__all__ = ["engine_versions", "freeze_hash", "open_freeze", "settings_hash", "solver_changed", "solver_source"]


_FOLDERS = (Path(__file__).parent, Path(__file__).parents[1] / "physics")


@lru_cache(maxsize=1)
def engine_versions() -> dict[str, str]:
    """Versions of what computes the motion."""
    from importlib.metadata import version

    return {"mujoco": version("mujoco"), "numpy": version("numpy"), "scipy": version("scipy"), "warp-lang": version("warp-lang")}


def solver_source() -> str:
    """SHA-256 over the source of what computes the motion: the engines, and the laws that they follow."""
    return source_digest(*_FOLDERS)


def solver_changed() -> bool:
    """True where that source is another than when this process first read it, after an update for instance."""
    return source_changed(*_FOLDERS)


def freeze_hash(
    spec: WorldSpec, built: Mapping[str, BuiltEntity], *, source: str | None = None, versions: Mapping[str, str] | None = None
) -> str:
    """Hash of production settings: motion slice, content of the geometry, solver source, engine versions.

    `source` and `versions` are of this installation, or what a record says: a record that another version made hashes to its
    own freeze all the same.
    """
    return settings_hash(spec, {name: entity.digest() for name, entity in built.items()}, source=source, versions=versions)


def settings_hash(
    spec: WorldSpec, contents: Mapping[str, str], *, source: str | None = None, versions: Mapping[str, str] | None = None
) -> str:
    """The same from the digests of the geometry."""
    marks = [name] if (name := ablation()) else []  # what an evaluation without some checks probes is no freeze elsewhere
    return digest_of(motion_slice(spec), dict(contents), source or solver_source(), dict(versions or engine_versions()), *marks)


def open_freeze(
    folder: WorldFolder, spec: WorldSpec, built: Mapping[str, BuiltEntity], files: Mapping[str, str], revision: int
) -> str:
    """Write `candidate.json` for these settings and return the freeze hash.

    The record holds the specification, so that a candidate can be judged without the ledger. A later revision with
    equal motion (another camera, another story) keeps the caches and replaces the recorded specification.
    """
    freeze = freeze_hash(spec, built)
    document = spec.model_dump(mode="json", exclude_none=True)
    record = {
        "freeze": freeze,
        "revision": revision,
        "spec": document,
        "spec_digest": spec_digest(spec),
        "document_digest": digest_of(document),
        "built": {name: [files[name], built[name].digest()] for name in sorted(built)},
        "versions": engine_versions(),
        "source": solver_source(),
        **({"ablation": name} if (name := ablation()) else {}),
    }
    path = folder.candidate(freeze) / "candidate.json"
    write_atomically(path, json.dumps(record, sort_keys=True, indent=1).encode())
    return freeze
