/* The program and its barrier problem at a point. */

#include "solver.h"

static void add_entries(double *entries, const int *places, const double *added, int count) {
    for (int k = 0; k < count; k++)
        entries[places[k]] += added[k];
}

/* The rows that are on; derivatives where there are multipliers. */
static void evaluate_switched(Solver *s, const double *primals, const double *multipliers, Evaluation *at) {
    const double *arguments[3] = {primals, s->parameters, multipliers};
    for (int k = 0; k < s->problem.switched_count; k++) {
        const SwitchedRow *row = &s->problem.switched[k];
        if (s->parameters[row->parameter] == 0)
            continue;
        double jacobian[row->jacobian_entries + 1], hessian[row->hessian_entries + 1];
        double *results[3] = {&at->rows[row->row], jacobian, hessian};
        if (!multipliers) {
            row->values(arguments, results, s->integers, s->work, 0);
            continue;
        }
        row->derivatives(arguments, results, s->integers, s->work, 0);
        add_entries(at->jacobian, row->jacobian_places, jacobian, row->jacobian_entries);
        add_entries(at->hessian, row->hessian_places, hessian, row->hessian_entries);
    }
}

void evaluate_all(Solver *s, const double *primals, const double *multipliers, Evaluation *at) {
    if (s->problem.blocks) {
        evaluate_blocks(s, primals, multipliers, at);
        return;
    }
    const double *arguments[3] = {primals, s->parameters, multipliers};
    double *results[5] = {&at->cost, at->gradient, at->rows, at->jacobian, at->hessian};
    s->problem.derivatives(arguments, results, s->integers, s->work, 0);
    evaluate_switched(s, primals, multipliers, at);
}

void evaluate_values(Solver *s, const double *primals, Evaluation *at) {
    if (s->problem.blocks) {
        evaluate_blocks(s, primals, NULL, at);
        return;
    }
    const double *arguments[2] = {primals, s->parameters};
    double *results[2] = {&at->cost, at->rows};
    s->problem.values(arguments, results, s->integers, s->work, 0);
    evaluate_switched(s, primals, NULL, at);
}

/* Rows less their limit or their slack; returns the sum of their sizes, WB's theta. */
double take_residuals(const Solver *s, const double *rows, const double *primals, double *residuals) {
    double violation = 0;
    for (int j = 0; j < s->problem.rows; j++) {
        int slack = s->slack_of[j];
        residuals[j] = rows[j] - (slack < 0 ? s->problem.row_lower[j] : primals[slack]);
        violation += fabs(residuals[j]);
    }
    return violation;
}

double largest(const double *values, int count) {
    double most = 0;
    for (int i = 0; i < count; i++)
        most = larger(most, fabs(values[i]));
    return most;
}

/* WB equation 3a, with the damping of section 3.7 for what is bounded on one side only. Logarithms are dear, so
   they are taken of products, as long as these are neither huge nor tiny. */
double barrier_cost(const Solver *s, double cost, const double *primals) {
    double logarithms = 0, product = 1, distances = 0;
    for (int i = 0; i < s->primals; i++) {
        int below = bounded_below(s, i), above = bounded_above(s, i);
        double low = primals[i] - s->lower[i], high = s->upper[i] - primals[i];
        product *= (below ? low : 1) * (above ? high : 1);
        if (!(product > 1e-200 && product < 1e200)) {
            logarithms += log(product);
            product = 1;
        }
        if (below != above)
            distances += below ? low : high;
    }
    return cost - s->barrier * (logarithms + log(product)) + DAMPING * s->barrier * distances;
}

void jacobian_transposed(const Solver *s, const Evaluation *at, const double *multipliers, double *product) {
    const Problem *p = &s->problem;
    for (int column = 0; column < p->variables; column++) {
        double sum = 0;
        for (int k = p->jacobian_starts[column]; k < p->jacobian_starts[column + 1]; k++)
            sum += at->jacobian[k] * multipliers[p->jacobian_rows[k]];
        product[column] = sum;
    }
}

/* The largest share of a step, at most 1, that leaves of each distance to a bound 1 - fraction: WB equation 15a. */
double largest_step(const Solver *s, const double *step, double fraction) {
    double share = 1;
    for (int i = 0; i < s->primals; i++) {
        if (bounded_below(s, i) && step[i] < 0)
            share = fmin(share, -fraction * (s->primals_now[i] - s->lower[i]) / step[i]);
        if (bounded_above(s, i) && step[i] > 0)
            share = fmin(share, fraction * (s->upper[i] - s->primals_now[i]) / step[i]);
    }
    return share;
}
