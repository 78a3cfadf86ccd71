/* Distribution functions for the statistics of few runs. */
#pragma once

/* P(T <= t) for Student's t with `degrees` > 0, not necessarily whole, degrees of freedom. */
double scree_student_cdf(double t, double degrees);
/* Its inverse for p in (0, 1). */
double scree_student_quantile(double p, double degrees);

/* P(X <= x) for chi-square, and its inverse for p in (0, 1). */
double scree_chi_square_cdf(double x, double degrees);
double scree_chi_square_quantile(double p, double degrees);
