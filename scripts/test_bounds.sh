#!/bin/sh
# Run the tests with the oldest or the newest releases that pyproject.toml allows, instead of those
# that constraints.txt pins. Needs uv (pip install uv), a network, and Python 3.11 to 3.14.
#   sh scripts/test_bounds.sh oldest|newest [PYTEST WORDS]
# `newest` takes MuJoCo 4, for which there is no dm_control yet.
set -eu
unset PYTHONPATH PYTHONHOME
cd "$(dirname "$0")/.."
bound="${1:-}"
case "$bound" in
    oldest) resolution=lowest-direct ;;
    newest) resolution=highest ;;
    *)
        echo "usage: sh scripts/test_bounds.sh oldest|newest [PYTEST WORDS]" >&2
        exit 2
        ;;
esac
shift
venv=".venv.$bound"
uv venv --quiet --clear ${PYTHON:+--python "$PYTHON"} "$venv"
export VIRTUAL_ENV="$PWD/$venv"
uv pip install --quiet --resolution "$resolution" --editable ".[dev]"
if [ "$bound" = newest ]; then
    uv pip uninstall --quiet dm-control
    uv pip install --quiet --upgrade "mujoco>=4,<5"
fi
uv pip list
export OMP_NUM_THREADS=1
exec "$venv/bin/python" -m pytest -n logical --maxprocesses 8 "$@"
