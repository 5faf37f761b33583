"""A world in which every part of the page has something to show."""

from __future__ import annotations

import json
from typing import Any

import cv2
import numpy as np
from worldagent.simulation.freeze import engine_versions, solver_source
from worldagent.tests.page.conftest import Made, row
from worldagent.tests.page.test_standing import FREEZE
from worldagent.worlds.cache import Cache, CacheIndex, write_container
from worldagent.worlds.claims import prompt_record
from worldagent.worlds.folder import WorldFolder
from worldagent.worlds.ledger import Ledger
from worldagent.worlds.patch import parse_spec

FRAMES = 12


def rich_world(made: Made, name: str = "w", **changes: Any) -> WorldFolder:
    """A world that was accepted, filmed, and then edited."""
    folder = made.world(name, **changes)
    ledger = Ledger(folder.ledger_path)
    ledger.put_freeze(FREEZE, 1, passed=True, detail={"failing": []})
    ledger.put_bake(FREEZE, 1, "cache-1", {"failing": []})
    simulated(folder)
    record = {
        "verdict": "accepted",
        "cache_digest": "cache-1",
        "spec_digest": (ledger.revision_spec(1) or ("", ""))[1],
        "replayed": True,
        "rows": [r.model_dump(mode="json") for r in (row("a"), row("b", "not_applicable"))],
        "clauses": {},
        "prompt": {**prompt_record(parse_spec(folder.read_json(folder.spec_path))), "read_by": "nobody"},
        "approximations": [{"what": "skin of 0.5 mm", "effect": "bodies hover"}],
        "weakenings": [],
    }
    ledger.add_acceptance(FREEZE, 1, "subject", "accepted", record)
    pictured(folder)
    made.rows(
        name,
        row("gap:ball:shelf", "fail"),
        row("gap:b1:b2"),
        row("gap:b2:b3", "unverified"),
        row("beat:fall", "fail", group="temporal", check="beat", unit="s"),
        row("joints:none", "not_applicable", group="physical", check="category", measured=None, bound=None, comparison=""),
    )
    made.edit(name, ("/shots/only/intent", "closer"), hypothesis="the camera stood too far away")
    ledger.mark_stale({"gap:b1:b2": "the pose of b1 changed in revision 2"}, 2)
    return folder


def simulated(folder: WorldFolder) -> None:
    """Caches with records of a bake."""
    root = folder.candidate(FREEZE)
    cache = Cache(root / "bake" / "rigid")
    cache.write_index(CacheIndex("rigid", "mujoco", 24, FRAMES, (), (), (), (), "test", {}))
    for k in range(FRAMES):
        values = {"kinetic_energy": 0.1 * k, "potential_energy": 2 - 0.1 * k, "momentum_z": -0.2 * k, "max_speed": 0.3 * k}
        write_container(cache.path(k), {f"record/{n}": np.array(v) for n, v in values.items()})
    record = {"versions": engine_versions(), "source": solver_source(), "spec": {"simulation": {"solvers": {"rigid": {}}}}}
    (root / "candidate.json").write_text(json.dumps(record))


def pictured(folder: WorldFolder, count: int = 2) -> None:
    """Pictures, a film, a report and a bundle."""
    folder.pictures.mkdir(exist_ok=True)
    for k in range(count):
        cv2.imwrite(str(folder.pictures / f"preview_0001_{k:05d}_only.jpg"), np.full((180, 320, 3), 40 + k % 200, np.uint8))
    cv2.imwrite(str(folder.pictures / f"bake_{FREEZE[:8]}.jpg"), np.full((540, 960, 3), 128, np.uint8))
    film = folder.candidate(FREEZE) / "final" / "final.webm"
    film.parent.mkdir(parents=True, exist_ok=True)
    writer = cv2.VideoWriter(str(film), cv2.VideoWriter.fourcc(*"VP80"), 24, (64, 48))
    for k in range(8):
        writer.write(np.full((48, 64, 3), 20 * k, np.uint8))
    writer.release()
    folder.acceptance.mkdir(exist_ok=True)
    (folder.acceptance / f"{FREEZE[:16]}.html").write_text("<!DOCTYPE html><title>Report</title><p>report")
    (folder.acceptance / f"{FREEZE[:16]}.zip").write_bytes(b"PK")
