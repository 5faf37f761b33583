# make setup | demo | test | coverage | slow | slow-ages | test-all | conformance | clients | check | types-tests | build | mcpb
PYTHON ?= python3
VENV := .venv
TEST_JOBS ?= 2
BIN := $(VENV)/bin
FLOORS := physics worlds execution geometry construction simulation verifiers rendering workflow tools server examples bench testing
export PYTHONSAFEPATH := 1
export MYPYPATH := .types

.PHONY: setup demo conformance clients test slow slow-ages golden coverage test-all fuzz check types-tests build mcpb clean

$(VENV)/.installed: pyproject.toml constraints.txt
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --upgrade pip
	$(BIN)/python -m pip install --quiet --constraint constraints.txt --editable '.[dev]'
	@touch $@

# Mitsuba loads libatomic, and runs 2-3 times faster with LLVM 16 or newer. Without root or apt, `worldagent doctor` says what is missing.
$(VENV)/.llvm:
	@if [ "$$(id -u)" = 0 ] && command -v apt-get >/dev/null 2>&1 && ! ls /usr/lib/*/libLLVM*19* /usr/lib/*/libatomic.so.1 >/dev/null 2>&1; then \
		(apt-get update -qq && apt-get install -y -qq libatomic1 && apt-get install -y -qq libllvm19) >/dev/null 2>&1 \
		|| echo "libatomic1 or libllvm19 not available: see worldagent doctor"; fi
	@touch $@

# The tests of the web page drive a browser; without one they are skipped and say so.
$(VENV)/.chromium:
	@if [ "$$(id -u)" = 0 ] && command -v apt-get >/dev/null 2>&1 && ! command -v chromium >/dev/null 2>&1; then \
		(apt-get update -qq && apt-get install -y -qq --no-install-recommends chromium) >/dev/null 2>&1 || echo "chromium not available: the page is not tested in a browser"; fi
	@touch $@

# The accessibility audit of those tests; MPL-2.0, so it is fetched for them and never shipped.
$(VENV)/.axe:
	@if command -v npm >/dev/null 2>&1; then \
		npm install --silent --no-save --prefix $(VENV)/axe axe-core@4.14.1 >/dev/null 2>&1 || echo "axe-core not available: accessibility is not audited"; fi
	@touch $@

setup: $(VENV)/.installed $(VENV)/.llvm $(VENV)/.chromium $(VENV)/.axe

demo: setup
	$(BIN)/worldagent demo $(DEMO_ARGS)

test: setup
	$(BIN)/python -m pytest -q -m "not slow" -n $(TEST_JOBS) --dist loadfile $(TEST_ARGS)

# The slice of the slow tests whose last pass is oldest, or the one that SLICE names; records the run in tests/slow/passes.json.
slow: setup
	$(BIN)/python -m worldagent.tests.slow.run $(SLICE) --jobs $(TEST_JOBS) $(SLOW_ARGS)

slow-ages: setup
	$(BIN)/python -m worldagent.tests.slow.run --ages

# Every row of the seeded worlds against tests/golden; `python -m worldagent.bench.golden record` after a change that is meant.
golden: setup
	$(BIN)/python -m worldagent.bench.golden compare

# The statements of one floor that its own fast tests run: FLOOR, or the one whose turn it is by the date; the last figures of the others.
coverage: setup
	$(BIN)/python -m worldagent.tests.slow.coverage $(FLOOR) --jobs $(TEST_JOBS) $(COVERAGE_ARGS)

test-all: setup
	$(BIN)/python -m pytest -q

# The official conformance suite, the Inspector and tdqs; the first two come from npm into .conformance.
conformance: setup
	$(BIN)/python tests/conformance/run.py $(CONFORMANCE_ARGS)

# Claude Code and Codex from npm, without an account, into .clients.
clients: setup
	npm install --silent --no-fund --no-audit --prefix .clients @anthropic-ai/claude-code@2.1.330 @openai/codex@0.169.0
	$(BIN)/python -m pytest -q tests/clients

# make fuzz FUZZ_ARGS="--seconds 60 --seed 7"
fuzz: setup
	$(BIN)/python -m worldagent.tests.hostile.fuzz $(FUZZ_ARGS)

check: setup
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy $(addprefix .types/worldagent/,$(FLOORS))
	$(BIN)/lint-imports

# The tests by the settings of pyproject.toml, a slice of its own: after `check` its cache makes this 15 s.
types-tests: setup
	$(BIN)/mypy .types/worldagent/tests

build: setup
	$(BIN)/python -m build --outdir dist .

# Needs Node.js, for the official packing tool.
mcpb: build
	$(BIN)/python packaging/build_mcpb.py "$$(ls -t dist/worldagent-*.whl | head -1)" dist

clean:
	rm -rf $(VENV) build dist demo-out .clients .mypy_cache .ruff_cache .pytest_cache
