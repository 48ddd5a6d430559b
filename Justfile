# `just` lists the recipes; `just check` is what CI runs.
default:
    @just --list

# everything CI runs
check:
    bash .ci/run

test *ARGS:
    .venv/bin/python -m pytest {{ARGS}}

# whole studies and coverage of bounds, which the tests leave out
test-long *ARGS:
    .venv/bin/python -m pytest -n auto -m long {{ARGS}}

lint:
    .venv/bin/ruff check . && .venv/bin/ruff format --check . && .venv/bin/mypy && .venv/bin/lint-imports

# changed inputs by the thousand: just fuzz --count 5000 --seed 2
fuzz *ARGS:
    .venv/bin/python tests/fuzz.py {{ARGS}}

# timings against the budgets
bench:
    .venv/bin/python -m pytest benchmarks --benchmark-enable --benchmark-only

# the committed sample reports
samples:
    .venv/bin/python reports/make_samples.py

# the documentation, as docs/_build/html/index.html: just docs [--clean]
docs *ARGS:
    .venv/bin/python docs/build.py {{ARGS}}

# outputs of every command against tests/frozen: just frozen [WORD...] [--update] [--keep FOLDER]
frozen *ARGS:
    .venv/bin/python tests/frozen.py {{ARGS}}
