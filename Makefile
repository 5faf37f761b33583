# make setup | demo | test | test-all | check | build | mcpb
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
FLOORS := worlds execution geometry construction simulation verifiers rendering tools server examples bench
export PYTHONSAFEPATH := 1
export MYPYPATH := .types

.PHONY: setup demo test test-all check build mcpb clean

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

setup: $(VENV)/.installed $(VENV)/.llvm

demo: setup
	$(BIN)/worldagent demo $(DEMO_ARGS)

test: setup
	$(BIN)/python -m pytest -q -m "not slow"

test-all: setup
	$(BIN)/python -m pytest -q

check: setup
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy $(addprefix .types/worldagent/,$(FLOORS))
	$(BIN)/lint-imports

build: setup
	$(BIN)/python -m build --outdir dist .

# Needs Node.js, for the official packing tool.
mcpb: build
	$(BIN)/python packaging/build_mcpb.py "$$(ls -t dist/worldagent-*.whl | head -1)" dist

clean:
	rm -rf $(VENV) build dist demo-out .mypy_cache .ruff_cache .pytest_cache
