/* Verbs that pour shapes into a template and run it: words as shapes, levels, settings, runs. */
#pragma once

#include "cli/scene_run.h"

enum { CLI_VIEW_UNSET = -1 };

typedef struct cli_pour_arguments {
  cli_scene_options scene;
  const char *config, *preset, *rp;
  cli_fields fields;
  cli_source source;
  size_t each; /* particles of a word without =COUNT; 0: equal shares of the template's */
  size_t triangles, clump;
  int method, view, container;
  bool samples, spheres, no_repair;
} cli_pour_arguments;

#define CLI_POUR_DEFAULTS .source = CLI_SOURCE_DEFAULTS, .scene.rays = 8, .view = CLI_VIEW_UNSET

/* Options of all such verbs. */
#define CLI_POUR_OPTIONS                                                                           \
  CLI_ROW(CLI_FILE, "config", config, "FILE",                                                      \
          "A scene in YAML, as --print writes it, or values of its parameters; - is stdin."),      \
      CLI_ROW(CLI_TEXTS, "set", scene.set, "FIELD=VALUE",                                          \
              "Change any field of the scene, as gravity.0=1; may be given several times."),       \
      CLI_FLAG_ROW("print", scene.print,                                                           \
                   "Print the scene as it would be run, with units and comments, and stop."),      \
      CLI_FLAG_ROW("samples", samples, "The nine built-in devices as shapes."),                    \
      CLI_ROW(CLI_TEXT, "rp", rp, "LIST",                                                          \
              "Decimate the scans first, as 1e-3, or 1e-5,recommended,1e-3 for a run at each; "    \
              "clump:20 is a run with clumps of 20 spheres that stand for the scans."),            \
      CLI_RANGE_ROW(CLI_COUNT, "count", triangles, "COUNT", 4, 4294967295.0,                       \
                    "Decimate every scan to at most this many triangles. Default: scans of more "  \
                    "than 2000 are decimated to what `scree choose` chooses for them."),           \
      CLI_RANGE_ROW(CLI_COUNT, "clump", clump, "N", 1, 300,                                        \
                    "Clumps of so many spheres in place of the scans' surfaces, with their mass "  \
                    "and inertia."),                                                               \
      CLI_FLAG_ROW("spheres", spheres,                                                             \
                   "A run with spheres of the shapes' volumes: alone, or after those of --rp."),   \
      CLI_CHOICE_ROW("method", method, "NAME", "volume|qecd",                                      \
                     "How to decimate: volume (keeps the volume) or qecd (as the paper). "         \
                     "Default: volume."),                                                          \
      CLI_FLAG_ROW("no-repair", no_repair,                                                         \
                   "Refuse scans that are no closed surface instead of repairing them."),          \
      CLI_FLAG_ROW("resume", scene.resume,                                                         \
                   "Go on from the checkpoint in DIR where there is one; without SHAPE, with "     \
                   "what is in it."),                                                              \
      CLI_FLAG_ROW("force", scene.overwrite,                                                       \
                   "Begin anew in a folder with an earlier run, whose files go."),                 \
      CLI_CHOICE_ROW("view", view, "VIEW", "none|surfaces|points|contacts|walls|all",              \
                     "What of each frame becomes a .vtp file for ParaView. Default: surfaces."),   \
      CLI_FLAG_ROW("json", scene.json, "Print result.json instead of text."),                      \
      CLI_FLAG_ROW("no-picture", scene.no_picture, "Do not write scene.png."),                     \
      CLI_RANGE_ROW(CLI_COUNT, "rays", scene.rays, "N", 1, 65536,                                  \
                    "Rays a pixel of scene.png. Default: 8.")
#define CLI_POUR_PARTNERS                                                                          \
  "method:rp resolution:sample:|samples noise:sample:|samples sample-seed:sample:|samples "        \
  "rp::|samples count::|samples clump::|samples spheres::|samples no-repair::|samples "            \
  "unit::|samples"
#define CLI_POUR_EXCLUSIVE "rp|count"

/* states: frames can be measured again. */
scree_status cli_pour_run(const cli_call *call, const char *template_name, bool states,
                          scree_error *error);
