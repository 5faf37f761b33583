"""A specification as JSON, made once for the latest ones: models are frozen, so that whoever asks again gets the very same document."""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable
from functools import wraps
from typing import Any, TypeVar

import pydantic_core
from pydantic import BaseModel

__all__ = ["bare_document", "document_of", "kept_of_latest", "text_of"]

KEPT = 4
"""Specifications whose documents are kept: an edit compares two, one that takes others back three."""

Model = TypeVar("Model", bound=BaseModel)
Result = TypeVar("Result")


def kept_of_latest(make: Callable[[Model], Result]) -> Callable[[Model], Result]:
    """Decorator of a function of a frozen model: results for the latest models are kept, and nobody may change them.

    The model itself is the key: equal ones cost more to compare than most functions of them.
    """
    kept: deque[tuple[Model, Result]] = deque(maxlen=KEPT)
    lock = threading.Lock()

    @wraps(make)
    def found(model: Model) -> Result:
        with lock:
            for other, result in kept:
                if other is model:
                    return result
        result = make(model)
        with lock:
            kept.append((model, result))
        return result

    return found


@kept_of_latest
def document_of(model: BaseModel) -> dict[str, Any]:
    """A model as JSON, nulls included."""
    return model.model_dump(mode="json")


@kept_of_latest
def bare_document(model: BaseModel) -> dict[str, Any]:
    """A model as JSON without nulls."""
    return model.model_dump(mode="json", exclude_none=True)


def text_of(model: BaseModel, *, indent: int | None = None) -> bytes:
    """UTF-8 JSON of a model without nulls: the bytes of `model_dump_json(exclude_none=True)`.

    Args:
        model: of finite numbers.
        indent: spaces per level; none writes one line.
    """
    return pydantic_core.to_json(bare_document(model), indent=indent)
