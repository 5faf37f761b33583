"""Methods whose answers their object keeps: they answer once, and what they read goes with the object."""

from __future__ import annotations

from worldagent.worlds.kept import kept


class Reader:
    def __init__(self) -> None:
        self.asked: list[int] = []

    @kept(2)
    def square(self, number: int, *, sign: int = 1) -> int:
        """Sign times the square."""
        self.asked.append(number)
        return sign * number**2


def test_an_answer_is_kept_for_its_object_and_its_arguments() -> None:
    one, two = Reader(), Reader()
    assert [one.square(3), one.square(3), one.square(3, sign=-1), two.square(3)] == [9, 9, -9, 9]
    assert (one.asked, two.asked) == ([3, 3], [3])


def test_the_answers_that_were_asked_for_last_are_kept() -> None:
    one = Reader()
    for number in (1, 2, 1, 3, 1, 2):
        one.square(number)
    assert one.asked == [1, 2, 3, 2]
