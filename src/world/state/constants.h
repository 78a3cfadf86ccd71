/* All numbers of the contact law that are no option of a world, no material's and none of speed.
 *
 * In units of: the pair's overlap limit, its contact radii (reach), its contact time pi (m/K)^1/2,
 * a step's way; cosines where nothing else is said. Where no source stands the number is a choice;
 * docs/background/physics.md tells what depends on it. */
#pragma once

/* ---- points against surfaces (narrow.c) ---- */

/* 81 degrees: faces so far from the separation direction still count, of thin wedges. */
static const double point_facing_cosine = 0.15;
/* A second face of a notch counts from 15 degrees, and wholly from 25: a finely meshed dent has
 * less from face to face. */
static const double notch_cosines[2] = {0.9659258, 0.9063078};

/* ---- edges against edges (edges.c) ---- */

/* Sines: nearly parallel edges leave to their ends what they would say themselves. */
static const double parallel_sines[2] = {1e-3, 4e-3};
/* A direction beyond the normals of an edge's faces: wholly one of its own up to 15 degrees, not at
 * all from 30. */
static const double beyond_cosines[2] = {0.8660254, 0.9659258};
static const double beyond_sines[2] = {0.5, 0.2588190};
/* Between a crossing's normal and the direction in which the edges were last apart. */
static const double crossing_cosines[2] = {0.3, 0.6};
/* 78 degrees: the way in which the pair presses already. */
static const double pressing_cosine = 0.2;
/* Cosines and sines of scree_cone_slack and of twice that. */
static const double slack_cosines[2] = {0.9982005, 0.9928086};
static const double slack_sines[2] = {0.0599640, 0.1197122};
/* Over this part of contact radii and overlap a crossing fades at its ends. */
static const double end_share = 0.1;
/* It fades as for this sharing where that is less. */
static const double least_sharing = 0.01;
/* From 73 degrees on a face at an end bears what its corner would. */
static const double corner_facing_cosine = 0.3;

/* ---- depths of edges in bodies (depth.c) ---- */

/* A depth is asked for from this part of the contact radii on. */
static const double near_share = 0.25;
/* A pair that begins deeper than this part of the limit began in each other. */
static const double start_share = 0.05;
/* Relative, within which the deepest place is found. */
static const double depth_tolerance = 1e-6;

/* ---- one force of many contact points (law.c, spheres.c) ---- */

/* Slopes of blends and of fading tapers: steps do not resolve steeper ones. */
static const double most_slopes[2] = {3, 1};
/* A step's ways below an overlap in which the spring is seen well. */
static const double steep_overlap = 3;
/* Contact radii a step resolves. */
static const double resolved_share = 0.01;
/* Share of the critical damping of rolling: Ai, Chen, Rotter, Ooi 2011, eq. 24 to 32. */
static const double rolling_damping_ratio = 0.3;
/* Rolling of bodies that are no spheres: the inertia about the contact times the sum of 1/I about
 * three axes, 3 * 7/2 as of a sphere; the largest (mu_r b)^2 m/I, likewise summed, whose spring is
 * that of spheres. */
static const double rolls_about_contact = 10.5, softest_rolling = 8.0 / 3;

/* ---- springs pressed beyond what is small beside the bodies (law.h) ---- */

/* In overlap limits: from here on a spring hardens, over this width to so many times K. */
static const double hard_from = 1, hard_width = 0.5, hard_most = 100;
/* The same for bodies that are hit off their centres, which feel less than their mass. */
static const double hard_most_turning = 15;
/* In place of kappa there: else turning the bodies is as much stiffer as the force is larger. */
static const double hard_sharing = 0.5;
/* (K/m)^1/2 h in the parts of a step, with the hardened K and a mass of a seventh. */
static const double hard_pace = 0.5;
/* In overlap limits: beyond it bodies part that know depths, and others have come through. */
static const double most_pressed = 4;
/* In overlap limits: a deeper claim of features the depths of edges must bear out, by half. */
static const double sure_pressed = 2.5, sure_share = 0.5;

/* ---- sub-steps (substep.c) ---- */

/* Contact radii: deeper features are blended, and not stepped finely. */
static const double blended_depth = 0.5;
/* Contact radii: pairs that move farther in a step are followed alone. While they are, the forces
 * of others stand still, which costs slower pairs more than it gains. */
static const double followed_way = 0.04;
/* Contact radii in a sub-step. */
static const double longest_way = 0.02;

/* ---- bodies that lie in each other (law.c, depth.c, watch.c) ---- */

/* The length of the normals' mean, by contact weights: shorter is held from all sides. */
static const double pinched_net = 0.35;
/* Between a way out and the side from which a body came to a sheet. */
static const double way_back_cosine = 0.3;
/* A body as deep as its limit is apart in so many contact times; nor may a place be through a
 * surface for longer. */
static const double passage_patience = 50;
/* Share of the reduced mass, taken in a step: a corner's is up to seven times smaller. */
static const double depenetration_damping = 0.1;
/* They are apart from this part of the contact radii on, and looked at as often as they have come
 * out by this part of their depth. */
static const double apart_share = 0.9, depenetration_look_share = 0.2;

/* ---- the watch for what passes a surface (watch.c) ---- */

/* Share of the depth of the deepest place that may pass between two looks. */
static const double watch_look_share = 0.25;
/* 105 degrees: what leaves within that of where it came from goes back. */
static const double watch_back_cosine = -0.25;
/* 120 degrees: beyond a rim within that of where it came from. */
static const double watch_rim_cosine = -0.5;
