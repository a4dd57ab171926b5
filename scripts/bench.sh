#!/usr/bin/env bash
# Measure a part of KR3 against its goals: bench.sh {reasoner | pomdp | coupling | robot | experiments} [--quick] [--json FILE]
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
# shellcheck source=scripts/build.sh
source "$root/scripts/build.sh"

part=${1:-}
[ $# -gt 0 ] && shift
case "$part" in
  reasoner)
    case " $* " in *" --help "* | *" -h "*) ;; *) build_workspace ;; esac
    enter_workspace
    exec /usr/bin/python3 -B "$root/src/kr3_reasoner/bench/bench_reasoner.py" \
      --binary "$workspace/devel/lib/kr3_reasoner/reasoner_bench" "$@"
    ;;
  pomdp)
    case " $* " in *" --help "* | *" -h "*) ;; *) build_workspace ;; esac
    enter_workspace
    exec /usr/bin/python3 -B "$root/src/kr3_pomdp/bench/bench_pomdp.py" --programs "$workspace/devel/lib/kr3_pomdp" "$@"
    ;;
  coupling)
    case " $* " in *" --help "* | *" -h "*) ;; *) build_workspace ;; esac
    enter_workspace
    exec /usr/bin/python3 -B "$root/src/kr3_executive/bench/bench_coupling.py" --programs "$workspace/devel/lib" "$@"
    ;;
  robot)
    case " $* " in *" --help "* | *" -h "*) ;; *) build_workspace ;; esac
    enter_workspace
    exec /usr/bin/python3 -B "$root/src/kr3_experiments/bench/bench_robot.py" --programs "$workspace/devel/lib" "$@"
    ;;
  experiments)
    case " $* " in *" --help "* | *" -h "*) ;; *) build_workspace ;; esac
    run_in_workspace bench_experiments "$@"
    ;;
  *)
    fail "unknown benchmark '$part', expected: reasoner, pomdp, coupling, robot or experiments"
    ;;
esac
