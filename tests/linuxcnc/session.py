"""A LinuxCNC without a screen and without real time, in a sandbox of its own.

The outer half (root) builds a run directory and starts a worker script in fresh
mount, pid, ipc and network namespaces as user nobody: rtapi_app refuses to run
as root, shared memory keys and port 5005 become private, and when the worker
ends the kernel ends every daemon with it. The inner half, `Controller`, is used
by the worker.
"""

import json
import os
import shutil
import subprocess
import sys
import tempfile
import time

HERE = os.path.dirname(os.path.abspath(__file__))
PYTHON = "/usr/bin/python3"  # only Debian's own has the modules linuxcnc and hal
PACKAGE = "linuxcnc-uspace"
TESTED_VERSION = "2.9.0~pre1+git20230208.f1270d6ed7"
NOBODY = 65534
SERVO_PERIOD_NS = 250_000
ACCELERATION = 1000.0  # with 250 us the dead zone of the ramp is 3.1e-5 mm at most
# Per servo cycle and joint; the order is the order of the sampler's columns.
SAMPLED_PINS = ("pos-cmd", "vel-cmd", "backlash-corr", "backlash-filt", "motor-pos-cmd")
SAMPLER_DEPTH = 65536


class SessionFailed(Exception):
    """The controller did not do what the test needs; the text carries its logs."""


# --- outer half -----------------------------------------------------------------


def version():
    """Version of the installed package; SessionFailed when it is not installed."""
    query = ["dpkg-query", "-W", "-f", "${db:Status-Status} ${Version}", PACKAGE]
    found = subprocess.run(query, capture_output=True, text=True, check=False)
    status, _, number = found.stdout.partition(" ")
    if found.returncode != 0 or status != "installed":
        raise SessionFailed(f"{PACKAGE} is not installed: run tests/linuxcnc/install.sh")
    return number


def assert_version():
    """The semantics tested here were measured with one version: refuse another."""
    number = version()
    if not number.startswith(TESTED_VERSION):
        raise SessionFailed(f"{PACKAGE} {number} is not the measured {TESTED_VERSION}")
    return number


def report(measure):
    """Prints what a measurement returns, with the package, as JSON; the exit code. Another version is refused."""
    try:
        result = {"package": assert_version(), **measure()}
    except SessionFailed as failure:
        print(failure, file=sys.stderr)
        return 1
    print(json.dumps(result))
    return 0


class RunDir:
    """A temporary directory that nobody can read and write, removed at the end."""

    def __init__(self, files, copies=(), keep=False):
        self.keep = keep
        self.path = tempfile.mkdtemp(prefix="abbe-linuxcnc-")
        scripts = [name for name in os.listdir(HERE) if name.endswith(".py")]
        for source in [os.path.join(HERE, name) for name in scripts] + list(copies):
            shutil.copyfile(source, self.join(os.path.basename(source)))
        for name, text in files.items():
            mode = "wb" if isinstance(text, bytes) else "w"
            with open(self.join(name), mode) as out:
                out.write(text)
        os.mkdir(self.join("log"))
        for root, _, names in os.walk(self.path):
            for entry in [root] + [os.path.join(root, name) for name in names]:
                if os.getuid() == 0:
                    os.chown(entry, NOBODY, NOBODY)
        os.chmod(self.path, 0o755)

    def join(self, *parts):
        return os.path.join(self.path, *parts)

    def __enter__(self):
        return self

    def __exit__(self, kind, value, trace):
        if self.keep:
            print(f"kept {self.path}", file=sys.stderr)
        else:
            shutil.rmtree(self.path, ignore_errors=True)


MODULES = "/usr/lib/linuxcnc/modules"


def sandboxed(argv, modules=None):
    """The command line that runs `argv` as nobody in namespaces of its own; `modules` is a
    directory of real-time modules that are seen beside the installed ones."""
    if os.getuid() != 0:
        raise SessionFailed("namespaces and user nobody need root")
    spaces = ["unshare", "--mount", "--pid", "--fork", "--kill-child", "--mount-proc",
              "--ipc", "--net"]
    user = ["setpriv", "--reuid", str(NOBODY), "--regid", str(NOBODY), "--clear-groups",
            "--no-new-privs"]
    if modules is None:
        return spaces + user + list(argv)
    overlay = 'mount -t overlay overlay -o lowerdir="$0:$1" "$1" && shift && exec "$@"'
    return spaces + ["sh", "-c", overlay, modules, MODULES] + user + list(argv)


def run_worker(rundir, argv, timeout, modules=None):
    """Runs `argv` in the sandbox with `rundir` as cwd and home; SessionFailed on failure."""
    environment = {"PATH": "/usr/bin:/bin:/usr/sbin:/sbin", "HOME": rundir.path,
                   "LANG": "C", "PYTHONDONTWRITEBYTECODE": "1"}
    log = rundir.join("log", "worker.log")
    # Files, not pipes: the daemons inherit them and would keep a pipe open.
    with open(log, "w") as out, open(os.devnull) as null:
        process = subprocess.Popen(sandboxed(argv, modules), cwd=rundir.path, env=environment,
                                   stdin=null, stdout=out, stderr=subprocess.STDOUT)
        try:
            code = process.wait(timeout)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
            code = f"timeout after {timeout} s"
    if code != 0:
        raise SessionFailed(f"worker ended with {code}\n{logs(rundir.join('log'))}")


def logs(directory, tail=3000):
    """The ends of all logs, to be shown with a failure."""
    parts = []
    for name in sorted(os.listdir(directory)):
        with open(os.path.join(directory, name), errors="replace") as log:
            text = log.read()
        if text.strip():
            parts.append(f"--- {name} ---\n{text[-tail:]}")
    return "\n".join(parts)


# --- INI and HAL ----------------------------------------------------------------

GLOBAL_INI = {
    "EMC": {"VERSION": "1.1", "MACHINE": "abbe-test", "DEBUG": "0"},
    "DISPLAY": {"DISPLAY": "none"},
    "TASK": {"TASK": "milltask", "CYCLE_TIME": "0.001"},
    "RS274NGC": {"PARAMETER_FILE": "linuxcnc.var"},
    "EMCMOT": {"EMCMOT": "motmod", "COMM_TIMEOUT": "1", "SERVO_PERIOD": str(SERVO_PERIOD_NS)},
    "EMCIO": {"EMCIO": "io", "CYCLE_TIME": "0.05", "TOOL_TABLE": "tool.tbl"},
    "TRAJ": {"LINEAR_UNITS": "mm", "ANGULAR_UNITS": "degree", "NO_FORCE_HOMING": "0",
             "DEFAULT_LINEAR_VELOCITY": "100", "MAX_LINEAR_VELOCITY": "1000",
             "DEFAULT_ANGULAR_VELOCITY": "100", "MAX_ANGULAR_VELOCITY": "1000",
             "DEFAULT_LINEAR_ACCELERATION": str(ACCELERATION),
             "MAX_LINEAR_ACCELERATION": str(ACCELERATION),
             "MAX_ANGULAR_ACCELERATION": str(ACCELERATION)},
}


def motion_ini(low, high, speed):
    """Keys of an axis or joint section that do not depend on compensation."""
    return {"MIN_LIMIT": repr(low), "MAX_LIMIT": repr(high), "MAX_VELOCITY": repr(speed),
            "MAX_ACCELERATION": repr(ACCELERATION)}


def joint_ini(low, high, speed):
    """Keys of a joint section: homed on the spot at 0, following error ignored."""
    keys = motion_ini(low, high, speed)
    keys.update({"HOME": "0", "HOME_OFFSET": "0", "HOME_SEARCH_VEL": "0",
                 "HOME_LATCH_VEL": "0", "HOME_SEQUENCE": "0",
                 "FERROR": "1e9", "MIN_FERROR": "1e9"})
    return keys


def render_ini(sections):
    """INI text; LinuxCNC's parser reads the first section of a name only."""
    lines = []
    for section, keys in sections.items():
        lines.append(f"[{section}]")
        lines.extend(f"{key} = {value}" for key, value in keys.items())
        lines.append("")
    return "\n".join(lines)


def parse_ini(text):
    """Plain `[SECTION]` and `KEY = VALUE`; anything else is refused, not guessed."""
    sections, current = {}, None
    for number, line in enumerate(text.splitlines(), 1):
        line = line.strip()
        if not line or line.startswith(("#", ";")):
            continue
        if line.startswith("[") and line.endswith("]"):
            if line[1:-1] in sections:
                raise SessionFailed(f"INI line {number}: section {line} is there twice")
            current = sections.setdefault(line[1:-1], {})
        elif "=" in line and current is not None:
            key, value = (part.strip() for part in line.split("=", 1))
            if key in current:
                raise SessionFailed(f"INI line {number}: {key} is there twice")
            current[key] = value
        else:
            raise SessionFailed(f"INI line {number} not understood: {line!r}")
    return sections


def hal_text(joints):
    """HAL file with a sampler per joint: at most eight."""
    return bare_hal(joints) + sampled(joints)


def bare_hal(joints):
    """HAL file: motors that follow at once, no emergency stop."""
    lines = [
        "loadrt tpmod", "loadrt homemod", "loadrt [KINS]KINEMATICS",
        f"loadrt motmod servo_period_nsec={SERVO_PERIOD_NS} num_joints={joints}",
        "addf motion-command-handler servo-thread", "addf motion-controller servo-thread",
        "net estop iocontrol.0.user-enable-out => iocontrol.0.emc-enable-in",
        "net prepare iocontrol.0.tool-prepare => iocontrol.0.tool-prepared",
        "net change iocontrol.0.tool-change => iocontrol.0.tool-changed",
    ]
    lines += [f"net {motor(joint)} joint.{joint}.{SAMPLED_PINS[-1]} => joint.{joint}.motor-pos-fb"
              for joint in range(joints)]
    return "\n".join(lines) + "\n"


# HAL lines that count servo cycles on the pin cycles.out: a busy machine may hold the thread for longer than any look.
CYCLES = """loadrt sum2 names=cycles
addf cycles servo-thread
net cycles cycles.out => cycles.in0
setp cycles.in1 1
"""


def motor(joint):
    """The signal of a joint's motor command."""
    return f"joint{joint}-{SAMPLED_PINS[-1]}"


def sampled(joints):
    """HAL lines that sample every joint."""
    pins_per_sampler = "f" * len(SAMPLED_PINS)
    lines = ["loadrt sampler depth={} cfg={}".format(
        ",".join([str(SAMPLER_DEPTH)] * joints), ",".join([pins_per_sampler] * joints))]
    for joint in range(joints):
        lines += [f"net joint{joint}-{pin} joint.{joint}.{pin} => sampler.{joint}.pin.{column}"
                  for column, pin in enumerate(SAMPLED_PINS[:-1])]
        lines.append(f"net {motor(joint)} => sampler.{joint}.pin.{len(SAMPLED_PINS) - 1}")
        lines.append(f"addf sampler.{joint} servo-thread")
    return "\n".join(lines) + "\n"


# --- inner half -----------------------------------------------------------------


class Controller:
    """Starts, homes and moves the controller; used inside the sandbox only."""

    def __init__(self, ini="run.ini", hal_file="run.hal", joints=1):
        self.ini, self.hal_file, self.joints = os.path.abspath(ini), hal_file, joints
        self.messages, self.processes = [], []
        self.streams = []

    def spawn(self, name, *argv):
        log = open(os.path.join("log", name + ".log"), "a")
        process = subprocess.Popen(argv, stdin=subprocess.DEVNULL, stdout=log,
                                   stderr=subprocess.STDOUT)
        self.processes.append((name, process))
        return process

    def call(self, name, *argv, timeout=20):
        code = self.spawn(name, *argv).wait(timeout)
        if code != 0:
            raise SessionFailed(f"{name} ended with {code}")

    def start(self):
        """The start order of the stock launcher, without its display."""
        self.call("linuxcncsvr", "linuxcncsvr", "-ini", self.ini)
        self.call("halcmd", "halcmd", "loadusr", "-Wn", "iocontrol", "io", "-ini", self.ini)
        self.call("halcmd", "halcmd", "-i", self.ini, "-f", self.hal_file)
        # Task talks to motion while it starts, so it must not be waited for here.
        self.spawn("milltask", "milltask", "-ini", self.ini)
        self.call("halcmd", "halcmd", "start")
        self.attach()

    def attach(self):
        """To a controller that is running: this one's, or one that the stock launcher has started."""
        import hal
        import linuxcnc
        self.linuxcnc, self.hal = linuxcnc, hal
        self.component = hal.component("abbe-test")
        self.component.ready()
        self.stat, self.command = linuxcnc.stat(), linuxcnc.command()
        self.errors = linuxcnc.error_channel()
        self.wait("status channel", self._status_is_there)

    def _status_is_there(self):
        self.stat.poll()
        return self.stat.joints == self.joints

    def open_samplers(self):
        config = "f" * len(SAMPLED_PINS)
        self.streams = [self.hal.stream(self.component, self.hal.sampler_base + joint, config)
                        for joint in range(self.joints)]

    def wait(self, what, condition, timeout=15.0, idle=lambda: time.sleep(0.002)):
        """Polls `condition`; `idle` runs in between and can drain the samplers."""
        end = time.monotonic() + timeout
        while not condition():
            if time.monotonic() > end:
                self.drain_messages()
                raise SessionFailed(f"timeout: {what}; messages {self.messages}")
            idle()

    def drain_messages(self):
        while True:
            message = self.errors.poll()
            if not message:
                return
            self.messages.append(message[1].strip())

    def home(self):
        """Out of emergency stop, on, all joints homed where they stand, then MDI."""
        linuxcnc = self.linuxcnc
        self._set_state(linuxcnc.STATE_ESTOP_RESET, "out of emergency stop")
        self._set_state(linuxcnc.STATE_ON, "machine on")
        self._set_mode(linuxcnc.MODE_MANUAL)
        self.command.teleop_enable(0)
        self.command.wait_complete(5)
        self.command.home(-1)
        self.wait("homing", self._all_homed)
        self._set_mode(linuxcnc.MODE_MDI)

    def _set_state(self, state, what):
        self.command.state(state)
        self.command.wait_complete(5)
        self.wait(what, lambda: self._polled().task_state == state)

    def _set_mode(self, mode):
        self.command.mode(mode)
        self.command.wait_complete(5)
        self.wait("mode change", lambda: self._polled().task_mode == mode)

    def _polled(self):
        self.stat.poll()
        return self.stat

    def _all_homed(self):
        return sum(self._polled().homed[: self.joints]) == self.joints

    def mdi(self, line, timeout, idle):
        """Runs one line to the end of its motion; an operator error is a failure."""
        before = len(self.messages)
        self.command.mdi(line)
        serial = self.command.serial

        def finished():
            stat = self._polled()
            return (stat.echo_serial_number == serial and stat.inpos and stat.queue == 0
                    and stat.state == self.linuxcnc.RCS_DONE
                    and stat.interp_state == self.linuxcnc.INTERP_IDLE)

        self.wait(f"MDI {line}", finished, timeout, idle)
        self.drain_messages()
        # What the table loader has to say can arrive late: it is not about this line.
        about_motion = [m for m in self.messages[before:] if "compensation" not in m]
        if about_motion:
            raise SessionFailed(f"MDI {line}: {about_motion}")

    def pin(self, name):
        return self.hal.get_value(name)

    def overruns(self):
        return [self.pin(f"sampler.{joint}.overruns") for joint in range(self.joints)]
