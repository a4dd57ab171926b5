#!/usr/bin/env bash
# Install what is missing: Debian packages by name, clingo from its source distribution. Does nothing when all is there.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
# shellcheck source=scripts/lib.sh
source "$root/scripts/lib.sh"

needed_gb=6

check_system() {
  local id="" version=""
  if [ -r /etc/os-release ]; then
    id=$(. /etc/os-release && printf '%s' "${ID:-}")
    version=$(. /etc/os-release && printf '%s' "${VERSION_ID:-}")
  fi
  if [ "$id $version" != "debian 12" ] && [ -z "${KR3_ANY_SYSTEM:-}" ]; then
    fail "this is '${id:-unknown} ${version:-}', and KR3 is made for Debian 12 (KR3_ANY_SYSTEM=1 tries all the same)"
  fi
}

check_disk() {
  local free_kb
  free_kb=$(df -Pk "$root" | awk 'NR == 2 { print $4 }')
  if [ "$free_kb" -lt $((needed_gb * 1024 * 1024)) ]; then
    fail "only $((free_kb / 1024)) MB are free below $root; set-up and build need $needed_gb GB"
  fi
}

install_packages() {
  local as_root=()
  if [ "$(id -u)" -ne 0 ]; then
    command -v sudo > /dev/null || fail "these packages are missing, and neither root nor sudo is at hand: $*
  as root: apt-get install --no-install-recommends $*"
    as_root=(sudo -n)
    sudo -v || fail "sudo was refused; as root: apt-get install --no-install-recommends $*"
  fi
  local apt=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -q -o DPkg::Lock::Timeout=300 -o Acquire::Retries=3)
  run_logged "Reading Debian's package lists" "$logs/apt-update.log" \
    "${apt[@]}" -o APT::Update::Error-Mode=any update ||
    fail "Debian's package lists could not be read: is the network there, are the sources in /etc/apt right?"
  run_logged "Installing $# Debian packages" "$logs/apt-install.log" \
    "${apt[@]}" install -y --no-install-recommends "$@" ||
    fail "apt-get could not install the packages (see the log above)"
}

set_up() {
  local missing=() prefix
  check_system
  mapfile -t missing < <(missing_packages)
  prefix=$(clingo_prefix)
  if [ "${#missing[@]}" -eq 0 ] && [ -f "$prefix/.complete" ]; then
    return
  fi
  check_disk
  if [ "${#missing[@]}" -gt 0 ]; then
    install_packages "${missing[@]}"
  fi
  if [ ! -f "$prefix/.complete" ]; then
    run_logged "Building clingo $(clingo_version), once" "$logs/clingo.log" "$root/scripts/build_clingo.sh" "$prefix" ||
      fail "clingo could not be built: is PyPI within reach? (see the log above)"
  fi
}

if [ "${BASH_SOURCE[0]}" = "$0" ]; then
  case "${1:-}" in
    "")
      set_up
      say "everything is installed"
      ;;
    --help) say "Usage: ./kr3 setup: install what third_party/debian-packages.txt names and is missing, and clingo" ;;
    *) fail "setup: unknown option '$1'" ;;
  esac
fi
