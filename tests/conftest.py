"""Surroundings of all tests."""

import os

# A process that waits with all engines loaded, for the workspace of every test, would fill the machine; tests of such
# processes switch them on.
os.environ.setdefault("WORLDAGENT_WARM", "0")
# Tests wait for the result of a call where a client would come back for it.
os.environ.setdefault("WORLDAGENT_WAIT_MAX_S", "240")
