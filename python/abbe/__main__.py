"""``python -m abbe``: the command of the package."""

from __future__ import annotations

import os
import subprocess
import sys
import sysconfig
from pathlib import Path


def main() -> int:
    """Becomes the program that was installed with the package: exit code, signals and pipes are its own."""
    schemes = (None, sysconfig.get_preferred_scheme("user"))
    folders = [sysconfig.get_path("scripts", scheme) if scheme else sysconfig.get_path("scripts") for scheme in schemes]
    name = "abbe.exe" if sys.platform == "win32" else "abbe"
    program = next((str(path) for folder in folders if (path := Path(folder) / name).is_file()), None)
    if program is None:
        print("abbe: this package was built from its sources and has no program, only the library", file=sys.stderr)
        return 2
    if sys.platform != "win32":
        os.execv(program, [program, *sys.argv[1:]])
    return subprocess.call([program, *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
