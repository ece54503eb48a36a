#!/usr/bin/env python3
"""Holds graphs against the JSON Schema that `weir graph schema` prints, and checks that it refuses broken ones.

    schema_check.py WEIR GRAPH.json...

A validator for the part of JSON Schema that Weir's uses; a keyword that it doesn't know is an error.
"""
import json
import re
import subprocess
import sys

TYPES = {"object": dict, "string": str, "boolean": bool, "array": list}
SILENT = {"$schema", "title", "description", "default", "definitions"}


def is_type(value, name):
    if name in ("number", "integer"):
        return isinstance(value, (int, float) if name == "number" else int) and not isinstance(value, bool)
    return isinstance(value, TYPES[name])


def faults(value, schema, root, place="$"):
    """What is wrong with value, as a list of texts."""
    found = []
    for key, wanted in schema.items():
        if key in SILENT:
            continue
        if key == "$ref":
            found += faults(value, root["definitions"][wanted.removeprefix("#/definitions/")], root, place)
        elif key == "type":
            if not is_type(value, wanted):
                return [f"{place}: no {wanted}"]
        elif key == "const" or key == "enum":
            if value not in ([wanted] if key == "const" else wanted):
                found.append(f"{place}: {value!r}, not {wanted!r}")
        elif key == "pattern":
            if not re.search(wanted, value):
                found.append(f"{place}: {value!r} is not like {wanted}")
        elif key == "minimum" or key == "maximum":
            if value < wanted if key == "minimum" else value > wanted:
                found.append(f"{place}: {value} is beyond {wanted}")
        elif key == "minProperties":
            if len(value) < wanted:
                found.append(f"{place}: fewer than {wanted}")
        elif key == "required":
            found += [f"{place}: lacks {name}" for name in wanted if name not in value]
        elif key == "propertyNames":
            found += [fault for name in value for fault in faults(name, wanted, root, place)]
        elif key == "properties":
            found += [f for name, part in wanted.items() if name in value for f in faults(value[name], part, root, f"{place}.{name}")]
        elif key == "additionalProperties":
            others = [name for name in value if name not in schema.get("properties", {})]
            if wanted is False:
                found += [f"{place}: unknown {name}" for name in others]
            else:
                found += [f for name in others for f in faults(value[name], wanted, root, f"{place}.{name}")]
        elif key == "oneOf":
            tries = [faults(value, part, root, place) for part in wanted]
            if sum(not t for t in tries) != 1:
                found.append(f"{place}: fits {sum(not t for t in tries)} of oneOf; nearest: {min(tries, key=len)}")
        else:
            raise SystemExit(f"schema_check.py: the schema's keyword '{key}' is not known here")
    return found


def main():
    weir, *graphs = sys.argv[1:]
    schema = json.loads(subprocess.run([weir, "graph", "schema"], capture_output=True, text=True, check=True).stdout)
    bad = []
    for path in graphs:
        with open(path, encoding="utf-8") as file:
            graph = json.load(file)
        bad += [f"{path}: {fault}" for fault in faults(graph, schema, schema)]
        first = next(iter(graph["passes"].values()))
        for key, value in (("tyqe", "x"), ("type", "nowhere.Nothing"), ("params", {"nonsense": 1})):
            kept, first[key] = first.get(key), value
            if not faults(graph, schema, schema):
                bad.append(f"{path}: the schema takes \"{key}\": {value!r}")
            if kept is None:
                del first[key]
            else:
                first[key] = kept
    if bad or not graphs:
        sys.exit("\n".join(bad or ["no graphs"]))


if __name__ == "__main__":
    main()
