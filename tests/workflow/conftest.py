"""The surroundings of a call, as the tests of the tools have them."""

from worldagent.tests.tools.conftest import context, told

__all__ = ["context", "told"]
