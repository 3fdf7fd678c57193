"""Compares versions: the engine has the library of the program, and the same packages below it."""

import re
from pathlib import Path


def packages(path):
    found = {}
    for name, version in re.findall(r'name = "(.+)"\nversion = "(.+)"', Path(path).read_text()):
        found.setdefault(name, set()).add(version)
    return found


root, own = packages("Cargo.lock"), packages("web/engine/Cargo.lock")
own.pop("abbe-engine")
assert own["abbe"] == root["abbe"], "web/engine/Cargo.lock has another version than Cargo.toml: run cargo update abbe there"
others = {name: (own[name], root.get(name)) for name in own if not own[name] <= root.get(name, set())}
assert not others, f"web/engine/Cargo.lock has other versions than Cargo.lock: {others}"
