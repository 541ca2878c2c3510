"""What OpenCASCADE reads from STEP and IGES files: faces with kind and area, validity, seconds.

usage: occt.py FILE...   prints one JSON object a line
       occt.py --time N FILE   reads the file N times and prints the least seconds and the most memory, in sizes of the file
       occt.py --compare INSPECT.json ORIGINAL EXPORT...
           compares every export with the original and with our own areas, one line each; exit 1 where they differ
Needs the PyPI package cadquery-ocp-novtk (or cadquery-ocp).
"""

import json
import os
import resource
import sys
import time

from OCP.BRep import BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Surface
from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.BRepGProp import BRepGProp
from OCP.GProp import GProp_GProps
from OCP.IFSelect import IFSelect_RetDone
from OCP.IGESControl import IGESControl_Reader
from OCP.STEPControl import STEPControl_Reader
from OCP.TopAbs import TopAbs_ShapeEnum as Kind
from OCP.TopExp import TopExp_Explorer
from OCP.TopoDS import TopoDS


def reader_of(path):
    return IGESControl_Reader() if path.lower().endswith((".igs", ".iges")) else STEPControl_Reader()


def read(path):
    start = time.perf_counter()
    reader = reader_of(path)
    if reader.ReadFile(path) != IFSelect_RetDone:
        raise RuntimeError("not read")
    parsed = time.perf_counter()
    reader.TransferRoots()
    shape = reader.OneShape()
    return shape, parsed - start, time.perf_counter() - start


def face_of(shape):
    cast = getattr(TopoDS, "Face_s", None) or getattr(TopoDS, "Face")
    return cast(shape)


def area_of(face):
    properties = GProp_GProps()
    compute = getattr(BRepGProp, "SurfaceProperties_s", None) or BRepGProp.SurfaceProperties
    # Adaptive: the default rule is off by more than a percent on some trimmed faces.
    compute(face, properties, 1e-8)
    return properties.Mass()


def slack_of(face):
    """The area that the edges' own tolerances leave open: each times the edge's length."""
    tolerance = getattr(BRep_Tool, "Tolerance_s", None) or BRep_Tool.Tolerance
    compute = getattr(BRepGProp, "LinearProperties_s", None) or BRepGProp.LinearProperties
    total = 0.0
    walk = TopExp_Explorer(face, Kind.TopAbs_EDGE)
    while walk.More():
        cast = getattr(TopoDS, "Edge_s", None) or getattr(TopoDS, "Edge")
        edge = cast(walk.Current())
        properties = GProp_GProps()
        compute(edge, properties)
        total += tolerance(edge) * properties.Mass()
        walk.Next()
    return total


def report(path):
    shape, parsed, seconds = read(path)
    faces = []
    walk = TopExp_Explorer(shape, Kind.TopAbs_FACE)
    while walk.More():
        face = face_of(walk.Current())
        kind = str(BRepAdaptor_Surface(face).GetType()).split("GeomAbs_")[-1]
        faces.append({"kind": kind, "area": area_of(face), "slack": slack_of(face)})
        walk.Next()
    count = 0
    solids = TopExp_Explorer(shape, Kind.TopAbs_SOLID)
    while solids.More():
        count += 1
        solids.Next()
    return {
        "file": path,
        "valid": bool(BRepCheck_Analyzer(shape).IsValid()),
        "solids": count,
        "faces": faces,
        "parse_s": parsed,
        "read_s": seconds,
    }


# Two kernels' loops follow circles to a few millionths; OpenCASCADE against itself on the same geometry is the sharper test.
OURS = 1e-5
SAME = 1e-6


def largest(areas, others):
    pairs = zip(sorted(areas), sorted(others))
    return max((abs(a - b) / max(a, b, 1e-300) for a, b in pairs), default=0.0)


def beyond(faces, others, relative):
    """Faces whose areas differ by more than the relative figure and than their edges leave open."""
    pairs = zip(sorted((face["area"], face["slack"]) for face in faces), sorted(others))
    return sum(abs(a - b) > max(relative * max(a, b), slack) for (a, slack), b in pairs)


def compare(inspect, original, exports):
    with open(inspect, encoding="utf-8") as file:
        ours = [face["area_mm2"] for face in json.load(file)["faces"]]
    before = report(original)
    reference = [face["area"] for face in before["faces"]]
    good = True
    for path in exports:
        got = report(path)
        areas = [face["area"] for face in got["faces"]]
        kinds = sorted(face["kind"] for face in got["faces"])
        same_kinds = kinds == sorted(face["kind"] for face in before["faces"])
        counts = len(areas) == len(reference) == len(ours)
        to_occt = largest(areas, reference) if counts else float("nan")
        to_ours = largest(areas, ours) if counts else float("nan")
        word = "DIFFERS"
        if counts and got["valid"]:
            if to_ours <= OURS:
                word = "equal" if to_occt <= SAME else "equal to ours alone"
            elif beyond(got["faces"], ours, OURS) == 0:
                word = "within the tolerances of its edges"
        good = good and word != "DIFFERS"
        name = path.replace("\\", "/").rsplit("/", 1)[-1]
        print(
            f"{name:36} {len(reference):6} {len(areas):6} {'same' if same_kinds else 'other':>6} "
            f"{got['solids']:6} {'yes' if got['valid'] else 'NO':>6} {to_occt:10.1e} {to_ours:10.1e}  "
            f"{word}"
        )
    return good


def main(arguments):
    if arguments[:1] == ["--compare"]:
        sys.exit(0 if compare(arguments[1], arguments[2], arguments[3:]) else 1)
    if arguments[:1] == ["--time"]:
        times, path = int(arguments[1]), arguments[2]
        before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        best = min(read(path)[1:] for _ in range(times))
        grown = 1024 * (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) / os.path.getsize(path)
        print(json.dumps({"file": path, "parse_s": best[0], "read_s": best[1], "peak_of_file": grown}))
        return
    for path in arguments:
        try:
            print(json.dumps(report(path)))
        except Exception as why:  # one bad file must not hide the others
            print(json.dumps({"file": path, "error": str(why)}))


main(sys.argv[1:])
