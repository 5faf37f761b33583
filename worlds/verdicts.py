"""Verdicts in words: the same in replies, on the page, in the report and in bundles."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Literal, get_args

from .ablation import ABLATED, ablation_words

__all__ = ["READ_BY", "ReadBy", "asked_words", "prompt_told", "reader_words", "unusual_told", "verdict_words"]

ReadBy = Literal["nobody", "client", "model", "person"]
"""Who, beside the checks, compared the prompt with what is to be seen: an independent model or a person makes `accepted` unqualified."""
READ_BY: tuple[ReadBy, ...] = get_args(ReadBy)
_QUALIFIED: Mapping[str, str] = {"nobody": ", prompt read by nobody", "client": ", prompt read by its own client alone"}

READINGS = (
    "words that no rule understands and no row measures: that what their claim names is what they say is the agent's word alone"
)
"""Sentence beside `readings` in a reply."""
_READERS: Mapping[str, str] = {
    "nobody": "nobody",
    "client": "its own client alone",
    "model": "an independent model",
    "person": "a person",
}


def verdict_words(record: Mapping[str, Any]) -> str:
    """The verdict of an acceptance record, with what it says of the prompt.

    Worlds of version 1, and records without an account of the prompt, are judged by clauses.
    """
    if record.get("verdict") == ABLATED:
        return ablation_words(str(record.get("ablation")))
    if record.get("verdict") != "accepted":
        return str(record.get("verdict"))
    prompt = record.get("prompt")
    if not isinstance(prompt, Mapping):
        return "physics accepted; prompt judged by clauses"
    return "accepted" + _QUALIFIED.get(str(prompt.get("read_by", "nobody")), "")


def reader_words(prompt: Mapping[str, Any]) -> str:
    """Who compared the prompt with what is to be seen, for a sentence that ends so.

    Args:
        prompt: member of an acceptance record.
    """
    return _READERS.get(str(prompt.get("read_by", "nobody")), "nobody")


def unusual_told(record: Mapping[str, Any]) -> dict[str, Any]:
    """Sentences that a verdict prints beside its result, for a reply; nothing where there are none, or where a record knows none."""
    told = [str(line) for line in record.get("unusual") or ()]
    return {"unusual": told} if told else {}


def prompt_told(record: Mapping[str, Any]) -> dict[str, Any]:
    """Account of the prompt for a reply: shares, filler, waivers with their reasons, words that only the agent read, warnings, who read it."""
    prompt = record.get("prompt")
    if not isinstance(prompt, Mapping):
        clauses = record.get("clauses") or {}
        unmet = {k: c["unmet"] for k, c in clauses.items() if c.get("unmet")}
        silent = {k: c["static_because"] for k, c in clauses.items() if c.get("static_because")}
        return {"unmet_clauses": unmet, **({"clauses_without_event": silent} if silent else {})}
    kept = ("claimed", "filler", "waived", "filler_texts", "waivers", "language", "warnings", "read_by")
    readings = {"readings": list(prompt["readings"]), "readings_are": READINGS} if prompt.get("readings") else {}
    return {"prompt": {k: prompt[k] for k in kept if k in prompt} | readings}


def asked_words(comparison: str, bound: float, unit: str) -> str:
    """The bound of a row for a reader; that of a band is one of its ends.

    Args:
        comparison: of the row.
        bound: its number.
        unit: of that; empty or `1` where it has none.
    """
    number = f"{bound:.6g}" + ("" if unit in ("", "1") else f" {unit}")
    return f"a value of the band that ends at {number}" if comparison == "in" else f"{comparison} {number}"
