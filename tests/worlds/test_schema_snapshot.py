"""The schema of specifications changes on purpose only: worlds, recipes and freezes of earlier builds hang on it."""

import hashlib
import json

from worldagent.worlds.spec import WorldSpec

SCHEMA = "2316a8790316a56d7f03ffafff5a5544e6d956972ea8ae25a2f040ce3b62623c"
"""SHA-256 of the schema with sorted keys; a new one belongs with a line in the changelog that names what changed."""


def test_the_schema_of_specifications_is_the_recorded_one() -> None:
    text = json.dumps(WorldSpec.model_json_schema(), sort_keys=True)
    assert hashlib.sha256(text.encode()).hexdigest() == SCHEMA
