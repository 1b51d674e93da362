/* Along a direction to a point that filter and barrier cost accept: WB sections 2.3, 2.4, 3.2 and 3.3. */

#include "solver.h"

#define GAMMA_VIOLATION 1e-5   /* WB equation 18 */
#define GAMMA_COST 1e-8        /* WB equation 18; IPOPT's default */
#define S_VIOLATION 1.1        /* WB equation 19 */
#define S_COST 2.3
#define ARMIJO 1e-8            /* WB equation 20, eta_phi; IPOPT's default */
#define LEAST_SHARE 0.05       /* WB equation 23, gamma_alpha */
#define MOST_CORRECTIONS 4     /* WB section 2.4, p_max */
#define LESS_VIOLATION 0.99    /* kappa_soc */
#define MOST_INCREASE 5.0      /* IPOPT, obj_max_inc: powers of ten by which the barrier cost may grow */
#define MOST_SOFT_STEPS 10     /* IPOPT, max_soft_resto_iters: one after the other */
#define SOFT_DECREASE 0.9999   /* IPOPT, soft_resto_pderror_reduction_factor */

/* The barrier cost here, and its slope along the step. */
typedef struct {
    double cost, slope;
} Here;

/* What a trial point has, and how it was accepted. */
typedef struct {
    double violation, cost;
    int switching, sufficient; /* conditions 19 and 20 of WB */
} Trial;

static Here measured(const Solver *s) {
    Here here = {barrier_cost(s, s->now.cost, s->primals_now), 0};
    for (int i = 0; i < s->primals; i++) {
        int below = bounded_below(s, i), above = bounded_above(s, i);
        double slope = i < s->problem.variables ? s->now.gradient[i] : 0;
        if (below)
            slope -= s->barrier / (s->primals_now[i] - s->lower[i]);
        if (above)
            slope += s->barrier / (s->upper[i] - s->primals_now[i]);
        slope += DAMPING * s->barrier * ((below && !above) - (above && !below));
        here.slope += slope * s->step[i];
    }
    return here;
}

static void measure_trial(Solver *s, Trial *trial) {
    trial->violation = take_residuals(s, s->trial.rows, s->trial_primals, s->trial_residuals);
    trial->cost = barrier_cost(s, s->trial.cost, s->trial_primals);
}

static int accepts(const Solver *s, const Here *here, double share, Trial *trial) {
    trial->switching = here->slope < 0 && share * pow(-here->slope, S_COST) > pow(s->violation, S_VIOLATION);
    trial->sufficient = not_above(trial->cost - here->cost, ARMIJO * share * here->slope, here->cost);
    if (!isfinite(trial->cost) || !(trial->violation <= s->most_violation))
        return 0;
    if (trial->switching && s->violation <= s->small_violation) {
        if (!trial->sufficient)
            return 0;
    } else {
        double rise = trial->cost - here->cost;
        double usual = fabs(here->cost) > 10 ? log10(fabs(here->cost)) : 1;
        if (rise > 0 && log10(rise) > MOST_INCREASE + usual)
            return 0;
        if (!not_above(trial->violation, (1 - GAMMA_VIOLATION) * s->violation, s->violation) &&
            !not_above(rise, -GAMMA_COST * s->violation, here->cost))
            return 0;
    }
    return filter_accepts(s, trial->violation, trial->cost);
}

static void move(const double *from, const double *step, double share, int count, double *to) {
    for (int i = 0; i < count; i++)
        to[i] = from[i] + share * step[i];
}

static void add_here(Solver *s, const Here *here) {
    filter_add(s, (1 - GAMMA_VIOLATION) * s->violation, here->cost - GAMMA_COST * s->violation);
}

/* Second-order corrections: WB section 2.4. Returns the share of the corrected step, or 0. */
static double corrected_share(Solver *s, const Here *here, double share, double fraction, double dual_shift,
                              Trial *trial) {
    double corrected = share, before = HUGE_VAL;
    memcpy(s->corrected_residuals, s->residuals, sizeof(double) * s->problem.rows);
    for (int k = 0; k < MOST_CORRECTIONS && trial->violation <= LESS_VIOLATION * before; k++) {
        before = trial->violation;
        for (int j = 0; j < s->problem.rows; j++)
            s->corrected_residuals[j] = corrected * s->corrected_residuals[j] + s->trial_residuals[j];
        set_right_side(s, s->corrected_residuals);
        solve_system(s, s->now.hessian, dual_shift);
        expand_solution(s, s->corrected_step, s->corrected_multiplier_step);
        corrected = largest_step(s, s->corrected_step, fraction);
        move(s->primals_now, s->corrected_step, corrected, s->primals, s->trial_primals);
        evaluate_values(s, s->trial_primals, &s->trial);
        measure_trial(s, trial);
        if (accepts(s, here, share, trial))
            return corrected;
    }
    return 0;
}

/* The share of the forces' steps that keeps them positive: WB equation 15b. */
double forces_share(const Solver *s, double fraction) {
    double share = 1;
    for (int i = 0; i < s->primals; i++) {
        if (bounded_below(s, i) && s->lower_step[i] < 0)
            share = fmin(share, -fraction * s->lower_forces[i] / s->lower_step[i]);
        if (bounded_above(s, i) && s->upper_step[i] < 0)
            share = fmin(share, -fraction * s->upper_forces[i] / s->upper_step[i]);
    }
    return share;
}

void adopt(double **now, double **trial) {
    double *before = *now;
    *now = *trial;
    *trial = before;
}

/* The corrected step in place of the step, as IPOPT has it: the forces' steps follow from it, too. */
static void take_corrected(Solver *s) {
    adopt(&s->step, &s->corrected_step);
    adopt(&s->multiplier_step, &s->corrected_multiplier_step);
    set_force_steps(s);
}

static void adopt_evaluation(Solver *s) {
    Evaluation before = s->now;
    s->now = s->trial;
    s->trial = before;
}

/* Mean sizes of what the optimality conditions of the barrier problem leave. */
static double conditions_error(Solver *s, const double *primals, const double *multipliers,
                               const double *lower_forces, const double *upper_forces, const Evaluation *at,
                               const double *residuals) {
    int variables = s->problem.variables, rows = s->problem.rows, forces = 0;
    double dual = 0, complementary = 0, primal = 0;
    jacobian_transposed(s, at, multipliers, s->transposed);
    for (int i = 0; i < s->primals; i++) {
        double slope = i < variables ? at->gradient[i] + s->transposed[i]
                                     : -multipliers[s->slack_rows[i - variables]];
        if (bounded_below(s, i)) {
            slope -= lower_forces[i];
            complementary += fabs((primals[i] - s->lower[i]) * lower_forces[i] - s->barrier);
            forces++;
        }
        if (bounded_above(s, i)) {
            slope += upper_forces[i];
            complementary += fabs((s->upper[i] - primals[i]) * upper_forces[i] - s->barrier);
            forces++;
        }
        dual += fabs(slope);
    }
    for (int j = 0; j < rows; j++)
        primal += fabs(residuals[j]);
    return dual / s->primals + primal / fmax(1, rows) + complementary / fmax(1, forces);
}

/* Soft restoration: a full step in all unknowns that lessens the error of the optimality conditions, as in IPOPT
   (WB section 3.3 asks for no more). */
static int soft_step(Solver *s, const Here *here, double share) {
    int rows = s->problem.rows;
    move(s->primals_now, s->step, share, s->primals, s->trial_primals);
    move(s->multipliers, s->multiplier_step, share, rows, s->trial_multipliers);
    move(s->lower_forces, s->lower_step, share, s->primals, s->trial_lower);
    move(s->upper_forces, s->upper_step, share, s->primals, s->trial_upper);
    evaluate_all(s, s->trial_primals, s->trial_multipliers, &s->trial);
    take_residuals(s, s->trial.rows, s->trial_primals, s->trial_residuals);
    double before = conditions_error(s, s->primals_now, s->multipliers, s->lower_forces, s->upper_forces, &s->now,
                                     s->residuals);
    double after = conditions_error(s, s->trial_primals, s->trial_multipliers, s->trial_lower, s->trial_upper,
                                    &s->trial, s->trial_residuals);
    if (!(after <= SOFT_DECREASE * before))
        return 0;
    add_here(s, here);
    adopt(&s->primals_now, &s->trial_primals);
    adopt(&s->multipliers, &s->trial_multipliers);
    adopt(&s->lower_forces, &s->trial_lower);
    adopt(&s->upper_forces, &s->trial_upper);
    adopt_evaluation(s);
    return 1;
}

/* WB equation 23, times gamma_alpha. */
static double least_share(const Solver *s, const Here *here) {
    double least = GAMMA_VIOLATION;
    if (here->slope < 0) {
        least = fmin(least, GAMMA_COST * s->violation / -here->slope);
        if (s->violation <= s->small_violation)
            least = fmin(least, pow(s->violation, S_VIOLATION) / pow(-here->slope, S_COST));
    }
    return LEAST_SHARE * least;
}

/* Take a step to an acceptable point, which is then evaluated as the current one. Returns 0 where there is none:
   nothing has changed then but the filter, which keeps off the point. */
int line_search(Solver *s, double fraction, double dual_shift) {
    Here here = measured(s);
    double primal = largest_step(s, s->step, fraction), forces = forces_share(s, fraction);
    double share = primal, least = least_share(s, &here);
    Trial trial;
    int found = 0, evaluated = 0;
    for (int first = 1; first || share > least; first = 0, share *= 0.5) {
        move(s->primals_now, s->step, share, s->primals, s->trial_primals);
        evaluated = first;
        if (first) { /* mostly accepted: everything at once is cheaper */
            move(s->multipliers, s->multiplier_step, share, s->problem.rows, s->trial_multipliers);
            evaluate_all(s, s->trial_primals, s->trial_multipliers, &s->trial);
        } else
            evaluate_values(s, s->trial_primals, &s->trial);
        measure_trial(s, &trial);
        if ((found = accepts(s, &here, share, &trial)))
            break;
        if (first && trial.violation >= s->violation) {
            double corrected = corrected_share(s, &here, share, fraction, dual_shift, &trial);
            if (corrected > 0) {
                found = 1, evaluated = 0;
                share = corrected;
                take_corrected(s);
                forces = forces_share(s, fraction);
                break;
            }
        }
    }
    if (!found) {
        if (s->soft_steps < MOST_SOFT_STEPS && soft_step(s, &here, fmin(primal, forces))) {
            s->soft_steps++;
            return 1;
        }
        s->soft_steps = 0;
        add_here(s, &here);
        return 0;
    }
    s->soft_steps = 0;
    if (!(trial.switching && trial.sufficient))
        add_here(s, &here);
    adopt(&s->primals_now, &s->trial_primals);
    move(s->multipliers, s->multiplier_step, share, s->problem.rows, s->multipliers);
    move(s->lower_forces, s->lower_step, forces, s->primals, s->lower_forces);
    move(s->upper_forces, s->upper_step, forces, s->primals, s->upper_forces);
    if (evaluated)
        adopt_evaluation(s);
    else
        evaluate_all(s, s->primals_now, s->multipliers, &s->now);
    return 1;
}
