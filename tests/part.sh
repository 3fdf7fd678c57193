# Sourced by scripts of several parts. `part NAME COMMAND...` runs one, and the script ends with the seconds of each.

parts=()
trap '[ "${#parts[@]}" -eq 0 ] || printf "%6s s  %s\n" "${parts[@]}"' EXIT

part() {
    local name=$1 start=$SECONDS
    shift
    printf '\n== %s\n' "$name"
    "$@"
    parts+=("$((SECONDS - start))" "$name")
}
