# Everything from a bare checkout: needs Python 3.11 or later, git and make; each target sets up what it needs.
PYTHON ?= python3
WORKERS ?= 2
DEMO_SEED ?= 0
BIN := .venv/bin
STAMP := .venv/.installed
TRAINING := .venv/.training

# Our matrices are small: BLAS threads only wait for each other where both cores are busy.
export OPENBLAS_NUM_THREADS := 1
export OMP_NUM_THREADS := 1
export MKL_NUM_THREADS := 1

.PHONY: setup training demo test test-all check docs figures notebooks format clean interop exam packages

setup: $(STAMP)

$(STAMP): requirements.lock pyproject.toml exam/pyproject.toml
	@$(PYTHON) -c 'import sys; v = sys.version_info[:3]; sys.exit(v < (3, 11) and f"workbench needs Python 3.11 or later; {sys.executable} is {v[0]}.{v[1]}: set PYTHON=")'
	@echo "installing what requirements.lock lists into .venv: once, some minutes, 2.4 GB on disk"
	test -x $(BIN)/python || $(PYTHON) -m venv .venv
	$(BIN)/python -m pip install --disable-pip-version-check -r requirements.lock
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation -e . -e exam
	@touch $@

training: $(TRAINING)

$(TRAINING): $(STAMP) requirements-training.lock requirements-ray.lock
	@echo "installing torch, ray, rerun and what trains into .venv: once, some minutes, 2 GB on disk and more with CUDA"
	$(BIN)/python -m pip install --disable-pip-version-check -r requirements.lock -r requirements-training.lock -r requirements-ray.lock
	@touch $@

demo: setup
	$(BIN)/workbench demo demo --seed $(DEMO_SEED) --force

# The core: what pins physics and behaviour in minutes and needs requirements.lock alone (tests/kept_for_all.py).
test: setup
	$(BIN)/pytest --core -n $(WORKERS) --dist worksteal $(PYTEST_ARGS)

# Everything, as CI runs it.
test-all: training
	$(BIN)/pytest -n $(WORKERS) --dist worksteal $(PYTEST_ARGS)

check: training
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/lint-imports --no-logo
	$(BIN)/pyright

# The pages as a site in build/site; it opens from disk and asks nothing of the network. Not quietly:
# what is not said is no warning to --strict.
docs: setup
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --strict

# What the documentation states, made anew, and what changed. ALL=1: what takes hours too; ONLY="ladder exam": some;
# DATA=: folder of the measured data; WRITE=1: into the pages.
figures: training
	$(BIN)/python analyses/figures.py $(if $(ALL),--all) $(if $(ONLY),--only $(ONLY)) $(if $(DATA),--data $(DATA)) $(if $(WRITE),--write)

# The notebooks run anew, with what they show.
notebooks: setup
	$(BIN)/python analyses/run_notebooks.py

# Files of `normalize --for` in the simulators that read them, one environment each. MUJOCO3=: which MuJoCo 3.
MUJOCO3 ?= 3.3.1
interop: setup
	test -x build/interop/mujoco3/bin/python || $(PYTHON) -m venv build/interop/mujoco3
	build/interop/mujoco3/bin/python -m pip install --quiet --disable-pip-version-check mujoco==$(MUJOCO3) numpy
	$(BIN)/python benchmarks/interop.py mujoco3 --python build/interop/mujoco3/bin/python

# Solvers through the first CASES of the exam, from nothing: an environment of its own, cases, answers, a table.
# SOLVER="a.py b.py": several in one table; SOLVER=all: every baseline. One that fails in some cases is marked all the same.
SOLVER ?= exam/baselines/least_squares_bic.py
CASES ?= 24
BASELINES := nothing least_squares_bic least_squares_aic sparse network symbolic closed_loop sysid
SOLVERS := $(if $(filter all,$(SOLVER)),$(BASELINES:%=exam/baselines/%.py),$(SOLVER))
COMMA := ,
LIBRARIES := $(if $(filter sparse network symbolic closed_loop sysid,$(basename $(notdir $(SOLVERS)))),$(COMMA)baselines)
LOCKS := -c requirements.lock -c requirements-training.lock -c exam/requirements-baselines.lock
ANSWERS := build/exam/answers-$(CASES)
exam:
	test -x build/exam/bin/python || $(PYTHON) -m venv build/exam
	build/exam/bin/python -m pip install --quiet --disable-pip-version-check $(LOCKS) './exam[plants$(LIBRARIES)]' mujoco
	build/exam/bin/python -m workbench_exam make build/exam/cases-$(CASES) --count $(CASES) --jobs $(WORKERS)
	for solver in $(SOLVERS); do build/exam/bin/python -m workbench_exam run $$solver build/exam/cases-$(CASES) -o $(ANSWERS)/$$(basename $$solver .py); done || true
	build/exam/bin/python -m workbench_exam score build/exam/cases-$(CASES) $(addprefix $(ANSWERS)/,$(basename $(notdir $(SOLVERS))))

# The package without a clone: wheel and sdist in an empty environment of each Python that this machine has.
packages: setup
	$(BIN)/python .ci/packages.py

format: setup
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .

clean:
	rm -rf .venv demo build dist
