"""A bake takes the frames of the probe of its own settings, and goes on from there to the bytes that it would have made by itself (R79)."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

import pytest
from worldagent.construction.build import build_entity
from worldagent.simulation import bake
from worldagent.simulation.origins import checkpoint_path, taken_in
from worldagent.simulation.schedule import run_frames
from worldagent.testing.worlds.small_liquids import PROMPT, tank_spec
from worldagent.tests.simulation.test_shorter_run import files
from worldagent.workflow.estimates import spared_seconds
from worldagent.worlds.bake_plan import checkpoint_frames
from worldagent.worlds.built import BuiltEntity
from worldagent.worlds.cache import Cache
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.folder import WorldFolder
from worldagent.worlds.patch import parse_spec
from worldagent.worlds.spec import WorldSpec

FREEZE = "f" * 64
WHOLE, PROBED = 18, 15
NAMES = ("rigid", "water")


class Probed:
    """A world whose first frames a probe has simulated, and all of whose frames a bake made by itself, in `root`."""

    def __init__(self, root: Path) -> None:
        self.spec: WorldSpec = parse_spec({**tank_spec(spacing=0.05, frames=WHOLE, closed=True), "prompt": PROMPT})
        self.built: dict[str, BuiltEntity] = {n: build_entity(self.spec, n, Path()) for n in self.spec.entities}
        self.folder = WorldFolder(root / "w")
        self.alone = root / "alone"
        self.candidate = self.folder.candidate(FREEZE)
        self.said: list[str] = []

    def make(self) -> None:
        """Simulate both."""
        run_frames(self.spec, self.built, self.alone, frames=WHOLE)
        run_frames(self.spec, self.built, self.candidate / "probe", frames=PROBED)

    @property
    def probe(self) -> Candidate:
        """The probe, as read from its folder."""
        caches = {n: Cache(self.candidate / "probe" / n) for n in NAMES}
        return Candidate(self.folder.root, self.spec, self.built, "probe", caches)

    def bake(self, **more: Any) -> Path:
        """Bake the world; the folder of the bake."""
        self.said.clear()
        bake.run_bake(self.folder, FREEZE, progress=lambda done, total, text: self.said.append(text), **more)
        return self.candidate / "bake"

    @property
    def simulated(self) -> list[int]:
        """Frames that the last bake simulated."""
        told = [text.partition(": frame ")[2] for text in self.said]
        return [int(text.split()[0]) - 1 for text in told if text.endswith(f" of {WHOLE}")]


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of a `Probed` that is simulated."""
    root = tmp_path_factory.mktemp("probed")
    Probed(root).make()
    return root


@pytest.fixture
def probed(made: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Probed:
    found = Probed(Path(shutil.copytree(made, tmp_path / "copy")))
    monkeypatch.setattr(bake, "recorded_inputs", lambda folder, freeze, built=None: (found.spec, found.built))
    monkeypatch.setattr(bake, "open_candidate", lambda *_: None)
    return found


def _frames(folder: Path) -> dict[str, bytes]:
    return {n: held for n, held in files(folder).items() if n != "taken.json"}


def test_a_bake_goes_on_from_the_last_checkpoint_of_its_probe_to_the_same_bytes(probed: Probed) -> None:
    mark = checkpoint_frames(probed.spec, PROBED)[-1]
    assert 0 < mark < PROBED - 1
    baked = probed.bake(probe=probed.probe)
    assert _frames(baked) == _frames(probed.alone)
    assert {n: (t.origin, t.frames) for n, t in taken_in(baked).items()} == dict.fromkeys(
        NAMES, (f"{probed.candidate.name}/probe", mark + 1)
    )
    assert probed.simulated == [*range(mark + 1, WHOLE)]
    assert spared_seconds(baked, {"simulated_s": 30.0, "frames": PROBED}) == pytest.approx(30.0 * (mark + 1) / PROBED)


@pytest.mark.parametrize("trusts", [True, False])
def test_without_a_probe_or_where_nothing_is_trusted_a_bake_simulates_all(trusts: bool, probed: Probed) -> None:
    baked = probed.bake() if trusts else probed.bake(probe=probed.probe, reuse=False)
    assert _frames(baked) == _frames(probed.alone)
    assert taken_in(baked) == {}
    assert spared_seconds(baked, {"simulated_s": 30.0, "frames": PROBED}) == 0.0
    assert probed.simulated == [*range(WHOLE)]


@pytest.mark.parametrize("damage", ["frame", "checkpoint"])
def test_what_is_damaged_in_the_probe_is_simulated(damage: str, probed: Probed) -> None:
    mark = checkpoint_frames(probed.spec, PROBED)[-1]
    water = probed.probe.caches["water"]
    path = water.path(mark - 1) if damage == "frame" else checkpoint_path(water.folder, mark)
    path.write_bytes(path.read_bytes()[:-8] + b"\0" * 8)
    baked = probed.bake(probe=probed.probe)
    assert _frames(baked) == _frames(probed.alone)
    assert probed.simulated[0] <= mark
