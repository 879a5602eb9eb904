#!/bin/sh
# Runs a Python test of the report in the virtual environment that tests/run.sh makes. Without it the test is skipped
# (exit status 77), unless CI is set: there it must not go missing.
root=$(cd "$(dirname "$0")/../.." && pwd)
python=$root/.venv/bin/python
if [ ! -x "$python" ]; then
  echo "$python is absent; tests/run.sh makes it from bench/report/requirements.txt" >&2
  [ -n "$CI" ] && exit 1
  exit 77
fi
cd "$root" && exec "$python" -B -m unittest -v "tests/bench/$1"
