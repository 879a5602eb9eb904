#!/bin/sh
# bench/run.sh where nothing is set up and nothing may be installed: a hint, status 2, and no folder left behind.
root=$(cd "$(dirname "$0")/../.." && pwd)
copy=$(mktemp -d) || exit 1
trap 'rm -rf "$copy"' EXIT
(cd "$root" && tar cf - bench/run.sh bench/*/task.hpp bench/report/requirements.txt scripts/setup.sh packages.txt) |
  tar xf - -C "$copy" || exit 1
told=$("$copy/bench/run.sh" --no-install --profile smoke --out "$copy/results/mine" 2>&1)
status=$?
fail() { echo "$1; it told: $told" >&2; exit 1; }
[ "$status" -eq 2 ] || fail "status $status, not 2"
case $told in *"pip install -r bench/report/requirements.txt"*) ;; *) fail "no hint how to make .venv" ;; esac
[ ! -e "$copy/results" ] || fail "left a folder for results"
