#!/usr/bin/python3
"""Does this harness work, and does it notice? Needs no abbe, only the controller.

Writes tables by hand (periodic error with reversal, rotary over both turns, type 0,
one row, a step inside the dead zone of LinuxCNC's ramp), runs the controller over
them, then spoils tables and replays and expects every spoiled one to be refused.
With --spoiled it leaves out what the live checks run themselves.
"""

import json
import math
import os
import subprocess
import sys
import tempfile

sys.dont_write_bytecode = True
HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, HERE)

import session  # noqa: E402
from fragment import FRAGMENT, Fragment  # noqa: E402


def wave(low, high, rows, size, period, lost):
    """A periodic error on a slope, noise at a tenth, lost motion in reverse."""
    table = []
    for number in range(rows):
        place = low + (high - low) * number / (rows - 1)
        trim = (size * math.sin(2 * math.pi * place / period) + 0.1 * size * math.sin(7.3 * place)
                - 1e-5 * place + size)
        table.append((place, trim, trim + lost))
    return table


def machines():
    """name: [(letter, kind, low, high, type of file, rows)]"""
    type0 = [(place, place + forward, place + reverse)
             for place, forward, reverse in wave(100, 180, 21, 0.003, 23, 0.006)]
    return {
        "five": [("X", "LINEAR", 0, 300, 1, wave(0, 300, 151, 0.003, 50, -0.004)),
                 ("Y", "LINEAR", 0, 250, 1, wave(0, 250, 126, 0.002, 37, 0.005)),
                 ("Z", "LINEAR", -250, 0, 1, wave(-250, 0, 256, 0.004, 60, -0.003)),
                 ("A", "ANGULAR", -120, 30, 1, wave(-120, 30, 61, 0.0015, 90, 0.002)),
                 ("C", "ANGULAR", -360, 360, 1, wave(-360, 360, 145, 0.002, 360, -0.0025))],
        "odd": [("X", "LINEAR", 100, 180, 0, type0),
                ("Y", "LINEAR", -10, 10, 1, [(-5.0, 0.0001, -0.0001)]),
                ("Z", "LINEAR", -20, 60, 1,
                 [(2.0 * n, 1e-6 * n, 1e-6 * n + 2.8e-5) for n in range(-10, 31)])],
    }


def write_machine(directory, joints):
    letters = [joint[0] for joint in joints]
    parts = [f"[KINS]\nJOINTS = {len(joints)}\nKINEMATICS = trivkins"
             f" coordinates={''.join(letters)}\n\n[TRAJ]\nCOORDINATES = {' '.join(letters)}\n"]
    os.mkdir(directory)
    for number, (letter, kind, low, high, file_type, rows) in enumerate(joints):
        name = f"joint_{number}_{letter}.comp"
        with open(os.path.join(directory, name), "w") as out:
            out.writelines("{:.6f} {:.9f} {:.9f}\n".format(*row).replace("-0.000000000", "0")
                           for row in rows)
        parts.append(f"[JOINT_{number}]\nTYPE = {kind}\nMIN_LIMIT = {low}\nMAX_LIMIT = {high}\n"
                     f"COMP_FILE = {name}\nCOMP_FILE_TYPE = {file_type}\n")
    with open(os.path.join(directory, FRAGMENT), "w") as out:
        out.write("\n".join(parts))


def call(script, *arguments):
    """Exit code, standard output, standard error of one of the scripts."""
    done = subprocess.run([session.PYTHON, os.path.join(HERE, script), *arguments],
                          capture_output=True, text=True, timeout=300, check=False)
    return done.returncode, done.stdout, done.stderr


class Selftest:
    def __init__(self):
        self.failures = 0

    def expect(self, what, wanted, script, *arguments):
        """One call that has to succeed (`wanted` empty) or to fail saying `wanted`."""
        code, out, err = call(script, *arguments)
        good = code == 0 if not wanted else code == 1 and wanted in err + out
        self.failures += not good
        print(f"{'ok  ' if good else 'FAIL'} {what}", flush=True)
        if not good:
            print(f"exit code {code}\n{out[-2000:]}\n{err[-4000:]}")
        return out


def rewrite(path, change):
    with open(path) as source:
        text = source.read()
    changed = change(text)
    assert changed != text, path
    with open(path, "w") as out:
        out.write(changed)


def spoiled_tables(test, scratch, observed):
    """The same observation against tables that are not the ones that were loaded."""
    def in_row(column, change):
        def apply(text):
            lines = text.split("\n")
            words = lines[40].split()
            words[column] = f"{change(float(words[column])):.9f}"
            return "\n".join(lines[:40] + [" ".join(words)] + lines[41:])
        return apply

    def columns_swapped(text):
        return "".join(f"{a} {c} {b}\n" for a, b, c in map(str.split, text.splitlines()))

    changes = {
        "trim changed by 2e-9": (in_row(1, lambda value: value + 2e-9), " corr "),
        "node moved by 1e-4": (in_row(0, lambda value: value + 1e-4), " corr "),
        "columns swapped": (columns_swapped, " corr "),
        "last row missing": (lambda text: text[:text[:-1].rindex("\n") + 1], " corr "),
        "blank line": (lambda text: "\n" + text, "blank line"),
    }
    for number, (name, (change, wanted)) in enumerate(changes.items()):
        directory = os.path.join(scratch, f"spoiled{number}")
        write_machine(directory, machines()["five"])
        rewrite(os.path.join(directory, "joint_1_Y.comp"), change)
        test.expect(f"check notices: {name}", wanted, "run_comp.py", "check", observed, directory)


def spoiled_replays(test, directory, observed):
    """A right replay passes; one that is off, short or not a number does not."""
    tables = {joint.number: joint.table for joint in Fragment(directory).joints}
    with open(observed) as source:
        rows = [line.split(",")[:3] for line in source.read().splitlines()[1:]]
    right = [f"{n},{name},{place},{tables[int(n)].correction(float(place), name)!r}"
             for n, name, place in rows]
    middle = len(right) // 2
    start, value = right[middle].rsplit(",", 1)
    replays = {
        "right": (right, ""),
        "off by 2e-9 once": (with_row(right, middle, f"{start},{float(value) + 2e-9!r}"), "corr"),
        "NaN once": (with_row(right, middle, f"{start},nan"), "corr"),
        "one row short": (right[:middle] + right[middle + 1:], "lacks 1 observed rows"),
    }
    path = observed + ".replay"
    for name, (lines, wanted) in replays.items():
        with open(path, "w") as out:
            out.write("joint,direction,position,correction\n" + "\n".join(lines) + "\n")
        test.expect(f"check with a replay: {name}", wanted,
                    "run_comp.py", "check", observed, directory, "--expect", path)


def spoiled_observations(test, directory, observed):
    """What the motors would show if the controller did not apply what it looked up."""
    with open(observed) as source:
        header, *rows = source.read().splitlines()
    cells = [row.split(",") for row in rows]
    moving = next(index for index, row in enumerate(cells) if row[6] == "motion")
    resting = next(index for index, row in enumerate(cells) if row[6] == "rest")

    def motor_off(index, amount):
        row = list(cells[index])
        for column in (4, 5):
            row[column] = repr(float(row[column]) + amount)
        return with_row(rows, index, ",".join(row))

    def without(condition):
        return [row for row, cell in zip(rows, cells) if not condition(cell)]

    spoiled = {
        "motor off by 2e-6 in motion": (motor_off(moving, 2e-6), "motor_in_motion"),
        "motor off by 6e-5 at rest": (motor_off(resting, 6e-5), "motor_at_rest"),
        "joint 1 never reversed": (without(lambda c: c[:2] == ["1", "reverse"]), "never visited"),
        "joint 2 not beyond its end": (
            without(lambda c: c[0] == "2" and float(c[2]) > 0), "nothing above"),
        "no rests": (without(lambda c: c[6] == "rest"), "nothing at rest"),
    }
    path = observed + ".spoiled"
    for name, (lines, wanted) in spoiled.items():
        with open(path, "w") as out:
            out.write("\n".join([header] + lines) + "\n")
        test.expect(f"check notices: {name}", wanted, "run_comp.py", "check", path, directory)


def with_row(rows, index, row):
    return rows[:index] + [row] + rows[index + 1:]


def main():
    test = Selftest()
    with tempfile.TemporaryDirectory() as scratch:
        for name, joints in machines().items():
            directory = os.path.join(scratch, name)
            observed = os.path.join(scratch, name + ".csv")
            write_machine(directory, joints)
            out = test.expect(f"{name}: observe", "", "run_comp.py", "observe", directory,
                              "--out", observed)
            if out:
                report = json.loads(out)
                print(f"     {report['seconds']} s, cycles {report['cycles']}, largest corr"
                      f" {max(j['max_difference']['corr'] for j in report['joints'])}")
            test.expect(f"{name}: check", "", "run_comp.py", "check", observed, directory)
            test.expect(f"{name}: lint", "", "malformed.py", "lint", directory)
        five, observed = os.path.join(scratch, "five"), os.path.join(scratch, "five.csv")
        test.expect("five: through #INCLUDE and the launcher", "", "run_comp.py", "include", five)
        spoiled_tables(test, scratch, observed)
        spoiled_replays(test, five, observed)
        spoiled_observations(test, five, observed)
    if "--spoiled" not in sys.argv:
        test.expect("malformed tables", "", "malformed.py", "show")
        test.expect("kinematics modules", "", "kinematics.py")
    print(f"{test.failures} failures")
    return 1 if test.failures else 0


if __name__ == "__main__":
    sys.exit(main())
