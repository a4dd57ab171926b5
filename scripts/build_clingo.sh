#!/usr/bin/env bash
# Build the pinned clingo library from its PyPI source distribution, once, into a cache outside the build folder.
# Usage: build_clingo.sh PREFIX
set -euo pipefail

prefix=$1
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
# shellcheck source=/dev/null
source <(grep -E '^(version|sha256)=' "$here/../third_party/clingo.lock")

if [ -f "$prefix/.complete" ]; then
  exit 0
fi
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
echo "clingo $version: downloading the source distribution"
(cd "$work" && /usr/bin/python3 -m pip download "clingo==$version" --no-binary clingo --no-deps --quiet)
archive="$work/clingo-$version.tar.gz"
if ! echo "$sha256  $archive" | sha256sum --check --status; then
  echo "clingo $version: expected SHA-256 $sha256, found $(sha256sum "$archive" | cut -d' ' -f1)" >&2
  exit 1
fi
tar -xzf "$archive" -C "$work"
echo "clingo $version: building (about four CPU minutes, once)"
cmake -S "$work/clingo-$version" -B "$work/build" -DCMAKE_BUILD_TYPE=Release -DCMAKE_INSTALL_PREFIX="$prefix" \
  -DCLINGO_BUILD_APPS=OFF -DCLINGO_BUILD_WITH_PYTHON=OFF -DCLINGO_BUILD_WITH_LUA=OFF -DCLINGO_BUILD_SHARED=ON \
  -DCMAKE_INSTALL_LIBDIR=lib > "$work/log" 2>&1 || { tail -n 40 "$work/log" >&2; exit 1; }
cmake --build "$work/build" --target install -j "${KR3_JOBS:-2}" >> "$work/log" 2>&1 || { tail -n 40 "$work/log" >&2; exit 1; }
touch "$prefix/.complete"
