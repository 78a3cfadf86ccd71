/* Verbs that pour shapes into a template and run it: words as shapes, levels, settings, runs. */
#pragma once

#include "cli/scene_run.h"

enum { CLI_MOST_SETTINGS = 40, CLI_VIEW_UNSET = -1 };

typedef struct cli_pour_arguments {
  const char *config, *preset, *output, *rp;
  const char *settings[CLI_MOST_SETTINGS]; /* in the order of the verb's table; NULL: not given */
  cli_source source;
  cli_texts set;
  size_t each; /* particles of a word without =COUNT; 0: equal shares of the template's */
  size_t triangles, clump, rays;
  int method, view, container;
  bool samples, spheres, no_repair, resume, force, print, json, no_picture;
} cli_pour_arguments;

#define CLI_POUR_DEFAULTS  .source = CLI_SOURCE_DEFAULTS, .rays = 24, .view = CLI_VIEW_UNSET
#define CLI_POUR_AT(field) offsetof(cli_pour_arguments, field)
/* Tables of settings are X(id, option, parameter, kind, VALUE, help). CLI_SETTINGS makes of one
 * SETTING_id, their count, and rows of cli_setting; CLI_SETTING_OPTION rows of options. */
#define CLI_SETTING_ID(id, option, field, kind, value, help) SETTING_##id,
#define CLI_SETTING(id, option, field, kind, value, help)    {option, field, kind},
#define CLI_SETTING_OPTION(id, option, field, kind, value, help)                                   \
  {option, kind, CLI_POUR_AT(settings) + SETTING_##id * sizeof(const char *), value, help, 0,      \
   0,      NULL},
#define CLI_SETTINGS(TABLE)                                                                        \
  enum { TABLE(CLI_SETTING_ID) SETTING_COUNT };                                                    \
  _Static_assert((int)SETTING_COUNT <= (int)CLI_MOST_SETTINGS, "room for all settings");           \
  static const cli_setting settings[] = {TABLE(CLI_SETTING)};

/* Options of all such verbs: X(option, kind, member, VALUE, help, least, most, words). */
#define CLI_POUR_OPTION(option, kind, member, value, help, least, most, words)                     \
  {option, kind, CLI_POUR_AT(member), value, help, least, most, words},
#define CLI_POUR_OPTIONS(X)                                                                        \
  X("config", CLI_FILE, config, "FILE",                                                            \
    "A scene in YAML, as --print writes it, or values of its parameters; - is stdin.", 0, 0, NULL) \
  X("set", CLI_TEXTS, set, "FIELD=VALUE",                                                          \
    "Change any field of the scene, as gravity.0=1; may be given several times.", 0, 0, NULL)      \
  X("print", CLI_FLAG, print, NULL,                                                                \
    "Print the scene as it would be run, with units and comments, and stop.", 0, 0, NULL)          \
  X("samples", CLI_FLAG, samples, NULL, "The nine built-in devices as shapes.", 0, 0, NULL)        \
  X("rp", CLI_TEXT, rp, "LIST",                                                                    \
    "Decimate the scans first, as 1e-3, or 1e-5,recommended,1e-3 for a run at each; clump:20 is "  \
    "a run with clumps of 20 spheres that stand for the scans.",                                   \
    0, 0, NULL)                                                                                    \
  X("count", CLI_COUNT, triangles, "COUNT",                                                        \
    "Decimate every scan to at most this many triangles. Default: scans of more than 2000 are "    \
    "decimated to what `scree choose` chooses for them.",                                          \
    4, 4294967295.0, NULL)                                                                         \
  X("clump", CLI_COUNT, clump, "N",                                                                \
    "Clumps of so many spheres in place of the scans' surfaces, with their mass and inertia.", 1,  \
    300, NULL)                                                                                     \
  X("spheres", CLI_FLAG, spheres, NULL,                                                            \
    "A run with spheres of the shapes' volumes: alone, or after those of --rp.", 0, 0, NULL)       \
  X("method", CLI_CHOICE, method, "NAME",                                                          \
    "How to decimate: volume (keeps the volume) or qecd (as the paper). Default: volume.", 0, 0,   \
    "volume|qecd")                                                                                 \
  X("no-repair", CLI_FLAG, no_repair, NULL,                                                        \
    "Refuse scans that are no closed surface instead of repairing them.", 0, 0, NULL)              \
  X("resume", CLI_FLAG, resume, NULL,                                                              \
    "Go on from the checkpoint in DIR where there is one; without SHAPE, with what is in it.", 0,  \
    0, NULL)                                                                                       \
  X("force", CLI_FLAG, force, NULL, "Begin anew in a folder with an earlier run, whose files go.", \
    0, 0, NULL)                                                                                    \
  X("view", CLI_CHOICE, view, "VIEW",                                                              \
    "What of each frame becomes a .vtp file for ParaView. Default: surfaces.", 0, 0,               \
    "none|surfaces|points|contacts|walls|all")                                                     \
  X("json", CLI_FLAG, json, NULL, "Print result.json instead of text.", 0, 0, NULL)                \
  X("no-picture", CLI_FLAG, no_picture, NULL, "Do not write scene.png.", 0, 0, NULL)               \
  X("rays", CLI_COUNT, rays, "N", "Rays a pixel of scene.png. Default: 24.", 1, 65536, NULL)
#define CLI_POUR_PARTNERS                                                                          \
  "method:rp resolution:sample:|samples noise:sample:|samples sample-seed:sample:|samples "        \
  "rp::|samples count::|samples clump::|samples spheres::|samples no-repair::|samples "            \
  "unit::|samples"

typedef struct cli_pour_kind {
  const char *template_name;
  const cli_setting *settings;
  size_t setting_count;
  bool states; /* frames can be measured again */
} cli_pour_kind;

/* The exit code. */
int cli_pour_run(const cli_call *call, const cli_pour_kind *kind);
