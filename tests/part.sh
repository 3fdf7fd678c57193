# Sourced by scripts of several parts. `part NAME COMMAND...` runs one; `beside NAME COMMAND...` starts one beside those
# that follow, and `together` waits for them. The script ends with the seconds of each, and those of processor time so far.

parts=()
lanes=()
trap summary EXIT

summary() {
    [ "${#parts[@]}" -gt 0 ] || return 0
    printf "%6s s  %s\n" "${parts[@]}"
    # In a file: a subshell would show its own.
    local spent
    spent=$(mktemp)
    times >"$spent"
    awk 'NR == 2 { split($1, u, /[ms]/); split($2, s, /[ms]/)
        printf "%6d s  processor time of all\n", 60 * (u[1] + s[1]) + u[2] + s[2] }' "$spent"
    rm -f "$spent"
}

part() {
    local name=$1 start=$SECONDS
    shift
    printf '\n== %s\n' "$name"
    "$@"
    parts+=("$((SECONDS - start))" "$name")
}

# The command is a program or a function; what it prints follows when it has ended.
beside() {
    local name=$1 log
    shift
    log=$(mktemp)
    (
        trap - EXIT
        set -euo pipefail
        start=$SECONDS
        parts=()
        "$@"
        [ "${#parts[@]}" -eq 0 ] || printf "%6s s  %s\n" "${parts[@]}"
        echo "$((SECONDS - start))" >"$log.seconds"
    ) >"$log" 2>&1 &
    lanes+=("$!" "$name" "$log")
}

together() {
    local failed=0
    set -- "${lanes[@]}"
    lanes=()
    while [ $# -gt 0 ]; do
        local code=0
        wait "$1" || code=$?
        printf '\n== %s (beside others)\n' "$2"
        cat "$3"
        [ "$code" -eq 0 ] && parts+=("$(cat "$3.seconds")" "$2 (beside others)") || { failed=1; echo "$2: failed with $code" >&2; }
        rm -f "$3" "$3.seconds"
        shift 3
    done
    return "$failed"
}
