#!/usr/bin/env bash
# Feed the parser with random bytes, built with clang, libFuzzer, ASan and UBSan. What it finds is left in the work folder.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
# shellcheck source=scripts/setup.sh
source "$root/scripts/setup.sh"

usage="Usage: ./kr3 fuzz parser [--runs N] [--seconds S] [--merge]
  --runs N      how many inputs (1000000)
  --seconds S   end after S seconds at the latest (no limit)
  --merge       then add what reaches new code to the corpus in src/kr3_reasoner/test/corpus/parser
clang comes from Debian and is installed when it is missing; the ordinary set-up does without it."

packages=(clang-14 libclang-rt-14-dev libfuzzer-14-dev)
reasoner="$root/src/kr3_reasoner"
work="$workspace/fuzz"
runs=1000000
seconds=0
merge=no

case "${1:-}" in
  parser) shift ;;
  --help)
    say "$usage"
    exit 0
    ;;
  *) fail "fuzz: unknown target '${1:-}'; the one there is: parser" ;;
esac
while [ $# -gt 0 ]; do
  case "$1" in
    --runs | --seconds)
      [[ "${2:-}" =~ ^[0-9]+$ ]] || fail "fuzz: $1 needs a number"
      [ "$1" = --runs ] && runs=$2 || seconds=$2
      shift 2
      ;;
    --merge)
      merge=yes
      shift
      ;;
    *) fail "fuzz: unknown option '$1'" ;;
  esac
done

set_up
if ! dpkg-query -W "${packages[@]}" > /dev/null 2>&1; then
  install_packages "${packages[@]}"
fi
build_fuzzer() {
  CC=clang-14 CXX=clang++-14 cmake -S "$reasoner/test/fuzz" -B "$work/build" \
    -DClingo_DIR="$(clingo_prefix)/lib/cmake/Clingo"
  cmake --build "$work/build" -j "${KR3_JOBS:-2}"
}
run_logged "Building the fuzzer" "$logs/fuzz-build.log" build_fuzzer || fail "the fuzzer does not build"

mkdir -p "$work/corpus" "$work/found"
fuzzer=("$work/build/parser_fuzzer" -dict="$reasoner/test/fuzz/parser.dict" -max_len=400 -timeout=10
  -rss_limit_mb=3000)
say "$runs inputs (log: ${logs#"$root"/}/fuzz.log; what is found: ${work#"$root"/}/found)"
if ! "${fuzzer[@]}" -artifact_prefix="$work/found/" -runs="$runs" -max_total_time="$seconds" -print_final_stats=1 \
  "$work/corpus" "$reasoner/test/corpus/parser" > "$logs/fuzz.log" 2>&1; then
  tail -n 40 "$logs/fuzz.log" >&2
  fail "the parser failed on an input in ${work#"$root"/}/found"
fi
grep '^stat::' "$logs/fuzz.log"
if [ "$merge" = yes ]; then
  "${fuzzer[@]}" -merge=1 -use_counters=0 "$reasoner/test/corpus/parser" "$work/corpus" > "$logs/fuzz-merge.log" 2>&1
fi
say "no input failed"
