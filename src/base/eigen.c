/* Cyclic Jacobi rotations (Golub, Van Loan, Matrix Computations, 4th ed., 8.5): no loss of digits
 * for close or multiple eigenvalues, which inertia tensors of symmetric bodies have. */
#include "base/eigen.h"

enum { SWEEPS = 30 }; /* quadratic convergence: six are enough, the rest is for certainty */

/* Makes a[p][q] zero; columns of v collect the rotations. */
static void rotate(double a[3][3], double v[3][3], int p, int q) {
  if (a[p][q] == 0) return;
  double tau = (a[q][q] - a[p][p]) / (2 * a[p][q]);
  double t = (tau >= 0 ? 1 : -1) / (fabs(tau) + sqrt(1 + tau * tau));
  double c = 1 / sqrt(1 + t * t), s = t * c;
  for (int k = 0; k < 3; k++) {
    double x = a[k][p], y = a[k][q];
    a[k][p] = c * x - s * y;
    a[k][q] = s * x + c * y;
  }
  for (int k = 0; k < 3; k++) {
    double x = a[p][k], y = a[q][k];
    a[p][k] = c * x - s * y;
    a[q][k] = s * x + c * y;
  }
  a[p][q] = a[q][p] = 0;
  for (int k = 0; k < 3; k++) {
    double x = v[k][p], y = v[k][q];
    v[k][p] = c * x - s * y;
    v[k][q] = s * x + c * y;
  }
}

static int largest_component(const double row[3]) {
  int largest = 0;
  for (int k = 1; k < 3; k++)
    if (fabs(row[k]) > fabs(row[largest])) largest = k;
  return largest;
}

/* Adding 0 makes the zero of either sign a positive one. */
void scree_frame_canonical(mat3 *axes) {
  for (int i = 0; i < 2; i++) {
    double sign = axes->m[i][largest_component(axes->m[i])] < 0 ? -1 : 1;
    for (int k = 0; k < 3; k++) axes->m[i][k] = sign * axes->m[i][k] + 0.0;
  }
  vec3 third = vec3_cross(vec3_load(axes->m[0]), vec3_load(axes->m[1]));
  vec3_store(axes->m[2], vec3_add(third, (vec3){0, 0, 0}));
}

void scree_eigen_symmetric(const mat3 *matrix, double values[3], mat3 *axes) {
  double a[3][3], v[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  double scale = 0;
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      a[i][j] = i <= j ? matrix->m[i][j] : matrix->m[j][i];
      scale = fmax(scale, fabs(a[i][j]));
    }
  for (int sweep = 0; sweep < SWEEPS; sweep++) {
    if (fabs(a[0][1]) + fabs(a[0][2]) + fabs(a[1][2]) <= 1e-18 * scale) break;
    rotate(a, v, 0, 1);
    rotate(a, v, 0, 2);
    rotate(a, v, 1, 2);
  }
  int order[3] = {0, 1, 2};
  for (int i = 0; i < 2; i++)
    for (int j = 0; j < 2 - i; j++)
      if (a[order[j + 1]][order[j + 1]] < a[order[j]][order[j]]) {
        int swap = order[j];
        order[j] = order[j + 1];
        order[j + 1] = swap;
      }
  for (int i = 0; i < 3; i++) {
    values[i] = a[order[i]][order[i]];
    vec3_store(axes->m[i], vec3_unit((vec3){v[0][order[i]], v[1][order[i]], v[2][order[i]]}));
  }
  scree_frame_canonical(axes);
}
