"""Plans the motion of an observation and turns recorded cycles into rows."""

import array
import bisect
import json
import math
import os

import session

COLUMNS = ("joint", "direction", "position", "corr", "filt", "motor_minus_pos", "phase",
           "pos_cmd")
TOP_SPEED = 300.0  # mm/s or deg/s of a sweep
JOINT_SPEED = 600.0  # the ramp of a reversal may use half of it
PERIOD = session.SERVO_PERIOD_NS * 1e-9
# Below this speed of the correction itself, the controller follows it exactly.
FOLLOW = 0.8 * session.ACCELERATION * PERIOD / 4
DEAD_ZONE = 0.5 * session.ACCELERATION * PERIOD**2 * 1.001
DEAD_ZONE_START = 0.25 * session.ACCELERATION * PERIOD**2 * 0.999
CONVERGED = 1e-9
NUDGE = 0.8
# Interior stops as fractions of the table, every second one moved on to a node.
INTERIOR = (0.06, 0.17, 0.29, 0.41, 0.5, 0.63, 0.74, 0.86, 0.95)
MAX_ROWS = 4000  # per joint and direction


# --- plan -----------------------------------------------------------------------


def margin(table):
    """How far a joint is driven beyond its table."""
    return max(3.0, 0.03 * (table.high - table.low))


def travel(table):
    """Limits of the run: the table and what lies beyond it, home (0) included."""
    beyond = margin(table) + 1.0
    return min(table.low - beyond, -1.0), max(table.high + beyond, 1.0)


def stops(table):
    """Where one joint rests, from below the table to above it."""
    beyond, span = margin(table), table.high - table.low
    places = [table.low - beyond, table.low - beyond / 3, table.low]
    for count, fraction in enumerate(INTERIOR):
        place = table.low + fraction * span
        if count % 2 == 0:
            place = table.nominal[bisect.bisect_right(table.nominal, place) - 1]
        places.append(place)
    return places + [table.high, table.high + beyond / 3, table.high + beyond]


def seconds(tables, before, after):
    """Time of one move so that no joint's correction changes too fast to be followed."""
    longest = 0.05
    for table, start, end in zip(tables, before, after):
        slope = table.steepest(min(start, end), max(start, end))
        speed = min(TOP_SPEED, FOLLOW / slope if slope > 0 else TOP_SPEED)
        longest = max(longest, abs(end - start) / speed)
    return longest


def plan(fragment):
    """All joints together up and down through their stops, with nudges on the way."""
    tables = [joint.table for joint in fragment.joints]
    up = [list(stop) for stop in zip(*(stops(table) for table in tables))]
    down = []
    for count, stop in enumerate(reversed(up[:-1])):
        down.append(stop)
        if count % 4 == 3:  # a reversal in the middle of the table
            down.append([place + NUDGE for place in stop])
    # Twice up: the first motion of all starts from home, in the middle of nowhere.
    places = up + down + [up[1]]
    moves, here = [], [0.0] * len(tables)
    for place in places:
        moves.append({"positions": place, "seconds": seconds(tables, here, place)})
        here = place
    return {"letters": fragment.letters, "stops": moves}


# --- rows -----------------------------------------------------------------------


def ramp_cycles(step):
    """Servo cycles in which a reversal of this size has to be worked off."""
    acceleration, top = session.ACCELERATION / 2, JOINT_SPEED / 2
    duration = 2 * math.sqrt(step / acceleration) + step / top
    return int(1.2 * duration / PERIOD) + 20


class Phase:
    """Tells motion from the ramp after a reversal and from its dead zone.

    The controller's ramp leaves a remainder between a half and the whole of
    DEAD_ZONE alone until the table value changes enough: it stands still then,
    and nothing but standing still in that range counts as the dead zone.
    """

    def __init__(self):
        self.direction, self.deadline, self.filt = None, None, 0.0

    def reverse(self, cycle, direction, corr):
        self.direction = direction
        self.deadline = cycle + ramp_cycles(abs(corr - self.filt))

    def of(self, cycle, corr, filt):
        """Phase of one cycle; every cycle has to be passed in, in order."""
        left, frozen = abs(filt - corr), filt == self.filt
        self.filt = filt
        if self.deadline is None or left <= CONVERGED:
            self.deadline = None
            return "motion"
        if frozen and DEAD_ZONE_START <= left <= DEAD_ZONE:
            self.deadline = cycle + ramp_cycles(left)
            return "deadzone"
        return "ramp" if cycle <= self.deadline else "motion"


def rows_of(recorded, rests):
    """Rows of one joint: (direction, position, corr, filt, motor_minus_pos, phase, pos_cmd).

    `position` is where the table was looked up: the commanded position of the last
    cycle with a velocity. Cycles before the first motion have no direction.
    """
    width, state = len(session.SAMPLED_PINS), Phase()
    rests, rows, lookup = set(rests), [], None
    for cycle in range(len(recorded) // width):
        pos, vel, corr, filt, motor = recorded[cycle * width:(cycle + 1) * width]
        if vel != 0.0:
            direction = "forward" if vel > 0 else "reverse"
            if direction != state.direction:
                state.reverse(cycle, direction, corr)
            lookup = pos
        if state.direction is None:
            state.filt = filt
            continue
        phase = state.of(cycle, corr, filt)
        if cycle in rests:
            phase = "rest"
        if vel != 0.0 or phase != "motion":
            rows.append((state.direction, lookup, corr, filt, motor - pos, phase, pos))
    return rows


def evenly(rows, count):
    """At most `count` of the rows, evenly spread, first and last included."""
    if len(rows) <= count:
        return list(rows)
    return [rows[round(i * (len(rows) - 1) / (count - 1))] for i in range(count)]


def thinned(rows, table, direction):
    """Rows of one direction: all rests, both sides of every node, samples of the rest."""
    mine = [(index, row) for index, row in enumerate(rows) if row[0] == direction]
    keep = {index for index, row in mine if row[5] == "rest"}
    for (index, row), (after, following) in zip(mine, mine[1:]):
        if (bisect.bisect_right(table.nominal, row[1])
                != bisect.bisect_right(table.nominal, following[1])):
            keep |= {index, after}
    groups = [
        ([i for i, row in mine if row[5] in ("ramp", "deadzone")], 400),
        ([i for i, row in mine if row[1] < table.low], 100),
        ([i for i, row in mine if row[1] >= table.high], 100),
    ]
    for group, count in groups:
        keep |= set(evenly(group, count))
    keep |= set(evenly([i for i, _ in mine], MAX_ROWS - len(keep)))
    return [rows[index] for index in sorted(keep)]


# --- run ------------------------------------------------------------------------


class Observation:
    """What the controller did, joint by joint, every recorded servo cycle."""

    def __init__(self, fragment, rows, result, motion_seconds):
        self.fragment, self.rows = fragment, rows
        self.result, self.motion_seconds = result, motion_seconds

    def write_csv(self, path):
        with open(path, "w", encoding="ascii") as out:
            out.write(",".join(COLUMNS) + "\n")
            for joint, rows in zip(self.fragment.joints, self.rows):
                for direction in ("forward", "reverse"):
                    for row in thinned(rows, joint.table, direction):
                        name, *numbers, phase, pos_cmd = row
                        texts = [str(joint.number), name, *map(repr, numbers), phase,
                                 repr(pos_cmd)]
                        out.write(",".join(texts) + "\n")


def observe(fragment, limit_seconds=300.0, keep=False):
    """Runs the controller over the fragment's tables."""
    moves = plan(fragment)
    motion_seconds = sum(stop["seconds"] for stop in moves["stops"])
    if motion_seconds > limit_seconds:
        raise session.SessionFailed(
            f"the sweep takes {motion_seconds:.0f} s because a table is steep or long;"
            f" --max-seconds is {limit_seconds:.0f}")
    ranges = [travel(joint.table) for joint in fragment.joints]
    files = {"run.ini": fragment.merged_ini(ranges, JOINT_SPEED),
             "run.hal": session.hal_text(len(fragment.joints)), "tool.tbl": "",
             "plan.json": json.dumps(moves)}
    tables = [joint.path for joint in fragment.joints]
    with session.RunDir(files, tables, keep) as rundir:
        session.run_worker(rundir, [session.PYTHON, "worker.py"], motion_seconds * 2 + 60)
        with open(rundir.join("result.json")) as source:
            result = json.load(source)
        recorded = [read_binary(rundir.join(f"joint_{joint.number}.bin"))
                    for joint in fragment.joints]
    assert_sound(result)
    rests = list(zip(*result["rests"]))
    rows = [rows_of(cycles, rest) for cycles, rest in zip(recorded, rests)]
    return Observation(fragment, rows, result, motion_seconds)


def read_binary(path):
    values = array.array("d")
    with open(path, "rb") as source:
        values.fromfile(source, os.path.getsize(path) // values.itemsize)
    return values


def assert_sound(result):
    """A run whose record has holes or whose controller complained shows nothing."""
    if any(result["overruns"]):
        raise session.SessionFailed(f"sampler overruns: {result['overruns']}")
    if result["messages"]:
        raise session.SessionFailed(f"operator messages: {result['messages']}")
    for number, home in enumerate(result["home"]):
        if any(home[key] != 0.0 for key in ("pos", "corr", "filt", "motor_offset")):
            raise session.SessionFailed(f"joint {number} after homing: {home}")
