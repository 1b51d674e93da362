/* The method: start, barrier problems, end. WB Algorithm A. */

#define _POSIX_C_SOURCE 199309L

#include <stdlib.h>
#include <time.h>

#include "solver.h"

#define LEAST_FRACTION 0.99     /* WB equation 8, tau_min */
#define ENOUGH 10.0             /* WB Algorithm A, kappa_epsilon */
#define LESS_BARRIER 0.2        /* WB equation 7, kappa_mu */
#define BARRIER_POWER 1.5       /* WB equation 7, theta_mu */
#define MOST_SCALED 100.0       /* WB section 2.1, s_max */
#define FAR_FORCE 1e10          /* WB equation 16, kappa_Sigma */
#define SMALL_VIOLATION 1e-4    /* WB section 3.1, theta_min */
#define MOST_VIOLATION 1e4      /* theta_max */
#define LARGEST_DUAL 1.0        /* IPOPT's dual_inf_tol, constr_viol_tol and compl_inf_tol */
#define LARGEST_RESIDUAL 1e-4
#define LARGEST_PRODUCT 1e-4
#define NEARLY 1e-6             /* IPOPT's acceptable_tol, acceptable_constr_viol_tol, acceptable_iter */
#define NEARLY_FEASIBLE 1e-2
#define NEARLY_ITERATIONS 15
#define DIVERGED 1e30
#define INFEASIBLE_RESIDUAL 1e-6 /* IPOPT: 100 tolerances */
#define RESTORATIONS 60
#define MOST_RESTORATIONS 240

/* Errors of the optimality conditions: WB equations 5 and 6. */
typedef struct {
    double dual, complementary, dual_scale, force_scale;
} Errors;

static Errors errors(Solver *s, double barrier) {
    const Problem *p = &s->problem;
    Errors e = {0, 0, 0, 0};
    double multipliers = 0, forces = 0;
    int bounds = 0;
    jacobian_transposed(s, &s->now, s->multipliers, s->transposed);
    for (int i = 0; i < s->primals; i++) {
        double slope = i < p->variables ? s->now.gradient[i] + s->transposed[i]
                                        : -s->multipliers[s->slack_rows[i - p->variables]];
        if (bounded_below(s, i)) {
            slope -= s->lower_forces[i];
            double product = fabs((s->primals_now[i] - s->lower[i]) * s->lower_forces[i] - barrier);
            e.complementary = larger(e.complementary, product);
            forces += s->lower_forces[i];
            bounds++;
        }
        if (bounded_above(s, i)) {
            slope += s->upper_forces[i];
            double product = fabs((s->upper[i] - s->primals_now[i]) * s->upper_forces[i] - barrier);
            e.complementary = larger(e.complementary, product);
            forces += s->upper_forces[i];
            bounds++;
        }
        e.dual = larger(e.dual, fabs(slope));
    }
    for (int j = 0; j < p->rows; j++)
        multipliers += fabs(s->multipliers[j]);
    e.dual_scale = fmax(MOST_SCALED, (multipliers + forces) / fmax(1, p->rows + bounds)) / MOST_SCALED;
    e.force_scale = fmax(MOST_SCALED, forces / fmax(1, bounds)) / MOST_SCALED;
    return e;
}

static double scaled(const Errors *e, double infeasibility) {
    return larger(larger(e->dual / e->dual_scale, infeasibility), e->complementary / e->force_scale);
}

/* WB section 3.6: off the bounds by a share of their size and of their distance. */
static double pushed(double value, double lower, double upper, double push) {
    double below = lower > -UNBOUNDED ? push * fmax(1, fabs(lower)) : 0;
    double above = upper < UNBOUNDED ? push * fmax(1, fabs(upper)) : 0;
    if (lower > -UNBOUNDED && upper < UNBOUNDED) {
        below = fmin(below, push * (upper - lower));
        above = fmin(above, push * (upper - lower));
    }
    if (lower > -UNBOUNDED && value < lower + below)
        value = lower + below;
    if (upper < UNBOUNDED && value > upper - above)
        value = upper - above;
    return value;
}

static double relaxed(double bound, double relaxation) {
    return fabs(bound) < UNBOUNDED ? bound + relaxation * fmax(1, fabs(bound)) : bound;
}

static void begin(Solver *s, const Options *options, const double *x) {
    const Problem *p = &s->problem;
    for (int i = 0; i < s->primals; i++) {
        int row = i < p->variables ? -1 : s->slack_rows[i - p->variables];
        s->lower[i] = relaxed(row < 0 ? p->lower[i] : p->row_lower[row], -options->relaxation);
        s->upper[i] = relaxed(row < 0 ? p->upper[i] : p->row_upper[row], options->relaxation);
    }
    s->barrier = options->barrier;
    s->filter_count = 0;
    s->last_shift = 0;
    s->soft_steps = 0;
    memset(s->multipliers, 0, sizeof(double) * p->rows);
    for (int i = 0; i < p->variables; i++)
        s->primals_now[i] = pushed(x[i], s->lower[i], s->upper[i], options->push);
    evaluate_all(s, s->primals_now, s->multipliers, &s->now);
    for (int k = 0, i = p->variables; k < s->slacks; k++, i++)
        s->primals_now[i] = pushed(s->now.rows[s->slack_rows[k]], s->lower[i], s->upper[i], options->push);
    for (int i = 0; i < s->primals; i++) {
        double below = s->primals_now[i] - s->lower[i], above = s->upper[i] - s->primals_now[i];
        s->lower_forces[i] = !bounded_below(s, i) ? 0 : options->near ? s->barrier / below : 1;
        s->upper_forces[i] = !bounded_above(s, i) ? 0 : options->near ? s->barrier / above : 1;
    }
    estimate_multipliers(s);
    evaluate_all(s, s->primals_now, s->multipliers, &s->now);
    s->violation = take_residuals(s, s->now.rows, s->primals_now, s->residuals);
    s->small_violation = SMALL_VIOLATION * fmax(1, s->violation);
    s->most_violation = MOST_VIOLATION * fmax(1, s->violation);
}

/* A smaller barrier as soon as its problem is solved well enough. */
static void lower_barrier(Solver *s, double tolerance, double infeasibility) {
    double least = fmin(tolerance, LARGEST_PRODUCT) / (ENOUGH + 1);
    while (s->barrier > least) {
        Errors e = errors(s, s->barrier);
        if (!(scaled(&e, infeasibility) <= ENOUGH * s->barrier))
            return;
        double next = fmax(least, fmin(LESS_BARRIER * s->barrier, pow(s->barrier, BARRIER_POWER)));
        if (next >= s->barrier)
            return;
        s->barrier = next;
        s->filter_count = 0;
    }
}

/* WB equation 16: forces not too far from mu / distance. */
static void bound_forces(Solver *s) {
    for (int i = 0; i < s->primals; i++) {
        if (bounded_below(s, i)) {
            double central = s->barrier / (s->primals_now[i] - s->lower[i]);
            s->lower_forces[i] = fmax(fmin(s->lower_forces[i], FAR_FORCE * central), central / FAR_FORCE);
        }
        if (bounded_above(s, i)) {
            double central = s->barrier / (s->upper[i] - s->primals_now[i]);
            s->upper_forces[i] = fmax(fmin(s->upper_forces[i], FAR_FORCE * central), central / FAR_FORCE);
        }
    }
}

static double seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static Status iterate(Solver *s, const Options *options) {
    Outcome *o = s->outcome;
    double until = seconds() + options->seconds;
    int nearly = 0;
    for (;;) {
        Errors e = errors(s, 0);
        double infeasibility = largest(s->residuals, s->problem.rows), error = scaled(&e, infeasibility);
        if (error <= options->tolerance && e.dual <= LARGEST_DUAL && infeasibility <= LARGEST_RESIDUAL &&
            e.complementary <= LARGEST_PRODUCT)
            return SOLVED;
        nearly = error <= NEARLY && infeasibility <= NEARLY_FEASIBLE ? nearly + 1 : 0;
        if (nearly == NEARLY_ITERATIONS)
            return ACCEPTABLE;
        if (!(error < DIVERGED) || !isfinite(s->now.cost))
            return INVALID_NUMBER;
        if (o->iterations + o->restorations >= options->iterations)
            return ITERATION_LIMIT;
        if (seconds() > until)
            return TIME_LIMIT;
        lower_barrier(s, options->tolerance, infeasibility);
        double dual_shift;
        if (!find_direction(s, &dual_shift))
            return nearly ? ACCEPTABLE : STEP_FAILED;
        double fraction = fmax(LEAST_FRACTION, 1 - s->barrier);
        if (!line_search(s, fraction, dual_shift)) {
            if (nearly)
                return ACCEPTABLE;
            if (o->restorations >= MOST_RESTORATIONS)
                return RESTORATION_FAILED;
            int left = options->iterations - o->iterations - o->restorations;
            if (!restore(s, RESTORATIONS < left ? RESTORATIONS : left)) {
                if (o->iterations + o->restorations >= options->iterations)
                    return ITERATION_LIMIT;
                return largest(s->residuals, s->problem.rows) > INFEASIBLE_RESIDUAL ? INFEASIBLE
                                                                                    : RESTORATION_FAILED;
            }
            leave_restoration(s, fraction);
        }
        s->violation = take_residuals(s, s->now.rows, s->primals_now, s->residuals);
        bound_forces(s);
        o->iterations++;
    }
}

void solve(Solver *s, const Options *options, const double *parameters, double *x, double *bounds, double *rows,
           double *parameter_slopes, double *fixed_slopes, Outcome *outcome) {
    memset(outcome, 0, sizeof(*outcome));
    s->parameters = parameters;
    s->outcome = outcome;
    begin(s, options, x);
    outcome->status = iterate(s, options);
    outcome->cost = s->now.cost;
    memcpy(x, s->primals_now, sizeof(double) * s->problem.variables);
    memcpy(rows, s->multipliers, sizeof(double) * s->problem.rows);
    for (int i = 0; i < s->problem.variables; i++)
        bounds[i] = s->upper_forces[i] - s->lower_forces[i];
    if (s->problem.blocks)
        return;
    const double *arguments[3] = {x, parameters, rows};
    double *results[2] = {parameter_slopes, fixed_slopes};
    s->problem.slopes(arguments, results, s->integers, s->work, 0);
}

/* One block of zeros, and a vector after another from it. */
typedef struct {
    char *next;
    size_t size;
} Arena;

static void *taken(Arena *arena, size_t count, size_t size) {
    void *place = arena->next ? arena->next + arena->size : NULL;
    arena->size += (count * size + 15) / 16 * 16;
    return place;
}

static void lay_out(Solver *s, Arena *arena) {
    const Problem *p = &s->problem;
    size_t primals = (size_t)s->primals, rows = (size_t)p->rows, unknowns = (size_t)s->unknowns;
    double **by_primals[] = {&s->lower, &s->upper, &s->primals_now, &s->lower_forces, &s->upper_forces, &s->slope,
                             &s->curvature, &s->step, &s->lower_step, &s->upper_step, &s->corrected_step,
                             &s->trial_primals, &s->trial_lower, &s->trial_upper, &s->reference};
    double **by_rows[] = {&s->multipliers, &s->residuals, &s->multiplier_step, &s->corrected_multiplier_step,
                          &s->corrected_residuals, &s->trial_multipliers, &s->trial_residuals};
    double **by_unknowns[] = {&s->inverse_pivots, &s->row_work, &s->right, &s->solution, &s->remainder,
                              &s->ordered, &s->transposed};
    Evaluation *evaluations[] = {&s->now, &s->trial};
    for (size_t k = 0; k < sizeof(by_primals) / sizeof(*by_primals); k++)
        *by_primals[k] = taken(arena, primals, sizeof(double));
    for (size_t k = 0; k < sizeof(by_rows) / sizeof(*by_rows); k++)
        *by_rows[k] = taken(arena, rows, sizeof(double));
    for (size_t k = 0; k < sizeof(by_unknowns) / sizeof(*by_unknowns); k++)
        *by_unknowns[k] = taken(arena, unknowns, sizeof(double));
    for (size_t k = 0; k < sizeof(evaluations) / sizeof(*evaluations); k++) {
        Evaluation *at = evaluations[k];
        at->gradient = taken(arena, (size_t)p->variables, sizeof(double));
        at->rows = taken(arena, rows, sizeof(double));
        at->jacobian = taken(arena, (size_t)p->jacobian_starts[p->variables], sizeof(double));
        at->hessian = taken(arena, (size_t)p->hessian_starts[p->variables], sizeof(double));
    }
    s->system = taken(arena, (size_t)p->system_starts[s->unknowns], sizeof(double));
    s->factor = taken(arena, (size_t)p->factor_starts[s->unknowns], sizeof(double));
    s->work = taken(arena, (size_t)p->work, sizeof(double));
    s->integers = taken(arena, (size_t)p->integers, sizeof(Size));
    s->filled = taken(arena, unknowns, sizeof(int));
    s->slack_rows = taken(arena, rows, sizeof(int));
    s->slack_of = taken(arena, rows, sizeof(int));
}

Solver *create(const Problem *problem) {
    Solver shape = {.problem = *problem};
    for (int j = 0; j < problem->rows; j++)
        shape.slacks += problem->row_lower[j] != problem->row_upper[j];
    shape.primals = problem->variables + shape.slacks;
    shape.unknowns = problem->variables + problem->rows;
    Arena arena = {NULL, 0};
    lay_out(&shape, &arena);
    size_t head = (sizeof(Solver) + 15) / 16 * 16;
    Solver *s = calloc(1, head + arena.size);
    if (!s)
        return NULL;
    *s = shape;
    arena = (Arena){(char *)s + head, 0};
    lay_out(s, &arena);
    for (int j = 0, slack = 0; j < problem->rows; j++) {
        int between = problem->row_lower[j] != problem->row_upper[j];
        s->slack_of[j] = between ? problem->variables + slack : -1;
        if (between)
            s->slack_rows[slack++] = j;
    }
    return s;
}

void destroy(Solver *solver) {
    free(solver);
}
