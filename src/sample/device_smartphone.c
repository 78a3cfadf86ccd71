/* Three smartphones. */
#include "sample/device.h"

/* Flat sides, a square camera bump with three lenses. */
static const scree_piece_mm flat[] = {
    {PART, JOIN, {0, 0, 0}},
    {SLAB, JOIN, {0, 0, 0}, {35.8, 73.4, 3.9}, 10.5, 1},
    {SLAB, CUT, {0, 70.8, 3.9}, {5, 0.7, 0.6}, 0.6, 0.2, .blend = 0.4}, /* earpiece */
    {SLAB, JOIN, {-18, 54.5, -4.2}, {16.2, 16.2, 1.5}, 9, 0.8, .blend = 0.8},
    {SLAB, JOIN, {-26, 62.5, -5.6}, {6.6, 6.6, 1.5}, 6.6, 0.6, .blend = 0.4},
    {SLAB, JOIN, {-26, 46.5, -5.6}, {6.6, 6.6, 1.5}, 6.6, 0.6, .blend = 0.4},
    {SLAB, JOIN, {-10, 54.5, -5.6}, {6.6, 6.6, 1.5}, 6.6, 0.6, .blend = 0.4},
    {SLAB, CUT, {-26, 62.5, -7.3}, {4.8, 4.8, 0.8}, 4.8, 0.2, .blend = 0.4},
    {SLAB, CUT, {-26, 46.5, -7.3}, {4.8, 4.8, 0.8}, 4.8, 0.2, .blend = 0.4},
    {SLAB, CUT, {-10, 54.5, -7.3}, {4.8, 4.8, 0.8}, 4.8, 0.2, .blend = 0.4},
    {SLAB, CUT, {-9, 65.5, -5.9}, {2.3, 2.3, 0.6}, 2.3, 0.2, .blend = 0.4}, /* light */
    {SLAB, CUT, {0, -73.4, 0}, {4.5, 2.5, 1.5}, 1.4, 0.3, .blend = 0.5},    /* connector */
    {SLAB, CUT, {-16, -73.4, 0}, {0.8, 0.8, 1.6}, 0.8, 0.2, .blend = 0.4, ROW(6, 2.9), UPRIGHT},
    {SLAB, CUT, {16, -73.4, 0}, {0.8, 0.8, 1.6}, 0.8, 0.2, .blend = 0.4, ROW(6, 2.9), UPRIGHT},
    {SLAB, JOIN, {35.8, 24, 0}, {0.7, 9, 1.3}, 0.5, 0.4, .blend = 0.3}, /* power */
    {SLAB, JOIN, {-35.8, 24, 0}, {0.7, 5.2, 1.3}, 0.5, 0.4, .blend = 0.3, COLUMN(2, 13)}, /* volume
                                                                                           */
    {SLAB, JOIN, {-35.8, 45, 0}, {0.6, 2.6, 1.2}, 0.5, 0.3, .blend = 0.3},
};

/* Round long edges and a camera bar across the back. */
static const scree_piece_mm barred[] = {
    {PART, JOIN, {0, 0, 0}},
    {SLAB, JOIN, {0, 0, 0}, {38, 81, 4.4}, 9, 4},
    {SLAB, JOIN, {0, 48, -4.6}, {37.8, 11.5, 2.2}, 5, 1.6, .blend = 1.5}, /* camera bar */
    {SLAB, CUT, {-8, 48, -7}, {22, 7.2, 0.9}, 7.2, 0.3, .blend = 0.5},
    {SLAB, JOIN, {-22.6, 48, -6.2}, {5.4, 5.4, 0.7}, 5.4, 0.3, .blend = 0.3},
    {CAPSULE, JOIN, {-22.6, 48, -2.6}, {4.6, 0, 0}, .blend = 0.3},
    {SLAB, JOIN, {-8, 48, -6.2}, {5.4, 5.4, 0.7}, 5.4, 0.3, .blend = 0.3},
    {CAPSULE, JOIN, {-8, 48, -2.6}, {4.6, 0, 0}, .blend = 0.3},
    {SLAB, JOIN, {5.8, 48, -6.2}, {4.4, 4.4, 0.7}, 1.4, 0.3, .blend = 0.3},
    {SLAB, CUT, {24, 48, -6.9}, {2.6, 2.6, 0.7}, 2.6, 0.2, .blend = 0.4}, /* light */
    {SLAB, CUT, {0, 79, 3.9}, {7, 0.6, 0.8}, 0.5, 0.2, .blend = 0.4},     /* earpiece */
    {CAPSULE, CUT, {0, 71, 6.2}, {2.6, 0, 0}, .blend = 0.5},              /* front camera */
    {SLAB, CUT, {0, -81, 0}, {4.6, 2.5, 1.6}, 1.5, 0.3, .blend = 0.5},
    {SLAB, CUT, {0, -81, 0}, {5, 1.6, 0.9}, 0.8, 0.2, .blend = 0.4, ROW(2, 36)},
    {SLAB, JOIN, {38, 28, 0}, {0.8, 5, 1.4}, 0.6, 0.4, .blend = 0.4},
    {SLAB, JOIN, {38, 6, 0}, {0.8, 11, 1.4}, 0.6, 0.4, .blend = 0.4},
    {SLAB, CUT, {-38, -20, 0}, {0.9, 8, 1.3}, 0.4, 0.2, .blend = 0.3}, /* card tray */
    {SLAB, JOIN, {-37.7, -20, 0}, {0.6, 7.2, 0.7}, 0.3, 0.2, .blend = 0.2},
};

/* A smaller one with a home key, bent by 14 degrees as in a shredder's feed. */
static const scree_piece_mm bent[] = {
    {PART, JOIN, {0, 0, 0}, .bend_length = 60, .bend_deg = 14},
    {SLAB, JOIN, {0, 0, 0}, {33.5, 69, 3.6}, 9.5, 2.2},
    {SLAB, CUT, {0, -59.5, 3.8}, {5.6, 5.6, 0.7}, 5.6, 0.3, .blend = 0.6}, /* home key */
    {TORUS, JOIN, {0, -59.5, 3.5}, {5.6, 0.5, 0}, .blend = 0.3},
    {SLAB, CUT, {0, 61, 3.6}, {5.2, 0.8, 0.7}, 0.8, 0.2, .blend = 0.4}, /* earpiece */
    {CAPSULE, CUT, {-10.5, 61, 4.6}, {1.8, 0, 0}, .blend = 0.4},
    {SLAB, CUT, {0, 1, 3.8}, {30.4, 53.5, 0.5}, 0.8, 0.2, .blend = 0.4}, /* glass, set in */
    {SLAB, JOIN, {-22.5, 57.5, -3.8}, {6.2, 6.2, 1.2}, 6.2, 0.6, .blend = 0.5},
    {SLAB, CUT, {-22.5, 57.5, -5.2}, {4.4, 4.4, 0.8}, 4.4, 0.2, .blend = 0.4},
    {SLAB, CUT, {-11, 57.5, -3.6}, {2.1, 2.1, 0.6}, 2.1, 0.2, .blend = 0.4},
    {SLAB, CUT, {0, -69, 0}, {4, 2.5, 1.3}, 1, 0.3, .blend = 0.4},
    {SLAB, CUT, {-21, -69, 0}, {1.75, 1.75, 3}, 1.75, 0.3, .blend = 0.4, UPRIGHT},
    {SLAB, CUT, {17, -69, 0}, {0.75, 0.75, 1.4}, 0.75, 0.2, .blend = 0.4, ROW(6, 2.7), UPRIGHT},
    {SLAB, JOIN, {-33.5, 34, 0}, {0.7, 4.6, 1.2}, 0.5, 0.3, .blend = 0.3, COLUMN(2, 12)},
    {SLAB, JOIN, {33.5, 30, 0}, {0.7, 5, 1.2}, 0.5, 0.3, .blend = 0.3},
};

const scree_device scree_smartphones[3] = {
    SCREE_DEVICE("sp-1", "smartphone, flat sides, square camera bump", flat),
    SCREE_DEVICE("sp-2", "smartphone, round long edges, camera bar", barred),
    SCREE_DEVICE("sp-3", "smartphone, bent by 14 degrees", bent),
};
