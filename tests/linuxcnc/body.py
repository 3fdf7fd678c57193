"""Machines of the loop (loop.py), as a rigid body in NumPy: the second model, against which plant.c is held.

An axis of the file is displaced by `shift` (mm) and turned by `turn` (rad) about its origin. Poses are positions of
the joints by name; a place is one in the workpiece.
"""

import random

import numpy

LETTERS = "XYZABC"


def hat(v):
    return numpy.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])


def rotation(v):
    """The exponential of a rotation vector."""
    angle = numpy.linalg.norm(v)
    if angle == 0:
        return numpy.eye(3)
    k = hat(numpy.asarray(v) / angle)
    return numpy.eye(3) + numpy.sin(angle) * k + (1 - numpy.cos(angle)) * k @ k


def rigid(turn, shift):
    m = numpy.eye(4)
    m[:3, :3], m[:3, 3] = turn, shift
    return m


class Axis:
    """An axis as it is drawn, and where it really is."""

    def __init__(self, name, side, direction, origin, sense=1, rotary=None):
        self.name, self.side, self.sense = name, side, sense
        self.direction = numpy.array(direction, float) / numpy.linalg.norm(direction)
        self.origin, self.rotary = numpy.array(origin, float), name in "ABC" if rotary is None else rotary
        self.shift, self.turn, self.play = numpy.zeros(3), numpy.zeros(3), 0.0

    def motion(self, q, actual):
        """How far it carries its body."""
        q = q * self.sense
        if self.rotary:
            own = rotation(self.direction * numpy.radians(q))
            own = rigid(own, self.origin - own @ self.origin)
        else:
            own = rigid(numpy.eye(3), q * self.direction)
        if not actual:
            return own
        turn = rotation(self.turn)
        there = rigid(turn, self.origin + self.shift - turn @ self.origin)
        return there @ own @ numpy.linalg.inv(there)


class Machine:
    """Axes from the bed to the workpiece, and from the bed to the tool."""

    def __init__(self, text, axes, joints, tip, zero, balls, others, poses, safe):
        self.text, self.axes, self.joints = text, axes, joints
        self.tip, self.zero = numpy.array(tip, float), numpy.array(zero, float)
        self.balls, self.others, self.poses, self.safe = balls, others, poses, safe

    def holds(self, at, actual=True):
        """Tip, and the frame of the tool, as the workpiece sees them."""
        sides = {"w": numpy.eye(4), "t": numpy.eye(4)}
        for axis in self.axes:
            sides[axis.side] = sides[axis.side] @ axis.motion(at[axis.name], actual)
        seen = numpy.linalg.inv(sides["w"]) @ sides["t"]
        return (seen @ numpy.append(self.tip, 1))[:3] - self.zero, seen[:3, :3]

    def reach(self, rotary, place, actual=False):
        """Positions of all axes with the tip there."""
        linear = [axis.name for axis in self.axes if not axis.rotary]
        at = dict(rotary, **{name: 0.0 for name in linear})
        for _ in range(4):
            here = self.holds(at, actual)[0]
            slopes = [self.holds(dict(at, **{name: at[name] + 1}), actual)[0] - here for name in linear]
            step = numpy.linalg.solve(numpy.array(slopes).T, place - here)
            at.update({name: at[name] + way for name, way in zip(linear, step)})
        return at

    def missed(self, rotary, place):
        """Where the tip really is when the drawn machine has it at `place`."""
        return self.holds(self.reach(rotary, place))[0]

    def spoil(self, seed, shift=0.03, turn=60e-6):
        """Plants errors: lines of rotary axes, directions of linear ones."""
        chance = random.Random(seed)
        for axis in self.axes:
            axis.turn = numpy.array([chance.uniform(-turn, turn) for _ in range(3)])
            if axis.rotary:
                axis.shift = numpy.array([chance.uniform(-shift, shift) for _ in range(3)])

    def plant(self, probe, balls, radius, stem, stylus, more=()):
        """The file of plant.c."""
        lines = []
        for axis in self.axes:
            numbers = [*axis.direction, *axis.origin, *axis.shift, *axis.turn, axis.play]
            lines.append(f"axis {self.joints.index(axis.name)} {int(axis.rotary)} {int(axis.side == 't')} {axis.sense} "
                         + " ".join(f"{x:.15g}" for x in numbers))
        lines += ["tip " + words(self.tip), "zero " + words(self.zero), "stylus " + words(stylus),
                  "probe {noise} {delay} {pretravel} {lobe} {lobe_angle} {seed}".format(**probe)]
        lines += [f"ball {radius} {stem} " + words(ball) for ball in balls]
        return "\n".join(lines + list(more)) + "\n"


def words(numbers):
    return " ".join(f"{x:.15g}" for x in numbers)


def table_table():
    """A trunnion; its axes do not meet."""
    text = """abbe: 1
machine: Loop, table-table
chain: "w C' A' Y' b X Z t"
axes:
  X: { controller: 1, travel: [0 mm, 500 mm], origin: [0, 0, 0] }
  Y: { controller: 2, travel: [0 mm, 450 mm], origin: [0, 0, 0] }
  Z: { controller: 3, travel: [-400 mm, 0 mm], origin: [0, 0, 0] }
  A: { controller: 4, travel: [-120 deg, 30 deg], origin: [250, 225, -350], sense: direct }
  C: { controller: 5, travel: continuous, origin: [250, 225, -380], sense: direct }
tool: { gauge: [0, 0, 0], length: 120 mm }
workpiece: { origin: [250, 225, -380] }
"""
    axes = [Axis("Y", "w", [0, 1, 0], [0, 0, 0], -1), Axis("A", "w", [1, 0, 0], [250, 225, -350]),
            Axis("C", "w", [0, 0, 1], [250, 225, -380]), Axis("X", "t", [1, 0, 0], [0, 0, 0]),
            Axis("Z", "t", [0, 0, 1], [0, 0, 0])]
    balls = [[62, 31, 45], [-74, 22, 80], [11, -85, 60]]
    others = [[70, -45, 70], [-20, 88, 50], [-60, -60, 90]]
    poses = [{"A": a, "C": c} for a, c in
             [(0, 0), (0, 100), (0, 215), (-25, 40), (-25, 160), (-45, 280), (-45, 70), (25, 330), (25, 130)]]
    return Machine(text, axes, "XYZAC", [0, 0, -120], [250, 225, -380], balls, others, poses, [0, 0, 260])


def head_head():
    """A fork head; B is inclined and does not meet C."""
    text = """abbe: 1
machine: Loop, head-head
chain: "w Y' b X Z C B t"
axes:
  X: { controller: 1, travel: [-300 mm, 900 mm], origin: [0, 0, 0] }
  Y: { controller: 2, travel: [-300 mm, 650 mm], origin: [0, 0, 0] }
  Z: { controller: 3, travel: [-400 mm, 200 mm], origin: [0, 0, 0] }
  C: { controller: 5, travel: [-200 deg, 200 deg], origin: [5, 3, 0] }
  B: { controller: 4, travel: [-100 deg, 100 deg], direction: [0, 1, 1], origin: [12, 0, 260] }
tool: { gauge: [0, 0, 40], length: 150 mm }
workpiece: { origin: [100, 50, -300] }
"""
    axes = [Axis("Y", "w", [0, 1, 0], [0, 0, 0], -1), Axis("X", "t", [1, 0, 0], [0, 0, 0]),
            Axis("Z", "t", [0, 0, 1], [0, 0, 0]), Axis("C", "t", [0, 0, 1], [5, 3, 0]),
            Axis("B", "t", [0, 1, 1], [12, 0, 260])]
    balls = [[220, 100, 45], [390, 180, 80], [300, 240, 60]]
    others = [[250, 220, 70], [370, 90, 50], [310, 150, 90]]
    poses = [{"C": c, "B": b} for c, b in
             [(0, 0), (100, 0), (-120, 0), (40, 30), (-90, 30), (140, -40), (-30, -40), (60, 55), (-150, -20)]]
    return Machine(text, axes, "XYZBC", [0, 0, -110], [100, 50, -300], balls, others, poses, [300, 170, 260])


MACHINES = {"table-table": table_table, "head-head": head_head}
