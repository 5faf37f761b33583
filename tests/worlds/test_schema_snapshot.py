"""The schema of specifications changes on purpose only: worlds, recipes and freezes of earlier builds hang on it."""

import hashlib
import json

from worldagent.worlds.spec import WorldSpec

SCHEMA = "1a189e2e8af0ac5d6203776dea2f4b78088ab594891418ca9466b590cc09ef59"
"""SHA-256 of the schema with sorted keys; a new one belongs with a line in the changelog that names what changed."""


def test_the_schema_of_specifications_is_the_recorded_one() -> None:
    text = json.dumps(WorldSpec.model_json_schema(), sort_keys=True)
    assert hashlib.sha256(text.encode()).hexdigest() == SCHEMA
