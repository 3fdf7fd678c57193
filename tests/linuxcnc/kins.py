#!/usr/bin/python3
"""The kinematics module of `abbe compile --target linuxcnc-kins` in the running controller.

  kins.py DIR PROGRAM.json [--keep]
  kins.py DIR --launcher [--keep]

DIR is a compiled set; its abbekins.comp is built with halcompile and its simulation (sim.ini, sim.hal)
is started, faster than it is and with wide limits. PROGRAM.json is {"lines": [{"mdi": "G0 X1", "record":
true, "enable": true}, ...]}: each line is run to its end, in G54 with the tool T1 of the set (G43 H1); with
"refused": "words" the controller must refuse it with these words.
Prints JSON: {"package", "joints": [[motor commands less the motor's offset] per recorded line],
"pins": [{iterations, residual, failures, largest} per recorded line], "back": [[actual position of the
status channel, machine coordinates] per recorded line]}; mm and deg.

--launcher starts sim.ini as it is, but for its display, with the stock launcher, goes to X100 Y150 Z100 A-20 C30, and
switches the correction off and on again by abbe-switch.sel. Prints JSON: {"on", "off", "again": joints,
"shares": [...], "largest_step": the longest way of a joint between two looks while it fades}.
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
# Its messages go to a terminal or to files; what counts is the result.
LAUNCHER = """#!/bin/sh
linuxcnc -r sim.ini </dev/null
test -s result.json
"""
# The launcher loads the first two.
HAL = """loadrt tpmod
loadrt homemod
source sim.hal
setp abbe-ramp.maxv 1e6
""" + session.CYCLES
PINS = ("iterations", "residual", "failures", "largest")
# A motion of this length is none to the controller.
ARRIVED = 1e-10
# A joint that moves by less stands; the status channel is at its place.
STILL, BACK = 1e-9, 1e-9
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
    controller = session.Controller("sim.ini", "run.hal", joint_count())
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
        if "refused" in line:
            refused(controller, line, idle)
            continue
        controller.mdi(line["mdi"], 20, idle)
        controller.wait(f"arrival of {line['mdi']}", lambda: arrived(controller.stat, zero, line["mdi"]), 20, idle)
        if line["record"]:
            result["joints"].append(settled(controller))
            result["pins"].append({name: controller.pin(f"abbekins.{name}") for name in PINS})
            result["back"].append(position(controller, zero, line["mdi"]))
    result["tool"] = [controller.pin(f"abbekins.tool-{letter}") for letter in "xyz"]
    with open("result.json", "w") as out:
        json.dump(result, out)
    return 0


def refused(controller, line, idle):
    """The controller must say why it does not move, and stand still."""
    before = motors(controller)
    try:
        controller.mdi(line["mdi"], 2, idle)
    except session.SessionFailed as failure:
        moved = max(abs(a - b) for a, b in zip(motors(controller), before))
        if line["refused"] in str(failure) and moved < STILL:
            return
        raise session.SessionFailed(f"{failure}; joints moved by {moved}") from failure
    raise session.SessionFailed(f"{line['mdi']} was not refused")


def motors(controller):
    """Motor commands less the motor's offset and what the tables beside the module add for the direction of approach."""
    return [controller.pin(f"joint.{n}.motor-pos-cmd") - controller.pin(f"joint.{n}.motor-offset")
            - controller.pin(f"joint.{n}.backlash-filt") for n in range(controller.joints)]


def arrived(stat, zero, mdi):
    """Is the commanded position the programmed one? The status may still be that of before."""
    stat.poll()
    return far(stat, stat.position, zero, mdi) <= ARRIVED


def far(stat, position, zero, mdi):
    """How far a position of the status channel is from the programmed one."""
    def target(word, k):
        return float(word[1:]) + zero[k] + stat.tool_offset[k]
    words = [(word, "XYZABCUVW".index(word[0])) for word in mdi.split()[1:]]
    return max((abs(position[k] - target(word, k)) for word, k in words), default=0.0)


def position(controller, zero, mdi):
    """The actual position of the status channel, which lags behind on a busy computer: what it holds at the
    programmed one, or at last."""
    end = session.time.monotonic() + 3
    while True:
        controller.stat.poll()
        actual = list(controller.stat.actual_position)
        if far(controller.stat, actual, zero, mdi) < BACK or session.time.monotonic() > end:
            return actual
        session.time.sleep(0.002)


class Launched(session.Controller):
    """A controller that the launcher has started."""

    def fade(self, share, result):
        """Switches, and watches the joints until the ramp has arrived."""
        self.hal.set_p("abbe-switch.sel", str(share))
        before = motors(self)
        while self.pin("abbe-ramp.out") != share:
            session.time.sleep(0.01)
            now = motors(self)
            result["shares"].append(self.pin("abbe-ramp.out"))
            step = max(abs(a - b) for a, b in zip(now, before))
            result["largest_step"] = max(result["largest_step"], step)
            before = now
        return self.at_rest()

    def at_rest(self):
        """Motor commands once ten looks find the same: on a busy computer few servo cycles pass between two."""
        last, same = motors(self), 0
        end = session.time.monotonic() + 20
        while same < 10:
            if session.time.monotonic() > end:
                raise session.SessionFailed("timeout: standstill")
            session.time.sleep(0.05)
            now = motors(self)
            last, same = now, same + 1 if now == last else 0
        return last


def display():
    """The launcher's display program."""
    controller = Launched("sim.ini", joints=joint_count())
    controller.attach()
    controller.home()
    for line in START + ["G0 X100 Y150 Z100 A-20 C30"]:
        controller.mdi(line, 30, lambda: session.time.sleep(0.01))
    result = {"shares": [], "largest_step": 0.0}
    controller.wait("the correction", lambda: controller.pin("abbe-ramp.out") == 1)
    result["on"] = controller.at_rest()
    result["off"] = controller.fade(0, result)
    result["again"] = controller.fade(1, result)
    with open("result.json", "w") as out:
        json.dump(result, out)
    return 0


def joint_count():
    with open("sim.ini") as source:
        return int(re.search(r"^JOINTS = (\d+)$", source.read(), re.MULTILINE)[1])


def settled(controller):
    """Motor commands less the motor's offset, some servo cycles after the arrival."""
    start = controller.pin("cycles.out")
    controller.wait("standstill", lambda: controller.pin("cycles.out") > start + QUIET, 20)
    return motors(controller)


def run(directory, program, keep):
    """A program through the simulation in a hurry."""
    with open(os.path.join(directory, "sim.ini")) as source:
        ini = hurried(source.read())
    files = {"program.json": program, "sim.ini": ini, "run.hal": HAL}
    return in_sandbox(directory, files, [session.PYTHON, "kins.py", "--worker"], keep)


def launch(directory, keep):
    """The simulation as it is, with the stock launcher."""
    with open(os.path.join(directory, "sim.ini")) as source:
        ini = source.read()
    shown = "DISPLAY = linuxcncrsh"
    if ini.count(shown) != 1:
        raise session.SessionFailed(f"sim.ini has no `{shown}`")
    files = {"sim.ini": ini.replace(shown, "DISPLAY = ./display.sh"), "launch.sh": LAUNCHER,
             "display.sh": f"#!/bin/sh\nexec {session.PYTHON} kins.py --display > log/display.log 2>&1\n"}
    return in_sandbox(directory, files, ["sh", "launch.sh"], keep)


def in_sandbox(directory, files, argv, keep):
    """Builds, runs in the sandbox, and gives the result."""
    beside = [name for name in sorted(os.listdir(directory)) if name.startswith("reversal_")]
    with session.RunDir(files, [os.path.join(directory, name) for name in (*FILES, *beside)], keep) as rundir:
        module = build(directory, rundir.join("set"))
        os.mkdir(rundir.join("modules"))
        os.rename(module, rundir.join("modules", "abbekins.so"))
        for name in (name for name in files if name.endswith(".sh")):
            os.chmod(rundir.join(name), 0o755)
        session.run_worker(rundir, argv, 120, modules=rundir.join("modules"))
        with open(rundir.join("result.json")) as source:
            result = json.load(source)
        result["log"] = session.logs(rundir.join("log")) if keep else ""
    return result


def main():
    if sys.argv[1:] == ["--worker"]:
        return worker()
    if sys.argv[1:] == ["--display"]:
        return display()
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("directory")
    parser.add_argument("program", nargs="?")
    parser.add_argument("--launcher", action="store_true")
    parser.add_argument("--keep", action="store_true")
    arguments = parser.parse_args()
    def measured():
        if arguments.launcher:
            return launch(arguments.directory, arguments.keep)
        with open(arguments.program) as source:
            return run(arguments.directory, source.read(), arguments.keep)

    return session.report(measured)


if __name__ == "__main__":
    sys.exit(main())
