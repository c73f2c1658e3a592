#!/bin/sh
# Make a virtual environment with the suite and its tested dependencies; safe to run again.
# Needs Python 3.11 or 3.12 with venv (or pip) and a network; no root, no system packages.
set -eu
venv="$1"
python="${PYTHON:-python3}"

"$python" -c 'import sys; sys.exit(not (3, 11) <= sys.version_info[:2] < (3, 13))' || {
    echo "lcrl_bench needs Python 3.11 or 3.12; '$python' is $("$python" -V 2>&1)." >&2
    echo "Name another one: make PYTHON=python3.12 ..." >&2
    exit 4
}
[ -x "$venv/bin/python" ] || "$python" -m venv "$venv" 2>/dev/null || {
    # Debian's python3 without python3-venv has no ensurepip, but may have pip.
    rm -rf "$venv"
    "$python" -m venv --without-pip "$venv"
    "$python" -m pip --python "$venv/bin/python" install --quiet pip || {
        echo "Neither venv's ensurepip nor pip is there for '$python'." >&2
        echo "Install python3-venv or python3-pip, or use a Python from python.org or conda." >&2
        exit 4
    }
}
"$venv/bin/python" -m pip install --disable-pip-version-check --quiet \
    --constraint constraints.txt --editable '.[dev]'
touch "$venv/installed"
