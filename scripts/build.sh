#!/usr/bin/env bash
# Build the workspace. When no file changed since the last build it ends at once.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
# shellcheck source=scripts/setup.sh
source "$root/scripts/setup.sh"

# build_workspace [--force | --nodes]: set-up, then catkin_make where something changed; --nodes: only what the robot runs.
build_workspace() {
  local sources part=all targets=()
  if [ "${1:-}" = --nodes ]; then
    part=nodes
    targets=(kr3_nodes)
  fi
  set_up
  "$root/scripts/link_packages.sh"
  sources=$(fingerprint src tests third_party scripts/build.sh)
  if [ "${1:-}" != --force ] && [ "$(built_from "$part")" = "$sources" ]; then
    return
  fi
  rm -f "$(stamp_of all)" "$(stamp_of nodes)"
  run_logged "Building the workspace" "$logs/build.log" catkin_build "${targets[@]}" || fail "the build failed"
  printf '%s\n' "$sources" > "$(stamp_of "$part")"
}

# catkin_build [TARGET...]: line tables are enough for backtraces; more debugging information is a quarter of the time.
catkin_build() {
  cd "$workspace"
  export CCACHE_BASEDIR="$root" CCACHE_NOHASHDIR=1
  exec catkin_make "$@" -j"${KR3_JOBS:-2}" -DPYTHON_EXECUTABLE=/usr/bin/python3 -DCMAKE_BUILD_TYPE=RelWithDebInfo \
    -DCMAKE_CXX_FLAGS_RELWITHDEBINFO="-O2 -g1 -DNDEBUG" \
    -DKR3_WERROR=ON -DCMAKE_CXX_COMPILER_LAUNCHER=ccache -DClingo_DIR="$(clingo_prefix)/lib/cmake/Clingo"
}

if [ "${BASH_SOURCE[0]}" = "$0" ]; then
  case "${1:-}" in
    "" | --force)
      build_workspace "$@"
      say "the workspace is built"
      ;;
    --help) say "Usage: ./kr3 build [--force]: set-up, then catkin_make; --force: also when nothing changed" ;;
    *) fail "build: unknown option '$1'" ;;
  esac
fi
