/* What the files of the verb `drop` share. */
#ifndef SCREE_CLI_DROP_H
#define SCREE_CLI_DROP_H

#include "cli/frames.h"
#include "cli/input.h"
#include "report/provenance.h"

enum { DROP_PATH_BYTES = 4096 };

typedef struct drop_arguments {
  const char *output, *picture;
  cli_source source;
  double rp;
  size_t triangles, clump, seed, particles, rays;
  double width, depth, drop_height, speed;
  double time, still, frame_interval, checkpoint_interval;
  double young, young_wall, density, restitution, friction, friction_wall;
  double steps_per_contact, stiffness_factor;
  int container, law;
  bool no_repair, no_picture, overwrite, resume;
} drop_arguments;

/* One word of the command line. */
typedef struct drop_shape {
  const char *word;
  char name[DROP_PATH_BYTES];  /* the word without its count */
  char title[64], source[512]; /* for the report: short name; file, checksum, triangles */
  size_t count;                /* particles */
  size_t source_triangles;     /* before decimation; 0 for spheres */
  double diameter;             /* m; 0 where it is no sphere */
  scree_particle *particle;
} drop_shape;

typedef struct drop_run {
  const cli_call *call;
  const drop_arguments *arguments; /* with what is as usual filled in */
  drop_arguments settled;          /* what `arguments` points to */
  scree_pour_schedule schedule;
  drop_shape *shapes;
  size_t shape_count;
  scree_pour *pour;
  double shown; /* s on the clock: when the progress was */
  cli_frames frames;
  scree_work_start start;
} drop_run;

/* drop_shapes.c: reads the words; 0, or the exit code after saying why. */
int drop_read_words(drop_run *run);
/* Loads, repairs, decimates: every shape gets its particle. */
scree_status drop_make_particles(drop_run *run, scree_error *error);

/* drop_output.c: makes the folder; an earlier drop in it is refused where nothing may be
 * overwritten. */
scree_status drop_check_output(const drop_run *run, scree_error *error);
/* Takes away what an earlier drop left there. */
scree_status drop_clear_output(const drop_run *run, scree_error *error);
/* One frame of the pour as it is. */
scree_status drop_write_frame(drop_run *run, const scree_pour *pour, scree_error *error);
/* The collection of frames. */
scree_status drop_list_frames(const drop_run *run, scree_error *error);
/* drop.png; nothing where the build has no ray tracer. */
scree_status drop_write_picture(drop_run *run, scree_error *error);

/* What is there and what is lost, less the walls' work, J: what came in, but for the ledger's
 * error. */
double drop_energy(const scree_observation *observation);
/* DIR/name. */
scree_status drop_path(const drop_run *run, const char *name, char path[DROP_PATH_BYTES],
                       scree_error *error);

/* drop_report.c: what is left behind and made of it: last.world, drop.json, drop.txt (the text),
 * provenance.json, report.html. stopped_because: NULL for a pour that came to its end. */
scree_status drop_write_report(drop_run *run, const char *stopped_because, const char *text,
                               scree_error *error);

/* Fills *error; returns its status. */
scree_status drop_no_memory(scree_error *error);

#endif
