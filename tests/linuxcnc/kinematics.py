#!/usr/bin/python3
"""Ideal forward kinematics from LinuxCNC's shipped modules, called in-process.

  kinematics.py [--seed N] [--machines N] [--poses N] [--keep]
  kinematics.py --ask FILE.json

Prints JSON: {"ok", "package", "modules": {name: differences}, "machines": [{"module",
"pins", "yaml"}], "items": [{"module", "machine", "pins", "joints": {letter: value},
"position": [x, y, z, a, b, c, u, v, w]}]}; mm and deg. `machine` is an index into
`machines`, whose yaml says the same kinematics in abbe's machine language.

FILE.json is {"module": name, "sets": [{"pins": {name: value}, "poses": [{"joints": {letter: value}}]}]};
the sets are printed with "position" (forward) and "back" (inverse of it) in every pose.

How the modules are said there (all origins in machine coordinates at the zero pose,
R = rot-point pins, tip of the tool at machine zero at the zero pose, no workpiece
origin, so that the nominal position of the tip is the module's x, y, z):

xyzac-trt-kins   chain "w C' A' b X Y Z t"; C: sense direct, origin R; A: sense direct,
                 origin R + (0, y-offset, z-offset + tool-offset). x-offset acts nowhere.
xyzbc-trt-kins   chain "w C' B' b X Y Z t"; C: sense direct, origin R; B: sense direct,
                 origin R + (x-offset, 0, z-offset + tool-offset). y-offset acts nowhere.
5axiskins        chain "w b X Y Z C B W t"; C about the Z line through machine zero;
                 B left-handed about Y: direction [0, -1, 0], origin [0, 0, P] with
                 P = pivot-length; W positive moves the tip away from the pivot: direction
                 [0, 0, -1]; the gauge point is the pivot and the tool has length P.

`direct` because a positive A, B or C turns the table itself right-handed; the linear
axes keep the ISO 841 sense (a positive X moves the tool in +X of the workpiece), so
each of them may as well stand on the workpiece side. Each claim is checked against
the modules: by the closed forms below and by a product of turns about lines that is
built from the very description of which the yaml is rendered.
"""

import argparse
import ctypes
import json
import math
import os
import random
import sys

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import session  # noqa: E402

MODULES = ("xyzac-trt-kins", "xyzbc-trt-kins", "5axiskins")
MODULE_DIR = "/usr/lib/linuxcnc/modules"
LETTERS = {"xyzac-trt-kins": "XYZAC", "xyzbc-trt-kins": "XYZBC", "5axiskins": "XYZBCW"}
TRT_PINS = ("x-rot-point", "y-rot-point", "z-rot-point", "x-offset", "y-offset",
            "z-offset", "tool-offset")
MAX_JOINTS = 16
POSITION = "xyzabcuvw"
TOLERANCE = 1e-10


# --- seeded inputs --------------------------------------------------------------


def random_pins(module, generator, first):
    """The first set is the plain one: no offsets, or the default pivot."""
    if module == "5axiskins":
        return {"pivot-length": 250.0 if first else generator.uniform(50, 400)}
    return {name: 0.0 if first else generator.uniform(-300, 300) for name in TRT_PINS}


def random_joints(module, generator, number):
    """Joint values; the first pose is zero and the next ones turn by right angles."""
    if number == 0:
        return {letter: 0.0 for letter in LETTERS[module]}
    joints = {letter: generator.uniform(-500, 500) for letter in LETTERS[module]}
    for letter in set(joints) & set("ABC"):
        joints[letter] = generator.uniform(-360, 360)
        if number < 5:
            joints[letter] = 90.0 * generator.randint(-4, 4)
    return joints


# --- inside the sandbox ---------------------------------------------------------


class Pose(ctypes.Structure):
    """EmcPose: nine doubles."""

    _fields_ = [(name, ctypes.c_double) for name in POSITION]


class Module:
    """One kinematics module, loaded as the real-time loader would, in this process."""

    def __init__(self, name):
        import hal
        self.hal, self.name = hal, name
        ctypes.CDLL("liblinuxcnchal.so.0", mode=ctypes.RTLD_GLOBAL)
        self.component = hal.component("abbe-test")
        self.component.ready()
        self.library = ctypes.CDLL(os.path.join(MODULE_DIR, name + ".so"))
        if self.library.rtapi_app_main() != 0:
            raise session.SessionFailed(f"{name}: rtapi_app_main failed")
        self.flags = ctypes.c_ulong(0), ctypes.c_ulong(0)

    def set_pins(self, pins):
        for pin, value in pins.items():
            self.hal.set_p(f"{self.name}.{pin}", repr(value))
            if self.hal.get_value(f"{self.name}.{pin}") != value:
                raise session.SessionFailed(f"{self.name}.{pin} did not take {value}")

    def forward(self, values):
        joints = (ctypes.c_double * MAX_JOINTS)(*values)
        pose = Pose()
        code = self.library.kinematicsForward(
            joints, ctypes.byref(pose), *map(ctypes.byref, self.flags))
        if code != 0:
            raise session.SessionFailed(f"{self.name}: kinematicsForward gave {code}")
        return [getattr(pose, name) for name in POSITION]

    def inverse(self, position, count):
        joints = (ctypes.c_double * MAX_JOINTS)()
        code = self.library.kinematicsInverse(
            ctypes.byref(Pose(*position)), joints, *map(ctypes.byref, self.flags))
        if code != 0:
            raise session.SessionFailed(f"{self.name}: kinematicsInverse gave {code}")
        return joints[:count]


def worker(name):
    """Fills in what the module says about the poses of ask.json."""
    with open("ask.json") as source:
        sets = json.load(source)
    module, letters = Module(name), LETTERS[name]
    for each in sets:
        module.set_pins(each["pins"])
        for pose in each["poses"]:
            values = [pose["joints"][letter] for letter in letters]
            pose["position"] = module.forward(values)
            pose["back"] = module.inverse(pose["position"], len(letters))
    with open("answer.json", "w") as out:
        json.dump(sets, out)


# --- closed forms ---------------------------------------------------------------


def turn(axis, degrees, vector):
    """`vector` turned right-handed about a coordinate axis (0, 1, 2)."""
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    second, third = (axis + 1) % 3, (axis + 2) % 3
    result = list(vector)
    result[second] = c * vector[second] - s * vector[third]
    result[third] = s * vector[second] + c * vector[third]
    return result


def plus(*vectors):
    return [sum(parts) for parts in zip(*vectors)]


def minus(left, right):
    return [a - b for a, b in zip(left, right)]


def rot_point(pins):
    return [pins[f"{letter}-rot-point"] for letter in "xyz"]


def tilt_offset(module, pins):
    """From the rot-point to the tilting axis."""
    height = pins["z-offset"] + pins["tool-offset"]
    if module == "xyzac-trt-kins":
        return [0.0, pins["y-offset"], height]
    return [pins["x-offset"], 0.0, height]


def closed_form(module, pins, joints):
    """Position of the tip in workpiece coordinates, written down by hand."""
    linear = [joints[letter] for letter in "XYZ"]
    if module == "5axiskins":
        pivot = pins["pivot-length"]
        arm = turn(2, joints["C"], turn(1, -joints["B"], [0.0, 0.0, -pivot - joints["W"]]))
        return plus(linear, [0.0, 0.0, pivot], arm)
    centre, offset = rot_point(pins), tilt_offset(module, pins)
    axis, angle = (0, joints["A"]) if module == "xyzac-trt-kins" else (1, joints["B"])
    inner = turn(axis, -angle, minus(linear, plus(offset, centre)))
    return plus(centre, turn(2, -joints["C"], plus(offset, inner)))


# --- the same in abbe's machine language ----------------------------------------


def description(module, pins):
    """Chain, axes and tool; an axis is (letter, direction, origin, direct or not)."""
    x, y, z = [("X", [1, 0, 0], None, False), ("Y", [0, 1, 0], None, False),
               ("Z", [0, 0, 1], None, False)]
    if module == "5axiskins":
        pivot = pins["pivot-length"]
        head = [("C", [0, 0, 1], [0.0, 0.0, 0.0], False),
                ("B", [0, -1, 0], [0.0, 0.0, pivot], False), ("W", [0, 0, -1], None, False)]
        return {"chain": "w b X Y Z C B W t", "axes": [x, y, z] + head,
                "gauge": [0.0, 0.0, pivot], "length": pivot}
    centre = rot_point(pins)
    tilt = "A" if module == "xyzac-trt-kins" else "B"
    along = [1, 0, 0] if tilt == "A" else [0, 1, 0]
    table = [("C", [0, 0, 1], centre, True),
             (tilt, along, plus(centre, tilt_offset(module, pins)), True)]
    return {"chain": f"w C' {tilt}' b X Y Z t", "axes": table + [x, y, z],
            "gauge": [0.0, 0.0, 120.0], "length": 120.0}


def machine_yaml(module, pins):
    said = description(module, pins)
    lines = ["abbe: 1", f"machine: LinuxCNC {module}", f"chain: \"{said['chain']}\"", "axes:"]
    for letter, direction, origin, direct in said["axes"]:
        travel = ("[-1000 mm, 1000 mm]" if origin is None else
                  "continuous" if letter == "C" else "[-360 deg, 360 deg]")
        keys = [f"travel: {travel}", f"direction: {direction}"]
        if origin is not None:
            keys.append(f"origin: {origin}")
        if direct:
            keys.append("sense: direct")
        lines.append(f"  {letter}: {{ {', '.join(keys)} }}")
    lines.append(f"tool: {{ gauge: {said['gauge']}, length: {said['length']} mm }}")
    return "\n".join(lines) + "\n"


def about_line(origin, direction, degrees, point):
    """Rodrigues: `point` turned about the line through `origin`."""
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    arm = minus(point, origin)
    along = sum(a * d for a, d in zip(arm, direction))
    cross = [direction[1] * arm[2] - direction[2] * arm[1],
             direction[2] * arm[0] - direction[0] * arm[2],
             direction[0] * arm[1] - direction[1] * arm[0]]
    return [o + c * a + s * x + (1 - c) * along * d
            for o, a, x, d in zip(origin, arm, cross, direction)]


def described_position(module, pins, joints):
    """The tip carried from tool to workpiece through the described chain."""
    said = description(module, pins)
    point = minus(said["gauge"], [0.0, 0.0, said["length"]])
    for letter, direction, origin, direct in reversed(said["axes"]):
        value = -joints[letter] if direct else joints[letter]
        if origin is None:
            point = plus(point, [value * part for part in direction])
        else:
            point = about_line(origin, direction, value, point)
    return point


# --- outside --------------------------------------------------------------------


def ask(module, sets, keep):
    """Runs the worker in a sandbox: its HAL memory is private, its prints are a log."""
    with session.RunDir({"ask.json": json.dumps(sets)}, keep=keep) as rundir:
        argv = [session.PYTHON, "kinematics.py", "--worker", module]
        session.run_worker(rundir, argv, 60)
        with open(rundir.join("answer.json")) as source:
            return json.load(source)


def distance(left, right):
    return math.sqrt(sum((a - b) ** 2 for a, b in zip(left, right)))


def differences(module, sets):
    """Largest differences of a module from the closed form, the description and itself."""
    found = {"poses": 0, "closed_form": 0.0, "description": 0.0, "inverse": 0.0,
             "angles": 0.0}
    for each in sets:
        for pose in each["poses"]:
            pins, joints, position = each["pins"], pose["joints"], pose["position"]
            pairs = {
                "closed_form": (closed_form(module, pins, joints), position[:3]),
                "description": (described_position(module, pins, joints), position[:3]),
                "inverse": (pose["back"], [joints[letter] for letter in LETTERS[module]]),
                "angles": ([joints.get(letter, 0.0) for letter in "ABC"], position[3:6]),
            }
            found["poses"] += 1
            for key, (left, right) in pairs.items():
                difference = distance(left, right)
                # max() would lose a NaN, and JSON has none.
                if difference != difference:
                    difference = sys.float_info.max
                found[key] = max(found[key], difference)
    found["ok"] = found["poses"] > 0 and all(
        found[key] <= TOLERANCE for key in ("closed_form", "description", "inverse", "angles"))
    return found


def collect(seed, machines, poses, keep):
    """All modules; the same seed gives the same numbers."""
    result = {"package": session.assert_version(), "seed": seed, "modules": {},
              "machines": [], "items": []}
    for module in MODULES:
        generator = random.Random(f"{seed} {module}")
        sets = [{"pins": random_pins(module, generator, number == 0),
                 "poses": [{"joints": random_joints(module, generator, pose)}
                           for pose in range(poses)]} for number in range(machines)]
        sets = ask(module, sets, keep)
        result["modules"][module] = differences(module, sets)
        for each in sets:
            index = len(result["machines"])
            result["machines"].append({"module": module, "pins": each["pins"],
                                       "yaml": machine_yaml(module, each["pins"])})
            result["items"] += [{"module": module, "machine": index, "pins": each["pins"],
                                 "joints": pose["joints"], "position": pose["position"]}
                                for pose in each["poses"]]
    result["ok"] = all(each["ok"] for each in result["modules"].values())
    return result


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--machines", type=int, default=6, help="pin sets per module")
    parser.add_argument("--poses", type=int, default=40, help="poses per pin set")
    parser.add_argument("--keep", action="store_true")
    parser.add_argument("--ask", help="what to ask a module for, instead of random poses")
    parser.add_argument("--worker", choices=MODULES, help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.worker:
        worker(arguments.worker)
        return 0
    try:
        if arguments.ask:
            with open(arguments.ask) as source:
                wanted = json.load(source)
            session.assert_version()
            print(json.dumps(ask(wanted["module"], wanted["sets"], arguments.keep)))
            return 0
        result = collect(arguments.seed, arguments.machines, arguments.poses, arguments.keep)
    except session.SessionFailed as failure:
        print(failure, file=sys.stderr)
        return 1
    print(json.dumps(result, indent=1))
    return 0 if result["ok"] else 1


if __name__ == "__main__":
    sys.exit(main())
