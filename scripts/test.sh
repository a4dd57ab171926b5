#!/usr/bin/env bash
# Build everything and run every test: catkin's (gtest, rostest) and pytest's. The last line counts them.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
# shellcheck source=scripts/build.sh
source "$root/scripts/build.sh"

case "${1:-}" in
  "") ;;
  --quick) export KR3_QUICK_TESTS=1 ;;
  --help)
    say "Usage: ./kr3 test [--quick]: set-up, build, all tests; --quick leaves the whole missions of tests/ out"
    exit 0
    ;;
  *) fail "test: unknown option '$1'" ;;
esac

build_workspace
enter_workspace
results="$workspace/build/test_results"
rm -rf "$results"
mkdir -p "$results"

cd "$workspace"
export CCACHE_BASEDIR="$root" CCACHE_NOHASHDIR=1
run_logged "Building the tests" "$logs/build-tests.log" catkin_make tests -j"${KR3_JOBS:-2}" || fail "the tests do not build"
status=0
# One test at a time: several simulators side by side would only test the scheduler.
run_logged "Running catkin's tests" "$logs/run-tests.log" catkin_make run_tests -j1 || status=$?
catkin_test_results "$results" > "$logs/test-results.log" 2>&1 || status=$?

cd "$root"
python_tests=(tests/repository)
for folder in src/*/test; do
  if compgen -G "$folder/test_*.py" > /dev/null; then
    python_tests+=("$folder")
  fi
done
run_logged "Running Python's tests" "$logs/pytest.log" /usr/bin/python3 -m pytest -q -p no:cacheprovider \
  --junitxml="$results/python/pytest.xml" "${python_tests[@]}" || status=$?

/usr/bin/python3 "$root/scripts/test_summary.py" "$results" || status=$?
exit "$status"
