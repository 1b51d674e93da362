# `make search` runs the default problem on a fresh machine, `make test` passes the tests: both set up
# everything they need in .venv. Needed beforehand: Python 3.11 or later, make, git.

PYTHON ?= $(shell command -v python3.11 || command -v python3)
VENV ?= .venv
BIN := $(VENV)/bin
PROBLEM ?= problems/icub_lifting.toml
RUN ?=
EVALUATIONS ?=
EXTRAS ?= test,check
JOBS ?= 2
KILLS ?= 1000
MINUTES ?= 10
FOLDER ?=
# two more at a time than cores: tests wait for a third of their time
PYTEST := $(BIN)/python -m pytest -n $(shell expr $(JOBS) + 2) --dist worksteal
QUICK := tests/analysis tests/body tests/conformance/test_searches.py tests/design tests/golden tests/human tests/runlog \
	tests/searches tests/test_evolve.py tests/tree
PIP := $(BIN)/python -m pip install --no-compile --quiet --disable-pip-version-check --constraint constraints.txt

# bytecode is kept, wherever one works, and away from the sources: tests start hundreds of processes
export PYTHONPYCACHEPREFIX = $(abspath $(VENV))/bytecode
unexport PYTHONDONTWRITEBYTECODE

export OMP_NUM_THREADS = 1

.PHONY: help install search test test-quick test-all test-bare check bench faults fuzz robot api docs clean

help:  ## what can be made
	@sed -n 's/^\([a-z-]*\):.*## */  make \1\t/p' $(MAKEFILE_LIST) | expand --tabs=20

$(VENV)/installed: pyproject.toml constraints.txt
	$(PYTHON) -m venv $(VENV)
	$(PIP) --editable .
	@touch $@

# at once: to find out which packages fit takes pip half of its time
$(VENV)/installed-dev: pyproject.toml constraints.txt
	$(PYTHON) -m venv $(VENV)
	$(PIP) --editable '.[$(EXTRAS)]'
	@touch $(VENV)/installed $@

$(VENV)/installed-robots: $(VENV)/installed-dev
	$(PIP) --editable '.[robots]'
	$(PIP) --no-deps robosuite  # for one robot's files: nothing of it runs
	@touch $@

$(VENV)/installed-docs: $(VENV)/installed
	$(PIP) --editable '.[docs]'
	@touch $@

install: $(VENV)/installed  ## the virtual environment with evodesign in it

search: $(VENV)/installed  ## search the default problem (PROBLEM=, RUN=, EVALUATIONS=, JOBS=)
	$(BIN)/evodesign search $(PROBLEM) --jobs $(JOBS) $(if $(RUN),--run $(RUN)) \
		$(if $(EVALUATIONS),--evaluations $(EVALUATIONS))

test: $(VENV)/installed-dev  ## the tests, but for the slow ones
	$(PYTEST) -m 'not slow'

test-quick: $(VENV)/installed-dev  ## the tests that take no minute, for every save
	$(PYTEST) -m 'not slow and not prepared' $(QUICK)

test-all: $(VENV)/installed-robots  ## every test (700 MB of public robots are installed for them)
	$(PYTEST)

test-bare:  ## what the tests make of a machine without a browser and a C compiler
	.ci/bare-machine

check: $(VENV)/installed-dev  ## format, lint, types, import contracts
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/lint-imports

bench: $(VENV)/installed-robots  ## measured ratios, written to benchmarks/results
	$(BIN)/python benchmarks/search_quality.py
	$(BIN)/python -m benchmarks.catalogue_quality --population 24
	$(BIN)/python benchmarks/evolution_vs_gradient.py
	$(BIN)/python -m benchmarks.inner_speed
	$(BIN)/python -m benchmarks.inner_quality
	$(BIN)/python -m benchmarks.paper_formulation
	$(BIN)/python benchmarks/gradients.py
	$(BIN)/python -m benchmarks.many_cases
	$(BIN)/python -m benchmarks.disturbed_growth
	$(BIN)/python -m benchmarks.disturbed_ranking
	$(BIN)/python benchmarks/idle_share.py
	$(BIN)/python benchmarks/overhead.py
	$(BIN)/python -m benchmarks.public_robots
	$(BIN)/python -m benchmarks.averaging
	$(BIN)/python -m benchmarks.native_solver
	$(BIN)/python -m benchmarks.lift_speed
	$(BIN)/python -m benchmarks.lift_quality
	$(BIN)/python -m benchmarks.lift_ranking
	$(BIN)/python -m benchmarks.lift_bodies
	$(BIN)/python -m benchmarks.lift_gradients
	$(BIN)/python -m benchmarks.least_time
	$(BIN)/python -m benchmarks.lift_backs
	$(BIN)/python -m benchmarks.measured_people
	$(BIN)/python -m benchmarks.simulation

faults: $(VENV)/installed-dev  ## kill searches and commands 1,000 times, damage logs (KILLS=, FOLDER= to go on)
	$(BIN)/python -m tests.faults.campaign --kills $(KILLS) $(if $(FOLDER),--folder $(FOLDER))

fuzz: $(VENV)/installed-dev  ## segments, problems, robots and designs spoilt by grammar, for MINUTES=10
	$(BIN)/python -m tests.fuzz.fuzzer --minutes $(MINUTES)

robot: $(VENV)/installed  ## write problems/robots/icub_shapes.urdf from its table
	$(BIN)/python problems/robots/write_icub.py

api: $(VENV)/installed  ## write docs/api.md from the docstrings
	$(BIN)/python -m docs.write_api

docs: $(VENV)/installed-docs  ## the documentation as a site, in build/site
	$(BIN)/sphinx-build -W --keep-going -q -c docs . build/site

clean:  ## remove the virtual environment and caches
	rm -rf $(VENV) build .mypy_cache .ruff_cache .pytest_cache .hypothesis .import_linter_cache
