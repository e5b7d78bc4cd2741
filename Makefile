# What a developer runs. Each target sets up what it needs; python3 (3.11 or later) and cargo are enough to start.
#   make dev      .venv with everything in it, the binding built in the dev profile (seconds after a change)
#   make test     every test that is not slow: under two minutes
#   make check    all of it: format, lint, types, stubs, architecture, Rust and Python tests, the wheel. Is the CI.
#   make bench    the benchmarks

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
SITE := $(VENV)/.installed
MODULE := python/lmap/_railsim.abi3.so
RUST := $(shell find crates -name '*.rs' -o -name Cargo.toml) Cargo.toml Cargo.lock

# For cargo calls that build the binding without maturin. Clippy builds in a place of its own: it and maturin set
# pyo3's environment differently, and each would make the other compile pyo3 again.
export PYO3_PYTHON := $(CURDIR)/$(BIN)/python
# A binding built elsewhere must not hide ours.
unexport PYTHONPATH

.NOTPARALLEL:
.PHONY: dev test check format lint types architecture rust pytest bench clean

dev: $(MODULE)

$(BIN)/python:
	$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "lmap needs Python 3.11 or later")'
	$(PYTHON) -m venv $(VENV)

# The whole install only when what it depends on has changed; after that the module alone is built, in its place.
$(SITE): pyproject.toml | $(BIN)/python
	$(BIN)/python -m pip install --quiet 'maturin>=1.9.4,<2'
	$(BIN)/maturin develop --quiet --extras dev
	touch $@

$(MODULE): $(SITE) $(RUST)
	$(BIN)/maturin develop --quiet --skip-install
	touch $@

# Both at once: each alone leaves a core idle half of the time.
test: dev
	@log=$$(mktemp); cargo test --quiet --no-fail-fast >$$log 2>&1 & rust=$$!; \
	$(BIN)/pytest -n auto --dist worksteal -m 'not slow'; python=$$?; \
	wait $$rust; rust=$$?; cat $$log; rm -f $$log; exit $$((rust | python))

check: format lint types architecture rust pytest

format: dev
	cargo fmt --all --check
	$(BIN)/ruff format --check .

lint: dev
	$(BIN)/ruff check .
	cargo clippy --quiet --locked --workspace --all-targets --target-dir target/lint -- -D warnings

types: dev
	$(BIN)/mypy
	$(BIN)/python -m mypy.stubtest lmap._railsim --mypy-config-file pyproject.toml

architecture:
	bash .ci/architecture

rust:
	cargo test --quiet --no-fail-fast

pytest: dev
	$(BIN)/pytest -n auto --dist worksteal

bench: dev
	cargo bench

clean:
	cargo clean
	rm -rf $(VENV) python/lmap/data python/lmap/_railsim*.so dist out
