#!/usr/bin/env bash
# script/check-includes must accept a tree that keeps the order and name each of the three ways to break it.
set -euo pipefail
check=$(dirname "$(readlink -f "$0")")/../../script/check-includes
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT
mkdir "$tree"/{scenes,accel,harness}

write() { printf '#include <vector>\n%s\n' "$2" >"$tree/$1"; }
expect() {  # STATUS TEXT-IN-THE-MESSAGE
  local status=0 output
  output=$("$check" "$tree" 2>&1) || status=$?
  if [[ $status != "$1" || $output != *"$2"* ]]; then
    echo "expected status $1 and \"$2\", got status $status and: $output" >&2
    exit 1
  fi
}

write scenes/scene.h ''
write accel/grid.h '#include "scenes/scene.h"'
write harness/race.cpp $'#include "accel/grid.h"\n#include "scenes/scene.h"'
expect 0 "includes: ok"

write accel/grid.h '#include "harness/race.h"'
write harness/race.h ''
expect 1 "harness is not below accel"

write accel/grid.h '#include "grid_walk.h"'
write accel/grid_walk.h ''
expect 1 'accel/grid.h includes "grid_walk.h"'

write accel/grid.h '#include "accel/cells.h"'
write accel/cells.h '#include "accel/lists.h"'
write accel/lists.h '#include "accel/grid.h"'
expect 1 "include each other"
