/* A clump as the input of another DEM code: its spheres about the centre of mass, along the
 * principal axes, with mass and inertia, and a script that lets some fall into a box. Formats by
 * the codes' manuals: LAMMPS `molecule` and `fix rigid/small`, LIGGGHTS `fix
 * particletemplate/multisphere`, YADE `appendClumped`, PFC `clump template create`, Chrono
 * DEM-Engine `LoadClumpType`; EDEM's page "Add Multi-Sphere Particles" (a table of spheres about
 * the origin along the principal axes, to be pasted); MFiX by what its generator of glued spheres
 * writes as gsp_config.csv. */
#include "base/file.h"
#include "base/vec.h"

#include <string.h>

/* What all the writers need. */
typedef struct clump_job {
  const scree_particle *particle;
  const scree_code_options *options;
  const char *folder;
  scree_particle_measures m;
  double mass, inertia[3];
  double width, height; /* of the script's box, m */
  double time_step;     /* s */
  double damping;       /* LAMMPS's gamma_n, 1/(m s) */
  char name[128];       /* without blanks */
} clump_job;

static const double pi = 3.14159265358979323846;

/* Young's modulus, Poisson's ratio and friction of the scripts: to be edited there. */
static const double young = 1e7, poisson = 0.3, friction = 0.5, gravity = 9.81;

static double least_radius(const clump_job *j) {
  double least = INFINITY, centre[3], radius;
  for (size_t i = 0; i < j->m.point_count; i++) {
    scree_particle_point(j->particle, i, centre, &radius);
    least = fmin(least, radius);
  }
  return least;
}

/* A third of the critical damping at an overlap of 2 % of the radius: Hertz's stiffness is E
 * sqrt(overlap radius), and the damping gamma m sqrt(overlap radius). */
static double damping_rate(const clump_job *j, double least) {
  return 2. / 3 * sqrt(young / (j->mass * sqrt(0.02) * least));
}

/* A tenth of Rayleigh's time of the smallest sphere (Li, Xu, Thornton 2005). */
static double rayleigh_step(const clump_job *j, double least) {
  double shear = young / (2 * (1 + poisson));
  return 0.1 * pi * least * sqrt(j->options->density / shear) / (0.1631 * poisson + 0.8766);
}

static clump_job prepare(const scree_particle *particle, const scree_code_options *o,
                         const char *folder) {
  clump_job j = {.particle = particle, .options = o, .folder = folder};
  scree_particle_measure(particle, &j.m);
  j.mass = o->density * j.m.volume;
  for (int k = 0; k < 3; k++) j.inertia[k] = o->density * j.m.inertia[k];
  j.width = 4 * j.m.bounding_radius * ceil(cbrt((double)o->count)) / 2;
  j.height = 2 * j.m.bounding_radius * (2 + ceil(cbrt((double)o->count))) * 2;
  double least = least_radius(&j);
  j.time_step = rayleigh_step(&j, least);
  j.damping = damping_rate(&j, least);
  size_t used = 0;
  for (const char *c = o->name; *c && used + 1 < sizeof j.name; c++)
    j.name[used++] = strchr(" \t\"'\\/", *c) ? '_' : *c;
  return j;
}

static scree_status open_part(const clump_job *j, const char *prefix, const char *ending,
                              scree_output *output, scree_error *error) {
  char path[4096];
  int length = snprintf(path, sizeof path, "%s/%s%s%s", j->folder, prefix, j->name, ending);
  if (length < 0 || (size_t)length >= sizeof path)
    return scree_fail(error, SCREE_LIMIT, "%.200s: the path is too long", j->folder);
  return scree_output_open(path, j->options->overwrite, output, error);
}

/* A sphere a line after the number's pattern: "x y z" and the radius times a factor, in some order.
 */
static void put_spheres(const clump_job *j, FILE *f, bool radius_first, char between) {
  for (size_t i = 0; i < j->m.point_count; i++) {
    double c[3], r;
    scree_particle_point(j->particle, i, c, &r);
    if (radius_first) fprintf(f, "%.12g%c", r, between);
    fprintf(f, "%.12g%c%.12g%c%.12g", c[0], between, c[1], between, c[2]);
    if (!radius_first) fprintf(f, "%c%.12g", between, r);
    fputs(radius_first ? " ...\n" : "\n", f);
  }
}

/* ---- LAMMPS ---- */

static void put_molecule(const clump_job *j, FILE *f) {
  size_t n = j->m.point_count;
  double cubes = 0, c[3], r;
  fprintf(f,
          "# clump %s from scree %s: m, kg, about the centre of mass, along the principal axes\n\n",
          j->name, scree_version());
  fprintf(f, "%zu atoms\n%.12g mass\n0 0 0 com\n%.12g %.12g %.12g 0 0 0 inertia\n\nCoords\n\n", n,
          j->mass, j->inertia[0], j->inertia[1], j->inertia[2]);
  for (size_t i = 0; i < n; i++) {
    scree_particle_point(j->particle, i, c, &r);
    fprintf(f, "%zu %.12g %.12g %.12g\n", i + 1, c[0], c[1], c[2]);
    cubes += r * r * r;
  }
  fputs("\nTypes\n\n", f);
  for (size_t i = 0; i < n; i++) fprintf(f, "%zu 1\n", i + 1);
  fputs("\nDiameters\n\n", f);
  for (size_t i = 0; i < n; i++) {
    scree_particle_point(j->particle, i, c, &r);
    fprintf(f, "%zu %.12g\n", i + 1, 2 * r);
  }
  fputs("\nMasses\n\n", f);
  for (size_t i = 0; i < n; i++) {
    scree_particle_point(j->particle, i, c, &r);
    fprintf(f, "%zu %.12g\n", i + 1, j->mass * r * r * r / cubes);
  }
}

static void put_lammps_input(const clump_job *j, FILE *f) {
  double reach = j->m.bounding_radius;
  /* so many steps as a fall over three radii takes */
  double apart = ceil(sqrt(6 * reach / gravity) / j->time_step);
  fprintf(f,
          "# lets %zu clumps fall into a box: lmp -in in.%s\n"
          "units si\natom_style sphere\natom_modify map array\nboundary f f f\nnewton off\n"
          "comm_modify vel yes cutoff %.6g\nregion box block %.6g %.6g %.6g %.6g 0 %.6g units box\n"
          "create_box 1 box\nfix body all property/atom mol ghost yes\nneighbor %.6g "
          "bin\nneigh_modify exclude molecule/intra all\n"
          "molecule clump %s.mol\n",
          j->options->count, j->name, 2.5 * reach, -j->width / 2, j->width / 2, -j->width / 2,
          j->width / 2, j->height + 6 * reach, 0.1 * reach, j->name);
  fprintf(f,
          "pair_style gran/hertz/history %.6g NULL %.6g NULL %.6g 1\npair_coeff * *\n"
          "timestep %.6g\nfix gravity all gravity %.6g vector 0 0 -1\n",
          young, j->damping, friction, j->time_step, gravity);
  for (int k = 0; k < 2; k++)
    fprintf(
        f, "fix sides%d all wall/gran hertz/history %.6g NULL %.6g NULL %.6g 1 %cplane %.6g %.6g\n",
        k, young, j->damping, friction, "xy"[k], -j->width / 2, j->width / 2);
  fprintf(f,
          "fix floor all wall/gran hertz/history %.6g NULL %.6g NULL %.6g 1 zplane 0 NULL\n"
          "fix move all rigid/small molecule mol clump\n"
          "region top block %.6g %.6g %.6g %.6g %.6g %.6g units box\n"
          "fix fall all deposit %zu 0 %.0f 48271 region top mol clump rigid move attempt 100\n"
          "compute bodies all rigid/local move id mass x y z\n"
          "dump bodies all local %.0f bodies.dump index c_bodies[1] c_bodies[2] c_bodies[3] "
          "c_bodies[4] c_bodies[5]\n"
          "thermo %.0f\nthermo_style custom step atoms ke\nthermo_modify lost warn\nrun %.0f\n",
          young, j->damping, friction, -j->width / 2 + reach, j->width / 2 - reach,
          -j->width / 2 + reach, j->width / 2 - reach, j->height, j->height + reach,
          j->options->count, apart, apart, apart, apart * (double)(j->options->count + 3));
}

static scree_status write_lammps(const clump_job *j, scree_error *error) {
  scree_output output;
  scree_status status = open_part(j, "", ".mol", &output, error);
  if (status != SCREE_OK) return status;
  put_molecule(j, output.stream);
  status = scree_output_commit(&output, error);
  if (status == SCREE_OK) status = open_part(j, "in.", "", &output, error);
  if (status != SCREE_OK) return status;
  put_lammps_input(j, output.stream);
  return scree_output_commit(&output, error);
}

/* ---- LIGGGHTS ---- */

static void put_liggghts_input(const clump_job *j, FILE *f) {
  double w = j->width / 2, reach = j->m.bounding_radius;
  double least = 1e-3 * j->m.volume; /* what LIGGGHTS takes for none; its 1e-12 m3 are a grain */
  fprintf(f,
          "# lets %zu clumps fall into a box: liggghts -in in.%s\n"
          "units si\natom_style granular\natom_modify map array\nboundary f f f\nnewton off\n"
          "communicate single vel yes\nregion box block %.6g %.6g %.6g %.6g %.6g %.6g units box\n"
          "create_box 1 box\nneighbor %.6g bin\nneigh_modify delay 0\n",
          j->options->count, j->name, -w, w, -w, w, -reach, 3 * j->height, 0.1 * reach);
  fprintf(f,
          "fix m1 all property/global youngsModulus peratomtype %.6g\n"
          "fix m2 all property/global poissonsRatio peratomtype %.6g\n"
          "fix m3 all property/global coefficientRestitution peratomtypepair 1 0.3\n"
          "fix m4 all property/global coefficientFriction peratomtypepair 1 %.6g\n"
          "pair_style gran model hertz tangential history\npair_coeff * *\ntimestep %.6g\n"
          "fix gravity all gravity %.6g vector 0 0 -1\n",
          young, poisson, friction, j->time_step, gravity);
  fprintf(f,
          "fix floor all wall/gran model hertz tangential history primitive type 1 zplane 0.0\n"
          "fix left all wall/gran model hertz tangential history primitive type 1 xplane %.6g\n"
          "fix right all wall/gran model hertz tangential history primitive type 1 xplane %.6g\n"
          "fix front all wall/gran model hertz tangential history primitive type 1 yplane %.6g\n"
          "fix back all wall/gran model hertz tangential history primitive type 1 yplane %.6g\n",
          -w, w, -w, w);
  fprintf(
      f,
      "fix clump all particletemplate/multisphere 15485863 atom_type 1 volume_limit %.3g density "
      "constant %.6g nspheres %zu ntry 1000000 spheres file %s.txt scale 1.0 type 1 mass %.12g "
      "inertia_tensor "
      "%.12g 0 0 %.12g 0 %.12g use_volume\n"
      "fix mix all particledistribution/discrete 15485867 1 clump 1.0\n"
      "region top block %.6g %.6g %.6g %.6g %.6g %.6g units box volume_limit %.3g\n"
      "fix fall all insert/pack seed 32452843 distributiontemplate mix maxattempt 1000 "
      "insert_every once overlapcheck yes all_in yes vel constant 0 0 -0.1 orientation random "
      "region top particles_in_region %zu\n"
      "fix move all multisphere\n",
      least, j->options->density, j->m.point_count, j->name, j->mass, j->inertia[0], j->inertia[1],
      j->inertia[2], -w, w, -w, w, 0.1 * reach, 2.9 * j->height, least, j->options->count);
  fprintf(f,
          "compute mass all multisphere property masstotal\nthermo 1000\n"
          "thermo_style custom step atoms ke\nthermo_modify lost ignore norm no\n"
          "run 1\ndump bodies all local 1000 bodies.dump c_mass\nrun %.0f\n",
          ceil(2 * sqrt(2 * j->height / gravity) / j->time_step));
}

static scree_status write_liggghts(const clump_job *j, scree_error *error) {
  scree_output output;
  scree_status status = open_part(j, "", ".txt", &output, error);
  if (status != SCREE_OK) return status;
  put_spheres(j, output.stream, false, ' ');
  status = scree_output_commit(&output, error);
  if (status == SCREE_OK) status = open_part(j, "in.", "", &output, error);
  if (status != SCREE_OK) return status;
  put_liggghts_input(j, output.stream);
  return scree_output_commit(&output, error);
}

/* ---- YADE ---- */

static void put_yade(const clump_job *j, FILE *f) {
  fprintf(f,
          "\"\"\"Clumps %s from scree %s: yade -n -x %s.py\n\n"
          "MASS, INERTIA: kg, kg m2, of the body; SPHERES: x, y, z, radius, m, about its centre of "
          "mass, along its\nprincipal axes. add_clump() may be called from other scripts.\"\"\"\n"
          "MASS = %.12g\nINERTIA = (%.12g, %.12g, %.12g)\nSPHERES = [\n",
          j->name, scree_version(), j->name, j->mass, j->inertia[0], j->inertia[1], j->inertia[2]);
  for (size_t i = 0; i < j->m.point_count; i++) {
    double c[3], r;
    scree_particle_point(j->particle, i, c, &r);
    fprintf(f, "    (%.12g, %.12g, %.12g, %.12g),\n", c[0], c[1], c[2], r);
  }
  fprintf(f,
          "]\nGRAVITY, SIZE, COUNT = %.6g, %.6g, %zu\n"
          "material = O.materials.append(FrictMat(density=%.6g, young=%.6g, poisson=%.6g, "
          "frictionAngle=%.6g))\n",
          gravity, j->m.bounding_radius, j->options->count, j->options->density, young, poisson,
          atan(friction));
  fputs("\n\n"
        "def add_clump(position, turn=Quaternion.Identity):\n"
        "    \"\"\"The mass and inertia of the body, whatever the spheres' are.\"\"\"\n"
        "    balls = [sphere(Vector3(*position) + turn * Vector3(x, y, z), r, material=material) "
        "for x, y, z, r in SPHERES]\n"
        "    number, _ = O.bodies.appendClumped(balls, discretization=20)\n"
        "    state = O.bodies[number].state\n"
        "    # YADE keeps a clump's inertia along axes of its own\n"
        "    axes = state.ori.conjugate() * turn\n"
        "    state.mass = MASS\n"
        "    state.inertia = Vector3(*(sum(INERTIA[k] * (axes * Vector3.Unit(k))[i] ** 2 for k in "
        "range(3)) for i in range(3)))\n"
        "    return number\n\n\n",
        f);
  fputs(
      "clumps = []\n"
      "side = 1\n"
      "while side ** 3 < COUNT:\n    side += 1\n"
      "for n in range(COUNT):\n"
      "    cell = (n % side, n // side % side, n // side ** 2)\n"
      "    clumps.append(add_clump([2.1 * SIZE * (c + 0.5) for c in cell], Quaternion(Vector3(1, "
      "2, "
      "3).normalized(), n)))\n"
      "O.bodies.append(utils.wall(0, axis=2, sense=1, material=material))\n"
      "for axis in (0, 1):\n"
      "    O.bodies.append(utils.wall(0, axis=axis, sense=1, material=material))\n"
      "    O.bodies.append(utils.wall(2.1 * SIZE * side, axis=axis, sense=-1, material=material))\n"
      "O.engines = [\n"
      "    ForceResetter(),\n"
      "    InsertionSortCollider([Bo1_Sphere_Aabb(), Bo1_Wall_Aabb()]),\n"
      "    InteractionLoop([Ig2_Sphere_Sphere_ScGeom(), Ig2_Wall_Sphere_ScGeom()], "
      "[Ip2_FrictMat_FrictMat_FrictPhys()],\n"
      "                    [Law2_ScGeom_FrictPhys_CundallStrack()]),\n"
      "    NewtonIntegrator(damping=0.3, gravity=(0, 0, -GRAVITY)),\n"
      "]\n"
      "O.dt = 0.3 * PWaveTimeStep()\n"
      "O.run(int(3 * (2 * SIZE / GRAVITY) ** 0.5 / O.dt), True)\n"
      "print(f'{len(clumps)} clumps of {O.bodies[clumps[0]].state.mass:.6g} kg, '\n"
      "      f'{O.interactions.countReal()} contacts after {O.time:.4g} s, '\n"
      "      f'lowest centre {min(O.bodies[c].state.pos[2] for c in clumps):.4g} m')\n",
      f);
}

/* ---- PFC and Chrono ---- */

static void put_pfc(const clump_job *j, FILE *f) {
  fprintf(
      f,
      "; clump %s from scree %s: volume in m3, inertia for density 1; pebbles: radius, x, y, z\n"
      "clump template create ...\n    name '%s' ...\n    pebbles %zu ...\n",
      j->name, scree_version(), j->name, j->m.point_count);
  put_spheres(j, f, true, ' ');
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

static scree_status write_one(const clump_job *j, const char *ending,
                              void (*put)(const clump_job *, FILE *), scree_error *error) {
  scree_output output;
  scree_status status = open_part(j, "", ending, &output, error);
  if (status != SCREE_OK) return status;
  put(j, output.stream);
  return scree_output_commit(&output, error);
}

static scree_status write_chrono(const clump_job *j, scree_error *error) {
  scree_output output;
  scree_status status = open_part(j, "", ".csv", &output, error);
  if (status != SCREE_OK) return status;
  fputs("x,y,z,r\n", output.stream);
  put_spheres(j, output.stream, false, ',');
  status = scree_output_commit(&output, error);
  return status == SCREE_OK ? write_one(j, ".py", put_chrono, error) : status;
}

/* ---- EDEM and MFiX ---- */

static void put_edem(const clump_job *j, FILE *f) {
  fputs("X (m)\tY (m)\tZ (m)\tRadius (m)\n", f);
  put_spheres(j, f, false, '\t');
}

/* The share of a sphere's surface that lies in no other, by points on a spiral. */
static double exposed_share(const clump_job *j, size_t index) {
  enum { POINTS = 1000 };
  size_t exposed = 0;
  double c[3], r;
  scree_particle_point(j->particle, index, c, &r);
  for (int k = 0; k < POINTS; k++) {
    double z = 1 - (2 * k + 1.) / POINTS, ring = sqrt(1 - z * z), turn = 2.399963229728653 * k;
    vec3 p = vec3_mad(vec3_load(c), (vec3){ring * cos(turn), ring * sin(turn), z}, r);
    bool covered = false;
    for (size_t i = 0; i < j->m.point_count && !covered; i++) {
      double other[3], radius;
      scree_particle_point(j->particle, i, other, &radius);
      vec3 d = vec3_sub(p, vec3_load(other));
      covered = i != index && vec3_dot(d, d) < radius * radius;
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
    double c[3], r;
    scree_particle_point(j->particle, i, c, &r);
    fprintf(f, "%.12g,%.12g,%.12g,%.12g,%.12g,-1,-1,-1,-1,-1,-1,0,0,0,0,0,0,1\n", c[0] / size,
            c[1] / size, c[2] / size, 2 * r / size,
            4 * pi * r * r / (size * size) * exposed_share(j, i));
  }
}

static scree_status write_yade(const clump_job *j, scree_error *error) {
  return write_one(j, ".py", put_yade, error);
}

static scree_status write_pfc(const clump_job *j, scree_error *error) {
  return write_one(j, ".dat", put_pfc, error);
}

static scree_status write_edem(const clump_job *j, scree_error *error) {
  return write_one(j, ".tsv", put_edem, error);
}

static scree_status write_mfix(const clump_job *j, scree_error *error) {
  return write_one(j, "-gsp_config.csv", put_mfix, error);
}

/* ---- All of them ---- */

static const struct {
  const char *name;
  scree_status (*write)(const clump_job *job, scree_error *error);
} codes[SCREE_DEM_CODE_COUNT] = {
    [SCREE_DEM_LAMMPS] = {"lammps", write_lammps},
    [SCREE_DEM_LIGGGHTS] = {"liggghts", write_liggghts},
    [SCREE_DEM_YADE] = {"yade", write_yade},
    [SCREE_DEM_PFC] = {"pfc", write_pfc},
    [SCREE_DEM_CHRONO] = {"chrono", write_chrono},
    [SCREE_DEM_EDEM] = {"edem", write_edem},
    [SCREE_DEM_MFIX] = {"mfix", write_mfix},
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
  clump_job j = prepare(particle, &used, folder);
  return codes[code].write(&j, error);
}
