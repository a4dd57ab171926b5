#!/usr/bin/env bash
# Make catkin_ws/src hold one relative symlink per package: those of src/, and tests/ as kr3_integration_tests.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
links="$root/catkin_ws/src"
mkdir -p "$links"

is_package() { [ -f "$1/package.xml" ] && [ -f "$1/CMakeLists.txt" ]; }

for folder in "$root"/src/*; do
  name=$(basename "$folder")
  if is_package "$folder" && [ ! -L "$links/$name" ]; then
    ln -s "../../src/$name" "$links/$name"
  fi
done
if is_package "$root/tests" && [ ! -L "$links/kr3_integration_tests" ]; then
  ln -s ../../tests "$links/kr3_integration_tests"
fi
for link in "$links"/*; do
  if [ -L "$link" ] && [ "$(basename "$link")" != CMakeLists.txt ] && ! is_package "$link"; then
    rm "$link"
  fi
done
