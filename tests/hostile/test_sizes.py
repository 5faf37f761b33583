"""Patches and specifications of absurd size are refused before the work: cap, count and next step, in bounded memory."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from worldagent.tests.hostile.wire import LEGACY, MESSAGE_BYTES, Stdio, memory, request
from worldagent.tests.stories.small_run import PROMPT, small_spec
from worldagent.worlds.bounds import check_document, shown
from worldagent.worlds.errors import InputError, LimitError, SpecError
from worldagent.worlds.patch import apply_patch, parse_spec
from worldagent.worlds.spec import WorldSpec

MEMORY_BYTES = 1_500_000_000
"""Address space of the child that tries [bytes]: what its libraries map, and less than the bombs would take."""
SECONDS = 60
"""Longest that one refusal may take on a loaded machine [s]; a quiet one takes up to 4 s."""
DOUBLING = [{"op": "copy", "from": "/entities", "path": f"/entities/x{k}"} for k in range(60)]


@pytest.fixture(scope="module")
def spec() -> WorldSpec:
    return parse_spec({"prompt": PROMPT, **small_spec()})


def nested(depth: int) -> dict[str, Any]:
    value: dict[str, Any] = {"kind": "contact", "a": "ball", "b": "b1"}
    for _ in range(depth):
        value = {"kind": "not", "predicate": value}
    return value


PATCHES: dict[str, tuple[Any, list[str]]] = {
    "a million operations": (lambda: [{"op": "test", "path": "/title", "value": 1}] * 10**6, ["1,000,000 operations", "2,000", "split"]),
    "a million entities at once": (
        lambda: [{"op": "add", "path": "/entities", "value": {f"e{k}": {} for k in range(10**6)}}],
        ["values", "500,000", "split"],
    ),
    "copies that double": (lambda: DOUBLING, ["values added, copied or moved", "500,000", "split"]),
    "moves without end": (
        lambda: [{"op": "add", "path": "/entities/x", "value": [0] * 200_000}]
        + [{"op": "move", "from": f"/entities/{'xy'[k % 2]}", "path": f"/entities/{'yx'[k % 2]}"} for k in range(1000)],
        ["values added, copied or moved", "500,000"],
    ),
    "a value of great depth": (lambda: [{"op": "add", "path": "/story/beats/fall/predicate", "value": nested(10_000)}], ["levels", "64"]),
    "depth by steps": (
        lambda: [
            {"op": "add", "path": "/story/beats/fall/predicate" + "/predicate" * (20 * k), "value": nested(20)} for k in range(50)
        ],
        ["levels", "64"],
    ),
    "depth by moves": (
        lambda: [{"op": "add", "path": "/a", "value": {}}, {"op": "add", "path": "/b", "value": {}}]
        + [{"op": "move", "from": f"/{'ab'[k % 2]}", "path": f"/{'ba'[k % 2]}/{'ab'[k % 2]}"} for k in range(200)],
        ["cannot be applied"],
    ),
    "a pointer without end": (lambda: [{"op": "add", "path": "/x" * 10**6, "value": 1}], ["levels", "64"]),
    "an integer without end": (lambda: [{"op": "replace", "path": "/simulation/frames", "value": 10**5000}], ["16610 bits"]),
    "1e308": (lambda: [{"op": "replace", "path": "/entities/ball/pose/position/0", "value": 1e308}], ["1e+308"]),
    "a text without end": (lambda: [{"op": "replace", "path": "/title", "value": "x" * 10**8}], ["values", "500,000"]),
    "a long text": (lambda: [{"op": "replace", "path": "/title", "value": "x" * 10**6}], ["at most 200 characters"]),
    "a long key": (lambda: [{"op": "add", "path": "/" + "x" * 10**6, "value": 1}], ["there is no field"]),
    "a test of everything": (lambda: [{"op": "test", "path": "", "value": {}}], ["cannot be applied"]),
    "text that is no Unicode": (lambda: [{"op": "replace", "path": "/title", "value": "\ud800"}], ["no Unicode", "ud800"]),
}  # fmt: skip


@pytest.mark.parametrize("name", PATCHES)
def test_a_patch_without_measure_is_refused_with_cap_count_and_next_step(spec: WorldSpec, name: str) -> None:
    make, words = PATCHES[name]
    with pytest.raises(InputError) as found:
        apply_patch(spec, make())
    for word in words:
        assert word in str(found.value)
    assert len(str(found.value)) < 8000


SPECS: dict[str, tuple[Any, type[InputError], list[str]]] = {
    "a million entities": (
        lambda s: {**s, "entities": {f"e{k}": s["entities"]["ball"] for k in range(10**6)}},
        LimitError,
        ["1,000,000 entities", "20,000", "fewer entities"],
    ),
    "a million broken entities": (lambda s: {**s, "entities": dict.fromkeys(map(str, range(10**6)))}, LimitError, ["1,000,000 entities"]),
    "twenty thousand broken entities": (lambda s: {**s, "entities": {f"e{k}": {} for k in range(20_000)}}, SpecError, ["and 79980 more", "role: is missing; expected: text"]),
    "a million unknown fields": (lambda s: {**s, **{f"x{k}": k for k in range(10**6)}}, SpecError, ["there is no field", "and 999980 more"]),
    "three million values": (lambda s: {**s, "claims": {"c1": {"by": ["/look/x"] * 3 * 10**6}}}, LimitError, ["values", "2,000,000"]),
    "a depth of 10,000": (
        lambda s: {**s, "story": {"beats": {"b": {"predicate": nested(10_000)}}}},
        LimitError,
        ["levels", "64"],
    ),
    "an integer of 10,000 digits": (lambda s: {**s, "simulation": {"frames": 10**10_000}}, InputError, ["bits"]),
}  # fmt: skip


@pytest.mark.parametrize("name", SPECS)
def test_a_specification_without_measure_is_refused_with_cap_count_and_next_step(name: str) -> None:
    make, kind, words = SPECS[name]
    with pytest.raises(kind) as found:
        parse_spec(make({"prompt": PROMPT, **small_spec()}))
    for word in words:
        assert word in str(found.value)
    assert len(str(found.value)) < 8000


def test_the_refusals_take_bounded_memory_and_time() -> None:
    """In a child that may take no more: without the caps, a million broken entities took 5 GB and doubling copies all there is."""
    script = (
        "import resource, sys\n"
        f"resource.setrlimit(resource.RLIMIT_AS, ({MEMORY_BYTES}, {MEMORY_BYTES}))\n"
        "from worldagent.tests.hostile.test_sizes import *\n"
        "spec = parse_spec({'prompt': PROMPT, **small_spec()})\n"
        "for make, words in PATCHES.values():\n"
        "    try: apply_patch(spec, make())\n"
        "    except InputError: pass\n"
        "for make, kind, words in SPECS.values():\n"
        "    try: parse_spec(make({'prompt': PROMPT, **small_spec()}))\n"
        "    except InputError: pass\n"
        "print('done')\n"
    )
    child = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=SECONDS, check=False)
    assert child.stdout == "done\n", child.stderr[-2000:]


def test_the_largest_messages_leave_the_server_quick_and_small(tmp_path: Path) -> None:
    """As many operations, entities and levels as one message holds."""
    with Stdio(tmp_path, LEGACY) as server:
        server.open()
        create = {"name": "edit_spec", "arguments": {"world": "w", "prompt": PROMPT, "spec": small_spec()}}
        server.write(json.dumps(request(LEGACY, "create", "tools/call", create)).encode())
        assert not server.answer()["result"]["isError"]
        before = memory(server.child.pid, "VmHWM")
        many = (MESSAGE_BYTES - 1000) // 4
        for name, arguments in {
            "operations": '{"world":"w","patch":[' + ",".join(["{}"] * (many)) + "]}",
            "entities": '{"world":"w2","prompt":"p","spec":{"entities":{'
            + ",".join(f'"e{k}":1' for k in range(MESSAGE_BYTES // 12))
            + "}}}",
            "zeros": '{"world":"w","patch":[{"op":"add","path":"/entities/x","value":['
            + ",".join("0" * (2 * many - 100))
            + "]}]}",
            "copies": json.dumps({"world": "w", "patch": DOUBLING}),
        }.items():
            line = (
                f'{{"jsonrpc":"2.0","id":"{name}","method":"tools/call","params":{{"name":"edit_spec","arguments":{arguments}}}}}'
            )
            server.write(line.encode())
            answer = server.answer(SECONDS)
            assert answer["id"] == name
            assert answer["result"]["isError"], name
            text = answer["result"]["content"][0]["text"]
            assert text.startswith(("over the limit: ", "invalid: ")), text[:300]
            server.until_good()
        assert memory(server.child.pid, "VmHWM") - before < 700_000_000


def test_values_are_shown_without_being_written_out() -> None:
    assert shown([1, {"a": "b"}, (None, 1.5)]) == "[1, {'a': 'b'}, [None, 1.5]]"
    assert shown("x" * 10**7) == "'" + "x" * 76 + "..."
    assert shown({"k": list(range(10**6))}).startswith("{'k': [0, 1, 2")
    assert len(shown({str(k): {} for k in range(10**5)}, 50)) == 50
    assert shown(10**5000) == "an integer of 16610 bits"


def test_what_is_allowed_passes() -> None:
    check_document({"entities": {f"e{k}": {} for k in range(20_000)}}, "this")
    check_document([0.0] * 1_999_999, "this")
    with pytest.raises(LimitError):
        check_document([0.0] * 2_000_001, "this")
