/* Three feature phones. */
#include "sample/device.h"

/* A clamshell, open at 160 degrees: the hinge's axis is the x axis. */
static const scree_piece_mm clamshell[] = {
    {PART, JOIN, {0, 0, 0}},
    {SLAB, JOIN, {0, -47.5, -2.5}, {24.5, 46, 5.5}, 9, 2.2},
    {SLAB, CUT, {0, 0, 0}, {6.2, 6.2, 13.5}, 6.2, 0.4, .blend = 0.6, .turn_deg = {0, 90, 0}},
    {SLAB, JOIN, {-18.5, 0, 0}, {5.5, 5.5, 5}, 5.5, 0.9, .blend = 1.5, .turn_deg = {0, 90, 0}},
    {SLAB, JOIN, {18.5, 0, 0}, {5.5, 5.5, 5}, 5.5, 0.9, .blend = 1.5, .turn_deg = {0, 90, 0}},
    {SLAB, CUT, {0, -55, 3.4}, {20.5, 33, 1}, 4, 0.4, .blend = 0.6}, /* the keypad's bed */
    {SLAB,
     JOIN,
     {0, -66.5, 2.6},
     {5.6, 3.2, 1.1},
     1.6,
     0.5,
     .taper = -0.1,
     .blend = 0.3,
     GRID(3, 4, 13.2, 8.4)},
    {SLAB, JOIN, {0, -37, 2.6}, {9.5, 9.5, 1.3}, 9.5, 0.6, .blend = 0.3},
    {SLAB, CUT, {0, -37, 4}, {5.2, 5.2, 0.9}, 5.2, 0.3, .blend = 0.5},
    {CAPSULE, JOIN, {0, -37, 1.2}, {3.2, 0, 0}, .blend = 0.4},
    {SLAB, JOIN, {0, -31, 2.6}, {3.2, 2.4, 1.1}, 1.8, 0.5, .blend = 0.3, ROW(2, 30)},
    {SLAB, JOIN, {0, -43, 2.6}, {3.2, 2.4, 1.1}, 1.8, 0.5, .blend = 0.3, ROW(2, 30)},
    {SLAB, CUT, {8, -90.3, 3}, {1.6, 0.6, 0.8}, 0.5, 0.2, .blend = 0.4},    /* microphone */
    {SLAB, CUT, {0, -93.5, -2.5}, {5.5, 1.5, 1.6}, 0.8, 0.3, .blend = 0.5}, /* connector */
    {SLAB, CUT, {0, -14, -8}, {19, 0.5, 0.7}, 0.4, 0.2, .blend = 0.3},      /* battery cover */
    {SLAB, CUT, {0, -70, -8.4}, {6, 1.1, 0.9}, 1, 0.3, .blend = 0.5, COLUMN(3, 4)},
    {CAPSULE, JOIN, {0, 0, 0}, {4.7, 0, 18}, .turn_deg = {0, 90, 0}}, /* the hinge's pin */
    {PART, JOIN, {0, 0, 0}, .turn_deg = {20, 0, 0}},
    {SLAB, JOIN, {0, 47.5, -2.5}, {24.5, 46, 4.6}, 9, 2},
    {SLAB, CUT, {-20.1, 0, 0}, {6.2, 6.2, 7.6}, 6.2, 0.4, .blend = 0.6, .turn_deg = {0, 90, 0}},
    {SLAB, CUT, {20.1, 0, 0}, {6.2, 6.2, 7.6}, 6.2, 0.4, .blend = 0.6, .turn_deg = {0, 90, 0}},
    {SLAB, JOIN, {0, 0, 0}, {5.5, 5.5, 12.5}, 5.5, 0.9, .blend = 1.5, .turn_deg = {0, 90, 0}},
    {SLAB, CUT, {0, 47, 2.4}, {19.5, 30, 1}, 2, 0.4, .blend = 0.6}, /* the screen */
    {SLAB, CUT, {0, 85, 2.1}, {5, 0.9, 1}, 0.9, 0.3, .blend = 0.4}, /* earpiece */
    {SLAB, CUT, {0, 54, -7.6}, {12, 9, 1}, 3, 0.4, .blend = 0.6},   /* second screen */
    {SLAB, JOIN, {0, 76, -6.6}, {8, 8, 1.8}, 8, 0.7, .blend = 0.8}, /* camera */
    {SLAB, CUT, {0, 76, -8.9}, {5, 5, 1.2}, 5, 0.4, .blend = 0.5},
    {CAPSULE, JOIN, {0, 76, -4.6}, {3.4, 0, 0}, .blend = 0.3},
    {SLAB, CUT, {13, 76, -7.4}, {1.8, 1.8, 0.9}, 1.8, 0.3, .blend = 0.4}, /* photo light */
    {SLAB, JOIN, {24.3, 60, -2.5}, {0.9, 5, 1.5}, 0.8, 0.5, .blend = 0.3, COLUMN(2, 13)},
    {SLAB, JOIN, {-19, 93, -2.6}, {3.4, 3.4, 5}, 3.4, 1.2, .blend = 1.5, .turn_deg = {-90, 0, 0}},
};

/* A slider, half open: the upper half is pushed up by 36 mm. */
static const scree_piece_mm slider[] = {
    {PART, JOIN, {0, 0, 0}},
    {SLAB, JOIN, {0, 0, 0}, {25, 51, 5.4}, 8, 1.8},
    {SLAB, CUT, {0, -31.5, 5.4}, {22, 16.8, 0.7}, 3, 0.3, .blend = 0.5},
    {SLAB, JOIN, {0, -31.5, 4.9}, {6.2, 3.1, 0.9}, 1.2, 0.4, .blend = 0.3, GRID(3, 4, 14.2, 7.9)},
    {SLAB, CUT, {0, -50.8, 0}, {4.5, 1.5, 1.5}, 0.8, 0.3, .blend = 0.5},
    {SLAB, CUT, {0, 27, -5.4}, {21, 0.5, 0.7}, 0.4, 0.2, .blend = 0.3},
    {SLAB, CUT, {0, -44, -5.4}, {21, 0.5, 0.7}, 0.4, 0.2, .blend = 0.3},
    {SLAB, JOIN, {25, -20, -0.6}, {0.8, 6, 1.5}, 0.6, 0.4, .blend = 0.3},
    {SLAB,
     CUT,
     {-16, 40, -5.3},
     {0.7, 0.7, 0.9},
     0.7,
     0.2,
     .blend = 0.3,
     GRID(4, 4, 2.6, 2.6)}, /* loudspeaker */
    {PART, JOIN, {0, 36, 9.6}, .blend = 0.5},
    {SLAB, JOIN, {0, 0, 0}, {25, 51, 4.4}, 8, 1.6},
    {SLAB, CUT, {0, 11, 4.5}, {20.5, 30, 0.7}, 1.5, 0.3, .blend = 0.5},
    {SLAB, CUT, {0, 46.3, 4.5}, {5.5, 0.8, 0.9}, 0.8, 0.3, .blend = 0.4},
    {SLAB, CUT, {0, -34.5, 4.6}, {21, 12.2, 0.6}, 4, 0.3, .blend = 0.5},
    {SLAB, JOIN, {0, -34.5, 4.3}, {8.2, 8.2, 1}, 3, 0.5, .blend = 0.3},
    {SLAB, CUT, {0, -34.5, 5.4}, {4.4, 4.4, 0.5}, 1.6, 0.2, .blend = 0.4},
    {SLAB, JOIN, {0, -29.6, 4.3}, {4.6, 3.6, 0.8}, 1.4, 0.4, .blend = 0.3, ROW(2, 29)},
    {SLAB, JOIN, {0, -39.4, 4.3}, {4.6, 3.6, 0.8}, 1.4, 0.4, .blend = 0.3, ROW(2, 29)},
    {SLAB, JOIN, {0, 38, -4.1}, {9.5, 6.5, 1.2}, 6, 0.6, .blend = 0.6}, /* camera, behind */
    {SLAB, CUT, {-2.5, 38, -5.4}, {4, 4, 1.1}, 4, 0.3, .blend = 0.5},
    {CAPSULE, JOIN, {-2.5, 38, -2.3}, {2.8, 0, 0}, .blend = 0.3},
    {SLAB, CUT, {5.4, 38, -5.4}, {1.6, 1.6, 0.6}, 1.6, 0.2, .blend = 0.4},
    {SLAB, JOIN, {25, 22, 0}, {0.8, 7, 1.4}, 0.6, 0.4, .blend = 0.3},
};

/* A bar with a stub antenna. */
static const scree_piece_mm bar[] = {
    {PART, JOIN, {0, 0, 0}},
    {SLAB, JOIN, {0, 0, 0}, {25, 60, 9.8}, 11, 4},
    {SLAB, KEEP, {0, 0, -590.4}, {600, 600, 80}, 600, 0.5, .blend = 2, .turn_deg = {0, 90, 0}},
    {SLAB, JOIN, {-16, 60, -1}, {4.8, 4.8, 8}, 4.8, 1.2, .blend = 2.5, .turn_deg = {-90, 0, 0}},
    {CAPSULE, JOIN, {-16, 74, -1}, {3.6, 0, 12}, .blend = 0.8, .turn_deg = {-90, 0, 0}},
    {TORUS, CUT, {-16, 72, -1}, {3.9, 0.5, 0}, .blend = 0.3, .turn_deg = {-90, 0, 0}},
    {TORUS, CUT, {-16, 75, -1}, {3.9, 0.5, 0}, .blend = 0.3, .turn_deg = {-90, 0, 0}},
    {TORUS, CUT, {-16, 78, -1}, {3.9, 0.5, 0}, .blend = 0.3, .turn_deg = {-90, 0, 0}},
    {SLAB, CUT, {0, 26, 10.2}, {17.5, 16.5, 1.5}, 3, 0.5, .blend = 0.8},         /* the screen */
    {SLAB, CUT, {0, 50, 9.7}, {1.1, 3, 2.2}, 1, 0.3, .blend = 0.4, ROW(3, 4.2)}, /* earpiece */
    {SLAB, JOIN, {0, -0.5, 9.5}, {8.5, 4.6, 1.7}, 4.5, 0.8, .blend = 0.5},       /* navigation */
    {SLAB, CUT, {0, -0.5, 11.4}, {2.6, 1.6, 0.7}, 1.5, 0.3, .blend = 0.4},
    {SLAB,
     JOIN,
     {0, -0.5, 8.9},
     {4.2, 2.8, 1.7},
     2.4,
     0.7,
     .blend = 0.4,
     ROW(2, 28),
     .turn_deg = {0, 0, 0}},
    {SLAB,
     JOIN,
     {0, -30, 8.4},
     {5.4, 3.2, 2.5},
     2.6,
     0.8,
     .taper = -0.15,
     .blend = 0.4,
     GRID(3, 4, 13.6, 10.2)},
    {SLAB, CUT, {9, -55.5, 9}, {0.8, 0.8, 2}, 0.8, 0.3, .blend = 0.4},
    {SLAB, CUT, {0, -60, -1}, {6.5, 2, 2}, 0.9, 0.3, .blend = 0.6},
    {SLAB, CUT, {14, -60, -1}, {1.9, 1.9, 2.5}, 1.9, 0.3, .blend = 0.5, UPRIGHT},
    {SLAB, CUT, {0, 10, -10}, {21, 0.55, 0.9}, 0.5, 0.2, .blend = 0.3},
    {SLAB, CUT, {0, 16, -10.2}, {7, 1, 1.2}, 0.9, 0.3, .blend = 0.5, COLUMN(3, 3.6)},
    {SLAB, JOIN, {25, 22, 0.6}, {1, 8, 2}, 0.8, 0.5, .blend = 0.4},
    {SLAB, CUT, {26.2, 22, 0.6}, {0.8, 0.5, 2.4}, 0.4, 0.2, .blend = 0.4},
};

const scree_device scree_feature_phones[3] = {
    SCREE_DEVICE("fp-1", "feature phone, clamshell opened to 160 degrees", clamshell),
    SCREE_DEVICE("fp-2", "feature phone, slider pushed open", slider),
    SCREE_DEVICE("fp-3", "feature phone, bar with stub antenna and keys", bar),
};
