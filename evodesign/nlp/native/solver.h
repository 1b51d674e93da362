/* What the method's parts share: an iterate, its evaluation, and the system of its step. */

#ifndef EVODESIGN_SOLVER_H
#define EVODESIGN_SOLVER_H

#include <math.h>
#include <string.h>

#include "interior_point.h"

#define UNBOUNDED 1e19         /* IPOPT, nlp_upper_bound_inf */
#define DAMPING 1e-5           /* WB section 3.7, kappa_d */
#define FILTER_SIZE 400

typedef struct {
    double cost;
    double *gradient, *rows, *jacobian, *hessian;
} Evaluation;

struct Solver {
    Problem problem;
    int slacks, primals, unknowns; /* inequality rows; variables and slacks; variables and rows */
    int *slack_rows;               /* row of each slack */
    int *slack_of;                 /* place of each row's slack among the primals, or -1 */

    const double *parameters;
    double *lower, *upper;         /* of primals, relaxed */
    double *primals_now, *multipliers, *lower_forces, *upper_forces; /* v, y, z_L, z_U */
    Evaluation now, trial;
    double *residuals;             /* c(v) */
    double violation;              /* theta: sum of their sizes */
    double small_violation, most_violation; /* theta^min and theta^max */
    double barrier;                /* mu */

    double *slope;                 /* gradient of the barrier problem's Lagrangian, by primals */
    double *curvature;             /* Sigma + delta_w, by primals */
    double *step, *multiplier_step, *lower_step, *upper_step;
    double *corrected_step, *corrected_multiplier_step, *corrected_residuals;
    double *trial_primals, *trial_multipliers, *trial_residuals;
    double *trial_lower, *trial_upper;
    double *reference;             /* primals where restoration began */

    double *system, *factor, *inverse_pivots, *row_work;
    int *filled;
    double *right, *solution, *remainder, *ordered, *transposed;

    double filter[FILTER_SIZE][2];
    int filter_count;
    int soft_steps;                /* of soft restoration, one after the other */
    double last_shift;             /* delta_w of the last system that needed one */

    double *work;
    Size *integers;
    Outcome *outcome;
};

/* evaluation.c */
void evaluate_all(Solver *s, const double *primals, const double *multipliers, Evaluation *at);
void evaluate_values(Solver *s, const double *primals, Evaluation *at);
double take_residuals(const Solver *s, const double *rows, const double *primals, double *residuals);
double largest(const double *values, int count);
double barrier_cost(const Solver *s, double cost, const double *primals);
void jacobian_transposed(const Solver *s, const Evaluation *at, const double *multipliers, double *product);
double largest_step(const Solver *s, const double *step, double fraction);

/* The larger of two numbers; unlike fmax, what is not a number if either is none. */
static inline double larger(double a, double b) { return a != a || a > b ? a : b; }

static inline int bounded_below(const Solver *s, int i) { return s->lower[i] > -UNBOUNDED; }
static inline int bounded_above(const Solver *s, int i) { return s->upper[i] < UNBOUNDED; }

/* blocks.c */
void evaluate_blocks(Solver *s, const double *primals, const double *multipliers, Evaluation *at);

/* linear_system.c */
int factorise(Solver *s, const double *hessian, double dual_shift);
double solve_system(Solver *s, const double *hessian, double dual_shift);

/* direction.c */
int find_direction(Solver *s, double *dual_shift);
void set_right_side(Solver *s, const double *residuals);
void set_force_steps(Solver *s);
void expand_solution(const Solver *s, double *step, double *multiplier_step);
void estimate_multipliers(Solver *s);

/* filter.c */
int not_above(double value, double limit, double size);
int filter_accepts(const Solver *s, double violation, double cost);
void filter_add(Solver *s, double violation, double cost);

/* line_search.c */
void adopt(double **now, double **trial);
double forces_share(const Solver *s, double fraction);
int line_search(Solver *s, double fraction, double dual_shift);

/* restoration.c */
int restore(Solver *s, int iterations);
void leave_restoration(Solver *s, double fraction);

#endif
