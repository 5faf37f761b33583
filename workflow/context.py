"""Context and reply of a tool; the server turns these into MCP messages."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from .heard import Heard

if TYPE_CHECKING:
    from ..execution import Job, JobStore

__all__ = ["Handover", "Link", "Picture", "ToolBinding", "ToolContext", "ToolReply"]


@dataclass
class Handover:
    """Where a tool leaves the job that it started, for a client that follows jobs by itself (MCP tasks)."""

    patience_s: float = 0.5
    """Time that the tool waits for the job's end [s], whatever its arguments say: a short job needs no following."""
    job_id: str | None = None
    """The job that runs on; None if the tool's reply is complete."""


@dataclass(frozen=True)
class ToolContext:
    """One call's surroundings."""

    workspace: Path
    """Root of all worlds; no path leads out of it."""
    jobs: JobStore
    progress: Callable[[float, float | None, str], None]
    """Reports (done, total, message) to the client; safe from any thread; never raises."""
    cancelled: Callable[[], bool]
    """Function that is true once the client gave up on this call (a started job lives on)."""
    handover: Handover | None = None
    """Given when the client takes a running job instead of the reply."""
    replies: Mapping[str, Callable[[Job], ToolReply]] = field(default_factory=dict)
    """By kind of job: the reply of the tool that starts such jobs, for one that has ended."""
    heard: Heard = field(default_factory=Heard)
    """Warnings that this client's session has been told."""


@dataclass(frozen=True)
class Picture:
    """An encoded image for the client to show."""

    data: bytes
    format: str
    """`jpeg` or `png`."""


class Link(NamedTuple):
    """A file for the client to read as a resource."""

    name: str
    uri: str
    """`worldagent://...`"""
    mime_type: str
    size: int | None = None
    """Bytes."""
    description: str | None = None


@dataclass(frozen=True)
class ToolReply:
    """Result of a tool.

    `data` begins with `summary`, `warnings` and `next`. A tool with pictures carries no structured content (some clients
    then drop the pictures): its `data` becomes one compact JSON text block beside them. Any other reply is structured
    content plus the same JSON as text.
    """

    data: dict[str, Any]
    pictures: tuple[Picture, ...] = ()
    links: tuple[Link | tuple[str, str, str], ...] = ()


@dataclass(frozen=True)
class ToolBinding:
    """One MCP tool. `function(context, ...)` has typed, described parameters after the context."""

    function: Callable[..., ToolReply]
    title: str
    read_only: bool
    destructive: bool = False
    idempotent: bool = False
    open_world: bool = False
    """True for a tool that may speak to a host which the server's owner named (a model that reads worlds)."""
    pictures: bool = False
    """True if replies can hold pictures: then the tool declares no output schema."""
    jobs: Mapping[str, Callable[[Job], ToolReply]] = field(default_factory=dict)
    """By kind of the jobs that the tool starts: the reply that the tool gives when such a job has ended; raises its error."""
    words: Mapping[str, Mapping[str, str]] = field(default_factory=dict)
    """By argument: values that callers try and that it does not have, with the call that tells what they look for."""
    meta: Mapping[str, Any] = field(default_factory=dict)
    """`_meta` of the tool, for clients that read it: search words, size of results, a user interface."""

    @property
    def name(self) -> str:
        """The tool's name: the function's."""
        return self.function.__name__

    @property
    def description(self) -> str:
        """Description for the calling model: the function's docstring."""
        import inspect

        text = inspect.getdoc(self.function)
        if not text:
            raise ValueError(f"tool {self.name} has no docstring")
        return text
