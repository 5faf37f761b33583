"""A motion that runs away: the frame is taken again with shorter steps, and what cannot be mended is told of."""

import numpy as np
import pytest
from worldagent.tests.physics.rigid_world import ball, floor, solver, world
from worldagent.worlds.errors import EngineError


def falling():
    """A ball above a floor."""
    return solver(world({"floor": floor(), "ball": ball(0.1, at=(0, 0, 0.5))}))


def test_a_frame_that_ran_away_is_taken_again_with_half_the_step(monkeypatch):
    made, sound, steps = falling(), falling(), []
    plain = type(made)._run

    def fails_once(self, start, end, step, held=None):
        steps.append(step)
        if len(steps) == 1:
            self.data.qpos[:] = np.nan
            raise ZeroDivisionError("division by zero")
        return plain(self, start, end, step, held)

    monkeypatch.setattr(type(made), "_run", fails_once)
    made.advance(1)
    monkeypatch.undo()
    sound.begin_frame(1)
    sound.begin_attempt(1)
    sound.step_to(1 * sound._frame_time)
    assert steps == [made.settings.step, made.settings.step / 2]
    assert np.array_equal(made.data.qpos, sound.data.qpos)


def test_a_motion_that_runs_away_at_every_step_names_its_body_and_what_to_change(monkeypatch):
    made = falling()

    def fails(self, start, end, step, held=None):
        self.data.qvel[:] = [0, 0, -3e5, 0, 0, 0]
        raise self._mj.FatalError("mj_stackAlloc: out of memory")

    monkeypatch.setattr(type(made), "_run", fails)
    with pytest.raises(EngineError, match=r"motion of 'ball' ran away before frame 1 \(3e\+05 m/s.*settings/step"):
        made.advance(1)


def test_an_engine_that_gives_up_while_all_is_slow_says_why(monkeypatch):
    made = falling()

    def fails(self, start, end, step, held=None):
        raise self._mj.FatalError("mj_stackAlloc: out of memory\n  max = 1")

    monkeypatch.setattr(type(made), "_run", fails)
    with pytest.raises(EngineError, match=r"gave up at frame 1 \(mj_stackAlloc: out of memory\); fewer collision pieces"):
        made.advance(1)
