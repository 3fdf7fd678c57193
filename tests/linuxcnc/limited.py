#!/usr/bin/python3
"""The module of `abbe compile --target linuxcnc-kins` with drives that have limits, in the running controller.

  limited.py DIR PROGRAM.json [--keep]

DIR is a compiled set. PROGRAM.json is {"ini": INI text, "tools": lines of the tool table, "ramp": bool, "lines": [...]}.
The drives follow the commands of the joints (limit3) with 1.25 times MAX_VELOCITY and MAX_ACCELERATION of [JOINT_n].
Each of "lines" is run by MDI to its end and to the end of a ramp of the tool; the lines behind a failed one are left
out. Without "ramp" abbekins.ramp does not run.
Prints JSON: {"package", "lines": [{"line", "failed": text or null, "before", "after": joint commands, "step",
"acceleration": the largest of each joint from one servo cycle to the next (mm, deg) and by differences (per s2),
"moved_in_ramp": largest way of a joint of a rotary axis while the tool was ramped, deg, "zone": was the pin pole-zone
seen set}, ...]}.
"""

import argparse
import json
import os
import re
import sys

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import kins  # noqa: E402
import session  # noqa: E402

FACTOR = 1.25
PERIOD = 0.001
RAMP = "addf abbekins.ramp servo-thread\n"


def hal(ini):
    """The HAL file of the simulation with drives between the commands and the feedback."""
    sections = session.parse_ini(ini)
    joints = int(sections["KINS"]["JOINTS"])
    with open("sim.hal") as source:
        text = source.read()
    for n in range(joints):
        limits = sections[f"JOINT_{n}"]
        direct = f"net joint-{n} joint.{n}.motor-pos-cmd => joint.{n}.motor-pos-fb\n"
        if text.count(direct) != 1:
            raise session.SessionFailed(f"sim.hal has no `{direct}`")
        drive = [f"net {session.motor(n)} joint.{n}.motor-pos-cmd => drive-{n}.in",
                 f"net drive-{n} drive-{n}.out => joint.{n}.motor-pos-fb",
                 f"setp drive-{n}.maxv {FACTOR * float(limits['MAX_VELOCITY'])}",
                 f"setp drive-{n}.maxa {FACTOR * float(limits['MAX_ACCELERATION'])}"]
        text = text.replace(direct, "\n".join(drive) + "\n")
    names = ",".join(f"drive-{n}" for n in range(joints))
    behind = "addf motion-controller servo-thread\n"
    loaded = f"loadrt limit3 names={names}\n" + behind + "".join(f"addf drive-{n} servo-thread\n" for n in range(joints))
    text = "loadrt tpmod\nloadrt homemod\n" + text.replace(behind, loaded, 1)
    return text + session.sampled(joints)


def worker():
    with open("program.json") as source:
        program = json.load(source)
    if not program["ramp"]:
        with open("abbekins.hal") as source:
            text = source.read()
        if text.count(RAMP) != 1:
            raise session.SessionFailed("abbekins.hal has no ramp")
        with open("abbekins.hal", "w") as out:
            out.write(text.replace(RAMP, ""))
    with open("run.hal", "w") as out:
        out.write(hal(program["ini"]))
    controller = session.Controller("sim.ini", "run.hal", kins.joint_count())
    controller.start()
    controller.open_samplers()
    controller.home()
    controller.wait("the correction", lambda: controller.pin("abbe-ramp.out") == 1)
    result = {"lines": []}
    for line in kins.START + program["lines"]:
        result["lines"].append(watched(controller, line))
        if result["lines"][-1]["failed"]:
            break
    result["lines"] = result["lines"][len(kins.START):]
    with open("result.json", "w") as out:
        json.dump(result, out)
    return 0


def commands(controller):
    return [controller.pin(f"joint.{n}.pos-cmd") for n in range(controller.joints)]


def watched(controller, line):
    """Runs a line, and says what the joints did."""
    samples = [[] for _ in controller.streams]
    for stream in controller.streams:
        while stream.read() is not None:
            pass
    before = commands(controller)
    state = {"moved": 0.0, "zone": False}

    def look():
        now = commands(controller)
        # Still ramping after the look: it was before.
        if controller.pin("abbekins.tool-ramping"):
            state["moved"] = max(state["moved"], *(abs(a - b) for a, b in zip(now[3:], before[3:])))
        state["zone"] = state["zone"] or bool(controller.pin("abbekins.pole-zone"))
        drain(controller, samples)
        session.time.sleep(0.0005)
    failed = None
    try:
        controller.mdi(line, 60, look)
        controller.wait("the tool", lambda: not controller.pin("abbekins.tool-ramping"), 60, look)
    except session.SessionFailed as failure:
        failed = str(failure)
    end = session.time.monotonic() + 0.3
    while session.time.monotonic() < end:
        look()
    controller.drain_messages()
    if failed is None and controller.stat.task_state != controller.linuxcnc.STATE_ON:
        failed = f"machine off: {controller.messages}"
    drain(controller, samples)
    if sum(controller.overruns()):
        raise session.SessionFailed(f"samples were lost: {controller.overruns()}")
    step = [most(difference(one)) for one in samples]
    bend = [most(difference(difference(one))) / PERIOD**2 for one in samples]
    return {"line": line, "failed": failed, "before": before, "after": commands(controller), "step": step,
            "acceleration": bend, "moved_in_ramp": state["moved"], "zone": state["zone"]}


def drain(controller, samples):
    for stream, kept in zip(controller.streams, samples):
        sample = stream.read()
        while sample is not None:
            kept.append(sample[0])
            sample = stream.read()


def difference(numbers):
    return [b - a for a, b in zip(numbers, numbers[1:])]


def most(numbers):
    return max((abs(x) for x in numbers), default=0.0)


def run(directory, program, keep):
    ini = re.sub(r"^DISPLAY = .*$", "DISPLAY = none", program["ini"], count=1, flags=re.MULTILINE)
    files = {"program.json": json.dumps(program), "sim.ini": ini}
    with open(os.path.join(directory, "sim.tbl")) as source:
        table = source.read()
    argv = [session.PYTHON, "limited.py", "--worker", table + program["tools"]]
    return kins.in_sandbox(directory, files, argv, keep)


def main():
    if sys.argv[1:2] == ["--worker"]:
        with open("sim.tbl", "w") as out:
            out.write(sys.argv[2])
        return worker()
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("directory")
    parser.add_argument("program")
    parser.add_argument("--keep", action="store_true")
    arguments = parser.parse_args()
    with open(arguments.program) as source:
        program = json.load(source)
    return session.report(lambda: run(arguments.directory, program, arguments.keep))


if __name__ == "__main__":
    sys.exit(main())
