#!/usr/bin/env bash
# The main job: sets up what is missing, builds, measures every task, and ends with an HTML report.
set -u
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)

usage() {
  cat <<'EOF'
bench/run.sh [--profile smoke|quick|full] [--task T]... [--out DIR] [--resume] [--no-install]

  --profile P    smoke: every cell once, tiny; quick (default): minutes; full: hours
  --task T       only this task (brdf_integral, closest_point, distance_field, inside, knn, knn_dynamic, knn_nd, light_transport, ray, region_average, shadow); may be repeated
  --out DIR      folder for rows, pictures and report; default results/<profile>-<date>-<time>
  --resume       continue the run in --out (default: the newest of this profile) where it stopped
  --no-install   install nothing
Exit status: 0 all as expected; 1 a method of ours failed a cell; 2 unusable arguments or machine.
EOF
}

profile=quick out= resume=0 install=1 tasks=()
need() { [ $# -ge 2 ] && [ -n "$2" ] || { echo "run.sh: $1 needs a value" >&2; exit 2; }; }
while [ $# -gt 0 ]; do
  case $1 in
    --profile) need "$@"; profile=$2; shift 2 ;;
    --task) need "$@"; tasks+=("$2"); shift 2 ;;
    --out) need "$@"; out=$2; shift 2 ;;
    --resume) resume=1; shift ;;
    --no-install) install=0; shift ;;
    -h | --help) usage; exit 0 ;;
    *) echo "run.sh: unknown argument '$1'" >&2; usage >&2; exit 2 ;;
  esac
done
case $profile in smoke | quick | full) ;; *)
  echo "run.sh: --profile is '$profile'; it must be smoke, quick or full" >&2
  exit 2
  ;;
esac
known=()
for folder in "$root"/bench/*/task.hpp; do
  name=$(basename "$(dirname "$folder")")
  [ "$name" = core ] || known+=("$name")
done
for task in ${tasks[@]+"${tasks[@]}"}; do
  case " ${known[*]} " in *" $task "*) ;; *)
    echo "run.sh: unknown task '$task'; known: ${known[*]}" >&2
    exit 2
    ;;
  esac
done
[ ${#tasks[@]} -gt 0 ] || tasks=("${known[@]}")
mapfile -t tasks < <(printf '%s\n' "${tasks[@]}" | awk '!seen[$0]++')  # one that was named twice runs once

if [ -z "$out" ]; then
  if [ $resume -eq 1 ]; then
    out=$(find "$root/results" -maxdepth 1 -type d -name "$profile-*" 2>/dev/null | sort | tail -n 1)
    [ -n "$out" ] || { echo "run.sh: --resume: no earlier $profile run in results/" >&2; exit 2; }
  else
    out=$root/results/$profile-$(date +%Y%m%d-%H%M%S)
  fi
fi
if [ $resume -eq 0 ] && [ -n "$(find "$out" -name '*.jsonl' -print -quit 2>/dev/null)" ]; then
  echo "run.sh: $out already holds results; pass --resume to continue them, or another --out" >&2
  exit 2
fi
# shellcheck source=scripts/setup.sh
. "$root/scripts/setup.sh"
ensure_packages
ensure_python
build_preset release "${tasks[@]/#/bench_}" treeline_gen treeline_render
mkdir -p "$out" || exit 2  # only now: what could not be set up leaves no empty folder
out=$(cd "$out" && pwd)

status=0
worst() { [ "$1" -gt "$status" ] && status=$1; }
started=$(date +%s)
flags=()
[ $resume -eq 1 ] && flags=(--resume)
program() { printf '%s/build/release/bench/bench_%s' "$root" "$1"; }

# What is timed has the machine to itself.
for task in "${tasks[@]}"; do
  say "Task $task: measuring ($profile)"
  "$(program "$task")" --profile "$profile" --rows "$out/$task.jsonl" ${flags[@]+"${flags[@]}"} >"$out/$task.log"
  code=$?
  [ $code -eq 2 ] && { cat "$out/$task.log" >&2; fail 2 "bench_$task could not run"; }
  [ $code -gt 2 ] && fail 1 "bench_$task was ended (status $code); continue with --resume --out $out"
  worst $code
  if "$(program "$task")" --list --profile "$profile" | grep -q '^scaling'; then
    say "Task $task: threads"
    "$(program "$task")" --scaling --profile "$profile" --rows "$out/$task.threads.jsonl" ${flags[@]+"${flags[@]}"} \
      >"$out/$task.threads.log"
    worst $?
  fi
done

# What is not, hard cases and pictures, shares it: one job a core, and one more, as some wait for a peer's time
# to run out.
# Steps of hard cases take milliseconds; those that hang must not cost the quick profile much of its time.
limit=20
[ "$profile" = quick ] && limit=10
hard_cases() {
  "$(program "$1")" --stress --stress-seconds $limit --rows "$out/$1.stress.jsonl" ${flags[@]+"${flags[@]}"} \
    >"$out/$1.stress.log"
}
draw_pictures() {
  "$(program "$1")" --profile "$profile" --pictures "$out/pictures/$1" >"$out/$1.pictures.log"
}
codes=$(mktemp) || exit 2
trap 'rm -f "$codes"' EXIT
trap 'trap "" TERM; kill -TERM 0; exit 130' INT  # jobs in the background do not hear an interrupt
say "Hard cases and pictures: $(($(nproc) + 1)) at a time"
for job in hard_cases draw_pictures; do
  for task in "${tasks[@]}"; do
    while [ "$(jobs -rp | wc -l)" -gt "$(nproc)" ]; do wait -n; done
    { "$job" "$task" 2> >(sed -u "s/^/$task, ${job#*_}: /" >&2); echo $? >>"$codes"; } &
  done
done
wait
while read -r code; do worst "$code"; done <"$codes"

say "Report"
pictures=()
for task in "${tasks[@]}"; do
  [ -f "$out/pictures/$task/pictures.jsonl" ] && pictures+=(--pictures "$out/pictures/$task")
done
"$root/.venv/bin/python" "$root/bench/report/report.py" "$out"/*.jsonl ${pictures[@]+"${pictures[@]}"} \
  --out "$out/report.html" --winners || fail 2 "the report could not be made; the rows are in $out"
printf '\nRows:   %s\nReport: %s\nTime:   %s s after the build\n' "$out" "$out/report.html" $(($(date +%s) - started))
[ $status -eq 1 ] && echo "A method of ours failed a cell: look for 'wrong', 'crashed' or 'timeout' in the report." >&2
exit "$status"
