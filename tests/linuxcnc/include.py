"""`#INCLUDE compensation.inc` in a real INI, started by the stock `linuxcnc` launcher.

Only the launcher expands #INCLUDE, and LinuxCNC reads the first section of a name
only. So the user's own [TRAJ] and [KINS] come first, the fragment last, and its
[JOINT_n] must be the only ones: what they do not say (speeds, homing) is LinuxCNC's
default here, and the joints are jogged unhomed.
"""

import json
import os
import sys

import session

TOLERANCE = 1e-9
DISPLAY = "display.sh"
LAUNCHER = """#!/bin/sh
# The launcher shows its messages on a terminal or in files; its result is the files.
linuxcnc -r run.ini </dev/null
test -s include.json
"""


def including_ini(fragment):
    """An INI of the user's: own global keys, compensation by #INCLUDE alone."""
    sections = {name: dict(keys) for name, keys in session.GLOBAL_INI.items()}
    for name in ("TRAJ", "KINS"):
        sections.setdefault(name, {}).update(fragment.sections[name])
    sections["DISPLAY"] = {"DISPLAY": f"./{DISPLAY}"}
    sections["HAL"] = {"HALFILE": "run.hal"}
    for joint in fragment.joints:
        low, high = joint.limits
        sections[f"AXIS_{joint.letter}"] = session.motion_ini(low, high, 1.0)
    return session.render_ini(sections) + "\n#INCLUDE compensation.inc\n"


def launcher_hal(joints):
    """The launcher loads tpmod and homemod itself."""
    lines = session.hal_text(joints).splitlines()
    return "\n".join(line for line in lines if line not in ("loadrt tpmod", "loadrt homemod"))


def through_launcher(fragment, keep=False):
    """Starts the stock launcher and compares joint.N.backlash-corr with the model."""
    display = (f"#!/bin/sh\nexec {session.PYTHON} include.py \"$2\" "
               f"{len(fragment.joints)} > log/display.log 2>&1\n")
    files = {"run.ini": including_ini(fragment), "run.hal": launcher_hal(len(fragment.joints)),
             "tool.tbl": "", DISPLAY: display, "launch.sh": LAUNCHER,
             "compensation.inc": fragment.text}
    with session.RunDir(files, [joint.path for joint in fragment.joints], keep) as rundir:
        os.chmod(rundir.join(DISPLAY), 0o755)
        session.run_worker(rundir, ["sh", "launch.sh"], 90)
        with open(rundir.join("include.json")) as source:
            observed = json.load(source)
    failures, largest = [], 0.0
    for joint, turns in zip(fragment.joints, observed):
        for turn in turns:
            expected = joint.table.correction(turn["position"], turn["direction"])
            difference = abs(turn["corr"] - expected)
            largest = max(largest, difference)
            if not difference <= TOLERANCE:
                failures.append(f"joint {joint.number}: {turn}, the model says {expected}")
    return {"ok": not failures, "failures": failures, "observed": observed,
            "max_difference": largest}


# --- the display program --------------------------------------------------------


class Display(session.Controller):
    """A controller that the launcher has started."""

    def attach(self):
        super().attach()
        self.open_samplers()

    def switch_on(self):
        self._set_state(self.linuxcnc.STATE_ESTOP_RESET, "out of emergency stop")
        self._set_state(self.linuxcnc.STATE_ON, "machine on")
        self._set_mode(self.linuxcnc.MODE_MANUAL)
        self.command.teleop_enable(0)
        self.command.wait_complete(5)

    def jog(self, joint, distance):
        """One increment; the value looked up in the last cycle with a velocity."""
        stream, moving = self.streams[joint], []
        while stream.read() is not None:
            pass
        target = self.pin(f"joint.{joint}.pos-cmd") + distance
        self.command.jog(self.linuxcnc.JOG_INCREMENT, True, joint,
                         1.0 if distance > 0 else -1.0, abs(distance))

        def arrived():
            sample = stream.read()
            while sample is not None:
                if sample[1] != 0.0:
                    moving[:] = [sample]
                elif moving and abs(sample[0] - target) < 1e-6:
                    return True
                sample = stream.read()
            return False

        self.wait(f"jog of joint {joint}", arrived)
        position, velocity, corr, _, _ = moving[0]
        return {"direction": "forward" if velocity > 0 else "reverse",
                "position": position, "corr": corr}


def display(ini, joints):
    controller = Display(ini, joints=joints)
    controller.attach()
    controller.switch_on()
    turns = [[controller.jog(joint, distance) for distance in (0.02, -0.04, 0.03)]
             for joint in range(joints)]
    with open("include.json", "w") as out:
        json.dump(turns, out)


if __name__ == "__main__":
    display(sys.argv[1], int(sys.argv[2]))
