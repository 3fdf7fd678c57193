# Sourced by what builds a release: the same commit gives the same bytes in every folder.
export CARGO_INCREMENTAL=0 LC_ALL=C TZ=UTC
export SOURCE_DATE_EPOCH="${SOURCE_DATE_EPOCH:-$(git log -1 --format=%ct)}"

# No path of this machine ends up in what is built. The separator allows for blanks in paths.
remap="--remap-path-prefix=$PWD=/abbe"$'\x1f'"--remap-path-prefix=${CARGO_HOME:-$HOME/.cargo}=/cargo"
remap+=$'\x1f'"--remap-path-prefix=$(rustc --print sysroot)=/rust"

# Writes SHA256SUMS of a folder.
checksums() {
    (cd "$1" && find . -type f ! -name SHA256SUMS -print0 | sort -z | xargs -0 sha256sum >SHA256SUMS)
}
