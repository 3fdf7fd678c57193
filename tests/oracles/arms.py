"""Expected branches for tests/it/robots.rs, by Pinocchio: python3 arms.py > arms.json

Needs `pip install pin`. Nothing of the program is used. The UR5 is built joint by joint from its published
Denavit-Hartenberg table, the others from lines of their axes; forward kinematics and Jacobians are Pinocchio's. All
branches of a pose are what Newton's iteration from many random starts comes to.
"""

import json

import numpy as np
import pinocchio as pin

STARTS = 400
POSES = 8

# a (mm), alpha (deg), d (mm): the maker's table.
UR5 = [(0, 90, 89.159), (-425, 0, 0), (-392.25, 0, 0), (0, 90, 109.15), (0, -90, 94.65), (0, 0, 82.3)]

# Direction and point of each axis, and the tip, at the zero pose, mm.
LINES = {
    # A spherical wrist behind a shoulder with an offset: the shape of a small industrial arm.
    "wrist": {
        "axes": [
            ([0, 0, 1], [0, 0, 0]),
            ([0, 1, 0], [25, 0, 400]),
            ([0, 1, 0], [340, 0, 400]),
            ([1, 0, 0], [340, 0, 435]),
            ([0, 1, 0], [705, 0, 435]),
            ([1, 0, 0], [705, 0, 435]),
        ],
        "tip": [785, 0, 435],
    },
    # The same wrist at the base, as a machine that holds the part would have it.
    "wrist-first": {
        "axes": [
            ([1, 0, 0], [0, 0, 0]),
            ([0, 1, 0], [0, 0, 0]),
            ([0, 0, 1], [0, 0, 0]),
            ([0, 1, 0], [300, 0, 50]),
            ([0, 1, 0], [600, 0, 50]),
            ([0, 0, 1], [650, 20, 50]),
        ],
        "tip": [700, 0, 100],
    },
    # Three parallel axes, the wrist axes 60 mm apart.
    "parallel": {
        "axes": [
            ([0, 0, 1], [0, 0, 0]),
            ([0, -1, 0], [0, 0, 90]),
            ([0, -1, 0], [-400, 0, 90]),
            ([0, 1, 0], [-800, 0, 90]),
            ([0, 0, -1], [-800, -110, 90]),
            ([0, -1, 0], [-740, -110, 0]),
        ],
        "tip": [-740, -200, 30],
    },
    # Three parallel axes at the base.
    "parallel-first": {
        "axes": [
            ([0, 0, 1], [0, 0, 0]),
            ([0, 0, 1], [300, 0, 0]),
            ([0, 0, 1], [550, 0, 0]),
            ([1, 0, 0], [600, 0, 200]),
            ([0, 1, 0], [700, 10, 200]),
            ([1, 0, 0], [720, 0, 230]),
        ],
        "tip": [800, 0, 230],
    },
}


def by_table():
    """The UR5 and its flange, with the tool point (0, 0.09, 31) mm of the flange."""
    model = pin.Model()
    parent, placement = 0, pin.SE3.Identity()
    for i, (a, alpha, d) in enumerate(UR5):
        parent = model.addJoint(parent, pin.JointModelRZ(), placement, f"J{i + 1}")
        turn = pin.utils.rotate("x", np.deg2rad(alpha))
        placement = pin.SE3(turn, np.array([a, 0.0, d]))
    frame = model.addFrame(pin.Frame("flange", parent, placement, pin.FrameType.OP_FRAME))
    return model, frame, np.array([0, 0.09, 31])


def by_lines(axes, tip):
    model = pin.Model()
    parent, before = 0, np.zeros(3)
    for i, (w, o) in enumerate(axes):
        joint = pin.JointModelRevoluteUnaligned(np.array(w, float))
        parent = model.addJoint(parent, joint, pin.SE3(np.eye(3), np.array(o, float) - before), f"J{i + 1}")
        before = np.array(o, float)
    frame = model.addFrame(pin.Frame("tip", parent, pin.SE3(np.eye(3), np.array(tip) - before), pin.FrameType.OP_FRAME))
    return model, frame, np.zeros(3)


def placed(model, data, frame, q):
    pin.framesForwardKinematics(model, data, q)
    return data.oMf[frame].copy()


def branches(model, data, frame, goal, random):
    """All positions (deg, -180 to 180) for a placement of the frame."""
    found = []
    scale = np.diag([1, 1, 1, 300, 300, 300])
    for _ in range(STARTS):
        q = random.uniform(-np.pi, np.pi, 6)
        for _ in range(120):
            now = placed(model, data, frame, q)
            error = scale @ pin.log6(now.actInv(goal)).vector
            if np.linalg.norm(error) < 1e-11:
                break
            j = scale @ pin.computeFrameJacobian(model, data, q, frame, pin.LOCAL)
            damping = 1e-3 * min(np.linalg.norm(error), 100) + 1e-13
            step = j.T @ np.linalg.solve(j @ j.T + damping * np.eye(6), error)
            q = q + step * min(1, 0.5 / np.abs(step).max())
        now = placed(model, data, frame, q)
        if np.linalg.norm(scale @ pin.log6(now.actInv(goal)).vector) < 1e-8:
            q = np.rad2deg(np.arctan2(np.sin(q), np.cos(q)))
            near = [np.abs(np.remainder(q - other + 180, 360) - 180).max() < 1e-4 for other in found]
            if not any(near):
                found.append(q)
    return sorted([list(q) for q in found])


def main():
    random = np.random.default_rng(11)
    result = {}
    arms = {"ur5": by_table()} | {name: by_lines(of["axes"], of["tip"]) for name, of in LINES.items()}
    for name, (model, frame, tool) in arms.items():
        data = model.createData()
        home = placed(model, data, frame, np.zeros(6))
        poses = []
        for _ in range(POSES):
            q = random.uniform(-np.pi, np.pi, 6)
            goal = placed(model, data, frame, q)
            poses.append(
                {
                    "tip": list(goal.act(tool)),
                    # From the zero pose to this one.
                    "rotation": [list(row) for row in goal.rotation @ home.rotation.T],
                    "drawn": list(np.rad2deg(q)),
                    "branches": branches(model, data, frame, goal, random),
                }
            )
        result[name] = {"poses": poses}
        if name in LINES:
            result[name] |= LINES[name]
    print("{\n" + ",\n".join(f"{json.dumps(k)}: {json.dumps(v)}" for k, v in result.items()) + "\n}")


main()
