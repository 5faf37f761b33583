"""The folder of a probe whose process is killed while it makes room for one at other settings."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

import pytest
from worldagent.simulation import probe
from worldagent.testing.worlds.small_liquids import PROMPT, tank_spec
from worldagent.tests.stories.small_run import PROMPT as BLOCKS
from worldagent.tests.stories.small_run import small_spec
from worldagent.worlds.coarsening import overrides_for, write_overrides
from worldagent.worlds.folder import WorldFolder
from worldagent.worlds.patch import parse_spec
from worldagent.worlds.probe_length import probe_frames
from worldagent.worlds.spec import WorldSpec

FREEZE = "f" * 64


def test_frames_of_a_coarser_probe_never_pass_for_those_of_another(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    spec = WorldSpec.model_validate({**tank_spec(spacing=0.03, engine="dfsph"), "prompt": PROMPT})
    folder = WorldFolder(tmp_path)
    root = folder.candidate(FREEZE) / "probe"
    write_overrides(root, overrides_for(spec, 2.0))
    (root / "water").mkdir()
    (root / "water" / "frame_000000.npz").write_bytes(b"of another resolution")
    found: list[list[str]] = []

    def run(spec: WorldSpec, built: Any, where: Path, **_: Any) -> None:
        found.append(sorted(p.name for p in where.rglob("frame_*")))

    monkeypatch.setattr(probe, "recorded_inputs", lambda folder, freeze, built=None: (spec, {}))
    monkeypatch.setattr(probe, "run_frames", run)
    monkeypatch.setattr(probe, "open_candidate", lambda *_: None)
    remove = shutil.rmtree

    def killed_amid(path: Path, **_: Any) -> None:
        if path.exists():
            (path / "overrides.json").unlink()
            raise KeyboardInterrupt

    monkeypatch.setattr(shutil, "rmtree", killed_amid)
    with pytest.raises(KeyboardInterrupt):
        probe.run_probe(folder, FREEZE)
    monkeypatch.setattr(shutil, "rmtree", remove)
    probe.run_probe(folder, FREEZE)
    probe.run_probe(folder, FREEZE, overrides=overrides_for(spec, 2.0))
    assert found == [[], []]
    assert sorted(p.name for p in folder.candidate(FREEZE).iterdir()) == ["probe"]


@pytest.mark.parametrize(("last", "frames", "wanted"), [(24, 240, 24 + 1 + 18), (24, 30, 30), (238, 240, 240)])
def test_a_probe_ends_soon_after_its_last_beat_and_never_after_the_world(last: int, frames: int, wanted: int) -> None:
    """R76: at 24 fps, settling takes 18 frames more."""
    spec = parse_spec({**small_spec(), "prompt": BLOCKS})
    beats = {"fall": spec.story.beats["fall"].model_copy(update={"frames": (4, last)})}
    plan = spec.simulation.model_copy(update={"frames": frames})
    changed = spec.model_copy(update={"story": spec.story.model_copy(update={"beats": beats}), "simulation": plan})
    assert changed.simulation.fps == 24
    assert probe_frames(changed) == wanted
