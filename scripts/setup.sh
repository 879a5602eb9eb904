# Sourced by bench/run.sh and tests/run.sh: brings a machine to the point where a preset is built.
# Expects $root (the repository) and $install (1, or 0 for --no-install).
# shellcheck shell=bash

say() { printf '\033[1m%s\033[0m\n' "$*" >&2; }
fail() {
  printf '%s: %s\n' "${0##*/}" "$2" >&2
  exit "$1"
}

packages_came=0

# Installs the packages of packages.txt that are missing; exit status 2 where that is not allowed.
ensure_packages() {
  local wanted missing=()
  mapfile -t wanted < <(grep -Ev '^[[:space:]]*(#|$)' "$root/packages.txt")
  command -v dpkg-query >/dev/null || {
    say "No dpkg on this system: assuming that the packages of packages.txt, or their like, are there."
    return
  }
  local installed
  installed=$(dpkg-query -W -f '${db:Status-Status} ${Package}\n' 2>/dev/null | sed -n 's/^installed //p')
  local package
  for package in "${wanted[@]}"; do
    grep -qxF "$package" <<<"$installed" || missing+=("$package")
  done
  [ ${#missing[@]} -eq 0 ] && return

  local line="apt-get install -y --no-install-recommends ${missing[*]}"
  if [ "$install" -eq 0 ]; then
    say "Missing packages, and --no-install was given; peers among them will be 'not_built'. To install them:"
    say "  sudo apt-get update && sudo $line"
    return
  fi
  local become=()
  if [ "$(id -u)" -ne 0 ]; then
    if command -v sudo >/dev/null && { sudo -n true 2>/dev/null || [ -t 0 ]; }; then
      become=(sudo)
    else
      say "These packages are missing, and neither root nor sudo is at hand. Install them with:"
      say "  apt-get update && $line"
      exit 2
    fi
  fi
  say "Installing ${#missing[@]} packages: ${missing[*]}"
  "${become[@]}" env DEBIAN_FRONTEND=noninteractive apt-get update -q >&2 || fail 2 "apt-get update failed"
  # shellcheck disable=SC2086
  "${become[@]}" env DEBIAN_FRONTEND=noninteractive $line >&2 || fail 2 "installing packages failed: $line"
  packages_came=1
}

# The Python environment of the report, made anew whenever its requirements change.
ensure_python() {
  local venv=$root/.venv requirements=$root/bench/report/requirements.txt
  if cmp -s "$requirements" "$venv/requirements.installed"; then return; fi
  if [ "$install" -eq 0 ]; then
    say "The report needs a Python environment in .venv, and --no-install was given. To make it:"
    say "  python3 -m venv .venv && .venv/bin/pip install -r bench/report/requirements.txt"
    say "  cp bench/report/requirements.txt .venv/requirements.installed"
    fail 2 "no Python environment in .venv$([ -d "$venv" ] && echo " of these requirements")"
  fi
  say "Making the Python environment in .venv"
  if [ -L "$venv" ] && [ ! -e "$venv" ]; then rm "$venv"; fi  # a link that leads nowhere
  python3 -m venv "$venv" || fail 2 "python3 -m venv failed"
  "$venv/bin/pip" install --quiet --disable-pip-version-check -r "$requirements" >&2 || fail 2 "pip install failed"
  cp "$requirements" "$venv/requirements.installed"
}

# build_preset PRESET [TARGET...]: configures if needed and builds; output only where something happens or fails.
build_preset() {
  local preset=$1 build=$root/build/$1
  shift
  local log=$root/build/$preset.configure.log
  mkdir -p "$root/build"
  # Anew after packages came, too: peers among them are no longer absent.
  if [ ! -f "$build/build.ninja" ] || [ "$packages_came" -eq 1 ] || [ "$root/packages.txt" -nt "$build/build.ninja" ]; then
    say "Configuring preset $preset"
    (cd "$root" && cmake --preset "$preset") >"$log" 2>&1 || {
      cat "$log" >&2
      fail 2 "configuring failed"
    }
    grep -E 'is not built|is left out|are not read|is not read|is absent' "$log" >&2 || true
  fi
  local targets=()
  [ $# -gt 0 ] && targets=(--target "$@")
  (cd "$root" && cmake --build "build/$preset" "${targets[@]}") >&2 || fail 2 "building failed"
}
