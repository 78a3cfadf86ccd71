/* A clump as the input of another DEM code: its spheres about the centre of mass, along the
 * principal axes, with mass and inertia, and a script that lets some fall into a box. Formats by
 * the codes' manuals: LAMMPS `molecule` and `fix rigid/small`, LIGGGHTS `fix
 * particletemplate/multisphere`, YADE `appendClumped`, PFC `clump template create`, Chrono
 * DEM-Engine `LoadClumpType`; EDEM's page "Add Multi-Sphere Particles" (a table of spheres about
 * the origin along the principal axes, to be pasted); MFiX by what its generator of glued spheres
 * writes as gsp_config.csv. */
#include "base/file.h"
#include "base/path.h"
#include "base/vec.h"
#include "report/program.h"

#include <string.h>

/* What all the writers need. */
typedef struct clump_job {
  const scree_particle *particle;
  const scree_code_options *options;
  scree_particle_measures m;
  double mass, inertia[3];
  double width, height; /* of the script's box, m */
  double young;         /* Pa */
  double time_step;     /* s */
  double damping;       /* LAMMPS's gamma_n, 1/(m s) */
  char name[128];       /* letters, digits, points, - and _ */
} clump_job;

static const double pi = 3.14159265358979323846;

/* Of the scripts, to be edited there. */
static const double poisson = 0.3, friction = 0.5, gravity = 9.81;

static scree_sphere sphere_of(const clump_job *j, size_t index) {
  scree_sphere s;
  scree_particle_point(j->particle, index, s.centre, &s.radius);
  return s;
}

static double least_radius(const clump_job *j) {
  double least = INFINITY;
  for (size_t i = 0; i < j->m.point_count; i++) least = fmin(least, sphere_of(j, i).radius);
  return least;
}

/* A third of the critical damping at an overlap of 2 % of the radius: Hertz's stiffness is E
 * sqrt(overlap radius), and the damping gamma m sqrt(overlap radius). */
static double damping_rate(const clump_job *j, double least) {
  return 2. / 3 * sqrt(j->young / (j->mass * sqrt(0.02) * least));
}

/* So that a sphere of the body's volume that falls from the script's height presses itself a tenth
 * of its radius into the floor (Hertz: overlap = (15 m v2 / (16 E* sqrt(r)))^(2/5)): softer bodies
 * of any size would fall through it, and stiffer ones take more steps. */
static double softened_modulus(const clump_job *j) {
  const double share = 0.1, speed2 = 2 * gravity * j->height;
  double plane = 15. / 16 * (4. / 3 * pi) * j->options->density * speed2 / pow(share, 2.5);
  return fmax(1e6, plane * (1 - poisson * poisson));
}

/* A tenth of Rayleigh's time of the smallest sphere (Li, Xu, Thornton 2005). */
static double rayleigh_step(const clump_job *j, double least) {
  double shear = j->young / (2 * (1 + poisson));
  return 0.1 * pi * least * sqrt(j->options->density / shear) / (0.1631 * poisson + 0.8766);
}

/* Other characters mean something in one of the scripts; of UTF-8 one stands for all its bytes. */
static void name_files(clump_job *j) {
  static const char allowed[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-.";
  size_t used = 0;
  for (const char *c = j->options->name; *c && used + 1 < sizeof j->name; c++) {
    if (((unsigned char)*c & 0xc0) == 0x80) continue;
    bool is_kept = strchr(allowed, *c) && (used || (*c != '-' && *c != '.'));
    j->name[used++] = is_kept ? *c : '_';
  }
}

static const char *modulus_source(const clump_job *j) {
  return j->options->young > 0 ? "as asked for"
                               : "softened, so that the fall presses a tenth of a radius";
}

static clump_job prepare(const scree_particle *particle, const scree_code_options *o) {
  clump_job j = {.particle = particle, .options = o};
  scree_particle_measure(particle, &j.m);
  j.mass = o->density * j.m.volume;
  for (int k = 0; k < 3; k++) j.inertia[k] = o->density * j.m.inertia[k];
  j.width = 4 * j.m.bounding_radius * ceil(cbrt((double)o->count)) / 2;
  j.height = 2 * j.m.bounding_radius * (2 + ceil(cbrt((double)o->count))) * 2;
  double least = least_radius(&j);
  j.young = o->young > 0 ? o->young : softened_modulus(&j);
  j.time_step = rayleigh_step(&j, least);
  j.damping = damping_rate(&j, least);
  name_files(&j);
  return j;
}

/* A line for each: x, y, z and the radius, with that between them. */
static void put_spheres(const clump_job *j, FILE *f, char between) {
  for (size_t i = 0; i < j->m.point_count; i++) {
    scree_sphere s = sphere_of(j, i);
    fprintf(f, "%.12g%c%.12g%c%.12g%c%.12g\n", s.centre[0], between, s.centre[1], between,
            s.centre[2], between, s.radius);
  }
}

/* ---- LAMMPS ---- */

static void put_molecule(const clump_job *j, FILE *f) {
  size_t n = j->m.point_count;
  double cubes = 0;
  fprintf(f,
          "# clump %s from scree %s: m, kg, about the centre of mass, along the principal axes\n\n",
          j->name, scree_version());
  fprintf(f, "%zu atoms\n%.12g mass\n0 0 0 com\n%.12g %.12g %.12g 0 0 0 inertia\n\nCoords\n\n", n,
          j->mass, j->inertia[0], j->inertia[1], j->inertia[2]);
  for (size_t i = 0; i < n; i++) {
    scree_sphere s = sphere_of(j, i);
    fprintf(f, "%zu %.12g %.12g %.12g\n", i + 1, s.centre[0], s.centre[1], s.centre[2]);
    cubes += s.radius * s.radius * s.radius;
  }
  fputs("\nTypes\n\n", f);
  for (size_t i = 0; i < n; i++) fprintf(f, "%zu 1\n", i + 1);
  fputs("\nDiameters\n\n", f);
  for (size_t i = 0; i < n; i++) fprintf(f, "%zu %.12g\n", i + 1, 2 * sphere_of(j, i).radius);
  fputs("\nMasses\n\n", f);
  for (size_t i = 0; i < n; i++) {
    double r = sphere_of(j, i).radius;
    fprintf(f, "%zu %.12g\n", i + 1, j->mass * r * r * r / cubes);
  }
}

/* Overlapping spheres would each take their own weight, about another centre than the body's:
 * gravity is of the bodies, by `disable` and the keyword of `rigid/small`. */
static void put_lammps_input(const clump_job *j, FILE *f) {
  double reach = j->m.bounding_radius;
  /* so many steps as a fall over three radii takes */
  double apart = ceil(sqrt(6 * reach / gravity) / j->time_step);
  double settling = 4 * ceil(sqrt(2 * j->height / gravity) / j->time_step);
  fprintf(f,
          "# lets %zu clumps fall into a box: lmp -in in.%s\n"
          "# Young's modulus %.3g Pa: %s\n"
          "variable young index %.6g\nvariable damping index %.6g\nvariable friction index %.6g\n"
          "variable down_x index 0\nvariable down_z index -1\n"
          "units si\natom_style sphere\natom_modify map array\nboundary f f f\nnewton off\n"
          "comm_modify vel yes cutoff %.6g\nregion box block %.6g %.6g %.6g %.6g 0 %.6g units box\n"
          "create_box 1 box\nfix body all property/atom mol ghost yes\nneighbor %.6g "
          "bin\nneigh_modify exclude molecule/intra all\n"
          "molecule clump %s.mol\n",
          j->options->count, j->name, j->young, modulus_source(j), j->young, j->damping, friction,
          2.5 * reach, -j->width / 2, j->width / 2, -j->width / 2, j->width / 2,
          j->height + 6 * reach, 0.1 * reach, j->name);
  fprintf(f,
          "pair_style gran/hertz/history ${young} NULL ${damping} NULL ${friction} 1\n"
          "pair_coeff * *\ntimestep %.6g\n"
          "fix gravity all gravity %.6g vector ${down_x} 0 ${down_z} disable\n",
          j->time_step, gravity);
  for (int k = 0; k < 2; k++)
    fprintf(f,
            "fix sides%d all wall/gran hertz/history ${young} NULL ${damping} NULL ${friction} 1 "
            "%cplane %.6g %.6g\n",
            k, "xy"[k], -j->width / 2, j->width / 2);
  fprintf(f,
          "fix floor all wall/gran hertz/history ${young} NULL ${damping} NULL ${friction} 1 "
          "zplane 0 NULL\n"
          "fix move all rigid/small molecule mol clump gravity gravity\n"
          "region top block %.6g %.6g %.6g %.6g %.6g %.6g units box\n"
          "fix fall all deposit %zu 0 %.0f 48271 region top mol clump rigid move attempt 1000\n"
          "compute bodies all rigid/local move id mass x y z vx vy vz omegax omegay omegaz "
          "inertiax inertiay inertiaz\n"
          "dump bodies all local %.0f bodies.dump index c_bodies[*]\n"
          "thermo %.0f\nthermo_style custom step atoms ke\nthermo_modify lost error\nrun %.0f\n",
          -j->width / 2 + reach, j->width / 2 - reach, -j->width / 2 + reach, j->width / 2 - reach,
          j->height, j->height + reach, j->options->count, apart, apart, apart,
          apart * (double)j->options->count + settling);
  fprintf(f,
          "variable there equal atoms\n"
          "if \"${there} != %zu\" then \"print 'only ${there} of %zu spheres are in the box'\" "
          "\"quit 1\"\n",
          j->options->count * j->m.point_count, j->options->count * j->m.point_count);
}

/* ---- LIGGGHTS ---- */

static void put_liggghts_input(const clump_job *j, FILE *f) {
  double w = j->width / 2, reach = j->m.bounding_radius;
  double least = 1e-3 * j->m.volume; /* what LIGGGHTS takes for none; its 1e-12 m3 are a grain */
  fprintf(f,
          "# lets %zu clumps fall into a box: liggghts -in in.%s\n"
          "# Young's modulus %.3g Pa: %s\n"
          "variable young index %.6g\nvariable friction index %.6g\n"
          "variable down_x index 0\nvariable down_z index -1\n"
          "units si\natom_style granular\natom_modify map array\nboundary f f f\nnewton off\n"
          "communicate single vel yes\nsoft_particles yes\nhard_particles yes\nregion box block "
          "%.6g %.6g %.6g %.6g %.6g %.6g units box\n"
          "create_box 1 box\nneighbor %.6g bin\nneigh_modify delay 0\n",
          j->options->count, j->name, j->young, modulus_source(j), j->young, friction, -w, w, -w, w,
          -reach, 3 * j->height, 0.1 * reach);
  fprintf(f,
          "fix m1 all property/global youngsModulus peratomtype ${young}\n"
          "fix m2 all property/global poissonsRatio peratomtype %.6g\n"
          "fix m3 all property/global coefficientRestitution peratomtypepair 1 0.3\n"
          "fix m4 all property/global coefficientFriction peratomtypepair 1 ${friction}\n"
          "pair_style gran model hertz tangential history\npair_coeff * *\ntimestep %.6g\n"
          "fix gravity all gravity %.6g vector ${down_x} 0 ${down_z}\n",
          poisson, j->time_step, gravity);
  fprintf(f,
          "fix floor all wall/gran model hertz tangential history primitive type 1 zplane 0.0\n"
          "fix left all wall/gran model hertz tangential history primitive type 1 xplane %.6g\n"
          "fix right all wall/gran model hertz tangential history primitive type 1 xplane %.6g\n"
          "fix front all wall/gran model hertz tangential history primitive type 1 yplane %.6g\n"
          "fix back all wall/gran model hertz tangential history primitive type 1 yplane %.6g\n",
          -w, w, -w, w);
  fprintf(f,
          "fix clump all particletemplate/multisphere 15485863 atom_type 1 volume_limit %.3g "
          "density constant %.6g nspheres %zu ntry 1000000 spheres file %s.txt scale 1.0 type 1 "
          "mass %.12g inertia_tensor %.12g 0 0 %.12g 0 %.12g use_volume\n"
          "fix mix all particledistribution/discrete 15485867 1 clump 1.0\n"
          "region top block %.6g %.6g %.6g %.6g %.6g %.6g units box volume_limit %.3g\n"
          "fix fall all insert/pack seed 32452843 distributiontemplate mix maxattempt 1000 "
          "insert_every once overlapcheck yes all_in yes vel constant 0 0 -0.1 orientation random "
          "region top particles_in_region %zu\n"
          "fix move all multisphere\n",
          least, j->options->density, j->m.point_count, j->name, j->mass, j->inertia[0],
          j->inertia[1], j->inertia[2], -w, w, -w, w, 0.1 * reach, 2.9 * j->height, least,
          j->options->count);
  fprintf(
      f,
      "compute mass all multisphere property masstotal\n"
      "compute place all multisphere property xcm\ncompute speed all multisphere property vcm\n"
      "compute spin all multisphere property omega\n"
      "compute moments all multisphere property inertia\n"
      "thermo 1000\nthermo_style custom step atoms ke\nthermo_modify lost error norm no\n"
      "run 1\nvariable there equal atoms\n"
      "if \"${there} != %zu\" then \"print 'only ${there} of %zu spheres are in the box'\" \"quit "
      "1\"\n"
      "dump bodies all local 1000 bodies.dump c_mass c_place[1] c_place[2] c_place[3] c_speed[1] "
      "c_speed[2] c_speed[3] c_spin[1] c_spin[2] c_spin[3] c_moments[1] c_moments[2] "
      "c_moments[3]\nrun %.0f\n"
      "if \"${there} != %zu\" then \"print 'only ${there} of %zu spheres are left'\" \"quit 1\"\n",
      j->options->count * j->m.point_count, j->options->count * j->m.point_count,
      ceil(4 * sqrt(2 * j->height / gravity) / j->time_step), j->options->count * j->m.point_count,
      j->options->count * j->m.point_count);
}

static void put_liggghts_spheres(const clump_job *j, FILE *f) {
  put_spheres(j, f, ' ');
}

/* ---- YADE ---- */

/* YADE works a clump's mass, centre and axes out from its members. So the spheres get next to none,
 * and the body's lies in six points that touch nothing, two on each principal axis, each a sixth of
 * the mass m: at sqrt(3 S / m) of an axis whose second moment is S. */
static void put_yade(const clump_job *j, FILE *f) {
  fprintf(f,
          "\"\"\"Clumps %s from scree %s: yade -n -x %s.py\n\n"
          "MASS, INERTIA: kg, kg m2, of the body; SPHERES: x, y, z, radius, m, about its centre of "
          "mass, along its\nprincipal axes. add_clump() may be called from other scripts.\n"
          "YOUNG: Pa, %s.\"\"\"\n"
          "from math import atan, pi\n\n"
          "MASS = %.12g\nINERTIA = (%.12g, %.12g, %.12g)\nSPHERES = [\n",
          j->name, scree_version(), j->name, modulus_source(j), j->mass, j->inertia[0],
          j->inertia[1], j->inertia[2]);
  for (size_t i = 0; i < j->m.point_count; i++) {
    scree_sphere s = sphere_of(j, i);
    fprintf(f, "    (%.12g, %.12g, %.12g, %.12g),\n", s.centre[0], s.centre[1], s.centre[2],
            s.radius);
  }
  fprintf(f,
          "]\nGRAVITY = Vector3(0, 0, -%.6g)\nSIZE, COUNT = %.6g, %zu\n"
          "DENSITY, YOUNG, POISSON, FRICTION = %.6g, %.6g, %.6g, %.6g\n",
          gravity, j->m.bounding_radius, j->options->count, j->options->density, j->young, poisson,
          friction);
  fputs(
      "POINT = 1e-3 * min(r for x, y, z, r in SPHERES)\n"
      "solid = dict(young=YOUNG, poisson=POISSON, frictionAngle=atan(FRICTION))\n"
      "light = O.materials.append(FrictMat(density=1e-12 * DENSITY, **solid))\n"
      "heavy = O.materials.append(FrictMat(density=MASS / 6 / (4 / 3 * pi * POINT**3), **solid))\n"
      "\n\n"
      "def add_clump(position, turn=Quaternion.Identity):\n"
      "    \"\"\"The spheres get next to no mass; the body's is in six points that touch "
      "nothing.\"\"\"\n"
      "    def ball(centre, radius, **more):\n"
      "        return sphere(Vector3(*position) + turn * Vector3(*centre), radius, **more)\n"
      "    members = [ball((x, y, z), r, material=light) for x, y, z, r in SPHERES]\n"
      "    for axis in range(3):\n"
      "        arm = (3 * max(0, sum(INERTIA) / 2 - INERTIA[axis]) / MASS) ** 0.5\n"
      "        for end in (-arm, arm):\n"
      "            members.append(ball(end * Vector3.Unit(axis), POINT, material=heavy, mask=0))\n"
      "    return O.bodies.appendClumped(members, discretization=0)[0]\n\n\n",
      f);
  fputs("clumps = []\n"
        "side = 1\n"
        "while side**3 < COUNT:\n    side += 1\n"
        "for n in range(COUNT):\n"
        "    cell = (n % side, n // side % side, n // side**2)\n"
        "    turn = Quaternion(Vector3(1, 2, 3).normalized(), n)\n"
        "    clumps.append(add_clump([2.1 * SIZE * (c + 0.5) for c in cell], turn))\n"
        "O.bodies.append(utils.wall(0, axis=2, sense=1, material=light))\n"
        "for axis in (0, 1):\n"
        "    O.bodies.append(utils.wall(0, axis=axis, sense=1, material=light))\n"
        "    O.bodies.append(utils.wall(2.1 * SIZE * side, axis=axis, sense=-1, material=light))\n"
        "O.engines = [\n"
        "    ForceResetter(),\n"
        "    InsertionSortCollider([Bo1_Sphere_Aabb(), Bo1_Wall_Aabb()]),\n"
        "    InteractionLoop([Ig2_Sphere_Sphere_ScGeom(), Ig2_Wall_Sphere_ScGeom()], "
        "[Ip2_FrictMat_FrictMat_FrictPhys()],\n"
        "                    [Law2_ScGeom_FrictPhys_CundallStrack()]),\n"
        "    NewtonIntegrator(damping=0.3, dampGravity=False, gravity=GRAVITY),\n"
        "]\n",
        f);
  fprintf(f,
          "O.dt = 0.3 * min(r for x, y, z, r in SPHERES) * (DENSITY / YOUNG) ** 0.5\n"
          "STEPS = int(6 * (2 * SIZE / %.6g) ** 0.5 / O.dt)\n"
          "O.run(STEPS, True)\n"
          "states = [O.bodies[c].state for c in clumps]\n"
          "print(f'{len(clumps)} clumps of {states[0].mass:.6g} kg, '\n"
          "      f'{O.interactions.countReal()} contacts after {O.time:.4g} s, '\n"
          "      f'lowest centre {min(s.pos[2] for s in states):.4g} m')\n",
          gravity);
}

/* ---- PFC and Chrono ---- */

static void put_pfc(const clump_job *j, FILE *f) {
  fprintf(
      f,
      "; clump %s from scree %s: volume in m3, inertia for density 1; pebbles: radius, x, y, z\n"
      "clump template create ...\n    name '%s' ...\n    pebbles %zu ...\n",
      j->name, scree_version(), j->name, j->m.point_count);
  for (size_t i = 0; i < j->m.point_count; i++) {
    scree_sphere s = sphere_of(j, i);
    fprintf(f, "%.12g %.12g %.12g %.12g ...\n", s.radius, s.centre[0], s.centre[1], s.centre[2]);
  }
  fprintf(f, "    volume %.12g ...\n    inertia %.12g %.12g %.12g 0 0 0\n", j->m.volume,
          j->m.inertia[0], j->m.inertia[1], j->m.inertia[2]);
}

static void put_chrono(const clump_job *j, FILE *f) {
  fprintf(f,
          "# clump %s from scree %s: kg, kg m2, m\n"
          "def load_clump(solver, material):\n"
          "    return solver.LoadClumpType(%.12g, [%.12g, %.12g, %.12g], \"%s.csv\", material)\n",
          j->name, scree_version(), j->mass, j->inertia[0], j->inertia[1], j->inertia[2], j->name);
}

static void put_chrono_spheres(const clump_job *j, FILE *f) {
  fputs("x,y,z,r\n", f);
  put_spheres(j, f, ',');
}

/* ---- EDEM and MFiX ---- */

static void put_edem(const clump_job *j, FILE *f) {
  fputs("X (m)\tY (m)\tZ (m)\tRadius (m)\n", f);
  put_spheres(j, f, '\t');
}

/* The share of a sphere's surface that lies in no other, by points on a spiral. */
static double exposed_share(const clump_job *j, size_t index) {
  enum { POINTS = 1000 };
  size_t exposed = 0;
  scree_sphere own = sphere_of(j, index);
  for (int k = 0; k < POINTS; k++) {
    double z = 1 - (2 * k + 1.) / POINTS, ring = sqrt(1 - z * z), turn = 2.399963229728653 * k;
    vec3 p =
        vec3_mad(vec3_load(own.centre), (vec3){ring * cos(turn), ring * sin(turn), z}, own.radius);
    bool covered = false;
    for (size_t i = 0; i < j->m.point_count && !covered; i++) {
      scree_sphere other = sphere_of(j, i);
      vec3 d = vec3_sub(p, vec3_load(other.centre));
      covered = i != index && vec3_dot(d, d) < other.radius * other.radius;
    }
    exposed += !covered;
  }
  return (double)exposed / POINTS;
}

/* In diameters of the bounding sphere. Heat flows between neighbours: none are named. */
static void put_mfix(const clump_job *j, FILE *f) {
  double size = 2 * j->m.bounding_radius;
  fputs("#version = 1\n"
        "x,y,z,rel_d,rel_sa,w,e,s,n,t,b,w_na,e_na,s_na,n_na,t_na,b_na,pid\n",
        f);
  for (size_t i = 0; i < j->m.point_count; i++) {
    scree_sphere s = sphere_of(j, i);
    double r = s.radius;
    fprintf(f, "%.12g,%.12g,%.12g,%.12g,%.12g,-1,-1,-1,-1,-1,-1,0,0,0,0,0,0,1\n",
            s.centre[0] / size, s.centre[1] / size, s.centre[2] / size, 2 * r / size,
            4 * pi * r * r / (size * size) * exposed_share(j, i));
  }
}

/* ---- All of them ---- */

/* The files of each: what stands before and behind the clump's name. */
static const struct {
  const char *name;
  struct {
    const char *before, *behind;
    void (*put)(const clump_job *job, FILE *stream);
  } files[2];
} codes[SCREE_DEM_CODE_COUNT] = {
    [SCREE_DEM_LAMMPS] = {"lammps", {{"", ".mol", put_molecule}, {"in.", "", put_lammps_input}}},
    [SCREE_DEM_LIGGGHTS] = {"liggghts",
                            {{"", ".txt", put_liggghts_spheres}, {"in.", "", put_liggghts_input}}},
    [SCREE_DEM_YADE] = {"yade", {{"", ".py", put_yade}}},
    [SCREE_DEM_PFC] = {"pfc", {{"", ".dat", put_pfc}}},
    [SCREE_DEM_CHRONO] = {"chrono", {{"", ".csv", put_chrono_spheres}, {"", ".py", put_chrono}}},
    [SCREE_DEM_EDEM] = {"edem", {{"", ".tsv", put_edem}}},
    [SCREE_DEM_MFIX] = {"mfix", {{"", "-gsp_config.csv", put_mfix}}},
};

const char *scree_dem_code_name(scree_dem_code code) {
  return (size_t)code < SCREE_DEM_CODE_COUNT ? codes[code].name : NULL;
}

scree_code_options scree_default_code_options(void) {
  return (scree_code_options){.name = "clump", .density = 2000, .count = 27};
}

scree_status scree_clump_code_write(const scree_particle *particle, scree_dem_code code,
                                    const scree_code_options *options, const char *folder,
                                    scree_error *error) {
  scree_code_options used = options ? *options : scree_default_code_options();
  scree_particle_measures m;
  scree_particle_measure(particle, &m);
  if (m.kind == SCREE_PARTICLE_MESH)
    return scree_fail(error, SCREE_BAD_ARGUMENT, "%s: the particle is a mesh, not a clump",
                      used.name);
  if (!scree_dem_code_name(code))
    return scree_fail(error, SCREE_BAD_ARGUMENT, "no DEM code has the number %d", (int)code);
  if (!(used.density > 0) || used.count < 1)
    return scree_fail(error, SCREE_BAD_ARGUMENT,
                      "density %g kg/m3 and %zu particles; both must be above 0", used.density,
                      used.count);
  clump_job j = prepare(particle, &used);
  for (int i = 0; i < 2 && codes[code].files[i].put; i++) {
    char path[SCREE_PATH_BYTES];
    scree_output output;
    if (snprintf(path, sizeof path, "%s/%s%s%s", folder, codes[code].files[i].before, j.name,
                 codes[code].files[i].behind) >= (int)sizeof path)
      return scree_fail(error, SCREE_LIMIT, "%.200s: the path is too long", folder);
    SCREE_TRY(scree_output_open(path, used.overwrite, &output, error));
    codes[code].files[i].put(&j, output.stream);
    SCREE_TRY(scree_output_commit(&output, error));
  }
  return SCREE_OK;
}
