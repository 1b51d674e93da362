/* A program put together from blocks that repeat: each repetition sees y = A x + b, and what it says is added
   where the tables send it. */

#include "solver.h"

/* y = A x + b of one repetition. */
static void see(const Block *block, int first, const double *variables, double *seen) {
    for (int i = 0; i < block->symbols; i++) {
        int row = first + i;
        double sum = block->constants[row];
        for (int k = block->image_starts[row]; k < block->image_starts[row + 1]; k++)
            sum += block->image[k] * variables[block->image_columns[k]];
        seen[i] = sum;
    }
}

/* A' gradient, added. */
static void add_slopes(const Block *block, int first, const double *slopes, double *gradient) {
    for (int i = 0; i < block->symbols; i++)
        for (int k = block->image_starts[first + i]; k < block->image_starts[first + i + 1]; k++)
            gradient[block->image_columns[k]] += block->image[k] * slopes[i];
}

/* The entries of one repetition, added to those of the program. */
static void add_entries(const Scatter *to, int first, int count, const double *entries, double *matrix) {
    for (int e = 0; e < count; e++)
        for (int k = to->starts[first + e]; k < to->starts[first + e + 1]; k++)
            matrix[to->places[k]] += to->weights[k] * entries[e];
}

/* Cost and rows; with multipliers, their derivatives, too. */
void evaluate_blocks(Solver *s, const double *primals, const double *multipliers, Evaluation *at) {
    const Problem *p = &s->problem;
    const double *own = s->parameters + p->shared;
    double *rows = at->rows;
    at->cost = 0;
    if (multipliers) {
        memset(at->gradient, 0, sizeof(double) * p->variables);
        memset(at->jacobian, 0, sizeof(double) * p->jacobian_starts[p->variables]);
        memset(at->hessian, 0, sizeof(double) * p->hessian_starts[p->variables]);
    }
    for (const Block *block = p->blocks; block < p->blocks + p->block_count; block++) {
        double *seen = s->work, *slopes = seen + block->symbols, *jacobian = slopes + block->symbols;
        double *hessian = jacobian + block->jacobian_entries, *work = hessian + block->hessian_entries, cost;
        for (int k = 0; k < block->repetitions; k++, rows += block->rows, own += block->own) {
            int first = k * block->symbols;
            see(block, first, primals, seen);
            const double *arguments[4] = {seen, own, s->parameters, multipliers};
            if (multipliers) {
                double *results[5] = {&cost, slopes, rows, jacobian, hessian};
                block->derivatives(arguments, results, s->integers, work, 0);
                add_slopes(block, first, slopes, at->gradient);
                add_entries(&block->jacobian, k * block->jacobian_entries, block->jacobian_entries, jacobian,
                            at->jacobian);
                add_entries(&block->hessian, k * block->hessian_entries, block->hessian_entries, hessian,
                            at->hessian);
                multipliers += block->rows;
            } else {
                double *results[2] = {&cost, rows};
                block->values(arguments, results, s->integers, work, 0);
            }
            at->cost += cost;
        }
    }
}
