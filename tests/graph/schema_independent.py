#!/usr/bin/env python3
"""What schema_check.py checks, by a validator that others wrote, and that the schema itself is one of draft-07. Then
that Weir refuses what the schema refuses.

    schema_independent.py WEIR GRAPH.json...
"""
import json
import os
import subprocess
import sys
import tempfile

from jsonschema import Draft7Validator

import schema_cases


def place(error):
    return "$" + "".join(f".{part}" for part in error.absolute_path)


def main():
    weir, *graphs = sys.argv[1:]
    schema = schema_cases.read_schema(weir)
    Draft7Validator.check_schema(schema)
    validator = Draft7Validator(schema)
    bad = []
    for path in graphs:
        bad += [f"{path}: {place(error)}: {error.message}" for error in validator.iter_errors(schema_cases.read(path))]
    with tempfile.TemporaryDirectory() as folder:
        file = os.path.join(folder, "broken.json")
        for name, graph, where in schema_cases.broken(graphs):
            errors = list(validator.iter_errors(graph))
            # One fault, said once and where it is: not as "is none of all the passes there are".
            if [place(error) for error in errors] != [where]:
                bad.append(f"{name}: expected one error at {where}, not {[(place(e), e.message) for e in errors]}")
            with open(file, "w", encoding="utf-8") as out:
                json.dump(graph, out)
            check = subprocess.run([weir, "graph", "check", file], capture_output=True, text=True)
            if check.returncode != 2 or file not in check.stderr:
                bad.append(f"{name}: weir graph check ends with {check.returncode}: {check.stderr.strip()}")
    if bad or not graphs:
        sys.exit("\n".join(bad or ["no graphs"]))


if __name__ == "__main__":
    main()
