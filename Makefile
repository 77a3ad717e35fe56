# Everything sets itself up: `make demo` and `make test` work on a clean clone that has
# Python 3.11, cargo and a C compiler. With uv the environment comes from uv.lock, without it from
# requirements-dev.txt, which `make lock` exports from uv.lock.

PYTHON ?= $(shell command -v python3.11 || command -v python3)
UV := $(shell command -v uv 2>/dev/null)
VENV := $(CURDIR)/.venv
BIN := $(VENV)/bin
OUT ?= out/demo

export VIRTUAL_ENV := $(VENV)
# One interpreter for every cargo call: a change of it would rebuild the bindings.
export PYO3_PYTHON := $(BIN)/python
unexport PYTHONPATH PYTHONHOME

DEPENDENCIES := $(VENV)/.dependencies
EXTENSION := $(VENV)/.extension
RUST_SOURCES := Cargo.toml Cargo.lock $(shell find rust -name '*.rs' -o -name Cargo.toml)

step = @printf '\n== %s ==\n' '$(1)'

.PHONY: demo test fuzz interop bench bench-check bench-update check clean setup lock

demo: setup
	$(BIN)/sdr-spoof demo --output $(OUT) --force

test: check
	$(call step,cargo test)
	cargo test --locked --package sdr_spoof_core
	$(call step,pytest)
	$(BIN)/pytest

# Random operations on the correlator engine and the tracker, a minute of each unless told
# otherwise; what fails says its seed: make fuzz FUZZ_SECONDS=600 FUZZ_SEED=1234
fuzz:
	cargo test --locked --package sdr_spoof_core --test engine fuzz::long -- --ignored --nocapture

# Other people's receivers on our recordings and ours on theirs, minutes each, not part of the
# tests: make interop PEERS="gnss-sdr rtklib". Peers that are missing are skipped.
interop: setup
	$(BIN)/python tests/interop $(PEERS)

check: setup
	$(call step,cargo fmt)
	cargo fmt --all --check
	$(call step,cargo clippy)
	cargo clippy --locked --workspace --all-targets -- -D warnings
	$(call step,ruff)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(call step,mypy)
	$(BIN)/mypy
	$(call step,stubtest)
	$(BIN)/python -m mypy.stubtest sdr_spoof._core --allowlist rust/py/stubtest-allowlist.txt

# The kernels by themselves, with criterion: cargo bench --package sdr_spoof_benches.
# For docs/validation.md: sdr-spoof bench --markdown, and sdr-spoof validate speed.
bench: setup
	$(BIN)/sdr-spoof bench

# Instructions of a fixed workload against benches/instructions.toml; needs valgrind.
bench-check bench-update: $(DEPENDENCIES)
	cargo build --profile counted --locked --quiet --package sdr_spoof_benches --bin instructions
	$(BIN)/python benches/instructions.py target/counted/instructions \
		$(if $(filter bench-update,$@),--update)

setup: $(EXTENSION)

$(DEPENDENCIES): pyproject.toml uv.lock requirements-dev.txt
	$(call step,environment in .venv)
ifdef UV
	$(UV) sync --locked --quiet --python $(PYTHON)
else
	test -x $(BIN)/pip || $(PYTHON) -m venv --clear $(VENV)
	# maturin installs through pip and needs its --group, which came with 25.1.
	$(BIN)/pip install --quiet --disable-pip-version-check --upgrade 'pip>=25.1'
	$(BIN)/pip install --quiet --requirement requirements-dev.txt
endif
	touch $@

$(EXTENSION): $(DEPENDENCIES) $(RUST_SOURCES)
	$(call step,extension)
	$(BIN)/maturin develop --release --locked --quiet
	touch $@

# After a change of the dependencies in pyproject.toml.
lock:
	uv lock
	uv export --locked --all-groups --no-hashes --no-annotate --no-header --no-emit-project \
		--output-file requirements-dev.txt --quiet

clean:
	rm -rf $(VENV) target out .mypy_cache .ruff_cache .pytest_cache
	find python tests -name __pycache__ -type d -prune -exec rm -rf {} +
	rm -f python/sdr_spoof/*.so
