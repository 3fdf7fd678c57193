#!/bin/sh
# Installs the controller that tests/linuxcnc talks to. Safe to run again.
set -eu

package=linuxcnc-uspace

# dpkg -s also succeeds for a removed package whose configuration stayed.
status() {
    dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null || true
}

if [ "$(status)" != installed ]; then
    if [ "$(id -u)" -ne 0 ]; then
        echo "install.sh: $package is missing and installing it needs root" >&2
        exit 1
    fi
    export DEBIAN_FRONTEND=noninteractive
    install_package() {
        # The recommended packages are desktop programs: 1.4 GB.
        apt-get install -y -q --no-install-recommends "$package" </dev/null
    }
    apt-cache policy "$package" | grep -q 'Candidate: [0-9]' || apt-get update -q
    # A package list may be older than the archive: refresh it once.
    install_package || { apt-get update -q && install_package; }
fi

if [ "$(status)" != installed ]; then
    echo "install.sh: $package is not installed (status: '$(status)')" >&2
    exit 1
fi
if ! /usr/bin/python3 -c 'import linuxcnc, hal'; then
    echo "install.sh: /usr/bin/python3 cannot import the modules of $package" >&2
    exit 1
fi
dpkg-query -W -f '${Package} ${Version}\n' "$package"
