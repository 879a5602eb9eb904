#!/usr/bin/env bash
# Sets up what is missing, builds everything and runs the tests.
set -u
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)

usage() {
  cat <<'EOF'
tests/run.sh [--preset P] [--no-install] [CTest arguments]

  --preset P     release (default), portable, debug, asan or tsan
  --no-install   install nothing
Anything else goes to CTest, e.g.  -R knn  or  --rerun-failed.
Exit status: 0 all tests passed; 2 unusable arguments or machine; else CTest's.
EOF
}

preset=release install=1 arguments=()
while [ $# -gt 0 ]; do
  case $1 in
    --preset)
      [ $# -ge 2 ] || { echo "run.sh: --preset needs a value" >&2; exit 2; }
      preset=$2
      shift 2
      ;;
    --no-install) install=0; shift ;;
    -h | --help) usage; exit 0 ;;
    *) arguments+=("$1"); shift ;;
  esac
done
case $preset in release | portable | debug | asan | tsan) ;; *)
  echo "run.sh: --preset is '$preset'; it must be release, portable, debug, asan or tsan" >&2
  exit 2
  ;;
esac

# shellcheck source=scripts/setup.sh
. "$root/scripts/setup.sh"
ensure_packages
ensure_python
build_preset "$preset"
# The readers' fuzz targets, by clang; without it the test `fuzz` is skipped.
if command -v clang++ >/dev/null; then build_preset fuzz fuzz_all; fi
cd "$root/build/$preset" || exit 2
# One more than there are cores: some tests wait for a peer's time to run out.
exec ctest --output-on-failure --no-tests=error -j "$(($(nproc) + 1))" ${arguments[@]+"${arguments[@]}"}
