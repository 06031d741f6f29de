# The environment lives in .venv, made once from the hashed lock; `make help` lists the targets.
PYTHON ?= python3
# A sourced ROS 2 must not mix in: .venv brings its own, with Fast DDS alone. Where Python may not keep its byte code
# every node compiles all that it imports at each start.
CLEAN_ENV := env -u PYTHONPATH -u LD_LIBRARY_PATH -u AMENT_PREFIX_PATH -u RMW_IMPLEMENTATION -u PYTHONDONTWRITEBYTECODE
BIN := .venv/bin
# Three tests at a time keep two cores busy, since nodes wait for each other; threads beside them would only get in
# the way: a quarter of the time.
ONE_THREAD := OPENBLAS_NUM_THREADS=1 OPENCV_FOR_THREADS_NUM=1
PYTEST := $(CLEAN_ENV) $(ONE_THREAD) ROS_PYTHON_CHECK_FIELDS=1 $(BIN)/python -m pytest -n 3 --dist worksteal
# Scenes of each family in `make bench`; the docs have thirty.
SEEDS ?= 3
UV := $(CLEAN_ENV) UV_NO_CONFIG=1 VIRTUAL_ENV=.venv $(BIN)/uv
PIP := $(CLEAN_ENV) $(BIN)/python -m pip --disable-pip-version-check
EDITABLE := --no-deps --no-build-isolation --editable .

.DEFAULT_GOAL := help
.PHONY: help setup demo test test-all check bench docs lock clean

help: ## list the targets
	@awk -F ':.*## ' '/^[a-z-]+:.*## / {printf "  make %-8s %s\n", $$1, $$2}' Makefile

setup: .venv/package.stamp ## make .venv: Python, ROS 2 and the tools (PYTHON=python3.12 chooses another Python)

demo: setup ## object poses of the demo bag, into demo_output
	$(CLEAN_ENV) $(BIN)/stereo-pick demo --output demo_output

test: setup ## run the tests
	$(PYTEST)

test-all: setup ## run them on more scenes, too
	$(PYTEST) --all

check: setup ## lint, format and types
	$(CLEAN_ENV) $(BIN)/ruff check
	$(CLEAN_ENV) $(BIN)/ruff format --check
	$(CLEAN_ENV) $(BIN)/mypy --strict stereo_pick

bench: setup ## print the figures that the docs quote; SEEDS=30 for all scenes
	$(CLEAN_ENV) $(BIN)/python benchmark/accuracy.py
	$(CLEAN_ENV) $(BIN)/python benchmark/evaluate_families.py --rivals --seeds $(SEEDS)
	$(CLEAN_ENV) $(BIN)/python benchmark/own_calibration.py --seeds $(SEEDS)
	$(CLEAN_ENV) $(BIN)/python benchmark/turned_camera.py --seeds $(SEEDS)
	$(CLEAN_ENV) $(BIN)/python benchmark/thesis_tables.py
	$(CLEAN_ENV) $(BIN)/python benchmark/speed.py

docs: setup ## bring the generated files up to date: docs/parameters.md and config/stereo_pick.yaml
	$(CLEAN_ENV) $(BIN)/stereo-pick parameters > docs/parameters.md
	$(CLEAN_ENV) $(BIN)/stereo-pick parameters --format yaml > config/stereo_pick.yaml

lock: setup ## bring requirements.lock up to date: one lock for Python 3.10 to 3.13
	$(UV) pip compile setup.py --extra wheels --extra bouguet --extra test --extra dev --universal \
		--python-version 3.10 --generate-hashes --no-emit-index-url --no-emit-find-links --no-annotate \
		--custom-compile-command "make lock" --upgrade --quiet --output-file requirements.lock

clean: ## remove everything that make made
	rm -rf .venv build install log demo_output *.egg-info .mypy_cache .ruff_cache .pytest_cache .hypothesis
	find . -name __pycache__ -prune -exec rm -rf {} +

# uv comes first, out of the lock by its hashes; where it has no wheel or fails, pip does its work.
.venv/lock.stamp: requirements.lock
	$(CLEAN_ENV) $(PYTHON) -m venv --clear .venv
	awk '/^[a-z]/ {uv = /^uv==/} uv' $< > .venv/uv.txt
	awk '/^[a-z]/ {uv = /^uv==/} !uv' $< > .venv/all.txt
	$(PIP) install --quiet --require-hashes --only-binary :all: -r .venv/uv.txt \
		&& $(UV) pip install --quiet --require-hashes -r $< \
		|| $(PIP) install --quiet --require-hashes -r .venv/all.txt
	touch $@

.venv/package.stamp: .venv/lock.stamp setup.py setup.cfg stereo_pick/__init__.py
	$(UV) pip install --quiet $(EDITABLE) || $(PIP) install --quiet $(EDITABLE)
	touch $@
