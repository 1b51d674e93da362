/* The program and its barrier problem at a point. */

#include "solver.h"

void evaluate_all(Solver *s, const double *primals, const double *multipliers, Evaluation *at) {
    if (s->problem.blocks) {
        evaluate_blocks(s, primals, multipliers, at);
        return;
    }
    const double *arguments[3] = {primals, s->parameters, multipliers};
    double *results[5] = {&at->cost, at->gradient, at->rows, at->jacobian, at->hessian};
    s->problem.derivatives(arguments, results, s->integers, s->work, 0);
}

void evaluate_values(Solver *s, const double *primals, Evaluation *at) {
    if (s->problem.blocks) {
        evaluate_blocks(s, primals, NULL, at);
        return;
    }
    const double *arguments[2] = {primals, s->parameters};
    double *results[2] = {&at->cost, at->rows};
    s->problem.values(arguments, results, s->integers, s->work, 0);
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
