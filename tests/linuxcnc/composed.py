#!/usr/bin/python3
"""Kinematic parameters and COMP_FILE tables together in the running controller.

  composed.py DIR PROGRAM.json [--keep]

DIR is a set of two targets: linuxcnc/ (tables) and one more subfolder, whose one HAL file is sourced. PROGRAM.json is
{"module": name, "coordinates": "XYZAC", "tool": {"letter": "Z", "length": 120}, "steps": [...]}. A step is {"mdi": line},
with "record": true if the joints count behind it, or {"pin": name, "add": number}. G43 H1 is in force.
Prints JSON: {"package", "motors": [[motor-pos-cmd of every joint] per record], "joints": [[pos-cmd] per record]};
mm and deg. The joints of the tables are found by their letters.
"""

import argparse
import json
import os
import sys

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import session  # noqa: E402
from fragment import Fragment  # noqa: E402

# The way between poses is nobody's concern. A table is looked up a last step of braking before the end, 1e-3 mm here.
FAST, QUICK = 2000.0, 20000.0
# A correction stands still up to half of acceleration x period^2 before its end: 0.009 um, 0.05 urad.
CALM = {"LINEAR": 300.0, "ANGULAR": 100.0}
RANGE = 1e5
START = ["G21 G90 G94 G54 G49", "G43 H1"]
# The motors must be the same over so many servo cycles.
QUIET = 120


def ini(module, coordinates, tables):
    """A complete INI: every joint homed on the spot, with the table of its letter."""
    sections = {name: dict(keys) for name, keys in session.GLOBAL_INI.items()}
    speeds = {key: str(FAST) for key in sections["TRAJ"] if key.endswith("VELOCITY")}
    rates = {key: str(QUICK) for key in sections["TRAJ"] if key.endswith("ACCELERATION")}
    sections["TRAJ"].update(speeds, **rates, COORDINATES=" ".join(coordinates))
    sections["KINS"] = {"KINEMATICS": module, "JOINTS": str(len(coordinates))}
    for number, letter in enumerate(coordinates):
        kind = "ANGULAR" if letter in "ABC" else "LINEAR"
        axis = session.motion_ini(-RANGE, RANGE, FAST)
        joint = session.joint_ini(-RANGE, RANGE, FAST)
        axis["MAX_ACCELERATION"], joint["MAX_ACCELERATION"] = str(QUICK), str(CALM[kind])
        if letter in tables:
            joint.update({"COMP_FILE": tables[letter].file, "COMP_FILE_TYPE": "1"})
        sections[f"JOINT_{number}"] = {"TYPE": kind, **joint}
        sections[f"AXIS_{letter}"] = axis
    return session.render_ini(sections)


def read(controller, pin):
    return [controller.pin(f"joint.{number}.{pin}") for number in range(controller.joints)]


def settled(controller):
    """Motor commands, once the corrections stand still."""
    seen = {"now": None, "since": 0}

    def still():
        cycle, now = controller.pin("cycles.out"), read(controller, "motor-pos-cmd")
        if now != seen["now"]:
            seen.update(now=now, since=cycle)
        return cycle - seen["since"] > QUIET

    controller.wait("standstill", still)
    return seen["now"]


def worker():
    """Inside the sandbox: runs program.json, writes result.json."""
    with open("program.json") as source:
        program = json.load(source)
    controller = session.Controller(joints=len(program["coordinates"]))
    controller.start()
    controller.home()

    def idle():
        session.time.sleep(0.001)

    for line in START:
        controller.mdi(line, 10, idle)
    result = {"motors": [], "joints": []}
    for step in program["steps"]:
        if "pin" in step:
            value = controller.pin(step["pin"]) + step["add"]
            controller.hal.set_p(step["pin"], repr(value))
            continue
        controller.mdi(step["mdi"], 20, idle)
        if step.get("record"):
            result["motors"].append(settled(controller))
            result["joints"].append(read(controller, "pos-cmd"))
    controller.drain_messages()
    result["messages"] = controller.messages
    with open("result.json", "w") as out:
        json.dump(result, out)
    return 0


def run(directory, text, keep):
    program = json.loads(text)
    folders = [name for name in os.listdir(directory) if os.path.isdir(os.path.join(directory, name))]
    parts = [name for name in folders if name != "restore"]
    other = next(name for name in parts if name != "linuxcnc")
    (hal,) = [name for name in os.listdir(os.path.join(directory, other)) if name.endswith(".hal")]
    tables = {joint.letter: joint for joint in Fragment(os.path.join(directory, "linuxcnc")).joints}
    tool = program["tool"]
    files = {"run.ini": ini(program["module"], program["coordinates"], tables), "program.json": text,
             "run.hal": session.bare_hal(len(program["coordinates"])) + session.CYCLES + f"source {hal}\n",
             "tool.tbl": f"T1 P1 {tool['letter']}{tool['length']}\n"}
    copies = [os.path.join(directory, other, hal)] + [joint.path for joint in tables.values()]
    with session.RunDir(files, copies, keep) as rundir:
        session.run_worker(rundir, [session.PYTHON, "composed.py", "--worker"], 180)
        with open(rundir.join("result.json")) as source:
            result = json.load(source)
    if result["messages"]:
        raise session.SessionFailed(f"operator messages: {result['messages']}")
    return result


def main():
    if sys.argv[1:] == ["--worker"]:
        return worker()
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("directory")
    parser.add_argument("program")
    parser.add_argument("--keep", action="store_true")
    arguments = parser.parse_args()
    def measured():
        with open(arguments.program) as source:
            return run(arguments.directory, source.read(), arguments.keep)

    return session.report(measured)


if __name__ == "__main__":
    sys.exit(main())
