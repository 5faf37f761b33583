"""Walks over a specification: references, predicate kinds, pointers, cycles."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Iterator, Mapping
from functools import lru_cache
from typing import Any, get_args

from .predicates.registry import PREDICATES
from .spec import Ref, SpecModel

__all__ = ["closest", "cycle_in", "kinds_of", "mentions_joint", "references", "resolves"]


def references(model: SpecModel, pointer: str) -> Iterator[tuple[str, str, str]]:
    """(pointer, target, value) of every reference field below a model."""
    for name, ref in _fields(type(model)):
        value = getattr(model, name)
        place = f"{pointer}/{name}"
        if ref is not None and isinstance(value, str):
            if value != "world":
                yield place, ref, value
        elif ref is not None and isinstance(value, list):
            for i, item in enumerate(value):
                yield f"{place}/{i}", ref, item
        elif isinstance(value, SpecModel):
            yield from references(value, place)
        elif isinstance(value, dict):
            for key, item in value.items():
                if isinstance(item, SpecModel):
                    yield from references(item, f"{place}/{key}")
        elif isinstance(value, list):
            for i, item in enumerate(value):
                if isinstance(item, SpecModel):
                    yield from references(item, f"{place}/{i}")


@lru_cache(maxsize=256)
def _fields(model: type[SpecModel]) -> tuple[tuple[str, str | None], ...]:
    """Fields of a model that hold references or other models, with the references' target."""
    found = []
    for name, info in model.model_fields.items():
        target = _target((*info.metadata, *_marks(info.annotation)))
        if target is not None or _holds_models(info.annotation):
            found.append((name, target))
    return tuple(found)


def _target(marks: Iterable[Any]) -> str | None:
    return next((m.target for m in marks if isinstance(m, Ref)), None)


def _marks(annotation: Any) -> Iterator[Any]:
    """Annotations at any depth of a type that holds no models."""
    yield from getattr(annotation, "__metadata__", ())
    for inner in get_args(annotation):
        yield from _marks(inner)


def _holds_models(annotation: Any) -> bool:
    """True if a value of a type may be a model or hold one."""
    inner = get_args(annotation)
    return any(map(_holds_models, inner)) if inner else isinstance(annotation, type) and issubclass(annotation, SpecModel)


def kinds_of(predicate: SpecModel) -> set[str]:
    """Predicate kinds in a predicate and below it; of an `or` those that all of its branches have, for any one of them may hold."""
    kind = str(getattr(predicate, "kind", ""))
    found = {kind}
    for name in type(predicate).model_fields:
        value = getattr(predicate, name)
        below = [kinds_of(item) for item in (value if isinstance(value, list) else [value]) if isinstance(item, SpecModel)]
        found |= (set.intersection if kind == "or" else set.union)(*below) if below else set()
    return found & set(PREDICATES)


def mentions_joint(predicate: SpecModel, joints: Mapping[str, Any], subject: str) -> bool:
    """True if a predicate reads a joint of `subject`."""
    for name in type(predicate).model_fields:
        value = getattr(predicate, name)
        if name == "joint" and value in joints and subject in (joints[value].child, joints[value].parent):
            return True
        if any(
            isinstance(v, SpecModel) and mentions_joint(v, joints, subject)
            for v in (value if isinstance(value, list) else [value])
        ):
            return True
    return False


def cycle_in(edges: Mapping[str, list[str]]) -> list[str]:
    """A cycle in a directed graph as its nodes, first repeated at the end; empty when there is none."""
    done: set[str] = set()
    for start in edges:
        path: list[str] = []
        stack = [(start, iter(edges.get(start, ())))]
        on_path = {start}
        path.append(start)
        while stack:
            _, children = stack[-1]
            child = next(children, None)
            if child is None:
                stack.pop()
                gone = path.pop()
                on_path.discard(gone)
                done.add(gone)
            elif child in on_path:
                return [*path[path.index(child) :], child]
            elif child not in done:
                stack.append((child, iter(edges.get(child, ()))))
                path.append(child)
                on_path.add(child)
    return []


def closest(value: str, known: set[str]) -> str | None:
    """The known name most like `value`, if any is like it."""
    return next(iter(difflib.get_close_matches(value, sorted(known), n=1)), None)


def resolves(document: Any, pointer: str) -> bool:
    """True if a JSON pointer leads to a value that is not null."""
    at = document
    for token in pointer.strip("/").split("/"):
        key = token.replace("~1", "/").replace("~0", "~")
        if isinstance(at, dict) and key in at:
            at = at[key]
        elif isinstance(at, list) and key.isdigit() and int(key) < len(at):
            at = at[int(key)]
        else:
            return False
    return at is not None
