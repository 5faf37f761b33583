"""Methods whose answers their object keeps, and which go when it goes.

`functools.lru_cache` on a method keeps the object, and all that it has read, for as long as the process lives: a server that opens
a cache for every picture would grow by its frames each time.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import Any, TypeVar, cast

__all__ = ["kept"]

F = TypeVar("F", bound=Callable[..., Any])
_NONE = object()


def kept(most: int | None = None) -> Callable[[F], F]:
    """Decorator of a method that reads: each object keeps its own answers, at most so many, those of the calls that were made last.

    Args:
        most: answers that an object keeps; None: all.
    """

    def decorate(method: F) -> F:
        slot = f"_kept_{method.__name__}"

        @wraps(method)
        def answer(self: Any, *args: Any, **named: Any) -> Any:
            known: dict[Any, Any] = self.__dict__.setdefault(slot, {})
            asked = (args, tuple(sorted(named.items())))
            found = known.pop(asked, _NONE)
            if found is _NONE:
                found = method(self, *args, **named)
            known[asked] = found  # at the end: the one that was asked for last
            while most is not None and len(known) > most:
                known.pop(next(iter(known)), None)
            return found

        return cast("F", answer)

    return decorate
