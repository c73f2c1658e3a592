#!/bin/sh
# Make a virtual environment with the suite and its tested dependencies; does nothing when the
# environment is up to date. Needs Python 3.11 or 3.12, a network and 3 GB (7 GB with
# a CUDA build of PyTorch); no root, no system packages, nothing outside the checkout.
#   sh scripts/bootstrap.sh .venv        PYTHON=python3.12 names the interpreter
set -eu
unset PYTHONPATH PYTHONHOME
cd "$(dirname "$0")/.."
venv="${1:-.venv}"
python="${PYTHON:-python3}"
# The folder is part of the stamp: an environment that was copied or moved points elsewhere.
stamp="$PWD $(cat pyproject.toml constraints.txt scripts/bootstrap.sh | cksum)"

if [ -x "$venv/bin/python" ] && [ "$(cat "$venv/installed" 2>/dev/null)" = "$stamp" ]; then
    exit 0
fi

fail() {
    for line in "$@"; do echo "$line" >&2; done
    exit 4
}

command -v "$python" >/dev/null 2>&1 ||
    fail "No '$python' here: lcrl_bench needs Python 3.11 or 3.12. Name one: make PYTHON=/path/to/python3.11 ..."
"$python" -c 'import sys; sys.exit(not (3, 11) <= sys.version_info[:2] < (3, 13))' ||
    fail "lcrl_bench needs Python 3.11 or 3.12; '$python' is $("$python" -V 2>&1)." \
        "Name another one: make PYTHON=python3.12 ..."

# Debian's python3 comes without ensurepip, but pip, virtualenv or uv may be there instead.
create() {
    rm -rf "$venv"
    "$python" -m venv "$venv" >/dev/null 2>&1 && return
    rm -rf "$venv"
    "$python" -m venv --without-pip "$venv" >/dev/null 2>&1 &&
        "$python" -m pip --python "$venv/bin/python" install --quiet --ignore-installed pip 2>/dev/null && return
    rm -rf "$venv"
    "$python" -m virtualenv --quiet "$venv" 2>/dev/null && return
    uv venv --quiet --seed --python "$python" "$venv" 2>/dev/null && return
    rm -rf "$venv"
    fail "'$python' can't make a virtual environment: it has no ensurepip, pip or virtualenv." \
        "On Debian and Ubuntu: apt-get install python3-venv. Without root: any other Python 3.11" \
        "or 3.12 (python.org, conda, uv), named by: make PYTHON=/path/to/python ..."
}

"$venv/bin/python" -m pip --version >/dev/null 2>&1 || create
rm -f "$venv/installed"
quiet=--quiet
[ -t 2 ] && quiet=
echo "Installing lcrl_bench and its dependencies into $venv: minutes the first time." >&2
"$venv/bin/python" -m pip install $quiet --disable-pip-version-check --no-warn-script-location \
    --constraint constraints.txt --editable '.[dev]' ||
    fail "pip could not install the dependencies (its message is above). With the network back," \
        "the same command goes on where it stopped."
echo "$stamp" >"$venv/installed"
