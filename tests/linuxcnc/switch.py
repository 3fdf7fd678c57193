#!/usr/bin/python3
"""M428 and M429 with the kinematics module of `abbe compile --target linuxcnc-kins`, in the running controller.

  switch.py DIR [--identity-first] [--keep]

DIR is a compiled set. Its simulation gets remaps of M428 (type 0) and M429 (type 1) as owners of trt kinematics have
them: an analog output drives motion.switchkins-type, with the interpreter synchronised before and after. The worker
goes to a tilted pose by X Y Z and the rotary words, switches, moves one joint by its word, switches back, and goes to
the pose again. Type 2 must be refused.
Prints JSON: {"package", "states": [{"what", "joints", "position", "tcp"}, ...], "jumps": [largest way of a joint while
the kinematics are switched, ...], "refused": joints' way at the refused type}; mm and deg.
"""

import argparse
import json
import os
import sys

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import kins  # noqa: E402
import session  # noqa: E402

POSE = "G0 X100 Y150 Z100 A-20 C30"
REMAP = """o<{code}remap>sub
M66 E0 L0
M68 E3 Q{type}
M66 E0 L0
o<{code}remap>endsub
M2
"""
INI = """[RS274NGC]
SUBROUTINE_PATH = .
REMAP = M428 modalgroup=10 ngc=428remap
REMAP = M429 modalgroup=10 ngc=429remap
REMAP = M430 modalgroup=10 ngc=430remap
"""


def state(controller, what):
    joints = kins.settled(controller)
    controller.stat.poll()
    return {"what": what, "joints": joints, "position": list(controller.stat.position),
            "tcp": bool(controller.pin("abbekins.tcp"))}


def switch(controller, code):
    """Switches; the largest way of a joint meanwhile."""
    before, far = kins.motors(controller), [0.0]

    def look():
        now = kins.motors(controller)
        far[0] = max(far[0], *(abs(a - b) for a, b in zip(now, before)))
        session.time.sleep(0.0005)
    controller.mdi(code, 10, look)
    end = session.time.monotonic() + 0.2
    while session.time.monotonic() < end:
        look()
    return far[0]


def worker(first):
    """`first` is the code of the error model, the other one that of identity."""
    tcp, identity = ("M429", "M428") if first else ("M428", "M429")
    # The interpreter finds its remaps by this, which the launcher sets.
    os.environ["INI_FILE_NAME"] = os.path.abspath("sim.ini")
    controller = session.Controller("sim.ini", "run.hal", kins.joint_count())
    controller.start()
    controller.home()

    def idle():
        session.time.sleep(0.001)
    result = {"states": [], "jumps": []}

    def keep(what):
        result["states"].append(state(controller, what))

    def move(line):
        controller.mdi(line, 30, idle)

    keep("homed")
    if first:
        result["jumps"].append(switch(controller, tcp))
    for line in kins.START + [POSE]:
        move(line)
    keep("pose")
    result["jumps"].append(switch(controller, identity))
    keep("identity")
    move("G91")
    move("G0 X-3")
    move("G90")
    keep("joint moved")
    result["jumps"].append(switch(controller, tcp))
    keep("back")
    move(POSE)
    keep("pose again")
    before = kins.motors(controller)
    try:
        switch(controller, "M430")
    except session.SessionFailed as failure:
        result["message"] = str(failure)
    session.time.sleep(0.2)
    result["refused"] = max(abs(a - b) for a, b in zip(kins.motors(controller), before))
    result["still_tcp"] = bool(controller.pin("abbekins.tcp"))
    with open("result.json", "w") as out:
        json.dump(result, out)
    return 0


def run(directory, first, keep):
    with open(os.path.join(directory, "sim.ini")) as source:
        ini = kins.hurried(source.read()).replace("[RS274NGC]\n", INI, 1)
    if first:
        ini = ini.replace("KINEMATICS = abbekins", "KINEMATICS = abbekins sparm=identityfirst", 1)
    files = {"sim.ini": ini, "run.hal": kins.HAL}
    files.update({f"{428 + k}remap.ngc": REMAP.format(code=428 + k, type=k) for k in range(3)})
    argv = [session.PYTHON, "switch.py", "--worker"] + (["--identity-first"] if first else [])
    return kins.in_sandbox(directory, files, argv, keep)


def main():
    if sys.argv[1:2] == ["--worker"]:
        return worker("--identity-first" in sys.argv)
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("directory")
    parser.add_argument("--identity-first", action="store_true")
    parser.add_argument("--keep", action="store_true")
    arguments = parser.parse_args()
    return session.report(lambda: run(arguments.directory, arguments.identity_first, arguments.keep))


if __name__ == "__main__":
    sys.exit(main())
