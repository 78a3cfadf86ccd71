/* What the kernels' sources read of the C library, which a device has not. */
#pragma once
#define INFINITY    __builtin_inff()
#define NAN         __builtin_nanf("")
#define isfinite(x) __builtin_isfinite(x)
#define isnan(x)    __builtin_isnan(x)
double fabs(double x);
double sqrt(double x);
double floor(double x);
double ceil(double x);
