#!/usr/bin/env python3
"""A guard of speed that no busy machine disturbs: instructions of kernels, counted by valgrind's callgrind.

    check.py            compare with counts.json, 5 % either way
    check.py --renew    write counts.json

What is counted: one kernel on 8192 poses, compiled as it is released, less a run without any: start and reading cancel,
and the plan's compilation is included. (In the development profile small functions are calls, and their counts
went up where those of the release went down.) The crate beside this file has the stages up to the evaluator alone, from
the sources of the library. The vector width is forced, for valgrind emulates
a processor of its own (AVX2 at most), so the counts do not depend on this one. They do depend on the compiler: with
another rustc than the one in counts.json differences are shown and not judged.
"""

import array
import json
import os
import pathlib
import random
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
COUNTS = HERE / "counts.json"
TOLERANCE = 0.05
POSES = 8192
KERNELS = [f"{kernel} {width}" for width in ("fused", "avx2") for kernel in ("batch 1", "batch exact", "grid 1", "grid exact")]
# The trunnion's volume, in the order of its walk: C A Y X Z.
TRAVEL = [(0, 360), (-120, 30), (0, 450), (0, 500), (-400, 0)]


def output(*command):
    return subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout


def binary():
    manifest = ROOT / "tests/instructions/Cargo.toml"
    target = ROOT / "target/instructions"
    output("cargo", "build", "--quiet", "--locked", "--release", "--manifest-path", manifest, "--target-dir", target)
    return target / "release/abbe-instructions"


def poses(folder):
    numbers = random.Random(7)
    path = folder / "poses.f64"
    path.write_bytes(array.array("d", [numbers.uniform(*t) for t in TRAVEL for _ in range(POSES)]).tobytes())
    return path


def instructions(program, path, folder, kernel):
    """Of one process that runs this kernel, and the widest vectors that it knows."""
    out = folder / f"callgrind.{kernel.replace(' ', '-')}.out"
    run = subprocess.run(
        ["valgrind", "--tool=callgrind", f"--callgrind-out-file={out}", program, ROOT / "configs/trunnion.yaml", path, *kernel.split()],
        capture_output=True, text=True, cwd=ROOT)
    if run.returncode != 0:
        raise SystemExit(f"{kernel}: {run.stdout}{run.stderr}")
    return int(next(line for line in out.read_text().splitlines() if line.startswith("summary:")).split()[1]), run.stdout.strip()


def main():
    renew = sys.argv[1:] == ["--renew"]
    compiler = output("rustc", "--version").strip()
    known = {} if renew else json.loads(COUNTS.read_text())
    program = binary()
    found, wrong = {}, []
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        path = poses(folder)
        start, width = instructions(program, path, folder, "")
        counted = [kernel for kernel in KERNELS if "avx2" not in kernel or width == "Avx2"]
        if counted != KERNELS:
            print("this processor has no AVX2, whose kernels are not counted")
        with ThreadPoolExecutor(os.cpu_count()) as pool:
            counts = pool.map(lambda kernel: instructions(program, path, folder, kernel)[0], counted)
        for kernel, count in zip(counted, counts):
            found[kernel] = count - start
            expected = known.get("instructions", {}).get(kernel)
            change = f"{100 * (found[kernel] / expected - 1):+.1f} %" if expected else "new"
            print(f"{kernel}: {found[kernel]} instructions, {change}")
            if expected is None or abs(found[kernel] / expected - 1) > TOLERANCE:
                wrong.append(kernel)
    if renew:
        COUNTS.write_text(json.dumps({"rustc": compiler, "instructions": found}, indent=2) + "\n")
    elif known["rustc"] != compiler:
        print(f"counted with {known['rustc']}, this is {compiler}: not judged; `{pathlib.Path(sys.argv[0])} --renew` makes new counts")
    elif wrong:
        raise SystemExit(f"more than 5 % off: {', '.join(wrong)}. If that is meant (fewer, or a good reason), `--renew` and commit.")


if __name__ == "__main__":
    main()
