#!/usr/bin/env bash
# Build everything and run every test: catkin's (gtest, rostest) and pytest's. The last line counts them.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
# shellcheck source=scripts/lib.sh
source "$root/scripts/lib.sh"

if [ "${1:-}" = --help ]; then
  say "Usage: ./kr3 test [--quick]: set-up, build, all tests; --quick leaves the whole missions of tests/ out."
  exit 0
fi

"$root/scripts/build.sh"
enter_workspace
results="$workspace/build/test_results"
rm -rf "$results"
mkdir -p "$results"
cd "$workspace"

run_logged "Building the tests" "$logs/build-tests.log" catkin_make tests -j"${KR3_JOBS:-2}" || fail "the tests do not build"

target=run_tests
if [ "${1:-}" = --quick ]; then
  export KR3_QUICK_TESTS=1
fi
status=0
# One test at a time: several simulators side by side would only test the scheduler.
run_logged "Running catkin's tests" "$logs/run-tests.log" catkin_make "$target" -j1 || status=$?

cd "$root"
python_tests=(tests/repository)
for folder in src/*/test; do
  compgen -G "$folder/test_*.py" > /dev/null && python_tests+=("$folder")
done
run_logged "Running Python's tests" "$logs/pytest.log" /usr/bin/python3 -m pytest -q -p no:cacheprovider \
  --junitxml="$results/python/pytest.xml" "${python_tests[@]}" || status=$?

/usr/bin/python3 "$root/scripts/test_summary.py" "$results" || status=$?
exit "$status"
