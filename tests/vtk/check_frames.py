"""Frames of `scree run` read by VTK itself: bodies.pvd is kept up, bodies are points with poses, a glyph of their shape
gives their triangles. usage: check_frames.py PROGRAM"""
import math
import os
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as tree

try:
    import vtk
except ImportError:
    print("skipped: no vtk module for this Python (Debian: python3-vtk9)")
    sys.exit(77)

SCENE = """
time: 0.1
shapes: {ball: {sphere: 0.02}, brick: {box: [0.01, 0.02, 0.03]}}
geometry: {floor: {plane: [0, 0, 1]}, table: {box: [0.3, 0.3, 0.01], at: [0.1, 0.1, 0.005]}}
inlets: {i: {box: {min: [0, 0, 0.02], max: [0.2, 0.2, 0.2]}, shapes: {ball: 1, brick: 1}, count: 20}}
output: {frames: 0.05}
sensors: {load: {wall: table, from: 0.05}, field: {grid: {cylinder: {at: [0.1, 0.1, 0], radius: 0.15, length: 0.2}, cells: [3, 8, 4]}}}
"""
folder = tempfile.mkdtemp()
with open(f"{folder}/scene.yaml", "w", encoding="utf-8") as file:
    file.write(SCENE)
subprocess.run([sys.argv[1], "run", f"{folder}/scene.yaml", "-o", f"{folder}/out", "--no-picture", "-q"], check=True,
               stdout=subprocess.DEVNULL)


def read(name):
    reader = vtk.vtkXMLPolyDataReader()
    reader.SetFileName(f"{folder}/out/{name}")
    reader.Update()
    assert reader.GetErrorCode() == 0, name
    return reader.GetOutput()


sets = tree.parse(f"{folder}/out/bodies.pvd").getroot().findall("Collection/DataSet")
times = [round(float(s.get("timestep")), 2) for s in sets]
assert times == [0.0, 0.05, 0.1, 0.1], times  # the last is of the end
last = read(sets[-1].get("file"))
data = last.GetPointData()
names = {data.GetArrayName(i): data.GetArray(i).GetNumberOfComponents() for i in range(data.GetNumberOfArrays())}
assert names == {"orientation": 4, "velocity [m/s]": 3, "angular velocity [rad/s]": 3, "contact force [N]": 3,
                 "stress [Pa]": 6, "size [m]": 1, "body": 1, "shape": 1, "fragment": 1}, names
assert last.GetNumberOfPoints() == 20 and data.GetArray("shape").GetRange() == (0.0, 1.0)
assert os.path.getsize(f"{folder}/out/{sets[-1].get('file')}") < 20 * 104 + 3000

brick = read("shape-1.vtp")
low, high = brick.GetPoints().GetBounds()[0::2], brick.GetPoints().GetBounds()[1::2]
assert sorted(round(b - a, 6) for a, b in zip(low, high)) == [0.01, 0.02, 0.03], brick.GetPoints().GetBounds()

# the lowest corner of every brick, turned by its quaternion, is not below the floor
for k in range(20):
    if data.GetArray("shape").GetValue(k) != 1:
        continue
    w, x, y, z = data.GetArray("orientation").GetTuple(k)
    third = (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y))
    reach = min(sum(a * b for a, b in zip(third, brick.GetPoint(i))) for i in range(brick.GetNumberOfPoints()))
    assert last.GetPoint(k)[2] + reach > -1e-4, k
# a grid: the mass of all bodies is in its cells, or near them
reader = vtk.vtkXMLStructuredGridReader()
reader.SetFileName(f"{folder}/out/sensor-field-grid.vts")
reader.Update()
grid = reader.GetOutput()
assert reader.GetErrorCode() == 0 and grid.GetNumberOfCells() == 3 * 8 * 4
cells = grid.GetCellData()
assert [cells.GetArray(n).GetNumberOfComponents() for n in ("velocity [m/s]", "stress [Pa]", "share of ball")] == [3, 6, 1]
assert 0 < max(cells.GetArray("solid fraction").GetRange()) < 0.7
# maps of a wall: of the table, by triangle, and not of the floor
walls = read("walls.vtp").GetCellData()
kinds = walls.GetArray("kind")
for name in ("pressure [Pa]", "shear [Pa]", "wear [J/m2]", "worn depth [m]"):
    values = [walls.GetArray(name).GetValue(i) for i in range(walls.GetNumberOfTuples())]
    assert [math.isnan(v) for v in values] == [kinds.GetValue(i) != 3 for i in range(len(values))], (name, values)
    assert name == "worn depth [m]" or max(v for v in values if not math.isnan(v)) > 0, name
print("20 bodies in 4 frames")
