"""NumPy's least squares on a matrix of little-endian doubles, the right side in its last column.

    python3 lstsq.py FILE ROWS COLUMNS RUNS
"""

import sys
import time

import numpy as np


def main():
    path, rows, columns, runs = sys.argv[1], *map(int, sys.argv[2:])
    matrix = np.fromfile(path, dtype="<f8").reshape(rows, columns)
    a, b = np.ascontiguousarray(matrix[:, :-1]), np.ascontiguousarray(matrix[:, -1])
    times = []
    for _ in range(runs):
        start = time.perf_counter()
        x, _, rank, _ = np.linalg.lstsq(a, b, rcond=None)
        times.append((time.perf_counter() - start) * 1e3)
    times.sort()
    name = f"  NumPy {np.__version__} linalg.lstsq"
    print(f"{name:<64} {times[0]:>9.2f} ms best, {times[len(times) // 2]:>9.2f} ms median of {runs}")
    print("x")
    for value in x:
        print(repr(float(value)))


if __name__ == "__main__":
    main()
