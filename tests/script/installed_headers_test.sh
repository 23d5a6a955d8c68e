#!/usr/bin/env bash
# Every installed header compiles alone, with nothing but itself and the installed ones to include, and none asks
# for a library that its user may not have.
#   installed_headers_test.sh INCLUDE_FOLDER COMPILER
set -euo pipefail
cd "$1"

if grep -rnE '^ *# *include *<[^>]*(/|\.hpp)[^>]*>' .; then
  echo "installed headers: these need other libraries; add the header to private_headers in cmake/install.cmake" >&2
  exit 1
fi
mapfile -t headers < <(find . -name '*.h' -printf '%P\n' | sort)
((${#headers[@]} > 20)) || { echo "installed headers: only ${#headers[@]} in $1" >&2; exit 1; }
# Included twice: they must have guards, too.
printf '%s\n' "${headers[@]}" | xargs -P "$(nproc)" -I @ \
  "$2" -std=c++20 -fsyntax-only -Wall -Wextra -Werror -I . -include @ -include @ -x c++ /dev/null
echo "installed headers: ${#headers[@]} ok"
