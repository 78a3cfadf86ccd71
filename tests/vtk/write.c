/* Writes one file of each kind that scree_vtp_write makes, and a collection, into the folder named.
 */
#include "scree.h"

#include <math.h>

int main(int argc, char **argv) {
  if (argc != 2) return 2;
  char path[512];
  scree_error error;
  const double points[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  const uint32_t triangles[] = {0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2}, lines[] = {0, 1, 2, 3};
  const double distance[] = {0.5, 1.5, 2.5, 3.5}, area[] = {0.5, 0.5, 0.8660254037844386, 0.5};
  const float velocity[] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
  const int64_t shape[] = {7, 8, 9, 10};
  const scree_vtk_array at_points[] = {{"distance <&>", SCREE_VTK_FLOAT64, 1, distance},
                                       {"velocity", SCREE_VTK_FLOAT32, 3, velocity},
                                       {"shape", SCREE_VTK_INT64, 1, shape}};
  const scree_vtk_array at_cells[] = {{"area", SCREE_VTK_FLOAT64, 1, area}};
  scree_vtk_data mesh = {points, 4,        triangles, NULL, 4,    at_points,
                         3,      at_cells, 1,         NAN,  NULL, false};
  scree_vtk_data bodies = {points, 4, NULL, NULL, 0, at_points, 3, NULL, 0, 0.25, NULL, false};
  scree_vtk_data contacts = {points, 4, NULL, lines, 2, NULL, 0, at_cells, 1, 0.5, NULL, false};
  const scree_vtk_data *all[] = {&mesh, &bodies, &contacts};
  const char *names[] = {"mesh.vtp", "bodies.vtp", "contacts.vtp"};
  for (int i = 0; i < 3; i++) {
    snprintf(path, sizeof path, "%s/%s", argv[1], names[i]);
    if (scree_vtp_write(all[i], path, false, &error) != SCREE_OK) {
      fprintf(stderr, "%s\n", error.message);
      return 1;
    }
  }
  const double times[] = {0, 0.25, 0.5};
  snprintf(path, sizeof path, "%s/all.pvd", argv[1]);
  return scree_pvd_write(names, times, 3, path, false, &error) != SCREE_OK;
}
