/* Joints: elastic, breakable bonds between bodies of a world. */
#ifndef SCREE_JOINTS_H
#define SCREE_JOINTS_H

#include "scree/fracture.h"
#include "scree/world.h"

#ifdef __cplusplus
extern "C" {
#endif

/* In place of a body: space, in which the joint holds the other. */
#define SCREE_SPACE SIZE_MAX

typedef enum scree_joint_state {
  SCREE_JOINT_WHOLE,
  SCREE_JOINT_CRACKED, /* broken, and still pressed together or not yet open all over its face */
  SCREE_JOINT_OPEN,    /* the two touch as any others */
  SCREE_JOINT_GONE,    /* a body of it was removed */
} scree_joint_state;

typedef enum scree_joint_mode {
  SCREE_JOINT_NOT_BROKEN,
  SCREE_JOINT_BY_TENSION, /* with bending */
  SCREE_JOINT_BY_SHEAR,   /* with torsion */
  SCREE_JOINT_BY_ENERGY,  /* by area */
} scree_joint_mode;

/* A plane section that holds two bodies. Its frame is (normal, axis, normal x axis): numbers by
 * component are in that order, of rotations about them: torsion, then bending. */
typedef struct scree_joint {
  size_t a, b;      /* bodies; b may be SCREE_SPACE */
  double centre[3]; /* m, in space as the two are now */
  double normal[3]; /* from a to b */
  double axis[3];   /* in the section, of its longer side; what is along the normal is left out */
  double stiffness[3]; /* N/m */
  double turning[3];   /* N m/rad */
  /* m^2; 0: no joint, but the two do not touch while they hang together, as bodies must that are
   * near each other without a common face: their rounded edges reach beyond their surfaces. */
  double area;
  double moduli[3]; /* m^3: a moment over it is the stress at the rim */
  double reach[2];  /* m, the farthest corner along `axis`, and across it */
  double damping;   /* share of critical of the two alone, in [0, 1]; default 0.05 */
  /* Broken where s + bending > tension, or shear + torsion > cohesion + friction max(0, -s), s the
   * mean normal stress, Pa; or where its energy by area passes toughness, J/m2. 0: never so. */
  double tension, cohesion, friction, toughness;
} scree_joint;
SCREE_API scree_joint scree_default_joint(void);

/* What stiffnesses follow from. */
typedef enum scree_section_kind {
  SCREE_SECTION_SOLID, /* faces of a fracture: the body has E, and Poisson's ratio 0 */
  SCREE_SECTION_SHEET, /* of a plate with E and nu */
  SCREE_SECTION_BAR,   /* Timoshenko's beam of a rectangle or, with equal sides, also of a disc */
} scree_section_kind;

/* Fills frame, stiffness, area, moduli and reach of a joint from a face of a fracture, in its
 * body's space: the solid that it was, of this Young's modulus (Pa). */
SCREE_API void scree_joint_of_face(const scree_fracture_face *face, double young,
                                   scree_joint *joint);
/* Stiffness, area, moduli and reach of a rectangle, `width` along the joint's axis and `thickness`
 * across it, m, between bodies whose centres (of a plate: middles) are `distance` apart. */
SCREE_API void scree_joint_of_rectangle(scree_section_kind kind, double young, double poisson,
                                        double width, double thickness, double distance,
                                        scree_joint *joint);
/* The same of a wire, by its radius. */
SCREE_API void scree_joint_of_wire(double young, double poisson, double radius, double distance,
                                   scree_joint *joint);

/* The two are held as they are now, free of stress. Bodies that are joined do not touch each other;
 * once the joint is open they do, from the overlap that there is then. SCREE_BAD_ARGUMENT for a
 * body that is not there, joined with itself, or a number that is not finite or of the wrong sign.
 */
SCREE_API scree_status scree_world_add_joint(scree_world *world, const scree_joint *joint,
                                             size_t *index, scree_error *error);
SCREE_API size_t scree_world_joint_count(const scree_world *world);

typedef struct scree_joint_observation {
  size_t a, b;
  scree_joint_state state;
  scree_joint_mode mode;
  double area;        /* m^2; 0: it only keeps the two from touching */
  double position[3]; /* m, in the middle of the two faces */
  double force[3];    /* N, on b, along normal, axis and across: tension is below 0 */
  double moment[3];   /* N m, on b, about them */
  double load;        /* what of its strength is used, 1: it breaks; of one that broke, 1 */
  double energy;      /* J, elastic */
  double fracture;    /* J that its break freed */
  double broke_at;    /* s; NaN: it has not */
} scree_joint_observation;
SCREE_API void scree_world_observe_joint(const scree_world *world, size_t index,
                                         scree_joint_observation *observation);

/* Numbers the fragments, bodies that hang together by whole joints, from 0 in the order of their
 * first bodies; of a removed body SIZE_MAX. fragments: as long as there are bodies. Answers how
 * many there are. */
SCREE_API size_t scree_world_fragments(const scree_world *world, size_t *fragments);

#ifdef __cplusplus
}
#endif
#endif
