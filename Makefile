PYTHON ?= python3
VENV ?= .venv
BIN := $(VENV)/bin

.PHONY: demo install test-install test sim check lint bounds docs validate experiments
install: ; $(PYTHON) -m venv $(VENV) && $(BIN)/pip install -q .
demo: install ; $(BIN)/melt run ice_cube_small -o ice_cube_small.vtkhdf --overwrite && $(BIN)/melt render ice_cube_small.vtkhdf -o ice_cube_small.png --frame 9
test-install: ; $(PYTHON) -m venv $(VENV) && $(BIN)/pip install -q -e '.[test,toolchain]'
test: test-install ; NUMBA_NUM_THREADS=$${NUMBA_NUM_THREADS:-2} OMP_WAIT_POLICY=passive $(BIN)/python -m pytest
sim: ; NUMBA_ENABLE_CUDASIM=1 $(BIN)/python -m pytest tests/harness -k simulat
bounds: ; NUMBA_BOUNDSCHECK=1 MELT_PARALLEL=0 $(BIN)/python -m pytest tests/stages
check: ; $(BIN)/melt check
lint: ; $(BIN)/ruff check . && $(BIN)/python -m pytest tests/laws
docs: ; $(BIN)/python -m melt.docs
validate: ; $(BIN)/python -m experiments
experiments: validate
