/* What a scene's file says: plain records, in an arena. */
#pragma once

#include "base/schema_rows.h"
#include "scene/geometry/kinds.h"
#include "scene/motions/kinds.h"
#include "scene/sensors/kinds.h"

#include <math.h>

#define SCREE_PLAN_UNITS "m|cm|mm|um|inch|ft|km"

enum { SCREE_MOST_CLASSES = 100 };
/* A window of time. */
#define SCREE_PLAN_WINDOW(ROW, T)                                                                  \
  ROW(T, REAL, from, 0, 0, 1e9, "s", "")                                                           \
  ROW(T, REAL, until, NAN, 0, 1e9, "s", "not given: to the end")

#define SCREE_PLAN_MATERIAL(ROW, T)                                                                \
  ROW(T, REAL, young, 1e8, 1, 1e16, "Pa",                                                          \
      "stiffness of a contact over size; of the law hertz Young's modulus")                        \
  ROW(T, REAL, density, 2000, 1e-3, 1e6, "kg/m3", "of particles")                                  \
  ROW(T, REAL, restitution, 0.3, 0.01, 1, "",                                                      \
      "of a pair, the lower of the two, unless `pairs` says more")                                 \
  ROW(T, REAL, friction, 0.5, 0, 100, "", "likewise")                                              \
  ROW(T, REAL, rolling_friction, 0, 0, 100, "", "likewise, of what limits rolling; 0: freely")     \
  ROW(T, REAL, surface_energy, 0, 0, 1e6, "J/m2", "of cohesion, likewise; 0: nothing sticks")      \
  ROW(T, REAL, poisson, 0.3, 0, 0.5, "", "Poisson's ratio, of the law hertz")
SCREE_RECORD_TYPE(scree_plan_material, SCREE_PLAN_MATERIAL)

#define SCREE_PLAN_PAIR(ROW, T)                                                                    \
  ROW(T, TEXTS, between, "two materials, or one twice")                                            \
  ROW(T, REAL, restitution, NAN, 0.01, 1, "", "")                                                  \
  ROW(T, REAL, friction, NAN, 0, 100, "", "")                                                      \
  ROW(T, REAL, rolling_friction, NAN, 0, 100, "", "")                                              \
  ROW(T, REAL, surface_energy, NAN, 0, 1e6, "J/m2", "of cohesion")                                 \
  ROW(T, REAL, pull_off, NAN, 0, 1e9, "N", "that holds any two that touch")                        \
  ROW(T, REAL, wear, 0, 0, 1, "1/Pa",                                                              \
      "Archard's: volume that geometry loses over load and way of sliding")
SCREE_RECORD_TYPE(scree_plan_pair, SCREE_PLAN_PAIR)

/* Rosin-Rammler: size d', spread n; lognormal: median, standard deviation of the logarithm. */
#define SCREE_PLAN_ROSIN_RAMMLER(ROW, T)                                                           \
  ROW(T, REAL, size, NAN, 1e-9, 1e3, "m", "63.2 % is finer")                                       \
  ROW(T, REAL, spread, NAN, 0.1, 100, "", "exponent n: the greater the narrower")
SCREE_RECORD_TYPE(scree_plan_rosin_rammler, SCREE_PLAN_ROSIN_RAMMLER)

#define SCREE_PLAN_LOGNORMAL(ROW, T)                                                               \
  ROW(T, REAL, median, NAN, 1e-9, 1e3, "m", "half is finer")                                       \
  ROW(T, REAL, deviation, NAN, 1e-3, 5, "", "standard deviation of the natural logarithm")
SCREE_RECORD_TYPE(scree_plan_lognormal, SCREE_PLAN_LOGNORMAL)

/* One of distribution, rosin_rammler, lognormal, uniform. */
#define SCREE_PLAN_SIZE(ROW, T)                                                                    \
  ROW(T, TABLE, distribution, 0, 1e6, "m|", "[size in m, share]")                                  \
  ROW(T, FLAG, cumulative, false,                                                                  \
      "the shares are of what is finer, from 0 to 1; even between two sizes")                      \
  ROW(T, GROUP, rosin_rammler, scree_plan_rosin_rammler, "")                                       \
  ROW(T, GROUP, lognormal, scree_plan_lognormal, "")                                               \
  ROW(T, FLAG, uniform, false, "even from least to most")                                          \
  ROW(T, WORD, by, 0, "mass|number", "what the shares are of")                                     \
  ROW(T, REAL, least, NAN, 1e-9, 1e3, "m", "none is finer")                                        \
  ROW(T, REAL, most, NAN, 1e-9, 1e3, "m", "none is coarser")                                       \
  ROW(T, COUNT, classes, 8, 1, SCREE_MOST_CLASSES, "of a continuous one")
SCREE_RECORD_TYPE(scree_plan_size, SCREE_PLAN_SIZE)

/* What holds two pieces together. */
#define SCREE_PLAN_BOND(ROW, T)                                                                    \
  ROW(T, REAL, tension, NAN, 1, 1e12, "Pa", "strength")                                            \
  ROW(T, REAL, cohesion, NAN, 1, 1e12, "Pa", "in shear; not given: three times the tension")       \
  ROW(T, REAL, friction, NAN, 0, 10, "", "by which a pressure adds to that; not given: 0.6")       \
  ROW(T, REAL, toughness, NAN, 0, 1e9, "J/m2",                                                     \
      "energy by area at which it breaks too; not given, or 0: at none")                           \
  ROW(T, REAL, weibull, NAN, 0, 1000, "",                                                          \
      "modulus of the scatter of strengths; not given, or 0: none")                                \
  ROW(T, REAL, young, NAN, 1, 1e16, "Pa",                                                          \
      "of the joints; not given: 200 times the tension, at least the material's")                  \
  ROW(T, REAL, damping, NAN, 0, 1, "", "share of critical; not given: 0.05")
typedef struct scree_plan_bond {
  SCREE_PLAN_BOND(SCREE_MEMBER, scree_plan_bond)
} scree_plan_bond;
/* The bond of a record that has these rows. */
#define SCREE_BOND_OF(record)                                                                      \
  ((scree_plan_bond){(record)->tension, (record)->cohesion, (record)->friction,                    \
                     (record)->toughness, (record)->weibull, (record)->young, (record)->damping})

/* Fields of a shape that breaks: its cells, and what holds them together. */
#define SCREE_PLAN_FRACTURE(ROW, T)                                                                \
  ROW(T, COUNT, cells, 60, 1, 10000, "that may break off")                                         \
  ROW(T, SEED, seed, 1, "of their places")                                                         \
  SCREE_PLAN_BOND(ROW, T)
SCREE_RECORD_TYPE(scree_plan_fracture, SCREE_PLAN_FRACTURE)

/* A part of an assembly: one of file, sample, box. */
#define SCREE_PLAN_COMPONENT(ROW, T)                                                               \
  ROW(T, TEXT, file, "a scan, in the coordinates of all; not given: the shape's file names it")    \
  ROW(T, TEXT, sample, "a built-in one")                                                           \
  ROW(T, VECTOR, box, SCREE_NONE, 1e-9, 1e3, "m", "three sides")                                   \
  ROW(T, VECTOR, at, SCREE_ZERO, -1e3, 1e3, "m", "where its origin lies")                          \
  ROW(T, WORD, unit, -1, SCREE_PLAN_UNITS, "of the file's lengths")                                \
  ROW(T, TEXT, triangles, "recommended, all, or at most so many")                                  \
  ROW(T, TEXT, material, "not given: the shape's")                                                 \
  ROW(T, REAL, density, NAN, 1e-3, 1e6, "kg/m3", "another than its material's")                    \
  ROW(T, GROUP, fracture, scree_plan_fracture, "it breaks itself")
SCREE_RECORD_TYPE(scree_plan_component, SCREE_PLAN_COMPONENT)

#define SCREE_PLAN_JOINED(ROW, T)                                                                  \
  ROW(T, TEXTS, between, "two parts; stud* is all that begin so")                                  \
  SCREE_PLAN_BOND(ROW, T)
SCREE_RECORD_TYPE(scree_plan_joined, SCREE_PLAN_JOINED)

#define SCREE_PLAN_JOINTS(ROW, T)                                                                  \
  ROW(T, REAL, gap, NAN, 1e-9, 1, "m",                                                             \
      "within which faces of two parts hold each other; not given: a 500th of the whole's size")   \
  ROW(T, TEXTS, loose, "parts that nothing needs to hold")                                         \
  ROW(T, REAL, bending, 1, 1e-6, 1, "", "of spheres: share of a solid wire's stiffness in it")     \
  ROW(T, LIST, pairs, scree_plan_joined, "what holds two parts otherwise")                         \
  SCREE_PLAN_BOND(ROW, T)
SCREE_RECORD_TYPE(scree_plan_joints, SCREE_PLAN_JOINTS)

/* A wire along a path. */
#define SCREE_PLAN_POINT(ROW, T) ROW(T, VECTOR, at, SCREE_NONE, -1e3, 1e3, "m", "")
SCREE_RECORD_TYPE(scree_plan_point, SCREE_PLAN_POINT)
#define SCREE_PLAN_CABLE(ROW, T)                                                                   \
  ROW(T, REAL, diameter, NAN, 1e-9, 1, "m", "")                                                    \
  ROW(T, LIST, path, scree_plan_point, "straight from point to point")
SCREE_RECORD_TYPE(scree_plan_cable, SCREE_PLAN_CABLE)

/* One of file, sample, sphere, clump (a table), box, cable; a clump that is a count is one of the
 * others' surface. */
#define SCREE_PLAN_SHAPE(ROW, T)                                                                   \
  ROW(T, TEXT, file, "a scan, or a table of spheres")                                              \
  ROW(T, TEXT, sample, "a built-in one, as sp-1")                                                  \
  ROW(T, REAL, sphere, NAN, 1e-9, 1e3, "m", "diameter")                                            \
  ROW(T, TEXT, clump, "a table of spheres: x, y, z, radius; or so many that stand for the shape")  \
  ROW(T, VECTOR, box, SCREE_NONE, 1e-9, 1e3, "m", "three sides")                                   \
  ROW(T, GROUP, cable, scree_plan_cable, "of spheres that joints hold")                            \
  ROW(T, WORD, unit, -1, SCREE_PLAN_UNITS,                                                         \
      "of the file's lengths; not given: as the file says, else mm")                               \
  ROW(T, REAL, resolution, NAN, 0.02e-3, 5e-3, "m", "of a sample's vertices")                      \
  ROW(T, REAL, noise, NAN, 0, 2e-3, "m", "of a sample's vertices")                                 \
  ROW(T, SEED, sample_seed, 1, "of that noise")                                                    \
  ROW(T, FLAG, repair, true, "what is no closed surface; false: it is refused")                    \
  ROW(T, TEXT, triangles, "recommended (as `scree choose` does), all, or at most so many")         \
  ROW(T, TEXT, rp,                                                                                 \
      "or its level: this share of the triangles; recommended, or as 0.5*recommended a multiple; " \
      "scan; clump:20; spheres")                                                                   \
  ROW(T, WORD, method, 0, "volume|qecd", "of decimation")                                          \
  ROW(T, WORD, mass_from, 0, "mesh|scan",                                                          \
      "volume that gives the mass: of the decimated mesh, or of the scan at every level")          \
  ROW(T, TEXT, material, "")                                                                       \
  ROW(T, REAL, density, NAN, 1e-3, 1e6, "kg/m3", "another than its material's")                    \
  ROW(T, GROUP, size, scree_plan_size,                                                             \
      "of many sizes, each the diameter of the sphere of equal volume")                            \
  ROW(T, REAL, thickness, NAN, 1e-9, 1, "m", "of an open surface: a sheet, half to each side")     \
  ROW(T, GROUP, fracture, scree_plan_fracture, "it breaks into cells that joints hold")            \
  ROW(T, NAMED, parts, scree_plan_component, "that joints hold; of a file: those that it names")   \
  ROW(T, GROUP, joints, scree_plan_joints, "between parts, or between the spheres of a table")     \
  ROW(T, OWN, double scaled, scaled, NAN)                                                          \
  ROW(T, OWN, size_t family, family, 0)
SCREE_RECORD_TYPE(scree_plan_shape, SCREE_PLAN_SHAPE)

/* Spheres of the clump that stands for the shape's surface; 0: its clump is a table, or none. */
size_t scree_plan_spheres(const scree_plan_shape *shape);

#define SCREE_PLAN_TURN(ROW, T)                                                                    \
  ROW(T, DIRECTION, axis, (0, 0, 1), "")                                                           \
  ROW(T, REAL, angle_deg, 0, -360, 360, "deg", "right-handed about the axis")
SCREE_RECORD_TYPE(scree_plan_turn, SCREE_PLAN_TURN)

/* A cylinder, of geometry and as the region of an inlet. */
#define SCREE_PLAN_CYLINDER(ROW, T)                                                                \
  ROW(T, REAL, radius, NAN, 1e-9, 1e6, "m",                                                        \
      "inside; of geometry with layers in it not given: as wide as what they pour will be high")   \
  ROW(T, REAL, length, 0, 0, 1e6, "m", "along the axis; of geometry 0: endless")                   \
  ROW(T, DIRECTION, axis, (0, 0, 1), "")                                                           \
  ROW(T, VECTOR, at, SCREE_NONE, -1e6, 1e6, "m", "of a region: the middle of the end it begins at")
SCREE_RECORD_TYPE(scree_plan_cylinder, SCREE_PLAN_CYLINDER)

#define SCREE_PLAN_BOX(ROW, T)                                                                     \
  ROW(T, VECTOR, min, SCREE_NONE, -1e6, 1e6, "m", "corner")                                        \
  ROW(T, VECTOR, max, SCREE_NONE, -1e6, 1e6, "m", "opposite corner")
SCREE_RECORD_TYPE(scree_plan_box, SCREE_PLAN_BOX)

/* A motion is of one kind; they stand in scene/motions. */
#define SCREE_PLAN_MOTION(ROW, T)                                                                  \
  SCREE_MOTION_KINDS(ROW, T)                                                                       \
  SCREE_PLAN_WINDOW(ROW, T)                                                                        \
  ROW(T, TEXT, during, "a phase: only while it lasts")
SCREE_RECORD_TYPE(scree_plan_motion, SCREE_PLAN_MOTION)

/* Keeps a force (N) or torque (N m) on bodies. */
#define SCREE_PLAN_SERVO(ROW, T)                                                                   \
  ROW(T, REAL, force, NAN, -1e12, 1e12, "N", "on bodies, along the slide")                         \
  ROW(T, REAL, speed, NAN, 1e-9, 1e3, "m/s", "at most")
SCREE_RECORD_TYPE(scree_plan_servo, SCREE_PLAN_SERVO)

#define SCREE_PLAN_TURNING_SERVO(ROW, T)                                                           \
  ROW(T, AS, "torque", REAL, force, NAN, -1e12, 1e12, "N m", "on bodies, about the hinge")         \
  ROW(T, REAL, speed, NAN, 1e-9, 1e4, "rad/s", "at most")
SCREE_RECORD_LIKE(scree_plan_servo, scree_plan_turning_servo);

/* What moves by forces along one coordinate, a slide (m) or a hinge (rad). */
#define SCREE_PLAN_HINGE(ROW, T)                                                                   \
  ROW(T, DIRECTION, axis, (0, 0, 1), "")                                                           \
  ROW(T, VECTOR, through, SCREE_ZERO, -1e6, 1e6, "m", "a point of the axis")                       \
  ROW(T, REAL, inertia, NAN, 1e-15, 1e15, "kg m2", "about the axis")                               \
  ROW(T, REAL, mass, 0, 0, 1e12, "kg", "for its weight")                                           \
  ROW(T, VECTOR, centre, SCREE_NONE, -1e6, 1e6, "m",                                               \
      "of mass, at the start; not given: on the axis")                                             \
  ROW(T, REAL, spring, 0, 0, 1e15, "N m/rad", "")                                                  \
  ROW(T, REAL, rest, 0, -1e6, 1e6, "rad", "angle at which the spring is loose")                    \
  ROW(T, REAL, damper, 0, 0, 1e15, "N m s/rad", "")                                                \
  ROW(T, AS, "torque", REAL, force, 0, -1e12, 1e12, "N m", "that drives it")                       \
  ROW(T, REAL, amplitude, 0, 0, 1e12, "N m", "of a torque that swings besides")                    \
  ROW(T, REAL, frequency, 0, 0, 1e5, "Hz", "")                                                     \
  ROW(T, REAL, from, 0, 0, 1e9, "s", "held until then")                                            \
  ROW(T, REAL, least, NAN, -1e6, 1e6, "rad", "where it stops; not given: nowhere")                 \
  ROW(T, REAL, most, NAN, -1e6, 1e6, "rad", "likewise")                                            \
  ROW(T, GROUP, servo, scree_plan_turning_servo, "instead of inertia and torques")
SCREE_RECORD_TYPE(scree_plan_hinge, SCREE_PLAN_HINGE)

#define SCREE_PLAN_SLIDE(ROW, T)                                                                   \
  ROW(T, AS, "along", DIRECTION, axis, (0, 0, 1), "")                                              \
  ROW(T, REAL, mass, NAN, 1e-9, 1e12, "kg", "")                                                    \
  ROW(T, REAL, spring, 0, 0, 1e15, "N/m", "")                                                      \
  ROW(T, REAL, rest, 0, -1e6, 1e6, "m", "way at which the spring is loose")                        \
  ROW(T, REAL, damper, 0, 0, 1e15, "N s/m", "")                                                    \
  ROW(T, REAL, force, 0, -1e12, 1e12, "N", "that drives it")                                       \
  ROW(T, REAL, amplitude, 0, 0, 1e12, "N", "of a force that swings besides")                       \
  ROW(T, REAL, frequency, 0, 0, 1e5, "Hz", "")                                                     \
  ROW(T, REAL, from, 0, 0, 1e9, "s", "held until then")                                            \
  ROW(T, REAL, least, NAN, -1e6, 1e6, "m", "where it stops; not given: nowhere")                   \
  ROW(T, REAL, most, NAN, -1e6, 1e6, "m", "likewise")                                              \
  ROW(T, GROUP, servo, scree_plan_servo, "instead of mass and forces")
SCREE_RECORD_LIKE(scree_plan_hinge, scree_plan_slide);
typedef scree_plan_hinge scree_plan_part; /* either */

/* The surface of closed loops about an axis runs along itself. */
#define SCREE_PLAN_BELT(ROW, T)                                                                    \
  ROW(T, DIRECTION, axis, (0, 1, 0), "of its pulleys")                                             \
  ROW(T, REAL, speed, NAN, -1e3, 1e3, "m/s", "along itself; above 0 right-handed about the axis")
SCREE_RECORD_TYPE(scree_plan_belt, SCREE_PLAN_BELT)

/* Copies at equal ways round two wheels `span` apart, of which one is at `through`, from the strand
 * that leads to the other on; without a span about the axis. */
#define SCREE_PLAN_ROUND(ROW, T)                                                                   \
  ROW(T, COUNT, count, 0, 1, 1000, "of all, at equal distances")                                   \
  ROW(T, DIRECTION, axis, (0, 0, 1), "about which they stand")                                     \
  ROW(T, VECTOR, through, SCREE_ZERO, -1e6, 1e6, "m", "a point of it")                             \
  ROW(T, VECTOR, span, SCREE_ZERO, -1e6, 1e6, "m",                                                 \
      "of a chain: from the wheel there to the other; the first copy begins the strand along it")  \
  ROW(T, REAL, radius, NAN, 1e-9, 1e6, "m", "of the wheels, to the chain")
SCREE_RECORD_TYPE(scree_plan_round, SCREE_PLAN_ROUND)

/* Geometry is of one kind; they stand in scene/geometry. */
#define SCREE_PLAN_GEOMETRY(ROW, T)                                                                \
  SCREE_GEOMETRY_KINDS(ROW, T)                                                                     \
  ROW(T, WORD, unit, 2, SCREE_PLAN_UNITS, "of the file's lengths")                                 \
  ROW(T, VECTOR, at, SCREE_ZERO, -1e6, 1e6, "m", "where its origin goes")                          \
  ROW(T, GROUP, turn, scree_plan_turn, "about its origin, before it goes there")                   \
  ROW(T, WORD, side, 0, "auto|outside|inside|both",                                                \
      "of a closed mesh or box: where bodies are; auto: where the inlets are")                     \
  ROW(T, TEXT, material, "")                                                                       \
  ROW(T, GROUP, copies, scree_plan_round, "of it, about an axis or along a chain")                 \
  ROW(T, LIST, motion, scree_plan_motion, "in this order")                                         \
  ROW(T, GROUP, slide, scree_plan_slide, "moved by forces along a direction")                      \
  ROW(T, GROUP, hinge, scree_plan_hinge, "turned by forces about an axis")                         \
  ROW(T, VECTOR, surface_velocity, SCREE_NONE, -1e3, 1e3, "m/s",                                   \
      "of a belt that stays where it is")                                                          \
  ROW(T, GROUP, belt, scree_plan_belt,                                                             \
      "of a file or loop that is closed about an axis: its surface runs round")
SCREE_RECORD_TYPE(scree_plan_geometry, SCREE_PLAN_GEOMETRY)

#define SCREE_PLAN_LAYERS(ROW, T)                                                                  \
  ROW(T, WORD, packed, 0, "random|grid",                                                           \
      "as many as random places hold, or one in every cell of a square grid")                      \
  ROW(T, REAL, pack_time, NAN, 0, 1e6, "s",                                                        \
      "in which all enter; not given: each layer as the one before has made room by falling")      \
  ROW(T, TEXT, in,                                                                                 \
      "a cylinder or shaft that they fill, in place of a box or cylinder of their own")            \
  ROW(T, WORD, begin, 0, "heap|top",                                                               \
      "in it: from near its bottom, or above where all will lie loosely")                          \
  ROW(T, REAL, bottom, NAN, 0, 1e6, "m",                                                           \
      "from near its bottom: height of the first; not given: as `above`")                          \
  ROW(T, REAL, above, 0, 0, 1e3, "m", "the highest body, at least")                                \
  ROW(T, REAL, clearance, NAN, 0, 1e3, "m",                                                        \
      "kept free around a body; not given: half a hundredth of the mean size")
SCREE_RECORD_TYPE(scree_plan_layers, SCREE_PLAN_LAYERS)

#define SCREE_PLAN_INLET(ROW, T)                                                                   \
  ROW(T, GROUP, box, scree_plan_box, "bodies begin wholly inside")                                 \
  ROW(T, GROUP, cylinder, scree_plan_cylinder, "likewise")                                         \
  ROW(T, WEIGHTS, shapes, 0, 1e12, "", "and their shares by number")                               \
  ROW(T, REAL, rate, NAN, 0, 1e9, "1/s", "bodies a second")                                        \
  ROW(T, REAL, mass_rate, NAN, 0, 1e9, "kg/s", "or mass a second")                                 \
  ROW(T, COUNT, count, 0, 1, 1e9, "at most so many; without a rate as soon as there is room")      \
  SCREE_PLAN_WINDOW(ROW, T)                                                                        \
  ROW(T, VECTOR, velocity, SCREE_ZERO, -1e3, 1e3, "m/s", "on entering")                            \
  ROW(T, WORD, orientation, 0, "random|fixed", "fixed: axes as in the shape's file")               \
  ROW(T, GROUP, layers, scree_plan_layers,                                                         \
      "batches, each above all that is there; the region is what they cover and where they begin")
SCREE_RECORD_TYPE(scree_plan_inlet, SCREE_PLAN_INLET)

#define SCREE_PLAN_OUTLET(ROW, T)                                                                  \
  ROW(T, GROUP, box, scree_plan_box, "bodies whose centre is inside are taken out")                \
  SCREE_PLAN_WINDOW(ROW, T)
SCREE_RECORD_TYPE(scree_plan_outlet, SCREE_PLAN_OUTLET)

#define SCREE_PLAN_DOMAIN(ROW, T)                                                                  \
  ROW(T, VECTOR, min, SCREE_NONE, -1e9, 1e9, "m", "corner")                                        \
  ROW(T, VECTOR, max, SCREE_NONE, -1e9, 1e9, "m", "opposite corner")                               \
  ROW(T, TEXTS, periodic, "axes along which what leaves enters again")
SCREE_RECORD_TYPE(scree_plan_domain, SCREE_PLAN_DOMAIN)

/* A sensor is of one kind; they stand in scene/sensors. */
#define SCREE_PLAN_SENSOR(ROW, T)                                                                  \
  SCREE_SENSOR_KINDS(ROW, T)                                                                       \
  ROW(T, REAL, from, 0, 0, 1e9, "s", "what comes before is neither gathered nor in means")         \
  ROW(T, REAL, until, NAN, 0, 1e9, "s", "nor what comes after; not given: all")
SCREE_RECORD_TYPE(scree_plan_sensor, SCREE_PLAN_SENSOR)

/* law: 0 Schiller and Naumann, 1 Stokes */
#define SCREE_PLAN_DRAG(ROW, T)                                                                    \
  ROW(T, REAL, density, NAN, 0, 1e6, "kg/m3", "of the fluid")                                      \
  ROW(T, REAL, viscosity, NAN, 1e-12, 1e9, "Pa s", "dynamic")                                      \
  ROW(T, VECTOR, velocity, (0, 0, 0), -1e3, 1e3, "m/s", "of the fluid")                            \
  ROW(T, WORD, law, 0, "schiller-naumann|stokes", "of a sphere of equal volume")                   \
  ROW(T, FLAG, buoyancy, true, "the weight of the fluid lifts")
SCREE_RECORD_TYPE(scree_plan_drag, SCREE_PLAN_DRAG)

/* One of force, acceleration, per_volume, drag. */
#define SCREE_PLAN_FORCE(ROW, T)                                                                   \
  ROW(T, TEXTS, of, "shapes or materials; not given: all")                                         \
  ROW(T, GROUP, box, scree_plan_box, "where; not given: everywhere")                               \
  ROW(T, GROUP, cylinder, scree_plan_cylinder, "likewise")                                         \
  SCREE_PLAN_WINDOW(ROW, T)                                                                        \
  ROW(T, VECTOR, force, SCREE_NONE, -1e12, 1e12, "N", "on each body")                              \
  ROW(T, VECTOR, acceleration, SCREE_NONE, -1e9, 1e9, "m/s2", "times its mass")                    \
  ROW(T, VECTOR, per_volume, SCREE_NONE, -1e15, 1e15, "N/m3", "times its volume")                  \
  ROW(T, GROUP, drag, scree_plan_drag, "of a fluid")                                               \
  ROW(T, WORD, by, 0, "x|y|z|t", "of the table (m or s)")                                          \
  ROW(T, TABLE, table, 0, 0, "|",                                                                  \
      "[where or when, factor] of the force or of the fluid's velocity, linear between")
SCREE_RECORD_TYPE(scree_plan_force, SCREE_PLAN_FORCE)

#define SCREE_PLAN_STOP(ROW, T)                                                                    \
  ROW(T, REAL, still, NAN, 0, 1e9, "J", "all have entered and move with less energy a body")       \
  ROW(T, REAL, rest, NAN, 0, 1e9, "s", "for so long; not given: for ten ticks")                    \
  ROW(T, REAL, filled, NAN, 0, 1e9, "s", "so long after all have entered")                         \
  ROW(T, FLAG, empty, false, "all have entered and left")                                          \
  ROW(T, REAL, after, 0, 0, 1e9, "s", "not before")
SCREE_RECORD_TYPE(scree_plan_stop, SCREE_PLAN_STOP)

#define SCREE_PLAN_PHASE(ROW, T)                                                                   \
  ROW(T, REAL, time, NAN, 0, 1e9, "s", "it lasts, at most")                                        \
  ROW(T, FLAG, filled, false, "it lasts until all have entered, however long")                     \
  ROW(T, REAL, still, NAN, 0, 1e9, "J", "it ends early when all move with less energy a body")     \
  ROW(T, REAL, rest, 0.1, 0, 1e9, "s", "for so long")                                              \
  ROW(T, FLAG, early, true, "false: `still` does not end it")                                      \
  ROW(T, TEXT, clear, "a geometry: it ends early only when that is above all bodies")
SCREE_RECORD_TYPE(scree_plan_phase, SCREE_PLAN_PHASE)

#define SCREE_PLAN_OUTPUT(ROW, T)                                                                  \
  ROW(T, REAL, frames, 0, 0, 1e9, "s", "between files for ParaView; 0: none")                      \
  ROW(T, WORD, bodies, 0, "instances|surfaces",                                                    \
      "of files for ParaView: a point for each, and each shape once; or all their triangles")      \
  ROW(T, REAL, series, 0.01, 1e-9, 1e9, "s", "between the lines of series.csv")                    \
  ROW(T, REAL, motion, 0, 0, 1e9, "s", "between moments of report.html; 0: a 240th of the time")   \
  ROW(T, REAL, checkpoint, 60, 0.01, 1e9, "s", "of the clock")
SCREE_RECORD_TYPE(scree_plan_output, SCREE_PLAN_OUTPUT)

#define SCREE_PLAN_BODIES(ROW, T) ROW(T, TEXT, file, "a table with a line for each")
SCREE_RECORD_TYPE(scree_plan_bodies, SCREE_PLAN_BODIES)

#define SCREE_PLAN_CONTACT(ROW, T)                                                                 \
  ROW(T, WORD, law, 0, "linear|hysteretic|hertz", "docs/background/physics.md")                    \
  ROW(T, REAL, steps, 20, 15, 1e6, "", "time steps in a quarter of the fastest contact's period")  \
  ROW(T, REAL, stiffness_factor, 1, 1e-9, 1e9, "",                                                 \
      "multiplies every stiffness: below 1 steps are longer and overlaps deeper")                  \
  ROW(T, REAL, tangential_ratio, 1, 1e-6, 1, "", "tangential over normal stiffness")               \
  ROW(T, WORD, rolling, 0, "couple|epsd", "what rolling_friction limits; epsd: as LIGGGHTS does")  \
  ROW(T, REAL, time_step, 0, 0, 1, "s", "0: by steps")
SCREE_RECORD_TYPE(scree_plan_contact, SCREE_PLAN_CONTACT)

/* A name for fields that are set together. */
#define SCREE_PLAN_PARAMETER(ROW, T)                                                               \
  ROW(T, TEXT, name, "")                                                                           \
  ROW(T, TEXT, was, "what it was called before: who says that is told the name")                   \
  ROW(T, TEXTS, sets, "fields; * is every name of a group")                                        \
  ROW(T, REAL, factor, NAN, -1e9, 1e9, "", "times the value")                                      \
  ROW(T, REAL, least, NAN, -1e300, 1e300, "", "of the value")                                      \
  ROW(T, REAL, most, NAN, -1e300, 1e300, "", "")                                                   \
  ROW(T, REAL, below, NAN, 1e-9, 1e3, "m",                                                         \
      "where the largest shape is smaller, the fields shrink")                                     \
  ROW(T, REAL, size, NAN, 1e-9, 1e3, "m", "or they are for shapes of this mean size, and scale")   \
  ROW(T, REAL, power, NAN, 0, 10, "",                                                              \
      "of the share of that size that they change by; 0, once they are set: they do not")          \
  ROW(T, REAL, scales, NAN, 0, 10, "", "the power that a preset with a size gives them")
SCREE_RECORD_TYPE(scree_scene_parameter, SCREE_PLAN_PARAMETER)

#define SCREE_PLAN_PRESET(ROW, T)                                                                  \
  ROW(T, TEXT, name, "")                                                                           \
  ROW(T, TEXT, about, "")                                                                          \
  ROW(T, REAL, size, NAN, 1e-9, 1e3, "m", "of the particles that its values are for")              \
  ROW(T, VALUES, set, "values of parameters and fields")
SCREE_RECORD_TYPE(scree_plan_preset, SCREE_PLAN_PRESET)

#define SCREE_PLAN_SCENE(ROW, T)                                                                   \
  ROW(T, TEXT, title, "")                                                                          \
  ROW(T, TEXT, preset, "of those below, whose values it has")                                      \
  ROW(T, REAL, time, NAN, 1e-9, 1e9, "s", "simulated, at most")                                    \
  ROW(T, SEED, seed, 1, "of places, orientations and order")                                       \
  ROW(T, VECTOR, gravity, (0, 0, -9.81), -1e3, 1e3, "m/s2", "")                                    \
  ROW(T, COUNT, tick, 0, 1, 1e6,                                                                   \
      "steps between looks at inlets, outlets, flows and the end; not given: by the bodies' size") \
  ROW(T, GROUP, contact, scree_plan_contact, "")                                                   \
  ROW(T, NAMED, materials, scree_plan_material, "")                                                \
  ROW(T, LIST, pairs, scree_plan_pair, "")                                                         \
  ROW(T, NAMED, shapes, scree_plan_shape, "")                                                      \
  ROW(T, NAMED, geometry, scree_plan_geometry, "")                                                 \
  ROW(T, GROUP, bodies, scree_plan_bodies, "that are there from the start")                        \
  ROW(T, NAMED, inlets, scree_plan_inlet, "")                                                      \
  ROW(T, NAMED, outlets, scree_plan_outlet, "")                                                    \
  ROW(T, GROUP, domain, scree_plan_domain, "what leaves it is taken out")                          \
  ROW(T, NAMED, sensors, scree_plan_sensor, "")                                                    \
  ROW(T, NAMED, forces, scree_plan_force, "on bodies")                                             \
  ROW(T, NAMED, phases, scree_plan_phase, "follow each other; after the last the scene ends")      \
  ROW(T, GROUP, stop, scree_plan_stop, "what ends it before its time")                             \
  ROW(T, GROUP, output, scree_plan_output, "")                                                     \
  ROW(T, LIST, parameters, scree_scene_parameter, "names for fields set together")                 \
  ROW(T, LIST, presets, scree_plan_preset, "values for many")                                      \
  ROW(T, OWN, scree_plan_shape_list families, families, {0})
SCREE_RECORD_TYPE(scree_plan, SCREE_PLAN_SCENE)

/* sensors.c: names that sensors refer to, regions, what each kind checks. */
scree_status scree_plan_check_sensors(const scree_reader *reader, const scree_plan *plan);
/* plan_check.c: of a whole scree_plan, whose records are good each. */
scree_status scree_plan_check(const scree_reader *reader, const void *plan);

/* sizes.c: a class of a distribution of sizes. */
typedef struct scree_size_class {
  double size, share; /* m, the diameter of the sphere of equal volume; by number, all together 1 */
} scree_size_class;
/* The classes, in the arena, of as much mass and number as the distribution has in them. NULL: no
 * memory. */
scree_size_class *scree_plan_size_classes(const scree_plan_size *size, scree_arena *arena,
                                          size_t *count);
/* A shape of many sizes becomes one for each class, in inlets by its share. */
scree_status scree_plan_expand(scree_plan *plan, scree_arena *arena, scree_error *error);

/* Reads and checks it all but the files it names. */
scree_status scree_plan_read(const scree_reader *reader, const scree_yaml *root, scree_plan *plan);

/* Index of the record of that name in a list of records; its count where there is none. */
#define SCREE_PLAN_FIND(list, name)                                                                \
  scree_plan_find((list).items, (list).count, sizeof *(list).items, name)
size_t scree_plan_find(const void *items, size_t count, size_t size, const char *name);
/* The name of one; NULL past the last. */
#define SCREE_PLAN_NAME(list, index)                                                               \
  ((index) < (list).count ? (list).items[index].place.name : NULL)
/* Metres of the unit. */
double scree_plan_unit(int unit);
