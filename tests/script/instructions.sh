#!/usr/bin/env bash
# Counts the instructions of brick-grid's AVX2 kernels and of its build with callgrind, for a ray and for a
# primitive, and compares them with the table. Exit status 77: not here.
#   instructions.sh TABLE COMPILER PROGRAM
# PROGRAM is brick_instructions, or empty where it could not be built. With RAYMETER_RENEW set, what this compiler's
# code takes is put into the table.
set -euo pipefail
shopt -s inherit_errexit
table=$1 compiler=$2 program=$3
skip() { echo "skipped: $1"; exit 77; }
[[ -n $program ]] || skip "valgrind's headers were not there when this was built (script/setup test)"
command -v valgrind >/dev/null || skip "no valgrind (script/setup test)"
grep -qw avx2 /proc/cpuinfo || skip "this CPU has no AVX2"

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
# Dump i of callgrind is what line i of the program tells of.
valgrind --tool=callgrind --instr-atstart=no --callgrind-out-file="$work/dump" "$program" >"$work/lines" 2>"$work/log" ||
  { cat "$work/log"; exit 1; }
i=0
while IFS=, read -r scene what count; do
  ((++i))
  total=$(sed -n 's/^totals: //p' "$work/dump.$i")
  echo "$compiler,$scene,$what,$((total / count))"
done <"$work/lines" >"$work/measured"

if [[ -n ${RAYMETER_RENEW:-} ]]; then
  { echo 'compiler,scene,what,instructions'; { grep -v -e '^compiler,' -e "^$compiler," "$table" || true; cat "$work/measured"; } | sort; } >"$work/table"
  cp "$work/table" "$table"
fi

# More than 5% above the number, or 15% below it, is a failure; of a compiler that is not in the table, more than 30%
# above another's.
awk -F, '
  NR == FNR { was[$1, $2, $3] = $4; any[$2, $3] = $4; known[$1] = 1; next }
  {
    n = known[$1] ? was[$1, $2, $3] : any[$2, $3]
    verdict = "ok"
    if (n == "") verdict = "NOT IN THE TABLE"
    else if ($4 > n * (known[$1] ? 1.05 : 1.3)) verdict = "MORE"
    else if (known[$1] && $4 < n * 0.85) verdict = "FAR FEWER, well done"
    if (verdict != "ok") bad = 1
    printf "%-24s %-24s %7d instructions, was %7d: %s\n", $2, $3, $4, n, verdict
    if (!known[$1]) other = $1
  }
  END {
    if (other) print "of " other " the table knows nothing: compared with another compiler, roughly"
    if (bad) print "where that is meant to be, renew the table with script/renew-work-tables"
    exit bad
  }' "$table" "$work/measured"
