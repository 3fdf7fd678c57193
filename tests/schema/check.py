"""Validates documents with an independent implementation of JSON Schema.

Standard input: {"schema": ..., "accept": {name: document}, "refuse": {name: document}}.
Prints what went wrong and exits with 1 then.
"""
import json
import sys

import jsonschema

task = json.load(sys.stdin)
jsonschema.Draft7Validator.check_schema(task["schema"])
validator = jsonschema.Draft7Validator(task["schema"])
wrong = []
for name, document in task["accept"].items():
    for failure in validator.iter_errors(document):
        wrong.append(f"{name} is refused: {list(failure.absolute_path)}: {failure.message[:300]}")
for name, document in task["refuse"].items():
    if validator.is_valid(document):
        wrong.append(f"{name} is accepted")
print("\n".join(wrong) or f"{len(task['accept'])} accepted, {len(task['refuse'])} refused")
sys.exit(1 if wrong else 0)
