"""The schema, the shipped graphs, and graphs that are broken in ways that a schema can see."""
import copy
import json
import subprocess


def read(path):
    with open(path, encoding="utf-8") as file:
        return json.load(file)


def read_schema(weir):
    return json.loads(subprocess.run([weir, "graph", "schema"], capture_output=True, text=True, check=True).stdout)


def broken(paths):
    """(name, graph, place of the fault): made of graphs/restir_di.json."""
    path = next(path for path in paths if path.endswith("restir_di.json"))
    valid = read(path)

    def case(name, place, change):
        graph = copy.deepcopy(valid)
        change(graph, graph["passes"])
        assert json.dumps(graph) != json.dumps(valid), name
        return name, graph, place

    spatial, temporal = "$.passes.spatial", "$.passes.temporal"
    return [
        case("unknown key", "$", lambda g, p: g.update(passs={})),
        case("no version", "$", lambda g, p: g.pop("version")),
        case("another version", "$.version", lambda g, p: g.update(version=2)),
        case("a name that is none", "$.name", lambda g, p: g.update(name=3)),
        case("no passes", "$.passes", lambda g, p: p.clear()),
        case("no outputs", "$.outputs", lambda g, p: g["outputs"].clear()),
        case("an output that is no reference", "$.outputs.color", lambda g, p: g["outputs"].update(color="tonemap")),
        case("a pass's name with a dot", "$.passes", lambda g, p: p.update({"a.b": p["gbuffer"]})),
        case("unknown key of a pass", spatial, lambda g, p: p["spatial"].update(tyqe="x")),
        case("no type", spatial, lambda g, p: p["spatial"].pop("type")),
        case("unknown type", f"{spatial}.type", lambda g, p: p["spatial"].update(type="restir_di.Spacial")),
        case("enabled by a number", f"{spatial}.enabled", lambda g, p: p["spatial"].update(enabled=1)),
        case("no inputs", spatial, lambda g, p: p["spatial"].pop("inputs")),
        case("unknown input", f"{temporal}.inputs", lambda g, p: p["temporal"]["inputs"].update(moton="gbuffer.motion")),
        case("open input", f"{temporal}.inputs", lambda g, p: p["temporal"]["inputs"].pop("motion")),
        case("bad reference", f"{temporal}.inputs.motion", lambda g, p: p["temporal"]["inputs"].update(motion="gbuffer")),
        case("bad suffix", f"{temporal}.inputs.history",
             lambda g, p: p["temporal"]["inputs"].update(history="spatial.reservoirs@prev")),
        case("unknown parameter", f"{spatial}.params", lambda g, p: p["spatial"]["params"].update(neighbors=4)),
        case("a text for an integer", f"{spatial}.params.iterations", lambda g, p: p["spatial"]["params"].update(iterations="1")),
        case("a fraction for an integer", f"{spatial}.params.iterations",
             lambda g, p: p["spatial"]["params"].update(iterations=1.5)),
        case("a number for a bool", "$.passes.initial.params.visibility",
             lambda g, p: p["initial"]["params"].update(visibility=1)),
        case("null for a number", f"{spatial}.params.radius", lambda g, p: p["spatial"]["params"].update(radius=None)),
        case("too small", f"{spatial}.params.iterations", lambda g, p: p["spatial"]["params"].update(iterations=0)),
        case("too large", f"{spatial}.params.radius", lambda g, p: p["spatial"]["params"].update(radius=1e6)),
        case("unknown choice", f"{spatial}.params.mis", lambda g, p: p["spatial"]["params"].update(mis="pairwize")),
    ]
