/* Leases: files that say who works on what, in a folder that several machines may share. A lease
 * only saves work: results are the same whoever makes them, so that nothing is lost or wrong where
 * two hold the same one for a moment. */
#pragma once

#include "base/error.h"
#include "base/path.h"

enum { SCREE_LEASE_NAME = 160, SCREE_LEASE_NOTE = 96 };

typedef struct scree_lease {
  char path[SCREE_PATH_BYTES];   /* "": there is none */
  char aside[SCREE_PATH_BYTES];  /* where a new one is written */
  char token[64];                /* ours alone */
  char worker[SCREE_LEASE_NAME]; /* for people */
  double last_renewal;           /* on the clock */
} scree_lease;

/* What can be seen of a lease. */
typedef struct scree_lease_view {
  bool held;  /* somebody has it ... */
  bool alive; /* ... and is not known to be dead: process gone on this machine, or no sign of life
                 for lease_s seconds */
  char worker[SCREE_LEASE_NAME], note[SCREE_LEASE_NOTE];
  double age; /* s since the last sign of life, by the folder's own clock */
} scree_lease_view;

/* Tries to take FOLDER/NAME; *taken false where another alive holds it. One whose holder is dead is
 * taken over, and the death is written down. Free with scree_lease_release. */
scree_status scree_lease_take(const char *folder, const char *name, double lease_s,
                              const char *worker, bool *taken, scree_lease *lease,
                              scree_error *error);
/* A sign of life with a note; *kept false where somebody else has the lease now. */
scree_status scree_lease_renew(scree_lease *lease, const char *note, bool *kept,
                               scree_error *error);
/* Gives it back, if it is still ours. */
void scree_lease_release(scree_lease *lease);

scree_lease_view scree_lease_look(const char *folder, const char *name, double lease_s);
/* How many holders died; *last (may be NULL) gets the last one's name. */
size_t scree_lease_deaths(const char *folder, const char *name, char last[SCREE_LEASE_NAME]);
/* Forgets them. */
void scree_lease_forget_deaths(const char *folder, const char *name);

/* "host.pid", for a worker that was given no name. */
void scree_lease_default_worker(char worker[SCREE_LEASE_NAME]);
