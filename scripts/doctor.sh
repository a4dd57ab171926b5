#!/usr/bin/env bash
# Look at the machine and say what would not work; scripts/doctor.sh needs nothing but a shell.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
# shellcheck source=scripts/lib.sh
source "$root/scripts/lib.sh"

status=0
good() { say "  ok    $*"; }
warn() {
  say "  WARN  $*"
  status=1
}

system=$(. /etc/os-release 2> /dev/null && printf '%s %s' "${ID:-}" "${VERSION_ID:-}" || true)
if [ "$system" = "debian 12" ]; then good "Debian 12"; else warn "this is '$system'; KR3 is made for Debian 12"; fi

free_mb=$(($(df -Pk "$root" | awk 'NR == 2 { print $4 }') / 1024))
if [ "$free_mb" -ge 6144 ]; then
  good "$free_mb MB free"
elif is_built nodes && [ "$free_mb" -ge 1024 ]; then
  good "$free_mb MB free, enough to run what is built"
else
  warn "$free_mb MB free: set-up and build need 6 GB"
fi

memory_mb=$(($(awk '/^MemTotal/ { print $2 }' /proc/meminfo) / 1024))
if [ "$memory_mb" -ge 3500 ]; then good "$memory_mb MB of memory"; else warn "$memory_mb MB of memory: building needs 4 GB"; fi

mapfile -t missing < <(missing_packages)
if [ "${#missing[@]}" -eq 0 ]; then
  good "all Debian packages are installed"
else
  warn "missing Debian packages (./kr3 setup installs them): ${missing[*]}"
fi

if [ -f "$(clingo_prefix)/.complete" ]; then
  good "clingo $(clingo_version)"
else
  warn "clingo $(clingo_version) is not built yet (./kr3 setup builds it)"
fi

if is_built nodes; then
  good "the workspace is built"
  enter_workspace
  rosrun kr3_experiments kr3_cli doctor || status=1
else
  warn "the workspace is not built yet (./kr3 build)"
fi
exit "$status"
