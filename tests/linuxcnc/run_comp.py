#!/usr/bin/python3
"""Loads what abbe compiled into a real LinuxCNC and compares what it does.

  run_comp.py observe DIR --out observed.csv   the controller's own numbers
  run_comp.py check observed.csv DIR [--expect replay.csv]
  run_comp.py include DIR                      the fragment through the stock launcher
  run_comp.py run DIR...                       all of it, with the model in model.py

Prints JSON; exit code 0 only when every comparison holds.
"""

import argparse
import bisect
import csv
import json
import os
import sys
import tempfile
import time

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import include  # noqa: E402
import observe  # noqa: E402
import session  # noqa: E402
from fragment import Fragment  # noqa: E402
from model import DIRECTIONS  # noqa: E402

CORRECTION_TOLERANCE = 1e-9
MOTION_TOLERANCE = 1e-6
REST_TOLERANCE = 5e-5
# At rest the table was looked up one last step of braking before the position.
HAIR = session.ACCELERATION * observe.PERIOD**2


class Differences:
    """Largest differences of one joint and direction, and what was covered."""

    def __init__(self, joint, direction):
        self.joint, self.table, self.direction = joint.number, joint.table, direction
        self.rows = {"motion": 0, "ramp": 0, "deadzone": 0, "rest": 0}
        self.outside = {"below": 0, "above": 0}
        self.intervals = set()
        self.largest = dict.fromkeys(
            ("corr", "corr_at_rest_vs_command", "motor_in_motion", "motor_at_rest",
             "motor_in_ramp", "motor_minus_filt"), 0.0)

    def note(self, key, difference):
        # max() would lose a NaN, and JSON has none.
        if difference != difference:
            difference = sys.float_info.max
        self.largest[key] = max(self.largest[key], difference)

    def add(self, row, expected):
        _, position, corr, filt, motor, phase, command = row
        self.rows[phase] += 1
        self.note("corr", abs(corr - expected))
        self.note("motor_minus_filt", abs(motor - filt))
        kind = {"motion": "motor_in_motion", "ramp": "motor_in_ramp"}
        self.note(kind.get(phase, "motor_at_rest"), abs(motor - corr))
        if phase == "rest":
            at_command = self.table.correction(command, self.direction)
            self.note("corr_at_rest_vs_command", abs(corr - at_command))
        self.outside["below"] += position < self.table.low
        self.outside["above"] += position > self.table.high
        self.intervals.add(bisect.bisect_right(self.table.nominal, position))

    def failures(self):
        limits = {"corr": CORRECTION_TOLERANCE, "motor_in_motion": MOTION_TOLERANCE,
                  "motor_at_rest": REST_TOLERANCE, "motor_minus_filt": 1e-9,
                  "corr_at_rest_vs_command":
                      CORRECTION_TOLERANCE + HAIR * self.table.steepest()}
        where = f"joint {self.joint} {self.direction}"
        found = [f"{where}: {key} {self.largest[key]:.3g} > {limit:.3g}"
                 for key, limit in limits.items() if not self.largest[key] <= limit]
        missing = set(range(len(self.table.nominal) + 1)) - self.intervals
        if missing:
            found.append(f"{where}: table intervals never visited: {sorted(missing)[:5]}")
        found += [f"{where}: nothing {side} the table"
                  for side, count in self.outside.items() if not count]
        # A flat table can leave the ramp in its dead zone for a whole direction.
        if not self.rows["motion"] + self.rows["deadzone"]:
            found.append(f"{where}: nothing in motion")
        if not self.rows["rest"]:
            found.append(f"{where}: nothing at rest")
        return found

    def report(self):
        return {"joint": self.joint, "direction": self.direction, "rows": self.rows,
                "outside": self.outside, "intervals": len(self.intervals),
                "max_difference": self.largest}


def compare(joints, rows, expected):
    """Differences of the rows of all joints; `expected(joint, row)` is the correction."""
    found = {(joint.number, direction): Differences(joint, direction)
             for joint in joints for direction in DIRECTIONS}
    for joint, mine in zip(joints, rows):
        for row in mine:
            found[joint.number, row[0]].add(row, expected(joint, row))
    return list(found.values())


def by_model(joint, row):
    return joint.table.correction(row[1], row[0])


def verdict(differences):
    failures = [text for each in differences for text in each.failures()]
    return {"ok": not failures, "failures": failures,
            "joints": [each.report() for each in differences]}


def read_observed(path, joints):
    rows = [[] for _ in joints]
    with open(path, newline="", encoding="ascii") as source:
        reader = csv.DictReader(source)
        if tuple(reader.fieldnames or ()) != observe.COLUMNS:
            raise session.SessionFailed(f"{path}: columns {reader.fieldnames}")
        for line in reader:
            rows[int(line["joint"])].append(
                (line["direction"], float(line["position"]), float(line["corr"]),
                 float(line["filt"]), float(line["motor_minus_pos"]), line["phase"],
                 float(line["pos_cmd"])))
    return rows


def read_expected(path):
    columns = ["joint", "direction", "position", "correction"]
    with open(path, newline="", encoding="ascii") as source:
        reader = csv.DictReader(source)
        if reader.fieldnames != columns:
            raise session.SessionFailed(f"{path}: columns {reader.fieldnames}, not {columns}")
        return {(int(line["joint"]), line["direction"], float(line["position"])):
                float(line["correction"]) for line in reader}


def observe_command(arguments):
    started = time.monotonic()
    fragment = Fragment(arguments.directory)
    seen = observe.observe(fragment, arguments.max_seconds, arguments.keep)
    seen.write_csv(arguments.out)
    result = verdict(compare(fragment.joints, seen.rows, by_model))
    result.update({
        "linuxcnc": seen.result["linuxcnc"], "package": session.version(),
        "out": arguments.out, "seconds": round(time.monotonic() - started, 1),
        "motion_seconds": round(seen.motion_seconds, 1),
        "cycles": [len(rows) for rows in seen.rows],
        "limits_inside_table": [
            joint.table.low <= joint.limits[0] and joint.limits[1] <= joint.table.high
            for joint in fragment.joints],
    })
    return result


def check_command(arguments):
    fragment = Fragment(arguments.directory)
    rows = read_observed(arguments.observed, fragment.joints)
    result = verdict(compare(fragment.joints, rows, by_model))
    if arguments.expect:
        table = read_expected(arguments.expect)
        keys = {(joint.number, row[0], row[1])
                for joint, mine in zip(fragment.joints, rows) for row in mine}
        missing = sorted(keys - set(table))
        if missing:
            raise session.SessionFailed(
                f"{arguments.expect} lacks {len(missing)} observed rows, first {missing[0]}")
        replay = verdict(compare(fragment.joints, rows,
                                 lambda joint, row: table[joint.number, row[0], row[1]]))
        result["ok"] = result["ok"] and replay["ok"]
        result["replay"] = replay
    return result


def run_command(arguments):
    """Everything for each directory; the parts keep their own verdicts."""
    result = {"ok": True, "directories": {}}
    for directory in arguments.directories:
        with tempfile.TemporaryDirectory() as scratch:
            path = os.path.join(scratch, "observed.csv")
            common = {"directory": directory, "keep": arguments.keep}
            parts = {
                "observe": observe_command(argparse.Namespace(
                    out=path, max_seconds=arguments.max_seconds, **common)),
                "check": check_command(argparse.Namespace(
                    observed=path, expect=None, **common)),
                "include": include.through_launcher(Fragment(directory), arguments.keep),
            }
        result["directories"][directory] = parts
        result["ok"] = result["ok"] and all(part["ok"] for part in parts.values())
    return result


def parse_arguments():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    verbs = parser.add_subparsers(dest="verb", required=True)
    verb = {name: verbs.add_parser(name) for name in ("observe", "check", "include", "run")}
    verb["check"].add_argument("observed")
    for name in ("observe", "check", "include"):
        verb[name].add_argument("directory")
    verb["run"].add_argument("directories", nargs="+")
    verb["observe"].add_argument("--out", required=True)
    verb["check"].add_argument("--expect")
    for name in ("observe", "run"):
        verb[name].add_argument("--max-seconds", type=float, default=300.0)
    for name in ("observe", "include", "run"):
        verb[name].add_argument("--keep", action="store_true",
                                help="leave the run directory for inspection")
    return parser.parse_args()


def main():
    arguments = parse_arguments()
    verbs = {"observe": observe_command, "check": check_command, "run": run_command,
             "include": lambda given: include.through_launcher(
                 Fragment(given.directory), given.keep)}
    try:
        if arguments.verb != "check":
            session.assert_version()
        result = verbs[arguments.verb](arguments)
    except session.SessionFailed as failure:
        print(failure, file=sys.stderr)
        return 1
    print(json.dumps(result, indent=1))
    for text in result.get("failures", []):
        print(text, file=sys.stderr)
    return 0 if result["ok"] else 1


if __name__ == "__main__":
    sys.exit(main())
