"""No telemetry: nothing in this process exports traces, metrics or logs, whatever the environment asks for.

The MCP SDK wraps every message in an OpenTelemetry span. Without a provider that goes nowhere; but `OTEL_*` variables, set for
other programs of the user, may name a plugin that the API loads and that sends prompts' tool names to a collector.
"""

from __future__ import annotations

import os
from collections.abc import MutableMapping

__all__ = ["silence_telemetry"]


def silence_telemetry(environment: MutableMapping[str, str] | None = None) -> list[str]:
    """Drop every `OTEL_` variable and switch the OpenTelemetry SDK off, for this process and its workers.

    To be called before the MCP SDK is imported. Returns the names that were dropped.
    """
    variables = os.environ if environment is None else environment
    dropped = sorted(name for name in variables if name.startswith("OTEL_"))
    for name in dropped:
        del variables[name]
    variables["OTEL_SDK_DISABLED"] = "true"
    return dropped
