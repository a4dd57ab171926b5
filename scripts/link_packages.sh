#!/usr/bin/env bash
# Make catkin_ws/src hold one relative symlink per package: those of src/, and tests/ as kr3_integration_tests.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
links="$root/catkin_ws/src"
mkdir -p "$links"
for package in "$root"/src/*/package.xml; do
  name=$(basename "$(dirname "$package")")
  [ -L "$links/$name" ] || ln -s "../../src/$name" "$links/$name"
done
if [ -f "$root/tests/package.xml" ] && [ ! -L "$links/kr3_integration_tests" ]; then
  ln -s ../../tests "$links/kr3_integration_tests"
fi
for link in "$links"/*; do
  if [ -L "$link" ] && [ ! -e "$link/package.xml" ] && [ "$(basename "$link")" != CMakeLists.txt ]; then
    rm "$link"
  fi
done
