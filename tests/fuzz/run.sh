#!/usr/bin/env bash
# run.sh BUILD [SECONDS]: each fuzz target of BUILD (preset `fuzz`) for so many seconds, from the seeds alone.
# Exit status: 0 nothing found; 1 something, kept in BUILD/found; 77 there are no targets.
set -u
build=$1 seconds=${2:-6}
[ -x "$build/tests/fuzz/fuzz_seeds" ] || exit 77
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
found=$build/found corpus=$build/corpus failed=0
rm -rf "$corpus" && mkdir -p "$found" "$corpus" && "$build/tests/fuzz/fuzz_seeds" "$corpus" || exit 1
for target in "$build"/tests/fuzz/fuzz_*; do
  format=${target##*/fuzz_}
  [ -d "$corpus/$format" ] || continue
  log=$build/fuzz_$format.log
  # Files that were found before come first: they must stay repaired.
  mapfile -t old < <(find "$found" -name "$format-*")
  if { [ ${#old[@]} -eq 0 ] || "$target" "${old[@]}" >"$log" 2>&1; } &&
    "$target" -seed=1 -max_total_time="$seconds" -timeout=10 -rss_limit_mb=2048 -max_len=4096 -print_final_stats=1 \
      -dict="$here/words.dict" -artifact_prefix="$found/$format-" "$corpus/$format" >"$log" 2>&1; then
    echo "$format: $(sed -n 's/^stat::number_of_executed_units: *//p' "$log") files, nothing found"
  else
    failed=1
    tail -40 "$log"
    echo "$format: FAILED; the file is in $found, the log in $log"
  fi
done
exit $failed
