"""A probe says which frames it took over from earlier runs."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from worldagent.simulation.origins import RECORD
from worldagent.workflow.motion_replies import motion_answer
from worldagent.workflow.probes import taken_frames
from worldagent.worlds.errors import EvidenceError


def test_what_was_taken_is_told_by_origin_and_frames(tmp_path: Path) -> None:
    assert taken_frames(tmp_path, 48) == {}
    rest = {"digest": "0" * 64}
    told = {
        "rigid": {"from": "aa/probe", "frames": 48, **rest},
        "sheets": {"from": "bb/probe", "frames": 13, **rest},
        "water": {"from": "bb/probe", "frames": 13, **rest},
    }
    (tmp_path / RECORD).write_text(json.dumps(told))
    assert taken_frames(tmp_path, 48) == {
        "taken": [
            "frames 0..47 of rigid taken from aa/probe",
            "frames 0..12 of sheets, water taken from bb/probe, simulated from 13",
        ]
    }
    (tmp_path / RECORD).write_text("{")
    with pytest.raises(EvidenceError, match="damaged"):
        taken_frames(tmp_path, 48)


def test_the_reply_of_a_probe_begins_with_it() -> None:
    counts = {"pass": 3, "fail": 0, "unverified": 0, "not_applicable": 0, "mandatory_open": 0}
    data = {"passed": True, "frames_probed": 48, "freeze": "aa", "counts": counts, "open_rows": []}
    plain = motion_answer("w", "probe", data, "concise").data["summary"]
    taken = motion_answer("w", "probe", {**data, "taken": ["frames 0..12 of a taken from b/probe, simulated from 13"]}, "concise")
    told = "48 frames probed (frames 0..12 of a taken from b/probe, simulated from 13), all"
    assert str(taken.data["summary"]).startswith(told)
    assert str(plain).startswith("48 frames probed, all")
