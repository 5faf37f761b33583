"""Parts of a job as stretches of the whole."""

import pytest
from worldagent.execution import JobContext, Part
from worldagent.execution.context import Board
from worldagent.execution.job import Progress


def heard(**more):
    seen = []
    return seen, Part(lambda *told: seen.append(told), **more)


def test_a_part_counts_as_its_share_and_ends_where_it_ends():
    seen, part = heard(first=0.2, last=0.6)
    part(1, 4, "a")
    part.part(0.5, 1.0)(1, 2, "b")
    assert seen[0][1:3] == (1.0, "a")
    assert seen[0][0] == pytest.approx(0.3)
    assert seen[0][3] == pytest.approx(0.6)
    assert seen[1][0] == pytest.approx(0.5)
    assert seen[1][3] == pytest.approx(0.6)


def test_stretches_of_unlike_pace_end_one_after_the_other():
    """Three instances of ten frames: the last report of each still belongs to it."""
    seen, part = heard(last=0.5, alike=3)
    for done in (1, 10, 11, 30):
        part(done, 30, "")
    assert [round(told[3], 6) for told in seen] == [round(0.5 * k / 3, 6) for k in (1, 1, 2, 3)]


def test_a_part_of_nothing_is_done():
    seen, part = heard(first=0.5, last=1.0)
    part(0, 0, "")
    assert seen[0][0] == 1.0


def test_the_board_carries_where_the_present_pace_ends():
    board = Board()
    context = JobContext(job_id="job_000000000000", report=board.write, cancel_asked=board.cancel_asked)
    Part(context.progress, 0.0, 0.5)(1, 4, "frames")
    assert board.read_new() == Progress(0.125, 1.0, "frames", 0.5)
    context.progress(0.5, None, "x" * 5000)
    told = board.read_new()
    assert (told.total, told.ends) == (None, None)
    assert set(told.message) == {"x"}
