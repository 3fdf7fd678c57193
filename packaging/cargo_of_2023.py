#!/usr/bin/env python3
"""cargo, but `cargo metadata` writes package ids as up to Rust 1.76: `name version (source)`."""

import json
import os
import subprocess
import sys


def renamed(value, ids):
    """Returns a JSON value with every id replaced."""
    if isinstance(value, dict):
        return {key: renamed(inner, ids) for key, inner in value.items()}
    if isinstance(value, list):
        return [renamed(inner, ids) for inner in value]
    return ids.get(value, value) if isinstance(value, str) else value


def id_of(package):
    """Returns the id that a package had."""
    source = package["source"] or package["id"].partition("#")[0]
    return f"{package['name']} {package['version']} ({source})"


arguments = ["cargo", *sys.argv[1:]]
if "metadata" not in arguments:
    os.execvp("cargo", arguments)
metadata = json.loads(subprocess.run(arguments, stdout=subprocess.PIPE, check=True).stdout)
json.dump(renamed(metadata, {package["id"]: id_of(package) for package in metadata["packages"]}), sys.stdout)
