/* The step of Newton's method on the barrier problem's optimality conditions: WB sections 2.2 and 3.1. */

#include "solver.h"

#define FIRST_SHIFT 1e-4       /* WB, Algorithm IC: delta_w^0 */
#define LEAST_SHIFT 1e-20      /* delta_w^min */
#define MOST_SHIFT 1e20        /* delta_w^max; IPOPT's default */
#define FEWER (1.0 / 3.0)      /* kappa_w^- */
#define MORE_AT_FIRST 100.0    /* kappa_w^+, before any shift was needed */
#define MORE 8.0               /* kappa_w^+ */
#define DUAL_SHIFT 1e-8        /* in the factors only: the system is quasi-definite, so that any order will do */
#define TRUE_DUAL_SHIFT 1e-8   /* WB, Algorithm IC: delta_c, times mu^kappa_c, in the system itself */
#define DUAL_POWER 0.25        /* kappa_c */
#define ACCURATE 1e-5          /* what may remain of the right side */
#define MOST_FACTORISATIONS 40
#define LARGEST_ESTIMATE 1e3   /* WB section 3.6: lambda_max */

/* The right side, with the slacks' rows of the full system eliminated. */
void set_right_side(Solver *s, const double *residuals) {
    const Problem *p = &s->problem;
    for (int i = 0; i < p->variables; i++)
        s->right[i] = -s->slope[i];
    for (int j = 0; j < p->rows; j++) {
        int slack = s->slack_of[j];
        s->right[p->variables + j] = -residuals[j] - (slack < 0 ? 0.0 : s->slope[slack] / s->curvature[slack]);
    }
}

/* The steps of variables, slacks and multipliers from the system's solution. */
void expand_solution(const Solver *s, double *step, double *multiplier_step) {
    const Problem *p = &s->problem;
    memcpy(step, s->solution, sizeof(double) * p->variables);
    memcpy(multiplier_step, s->solution + p->variables, sizeof(double) * p->rows);
    for (int k = 0, i = p->variables; k < s->slacks; k++, i++)
        step[i] = (multiplier_step[s->slack_rows[k]] - s->slope[i]) / s->curvature[i];
}

/* Gradient of the barrier problem's Lagrangian, and Sigma: WB equations 11 to 13. */
static void set_slope_and_curvature(Solver *s) {
    int variables = s->problem.variables;
    double mu = s->barrier;
    jacobian_transposed(s, &s->now, s->multipliers, s->transposed);
    for (int i = 0; i < s->primals; i++) {
        int below = bounded_below(s, i), above = bounded_above(s, i);
        double slope = i < variables ? s->now.gradient[i] + s->transposed[i]
                                     : -s->multipliers[s->slack_rows[i - variables]];
        double sigma = 0;
        if (below) {
            double distance = s->primals_now[i] - s->lower[i];
            slope -= mu / distance;
            sigma += s->lower_forces[i] / distance;
        }
        if (above) {
            double distance = s->upper[i] - s->primals_now[i];
            slope += mu / distance;
            sigma += s->upper_forces[i] / distance;
        }
        s->slope[i] = slope + DAMPING * mu * ((below && !above) - (above && !below));
        s->curvature[i] = sigma;
    }
}

/* The steps of bounds' forces that belong to the step of the primals. */
void set_force_steps(Solver *s) {
    for (int i = 0; i < s->primals; i++) {
        s->lower_step[i] = s->upper_step[i] = 0;
        if (bounded_below(s, i)) {
            double distance = s->primals_now[i] - s->lower[i], force = s->lower_forces[i];
            s->lower_step[i] = s->barrier / distance - force - force / distance * s->step[i];
        }
        if (bounded_above(s, i)) {
            double distance = s->upper[i] - s->primals_now[i], force = s->upper_forces[i];
            s->upper_step[i] = s->barrier / distance - force + force / distance * s->step[i];
        }
    }
}

static void shift_curvature(Solver *s, double change) {
    for (int i = 0; i < s->primals; i++)
        s->curvature[i] += change;
}

/* The direction from here: WB, Algorithm IC. A system whose solution stays inaccurate is treated as singular.
   Returns whether there is one; `dual_shift` is that of the system that gave it. */
int find_direction(Solver *s, double *dual_shift) {
    double shift = 0, in_factors = DUAL_SHIFT;
    *dual_shift = 0;
    set_slope_and_curvature(s);
    for (int tries = 0; tries <= MOST_FACTORISATIONS; tries++) {
        if (factorise(s, s->now.hessian, in_factors) == s->problem.variables) {
            set_right_side(s, s->residuals);
            if (solve_system(s, s->now.hessian, *dual_shift) < ACCURATE) {
                if (shift > 0)
                    s->last_shift = shift;
                expand_solution(s, s->step, s->multiplier_step);
                set_force_steps(s);
                return 1;
            }
            if (*dual_shift == 0) {
                *dual_shift = in_factors = TRUE_DUAL_SHIFT * pow(s->barrier, DUAL_POWER);
                continue;
            }
        }
        double before = shift;
        if (shift == 0)
            shift = s->last_shift == 0 ? FIRST_SHIFT : fmax(LEAST_SHIFT, FEWER * s->last_shift);
        else
            shift *= s->last_shift == 0 ? MORE_AT_FIRST : MORE;
        if (shift > MOST_SHIFT)
            return 0;
        shift_curvature(s, shift - before);
    }
    return 0;
}

/* Multipliers of rows that fit the gradient best: WB equation 36. They stay zero where they would be large. */
void estimate_multipliers(Solver *s) {
    const Problem *p = &s->problem;
    for (int i = 0; i < s->primals; i++)
        s->curvature[i] = 1.0;
    memset(s->multipliers, 0, sizeof(double) * p->rows);
    for (int i = 0; i < p->variables; i++)
        s->right[i] = -(s->now.gradient[i] - s->lower_forces[i] + s->upper_forces[i]);
    for (int j = 0; j < p->rows; j++) {
        int slack = s->slack_of[j];
        s->right[p->variables + j] = slack < 0 ? 0 : s->lower_forces[slack] - s->upper_forces[slack];
    }
    if (factorise(s, NULL, DUAL_SHIFT) != p->variables)
        return;
    solve_system(s, NULL, 0);
    if (largest(s->solution + p->variables, p->rows) < LARGEST_ESTIMATE)
        memcpy(s->multipliers, s->solution + p->variables, sizeof(double) * p->rows);
}
