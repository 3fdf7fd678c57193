"""Samples of all programs in turn, the smallest of each, and ratios. Called by benches/run."""

import os
import subprocess
import sys
import time

os.environ.update(OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1", MKL_NUM_THREADS="1")

import numpy as np

import machine
import peers

COUNT = 1 << 20
NUMPY = 1 << 16
PYTHON = 1 << 14  # poses of a sample where Python is called for each, or where 2^20 take seconds


class Ours:
    """The benchmark process: a line asks for a sample, a line answers with nanoseconds per pose."""

    def __init__(self, binary, file, poses, core=None):
        pin = (lambda: os.sched_setaffinity(0, {core})) if core is not None else None
        self.process = subprocess.Popen([binary, file, poses], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
                                        preexec_fn=pin)
        _, self.width, _ = self.process.stdout.readline().split()

    def sample(self, words):
        self.process.stdin.write(words + "\n")
        self.process.stdin.flush()
        answer = self.process.stdout.readline().strip()
        if answer in ("", "unknown"):
            raise SystemExit(f"`{words}`: no sample")
        return float(answer)

    def dump(self, words, path, count):
        self.sample(words)
        self.sample(f"dump {path}")
        return np.fromfile(path).reshape(6, -1)[:, :count]


def clocked(count, run):
    start = time.perf_counter()
    run()
    return (time.perf_counter() - start) * 1e9 / count


def check(name, found, expected, tolerance):
    """A wrong peer is no peer."""
    gap = [np.abs(f - e).max() / np.abs(e).max() for f, e in ((found[:3], expected[:3]), (found[3:], expected[3:]))]
    print(f"  {name:42} {gap[0]:8.1e} {gap[1]:8.1e}")
    if max(gap) > tolerance:
        raise SystemExit(f"{name} does not compute the same: {gap}")


def interleaved(rounds, contenders):
    """Every round takes one sample of each; the smallest and the median of each."""
    samples = {name: [] for name in contenders}
    for _ in range(rounds):
        for name, take in contenders.items():
            samples[name].append(take())
    return {name: (min(s), float(np.median(s))) for name, s in samples.items()}


def table(times, base):
    print(f"  {'ns per pose':42} {'smallest':>9} {'median':>9} {'ratio':>8}")
    for name, (least, median) in times.items():
        print(f"  {name:42} {least:9.2f} {median:9.2f} {least / times[base][0]:8.2f}")


def one_core(binary, folder, rounds):
    os.sched_setaffinity(0, {0})
    file, linear = machine.write(folder), machine.write(f"{folder}/linearised", joints="linearised")
    path, columns = machine.poses(folder, COUNT)
    errors = peers.looked_up(columns)
    casadi, numpy = peers.CasADi(folder, columns, errors), peers.NumPy(columns)
    pinocchio, jacobian = peers.Pinocchio(columns, errors, PYTHON), peers.PinocchioFirst(columns, errors, PYTHON)
    ours, theirs = Ours(binary, file, path, 0), Ours(binary, linear, path, 0)
    print(f"Largest difference from ours, position and rotation, of the largest ({ours.width}):")
    dump = f"{folder}/dump.f64"
    first = ours.dump("batch 1 widest 1", dump, COUNT)
    casadi.run("first", COUNT)
    check("CasADi, order 1", casadi.out.T, first, 1e-11)
    exact = ours.dump("batch exact widest 1", dump, COUNT)
    casadi.run("exact", COUNT)
    check("CasADi, exact", casadi.out.T, exact, 1e-9)
    jacobian.run()
    check("Pinocchio, order 1", jacobian.out, first[:, :PYTHON], 1e-11)
    pinocchio.run()
    check("Pinocchio, exact", pinocchio.out, exact[:, :PYTHON], 1e-9)
    linearised = theirs.dump("batch exact widest 1", dump, COUNT)
    numpy.run(PYTHON)
    check("NumPy, exact with linearised joints", numpy.out[:, :PYTHON], linearised[:, :PYTHON], 1e-9)
    check("naive chain, likewise, inverses of order 1", theirs.dump("naive", dump, PYTHON), linearised[:, :PYTHON], 1e-4)
    ask = lambda words: lambda: ours.sample(words)
    peer = {
        "NumPy, 4x4, curves by interp": lambda: clocked(NUMPY, lambda: numpy.run(NUMPY)),
        "naive 4x4 in Rust, curves by bisection": ask("naive"),
        "CasADi C, order 1, no curves": lambda: clocked(COUNT, lambda: casadi.run("first", COUNT)),
        "CasADi C, exact, no curves": lambda: clocked(COUNT, lambda: casadi.run("exact", COUNT)),
        "Pinocchio from Python, order 1, no curves": lambda: clocked(PYTHON, jacobian.run),
        "Pinocchio from Python, exact, no curves": lambda: clocked(PYTHON, pinocchio.run),
        "the general algebra, exact": ask("general exact"),
    }
    widths = ["scalar", "fused", "avx2", "avx512"]
    mine = {f"ours, order {o}, {w}": ask(f"batch {o} {w} 1") for o in ("1", "2", "exact") for w in widths}
    times = interleaved(rounds, {"ours, order 1": ask("batch 1 widest 1"), **peer, **mine, "ours, order 2": ask("batch 2 widest 1"),
                                 "ours, exact": ask("batch exact widest 1")})
    print(f"\nScattered, {COUNT} poses, 5 axes, 30 curves of 129 nodes, one core; ratio to ours, order 1:")
    table(times, "ours, order 1")
    exact = times["CasADi C, exact, no curves"][0] / times["ours, exact"][0]
    print(f"  exact: CasADi's time is {exact:.2f} of ours")


def grids(binary, folder, rounds):
    file = machine.write(f"{folder}/grid", steps=40)
    path, _ = machine.poses(f"{folder}/grid", COUNT)
    ours = Ours(binary, file, path, 0)
    ask = lambda words: lambda: ours.sample(words)
    mine = {f"ours, order {order}, grid of 40^5": ask(f"grid {order} widest 1") for order in ("1", "2", "exact")}
    times = interleaved(rounds, {"copy of the outputs": ask("copy"), **mine})
    print("\nGrid, 2^20 of its 1.02e8 nodes a sample, one core; ratio to the copy:")
    table(times, "copy of the outputs")


def growth(binary, folder, rounds):
    print("\nHow cost grows, order 1, one core (smallest of the samples, ns per pose):")
    for axes in (2, 3, 4, 5):
        sub = f"{folder}/axes{axes}"
        ours = Ours(binary, machine.write(sub, axes=axes), machine.poses(sub, COUNT, axes)[0], 0)
        print(f"  {axes} axes: {min(ours.sample('batch 1 widest 1') for _ in range(rounds)):.2f}")
    for nodes in (9, 129, 2049, 32769):
        sub = f"{folder}/nodes{nodes}"
        ours = Ours(binary, machine.write(sub, nodes=nodes), machine.poses(sub, COUNT)[0], 0)
        print(f"  {nodes} nodes: {min(ours.sample('batch 1 widest 1') for _ in range(rounds)):.2f}")
    for power in (4, 8, 12, 16, 20, 22):
        sub = f"{folder}/poses{power}"
        ours = Ours(binary, machine.write(sub), machine.poses(sub, 1 << power)[0], 0)
        print(f"  2^{power} poses: {min(ours.sample('batch 1 widest 1') for _ in range(rounds)):.2f}")


def threads(binary, folder, rounds):
    os.sched_setaffinity(0, range(os.cpu_count()))
    ours = Ours(binary, machine.write(f"{folder}/threads", steps=16), machine.poses(f"{folder}/threads", 1 << 22)[0])
    ask = lambda words: lambda: ours.sample(words)
    names = ["batch 1 widest", "batch exact widest", "survey 1", "survey exact", "grid 1 widest", "grid exact widest"]
    times = interleaved(rounds, {f"{n} {t}": ask(f"{n} {t}") for n in names for t in (1, 2)})
    print("\nTwo threads against one (smallest of the samples):")
    for n in names:
        one, two = times[f"{n} 1"][0], times[f"{n} 2"][0]
        print(f"  {n:24} {one:8.2f} {two:8.2f} ns per pose, {one / two:.2f} times")


def whole_program(program, folder):
    print("\nThe program, measured from outside:")
    start = min(clocked(1, lambda: subprocess.run([program, "check", "configs/trunnion.yaml"], capture_output=True, check=True))
                for _ in range(20))
    print(f"  abbe check: {start / 1e6:.1f} ms")
    file = machine.write(f"{folder}/grid", steps=40)
    for order in ("1", "exact"):
        begin = time.perf_counter()
        # GNU time starts it from a small process: this one's own memory would count as the child's.
        command = ["/usr/bin/time", "-f", "%M", program, "map", file, "--order", order, "--quiet"]
        done = subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, check=True)
        print(f"  abbe map of {40**5} nodes, order {order}: {time.perf_counter() - begin:.1f} s, "
              f"largest resident set {int(done.stderr.split()[-1]) / 1024:.1f} MiB")


def main():
    binary, program, folder, rounds = *sys.argv[1:4], int(sys.argv[4])
    one_core(binary, folder, rounds)
    grids(binary, folder, rounds)
    growth(binary, folder, rounds)
    threads(binary, folder, rounds)
    whole_program(program, folder)


if __name__ == "__main__":
    main()
