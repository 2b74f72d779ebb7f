# make generate and make test need no other set-up. Both create .venv on their first run: the former installs the
# packages that codewheel needs, the latter also those of the extra 'test'.
PYTHON ?= python3
CC ?= cc
CXX ?= c++
# On Windows, make comes with Git's shell, and an environment keeps its programs in Scripts.
ifeq ($(OS),Windows_NT)
PY = .venv/Scripts/python
else
PY = .venv/bin/python
endif
AXE = axe-playwright-python==0.1.8
export CC CXX

.PHONY: generate lint quick quick-outputs quick-tests-1 quick-tests-2 test verify bench bench-python bench-tool mutants check schema spec-page rules-page words-page site release clean

generate: .venv/.installed
	@$(PY) -m codewheel generate

# The format of the Python files, and the linter's rules in pyproject.toml.
# .venv/bin/ruff format fixes the format, and .venv/bin/ruff check --fix some findings of the linter.
lint: .venv/.tested
	@$(PY) -m ruff format --check --quiet --output-format concise .
	@$(PY) -m ruff check --quiet --output-format concise .
	@report=$$(PYTHONPATH=runtime/python $(dir $(PY))lint-imports --no-cache) || { echo "$$report" | sed -n '/^Broken/,$$p'; exit 1; }

# Everything that a change of wording or of a rule needs, in less than a minute: all tests except the slow ones.
# Compiled tests are kept even if the environment forbids it, because compiling takes a third of the time.
quick: export PYTHONDONTWRITEBYTECODE =
quick: lint
	@$(MAKE) --no-print-directory --jobs=3 quick-outputs quick-tests-1 quick-tests-2

quick-outputs: .venv/.tested
	@$(PY) -m mypy --no-error-summary generator runtime/python/codewheel_runtime
	@said=$$($(PY) -m codewheel generate --check) || { echo "$$said"; exit 1; }

# Two processes, each of which collects only its own tests, take less time than the workers of one.
QUICK_1 = tests/generator tests/docs tests/masters

quick-tests-1: .venv/.tested
	@$(PY) -m pytest -m 'not slow' $(QUICK_1)

quick-tests-2: .venv/.tested
	@$(PY) -m pytest -m 'not slow' tests $(addprefix --ignore=,$(QUICK_1))

# TESTS selects files.
test: .venv/.tested tools
	@$(PY) -m pytest -rs -n auto --dist worksteal $(TESTS)

# The longer evidence, and the cases that make test leaves out. make verify-proof, for example, runs only
# tests/verify/test_proof.py, and make verify-cases_c the further cases about C.
verify: .venv/.tested tools bench-packages engines axe
	@$(PY) -m pytest -rs -n auto --dist worksteal -o addopts=-q -m exhaustive tests

CASES_c = tests/c tests/browser tests/rust
CASES_python = tests/python tests/virtual
CASES_tool = tests $(addprefix --ignore=,tests/verify $(CASES_c) $(CASES_python))

verify-cases_%: .venv/.tested tools
	@$(PY) -m pytest -rs -n auto --dist worksteal -o addopts=-q -m exhaustive $(CASES_$*)

verify-%: .venv/.tested tools
	@$(PY) -m pytest -rs -n auto --dist worksteal -o addopts=-q tests/verify/test_$*.py

# The Python package has several such files.
verify-python: .venv/.tested tools
	@$(PY) -m pytest -rs -n auto --dist worksteal -o addopts=-q tests/verify/test_python_*.py

verify-footprint: bench-packages

verify-stream: engines

verify-site: axe

# Size and speed of the C headers next to hand-written decoders and other generators. BENCH=--write also writes docs/trust/footprint.md.
bench: .venv/.tested tools bench-packages
	@$(PY) benchmarks/footprint.py $(BENCH)
	@$(PY) benchmarks/around.py $(BENCH)

# The Python package for one frame and for a million, next to hand-written code and installable peers.
bench-python: .venv/.tested
	@$(PY) -m pip install --quiet --disable-pip-version-check bitstruct 'cantools>=41' construct kaitaistruct || echo "make: some peers cannot be installed and are left out"
	@$(PY) benchmarks/python_speed.py

# The command line as a multiple of a Python program that does nothing, next to other tools. TOOL=--rounds=3 is quicker.
bench-tool: .venv/.tested
	@$(PY) -m pip install --quiet --disable-pip-version-check 'cantools>=41' 'nunavut>=3.0' peakrdl || echo "make: some peers cannot be installed and are left out"
	@$(PY) benchmarks/tool_speed.py $(TOOL)

# Planted mistakes of a transcriber that pass check, by class of fact. MUTANTS=--write also writes docs/trust/mutants.md.
mutants: .venv/.tested
	@$(PY) benchmarks/mutants.py $(MUTANTS)

check: .venv/.installed
	@$(PY) -m codewheel check specs

rules-page: .venv/.installed
	@$(PY) docs/site/rules_page.py

# The pages as a static site in build/site, to be opened as files or put on any server. With the address of the server,
# it also has a sitemap: make site BASE=https://…
site: .venv/.tested
	@SITE_BASE='$(BASE)' $(PY) docs/site/build_site.py

# Wheels, sdists and archives of a release in build/release, each of them checked. Publishes nothing.
release: .venv/.tested
	@sh .ci/release

# The parts of the spec language that are described by classes, in the JSON Schema.
schema: .venv/.installed
	@$(PY) -m codewheel.language.schemas

spec-page: schema
	@$(PY) -m codewheel.language.language_page docs/transcribe

# The words that were added to the language, from the specs and the history.
words-page: .venv/.installed
	@$(PY) docs/site/words_page.py

# CI sets CODEWHEEL_LOCKED. Then the packages of .ci/requirements.txt are present, and no others are installed.
.PHONY: bench-packages
bench-packages: .venv/.tested
	@[ -n "$$CODEWHEEL_LOCKED" ] || $(PY) -m pip install --quiet --disable-pip-version-check --editable '.[bench]' || echo "make: the packages of the extra 'bench' cannot be installed, so the footprint is not shown"

.PHONY: engines
engines: .venv/.tested
	@[ -n "$$CODEWHEEL_LOCKED" ] || $(PY) -m pip install --quiet --disable-pip-version-check --editable '.[engines]' || echo "make: the packages of the extra 'engines' cannot be installed, so Dask and DuckDB are left out"

# The script only, without the browser that the package would install.
.PHONY: axe
axe: .venv/.tested
	@[ -d build/axe ] || $(PY) -m pip install --quiet --disable-pip-version-check --no-deps --target build/axe '$(AXE)' || echo "make: axe-core cannot be installed, so the site is not checked with it"

# The newest packages that pyproject.toml allows, for CI, with their hashes. Needs uv (pip install uv).
LOCK = uv pip compile --quiet --generate-hashes --no-annotate --no-header --python-version 3.11 --python-platform linux --upgrade
.PHONY: lock
lock:
	@echo 'setuptools>=77' | $(LOCK) --extra test --extra bench --extra engines --no-emit-package codewheel pyproject.toml - -o .ci/requirements.txt
	@echo '$(AXE)' | $(LOCK) --no-deps - -o .ci/axe.txt

.PHONY: tools
tools:
	@command -v $(firstword $(CC)) >/dev/null 2>&1 || { echo "make: no C compiler '$(CC)'; install one (Debian: apt-get install gcc) or set CC" >&2; exit 1; }
	@command -v $(firstword $(CXX)) >/dev/null 2>&1 || { echo "make: no C++ compiler '$(CXX)'; install one (Debian: apt-get install g++) or set CXX" >&2; exit 1; }
	@mkdir -p build
	@printf '#include <stdio.h>\nint main(void) { return puts("") < 0; }\n' | $(CC) -x c - -o build/it || { echo "make: '$(CC)' cannot compile and link a program; install the C library (Debian: apt-get install libc6-dev) or set CC" >&2; exit 1; }
	@printf '#include <cstdio>\nint main() { return std::puts("") < 0; }\n' | $(CXX) -x c++ - -o build/it || { echo "make: '$(CXX)' cannot compile and link a program; install the C++ library (Debian: apt-get install g++) or set CXX" >&2; exit 1; }
	@rm -f build/it

.venv/.installed: pyproject.toml
	@command -v $(PYTHON) >/dev/null 2>&1 || { echo "make: no '$(PYTHON)'; install Python 3.10 or newer (Debian: apt-get install python3) or set PYTHON" >&2; exit 1; }
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 10))' || { echo "make: '$(PYTHON)' is older than Python 3.10; install a newer one or set PYTHON" >&2; exit 1; }
	@$(PYTHON) -c 'import venv, ensurepip' 2>/dev/null || { echo "make: '$(PYTHON)' has no venv module; install it (Debian: apt-get install python3-venv)" >&2; exit 1; }
	@echo "setting up .venv"
	@$(PYTHON) -m venv .venv
	@$(PY) -m pip install --quiet --disable-pip-version-check --editable .
	@touch $@

.venv/.tested: .venv/.installed
	@echo "installing the packages for the tests"
	@$(PY) -m pip install --quiet --disable-pip-version-check --editable '.[test]'
	@touch $@

clean:
	rm -rf .venv build generator/codewheel.egg-info codewheel.egg-info
