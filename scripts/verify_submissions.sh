#!/usr/bin/env bash
# Verify the rows that a proposal adds or changes, with the suite as it is without the proposal.
#   scripts/verify_submissions.sh BASE PROPOSED OUT [flags of `leaderboard verify`]
# BASE and PROPOSED are checkouts; OUT gets the rows' *.verified.json and recordings. Nothing of
# PROPOSED is run: its submissions are read, and its checkpoints loaded by methods of BASE.
# LCRL_BENCH names the program, by default BASE/.venv/bin/lcrl-bench.
set -euo pipefail
base="$1" proposed="$2" out="$3"
shift 3
program="${LCRL_BENCH:-$base/.venv/bin/lcrl-bench}"
rows=leaderboard/submissions

if [ ! -d "$proposed/$rows" ]; then
    echo "no $rows in the proposal"
    exit 0
fi
files=()
while IFS= read -r -d '' file; do
    name="$(basename "$file")"
    if cmp -s "$file" "$base/$rows/$name"; then
        continue
    fi
    if [[ "$name" == *.verified.json ]]; then
        printf 'refused: %q says what a verification found: only who runs one may\n' "$name"
        exit 1
    fi
    files+=("$file")
done < <(find "$proposed/$rows" -maxdepth 1 -name '*.json' -print0 | sort -z)
if [ "${#files[@]}" = 0 ]; then
    echo "no row is added or changed"
    exit 0
fi
mkdir -p "$out"
status=0
"$program" leaderboard verify "${files[@]}" --recordings "$out/recordings" "$@" || status=$?
find "$proposed/$rows" -maxdepth 1 -name '*.verified.json' -newer "$out" -exec cp -t "$out" {} +
exit "$status"
