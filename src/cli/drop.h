/* What the files of the verb `drop` share. */
#ifndef SCREE_CLI_DROP_H
#define SCREE_CLI_DROP_H

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

/* Where a drop is; times in s of the simulation. */
typedef struct drop_schedule {
  double next_frame, next_line, still_since; /* still_since: NaN while moving */
  bool still;                                /* and so at its end */
  double end;
  double last_report, last_checkpoint; /* s on the clock */
} drop_schedule;

typedef struct drop_run {
  const cli_call *call;
  const drop_arguments *given, *arguments; /* as called; and with what is as usual filled in */
  drop_arguments settled;                  /* what `arguments` points to */
  double line_interval;                    /* s between lines of series.csv */
  double still_time;                       /* s below the still energy before it counts */
  drop_shape *shapes;
  size_t shape_count;
  scree_pour *pour;
  struct {
    char **files; /* names relative to the folder */
    double *times;
    size_t count, capacity;
  } frames;
  FILE *series; /* series.csv; NULL before it is open */
  drop_schedule schedule;
  scree_work_start start;
} drop_run;

/* drop_shapes.c: reads the words; 0, or the exit code after saying why. */
int drop_read_words(drop_run *run);
/* Loads, repairs, decimates: every shape gets its particle. */
scree_status drop_make_particles(drop_run *run, scree_error *error);

/* verb_drop.c: fills in what hangs on the particles' size: those of the pour, or of the shapes. */
void drop_settle(drop_run *run);

/* drop_output.c: makes the folder; an earlier drop in it is refused where nothing may be
 * overwritten. */
scree_status drop_check_output(const drop_run *run, scree_error *error);
/* The table, in a folder without what an earlier drop left there. */
scree_status drop_open_output(drop_run *run, scree_error *error);
/* A pour that fails shall leave the state before it. */
scree_status drop_keep_state(drop_run *run, scree_error *error);
/* One frame of the state as it is, and a line of series.csv. */
scree_status drop_write_frame(drop_run *run, scree_error *error);
scree_status drop_write_line(drop_run *run, scree_error *error);
/* The collection of frames; closes series.csv. */
scree_status drop_close_output(drop_run *run, scree_error *error);
/* drop.png; nothing where the build has no ray tracer. */
scree_status drop_write_picture(drop_run *run, scree_error *error);
void drop_free_output(drop_run *run);

/* What is there and what is lost, less the walls' work, J: what came in, but for the ledger's
 * error. */
double drop_energy(const scree_observation *observation);
/* One more frame in the collection, at the time given. */
scree_status drop_note_frame(drop_run *run, double time, scree_error *error);
/* DIR/name. */
scree_status drop_path(const drop_run *run, const char *name, char path[DROP_PATH_BYTES],
                       scree_error *error);

/* drop_resume.c: writes checkpoint.scree. */
scree_status drop_save(drop_run *run, scree_error *error);
/* With --resume and a checkpoint: the pour, the schedule and the files as they were. run->pour
 * stays NULL where there is none. */
scree_status drop_resume(drop_run *run, scree_error *error);

/* drop_report.c: from now on motion.scree tells where every body is, over a schedule of so many
 * seconds. */
scree_status drop_record(drop_run *run, double schedule, scree_error *error);
/* What is left behind and made of it: last.world, drop.json, drop.txt (the text), provenance.json,
 * report.html. stopped_because: NULL for a pour that came to its end. */
scree_status drop_write_report(drop_run *run, const char *stopped_because, const char *text,
                               scree_error *error);

/* verb_drop.c */
scree_pour_options drop_pour_options(const drop_arguments *arguments);
const drop_arguments *drop_defaults(void);

/* Fill *error; return its status. */
scree_status drop_no_memory(scree_error *error);
scree_status drop_no_series(scree_error *error);

#endif
