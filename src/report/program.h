/* What the program writes and draws, of what the public interface gives. */
#pragma once

#include "base/field.h"
#include "scree.h"

/* Writes a file of a result: of a scree_choice_report, scree_clump_report, scree_study_result or
 * scree_calibration_result, as the function's name says. "-" is stdout. */
typedef scree_status scree_writer(const void *result, const char *path, bool overwrite,
                                  scree_error *error);

/* A file that a result leaves in its folder. */
typedef struct scree_product {
  const char *name;
  scree_writer *write;
} scree_product;
/* Not where it is a picture and this build has none. */
bool scree_product_is_made(const scree_product *product);
/* Writes them in their order, but those that are not made or of which there is nothing to draw. */
scree_status scree_products_write(const scree_product *products, size_t count, const void *result,
                                  const char *folder, bool overwrite, scree_error *error);

/* What became of one file, for scree_check_json_write. */
typedef struct scree_check_entry {
  const char *file;       /* as given */
  const scree_scan *scan; /* NULL where it could not be read: then only `failure` is told */
  double unit_m;          /* metres per unit of the file */
  const scree_check *check;
  const scree_repair_report *repair; /* NULL where none was tried */
  const char *output;                /* the file written; NULL: none */
  const char *failure;               /* why there is no result; NULL: there is one */
} scree_check_entry;

/* One array with an object per entry: file, checksum, counts of every defect, verdict, what was
 * done. docs/reference/formats.md has every field. command_line may be NULL; path "-" is stdout. */
scree_status scree_check_json_write(const scree_check_entry *entries, size_t entry_count,
                                    const char *command_line, const char *path, bool overwrite,
                                    scree_error *error);

/* ---- Files for ParaView ---- */

/* The walls of a scene as they stand, with the maps of scree_scene_wall_map besides, NaN where no
 * wall sensor looks: `pressure [Pa]`, `shear [Pa]`, `wear [J/m2]`, `worn depth [m]`. As
 * scree_world_vtp_write. */
scree_status scree_scene_walls_vtp_write(const scree_scene *scene, const char *path, bool overwrite,
                                         scree_error *error);

/* The bodies of a scene as instances: a point a body at its centre of mass, in single precision,
 * 104 bytes. Per point: orientation (w x y z), velocity, angular velocity, contact force (N, the
 * sum of all), stress (Pa, its mean in the body by its contacts, pressure positive: xx, yy, zz, xy,
 * yz, xz), size (m), body, shape, fragment; names carry units. Errors as scree_world_vtp_write. */
scree_status scree_scene_bodies_vtp_write(const scree_scene *scene, const char *path,
                                          bool overwrite, scree_error *error);
/* The triangles of one of its shapes in the particle's frame, for glyphs; spheres as 320 each. */
scree_status scree_scene_shape_vtp_write(const scree_scene *scene, size_t shape, const char *path,
                                         bool overwrite, scree_error *error);

/* ---- The choice: figure, tables, JSON ---- */

/* One object of a choice, with all that is needed to run it again. Texts are borrowed. */
typedef struct scree_choice_entry {
  const char *name;        /* short, for tables and legends */
  const char *file;        /* as given: a path, or sample:NAME */
  const char *format;      /* as read, for example "binary STL"; "sample" for built-in ones */
  scree_checksum checksum; /* of the file's bytes; zero for samples */
  double unit_m;           /* metres per unit of the file */
  bool is_sample;          /* then resolution, noise and seed say how it was made */
  double sample_resolution, sample_noise; /* m */
  uint64_t sample_seed;
  const char *note;      /* what was repaired or is wrong, a sentence a line; NULL: nothing */
  const char *mesh_file; /* where the chosen mesh was written; NULL: nowhere */
  const scree_choice *choice;
} scree_choice_entry;

typedef struct scree_choice_report {
  const scree_choice_entry *entries;
  size_t entry_count;
  const scree_set_choice *set;
  const scree_choice_options *options;
  scree_method method;
  scree_choice_rule rule;   /* the one that is told first and that meshes are written by */
  const char *command_line; /* for provenance; NULL: unknown */
  const char *note;         /* what is to be said of all, a sentence a line; NULL: nothing */
} scree_choice_report;

/* The answer and the warnings in sentences, lengths in mm: the same in the text for people, in the
 * JSON and in the page. `entry` is an entry's index, or entry_count: the set as a whole. Answer how
 * many sentences there are, the first of them in texts. */
enum { SCREE_CHOICE_SENTENCES = 16 };
size_t scree_choice_answer(const scree_choice_report *report, size_t entry,
                           char texts[SCREE_CHOICE_SENTENCES][SCREE_CHOICE_SENTENCE_BYTES]);
size_t scree_choice_warnings(const scree_choice_report *report, size_t entry,
                             char texts[SCREE_CHOICE_SENTENCES][SCREE_CHOICE_SENTENCE_BYTES]);
/* What the recommended level costs more than the paper's; false: nothing worth a word. */
bool scree_choice_cost(const scree_choice *choice, char text[SCREE_CHOICE_SENTENCE_BYTES]);

/* The paper's Fig. 4, by the path's ending (.png, .svg, .pdf; .csv and .gnuplot for its data and a
 * script): eps_s and Ip against Rp, all objects, the choices marked. */
scree_writer scree_choice_figure_write;

/* One array: an object per entry, then the set's with "set": true. Lengths in metres, areas and
 * volumes in m2 and m3. docs/reference/formats.md has every field. "-" is stdout. */
scree_writer scree_choice_json_write;

/* One row per object and grid Rp, one for its robust and one for its recommended choice, and two
 * for a set of several objects (docs/reference/formats.md). "-" is stdout. */
scree_writer scree_choice_csv_write;

/* The dense curve of one object: one row per point of its trace that is another level. */
scree_status scree_choice_curve_csv_write(const scree_choice_entry *entry, const char *path,
                                          bool overwrite, scree_error *error);

/* One level of the table of a curve. */
typedef struct scree_curve_row {
  scree_level level;
  double eps_s, eps_v, ip; /* |S - Sm|/Sm, |V - Vm|/|Vm| (0 where Vm is), eps_s + Rp */
  scree_distance distance; /* forward: from the scan to the level; read where distances is true */
} scree_curve_row;

/* Its numbers beside the triangle count, in the order of the table: as text, CSV and JSON. */
typedef struct scree_curve_column {
  scree_field of;          /* of a row; its key in CSV */
  const char *json, *head; /* names in JSON and in text, with its unit */
  double scale;            /* from m into that unit */
  struct {
    int width, digits;
  } text[2]; /* without and with distances; width 0: it is not shown */
} scree_curve_column;
enum { SCREE_CURVE_COLUMNS = 12, SCREE_CURVE_DISTANCES = 7 }; /* from the second on, distances */
extern const scree_curve_column scree_curve_columns[SCREE_CURVE_COLUMNS];

/* A table of levels of one curve. Texts are borrowed. */
typedef struct scree_curve_entry {
  const char *file, *format; /* as given; as read */
  scree_checksum checksum;   /* of the file's bytes; zero for samples */
  double unit_m;             /* metres per unit of the file */
  scree_curve_facts facts;
  double area, volume; /* of the scan, m2 and m3 */
  const scree_curve_row *rows;
  size_t row_count;
  bool distances;
} scree_curve_entry;

/* One object, the rows in `levels` (docs/reference/formats.md); SI units. command_line NULL:
 * unknown. "-" is stdout. */
scree_status scree_curve_json_write(const scree_curve_entry *entry, const char *command_line,
                                    const char *path, bool overwrite, scree_error *error);

/* ---- Clumps: figure, tables, JSON ---- */

/* One body and its clumps. Texts are borrowed. */
typedef struct scree_clump_entry {
  const char *name;           /* short, for tables and legends */
  const char *file;           /* as given: a path, or sample:NAME */
  const char *format;         /* as read; "sample" for built-in ones */
  scree_checksum checksum;    /* of the file's bytes; zero for samples */
  double unit_m;              /* metres per unit of the file */
  const char *note;           /* what was repaired, in one sentence; NULL: nothing */
  size_t scan_triangle_count; /* before it was decimated to mesh */
  const scree_mesh *mesh;     /* that the spheres were fitted to */
  const scree_clumps *clumps;
  const scree_clump *chosen; /* one of them */
  const char *clump_file;    /* where that was written; NULL: nowhere */
} scree_clump_entry;

typedef struct scree_clump_report {
  const scree_clump_entry *entries;
  size_t entry_count;
  const char *command_line; /* for provenance; NULL: unknown */
} scree_clump_report;

/* The errors and the criterion against the number of spheres, by the path's ending (.png, .svg,
 * .pdf, .csv, .gnuplot). */
scree_writer scree_clump_figure_write;
/* An array with an object per body, all its clumps in it (docs/reference/formats.md). "-" is
 * stdout. */
scree_writer scree_clump_json_write;
/* A row per body and count. "-" is stdout. */
scree_writer scree_clump_csv_write;

/* ---- Measures and distances: tables, JSON ---- */

/* One measured scan. Texts are borrowed. */
typedef struct scree_measure_entry {
  const char *file, *format; /* as given; as read */
  scree_checksum checksum;
  double unit_m; /* metres per unit of the file */
  scree_measures measures;
  scree_topology topology;
  bool described; /* else there are no descriptors: the surface bounds no body */
  scree_descriptors descriptors;
} scree_measure_entry;

/* One array, an object per entry: every field of measures and topology by its name, in SI units
 * (docs/reference/formats.md). command_line is provenance; NULL: unknown. "-" is stdout. */
scree_status scree_measure_json_write(const scree_measure_entry *entries, size_t entry_count,
                                      const char *command_line, const char *path, bool overwrite,
                                      scree_error *error);
/* The same as rows; arrays as columns NAME_1, NAME_2 and so on. */
scree_status scree_measure_csv_write(const scree_measure_entry *entries, size_t entry_count,
                                     const char *path, bool overwrite, scree_error *error);
/* Zingg's plot (1935) of those that are described: elongation I / L against flatness S / I, by the
 * path's ending (.png, .svg, .pdf, .csv, .gnuplot). SCREE_BAD_ARGUMENT where none is. */
scree_status scree_zingg_figure_write(const scree_measure_entry *entries, size_t entry_count,
                                      const char *path, bool overwrite, scree_error *error);

/* The distance between two scans. */
typedef struct scree_distance_entry {
  const char *file[2];
  scree_checksum checksum[2];
  double unit_m[2];
  scree_distance_options options;
  scree_distance distance;
} scree_distance_entry;

/* One object with `forward` (from file 0 to file 1), `backward` and the Hausdorff distance, m. */
scree_status scree_distance_json_write(const scree_distance_entry *entry, const char *command_line,
                                       const char *path, bool overwrite, scree_error *error);

/* ---- The report: one page for a browser ---- */

/* Bytes for all objects of one page together, so that it stays below 6 MB. */
enum { SCREE_LEVELS_BYTES = 3750000 };

/* What the report shows of one object in 3D, in at most byte_limit bytes (but at least a level of
 * 2,000 triangles and what follows from it): the scan, or where that is too large the finest level
 * that fits; a fine level and the collapses that lead from it to the last; the dense curve;
 * measures of the scan and the choices. docs/reference/formats.md has the fields. Cost: O(N log N),
 * some 0.5 s for 762,008 triangles, half of it for the convex hull. */
scree_status scree_levels_write(const scree_curve *curve, const scree_choice *choice,
                                size_t byte_limit, const char *path, bool overwrite,
                                scree_error *error);

/* The page of one folder, which is called `name` in it: of one that gets its name when all is
 * written. */
scree_status scree_page_write_named(const char *folder, const char *name, const char *path,
                                    bool overwrite, scree_error *error);

/* ---- Heaps that were measured: JSON ---- */

/* A heap that `scree pile` measured of a scan, an outline or a picture. Texts are borrowed. */
typedef struct scree_heap_entry {
  const char *file, *kind, *command_line; /* kind: "scan", "outline" or "picture" */
  const scree_repose *repose;
  const scree_repose_options *options;
  const scree_ground *ground; /* of a scan; else NULL */
} scree_heap_entry;

/* One object: version, command, the ground, the heap as in `piles` of a scene
 * (docs/reference/formats.md). "-" is stdout. */
scree_status scree_heap_json_write(const scree_heap_entry *entry, const char *path, bool overwrite,
                                   scree_error *error);

/* ---- Scenes: JSON and pictures ---- */

/* The series, a row each. "-" is stdout. */
scree_status scree_scene_csv_write(const scree_scene *scene, const char *path, bool overwrite,
                                   scree_error *error);
/* The first pile's bodies without the geometry, seen as options say; a focus of radius 0 is put on
 * the pile, strays may lie outside. Errors as scree_render. */
scree_status scree_scene_pile_picture(const scree_scene *scene, const scree_render_options *options,
                                      const scree_progress *progress, scree_image *image,
                                      scree_error *error);

/* ---- Answers in words ---- */

/* What it says: whether it answers, its state in a few words, one sentence that does, what would
 * mislead, and what to do next at what cost ("": nothing). */
typedef struct scree_words {
  enum { SCREE_ANSWERED, SCREE_NOT_REACHED, SCREE_NOT_ENOUGH } verdict;
  const char *state;
  char answer[700], but[1000], next[500];
} scree_words;
/* "heap_angle" is a heap angle. Decimals of a number that is known to within the spread. */
void scree_words_name(const char *name, char *to, size_t size);
int scree_words_decimals(double spread);

/* How many more there are than came in: what came apart leaves pieces. */
static inline size_t scree_book_pieces(const scree_scene_book *book) {
  size_t there = book->inside_count + book->left_count;
  return there > book->entered_count ? there - book->entered_count : 0;
}
/* Says a scene, or its first heap where it has one. stopped: why it ended early, or NULL. */
void scree_scene_words(const scree_scene *scene, const scree_pile *pile, const char *stopped,
                       scree_words *words);
/* What a pile has beside its heap's angles and lengths. */
enum { SCREE_PILE_ROWS = 3 };
extern const scree_field scree_pile_rows[SCREE_PILE_ROWS];
/* What its methods read beside each other; "" without a heap. */
void scree_pile_finding(const scree_repose *repose, char *to, size_t size);

/* ---- Reports of a study ---- */

/* What a factor, or two of them besides (`other`), does to an answer from its first level to its
 * last; half: of the interval, infinite where no point has repeats. */
typedef struct scree_effect {
  const char *factor, *other, *from, *to; /* other: NULL of one factor */
  double size, half;
} scree_effect;
enum { SCREE_MOST_EFFECTS = 16 };
/* Finds the effects on a grid's answer, the strongest first, those of two factors behind. */
size_t scree_study_effects(const scree_study_result *result, size_t answer,
                           scree_effect effects[SCREE_MOST_EFFECTS]);
/* The scatter of one run, over all points, and half of a point's interval; NaN without repeats. */
void scree_study_scatter(const scree_study_result *result, size_t answer, double *sd, double *half);
/* Says one of a study's answers; the finding is what its effects show, in a title. */
void scree_study_words(const scree_study_result *result, size_t answer, scree_words *words);
void scree_study_finding(const scree_study_result *result, size_t answer, char *to, size_t size);

/* docs/reference/formats.md has every field. "-" is stdout. */
scree_writer scree_study_json_write;
/* One row per point. */
scree_writer scree_study_csv_write;
/* After the paper's Figs. 5, 7 and 8, by the path's ending as scree_choice_figure_write: angle with
 * standard deviation, and coefficient of variation, against Rp; mean rotation against time;
 * processor time of a run against Rp with both fits. SCREE_UNSUPPORTED where the study has nothing
 * to draw. */
scree_writer scree_study_angle_figure;
scree_writer scree_study_rotation_figure;
scree_writer scree_study_time_figure;
/* All of these into a folder: study.json, points.csv, and angle, rotation and time as .png, .svg,
 * .pdf, .csv and .gnuplot; what is there is overwritten. */
scree_status scree_study_report_write(const scree_study_result *result, const char *folder,
                                      scree_error *error);

/* ---- Reports ---- */

void scree_calibration_words(const scree_calibration_result *result, scree_words *words);
/* Titles: what is seen of an answer, of a parameter, of the course of the runs. */
void scree_calibration_answer_finding(const scree_calibration_result *result,
                                      const scree_answer_result *answer, char *to, size_t size);
void scree_calibration_parameter_finding(const scree_parameter_result *parameter, char *to,
                                         size_t size);
void scree_calibration_history_finding(const scree_calibration_result *result, char *to,
                                       size_t size);
/* What is usually missing where the model does not give what was measured; answers how many hints
 * there are. */
size_t scree_calibration_hints(const scree_calibration_result *result, size_t index, char *to,
                               size_t size);
/* For people: the answer, at most twelve lines; or all tables. */
void scree_calibration_print(const scree_calibration_result *result, bool all, FILE *stream);
/* docs/reference/formats.md has every field. "-" is stdout. */
scree_writer scree_calibration_json_write;
/* The samples, a row each. */
scree_writer scree_calibration_csv_write;
