"""The directory that `abbe compile --target linuxcnc --out DIR` writes, read back."""

import os

import session
from model import Table, TableRefused

FRAGMENT = "compensation.inc"


class Joint:
    """One `[JOINT_n]` section of the fragment with its table."""

    def __init__(self, number, letter, keys, directory):
        self.number, self.letter = number, letter
        try:
            self.kind = keys["TYPE"]
            self.limits = float(keys["MIN_LIMIT"]), float(keys["MAX_LIMIT"])
            self.file = keys["COMP_FILE"]
            self.file_type = int(keys["COMP_FILE_TYPE"])
        except (KeyError, ValueError) as problem:
            raise session.SessionFailed(f"{FRAGMENT} [JOINT_{number}]: {problem!r}") from problem
        if self.kind not in ("LINEAR", "ANGULAR") or self.limits[0] >= self.limits[1]:
            raise session.SessionFailed(f"{FRAGMENT} [JOINT_{number}]: {keys}")
        if os.path.basename(self.file) != self.file:
            raise session.SessionFailed(f"COMP_FILE {self.file} is not a plain file name")
        self.path = os.path.join(directory, self.file)
        try:
            self.table = Table.read(self.path, self.file_type)
        except (OSError, TableRefused) as problem:
            raise session.SessionFailed(str(problem)) from problem


class Fragment:
    """`compensation.inc` and the tables that it names."""

    def __init__(self, directory):
        try:
            with open(os.path.join(directory, FRAGMENT), encoding="utf-8") as source:
                self.text = source.read()
        except (OSError, UnicodeDecodeError) as problem:
            raise session.SessionFailed(str(problem)) from problem
        self.sections = session.parse_ini(self.text)
        try:
            self.letters = self.sections["TRAJ"]["COORDINATES"].split()
            count = int(self.sections["KINS"]["JOINTS"])
            kinematics = self.sections["KINS"]["KINEMATICS"].split()
        except (KeyError, ValueError) as problem:
            raise session.SessionFailed(f"{FRAGMENT}: {problem!r} is missing") from problem
        if kinematics != ["trivkins", "coordinates=" + "".join(self.letters)]:
            raise session.SessionFailed(f"{FRAGMENT}: KINEMATICS = {' '.join(kinematics)}")
        if count != len(self.letters) or not self.letters:
            raise session.SessionFailed(f"{FRAGMENT}: {count} joints, axes {self.letters}")
        expected = {"TRAJ", "KINS"} | {f"JOINT_{n}" for n in range(count)}
        if not expected <= set(self.sections):
            raise session.SessionFailed(f"{FRAGMENT}: no {sorted(expected - set(self.sections))}")
        self.joints = [Joint(n, letter, self.sections[f"JOINT_{n}"], directory)
                       for n, letter in enumerate(self.letters)]

    def merged_ini(self, ranges, speed):
        """A complete INI: the fragment's keys win, except limits, widened to `ranges`."""
        sections = {name: dict(keys) for name, keys in session.GLOBAL_INI.items()}
        for name, keys in self.sections.items():
            sections.setdefault(name, {}).update(keys)
        for joint, (low, high) in zip(self.joints, ranges):
            name = f"JOINT_{joint.number}"
            sections[name].update(session.joint_ini(low, high, speed))
            sections[f"AXIS_{joint.letter}"] = session.motion_ini(low, high, speed)
        return session.render_ini(sections)
