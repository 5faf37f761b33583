"""The schema of specifications changes on purpose only: worlds, recipes and freezes of earlier builds hang on it."""

import hashlib
import json

from worldagent.worlds.spec import WorldSpec

SCHEMA = "f6a838327d88be584fcd0deaf6a7ba8bff09707d301c946698160eb7a3d7c9ef"
"""SHA-256 of the schema with sorted keys; a new one belongs with a line in the changelog that names what changed."""


def test_the_schema_of_specifications_is_the_recorded_one() -> None:
    text = json.dumps(WorldSpec.model_json_schema(), sort_keys=True)
    assert hashlib.sha256(text.encode()).hexdigest() == SCHEMA
