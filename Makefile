# GNU make. `make` alone lists the targets; each sets up what it needs, in .venv.

PYTHON ?= python3
PYTHON35 ?= python3.5
BIN := .venv/bin
INSTALL := pip install --quiet --disable-pip-version-check
STAMP := .venv/.complete
# The mutator is no dependency of the project, nor is what it runs the tests of one small file with.
MUTATOR := mutmut==3.8.1 coverage hypothesis pytest pytest-timeout
MUTANTS := build/mutants
# Nor are the engines that the analytic model's own is measured against.
PEERS := build/peers
# Nor is the Python for browsers.
PYODIDE := build/pyodide

# Byte code is kept even where the environment forbids it: without it, half of what pytest does
# before the first test is compiling.
export PYTHONDONTWRITEBYTECODE :=

.DEFAULT_GOAL := help
.DELETE_ON_ERROR:
.PHONY: help setup demo reproduce test test-long test-py35 lint lint-tests lint-types lint-style \
	lint-scripts docs page bench bench-arm bench-theory faults soak stress mutants lock \
	screenshots clean

help: ## list the targets
	@sed -n 's/^\([a-z0-9-]*\):.*## /\1\t/p' Makefile | expand -t 14
	@echo 'PYTHON=... names the Python of .venv, 3.11 or newer (now: $(PYTHON)).'

setup: $(STAMP) ## make .venv with the locked dependencies and kickctl in it

demo: $(STAMP) ## watch the simulated robot being kicked
	$(BIN)/kickctl demo

reproduce: $(STAMP) ## measure all of the paper's claims, and write a report
	$(BIN)/kickctl reproduce

# Tests in real time mostly wait, so two processes share each core.
test: $(STAMP) ## run the tests (7 minutes)
	$(BIN)/python -m pytest tests --ignore=tests/lint -n $$((2 * $$(nproc))) --dist worksteal

test-long: $(STAMP) ## run the tests that take long: commands of the docs (3 minutes)
	$(BIN)/python -m pytest tests -m long -n $$(nproc)

# Nothing of pyproject.toml: the last pytest for 3.5 knows half of it.
test-py35: $(STAMP) ## run the robot's own tests on PYTHON35=..., a Python 3.5 or newer
	@$(PYTHON35) -c 'import sys; sys.exit(sys.version_info < (3, 5))' 2>/dev/null || { \
		echo "make test-py35: '$(PYTHON35)' is no Python 3.5 or newer. Name one:\
	 make test-py35 PYTHON35=/path/to/python3.5" >&2; exit 1; }
	@$(PYTHON35) -c 'import ev3dev2, hypothesis, pytest, serial' 2>/dev/null || { \
		echo "make test-py35: '$(PYTHON35)' lacks one of these, here the last for 3.5: $(PYTHON35)\
	 -m pip install pytest==6.1.2 hypothesis==5.33.2 pyserial python-ev3dev2" >&2; exit 1; }
	$(PYTHON35) -m pytest -c /dev/null --rootdir=. --import-mode=importlib -p no:cacheprovider \
		-W error -q $$($(BIN)/python -m tests.lint.sources)

lint: $(STAMP) ## check style, types, Python 3.5 in robot/ and the rules of the house
	@$(MAKE) --no-print-directory --keep-going --jobs=$$(nproc) --output-sync \
		lint-tests lint-types lint-style lint-scripts

lint-style: $(STAMP)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/lint-imports

lint-types: $(STAMP)
	$(BIN)/mypy

lint-scripts:
	@command -v shellcheck >/dev/null || { echo "make lint: needs shellcheck. Install it (Debian,\
	 Ubuntu: apt-get install shellcheck) and try again." >&2; exit 1; }
	shellcheck --check-sourced --external-sources deploy.sh .ci/run
	cat robot/service/change.sh robot/service/brick.sh | shellcheck -

lint-tests: $(STAMP)
	$(BIN)/python -m pytest tests/lint

docs: $(STAMP) ## make the site of the docs, with all notebooks, in build/docs/html (5 minutes)
	$(BIN)/python -m docs.site

page: $(STAMP) $(PYODIDE)/.complete ## make the lab's page for any web server, in build/page
	$(BIN)/python -m host.lab.static_page $(PYODIDE)/node_modules/pyodide build/page

bench: $(STAMP) ## measure the speed of what has to be fast
	$(BIN)/python -m tests.bench

bench-arm: $(STAMP) ## count what ticks, hosts and a start cost on an ARM926 (PYTHON_ARM=...)
	$(BIN)/python -m tests.bench_arm

bench-theory: $(PEERS)/.complete ## compare the model's engine with heyoka, diffrax, numba and scipy
	$(PEERS)/bin/python -m tests.bench_theory

faults: $(STAMP) ## try every fault twenty times on live motors, and print how long they ran on
	$(BIN)/python -m tests.faults

soak: $(STAMP) ## kick, cut and break a robot for an hour (SOAK_S=... seconds), and count lost ticks
	$(BIN)/python -m tests.soak

stress: $(STAMP) ## run the tests in real time 20 times (STRESS_RUNS=...) while all cores are busy
	$(BIN)/python -m tests.stress

mutants: $(MUTANTS)/.complete ## see whether the tests notice every small change to robot/safety.py
	$(MUTANTS)/bin/python -m tests.mutants

lock: $(STAMP) ## renew requirements.lock with the newest versions that fit together
	$(BIN)/uv pip compile pyproject.toml --group dev --output-file requirements.lock \
		--upgrade --quiet --universal --python-version 3.11 --generate-hashes --no-emit-index-url \
		--custom-compile-command 'make lock'

screenshots: $(STAMP) ## take pictures of the lab's page, in build/ and docs/
	$(BIN)/python -m tests.screenshots

clean: ## remove everything that can be made again
	rm -rf .venv build *.egg-info .pytest_cache .ruff_cache .mypy_cache .hypothesis \
		.coverage htmlcov
	find robot host sim_motor kickctl tests -name __pycache__ -type d -prune -exec rm -rf {} +

# The stamp comes last and goes first: after an interrupted setup, the next begins from the start.
$(STAMP): requirements.lock pyproject.toml
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null || { \
		echo "make setup: needs Python 3.11 or newer, and '$(PYTHON)' is not\
	 ($$($(PYTHON) --version 2>&1)). Install one and name it: make setup PYTHON=python3.12" >&2; \
		exit 1; }
	@$(PYTHON) -c 'import ensurepip, venv' 2>/dev/null || { echo "make setup: '$(PYTHON)' has no\
	 venv module. Install it (Debian, Ubuntu: apt-get install python3-venv) and try again." >&2; \
		exit 1; }
	@test -f $@ && $(BIN)/python -m pip --version >/dev/null || $(PYTHON) -m venv --clear .venv
	@rm -f $@
	@# uv takes a tenth of pip's time. But it does not know what is set for pip alone.
	@sed -n '/^uv==/,/[^\\]$$/p' requirements.lock | \
		$(BIN)/python -m $(INSTALL) --require-hashes -r /dev/stdin
	$(BIN)/uv pip install --quiet --python $(BIN)/python --require-hashes -r requirements.lock || \
		$(BIN)/python -m $(INSTALL) --require-hashes -r requirements.lock
	@# By itself an editable install brings a finder, which takes half of the start of each Python.
	$(BIN)/python -m $(INSTALL) --no-deps --no-build-isolation \
		--config-settings editable_mode=compat --editable .
	@touch $@

$(MUTANTS)/.complete: Makefile
	$(PYTHON) -m venv --clear $(MUTANTS)
	$(MUTANTS)/bin/python -m $(INSTALL) $(MUTATOR)
	@touch $@

# From the registry that npm is set to; what comes is checked against the lock's hashes.
$(PYODIDE)/.complete: host/lab/pyodide/package.json host/lab/pyodide/package-lock.json
	@command -v npm >/dev/null || { echo "make page: needs npm. Install it (Debian, Ubuntu:\
 apt-get install npm) and try again." >&2; exit 1; }
	@mkdir -p $(PYODIDE)
	cp host/lab/pyodide/*.json $(PYODIDE)
	@cd $(PYODIDE) && npm ci --ignore-scripts --no-audit --no-fund --loglevel=error || { \
		echo "make page: npm could not fetch Pyodide. Is there a network, and a registry in\
 npm's settings? 'npm ping' asks it." >&2; exit 1; }
	@touch $@

# Our own dependencies as locked, so that all engines run with the same numba, numpy and scipy.
$(PEERS)/.complete: Makefile requirements.lock tests/bench_theory/requirements.txt
	$(PYTHON) -m venv --clear $(PEERS)
	$(PEERS)/bin/python -m $(INSTALL) --require-hashes -r requirements.lock
	$(PEERS)/bin/python -m $(INSTALL) -r tests/bench_theory/requirements.txt
	@touch $@
