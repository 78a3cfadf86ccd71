/* A scan is read, checked and decimated, by the library of meshes alone. */
#include <scree.h>

#include <stdio.h>

int main(int count, char **words) {
  scree_scan scan = {0};
  scree_check check;
  scree_mesh level = {0};
  scree_error error = {0};
  if (count != 2 || scree_scan_read(words[1], NULL, &scan, &error) ||
      scree_mesh_check(&scan.mesh, NULL, NULL, &check, &error) ||
      scree_choose_mesh(&scan.mesh, 1, NULL, &level, NULL, &error)) {
    fprintf(stderr, "%s\n", error.message);
    return 1;
  }
  printf("%s\n", level.triangle_count > 3 && level.triangle_count <= scan.mesh.triangle_count
                     ? scree_version()
                     : "no level");
  scree_mesh_free(&level);
  scree_scan_free(&scan);
  return 0;
}
