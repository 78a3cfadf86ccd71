"""Reads what tests/vtk/write.c wrote with VTK itself and compares."""
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as tree

try:
    import vtk
except ImportError:
    print("skipped: no vtk module for this Python (Debian: python3-vtk9)")
    sys.exit(77)

folder = tempfile.mkdtemp()
subprocess.run([sys.argv[1], folder], check=True)


def read(name):
    reader = vtk.vtkXMLPolyDataReader()
    reader.SetFileName(f"{folder}/{name}")
    reader.Update()
    assert reader.GetErrorCode() == 0, name
    return reader.GetOutput()


mesh = read("mesh.vtp")
assert (mesh.GetNumberOfPoints(), mesh.GetNumberOfPolys()) == (4, 4)
assert mesh.GetPoint(3) == (0, 0, 1)
assert [mesh.GetCell(2).GetPointId(i) for i in range(3)] == [1, 2, 3]
assert mesh.GetPointData().GetArray("distance <&>").GetValue(3) == 3.5
assert mesh.GetPointData().GetArray("velocity").GetTuple(1) == (4, 5, 6)
assert mesh.GetCellData().GetArray("area").GetValue(2) == 0.8660254037844386
mass = vtk.vtkMassProperties()
mass.SetInputData(mesh)
assert abs(mass.GetVolume() - 1 / 6) < 1e-12
bodies = read("bodies.vtp")
assert (bodies.GetNumberOfVerts(), bodies.GetNumberOfPolys()) == (4, 0)
assert bodies.GetPointData().GetArray("shape").GetValue(2) == 9
assert bodies.GetFieldData().GetArray("TimeValue").GetValue(0) == 0.25
contacts = read("contacts.vtp")
assert contacts.GetNumberOfLines() == 2
assert contacts.GetCell(1).GetPointId(1) == 3
sets = tree.parse(f"{folder}/all.pvd").getroot().findall("Collection/DataSet")
assert [(s.get("file"), float(s.get("timestep"))) for s in sets] == [
    ("mesh.vtp", 0), ("bodies.vtp", 0.25), ("contacts.vtp", 0.5)]
print("VTK", vtk.vtkVersion.GetVTKVersion(), "reads the meshes, the bodies and the contacts")
