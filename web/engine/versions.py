"""Compares versions: the engine has that of the program, and the same packages below the library."""

import re
from pathlib import Path


def packages(path):
    found = {}
    for name, version in re.findall(r'name = "(.+)"\nversion = "(.+)"', Path(path).read_text()):
        found.setdefault(name, set()).add(version)
    return found


root, own = packages("Cargo.lock"), packages("web/engine/Cargo.lock")
assert own.pop("abbe-engine") == root["abbe"] == own["abbe"], "web/engine/Cargo.toml has another version than Cargo.toml"
others = {name: (own[name], root.get(name)) for name in own if not own[name] <= root.get(name, set())}
assert not others, f"web/engine/Cargo.lock has other versions than Cargo.lock: {others}"
