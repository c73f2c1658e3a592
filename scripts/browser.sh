#!/bin/sh
# Chromium for the leaderboard's tests, where it can be had without asking: as root, with apt.
# Anywhere else nothing is done, and the tests that need a browser are skipped with the reason.
# LCRL_CHROMIUM names another browser of its kind.
set -u
for name in "${LCRL_CHROMIUM:-chromium}" chromium-browser google-chrome google-chrome-stable chrome; do
    if command -v "$name" > /dev/null; then
        exit 0
    fi
done
if [ "$(id -u)" != 0 ] || ! command -v apt-get > /dev/null; then
    echo "browser: none here, and no root with apt to install one: its tests will be skipped"
    exit 0
fi
export DEBIAN_FRONTEND=noninteractive
timeout 300 sh -c "apt-get update -qq && apt-get install -y -qq --no-install-recommends chromium" \
    > /dev/null 2>&1 || echo "browser: apt can't install chromium: its tests will be skipped"
exit 0
