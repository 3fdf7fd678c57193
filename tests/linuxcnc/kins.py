#!/usr/bin/python3
"""The kinematics module of `abbe compile --target linuxcnc-kins` in the running controller.

  kins.py DIR PROGRAM.json [--keep]

DIR is a compiled set; its abbekins.comp is built with halcompile and its simulation (sim.ini, sim.hal)
is started, faster than it is and with wide limits. PROGRAM.json is {"lines": [{"mdi": "G0 X1", "record":
true, "enable": true}, ...]}: each line is run to its end, in G54 with the tool T1 of the set (G43 H1).
Prints JSON: {"package", "joints": [[motor commands less the motor's offset] per recorded line],
"pins": [{iterations, residual, failures, largest} per recorded line], "back": [[actual position of the
status channel, machine coordinates] per recorded line]}; mm and deg.
"""

import argparse
import json
import os
import re
import shutil
import subprocess
import sys

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import session  # noqa: E402

FILES = ("abbekins.hal", "sim.hal", "sim.var", "sim.tbl")
# The launcher loads the first two; the last four count servo cycles.
HAL = """loadrt tpmod
loadrt homemod
source sim.hal
setp abbe-ramp.maxv 1e6
loadrt sum2 names=cycles
addf cycles servo-thread
net cycles cycles.out => cycles.in0
setp cycles.in1 1
"""
PINS = ("iterations", "residual", "failures", "largest")
# A motion of this length is none to the controller.
ARRIVED = 1e-10
# Servo cycles after which the interpolators between tip and joints stand still.
QUIET = 10
START = ["G21 G90 G94 G54 G49", "G43 H1"]
FAST = {"MAX_VELOCITY": "20000", "MAX_ACCELERATION": "4e6", "MIN_LIMIT": "-1e5", "MAX_LIMIT": "1e5",
        "MAX_LINEAR_VELOCITY": "20000", "MAX_ANGULAR_VELOCITY": "20000",
        "DEFAULT_LINEAR_VELOCITY": "20000", "DEFAULT_ANGULAR_VELOCITY": "20000",
        "DISPLAY": "none"}


def hurried(ini):
    """The same simulation without waiting for it: paths between poses are nobody's concern."""
    def value(match):
        return f"{match[1]} = {FAST[match[1]]}" if match[1] in FAST else match[0]
    return re.sub(r"^(\w+) = .*$", value, ini, flags=re.MULTILINE)


def build(source, target):
    """halcompile in a copy of the set; the module's path."""
    shutil.copytree(source, target)
    done = subprocess.run(["halcompile", "--compile", "abbekins.comp"], cwd=target, text=True,
                          capture_output=True, check=False)
    module = os.path.join(target, "abbekins.so")
    if done.returncode != 0 or "warning" in done.stdout + done.stderr or not os.path.exists(module):
        raise session.SessionFailed(f"halcompile: {done.stdout}\n{done.stderr}")
    return module


def worker():
    """Inside the sandbox: runs program.json, writes result.json."""
    with open("program.json") as source:
        lines = json.load(source)["lines"]
    with open("sim.ini") as source:
        joints = int(re.search(r"^JOINTS = (\d+)$", source.read(), re.MULTILINE)[1])
    controller = session.Controller("sim.ini", "run.hal", joints)
    controller.start()
    controller.home()
    def idle():
        session.time.sleep(0.001)
    for line in START:
        controller.mdi(line, 10, idle)
    with open("sim.var") as source:
        offsets = dict(line.split() for line in source)
    zero = [float(offsets[str(5221 + k)]) for k in range(9)]
    result = {"joints": [], "pins": [], "back": []}
    for line in lines:
        controller.hal.set_p("abbekins.enable", "1" if line["enable"] else "0")
        controller.mdi(line["mdi"], 20, idle)
        controller.wait(f"arrival of {line['mdi']}", lambda: arrived(controller.stat, zero, line["mdi"]), 20, idle)
        if line["record"]:
            result["joints"].append(settled(controller))
            result["pins"].append({name: controller.pin(f"abbekins.{name}") for name in PINS})
            controller.stat.poll()
            result["back"].append(list(controller.stat.actual_position))
    result["tool"] = [controller.pin(f"abbekins.tool-{letter}") for letter in "xyz"]
    with open("result.json", "w") as out:
        json.dump(result, out)
    return 0


def arrived(stat, zero, mdi):
    """Is the commanded position the programmed one? The status may still be that of before."""
    stat.poll()
    for word in mdi.split()[1:]:
        k = "XYZABCUVW".index(word[0])
        target = float(word[1:]) + zero[k] + stat.tool_offset[k]
        if abs(stat.position[k] - target) > ARRIVED:
            return False
    return True


def settled(controller):
    """Motor commands less the motor's offset, some servo cycles after the arrival."""
    def read():
        return [controller.pin(f"joint.{n}.motor-pos-cmd") - controller.pin(f"joint.{n}.motor-offset")
                for n in range(controller.joints)]
    start = controller.pin("cycles.out")
    controller.wait("standstill", lambda: controller.pin("cycles.out") > start + QUIET, 20)
    return read()


def run(directory, program, keep):
    """Builds, runs in the sandbox, and gives the result."""
    files = {"program.json": program}
    with open(os.path.join(directory, "sim.ini")) as source:
        files["sim.ini"] = hurried(source.read())
    files["run.hal"] = HAL
    with session.RunDir(files, [os.path.join(directory, name) for name in FILES], keep) as rundir:
        module = build(directory, rundir.join("set"))
        os.mkdir(rundir.join("modules"))
        os.rename(module, rundir.join("modules", "abbekins.so"))
        argv = [session.PYTHON, "kins.py", "--worker"]
        session.run_worker(rundir, argv, 120, modules=rundir.join("modules"))
        with open(rundir.join("result.json")) as source:
            result = json.load(source)
        result["log"] = session.logs(rundir.join("log")) if keep else ""
    return result


def main():
    if sys.argv[1:] == ["--worker"]:
        return worker()
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("directory")
    parser.add_argument("program")
    parser.add_argument("--keep", action="store_true")
    arguments = parser.parse_args()
    try:
        package = session.assert_version()
        with open(arguments.program) as source:
            result = run(arguments.directory, source.read(), arguments.keep)
    except session.SessionFailed as failure:
        print(failure, file=sys.stderr)
        return 1
    result["package"] = package
    print(json.dumps(result))
    return 0


if __name__ == "__main__":
    sys.exit(main())
