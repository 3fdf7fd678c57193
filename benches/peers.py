"""The same deviations by other programs: NumPy in batches, CasADi-generated C, Pinocchio.

Every peer gets the same poses; CasADi and Pinocchio get the errors already looked up, which their time does not count.
All work on the machine of machine.py with orthogonal joints unless said otherwise: 4x4 matrices, default conventions.
"""

import ctypes
import pathlib
import subprocess

import numpy as np

import machine as m

UNIT = {"X": np.array([1.0, 0, 0]), "Y": np.array([0, 1.0, 0]), "Z": np.array([0, 0, 1.0]),
        "A": np.array([1.0, 0, 0]), "C": np.array([0, 0, 1.0])}


def location(axis):
    """(dx, dy, dz, ea, eb, ec) in mm and rad."""
    six = np.zeros(6)
    for name, value in m.LOCATION.items():
        if name[3] == axis:
            k = m.LETTERS.index(name[1])
            six[k] = value * (1e-3 if k < 3 else 1e-6)
    return six


def looked_up(columns, nodes=129):
    """Component errors at poses, [axis][6][pose], mm and rad."""
    out = np.empty((5, 6, columns.shape[1]))
    for a, axis in enumerate(m.WALK):
        for k, letter in enumerate(m.LETTERS):
            x, value = m.curve(axis, letter, nodes)
            out[a, k] = np.interp(columns[a], x, value) * (1e-3 if k < 3 else 1e-6)
    return out


# --- NumPy: batches of 4x4 matrices, small-angle error matrices -------------------------------------------------------------


def translation(v):
    t = np.eye(4)
    t[:3, 3] = v
    return t


def small(six):
    """1 + hat, translation: batched over the last axis of `six`."""
    e = np.zeros((six.shape[1], 4, 4))
    dx, dy, dz, a, b, c = six
    e[:, 0, 0] = e[:, 1, 1] = e[:, 2, 2] = e[:, 3, 3] = 1
    e[:, 0, 1], e[:, 0, 2], e[:, 1, 0], e[:, 1, 2], e[:, 2, 0], e[:, 2, 1] = -c, b, c, -a, -b, a
    e[:, 0, 3], e[:, 1, 3], e[:, 2, 3] = dx, dy, dz
    return e


def nominal(axis, q):
    n = np.zeros((q.size, 4, 4))
    n[:, 3, 3] = 1
    if axis in "XYZ":
        n[:, 0, 0] = n[:, 1, 1] = n[:, 2, 2] = 1
        n[:, "XYZ".index(axis), 3] = q
        return n
    s, c = np.sin(np.radians(q)), np.cos(np.radians(q))
    i, j, k = (1, 2, 0) if axis == "A" else (0, 1, 2)
    n[:, i, i], n[:, i, j], n[:, j, i], n[:, j, j], n[:, k, k] = c, -s, s, c, 1
    return n


class NumPy:
    """Blocks of poses that fit the cache; curve look-up by np.interp."""

    BLOCK = 2048

    def __init__(self, columns, nodes=129):
        self.columns, self.out = columns, np.empty((6, columns.shape[1]))
        self.tables = {(a, k): m.curve(a, k, nodes) for a in m.WALK for k in m.LETTERS}
        self.location = {a: small(location(a)[:, None])[0] for a in m.WALK}
        self.inverse = {a: np.linalg.inv(l) for a, l in self.location.items()}

    def block(self, q):
        real = ideal = np.eye(4)
        for a, axis in enumerate(m.WALK):
            n = nominal(axis, q[a])
            six = np.array([np.interp(q[a], *self.tables[axis, k]) for k in m.LETTERS])
            six *= np.array([1e-3] * 3 + [1e-6] * 3)[:, None]
            o = m.ORIGIN.get(axis, (0, 0, 0))
            before, after = translation(np.array(o)), translation(-np.array(o))
            moved = self.location[axis] @ n @ self.inverse[axis]
            # Y stands on the workpiece side: its error before the motion; C and A there: after it.
            e = small(six)
            moved = e @ moved if axis == "Y" else moved @ e
            real = real @ (before @ moved @ after)
            ideal = ideal @ (before @ n @ after)
        tip = np.array([*m.TIP, 1.0])
        d = (real - ideal) @ tip
        relative = real[:, :3, :3] @ ideal[:, :3, :3].transpose(0, 2, 1)
        w = 0.5 * np.stack([relative[:, 2, 1] - relative[:, 1, 2], relative[:, 0, 2] - relative[:, 2, 0],
                            relative[:, 1, 0] - relative[:, 0, 1]])
        return np.concatenate([d[:, :3].T, w])

    def run(self, count):
        for i in range(0, count, self.BLOCK):
            self.out[:, i:i + self.BLOCK] = self.block(self.columns[:, i:i + self.BLOCK])


# --- CasADi: the same chain in symbols, as C ---------------------------------------------------------------------------------


def casadi_functions():
    import casadi as ca

    def hat(w):
        return ca.vertcat(ca.horzcat(0, -w[2], w[1]), ca.horzcat(w[2], 0, -w[0]), ca.horzcat(-w[1], w[0], 0))

    def motion(r, t):
        return ca.vertcat(ca.horzcat(r, t), ca.DM([[0, 0, 0, 1]]))

    def error(six):
        w = six[3:]
        # sin t / t and (1 - cos t) / t^2 by their series: errors are below a mrad.
        square = ca.dot(w, w)
        h = hat(w)
        r = ca.SX.eye(3) + (1 - square / 6 + square**2 / 120) * h + (0.5 - square / 24 + square**2 / 720) * (h @ h)
        return motion(r, six[:3])

    def inverse(e):
        r = e[:3, :3].T
        return motion(r, -r @ e[:3, 3])

    q, e = ca.SX.sym("q", 5), ca.SX.sym("e", 30)
    real = ideal = ca.SX.eye(4)
    for a, axis in enumerate(m.WALK):
        six = e[6 * a:6 * a + 6]
        if axis in "XYZ":
            n = motion(ca.SX.eye(3), q[a] * ca.DM(UNIT[axis]))
        else:
            angle = q[a] * (np.pi / 180)
            s, c = ca.sin(angle), ca.cos(angle)
            h = hat(ca.DM(UNIT[axis]))
            n = motion(ca.DM.eye(3) + s * h + (1 - c) * (h @ h), ca.SX.zeros(3, 1))
        loc = error(ca.SX(location(axis))) if location(axis).any() else ca.SX.eye(4)
        t = ca.SX(translation(np.array(m.ORIGIN.get(axis, (0, 0, 0)))))
        moved = loc @ n @ inverse(loc)
        moved = error(six) @ moved if axis == "Y" else moved @ error(six)
        real = real @ (t @ moved @ inverse(t))
        ideal = ideal @ (t @ n @ inverse(t))
    tip = ca.vertcat(*m.TIP, 1)
    d = ((real - ideal) @ tip)[:3]
    r = real[:3, :3] @ ideal[:3, :3].T
    skew = 0.5 * ca.vertcat(r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1])
    square = ca.dot(skew, skew)
    w = skew * (1 + square / 6 + 3 * square**2 / 40)
    exact = ca.Function("exact", [q, e], [d, w], {"cse": True})
    # Location errors are of first order too: in symbols, so that they are linearised with the rest.
    return exact, first_order(ca, hat)


def first_order(ca, hat):
    """Sum over the joints of Ad(prefix) times the errors, written out: what one would generate by hand."""
    q, e = ca.SX.sym("q", 5), ca.SX.sym("e", 30)
    tip = ca.DM(m.TIP)
    r, t = ca.SX.eye(3), ca.SX.zeros(3, 1)
    twists = []
    for a, axis in enumerate(m.WALK):
        six, o = e[6 * a:6 * a + 6], ca.DM(m.ORIGIN.get(axis, (0, 0, 0)))
        loc = ca.DM(location(axis))
        if location(axis).any():
            twists.append((r, t, loc, o, 1))
        before = (r, t)
        if axis in "XYZ":
            t = t + r @ (q[a] * ca.DM(UNIT[axis]))
        else:
            angle = q[a] * (np.pi / 180)
            h = hat(ca.DM(UNIT[axis]))
            n = ca.DM.eye(3) + ca.sin(angle) * h + (1 - ca.cos(angle)) * (h @ h)
            t = t + r @ (o - n @ o)
            r = r @ n
        twists.append((*(before if axis == "Y" else (r, t)), six, o, 1))
        if location(axis).any():
            twists.append((r, t, loc, o, -1))
    place = r @ tip + t
    d, w = ca.SX.zeros(3, 1), ca.SX.zeros(3, 1)
    for r, t, six, o, sign in twists:
        turn = r @ six[3:] * sign
        d = d + r @ six[:3] * sign + ca.cross(turn, place - (r @ o + t))
        w = w + turn
    return ca.Function("first", [q, e], [d, w], {"cse": True})


LOOP = """
typedef long long casadi_int;
#define LOOP(NAME) int NAME(const double**, double**, casadi_int*, double*, int); \\
  void loop_##NAME(const double* in, double* out, long count) { double work[4096]; casadi_int integers[64]; \\
    for (long i = 0; i < count; ++i) { \\
      const double* arguments[16] = {in + 35 * i, in + 35 * i + 5}; double* results[16] = {out + 6 * i, out + 6 * i + 3}; \\
      NAME(arguments, results, integers, work, 0); } }
LOOP(first) LOOP(exact)
"""


class CasADi:
    """One call per pose from a loop in C; positions and 30 errors of a pose lie side by side."""

    def __init__(self, folder, columns, errors):
        import casadi as ca
        folder = pathlib.Path(folder)
        exact, first = casadi_functions()
        generator = ca.CodeGenerator("chain.c")
        generator.add(exact)
        generator.add(first)
        generator.generate(str(folder) + "/")
        (folder / "loop.c").write_text(LOOP)
        library = folder / "chain.so"
        subprocess.run(["cc", "-O3", "-march=native", "-fno-math-errno", "-shared", "-fPIC", "-o", library,
                        folder / "chain.c", folder / "loop.c", "-lm"], check=True)
        self.library = ctypes.CDLL(str(library))
        count = columns.shape[1]
        self.rows = np.ascontiguousarray(np.concatenate([columns, errors.reshape(30, count)]).T)
        self.out = np.empty((count, 6))

    def run(self, name, count):
        pointer = ctypes.POINTER(ctypes.c_double)
        loop = getattr(self.library, "loop_" + name)
        loop(self.rows.ctypes.data_as(pointer), self.out.ctypes.data_as(pointer), ctypes.c_long(count))


# --- Pinocchio: axes and errors as joints --------------------------------------------------------------------------------------


class Pinocchio:
    """Every error motion a free-flyer joint; forward kinematics of the real and the ideal chain, one call per pose from Python."""

    def __init__(self, columns, errors, count):
        import pinocchio as pin
        self.pin, self.count = pin, count
        self.real, self.ideal = self.chain(columns, errors, True), self.chain(columns, errors, False)
        self.out = np.empty((6, count))

    def chain(self, columns, errors, with_errors):
        pin = self.pin
        model, parent = pin.Model(), 0
        here = pin.SE3.Identity()
        configuration = []
        free = {"X": pin.JointModelPX, "Y": pin.JointModelPY, "Z": pin.JointModelPZ,
                "A": pin.JointModelRX, "C": pin.JointModelRZ}

        def add(joint, placement, name):
            nonlocal parent
            parent = model.addJoint(parent, joint, placement, name)

        def error_joint(a, axis, placement):
            add(pin.JointModelFreeFlyer(), placement, "E" + axis)
            half = 0.5 * errors[a, 3:, :self.count]
            angle = np.linalg.norm(half, axis=0)
            scale = np.where(angle > 0, np.sin(angle) / np.where(angle > 0, angle, 1), 1)
            configuration.append(np.vstack([errors[a, :3, :self.count], half * scale, np.cos(angle)]))

        for a, axis in enumerate(m.WALK):
            origin = pin.SE3(np.eye(3), np.array(m.ORIGIN.get(axis, (0.0, 0, 0))))
            six = location(axis)
            loc = pin.SE3(pin.exp3(six[3:]), six[:3]) if with_errors else pin.SE3.Identity()
            if with_errors and axis == "Y":
                error_joint(a, axis, here * origin)
                here = pin.SE3.Identity()
                add(free[axis](), here * loc, axis)
                here = loc.inverse() * origin.inverse()
            else:
                add(free[axis](), here * origin * loc, axis)
                here = loc.inverse()
                if with_errors:
                    q = columns[a, :self.count]
                    configuration.append((np.radians(q) if axis in "AC" else q)[None])
                    error_joint(a, axis, here)
                    here = pin.SE3.Identity()
                here = here * origin.inverse()
                if with_errors:
                    continue
            q = columns[a, :self.count]
            configuration.append((np.radians(q) if axis in "AC" else q)[None])
        model.addFrame(pin.Frame("tip", parent, 0, here * pin.SE3(np.eye(3), np.array(m.TIP)), pin.FrameType.OP_FRAME))
        return model, model.createData(), np.ascontiguousarray(np.concatenate(configuration).T), model.getFrameId("tip")

    def run(self):
        pin = self.pin
        (real, data, q, tip), (ideal, ideal_data, p, ideal_tip) = self.real, self.ideal
        for i in range(self.count):
            pin.forwardKinematics(real, data, q[i])
            pin.forwardKinematics(ideal, ideal_data, p[i])
            a, b = pin.updateFramePlacement(real, data, tip), pin.updateFramePlacement(ideal, ideal_data, ideal_tip)
            self.out[:3, i] = a.translation - b.translation
            self.out[3:, i] = pin.log3(a.rotation @ b.rotation.T)


class PinocchioFirst:
    """Order 1: the frame Jacobian of the ideal chain, in which every error motion is a free-flyer joint, times the errors."""

    def __init__(self, columns, errors, count):
        import pinocchio as pin
        self.pin, self.count, self.out = pin, count, np.empty((6, count))
        self.model, parent = pin.Model(), 0
        positions, speeds = [], []
        free = {"X": pin.JointModelPX, "Y": pin.JointModelPY, "Z": pin.JointModelPZ,
                "A": pin.JointModelRX, "C": pin.JointModelRZ}
        still = np.concatenate([np.zeros(6), [1.0]])[:, None].repeat(count, 1)
        here = pin.SE3.Identity()
        for a, axis in enumerate(m.WALK):
            origin = pin.SE3(np.eye(3), np.array(m.ORIGIN.get(axis, (0.0, 0, 0))))
            here = here * origin
            loc = location(axis)[:, None].repeat(count, 1)
            own = errors[a, :, :count]
            q = np.radians(columns[a, :count]) if axis in "AC" else columns[a, :count]
            joints = [("L", loc), ("M", None), ("U", -loc)]
            joints.insert(0 if axis == "Y" else 3, ("E", own))
            for name, speed in joints:
                joint = free[axis]() if speed is None else pin.JointModelFreeFlyer()
                parent = self.model.addJoint(parent, joint, here, name + axis)
                here = pin.SE3.Identity()
                positions.append(q[None] if speed is None else still)
                speeds.append(np.zeros((1, count)) if speed is None else speed)
            here = here * origin.inverse()
        tip = here * pin.SE3(np.eye(3), np.array(m.TIP))
        self.model.addFrame(pin.Frame("tip", parent, 0, tip, pin.FrameType.OP_FRAME))
        self.data, self.tip = self.model.createData(), self.model.getFrameId("tip")
        self.q = np.ascontiguousarray(np.concatenate(positions).T)
        self.v = np.ascontiguousarray(np.concatenate(speeds).T)

    def run(self):
        pin, frame = self.pin, self.pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
        for i in range(self.count):
            self.out[:, i] = pin.computeFrameJacobian(self.model, self.data, self.q[i], self.tip, frame) @ self.v[i]
