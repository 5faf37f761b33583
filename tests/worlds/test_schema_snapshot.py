"""The schema of specifications changes on purpose only: worlds, recipes and freezes of earlier builds hang on it."""

import hashlib
import json

from worldagent.worlds.spec import WorldSpec

SCHEMA = "80a5b1137bef4b33849d993d61dc8dc2a2b1681bb62f0c325464ec7ffe018c4a"
"""SHA-256 of the schema with sorted keys; a new one belongs with a line in the changelog that names what changed."""


def test_the_schema_of_specifications_is_the_recorded_one() -> None:
    text = json.dumps(WorldSpec.model_json_schema(), sort_keys=True)
    assert hashlib.sha256(text.encode()).hexdigest() == SCHEMA
