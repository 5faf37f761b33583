"""Arguments of a tool: JSON Schema derived from the function's signature, and validation with texts for the caller."""

from __future__ import annotations

import difflib
import inspect
from collections.abc import Mapping, Sequence
from typing import Any

from mcp.server.mcpserver.utilities.func_metadata import func_metadata
from pydantic import ValidationError

from ..workflow.context import ToolBinding
from ..worlds.bounds import extent, shown
from ..worlds.errors import InputError
from ..worlds.hints import did_you_mean, given

__all__ = ["Arguments"]

_SHOWN_PROBLEMS = 12
_SHOWN_CHARACTERS = 120


class Arguments:
    """Arguments of a tool. Unknown names are refused; values are checked against type and range."""

    def __init__(self, binding: ToolBinding) -> None:
        context, *names = inspect.signature(binding.function).parameters
        self.tool = binding.name
        self._words = binding.words
        self.names: tuple[str, ...] = tuple(names)
        self._metadata = func_metadata(binding.function, skip_names=[context], structured_output=False)
        schema = self._metadata.arg_model.model_json_schema()
        schema["additionalProperties"] = False
        schema.setdefault("properties", {})
        self.schema: dict[str, Any] = _portable(schema)
        """JSON Schema (2020-12) of the arguments."""

    def parse(self, given: Mapping[str, Any]) -> dict[str, Any]:
        """Keyword arguments of the function.

        Raises:
            InputError: An argument is unknown, missing or out of range.
        """
        for name, value in given.items():
            if name not in self.names:
                raise InputError(self._unknown(name))
            extent(value, what=f"{self.tool}: {name}", finite=True)
        try:
            return self._metadata.validate_arguments(dict(given))
        except ValidationError as error:
            problems = [self._problem(dict(found)) for found in error.errors(include_url=False)]
        problems = list(dict.fromkeys(problems))
        more = len(problems) - _SHOWN_PROBLEMS
        shown = problems[:_SHOWN_PROBLEMS] + ([f"... and {more} more"] if more > 0 else [])
        raise InputError(f"arguments of {self.tool}: " + "; ".join(shown))

    def _unknown(self, name: str) -> str:
        close = difflib.get_close_matches(name, self.names, n=1, cutoff=0.5)
        hint = f"; did you mean {close[0]!r}?" if close else "."
        return f"{self.tool} has no argument {shown(name)}{hint} Its arguments: {', '.join(self.names) or 'none'}"

    def _problem(self, found: dict[str, Any]) -> str:
        """One validation problem: argument, value, what is wrong and what is allowed."""
        argument, *inner = found["loc"]
        where = ".".join(str(step) for step in (argument, *inner))
        schema = self.schema["properties"].get(argument, {})
        if found["type"] == "missing" and not inner:
            described = schema.get("description")
            return f"{where} is missing" + (f" ({described})" if described else "")
        if inner and found["type"] == "extra_forbidden":
            known = sorted(self._inside(schema, inner[:-1]).get("properties", ()))
            return f"{where}: there is no {shown(inner[-1])} here{did_you_mean(str(inner[-1]), known) or ';'} allowed: {', '.join(known)}"
        if inner and found["type"] == "missing":
            return f"{where} is missing"
        allowed = _allowed(self._inside(schema, inner))
        options = _options(schema)
        if found["type"] in ("literal_error", "enum") and not inner and options:
            tried = str(found["input"])[:100].strip().lower().replace(" ", "_")
            leads = self._words.get(str(argument), {})
            meant = leads.get(tried, leads.get(tried.removesuffix("s"), ""))
            close = difflib.get_close_matches(tried, options, n=1, cutoff=0.4)
            hint = f": {meant};" if meant else f"; did you mean {close[0]!r}?" if close else ";"
            return f"{where} = {shown(found['input'], _SHOWN_CHARACTERS)} is not allowed{hint} one of {', '.join(map(repr, options))}"
        length = _length(schema)
        if length is not None and isinstance(found["input"], list | tuple) and len(found["input"]) != length:
            about = f" ({schema['description']})" if "description" in schema else ""
            return f"{argument} = {shown(found['input'], _SHOWN_CHARACTERS)} has {len(found['input'])} items, it needs {length}{about}"
        if found["type"] == "list_type" and not inner:
            return f"{where} = {shown(found['input'], _SHOWN_CHARACTERS)} must be a list: put it in brackets"
        value = given(None) if found["input"] is None else shown(found["input"], _SHOWN_CHARACTERS)
        return f"{where} = {value}: {found['msg']}" + (f" (allowed: {allowed})" if allowed else "")

    def _inside(self, schema: Mapping[str, Any], path: Sequence[Any]) -> Mapping[str, Any]:
        """The schema at a path below another; empty where there is none, or several."""
        at = self._plain(schema)
        for step in path:
            at = self._plain(at.get("properties", {}).get(step, at.get("items", {})))
        return at

    def _plain(self, schema: Mapping[str, Any]) -> Mapping[str, Any]:
        """A schema without references and without the choice of null."""
        options = [o for o in schema.get("anyOf", ()) if o.get("type") != "null"]
        found = options[0] if len(options) == 1 else schema
        name = str(found.get("$ref", "")).rpartition("/")[2]
        return self.schema.get("$defs", {}).get(name, {}) if name else found


def _options(schema: Mapping[str, Any]) -> list[str]:
    """Words that a value may be, where those are all it may be."""
    found = [value for option in schema.get("anyOf", [schema]) for value in option.get("enum", ())]
    return [value for value in found if isinstance(value, str)]


def _length(schema: Mapping[str, Any]) -> int | None:
    """Number of items of a vector."""
    for option in schema.get("anyOf", [schema]):
        if "minItems" in option and option["minItems"] == option.get("maxItems"):
            return int(option["minItems"])
    return None


def _allowed(schema: Mapping[str, Any]) -> str:
    """Range of a value in words, read from its schema; empty where the schema says nothing."""
    if "anyOf" in schema:
        return " or ".join(part for part in (_allowed(option) for option in schema["anyOf"]) if part)
    if "enum" in schema:
        return "one of " + ", ".join(repr(value) for value in schema["enum"])
    if "const" in schema:
        return repr(schema["const"])
    signs = {"minimum": ">=", "exclusiveMinimum": ">", "maximum": "<=", "exclusiveMaximum": "<"}
    sizes = {"minLength": "characters >=", "maxLength": "characters <=", "minItems": "items >=", "maxItems": "items <="}
    bounds = [f"{sign} {schema[key]}" for key, sign in (signs | sizes).items() if key in schema]
    if "pattern" in schema:
        bounds.append(f"matching {schema['pattern']}")
    return " ".join(part for part in (str(schema.get("type", "")), " and ".join(bounds)) if part)


def _portable(node: Any) -> Any:
    """A schema that every client takes.

    Without the generated `title` of every node, which only costs the model tokens; and vectors as `items` with a fixed
    length instead of `prefixItems`, since some APIs refuse arrays without `items`.
    """
    if isinstance(node, list):
        return [_portable(item) for item in node]
    if not isinstance(node, dict):
        return node
    plain: dict[str, Any] = {}
    for key, value in node.items():
        if key in ("properties", "$defs"):
            plain[key] = {name: _portable(child) for name, child in value.items()}
        elif key in ("default", "enum", "const", "examples"):
            plain[key] = value
        elif key == "prefixItems" and all(item == value[0] for item in value):
            plain["items"] = _portable(value[0])
        elif key != "title":
            plain[key] = _portable(value)
    return plain
