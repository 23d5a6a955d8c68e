#!/usr/bin/env bash
# Takes the project that a page of documentation describes, builds it against the installed package, and runs the
# page's commands. A code block whose first line is a comment with a file's name is that file; blocks marked `sh`
# are the commands; /opt/raymeter stands for where Raymeter is installed.
#   page_code.sh PAGE FOLDER PREFIX
set -euo pipefail
page=$(readlink -f "$1") prefix=$(readlink -f "$3")
rm -rf "$2"
mkdir -p "$2"
cd "$2"
awk '
  /^```./ { language = substr($0, 4); inside = 1; first = 1; file = language == "sh" ? "commands.sh" : ""; next }
  /^```$/ { inside = !inside; file = ""; next }
  inside && first && $0 ~ /^(\/\/|#) [A-Za-z_]+\.[a-z]+$/ { file = $2; first = 0 }
  inside && file { print > file; first = 0 }
' "$page"
[[ -s CMakeLists.txt && -s commands.sh ]] || { echo "$1: no project and no commands in it" >&2; exit 1; }
sed -i "s#/opt/raymeter#$prefix#g" commands.sh
export CXXFLAGS="-Wall -Wextra -Werror"
bash -euxo pipefail commands.sh
