/* bench_convert FILE OUT.ply: any scan as binary PLY in double precision, welded, in its own unit.
 */
#include <scree.h>

int main(int argc, char **argv) {
  scree_read_options read = scree_default_read_options();
  scree_write_options write = scree_default_write_options();
  scree_scan scan;
  scree_error error;
  if (argc != 3) {
    fprintf(stderr, "usage: %s FILE OUT.ply\n", argv[0]);
    return 2;
  }
  read.unit_m = 1;
  write.unit_m = 1;
  write.overwrite = true;
  scree_status status = scree_scan_read(argv[1], &read, &scan, &error);
  if (status == SCREE_OK) {
    status = scree_mesh_write(&scan.mesh, argv[2], &write, &error);
    scree_scan_free(&scan);
  }
  if (status == SCREE_OK) return 0;
  fprintf(stderr, "%s\n", error.message);
  return 1;
}
