"""Absurd motion through the whole probe: it ends, in words or with failing rows, and never passes."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

import pytest
from worldagent.tests.hostile.specs import rewritten
from worldagent.tests.stories.conftest import Agent
from worldagent.tests.stories.inline_jobs import run_jobs_inline
from worldagent.tests.stories.small_run import PROMPT, small_spec

PROCESSOR_SECONDS = 240.0
"""Most that a probe of a world of five bodies and 36 frames may take [s]; an honest one takes 3 s."""
MOTIONS: dict[str, tuple[str, Any]] = {
    "a speed beyond light": ("/entities/ball/physics/linear_velocity", [1e9, 0, 0]),
    "a spin beyond all": ("/entities/ball/physics/angular_velocity", [0, 1e9, 0]),
    "friction like glue": ("/materials/wood/friction", 4),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", MOTIONS)
def test_absurd_motion_ends_and_does_not_pass(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    run_jobs_inline(monkeypatch)
    pointer, value = MOTIONS[name]
    spec = small_spec()
    with Agent(tmp_path) as agent:
        agent.call("edit_spec", world="w", prompt=PROMPT, spec=rewritten(spec, pointer, value))
        agent.call("place_object", world="w")
        start = time.process_time()
        answer = agent.result("probe_sim", world="w")
        assert time.process_time() - start < PROCESSOR_SECONDS
        text = answer.content[0].text
        assert not text.startswith("internal error"), text
        assert answer.is_error or '"passed":false' in text, text[:500]
