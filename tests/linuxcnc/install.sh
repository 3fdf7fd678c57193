#!/bin/sh
# Installs the controller that tests/linuxcnc talks to, and what halcompile needs. Safe to run again.
set -eu

# dpkg -s also succeeds for a removed package whose configuration stayed.
status() {
    dpkg-query -W -f '${db:Status-Status}' "$1" 2>/dev/null || true
}

install_package() {
    # The recommended packages are desktop programs: 1.4 GB.
    apt-get install -y -q --no-install-recommends "$1" </dev/null
}

for package in linuxcnc-uspace linuxcnc-uspace-dev gcc make; do
    if [ "$(status "$package")" != installed ]; then
        if [ "$(id -u)" -ne 0 ]; then
            echo "install.sh: $package is missing and installing it needs root" >&2
            exit 1
        fi
        export DEBIAN_FRONTEND=noninteractive
        apt-cache policy "$package" | grep -q 'Candidate: [0-9]' || apt-get update -q
        # A package list may be older than the archive: refresh it once.
        install_package "$package" || { apt-get update -q && install_package "$package"; }
    fi
    if [ "$(status "$package")" != installed ]; then
        echo "install.sh: $package is not installed (status: '$(status "$package")')" >&2
        exit 1
    fi
done
if ! /usr/bin/python3 -c 'import linuxcnc, hal'; then
    echo "install.sh: /usr/bin/python3 cannot import the modules of linuxcnc-uspace" >&2
    exit 1
fi
command -v halcompile >/dev/null
dpkg-query -W -f '${Package} ${Version}\n' linuxcnc-uspace linuxcnc-uspace-dev
