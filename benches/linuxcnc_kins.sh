#!/usr/bin/env bash
# Time of a call of the generated LinuxCNC kinematics, without the controller: the flags are those of halcompile.
#   benches/linuxcnc_kins.sh PATH_TO_ABBE [MACHINE.yaml ...]
set -euo pipefail
cd "$(dirname "$0")/.."
abbe=${1:?the program}
shift
machines=("$@")
[ "${#machines[@]}" -gt 0 ] || machines=(configs/vmc-cframe-754.yaml configs/trunnion.yaml configs/ht-b-c.yaml configs/hh-bd-ram.yaml)
calls=200000
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

echo "| machine | inverse ns | forward ns |"
echo "|---|---|---|"
for machine in "${machines[@]}"; do
    rm -rf "$work/set"
    "$abbe" --quiet compile "$machine" --target linuxcnc-kins --out "$work/set" --poses 10 >/dev/null
    {
        echo '#include "shim.h"'
        sed '1,/^;;$/d' "$work/set/abbekins.comp"
        cat tests/linuxcnc/kins_main.c
    } >"$work/all.c"
    cc -std=gnu99 -Os -fno-fast-math -fno-builtin-sin -fno-builtin-cos -Itests/linuxcnc -I"$work/set" -o "$work/all" "$work/all.c" -lm
    # Poses about machine zero: enable, share, orientation, tool, X Y Z A B C U V W.
    tool=$(sed -n 's/^static const double abbe_tool\[3\] = { \(.*\) };/\1/p' "$work/set/abbekins_data.h" | tr -d ,)
    awk -v tool="$tool" 'BEGIN { srand(1); for (k = 0; k < 1000; k++) print 1, 1, 1, tool,
        rand() * 200, rand() * 200, -rand() * 200, 5 - rand() * 60, 5 + rand() * 20, rand() * 360, 0, 0, 0 }' >"$work/poses"
    echo "| $machine | $("$work/all" "$calls" <"$work/poses" | sed 's/ / | /') |"
done
