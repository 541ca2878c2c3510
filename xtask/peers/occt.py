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
from OCP.BRepAdaptor import BRepAdaptor_Curve2d, BRepAdaptor_Surface
from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.BRepGProp import BRepGProp
from OCP.BRepTools import BRepTools_WireExplorer
from OCP.GeomAbs import GeomAbs_SurfaceType
from OCP.gp import gp_Pnt, gp_Vec
from OCP.GProp import GProp_GProps
from OCP.IFSelect import IFSelect_RetDone
from OCP.IGESControl import IGESControl_Reader
from OCP.STEPControl import STEPControl_Reader
from OCP.TopAbs import TopAbs_Orientation as Orientation
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


GAUSS = (
    (-0.9602898564975363, 0.1012285362903763),
    (-0.7966664774136267, 0.2223810344533745),
    (-0.5255324099163290, 0.3137066458778873),
    (-0.1834346424956498, 0.3626837833783620),
    (0.1834346424956498, 0.3626837833783620),
    (0.5255324099163290, 0.3137066458778873),
    (0.7966664774136267, 0.2223810344533745),
    (0.9602898564975363, 0.1012285362903763),
)


def knots_of(surface, along_u):
    """Parameters between which a surface is smooth, a period to both sides where it closes."""
    if surface.GetType() == GeomAbs_SurfaceType.GeomAbs_BSplineSurface:
        spline = surface.BSpline()
        count = spline.NbUKnots() if along_u else spline.NbVKnots()
        knots = [spline.UKnot(k) if along_u else spline.VKnot(k) for k in range(1, count + 1)]
        if spline.IsUPeriodic() if along_u else spline.IsVPeriodic():
            period = knots[-1] - knots[0]
            knots = sorted({k + n * period for k in knots for n in (-2, -1, 0, 1, 2)})
        return knots
    low = surface.FirstUParameter() if along_u else surface.FirstVParameter()
    high = surface.LastUParameter() if along_u else surface.LastVParameter()
    return [low + (high - low) * k / 8 for k in range(9)]


def panels_of(face):
    """The area inside the parameter curves: Gauss panels between knots, along the boundary by Green's theorem, with gaps
    between curves closed by straight lines of parameters. OpenCASCADE's own rule misses knots beyond the period of a
    spline, and leaves gaps open."""
    surface = BRepAdaptor_Surface(face)
    us, vs = knots_of(surface, True), knots_of(surface, False)
    base = surface.FirstUParameter()
    point, du, dv = gp_Pnt(), gp_Vec(), gp_Vec()

    def parts(a, b, knots, least):
        inner = [k for k in knots if min(a, b) < k < max(a, b)]
        ends = [a, *(inner if a <= b else reversed(inner)), b]
        for low, high in zip(ends, ends[1:]):
            for k in range(least):
                yield low + (high - low) * k / least, low + (high - low) * (k + 1) / least

    def inner(u, v):
        total = 0.0
        for low, high in parts(base, u, us, 1):
            for x, w in GAUSS:
                surface.D1(0.5 * (low + high) + 0.5 * (high - low) * x, v, point, du, dv)
                total += 0.5 * w * (high - low) * du.Crossed(dv).Magnitude()
        return total

    def along(at, start, end):
        """The integral of `inner dv` between two parameters of a curve, cut where it crosses knots."""
        cuts = [start + (end - start) * k / 32 for k in range(33)]
        found = list(cuts)
        for low, high in zip(cuts, cuts[1:]):
            for pick, knots in ((0, us), (1, vs)):
                a, b = at(low)[pick], at(high)[pick]
                for knot in knots:
                    if min(a, b) < knot < max(a, b):
                        left, right = low, high
                        for _ in range(50):
                            middle = 0.5 * (left + right)
                            if (at(middle)[pick] - knot) * (a - knot) > 0:
                                left = middle
                            else:
                                right = middle
                        found.append(0.5 * (left + right))
        found.sort(reverse=end < start)
        total = 0.0
        for low, high in zip(found, found[1:]):
            if at(low)[1] == at(high)[1] == at(0.5 * (low + high))[1]:
                continue
            for x, w in GAUSS:
                t, h = 0.5 * (low + high) + 0.5 * (high - low) * x, 1e-5 * (high - low)
                slope = (at(t + h)[1] - at(t - h)[1]) / (2 * h)
                total += 0.5 * w * (high - low) * slope * inner(*at(t))
        return total

    total = 0.0
    loops = TopExp_Explorer(face, Kind.TopAbs_WIRE)
    while loops.More():
        walk = BRepTools_WireExplorer(wire_of(loops.Current()), face)
        ends = []
        while walk.More():
            edge = walk.Current()
            curve = BRepAdaptor_Curve2d(edge, face)
            place = lambda t, curve=curve: (lambda p: (p.X(), p.Y()))(curve.Value(t))
            span = [curve.FirstParameter(), curve.LastParameter()]
            if edge.Orientation() == Orientation.TopAbs_REVERSED:
                span.reverse()
            total += along(place, *span)
            ends.append((place(span[0]), place(span[1])))
            walk.Next()
        for (_, last), (first, _) in zip(ends, ends[1:] + ends[:1]):
            total += along(lambda t, a=last, b=first: tuple(p + t * (q - p) for p, q in zip(a, b)), 0.0, 1.0)
        loops.Next()
    return abs(total)


def wire_of(shape):
    cast = getattr(TopoDS, "Wire_s", None) or getattr(TopoDS, "Wire")
    return cast(shape)


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
        faces.append({"kind": kind, "area": area_of(face), "slack": slack_of(face), "shape": face})
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
# Faces integrated by panels, at most: each takes about a second.
PANELS = 60


def largest(areas, others):
    pairs = zip(sorted(areas), sorted(others))
    return max((abs(a - b) / max(a, b, 1e-300) for a, b in pairs), default=0.0)


def settle(faces, others):
    """Takes the panels' area for faces whose area by OpenCASCADE's rule has no partner among the others; how many."""
    left = sorted(others)
    alone = []
    for face in sorted(faces, key=lambda face: face["area"]):
        near = min(left, key=lambda area: abs(area - face["area"]), default=None)
        if near is not None and abs(near - face["area"]) <= OURS * near:
            left.remove(near)
        else:
            alone.append(face)
    for face in alone[:PANELS]:
        face["area"] = panels_of(face["shape"])
    return min(len(alone), PANELS)


def beyond(faces, others, relative):
    """Faces whose areas differ by more than the relative figure and than their edges leave open."""
    pairs = zip(sorted((face["area"], face["slack"]) for face in faces), sorted(others))
    return sum(abs(a - b) > max(relative * max(a, b), slack) for (a, slack), b in pairs)


def compare(inspect, original, exports):
    with open(inspect, encoding="utf-8") as file:
        ours = [face["area_mm2"] for face in json.load(file)["faces"]]
    before = report(original)
    settle(before["faces"], ours)
    reference = [face["area"] for face in before["faces"]]
    good = True
    for path in exports:
        got = report(path)
        panels = settle(got["faces"], ours)
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
            f"{word}{f', {panels} by panels' if panels else ''}"
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
            answer = report(path)
            for face in answer["faces"]:
                del face["shape"]
            print(json.dumps(answer))
        except Exception as why:  # one bad file must not hide the others
            print(json.dumps({"file": path, "error": str(why)}))


main(sys.argv[1:])
