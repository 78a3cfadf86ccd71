/* Of the C library, what the kernels' sources read: a device has none. */
#pragma once
#define INFINITY    __builtin_inff()
#define NAN         __builtin_nanf("")
#define isfinite(x) __builtin_isfinite(x)
#define isnan(x)    __builtin_isnan(x)
double fabs(double x);
double sqrt(double x);
double floor(double x);
double ceil(double x);
