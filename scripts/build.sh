#!/usr/bin/env bash
# Build the workspace. When no file changed since the last build it ends at once.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
# shellcheck source=scripts/lib.sh
source "$root/scripts/lib.sh"

if [ "${1:-}" = --help ]; then
  say "Usage: ./kr3 build [--force]: set-up, then catkin_make; --force also when nothing changed. KR3_JOBS: jobs (2)."
  exit 0
fi

"$root/scripts/setup.sh"
"$root/scripts/link_packages.sh"

sources=$(fingerprint src tests third_party scripts/build.sh)
if [ "${1:-}" != --force ] && [ "$(cat "$workspace/build/.kr3_built" 2> /dev/null)" = "$sources" ]; then
  exit 0
fi

rm -f "$workspace/build/.kr3_built"
export CCACHE_BASEDIR="$root" CCACHE_NOHASHDIR=1
cd "$workspace"
run_logged "Building the workspace" "$logs/build.log" \
  catkin_make -j"${KR3_JOBS:-2}" -DPYTHON_EXECUTABLE=/usr/bin/python3 -DCMAKE_BUILD_TYPE=RelWithDebInfo \
  -DKR3_WERROR=ON -DCMAKE_CXX_COMPILER_LAUNCHER=ccache -DClingo_DIR="$(clingo_prefix)/lib/cmake/Clingo" ||
  fail "the build failed"
printf '%s\n' "$sources" > "$workspace/build/.kr3_built"
