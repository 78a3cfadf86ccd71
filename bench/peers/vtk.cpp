/* VTK: vtkQuadricDecimation with its defaults. */
#include "harness.hpp"

#include <vtkCellArray.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkQuadricDecimation.h>

using bench::Mesh;
using bench::Run;

static void quadric(const Mesh &input, const std::vector<size_t> &counts, Run &run) {
  vtkNew<vtkPoints> points;
  vtkNew<vtkCellArray> cells;
  vtkNew<vtkPolyData> data;
  vtkNew<vtkQuadricDecimation> decimation;
  points->SetDataTypeToDouble();
  for (size_t v = 0; v < input.vertex_count(); v++)
    points->InsertNextPoint(&input.positions[3 * v]);
  for (size_t t = 0; t < input.triangle_count(); t++) {
    const vtkIdType corners[3] = {input.triangles[3 * t], input.triangles[3 * t + 1],
                                  input.triangles[3 * t + 2]};
    cells->InsertNextCell(3, corners);
  }
  data->SetPoints(points);
  data->SetPolys(cells);
  run.start();
  decimation->SetInputData(data);
  decimation->SetTargetReduction(1 - double(counts[0]) / double(input.triangle_count()));
  decimation->Update();
  run.stop();
  Mesh level;
  vtkPolyData *made = decimation->GetOutput();
  for (vtkIdType v = 0; v < made->GetNumberOfPoints(); v++)
    level.positions.insert(level.positions.end(), made->GetPoint(v), made->GetPoint(v) + 3);
  for (vtkIdType c = 0; c < made->GetNumberOfCells(); c++) {
    vtkIdType corner_count;
    const vtkIdType *corners;
    made->GetPolys()->GetCellAtId(c, corner_count, corners);
    for (vtkIdType k = 0; k < corner_count; k++) level.triangles.push_back((uint32_t)corners[k]);
  }
  run.level(level, counts[0]);
}

const bench::Peer peers[] = {{"vtk", false, quadric}, {nullptr, false, nullptr}};
