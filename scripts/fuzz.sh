#!/usr/bin/env bash
# Feed the reasoner's parser or the POMDP readers with random bytes, built with clang, libFuzzer, ASan and UBSan. What it
# finds is left in the work folder.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
# shellcheck source=scripts/setup.sh
source "$root/scripts/setup.sh"

usage="Usage: ./kr3 fuzz parser|pomdp [--runs N] [--seconds S] [--merge]
  parser        the reasoner's parser of descriptions, histories and goals
  pomdp         the readers of POMDP models, policies and bundles
  --runs N      how many inputs (1000000)
  --seconds S   end after S seconds at the latest (no limit)
  --merge       then add what reaches new code to the target's corpus in the sources
clang comes from Debian and is installed when it is missing; the ordinary set-up does without it."

packages=(clang-14 libclang-rt-14-dev libfuzzer-14-dev)
runs=1000000
seconds=0
merge=no

case "${1:-}" in
  parser)
    package="$root/src/kr3_reasoner"
    corpus="$package/test/corpus/parser"
    max_len=400
    ;;
  pomdp)
    package="$root/src/kr3_pomdp"
    corpus="$package/test/corpus/readers"
    max_len=4000
    ;;
  --help)
    say "$usage"
    exit 0
    ;;
  *) fail "fuzz: unknown target '${1:-}'; those there are: parser, pomdp" ;;
esac
target=$1
work="$workspace/fuzz/$target"
log="$logs/fuzz-$target"
shift
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
  CC=clang-14 CXX=clang++-14 cmake -S "$package/test/fuzz" -B "$work/build" \
    -DClingo_DIR="$(clingo_prefix)/lib/cmake/Clingo" --no-warn-unused-cli
  cmake --build "$work/build" -j "${KR3_JOBS:-2}"
}
run_logged "Building the fuzzer" "$log-build.log" build_fuzzer || fail "the fuzzer does not build"

mkdir -p "$work/corpus" "$work/found"
fuzzer=("$work/build/${target}_fuzzer" -dict="$package/test/fuzz/$target.dict" -max_len="$max_len" -timeout=10
  -rss_limit_mb=3000)
say "$runs inputs (log: ${log#"$root"/}.log; what is found: ${work#"$root"/}/found)"
if ! "${fuzzer[@]}" -artifact_prefix="$work/found/" -runs="$runs" -max_total_time="$seconds" -print_final_stats=1 \
  "$work/corpus" "$corpus" > "$log.log" 2>&1; then
  tail -n 40 "$log.log" >&2
  fail "an input failed, see ${work#"$root"/}/found"
fi
grep '^stat::' "$log.log"
if [ "$merge" = yes ]; then
  "${fuzzer[@]}" -merge=1 -use_counters=0 "$corpus" "$work/corpus" > "$log-merge.log" 2>&1
fi
say "no input failed"
