#!/usr/bin/env bash
# Time of a call of the generated LinuxCNC kinematics, without the controller: the flags are those of halcompile.
#   benches/linuxcnc_kins.sh PATH_TO_ABBE [MACHINE.yaml ...]
set -euo pipefail
cd "$(dirname "$0")/.."
abbe=${1:?the program}
shift
machines=("$@")
[ "${#machines[@]}" -gt 0 ] || machines=(configs/vmc-cframe-754.yaml configs/trunnion.yaml configs/ht-b-c.yaml configs/hh-bd-ram.yaml
    tests/data/kins/lathe.yaml tests/data/kins/ur5.yaml)
calls=200000
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

echo "| machine | inverse ns | forward ns |"
echo "|---|---|---|"
for machine in "${machines[@]}"; do
    rm -rf "$work/set"
    "$abbe" --quiet compile "$machine" --target linuxcnc-kins --out "$work/set" --poses 10 --max-correction "20 mm, 30 mrad" >/dev/null
    {
        echo '#include "shim.h"'
        sed '1,/^;;$/d' "$work/set/abbekins.comp"
        cat tests/linuxcnc/kins_main.c
    } >"$work/all.c"
    cc -std=gnu99 -Os -fno-fast-math -fno-builtin-sin -fno-builtin-cos -Itests/linuxcnc -I"$work/set" -o "$work/all" "$work/all.c" -lm
    # Joints about where the simulation stands after homing: enable, share, orientation, tool, pose (not used), joints.
    tool=$(sed -n 's/^static const double abbe_tool\[3\] = { \(.*\) };/\1/p' "$work/set/abbekins_data.h" | tr -d ,)
    home=$(sed -n 's/^HOME = //p' "$work/set/sim.ini" | tr '\n' ' ')
    awk -v tool="$tool" -v home="$home" 'BEGIN { srand(1); count = split(home, at, " ")
        for (k = 0; k < 1000; k++) {
            line = "1 1 1 " tool " 0 0 0 0 0 0 0 0 0"
            for (j = 1; j <= 9; j++) line = line " " (j <= count ? at[j] + 5 + 25 * rand() : 0)
            print line
        } }' >"$work/poses"
    echo "| $machine | $("$work/all" "$calls" <"$work/poses" | sed 's/ / | /') |"
done
