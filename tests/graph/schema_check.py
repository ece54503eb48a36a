#!/usr/bin/env python3
"""Holds graphs against the JSON Schema that `weir graph schema` prints, and checks that it refuses broken ones.

    schema_check.py WEIR GRAPH.json...

A validator for the part of JSON Schema that Weir's uses; a keyword that it doesn't know is an error.
"""
import re
import sys

import schema_cases

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
        elif key == "allOf":
            found += [f for part in wanted for f in faults(value, part, root, place)]
        elif key == "if":
            if not faults(value, wanted, root, place):
                found += faults(value, schema["then"], root, place)
        elif key == "then":
            pass  # with "if"
        else:
            raise SystemExit(f"schema_check.py: the schema's keyword '{key}' is not known here")
    return found


def main():
    weir, *graphs = sys.argv[1:]
    schema = schema_cases.read_schema(weir)
    bad = []
    for path in graphs:
        bad += [f"{path}: {fault}" for fault in faults(schema_cases.read(path), schema, schema)]
    for name, graph, place in schema_cases.broken(graphs):
        found = faults(graph, schema, schema)
        if not any(fault.startswith(place) for fault in found):
            bad.append(f"{name}: the schema says nothing at {place}, but: {found}")
    if bad or not graphs:
        sys.exit("\n".join(bad or ["no graphs"]))


if __name__ == "__main__":
    main()
