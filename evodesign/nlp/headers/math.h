/* What generated functions and the method take from the mathematical library: the compiler that comes with pip
   has no headers of the machine. Sources of the signatures: ISO C11, 7.12. */

#ifndef EVODESIGN_MATH_H
#define EVODESIGN_MATH_H

double acos(double x);
double acosh(double x);
double asin(double x);
double asinh(double x);
double atan(double x);
double atan2(double y, double x);
double atanh(double x);
double ceil(double x);
double copysign(double x, double y);
double cos(double x);
double cosh(double x);
double erf(double x);
double exp(double x);
double expm1(double x);
double fabs(double x);
double floor(double x);
double fmax(double x, double y);
double fmin(double x, double y);
double fmod(double x, double y);
double hypot(double x, double y);
double log(double x);
double log10(double x);
double log1p(double x);
double pow(double x, double y);
double sin(double x);
double sinh(double x);
double sqrt(double x);
double tan(double x);
double tanh(double x);

#define HUGE_VAL 1e400
#define INFINITY 1e400
#define NAN (1e400 - 1e400)
#define isfinite(x) ((x) - (x) == 0)

#endif
