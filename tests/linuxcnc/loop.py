#!/usr/bin/python3
"""The loop closed on the running controller: plan, measure, identify, compile, load, measure other balls.

  loop.py ABBE [--machine table-table|head-head] [--seed N] [--case CASE] [--keep]

ABBE is the program. plant.c is the machine: its errors are drawn from the seed, and abbe is not told of them. The
program of `abbe measure` runs in LinuxCNC with trivkins; after `identify` and `compile --target linuxcnc-kins` other
balls are touched through the module with an ideal probe, by a program of this file.
Cases: `good`; `lobing` (2 um, hardly any noise); and what must be refused or named: `reversed` (an axis turns the other
way), `loose` (a ball moves during the campaign), `noisy` (ten times the noise stated), `truncated` (the log is cut).
Prints JSON; exit code 0 only when everything holds. Lengths in the result are um.
"""

import argparse
import concurrent.futures
import ctypes
import json
import os
import random
import re
import shutil
import subprocess
import sys
import tempfile
import time

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import numpy  # noqa: E402

import body  # noqa: E402
import kins  # noqa: E402
import session  # noqa: E402

RADIUS, STEM, STYLUS = 12.5, 4.0, (3.0, 50.0, 2.0, 15.0)
TOUCH_NOISE = 1e-3
# Poses and balls of a campaign, and how far balls are from where they are said to be.
SETS, ASTRAY = 24, 0.4
PROBE = {"noise": TOUCH_NOISE, "delay": 2, "pretravel": 6e-3, "lobe": 2e-3, "lobe_angle": 0.4, "seed": 1}
IDEAL = {"noise": 0, "delay": 0, "pretravel": 0, "lobe": 0, "lobe_angle": 0, "seed": 1}
CLOCK = "40"
# Bars: rms scatter over the deviation of a centre that the plan foretold; what lobing of 2 um may leave, um.
MOST_SCATTER, MOST_LOBING = 1.5, 0.5
# The two models of the machine agree to this, mm.
SAME = 1e-9
CASES = ("good", "lobing", "reversed", "loose", "noisy", "truncated")


class Failed(Exception):
    """A step of the loop did not do what it should."""


# --- controller -------------------------------------------------------------------

MEASURE_HAL = """loadrt tpmod
loadrt homemod
loadrt trivkins coordinates={letters}
loadrt motmod servo_period_nsec=1000000 num_joints={count}
addf motion-command-handler servo-thread
addf motion-controller servo-thread
net estop iocontrol.0.user-enable-out => iocontrol.0.emc-enable-in
net prepare iocontrol.0.tool-prepare => iocontrol.0.tool-prepared
net change iocontrol.0.tool-change => iocontrol.0.tool-changed
"""
JUDGE_HAL = """loadrt tpmod
loadrt homemod
source sim.hal
setp abbe-ramp.maxv 1e6
"""


def plant_hal(joints):
    """The plant behind the motors; its signals are named as in sim.hal."""
    lines = [f"loadrt plant machine=plant.txt joints={joints}", "addf plant servo-thread",
             "net touching plant.probe => motion.probe-input"]
    for n in range(joints):
        lines += [f"net joint-{n} joint.{n}.motor-pos-cmd => plant.motor-{n}",
                  f"net offset-{n} joint.{n}.motor-offset => plant.offset-{n}"]
    return "\n".join(lines) + "\n"


def measure_ini(machine):
    """Identity kinematics, travels of the machine file and a hair more."""
    sections = {name: dict(keys) for name, keys in session.GLOBAL_INI.items()}
    sections["EMCMOT"]["SERVO_PERIOD"] = "1000000"
    sections["RS274NGC"]["SUBROUTINE_PATH"] = "program"
    sections["KINS"] = {"KINEMATICS": "trivkins", "JOINTS": str(len(machine.joints))}
    sections["TRAJ"]["COORDINATES"] = " ".join(machine.joints)
    for number, letter in enumerate(machine.joints):
        travel = re.search(rf"^  {letter}:.*travel: \[(\S+) \w+, (\S+) \w+\]", machine.text, re.MULTILINE)
        low, high = (float(travel[1]), float(travel[2])) if travel else (-1e5, 1e5)
        sections[f"AXIS_{letter}"] = session.motion_ini(low - 0.5, high + 0.5, 200.0)
        sections[f"JOINT_{number}"] = session.joint_ini(low - 0.5, high + 0.5, 200.0)
        sections[f"JOINT_{number}"]["TYPE"] = "ANGULAR" if letter in "ABC" else "LINEAR"
    return session.render_ini(sections)


def judge_ini(text):
    """The simulation of the set with room to move, and subroutines."""
    wide = {"MIN_LIMIT": "-1e5", "MAX_LIMIT": "1e5", "DISPLAY": "none", "MAX_LINEAR_VELOCITY": "200",
            "MAX_ANGULAR_VELOCITY": "200"}
    text = re.sub(r"^(\w+) = .*$", lambda m: f"{m[1]} = {wide[m[1]]}" if m[1] in wide else m[0], text,
                  flags=re.MULTILINE)
    return text.replace("[RS274NGC]\n", "[RS274NGC]\nSUBROUTINE_PATH = program\n")


class Accelerated(session.Controller):
    """Its realtime threads run on a faster clock."""

    def call(self, name, *argv, timeout=20):
        if "-f" not in argv:
            return super().call(name, *argv, timeout=timeout)
        os.environ.update({"LD_PRELOAD": os.path.abspath("clock.so"), "ABBE_CLOCK": CLOCK})
        try:
            return super().call(name, *argv, timeout=timeout)
        finally:
            del os.environ["LD_PRELOAD"], os.environ["ABBE_CLOCK"]


def worker():
    """Inside the sandbox: starts, homes, and runs what is asked; writes result.json."""
    with open("task.json") as source:
        task = json.load(source)
    # As the launcher does: the interpreter finds its subroutines by it.
    os.environ["INI_FILE_NAME"] = os.path.abspath("run.ini")
    controller = Accelerated("run.ini", "run.hal", task["joints"])
    controller.start()
    controller.home()
    for line in task["first"]:
        controller.mdi(line, 60, lambda: time.sleep(0.002))
    if task["pin"]:
        controller.wait(task["pin"], lambda: controller.pin(task["pin"]) == 1)
    result = {"said": "", "code": 0, "again": []}
    if task["program"]:
        done = subprocess.run([session.PYTHON, task["program"]], capture_output=True, text=True, check=False)
        result.update(said=done.stdout + done.stderr, code=done.returncode)
    for number in range(1, task["calls"] + 1):
        judged(controller, number, task["out"][number - 1], result["again"])
    result.update({name: controller.pin(f"plant.{name}") for name in ("touches", "shaft", "crashes")})
    with open("result.json", "w") as out:
        json.dump(result, out)
    return 0


def judged(controller, number, out, told):
    """A subroutine that says when it has ended, and is repeated if it breaks off, from above the ball."""
    for again in range(6):
        if again:
            for line in (out, "G90"):
                controller.command.mdi(line)
                controller.command.wait_complete(5)
                time.sleep(0.2)
        controller.drain_messages()
        before = len(controller.messages)
        controller.command.mdi(f"o<judge_{number}> call")
        end = time.monotonic() + 60
        while time.monotonic() < end:
            controller.drain_messages()
            if controller._polled().aout[1] == number:
                controller.command.wait_complete()
                return
            if len(controller.messages) > before:
                told.append([number, *controller.messages[before:]])
                break
            time.sleep(0.005)
        time.sleep(0.5)
    raise session.SessionFailed(f"judge_{number}: {controller.messages[-3:]}")


def controlled(shop, files, program, task, module=None):
    """Runs a task in the sandbox; the result and the log that the controller wrote."""
    copies = [shop.file("clock.so")]
    if module:
        copies += [os.path.join(module, name) for name in kins.FILES]
    with session.RunDir({**files, "task.json": json.dumps(task)}, copies, shop.keep) as rundir:
        shutil.copytree(program, rundir.join("program"))
        os.mkdir(rundir.join("modules"))
        shutil.copy(shop.file("plant.so"), rundir.join("modules"))
        if module:
            shutil.copy(kins.build(module, rundir.join("set")), rundir.join("modules"))
        session.run_worker(rundir, [session.PYTHON, "loop.py", "--worker"], 600, modules=rundir.join("modules"))
        with open(rundir.join("result.json")) as source:
            result = json.load(source)
        result["log"] = None
        with open(rundir.join("met.txt")) as source:
            result["met"] = source.read().splitlines()
        if os.path.exists(rundir.join(task["log"])):
            with open(rundir.join(task["log"])) as source:
                result["log"] = source.read()
    return result


# --- the loop -----------------------------------------------------------------------


class Shop:
    """A machine, its balls, and a folder."""

    def __init__(self, abbe, name, seed, case, folder, keep):
        self.abbe, self.seed, self.case, self.folder, self.keep = abbe, seed, case, folder, keep
        self.machine = body.MACHINES[name]()
        self.machine.spoil(seed)
        chance = random.Random(1000 + seed)
        self.astray = [[x + chance.uniform(-ASTRAY, ASTRAY) for x in ball] for ball in self.machine.balls]
        self.probe = dict(PROBE, seed=seed)
        self.seconds = {"build": 0.0}
        if case == "lobing":
            self.probe["noise"] = 5e-5
        if case == "noisy":
            self.probe["noise"] = 10 * TOUCH_NOISE
        self.write("machine.yaml", self.machine.text)
        self.build()

    def file(self, name):
        return os.path.join(self.folder, name)

    def write(self, name, text):
        with open(self.file(name), "w") as out:
            out.write(text)

    def build(self):
        """Plant, its twin without a controller, and the clock."""
        shutil.copy(os.path.join(session.HERE, "plant.c"), self.folder)
        clock = os.path.join(session.HERE, "clock.c")
        for argv in (["halcompile", "--compile", "plant.c"],
                     ["cc", "-O2", "-shared", "-fPIC", "-DOFFLINE", "plant.c", "-o", "offline.so", "-lm"],
                     ["cc", "-O2", "-shared", "-fPIC", clock, "-o", "clock.so"]):
            done = subprocess.run(argv, cwd=self.folder, capture_output=True, text=True, check=False)
            if done.returncode:
                raise Failed(f"{argv}: {done.stdout}{done.stderr}")

    def timed(self, name, step, *arguments):
        started = time.monotonic()
        try:
            return step(*arguments)
        finally:
            self.seconds[name] = round(time.monotonic() - started, 1)

    def run(self, *arguments):
        """The program; code, standard output, standard error."""
        done = subprocess.run([self.abbe, *arguments], cwd=self.folder, capture_output=True, text=True, check=False)
        return done.returncode, done.stdout, done.stderr

    def say(self, *arguments):
        """The same where it must succeed; warnings are kept."""
        code, out, err = self.run(*arguments)
        if code:
            raise Failed(f"abbe {' '.join(arguments)}: {err}{out}")
        return out

    def actual(self):
        """The file of the machine while it is measured."""
        machine, more = self.machine, []
        if self.case == "reversed":
            axis = next(axis for axis in machine.axes if axis.name == "C")
            axis.sense = -axis.sense
        if self.case == "loose":
            # Half-way through its sets the ball that is measured last; touches are fast and slow.
            with open(self.file("sets.csv")) as source:
                rows = [row.split(",")[0] for row in source][1:]
            last = rows[-1]
            before = 16 * (len(rows) - rows.count(last) // 2) + 10 * len(machine.balls)
            more = [f"loose {int(last[1:]) - 1} {before} 0.03 -0.02 0.01"]
        text = machine.plant(self.probe, self.astray, RADIUS, STEM, STYLUS, more)
        if self.case == "reversed":
            axis.sense = -axis.sense
        return text


def compared(shop):
    """plant.c against body.py, poses of the axes and contacts; the largest difference, mm."""
    shop.write("compared.txt", shop.machine.plant(IDEAL, shop.machine.balls, RADIUS, STEM, STYLUS))
    library = ctypes.CDLL(shop.file("offline.so"))
    if library.plant_read(shop.file("compared.txt").encode()):
        raise Failed("plant.c does not read its file")
    chance, worst = random.Random(5), 0.0
    machine, numbers = shop.machine, ctypes.c_double * 9

    def joints(at):
        return numbers(*[at[name] for name in machine.joints])
    for _ in range(200):
        at = {axis.name: chance.uniform(-90, 90) if axis.rotary else chance.uniform(-300, 300)
              for axis in machine.axes}
        out = (ctypes.c_double * 6)()
        library.plant_holds(joints(at), out)
        tip, frame = machine.holds(at)
        worst = max(worst, *numpy.abs(numpy.array(out[:3]) - tip), *numpy.abs(numpy.array(out[3:]) - frame[:, 2]))
    # A contact is where the middles are apart by both radii, from above and from all sides.
    for rotary in machine.poses[:5]:
        frame = machine.holds(machine.reach(rotary, machine.balls[0], True))[1]
        for way in ([0, 0, 1], [1, 0, 0], [-0.6, 0.8, 0]):
            for far, wanted in ((1e-7, 0), (-1e-7, 1)):
                place = numpy.array(machine.balls[0]) + (RADIUS + STYLUS[0] + far) * (frame @ way)
                # From afar, so that the signal is not held from before.
                away = joints(machine.reach(rotary, place + 50 * frame[:, 2], True))
                for _ in range(12):
                    library.plant_look(away)
                if library.plant_look(joints(machine.reach(rotary, place, True))) != wanted:
                    raise Failed(f"plant.c: contact {far} mm off is not {wanted}")
    if worst > SAME:
        raise Failed(f"plant.c and body.py are {worst} apart")
    return worst


def planned(shop):
    """The sets, and what the plan foretells."""
    machine = shop.machine
    zero = {axis.name: 0.0 for axis in machine.axes if axis.rotary}
    sizes = ["--ball-radius", f"{RADIUS} mm", "--stem", f"{STEM} mm", "--ball-within", "1 mm",
             "--stylus", ", ".join(f"{x} mm" for x in STYLUS)]
    ask = ["identify", "machine.yaml", "--fit", "needed", "--plan", str(SETS), "--instrument", "touch",
           "--noise", f"{TOUCH_NOISE} mm", *sizes]
    for ball in machine.balls:
        at = machine.reach(zero, numpy.array(ball))
        ask += ["--ball", ",".join(f"{axis.name}={at[axis.name]:.4f}" for axis in machine.axes if not axis.rotary)]
    with concurrent.futures.ThreadPoolExecutor() as both:
        table, foretold = both.map(lambda form: shop.say(*ask, "--format", form), ("csv", "json"))
    foretold = json.loads(foretold)
    rows = table.splitlines()
    # All balls are in it, and no set of it is refused.
    balls = {row.split(",")[0] for row in rows[1:]}
    if len(balls) != len(machine.balls) or len(rows) != SETS + 1:
        raise Failed(f"the plan has {len(rows) - 1} sets of {sorted(balls)}")
    shop.write("sets.csv", table)
    program = json.loads(shop.say("measure", "machine.yaml", "sets.csv", "--noise", f"{TOUCH_NOISE} mm", *sizes, "--out",
                                  "program", "--format", "json"))
    foretold["start"] = program["start"]
    return foretold


def measured(shop, start):
    """The program in the controller; its log."""
    machine = shop.machine
    files = {"run.ini": measure_ini(machine), "plant.txt": shop.actual(), "linuxcnc.var": "", "tool.tbl": "",
             "run.hal": MEASURE_HAL.format(letters=machine.joints, count=len(machine.joints))
             + "".join(f"net joint-{n} joint.{n}.motor-pos-cmd => joint.{n}.motor-pos-fb\n"
                       for n in range(len(machine.joints)))
             + plant_hal(len(machine.joints))}
    # Up first, as somebody would jog.
    first = [f"G53 G0 Z{start['Z']}", "G53 G0 " + " ".join(f"{name}{q}" for name, q in start.items())]
    task = {"joints": len(machine.joints), "first": first, "pin": "",
            "program": "program/abbe_measure.py", "calls": 0, "out": [], "log": "abbe_touches.log"}
    result = controlled(shop, files, shop.file("program"), task)
    log = result["log"] or ""
    if shop.case == "truncated":
        log = log[:len(log) * 2 // 3]
    shop.write("touches.log", log)
    return result


def judge_program(shop):
    """A subroutine for each touch: the tip in the workpiece, through the module, slowly.

    2.9 loses moves and results of probing now and then, above all beside other loads: a touch alone is repeated.
    """
    os.mkdir(shop.file("judge"))
    machine, reach = shop.machine, RADIUS + STYLUS[0]
    turns = [numpy.array([numpy.cos(t), numpy.sin(t), 0]) for t in numpy.arange(6) * numpy.pi / 3]
    names, outs = [], []
    for ball in machine.others:
        for pose, rotary in enumerate(machine.poses[::2]):
            centre = numpy.array(ball, float)
            frame = machine.holds(machine.reach(rotary, centre), False)[1]

            def go(word, place, feed=""):
                lines.append(f"{word} " + " ".join(f"{n}{x:.9f}" for n, x in zip("XYZ", place)) + feed)
            for touch, way in enumerate([numpy.array([0, 0, 1.0]), *turns]):
                number, n = len(names) + 1, frame @ way
                lines = [f"o<judge_{number}> sub", "(LOGAPPEND,judge.log)"]
                if touch == 0:
                    go("G0", machine.safe)
                    lines.append("G0 " + " ".join(f"{name}{q}" for name, q in rotary.items()))
                    go("G0", centre + 40 * frame[:, 2])
                go("G0", centre + (reach + 3) * n + (reach + 6) * (1 - way[2]) * frame[:, 2])
                go("G0", centre + (reach + 3) * n)
                # Corrected, so that a slow touch alone is near enough; two at once lose moves in 2.9.
                go("G1", centre + (reach + 0.15) * n, " F600")
                go("G38.2", centre + (reach - 1) * n, " F6")
                # 2.9 may hand out the touch before: it is elsewhere.
                off = " + ".join(f"ABS[#{5061 + k} - {x:.6f}]" for k, x in enumerate(centre + reach * n))
                lines += [f"o10 if [[#5070 EQ 0] OR [[{off}] GT 1]]", "#1 = #<_missed>", "o10 endif"]
                lines.append(f"(LOG,{number} %.9f#5061 #5062 #5063 #5070)")
                # What follows while the probing move still brakes may be lost, without a message.
                lines.append("G4 P0.02")
                go("G0", centre + (reach + 3) * n)
                go("G0", centre + (reach + 3) * n + (reach + 6) * (1 - way[2]) * frame[:, 2])
                if touch == len(turns):
                    go("G0", centre + 40 * frame[:, 2])
                    go("G0", machine.safe)
                lines += ["(LOGCLOSE)", f"M68 E1 Q{number}", f"o<judge_{number}> endsub", "M2"]
                with open(os.path.join(shop.file("judge"), f"judge_{number}.ngc"), "w") as out:
                    out.write("\n".join(lines) + "\n")
                names.append((tuple(ball), pose))
                outs.append("G91 G0 " + " ".join(f"{n}{40 * x:.6f}" for n, x in zip("XYZ", frame[:, 2])))
    return names, outs


def centre_of(points):
    """Middle of the sphere through touches, all of one unknown radius."""
    a = numpy.hstack([2 * points, numpy.ones((len(points), 1))])
    return numpy.linalg.lstsq(a, (points**2).sum(axis=1), rcond=None)[0][:3]


def judged_by_others(shop):
    """Other balls through the module, with an ideal probe: rms scatter of their centres, um, by component."""
    machine, (names, outs) = shop.machine, judge_program(shop)
    with open(shop.file("set/sim.ini")) as source:
        ini = judge_ini(source.read())
    files = {"run.ini": ini, "run.hal": JUDGE_HAL + plant_hal(len(machine.joints)),
             "plant.txt": machine.plant(IDEAL, machine.others, RADIUS, STEM, STYLUS)}
    first = ["G21 G90 G94 G61 G54 G49", "G43 H1", "G0 " + " ".join(f"{a}{x}" for a, x in zip("XYZ", machine.safe))]
    task = {"joints": len(machine.joints), "first": first, "pin": "abbe-ramp.out", "program": "",
            "calls": len(names), "out": outs, "log": "judge.log"}
    result = controlled(shop, files, shop.file("judge"), task, shop.file("set"))
    touches = {}
    for line in result["log"].splitlines():
        number, x, y, z, hit = line.split()
        if float(hit) != 1:
            raise Failed(f"judge.log: {line}")
        touches[int(number)] = [float(x), float(y), float(z)]
    centres, radii, sets = {}, [], {}
    for number, name in enumerate(names, 1):
        sets.setdefault(name, []).append(touches[number])
    for (ball, _), points in sets.items():
        points = numpy.array(points)
        centre = centre_of(points)
        radii.append(numpy.linalg.norm(points - centre, axis=1).mean() - RADIUS - STYLUS[0])
        centres.setdefault(ball, []).append(centre)
    off = numpy.concatenate([numpy.array(of) - numpy.mean(of, axis=0) for of in centres.values()])
    degrees = len(off) - len(centres)
    before = [numpy.array([machine.missed(rotary, numpy.array(ball, float)) for rotary in machine.poses[::2]])
              for ball in machine.others]
    before = numpy.concatenate([of - of.mean(axis=0) for of in before])
    return {"rms_um": 1e3 * float(numpy.sqrt((off**2).sum() / (3 * degrees))),
            "worst_um": 1e3 * float(numpy.linalg.norm(off, axis=1).max()),
            "rms_before_um": 1e3 * float(numpy.sqrt((before**2).sum() / (3 * degrees))),
            "radius_um": 1e3 * float(numpy.mean(radii)),
            **{name: result[name] for name in ("touches", "shaft", "crashes", "met", "again")}}


def good(shop, result):
    """The whole loop; the failures."""
    result["models_apart_mm"] = shop.timed("models", compared, shop)
    foretold = shop.timed("plan", planned, shop)
    result["foretold_centre_um"] = foretold["noise_um"]
    run = shop.timed("measure", measured, shop, foretold["start"])
    result["measured"] = {name: run[name] for name in ("touches", "shaft", "crashes", "code", "met")}
    result["said"] = run["said"][-2000:]
    if run["code"]:
        return [f"the program broke off: {run['said'][-500:]}"]
    found = json.loads(shop.timed("import", shop.say, "import", "touches.log", "--machine", "machine.yaml", "--out",
                                  "touches.csv", "--format", "json"))
    result["probe"] = {name: found[name] for name in ("sigma_um", "effective_radius_mm", "lobing")}
    fit = json.loads(shop.timed("identify", shop.say, "identify", "machine.yaml", "--fit", "needed", "--data",
                                "touches.csv", "--out", "fitted.yaml", "--format", "json"))
    result["sigma_um"] = fit["sigma_um"]
    shop.timed("compile", shop.say, "compile", "fitted.yaml", "--target", "linuxcnc-kins", "--out", "set", "--poses",
               "50")
    result["judged"] = judge = shop.timed("judge", judged_by_others, shop)
    bar = MOST_LOBING if shop.case == "lobing" else MOST_SCATTER * foretold["noise_um"]
    failures = [f"{name}: {part[name]}" for part in (run, judge) for name in ("shaft", "crashes") if part[name]]
    if not judge["rms_um"] <= bar:
        failures.append(f"scatter of other balls {judge['rms_um']:.3f} um, above {bar}")
    if not judge["rms_before_um"] > 10 * bar:
        failures.append("there was nothing to correct")
    return failures


def hostile(shop, result):
    """A campaign that must be refused, or its trouble named."""
    foretold = shop.timed("plan", planned, shop)
    run = shop.timed("measure", measured, shop, foretold["start"])
    result["measured"] = {name: run[name] for name in ("touches", "shaft", "crashes", "code", "met")}
    result["said"] = run["said"][-2000:]
    result["steps"] = steps = []
    for arguments in (["import", "touches.log", "--machine", "machine.yaml", "--out", "touches.csv"],
                      ["identify", "machine.yaml", "--fit", "needed", "--data", "touches.csv", "--out", "fitted.yaml"]):
        if steps and steps[-1]["code"]:
            break
        code, out, err = shop.run(*arguments)
        steps.append({"verb": arguments[0], "code": code, "said": err + out})
    told = run["said"] + "".join(step["said"] for step in steps)
    result["told"] = told[-3000:]
    refused = run["code"] or any(step["code"] for step in steps)
    # Attempts that broke off are the controller's.
    named = set(re.findall(r"warning\[(W05\d\d)\]", told)) - {"W0504"}
    return [] if refused or named else ["nothing was said of what was planted"]


def main():
    if sys.argv[1:] == ["--worker"]:
        return worker()
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("abbe")
    parser.add_argument("--machine", choices=sorted(body.MACHINES), default="table-table")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--case", choices=CASES, default="good")
    parser.add_argument("--keep", action="store_true", help="leave the folders for inspection")
    arguments = parser.parse_args()
    folder = tempfile.mkdtemp(prefix="abbe-loop-")
    result = {"machine": arguments.machine, "seed": arguments.seed, "case": arguments.case}
    try:
        session.assert_version()
        started = time.monotonic()
        shop = Shop(os.path.abspath(arguments.abbe), arguments.machine, arguments.seed, arguments.case, folder,
                    arguments.keep)
        step = good if arguments.case in ("good", "lobing") else hostile
        shop.seconds["build"] = round(time.monotonic() - started, 1)
        result["seconds"] = shop.seconds
        result["failures"] = step(shop, result)
    except (Failed, session.SessionFailed) as failure:
        result["failures"] = [str(failure)]
    finally:
        if arguments.keep:
            print(f"kept {folder}", file=sys.stderr)
        else:
            shutil.rmtree(folder, ignore_errors=True)
    print(json.dumps(result, indent=1))
    return 1 if result["failures"] else 0


if __name__ == "__main__":
    sys.exit(main())
