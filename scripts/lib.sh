# What the shell scripts of KR3 share. Sourced with `root` set to the repository.
# shellcheck shell=bash disable=SC2154

# The first python3 on a user's PATH may have no ROS, and another ROS workspace must not leak into ours.
export PATH="/usr/bin:/bin:$PATH"
unset CMAKE_PREFIX_PATH ROS_PACKAGE_PATH PYTHONPATH PYTHONHOME LD_LIBRARY_PATH ROS_MASTER_URI
# roscpp listens on every interface unless told otherwise.
export ROS_IP="${ROS_IP:-127.0.0.1}"
export PYTHONDONTWRITEBYTECODE=1

workspace="$root/catkin_ws"
logs="$workspace/log"

say() { printf '%s\n' "$*"; }

fail() {
  printf 'kr3: %s\n' "$*" >&2
  exit 1
}

clingo_version() { sed -n 's/^version=//p' "$root/third_party/clingo.lock"; }
clingo_prefix() { printf '%s/kr3/clingo-%s\n' "${XDG_CACHE_HOME:-$HOME/.cache}" "$(clingo_version)"; }

# Names of third_party/debian-packages.txt that are not installed, one a line.
missing_packages() {
  local wanted installed
  wanted=$(grep -vE '^\s*(#|$)' "$root/third_party/debian-packages.txt" | LC_ALL=C sort -u)
  # shellcheck disable=SC2086
  installed=$(dpkg-query -W -f '${Package} ${db:Status-Status}\n' $wanted 2> /dev/null |
    awk '$2 == "installed" { print $1 }' | LC_ALL=C sort -u || true)
  LC_ALL=C comm -23 <(printf '%s\n' "$wanted") <(printf '%s\n' "$installed")
}

# What was built is noted in two files: of all, or of the nodes alone.
stamp_of() { printf '%s/build/.kr3_built_%s\n' "$workspace" "$1"; }

# built_from all|nodes: the fingerprint of the sources that this part was built from, or nothing.
built_from() {
  local stamp
  stamp=$(stamp_of all)
  [ "$1" = all ] || [ -f "$stamp" ] || stamp=$(stamp_of "$1")
  cat "$stamp" 2> /dev/null || true
}

# is_built all|nodes
is_built() { [ -n "$(built_from "$1")" ]; }

# require_workspace all|nodes
require_workspace() {
  is_built "$1" || fail "the workspace is not built yet: run ./kr3 build"
}

# run_logged TITLE LOG COMMAND...: the output goes to LOG; the terminal gets one line that counts the seconds and, where
# the command prints one, shows its percentage. The end of the log is shown when the command fails. The command runs in a
# process group of its own, which is ended when this shell is asked to end, however that is.
run_logged() {
  local title=$1 log=$2 started=$SECONDS ticker command status=0
  shift 2
  mkdir -p "$(dirname "$log")"
  : > "$log"
  say "$title (log: ${log#"$root"/})"
  tick "$log" &
  ticker=$!
  set -m
  "$@" > "$log" 2>&1 < /dev/null &
  command=$!
  set +m
  # shellcheck disable=SC2064
  trap "stop_logged $command $ticker 130" INT
  # shellcheck disable=SC2064
  trap "stop_logged $command $ticker 143" TERM HUP
  wait "$command" || status=$?
  trap - INT TERM HUP
  kill "$ticker" 2> /dev/null || true
  wait "$ticker" 2> /dev/null || true
  [ ! -t 1 ] || printf '\r\033[K'
  if [ "$status" -ne 0 ]; then
    {
      printf -- '---- end of %s\n' "$log"
      tail -n 40 "$log"
      printf -- '----\n'
    } >&2
    return "$status"
  fi
  say "  done in $((SECONDS - started)) s"
}

# stop_logged COMMAND TICKER CODE: end the command's group, the hard way when it does not obey, and exit with CODE.
stop_logged() {
  local patience=50
  trap '' INT TERM HUP
  kill "$2" 2> /dev/null || true
  kill -TERM -- "-$1" 2> /dev/null || true
  while kill -0 -- "-$1" 2> /dev/null; do
    patience=$((patience - 1))
    [ "$patience" -gt 0 ] || kill -KILL -- "-$1" 2> /dev/null || true
    sleep 0.1
  done
  printf '\nkr3: interrupted\n' >&2
  exit "$3"
}

# The ticker of run_logged: rewrites one line on a terminal, prints a line every 30 s elsewhere.
tick() {
  local log=$1 started=$SECONDS percent text
  trap 'exit 0' TERM
  while :; do
    percent=$(tail -n 20 "$log" 2> /dev/null | grep -o '^\[ *[0-9]*%\]' | tail -n 1 | tr -d '[] ' || true)
    text="  $((SECONDS - started)) s ${percent:+, $percent}"
    if [ -t 1 ]; then
      printf '\r\033[K%s' "$text"
      sleep 1 &
    else
      [ "$SECONDS" -eq "$started" ] || say "$text"
      sleep 30 &
    fi
    wait $! || true
  done
}

# Fingerprint of the names, sizes and times of the files below the given paths, without what no build reads.
fingerprint() {
  (cd "$root" && find -L "$@" \( -name __pycache__ -o -name .pytest_cache \) -prune -o \
    -type f ! -name '*.md' ! -name '*.rst' -printf '%p %s %T@\n' | LC_ALL=C sort | sha256sum | cut -d' ' -f1)
}

# Source the workspace's environment; its scripts read variables that may be unset.
enter_workspace() {
  set +u
  # shellcheck source=/dev/null
  source "$workspace/devel/setup.bash"
  set -u
  export KR3_ROOT="$root"
}

run_in_workspace() {
  enter_workspace
  exec rosrun kr3_experiments kr3_cli "$@"
}
