/* Feasibility restoration: back to where the filter accepts a point, by Gauss-Newton steps on

       rho / 2 |c(v)|^2 + zeta / 2 |v - v_R|^2 - mu_R sum log(distances to bounds)

   WB section 3.3 minimises the 1-norm of c instead; squares need no further variables, so that the system keeps
   its pattern. As there, zeta = sqrt(mu_R), and mu_R begins at the largest residual. */

#include "solver.h"

#define RHO 1000.0             /* WB equation 29a */
#define FRACTION 0.99
#define ARMIJO 1e-4
#define LEAST_DECREASE 0.9     /* WB section 3.3, kappa_resto */
#define MOST_HALVINGS 25
#define STANDSTILL 1e-8        /* relative change of the primals that counts as none */
#define LARGEST_FORCE 1e3      /* IPOPT, bound_mult_reset_threshold */
#define SLOW 1e-3              /* and as little: the barrier is lowered */

static double squares(const Solver *s, const double *residuals) {
    double sum = 0;
    for (int j = 0; j < s->problem.rows; j++)
        sum += 0.5 * RHO * residuals[j] * residuals[j];
    return sum;
}

static double merit(const Solver *s, const double *primals, const double *residuals, double mu, double zeta) {
    double sum = squares(s, residuals);
    for (int i = 0; i < s->primals; i++) {
        double change = primals[i] - s->reference[i];
        if (bounded_below(s, i))
            sum -= mu * log(primals[i] - s->lower[i]);
        if (bounded_above(s, i))
            sum -= mu * log(s->upper[i] - primals[i]);
        sum += 0.5 * zeta * change * change;
    }
    return sum;
}

static void set_step(Solver *s, double mu, double zeta) {
    for (int i = 0; i < s->primals; i++) {
        double slope = zeta * (s->primals_now[i] - s->reference[i]), curvature = zeta;
        if (bounded_below(s, i)) {
            double distance = s->primals_now[i] - s->lower[i];
            slope -= mu / distance;
            curvature += mu / (distance * distance);
        }
        if (bounded_above(s, i)) {
            double distance = s->upper[i] - s->primals_now[i];
            slope += mu / distance;
            curvature += mu / (distance * distance);
        }
        s->slope[i] = slope;
        s->curvature[i] = curvature;
    }
    factorise(s, NULL, 1 / RHO);
    set_right_side(s, s->residuals);
    solve_system(s, NULL, 1 / RHO);
    expand_solution(s, s->step, s->multiplier_step);
}

/* The merit's slope along the step. */
static double slope_along(const Solver *s) {
    const Problem *p = &s->problem;
    double sum = 0;
    for (int i = 0; i < s->primals; i++)
        sum += s->slope[i] * s->step[i];
    for (int column = 0; column < p->variables; column++)
        for (int k = p->jacobian_starts[column]; k < p->jacobian_starts[column + 1]; k++)
            sum += RHO * s->residuals[p->jacobian_rows[k]] * s->now.jacobian[k] * s->step[column];
    for (int k = 0; k < s->slacks; k++)
        sum -= RHO * s->residuals[s->slack_rows[k]] * s->step[p->variables + k];
    return sum;
}

static double relative_step(const Solver *s) {
    double most = 0;
    for (int i = 0; i < s->primals; i++)
        most = fmax(most, fabs(s->step[i]) / (1 + fabs(s->primals_now[i])));
    return most;
}

/* Whether a point was found that the filter accepts and that is nearer to feasibility; it is then evaluated as
   the current one. Otherwise the current point is where the residuals can be made no smaller. */
int restore(Solver *s, int iterations) {
    double worst = largest(s->residuals, s->problem.rows), began = s->violation;
    double mu = fmax(s->barrier, worst), zeta = sqrt(mu);
    memcpy(s->reference, s->primals_now, sizeof(double) * s->primals);
    for (int round = 0; round < iterations; round++) {
        s->outcome->restorations++;
        double here = merit(s, s->primals_now, s->residuals, mu, zeta);
        set_step(s, mu, zeta);
        double slope = slope_along(s), share = largest_step(s, s->step, FRACTION), moved = relative_step(s);
        int halvings = 0;
        for (; halvings < MOST_HALVINGS; halvings++, share *= 0.5) {
            for (int i = 0; i < s->primals; i++)
                s->trial_primals[i] = s->primals_now[i] + share * s->step[i];
            evaluate_values(s, s->trial_primals, &s->trial);
            take_residuals(s, s->trial.rows, s->trial_primals, s->trial_residuals);
            double there = merit(s, s->trial_primals, s->trial_residuals, mu, zeta);
            if (isfinite(there) && there <= here + ARMIJO * share * slope + 1e-12 * fabs(here))
                break;
        }
        if (halvings == MOST_HALVINGS)
            return 0;
        memcpy(s->primals_now, s->trial_primals, sizeof(double) * s->primals);
        evaluate_all(s, s->primals_now, s->multipliers, &s->now);
        s->violation = take_residuals(s, s->now.rows, s->primals_now, s->residuals);
        if (s->violation <= LEAST_DECREASE * began &&
            filter_accepts(s, s->violation, barrier_cost(s, s->now.cost, s->primals_now)))
            return 1;
        if (moved * share < STANDSTILL) {
            if (mu <= fmax(s->barrier * 1.0001, 1e-9))
                return 0;
            mu = fmax(s->barrier, 0.1 * mu);
        } else if ((moved * share < SLOW || slope > -1e-2 * here) && mu > s->barrier)
            mu = fmax(s->barrier, 0.2 * mu);
        zeta = sqrt(mu);
    }
    return 0;
}

/* From where restoration ended. As IPOPT has it: bounds' forces as if all of it had been one step from
   `reference`, or 1 if that makes one of them large; multipliers of rows zero. */
void leave_restoration(Solver *s, double fraction) {
    for (int i = 0; i < s->primals; i++)
        s->step[i] = s->primals_now[i] - s->reference[i];
    adopt(&s->primals_now, &s->reference);
    set_force_steps(s);
    adopt(&s->primals_now, &s->reference);
    double share = forces_share(s, fraction), most = 0;
    for (int i = 0; i < s->primals; i++) {
        s->lower_forces[i] += share * s->lower_step[i];
        s->upper_forces[i] += share * s->upper_step[i];
        most = fmax(most, fmax(s->lower_forces[i], s->upper_forces[i]));
    }
    for (int i = 0; most > LARGEST_FORCE && i < s->primals; i++) {
        s->lower_forces[i] = bounded_below(s, i);
        s->upper_forces[i] = bounded_above(s, i);
    }
    memset(s->multipliers, 0, sizeof(double) * s->problem.rows);
    evaluate_all(s, s->primals_now, s->multipliers, &s->now);
}
