#!/usr/bin/python3
"""What LinuxCNC swallows in silence, and a lint that refuses exactly that.

  malformed.py show      writes each malformed table, loads it into the real
                         controller and prints what it made of it, as JSON
  malformed.py lint DIR  exit code 1 when a table in DIR is one of these

`show` ends with exit code 1 when the controller behaves otherwise than noted here,
when a variant passes the lint, or when the sound table is not loaded.
"""

import argparse
import concurrent.futures
import json
import os
import sys

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import model  # noqa: E402
import observe  # noqa: E402
import session  # noqa: E402
from fragment import FRAGMENT, Fragment  # noqa: E402

TABLE = "joint_0_X.comp"
SPEED = 300.0
TOLERANCE = 1e-9
# Between the points, on them and outside.
PLACES = (-5.0, 14.0, 20.0, 36.0, 47.0, 68.0, 104.0)


def rows(count=11, step=10.0):
    """A sound table that is nowhere zero, bends at every row and differs by direction."""
    return [f"{n * step:.4f} {0.002 + 0.0001 * n + 0.00003 * (n % 3):.6f}"
            f" {-0.004 + 0.0001 * (n % 4):.6f}" for n in range(count)]


def text(lines):
    return "".join(line + "\n" for line in lines)


def with_line(lines, index, line):
    return lines[:index] + [line] + lines[index:]


def swapped(lines):
    """Row 5 before row 4: the later one is dropped."""
    return lines[:4] + [lines[5], lines[4]] + lines[6:]


def nan_in(lines):
    words = lines[5].split()
    return lines[:5] + [f"{words[0]} nan nan"] + lines[6:]


# name: (file, the sound rows it was meant to be, what becomes of it, operator message)
def variants():
    sound, long_table = rows(), rows(257, 0.390625)
    return {
        "sound": (text(sound), sound, "loaded", False),
        "comment first": (text(with_line(sound, 0, "# X axis")), sound, "none", False),
        "blank line first": (text(with_line(sound, 0, "")), sound, "none", False),
        "comma separators": (text(line.replace(" ", ",") for line in sound), sound, "none",
                             False),
        "blank line inside": (text(with_line(sound, 5, "")), sound, "partial", False),
        "comment inside": (text(with_line(sound, 5, "# middle")), sound, "partial", False),
        "unsorted": (text(swapped(sound)), sound, "partial", True),
        "257 rows": (text(long_table), long_table, "partial", True),
        "nan": (text(nan_in(sound)), sound, "partial", False),
        "section twice": (text(sound), sound, "none", False),
    }


def run_ini(name):
    """One linear joint; for `section twice` the table stands in a second [JOINT_0]."""
    low, high = PLACES[0] - 5, PLACES[-1] + 5
    sections = {key: dict(value) for key, value in session.GLOBAL_INI.items()}
    sections["TRAJ"]["COORDINATES"] = "X"
    sections["KINS"] = {"JOINTS": "1", "KINEMATICS": "trivkins coordinates=X"}
    sections["AXIS_X"] = session.motion_ini(low, high, SPEED)
    sections["JOINT_0"] = {"TYPE": "LINEAR", **session.joint_ini(low, high, SPEED)}
    keys = {"COMP_FILE": TABLE, "COMP_FILE_TYPE": "1"}
    if name == "section twice":
        return session.render_ini(sections) + session.render_ini({"JOINT_0": keys})
    sections["JOINT_0"].update(keys)
    return session.render_ini(sections)


def run_variant(name, keep):
    """Loads one variant and reports where its correction is what was meant."""
    data, meant_lines, expected, message = variants()[name]
    meant = model.Table([tuple(map(float, line.split())) for line in meant_lines])
    places = PLACES + tuple(reversed(PLACES[:-1]))
    plan = {"letters": ["X"], "stops": [
        {"positions": [place], "seconds": 0.1} for place in places]}
    files = {"run.ini": run_ini(name), "run.hal": session.hal_text(1), "tool.tbl": "",
             "plan.json": json.dumps(plan), TABLE: data}
    with session.RunDir(files, keep=keep) as rundir:
        session.run_worker(rundir, [session.PYTHON, "worker.py"], 60)
        with open(rundir.join("result.json")) as source:
            result = json.load(source)
        recorded = observe.read_binary(rundir.join("joint_0.bin"))
    rests = {rest[0] for rest in result["rests"]}
    seen = [{"direction": row[0], "position": row[6], "corr": row[2], "filt": row[3],
             "meant": meant.correction(row[1], row[0])}
            for row in observe.rows_of(recorded, rests) if row[5] == "rest"]
    return judge(name, data, seen, result, (expected, message))


def judge(name, data, seen, result, expected):
    """The outcome, from the numbers alone, beside the expected one."""
    right = sum(abs(row["corr"] - row["meant"]) <= TOLERANCE for row in seen)
    zero = sum(row["corr"] == 0.0 for row in seen)
    outcome = "partial"
    if right == len(seen):
        outcome = "loaded"
    elif zero == len(seen):
        outcome = "none"
    for row in seen:  # JSON has no NaN
        row["corr"] = row["corr"] if row["corr"] == row["corr"] else "nan"
    message = bool(result["messages"])
    findings = model.lint(data.encode())
    # The section is the INI's fault, not the table's: `Fragment` refuses that one.
    refusable = name not in ("sound", "section twice")
    return {"variant": name, "ok": (outcome, message) == expected and bool(seen)
            and bool(findings) == refusable,
            "outcome": outcome, "expected": expected[0], "operator_messages":
            result["messages"], "silent": outcome != "loaded" and not message,
            "places": len(seen), "as_meant": right, "observed": seen,
            "lint": [f"line {number}: {what}" for number, what in findings]}


def show(keep):
    session.assert_version()
    with concurrent.futures.ThreadPoolExecutor(3) as pool:
        results = list(pool.map(lambda name: run_variant(name, keep), variants()))
    return {"ok": all(result["ok"] for result in results), "variants": results}


def lint(directory):
    """Findings over every table of a directory, and over what the fragment names."""
    findings, found = [], sorted(name for name in os.listdir(directory)
                                 if name.endswith(".comp"))
    for name in found:
        with open(os.path.join(directory, name), "rb") as source:
            findings += [f"{name}:{number}: {what}" for number, what in
                         model.lint(source.read())]
    try:
        named = sorted(joint.file for joint in Fragment(directory).joints)
        if named != found:
            findings.append(f"{FRAGMENT} names {named}, the directory holds {found}")
    except session.SessionFailed as failure:
        findings.append(str(failure))
    return {"ok": not findings, "files": found, "findings": findings}


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    verbs = parser.add_subparsers(dest="verb", required=True)
    verbs.add_parser("show").add_argument("--keep", action="store_true")
    verbs.add_parser("lint").add_argument("directory")
    arguments = parser.parse_args()
    try:
        result = show(arguments.keep) if arguments.verb == "show" else lint(arguments.directory)
    except (session.SessionFailed, OSError) as failure:
        print(failure, file=sys.stderr)
        return 1
    print(json.dumps(result, indent=1))
    return 0 if result["ok"] else 1


if __name__ == "__main__":
    sys.exit(main())
