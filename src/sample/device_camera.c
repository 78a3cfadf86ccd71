/* Three digital cameras. */
#include "sample/device.h"

/* A compact with its lens out, in three stages. */
static const scree_piece_mm compact[] = {
    {PART, JOIN, {0, 0, 0}},
    {SLAB, JOIN, {0, 0, 0}, {48, 28.5, 10.5}, 7, 2.5},
    {SLAB, JOIN, {-40, -1, 9}, {4.5, 22, 4.2}, 4, 2, .blend = 5}, /* grip */
    {SLAB, JOIN, {12, -1, 12}, {25.5, 25.5, 3}, 25.5, 1, .blend = 0.8},
    {SLAB, JOIN, {12, -1, 17}, {22.5, 22.5, 4.8}, 22.5, 0.7, .blend = 0.5},
    {SLAB, JOIN, {12, -1, 24}, {19, 19, 5.2}, 19, 0.7, .blend = 0.5},
    {SLAB, JOIN, {12, -1, 30}, {15.8, 15.8, 4.6}, 15.8, 0.8, .blend = 0.5},
    {TORUS, CUT, {12, -1, 19}, {22.8, 0.6, 0}, .blend = 0.3},
    {SLAB, CUT, {12, -1, 35}, {11, 11, 2.2}, 11, 0.5, .taper = 0.5, .blend = 0.5},
    {CAPSULE, JOIN, {12, -1, 20.6}, {13.6, 0, 0}, .blend = 0.3},         /* front lens */
    {SLAB, CUT, {-24, 20.5, 10.6}, {8, 4.2, 1}, 1.5, 0.4, .blend = 0.5}, /* flash */
    {SLAB, CUT, {-24, 20.5, 10.2}, {7, 0.5, 1.1}, 0.4, 0.2, .blend = 0.3, COLUMN(4, 1.8)},
    {SLAB, CUT, {-7.8, 22.5, 10.6}, {3.6, 2.8, 1.6}, 1, 0.4, .blend = 0.5}, /* viewfinder */
    {SLAB, CUT, {-14, 8, 10.6}, {1.8, 1.8, 0.8}, 1.8, 0.3, .blend = 0.4},   /* focus light */
    {SLAB, JOIN, {-33, 29, 0}, {8, 8, 1.6}, 8, 0.7, .blend = 0.6, UPRIGHT},
    {SLAB, JOIN, {-33, 31, 0}, {5, 5, 1.4}, 5, 0.6, .blend = 0.4, UPRIGHT},
    {SLAB, JOIN, {-13, 29, 0}, {3.4, 3.4, 0.9}, 3.4, 0.4, .blend = 0.4, UPRIGHT},
    {SLAB, CUT, {4, 28.4, 0}, {0.7, 0.7, 1.2}, 0.7, 0.2, .blend = 0.4, ROW(5, 2.4), UPRIGHT}, /* mic
                                                                                               */
    {SLAB, CUT, {-12, -2, -10.6}, {30, 22, 0.9}, 2, 0.4, .blend = 0.5}, /* screen */
    {SLAB, JOIN, {33.5, -2, -10.4}, {8, 8, 1.4}, 8, 0.6, .blend = 0.4}, /* four-way key */
    {SLAB, CUT, {33.5, -2, -12}, {3.8, 3.8, 0.9}, 3.8, 0.3, .blend = 0.4},
    {SLAB, JOIN, {33.5, 11.5, -10.4}, {2.4, 1.8, 1}, 1.5, 0.4, .blend = 0.4, ROW(2, 9)},
    {SLAB, JOIN, {33.5, -15.5, -10.4}, {2.4, 1.8, 1}, 1.5, 0.4, .blend = 0.4, ROW(2, 9)},
    {SLAB, CUT, {12, -28.5, 0}, {3.2, 3.2, 4}, 3.2, 0.4, .blend = 0.6, UPRIGHT},
    {SLAB, CUT, {-30, -28.5, 0}, {11, 7.5, 0.6}, 2, 0.2, .blend = 0.3, UPRIGHT},
    {SLAB, JOIN, {-30, -28.1, 0}, {10.3, 6.8, 0.5}, 1.5, 0.2, .blend = 0.2, UPRIGHT}, /* battery
                                                                                         door */
    {TORUS, JOIN, {48.2, 17, 0}, {2.6, 1.05, 0}, .blend = 0.4}, /* strap eye */
};

/* A boxy camera with a finder, a deep grip and its lens retracted. */
static const scree_piece_mm finder[] = {
    {PART, JOIN, {0, 0, 0}},
    {SLAB, JOIN, {0, 0, 0}, {53, 33, 15}, 5, 3},
    {SLAB, JOIN, {-41, -2, 13}, {11, 29, 9}, 9, 6, .blend = 7},    /* grip */
    {SLAB, JOIN, {6, 33, 0}, {19, 5.5, 12}, 4.5, 2.5, .blend = 4}, /* finder's hump */
    {SLAB, JOIN, {12, -3, 16}, {28.5, 28.5, 4.5}, 28.5, 1.2, .blend = 1},
    {SLAB, JOIN, {12, -3, 21}, {25.5, 25.5, 4.5}, 25.5, 0.8, .blend = 0.6},
    {SLAB, CUT, {12, -3, 24.6}, {22.5, 22.5, 1.5}, 22.5, 0.4, .blend = 0.5},
    {SLAB, JOIN, {12, -3, 22}, {20.5, 20.5, 4.8}, 20.5, 0.8, .blend = 0.4},
    {SLAB, CUT, {12, -3, 27.2}, {12.5, 12.5, 3.4}, 12.5, 0.5, .taper = 0.55, .blend = 0.5},
    {CAPSULE, JOIN, {12, -3, 11.4}, {13.4, 0, 0}, .blend = 0.3},
    {SLAB, CUT, {12, -3, 20.8}, {0.7, 1.1, 4.4}, 0.6, 0.3, .blend = 0.4, RING(36, 25.8)}, /* lens
                                                                                             ring */
    {SLAB, CUT, {6, 34, 12}, {12, 3.2, 1.2}, 1.5, 0.4, .blend = 0.6},  /* flash */
    {SLAB, CUT, {-19, 25, 15.2}, {5, 4, 1.6}, 1.2, 0.4, .blend = 0.6}, /* finder window */
    {SLAB, CUT, {-19, 13, 15.2}, {2.2, 2.2, 1}, 2.2, 0.3, .blend = 0.5},
    {SLAB, JOIN, {6, 32, -14}, {10.5, 7, 4.6}, 3, 1.2, .blend = 1.5}, /* eyepiece */
    {SLAB, CUT, {6, 32, -19}, {7, 4, 2.6}, 1.5, 0.4, .blend = 0.6},
    {SLAB, CUT, {6, 38.6, -3}, {9.2, 7.5, 1.7}, 0.8, 0.3, .blend = 0.5, UPRIGHT},
    {SLAB, JOIN, {6, 37.4, -3}, {6, 6.5, 0.8}, 0.6, 0.2, .blend = 0.3, UPRIGHT}, /* hot shoe */
    {SLAB, JOIN, {38, 34, 0}, {9.5, 9.5, 4}, 9.5, 0.8, .blend = 0.6, UPRIGHT},
    {SLAB,
     CUT,
     {38, 34.6, 0},
     {0.7, 0.8, 3.8},
     0.6,
     0.3,
     .blend = 0.3,
     UPRIGHT,
     RING(20, 9.7)}, /* mode dial */
    {SLAB, JOIN, {-42, 33, 12}, {6, 6, 2.4}, 6, 0.8, .blend = 0.8, .turn_deg = {75, 0, 0}},
    {CAPSULE, CUT, {-42, 45.5, 15.2}, {10.2, 0, 0}, .blend = 0.5}, /* shutter */
    {SLAB, JOIN, {-30, 33, -2}, {3.2, 3.2, 1.2}, 3.2, 0.5, .blend = 0.4, UPRIGHT},
    {SLAB, CUT, {-14, -5, -15.2}, {33, 24, 0.9}, 2, 0.4, .blend = 0.6}, /* screen */
    {SLAB, JOIN, {38, -6, -14.8}, {9, 9, 1.6}, 9, 0.6, .blend = 0.5},
    {SLAB, CUT, {38, -6, -16.6}, {4.2, 4.2, 1}, 4.2, 0.3, .blend = 0.5},
    {SLAB, JOIN, {38, 11, -14.8}, {2.6, 2.6, 1.2}, 2.6, 0.5, .blend = 0.4, ROW(2, 11)},
    {SLAB, JOIN, {38, -22, -14.8}, {2.6, 2.6, 1.2}, 2.6, 0.5, .blend = 0.4, ROW(2, 11)},
    {SLAB, CUT, {12, -33, 0}, {3.2, 3.2, 4.5}, 3.2, 0.4, .blend = 0.6, UPRIGHT},
    {SLAB, CUT, {53.2, 4, 0}, {0.9, 12, 0.6}, 0.5, 0.3, .blend = 0.3, .copies_x = 1},
    {TORUS, JOIN, {53.4, 22, 0}, {3, 1.2, 0}, .blend = 0.5},
    {TORUS, JOIN, {-53.4, 22, 0}, {3, 1.2, 0}, .blend = 0.5},
};

/* A bridge camera with a long zoom. */
static const scree_piece_mm bridge[] = {
    {PART, JOIN, {0, 0, 0}},
    {SLAB, JOIN, {0, 0, 0}, {56, 34, 15}, 9, 5},
    {SLAB, JOIN, {-45, -3, 18}, {12, 30, 14}, 11, 8, .blend = 9}, /* grip */
    {SLAB, JOIN, {8, 34, -2}, {20, 11, 20}, 8, 5, .blend = 8},    /* finder's hump */
    {SLAB, JOIN, {8, 44, 14}, {16, 2.5, 11}, 2, 1.2, .blend = 2, .turn_deg = {-4, 0, 0}}, /* flash
                                                                                             lid */
    {SLAB, JOIN, {10, -2, 26}, {34, 34, 13}, 34, 2, .blend = 2.5},
    {SLAB, JOIN, {10, -2, 44}, {31.5, 31.5, 10}, 31.5, 1, .blend = 0.8},
    {SLAB, CUT, {10, -2, 45}, {1, 1.5, 6}, 0.9, 0.4, .blend = 0.5, RING(40, 32)}, /* zoom ring */
    {SLAB, JOIN, {10, -2, 58}, {28, 28, 8}, 28, 1, .blend = 0.6},
    {SLAB, JOIN, {10, -2, 69}, {30, 30, 5}, 30, 1, .taper = 0.08, .blend = 0.6},
    {SLAB, CUT, {10, -2, 74.4}, {21, 21, 6}, 21, 0.6, .taper = 0.6, .blend = 0.6},
    {CAPSULE, JOIN, {10, -2, 42}, {29.5, 0, 0}, .blend = 0.4}, /* front lens */
    {SLAB, CUT, {-20, 24, 15.2}, {2.4, 2.4, 1.2}, 2.4, 0.3, .blend = 0.5},
    {SLAB, JOIN, {8, 40, -22}, {14, 9, 5}, 4, 2, .blend = 2}, /* eyepiece */
    {SLAB, CUT, {8, 40, -27.2}, {9, 5, 2.6}, 1.5, 0.4, .blend = 0.8},
    {SLAB, CUT, {8, 46.4, -6}, {9.4, 8, 1.7}, 0.8, 0.3, .blend = 0.5, UPRIGHT},
    {SLAB, JOIN, {38, 36, -2}, {10, 10, 5}, 10, 0.8, .blend = 0.8, UPRIGHT},
    {SLAB,
     CUT,
     {38, 37.5, -2},
     {0.7, 0.9, 4},
     0.6,
     0.3,
     .blend = 0.3,
     UPRIGHT,
     RING(24, 10.2)}, /* mode dial */
    {SLAB, JOIN, {-45, 32, 24}, {7, 7, 3}, 7, 1, .blend = 1, .turn_deg = {70, 0, 0}},
    {CAPSULE, CUT, {-45, 49, 30.2}, {15, 0, 0}, .blend = 0.6}, /* shutter */
    {SLAB, JOIN, {-32, 34, 2}, {3.4, 3.4, 1.4}, 3.4, 0.5, .blend = 0.5, ROW(2, 9.5), UPRIGHT},
    {SLAB, JOIN, {-10, -5, -16}, {36, 25, 2.2}, 3, 0.8, .blend = 0.5}, /* tilting screen */
    {SLAB, CUT, {-10, -4, -18.4}, {32, 20.5, 0.8}, 1, 0.3, .blend = 0.5},
    {SLAB, JOIN, {41, -8, -14.8}, {9.5, 9.5, 1.8}, 9.5, 0.6, .blend = 0.5},
    {SLAB, CUT, {41, -8, -16.8}, {4.4, 4.4, 1}, 4.4, 0.3, .blend = 0.5},
    {SLAB, JOIN, {41, 12, -14.8}, {3, 2.2, 1.3}, 2, 0.5, .blend = 0.5, GRID(2, 2, 11, 7)},
    {SLAB, JOIN, {-47, 25, -14}, {8, 4, 3}, 3, 1.5, .blend = 3}, /* thumb rest */
    {SLAB, CUT, {10, -34, 0}, {3.2, 3.2, 5}, 3.2, 0.4, .blend = 0.6, UPRIGHT},
    {SLAB, CUT, {56.2, -2, 2}, {0.9, 14, 0.6}, 0.5, 0.3, .blend = 0.3},
    {TORUS, JOIN, {56.6, 22, 0}, {3.6, 1.4, 0}, .blend = 0.6},
    {TORUS, JOIN, {-56.6, 22, 0}, {3.6, 1.4, 0}, .blend = 0.6},
};

const scree_device scree_cameras[3] = {
    SCREE_DEVICE("dc-1", "digital camera, compact with the lens out in three stages", compact),
    SCREE_DEVICE("dc-2", "digital camera with finder, deep grip and mode dial", finder),
    SCREE_DEVICE("dc-3", "digital camera, bridge type with a long zoom", bridge),
};
