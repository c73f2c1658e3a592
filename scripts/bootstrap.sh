#!/bin/sh
# Make a virtual environment with the suite and its tested dependencies, or bring one up to date;
# does nothing when there is nothing to do. Needs Python 3.11 to 3.14 and a network; no root, no
# system packages, nothing outside the checkout. Sizes and minutes are in README.md.
#   sh scripts/bootstrap.sh [VENV [EXTRA]]    EXTRA: `fast`, all that a run needs; `dev` (the
#                                             default), also what tests, lint and types need
#   PYTHON=python3.12 names the interpreter; otherwise the first usable one on the PATH is taken.
set -eu
unset PYTHONPATH PYTHONHOME
cd "$(dirname "$0")/.."
venv="${1:-.venv}"
extra="${2:-dev}"
versions="3.14 3.13 3.12 3.11"
needs="lcrl_bench needs Python 3.11 to 3.14"

fail() {
    echo "$1" >&2
    exit 4
}

# Such as 3.12; 3.14t for a build without the interpreter's lock, for which few wheels are made.
# Fails where nothing can be run: pyenv's shims are on the PATH for versions that it does not have.
version_of() {
    "$1" -c 'import sys; print("%d.%d" % sys.version_info[:2] + sys.abiflags)' 2>/dev/null
}

# What an environment was made from. With the folder in it, one that was copied or moved is made
# again; with the interpreter in it, so is one whose interpreter was replaced by a newer one.
stamp() {
    echo "$PWD $(version_of "$venv/bin/python") $(cat pyproject.toml constraints.txt scripts/bootstrap.sh | cksum) $1"
}

# Debian's python3 comes without ensurepip, but pip, virtualenv or uv may be there instead.
create() {
    rm -rf "$venv"
    "$1" -m venv "$venv" >/dev/null 2>&1 && return
    rm -rf "$venv"
    "$1" -m venv --without-pip "$venv" >/dev/null 2>&1 &&
        "$1" -m pip --python "$venv/bin/python" install --quiet --ignore-installed pip 2>/dev/null && return
    rm -rf "$venv"
    "$1" -m virtualenv --quiet "$venv" 2>/dev/null && return
    uv venv --quiet --seed --python "$1" "$venv" 2>/dev/null && return
    rm -rf "$venv"
    return 1
}

supported() {
    case " $versions " in *" $1 "*) ;; *) return 1 ;; esac
}

# With the first interpreter that has a supported version and can make an environment.
create_with_any() {
    seen="" unable=""
    for python in "$@"; do
        version="$(version_of "$python")" || continue
        if ! supported "$version"; then
            seen="$seen, $python is $version"
        elif create "$python"; then
            return
        else
            unable="${unable:-$python}"
        fi
    done
    [ -z "$unable" ] ||
        fail "'$unable' can't make a virtual environment: apt-get install python3-venv on Debian and Ubuntu, or name another Python (python.org, conda, uv): make PYTHON=/path/to/python ..."
    fail "$needs; ${seen:+found${seen#,}: }install one (apt, python.org, conda, uv), or name it: make PYTHON=/path/to/python ..."
}

# With a terminal pip draws its own bars. Elsewhere a line every ten seconds says that it goes on.
install() {
    set -- "$venv/bin/python" -m pip install --disable-pip-version-check \
        --no-warn-script-location --constraint constraints.txt --editable ".[$extra]"
    if [ -t 2 ]; then
        "$@"
        return
    fi
    "$@" --quiet &
    pip=$!
    # A background process of a script does not hear Ctrl-C.
    trap 'kill "$pip" 2>/dev/null; exit 130' HUP INT TERM
    seconds=0
    while kill -0 "$pip" 2>/dev/null; do
        sleep 1
        seconds=$((seconds + 1))
        [ $((seconds % 10)) -ne 0 ] || echo "  still installing, $seconds s" >&2
    done
    wait "$pip"
}

# Whether the environment that is there has a supported version, and the one that was asked for.
fits() {
    version="$(version_of "$venv/bin/python")" && supported "$version" || return 1
    [ -z "${PYTHON:-}" ] || [ "$(version_of "$PYTHON")" = "$version" ]
}

if fits; then
    case "$(cat "$venv/installed" 2>/dev/null)" in
        "$(stamp "$extra")" | "$(stamp dev)") exit 0 ;;
    esac
fi
if ! fits || ! "$venv/bin/python" -m pip --version >/dev/null 2>&1; then
    if [ -e "$venv" ] && [ ! -e "$venv/pyvenv.cfg" ] && [ -n "$(ls -A "$venv")" ]; then
        fail "'$venv' is no virtual environment, so it is left as it is: name another folder, make VENV=.venv ..."
    fi
    if [ -n "${PYTHON:-}" ]; then
        create_with_any "$PYTHON"
    else
        create_with_any python3 $(printf 'python%s ' $versions)
    fi
fi
rm -f "$venv/installed"
echo "Installing lcrl_bench and its dependencies into $venv: minutes the first time." >&2
install ||
    fail "pip could not install the dependencies (its message is above). With the network back, the same command goes on where it stopped."
stamp "$extra" >"$venv/installed"
