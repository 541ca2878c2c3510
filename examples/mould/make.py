"""A mould half with a free-form floor, drafted walls and fillets as one solid in a STEP file.

Needs Python 3 and OpenCASCADE 8 (pip install "cadquery-ocp>=8" numpy). In this folder:

    python3 make.py mould.step

The top is at z = 0 and looks up; the floor is z = -9 + 1.2 sin(2 pi x / 44) cos(2 pi y / 38), laid through points by the kernel.
"""
import argparse
import math
from pathlib import Path

from OCP.BRepAdaptor import BRepAdaptor_Surface
from OCP.BRepAlgoAPI import BRepAlgoAPI_Common, BRepAlgoAPI_Cut
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace, BRepBuilderAPI_MakePolygon
from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.BRepFilletAPI import BRepFilletAPI_MakeFillet
from OCP.BRepGProp import BRepGProp
from OCP.BRepOffsetAPI import BRepOffsetAPI_ThruSections
from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox, BRepPrimAPI_MakePrism
from OCP.GeomAPI import GeomAPI_PointsToBSplineSurface
from OCP.GeomAbs import GeomAbs_C2
from OCP.GProp import GProp_GProps
from OCP.Interface import Interface_Static
from OCP.Message import Message
from OCP.STEPControl import STEPControl_AsIs, STEPControl_Writer
from OCP.TopAbs import TopAbs_EDGE, TopAbs_FACE
from OCP.TopExp import TopExp_Explorer
from OCP.TopoDS import TopoDS
from OCP.collections import Array2_gp_Pnt
from OCP.gp import gp_Pnt, gp_Vec

BLOCK = (64.0, 48.0, 20.0)  # mm
MOUTH = (52.0, 36.0)  # the pocket at the top
DRAFT_DEG = 8.0
DEEPEST = 13.0  # below any point of the floor
CORNER, ROOT = 6.0, 2.2  # radii of the corners of the walls at the top, and between walls and floor


def floor(x, y):
    return -9 + 1.2 * math.sin(2 * math.pi * x / 44) * math.cos(2 * math.pi * y / 38)


def floor_face():
    """The floor, beyond the walls on all sides."""
    nx, ny = 25, 19
    points = Array2_gp_Pnt(1, nx, 1, ny)
    for i in range(nx):
        for j in range(ny):
            x, y = -32 + 64 * i / (nx - 1), -24 + 48 * j / (ny - 1)
            points.SetValue(i + 1, j + 1, gp_Pnt(x, y, floor(x, y)))
    surface = GeomAPI_PointsToBSplineSurface(points, 3, 3, GeomAbs_C2, 1e-4).Surface()
    return BRepBuilderAPI_MakeFace(surface, 1e-6).Face()


def rectangle(length, width, z):
    made = BRepBuilderAPI_MakePolygon()
    for sx, sy in ((-1, -1), (1, -1), (1, 1), (-1, 1)):
        made.Add(gp_Pnt(sx * length / 2, sy * width / 2, z))
    made.Close()
    return made.Wire()


def edges(shape):
    found = TopExp_Explorer(shape, TopAbs_EDGE)
    out = []
    while found.More():
        edge = TopoDS.Edge(found.Current())
        if not any(edge.IsSame(e) for e in out):
            out.append(edge)
        found.Next()
    return out


def ends(edge):
    from OCP.BRepAdaptor import BRepAdaptor_Curve
    c = BRepAdaptor_Curve(edge)
    return [c.Value(c.FirstParameter() + t * (c.LastParameter() - c.FirstParameter())) for t in (0, 0.5, 1)]


def rounded(shape, radius, wanted):
    made = BRepFilletAPI_MakeFillet(shape)
    for edge in edges(shape):
        if wanted(*ends(edge)):
            made.Add(radius, edge)
    return made.Shape()


def pocket():
    """The room of the pocket: drafted walls with round corners above the floor."""
    shrink = 2 * DEEPEST * math.tan(math.radians(DRAFT_DEG))
    grow = 2 * 2 * math.tan(math.radians(DRAFT_DEG))
    walls = BRepOffsetAPI_ThruSections(True, True)
    walls.AddWire(rectangle(MOUTH[0] - shrink, MOUTH[1] - shrink, -DEEPEST))
    walls.AddWire(rectangle(MOUTH[0] + grow, MOUTH[1] + grow, 2))
    room = rounded(walls.Shape(), CORNER, lambda a, m, b: abs(a.Z() - b.Z()) > 1)
    above = BRepPrimAPI_MakePrism(floor_face(), gp_Vec(0, 0, 30)).Shape()
    room = BRepAlgoAPI_Common(room, above).Shape()
    return rounded(room, ROOT, lambda a, m, b: max(a.Z(), m.Z(), b.Z()) < -5)


def faces(shape):
    found = TopExp_Explorer(shape, TopAbs_FACE)
    while found.More():
        yield TopoDS.Face(found.Current())
        found.Next()


def main():
    ask = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    ask.add_argument("out", type=Path, help="STEP file to write")
    args = ask.parse_args()
    Message.DefaultMessenger_s().ChangePrinters().Clear()
    length, width, height = BLOCK
    block = BRepPrimAPI_MakeBox(gp_Pnt(-length / 2, -width / 2, -height), length, width, height).Shape()
    solid = BRepAlgoAPI_Cut(block, pocket()).Shape()
    writer = STEPControl_Writer()
    Interface_Static.SetCVal_s("write.step.schema", "AP214IS")
    Interface_Static.SetCVal_s("write.step.product.name", "mould")
    Interface_Static.SetIVal_s("write.surfacecurve.mode", 0)
    writer.Transfer(solid, STEPControl_AsIs)
    writer.Write(str(args.out))
    about = GProp_GProps()
    BRepGProp.VolumeProperties_s(solid, about)
    print(f"valid {BRepCheck_Analyzer(solid).IsValid()}, volume {about.Mass():.2f} mm3")
    for k, face in enumerate(faces(solid)):
        area = GProp_GProps()
        BRepGProp.SurfaceProperties_s(face, area)
        c = area.CentreOfMass()
        kind = str(BRepAdaptor_Surface(face).GetType()).split(".")[-1]
        print(f"  {k + 1:3} {kind:28} {area.Mass():9.3f} mm2 at ({c.X():.1f}, {c.Y():.1f}, {c.Z():.1f})")


if __name__ == "__main__":
    main()
