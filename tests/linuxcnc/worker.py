"""Runs inside the sandbox: drives the joints through the stops of plan.json.

Every servo cycle of every joint is recorded (cycles in which nothing changed once)
to joint_N.bin, five float64 per cycle in the order of session.SAMPLED_PINS.
"""

import array
import json
import sys

import session


def same(sample, last):
    """Equal, a NaN being equal to a NaN: a frozen correction stands still too."""
    if last is None or sample == last:
        return sample == last
    return all(a == b or (a != a and b != b) for a, b in zip(sample, last))


class Recorder:
    """Drains the samplers; knows for every joint what was recorded last."""

    def __init__(self, controller):
        self.controller = controller
        self.data = [array.array("d") for _ in controller.streams]
        self.last = [None] * len(controller.streams)
        self.seen = [0] * len(controller.streams)

    def drain(self):
        for joint, stream in enumerate(self.controller.streams):
            data, last = self.data[joint], self.last[joint]
            for _ in range(session.SAMPLER_DEPTH):
                sample = stream.read()
                if sample is None:
                    break
                self.seen[joint] += 1
                if not same(sample, last):
                    data.extend(sample)
                    last = sample
            self.last[joint] = last

    def cycles(self):
        return [len(data) // len(session.SAMPLED_PINS) for data in self.data]

    def settle(self, cycles=100, timeout=10.0):
        """Waits until nothing has changed for some servo cycles."""
        state = {"since": None, "rows": None}

        def quiet():
            self.drain()
            if self.cycles() != state["rows"]:
                state["rows"], state["since"] = self.cycles(), min(self.seen)
            return min(self.seen) - state["since"] >= cycles

        self.controller.wait("standstill", quiet, timeout)

    def pause(self):
        """Idle of a waiting loop: drains, which takes long enough not to spin."""
        self.drain()
        session.time.sleep(0.002)


def main():
    with open("plan.json") as source:
        plan = json.load(source)
    controller = session.Controller(joints=len(plan["letters"]))
    controller.start()
    controller.open_samplers()
    controller.home()
    recorder = Recorder(controller)
    recorder.settle()
    joints = range(controller.joints)
    result = {
        "home": [{"pos": controller.pin(f"joint.{n}.pos-cmd"),
                  "corr": controller.pin(f"joint.{n}.backlash-corr"),
                  "filt": controller.pin(f"joint.{n}.backlash-filt"),
                  "motor_offset": controller.pin(f"joint.{n}.motor-offset")} for n in joints],
        "linuxcnc": controller.linuxcnc.version,
        "rests": [],
    }
    for stop in plan["stops"]:
        words = " ".join(f"{letter}{position:.9f}"
                         for letter, position in zip(plan["letters"], stop["positions"]))
        controller.mdi(f"G93 G1 {words} F{60.0 / stop['seconds']:.6f}",
                       stop["seconds"] * 1.5 + 15.0, recorder.pause)
        recorder.settle()
        # The last recorded cycle is what the controller shows from now on.
        result["rests"].append([rows - 1 for rows in recorder.cycles()])
    controller.drain_messages()
    result["overruns"] = controller.overruns()
    result["messages"] = controller.messages
    result["cycles_seen"] = recorder.seen
    for joint in joints:
        with open(f"joint_{joint}.bin", "wb") as out:
            recorder.data[joint].tofile(out)
    with open("result.json", "w") as out:
        json.dump(result, out)


if __name__ == "__main__":
    sys.exit(main())
