"""Prints numbers of a machine file, from the package that this Python has: the same on every processor.

wheel_at_work.py MACHINE [MAP]: compares with MAP, which `abbe map MACHINE --format json` has printed.
"""

import hashlib
import json
import platform
import sys
from pathlib import Path

import numpy as np

import abbe


def main() -> None:
    """Prints a line for each kind of number."""
    machine = abbe.load(sys.argv[1])
    of = f"{platform.machine()}, Python {platform.python_version()}, NumPy {np.__version__}"
    print(f"abbe {abbe.__version__} of {abbe.__file__}: {of}", file=sys.stderr)
    ends = np.array([[nodes[0], nodes[-1]] for nodes in machine.grid.values()])
    poses = np.random.default_rng(1).uniform(ends[:, 0], ends[:, 1], (10_000, len(ends)))
    for order in (1, 2, "exact"):
        found = machine.deviations(poses, order=order)
        print(order, hashlib.sha256(found.position.tobytes("F") + found.rotation.tobytes("F")).hexdigest())
    print(json.dumps(abbe.loads(abbe.starter()).budget(class_="production", samples=100, poses=100).to_dict()))
    for name, content in sorted(machine.compile("linuxcnc").contents.items()):
        print(name, hashlib.sha256(content).hexdigest())
    found = machine.map().to_dict()
    print(json.dumps(found))
    if len(sys.argv) > 2:
        assert found == json.loads(Path(sys.argv[2]).read_text()), "the program prints another map"


if __name__ == "__main__":
    main()
