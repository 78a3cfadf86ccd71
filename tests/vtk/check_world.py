"""Reads the views of a world that tests/vtk/world.c wrote with VTK itself, and compares them with what the
program says of the world call by call."""
import json
import math
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
told = json.loads(subprocess.run([sys.argv[1], folder], check=True, stdout=subprocess.PIPE).stdout)


def read(name):
    reader = vtk.vtkXMLPolyDataReader()
    reader.SetFileName(f"{folder}/{name}.vtp")
    reader.Update()
    assert reader.GetErrorCode() == 0, name
    data = reader.GetOutput()
    assert data.GetFieldData().GetArray("TimeValue").GetValue(0) == told["time"] > 0
    return data


def table(attributes):
    arrays = [attributes.GetArray(i) for i in range(attributes.GetNumberOfArrays())]
    return {a.GetName(): [a.GetTuple(k) for k in range(a.GetNumberOfTuples())] for a in arrays}


def norm(v):
    return math.sqrt(sum(x * x for x in v))


def near(a, b, tolerance=1e-12):
    return norm([x - y for x, y in zip(a, b)]) <= tolerance * (1 + norm(b))


# ---- one point a body
bodies = told["bodies"]
assert [b["body"] for b in bodies] == [0, 2, 3, 4]
points = read("points")
of = table(points.GetPointData())
assert points.GetNumberOfVerts() == points.GetNumberOfPoints() == 4
for k, body in enumerate(bodies):
    assert points.GetPoint(k) == tuple(body["position"])
    for name in "orientation", "velocity", "angular_velocity":
        assert of[name][k] == tuple(body[name]), name
    assert of["mass"][k][0] == body["mass"] and of["body"][k][0] == body["body"]
assert [s[0] for s in of["shape"]] == [0, 0, 2, 1]  # the sphere came second, with the body taken out
assert abs(of["size"][3][0] - 0.06) < 1e-15 and of["material"][0][0] == 0

# ---- their triangles
surfaces = read("surfaces")
cells = table(surfaces.GetCellData())
assert surfaces.GetNumberOfPolys() == 2 * 12 + 3 * 320 == len(cells["body"])
threshold = vtk.vtkThreshold()
threshold.SetInputData(surfaces)
threshold.SetInputArrayToProcess(0, 0, 0, vtk.vtkDataObject.FIELD_ASSOCIATION_CELLS, "body")


def part(body):
    threshold.SetLowerThreshold(body)
    threshold.SetUpperThreshold(body)
    surface = vtk.vtkGeometryFilter()
    surface.SetInputConnection(threshold.GetOutputPort())
    surface.Update()
    mass, centre = vtk.vtkMassProperties(), vtk.vtkCenterOfMass()
    mass.SetInputData(surface.GetOutput())
    centre.SetInputData(surface.GetOutput())
    centre.Update()
    return mass.GetVolume(), centre.GetCenter()


sphere = 4 / 3 * math.pi * 0.03**3
for body, volume, slack in (0, 0.06912**3, 1e-9), (2, 0.06912**3, 1e-9), (4, sphere, 0.04):
    got, centre = part(body)
    assert abs(got / volume - 1) < slack, (body, got, volume)
    assert near(centre, bodies[[b["body"] for b in bodies].index(body)]["position"], 1e-6)
    assert cells["shape"][[c[0] for c in cells["body"]].index(body)][0] == (1 if body == 4 else 0)
w, x, y, z = bodies[1]["orientation"]
half = 0.06912 / 2
turn = [[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]]
for sign in range(8):
    corner = [half if sign >> i & 1 else -half for i in range(3)]
    corner = [sum(turn[i][j] * corner[j] for j in range(3)) + bodies[1]["position"][i] for i in range(3)]
    assert near(surfaces.GetPoint(surfaces.FindPoint(corner)), corner, 1e-9)
speed = cells["speed"][0][0]
assert abs(speed - norm(bodies[0]["velocity"])) < 1e-6 * speed

# ---- contacts: features summed here, apart
pairs = {}
for c in told["contacts"]:
    pairs.setdefault((c["body"], c["other"], c["wall"]), []).append(c)
assert {(0, 0, 1), (0, 2, 0), (3, 0, 1), (4, 0, 1)} == set(pairs), pairs.keys()
lines = read("contacts")
of = table(lines.GetCellData())
assert lines.GetNumberOfLines() == len(pairs) >= 4
position = {b["body"]: b["position"] for b in bodies}
for k in range(lines.GetNumberOfLines()):
    key = tuple(int(of[n][k][0]) for n in ("body", "other", "wall"))
    features = pairs[key]
    force = [sum(f["force"][i] for f in features) for i in range(3)]
    weight = sum(norm(f["force"]) for f in features)
    place = [sum(norm(f["force"]) * f["position"][i] for f in features) / weight for i in range(3)]
    along = [sum(f["normal"][i] * sum(x * y for x, y in zip(f["force"], f["normal"])) for f in features)
             for i in range(3)]
    assert weight > 0 and near(of["force"][k], force) and near(of["normal_force"][k], along)
    assert near([a + b for a, b in zip(of["normal_force"][k], of["tangential_force"][k])], force)
    assert of["feature_count"][k][0] == len(features)
    assert of["overlap"][k][0] == max(f["overlap"] for f in features) > 0
    assert near(of["place"][k], place)
    ends = [lines.GetPoint(lines.GetCell(k).GetPointId(i)) for i in range(2)]
    assert ends[0] == tuple(position[key[0]])
    assert near(ends[1], place) if key[2] else ends[1] == tuple(position[key[1]])

# ---- walls
walls = read("walls")
of = table(walls.GetCellData())
kinds = {}
area = {}
for k in range(walls.GetNumberOfPolys()):
    wall = of["wall"][k][0]
    kinds[wall] = of["kind"][k][0]
    area[wall] = area.get(wall, 0) + walls.GetCell(k).ComputeArea()
assert kinds == {0: 0, 1: 1, 2: 2, 3: 2, 4: 3}
assert abs(area[1] / (math.pi * 0.25) - 1) < 2e-3
assert abs(area[2] / (2 * math.pi * 0.4 * 0.75) - 1) < 1e-3
assert area[0] > 1 and area[3] > 1  # endless ones reach past everything
assert abs(area[4] / (6 * 0.06912**2) - 1) < 1e-9
corners = {walls.GetCell(k).GetPointId(i) for k in range(walls.GetNumberOfPolys()) if of["wall"][k][0] == 4
           for i in range(3)}
w, x, y, z = told["mesh_wall_orientation"]
edge = (2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y))  # its z axis
heights = [sum(a * b for a, b in zip(walls.GetPoint(c), edge)) for c in corners]
assert abs(max(heights) - min(heights) - 0.06912) < 1e-9

# ---- the series
series = json.load(open(f"{folder}/pile.vtp.series"))
assert series == {"file-series-version": "1.0", "files": [
    {"name": "surfaces.vtp", "time": 0}, {"name": "points.vtp", "time": told["time"]}]}

# ---- the verb on a checkpoint: the same files, and a folder with everything
program = sys.argv[2]


def export(*words):
    subprocess.run([program, "export", *words, "-q"], check=True, cwd=folder)


for view in "surfaces", "points", "contacts", "walls":
    export("world.scree", "--view", view, "-o", f"again-{view}.vtp")
    assert open(f"{folder}/again-{view}.vtp", "rb").read() == open(f"{folder}/{view}.vtp", "rb").read(), view
export("world.scree", "--to", "cm", "-o", "pile")
pile = json.load(open(f"{folder}/pile/pile.json"))
assert pile["time"] == told["time"] and pile["gravity"] == [0, 0, -9.81] and pile["unit_m"] == 0.01
for body, one in zip(bodies, pile["bodies"], strict=True):
    assert body.items() <= one.items()
assert [b["shape"] for b in pile["bodies"]] == [0, 0, 2, 1]
assert [(s["shape"], s["kind"], s["mesh_file"], len(s["spheres"])) for s in pile["shapes"]] == [
    (0, "mesh", "shape-0.stl", 0), (1, "sphere", None, 1), (2, "clump", None, 2)]
side = 0.06912
assert near(pile["shapes"][0]["inertia_per_density"], [side**5 / 6] * 3, 1e-15)
assert abs(pile["shapes"][0]["volume"] - side**3) < 1e-15 and pile["shapes"][1]["spheres"] == [
    {"centre": [0, 0, 0], "radius": 0.03}]
assert [(w["kind"], w["mesh_file"]) for w in pile["walls"]] == [
    ("plane", None), ("disc", None), ("cylinder", None), ("cylinder", None), ("mesh", "wall-4.stl")]
assert pile["walls"][4]["orientation"] == told["mesh_wall_orientation"]
rows = [line.split(",") for line in open(f"{folder}/pile/bodies.csv").read().splitlines()]
assert rows[0][:8] == ["body", "shape", "material", "mass", "x", "y", "z", "qw"] and len(rows) == 5
for row, body in zip(rows[1:], bodies):
    assert [float(v) for v in row[3:]] == [body["mass"], *body["position"], *body["orientation"],
                                           *body["velocity"], *body["angular_velocity"]]
reader = vtk.vtkSTLReader()
reader.SetFileName(f"{folder}/pile/shape-0.stl")
reader.Update()
assert near(reader.GetOutput().GetBounds(), [b * s for s in [side / 0.01] for b in [-0.5, 0.5] * 3], 1e-6)
export("scene.scree", "-o", "scene.vtp", "--view", "points")
export("frame.scree", "world.scree", "-o", "all.pvd", "--view", "points")
assert open(f"{folder}/all-0000.vtp", "rb").read() == open(f"{folder}/scene.vtp", "rb").read()
assert open(f"{folder}/all-0001.vtp", "rb").read() == open(f"{folder}/points.vtp", "rb").read()
sets = tree.parse(f"{folder}/all.pvd").getroot().findall("Collection/DataSet")
assert [s.get("file") for s in sets] == ["all-0000.vtp", "all-0001.vtp"]
assert float(sets[1].get("timestep")) == told["time"] != float(sets[0].get("timestep"))
export("world.scree", "-o", "one.vtp.series", "--view", "walls")
assert json.load(open(f"{folder}/one.vtp.series"))["files"] == [{"name": "one-0000.vtp", "time": told["time"]}]
refused = subprocess.run([program, "export", "frame.scree", "--view", "contacts", "-o", "no.vtp"], cwd=folder,
                         stderr=subprocess.PIPE, text=True)
assert refused.returncode == 1 and "holds no contacts" in refused.stderr

# ---- a mesh with its areas and its distances from another
export("sample:box-12", "--reference", "sample:icosphere-3", "-o", "box.vtp")
reader = vtk.vtkXMLPolyDataReader()
reader.SetFileName(f"{folder}/box.vtp")
reader.Update()
box = reader.GetOutput()
export("sample:icosphere-3", "-o", "ball.vtp")
reader = vtk.vtkXMLPolyDataReader()
reader.SetFileName(f"{folder}/ball.vtp")
reader.Update()
distance = vtk.vtkImplicitPolyDataDistance()
distance.SetInput(reader.GetOutput())
assert reader.GetOutput().GetCellData().GetNumberOfArrays() == 1
on_cells, on_points = table(box.GetCellData()), table(box.GetPointData())
for k in range(box.GetNumberOfCells()):
    cell = box.GetCell(k)
    assert abs(on_cells["area"][k][0] - cell.ComputeArea()) < 1e-15
    corners = [box.GetPoint(cell.GetPointId(i)) for i in range(3)]
    centroid = [sum(c[i] for c in corners) / 3 for i in range(3)]
    assert abs(on_cells["distance"][k][0] - abs(distance.EvaluateFunction(centroid))) < 1e-9
for k in range(box.GetNumberOfPoints()):
    assert abs(on_points["distance"][k][0] - abs(distance.EvaluateFunction(box.GetPoint(k)))) < 1e-9
assert abs(sum(a[0] for a in on_points["area"]) - 6 * side**2) < 1e-15
print("VTK", vtk.vtkVersion.GetVTKVersion(), "reads bodies, contacts and walls of a world, and a mesh with fields")
