"""Accepted worlds as the clean set: every world that was accepted once must pass every check again.

They are the specifications in `accepted/`, the whole worlds that the skills record, and the showcases of `examples/` that are written
without looking at what was built; a run builds, probes and bakes them anew and counts each check that leaves a mandatory row open as a
false alarm.
"""

from __future__ import annotations

import json
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import Any

from ...construction import build_world, built_paths
from ...simulation.bake import run_bake
from ...simulation.freeze import open_freeze
from ...verifiers.acceptance import judge
from ...workflow.plates import make_plates
from ...worlds.baked import frame_digests
from ...worlds.candidate import Candidate
from ...worlds.errors import RefusedError
from ...worlds.folder import WorldFolder, write_atomically
from ...worlds.ledger import Ledger
from ...worlds.named_materials import declared_by_name
from ...worlds.patch import parse_edit, parse_spec
from ...worlds.requirements import Row
from ...worlds.spec import WorldSpec

__all__ = ["KEPT", "Rejudged", "adopt", "baked_in", "recorded", "rejudge", "showcases", "specifications"]

FOLDER = "accepted"
SKILLS = Path(__file__).parents[2] / "skills"
KEPT = Path(__file__).with_name(FOLDER)
"""Where accepted worlds are kept in a checkout."""


@dataclass(frozen=True)
class Rejudged:
    """One accepted world, built and judged anew."""

    world: str
    rows: tuple[Row, ...]
    seconds: float

    @property
    def checks(self) -> frozenset[str]:
        """Checks that judged it."""
        return frozenset(r.check for r in self.rows)

    @property
    def alarms(self) -> tuple[Row, ...]:
        """Mandatory rows that do not pass."""
        return tuple(r for r in self.rows if r.mandatory and r.status in ("fail", "unverified"))


PLATES_S = 600.0
"""[s] Own choice: most time for plates; the usual share of the bake's leaves some out on a busy machine, and rows unverified."""


def specifications() -> Iterator[tuple[str, WorldSpec]]:
    """Name and specification of every accepted world that is kept."""
    for item in sorted(files(__package__).joinpath(FOLDER).iterdir(), key=lambda i: i.name):
        if item.name.endswith(".json"):
            yield item.name.removesuffix(".json"), parse_spec(json.loads(item.read_text(encoding="utf-8")))


def recorded() -> Iterator[tuple[str, WorldSpec]]:
    """Name (`skill/file`) and specification of every whole world that a skill records; materials of the table are declared as an edit does."""
    for path in sorted(SKILLS.glob("*/*.json")):
        document = json.loads(path.read_text(encoding="utf-8"))
        if isinstance(document, dict) and {"prompt", "entities"} <= set(document):
            yield f"{path.parent.name}/{path.stem}", parse_edit(document)


def showcases() -> Iterator[tuple[str, WorldSpec]]:
    """Name (`examples/file`) and specification of the showcases that no answer of the server shapes."""
    from ...examples import burst_tank, jelly_hammock, jelly_tank, siege, water_hammock

    made = (
        ("siege", siege.PROMPT, siege.siege_spec()),
        ("burst_tank", burst_tank.PROMPT, burst_tank.flood_spec(0.05)),
        ("jelly_hammock", jelly_hammock.PROMPT, jelly_hammock.jelly_spec()),
        ("jelly_tank", jelly_tank.PROMPT, jelly_tank.tank_of_jelly()),
        ("water_hammock", water_hammock.PROMPT, water_hammock.held_spec()),
    )
    for name, prompt, spec in made:
        yield f"examples/{name}", declared_by_name(parse_spec({"prompt": prompt, **spec}))


def baked_in(folder: WorldFolder, spec: WorldSpec) -> Candidate:
    """The bake of a specification, made in a new folder with its ledger and plates."""
    folder.root.mkdir()
    write_atomically(folder.spec_path, spec.model_dump_json(exclude_none=True).encode())
    built, _ = build_world(folder, spec)
    freeze = open_freeze(folder, spec, built, built_paths(folder, spec), 1)
    baked = run_bake(folder, freeze)
    Ledger(folder.ledger_path).put_bake(freeze, 1, baked.digest, {"frame_digests": frame_digests(baked.caches)})
    make_plates(baked, seconds=PLATES_S)
    return baked


def rejudge(world: str, spec: WorldSpec) -> Rejudged:
    """Build, bake and judge a specification from nothing, as its acceptance did."""
    with tempfile.TemporaryDirectory(prefix="worldagent-accepted-") as root:
        folder = WorldFolder(Path(root) / world.replace("/", "-"))
        baked_in(folder, spec)
        start = time.perf_counter()
        record = judge(folder.root)
        return Rejudged(world, tuple(Row.model_validate(r) for r in record["rows"]), time.perf_counter() - start)


def adopt(folder: Path, into: Path) -> Path:
    """Keep the specification of an accepted world for the clean set.

    Args:
        folder: the world's folder, with its bake.
        into: where the specification goes, as `<folder's name>.json`; in the repository `testing/defects/accepted`.

    Raises:
        RefusedError: the world is not accepted by this program's own verifiers.
    """
    record: dict[str, Any] = judge(folder)
    if record["verdict"] != "accepted":
        raise RefusedError(f"{folder.name!r} is {record['verdict']}; only accepted worlds join the clean set")
    spec = parse_spec(json.loads((folder / "world.json").read_text(encoding="utf-8")))
    path = into / f"{folder.name}.json"
    write_atomically(path, (spec.model_dump_json(indent=1, exclude_none=True) + "\n").encode())
    return path
