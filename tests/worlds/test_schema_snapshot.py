"""The schema of specifications changes on purpose only: worlds, recipes and freezes of earlier builds hang on it."""

import hashlib
import json

from worldagent.worlds.spec import WorldSpec

SCHEMA = "4968fc19bafbd319248ef15ee8b3043b67ae616616d83bdf8c6a0d252556439e"
"""SHA-256 of the schema with sorted keys; a new one belongs with a line in the changelog that names what changed."""


def test_the_schema_of_specifications_is_the_recorded_one() -> None:
    text = json.dumps(WorldSpec.model_json_schema(), sort_keys=True)
    assert hashlib.sha256(text.encode()).hexdigest() == SCHEMA
