/* A program put together from blocks that repeat: each repetition sees y = A x + b, and what it says is added
   where the tables send it. A block's functions take several repetitions at once, each in a lane: of every number
   that of the first repetition, then that of the next. */

#include "solver.h"

/* y = A x + b of one repetition, into its lane. */
static void see(const Block *block, int first, const double *variables, double *seen) {
    for (int i = 0; i < block->symbols; i++) {
        int row = first + i;
        double sum = block->constants[row];
        for (int k = block->image_starts[row]; k < block->image_starts[row + 1]; k++)
            sum += block->image[k] * variables[block->image_columns[k]];
        seen[i * block->lanes] = sum;
    }
}

/* A' gradient of one repetition, added. */
static void add_slopes(const Block *block, int first, const double *slopes, double *gradient) {
    for (int i = 0; i < block->symbols; i++)
        for (int k = block->image_starts[first + i]; k < block->image_starts[first + i + 1]; k++)
            gradient[block->image_columns[k]] += block->image[k] * slopes[i * block->lanes];
}

/* The entries of one repetition, added to those of the program. */
static void add_entries(const Scatter *to, int first, int count, const double *entries, int lanes, double *matrix) {
    for (int e = 0; e < count; e++)
        for (int k = to->starts[first + e]; k < to->starts[first + e + 1]; k++)
            matrix[to->places[k]] += to->weights[k] * entries[e * lanes];
}

/* Numbers into a lane. */
static void put(const double *numbers, int count, int lanes, double *lane) {
    for (int i = 0; i < count; i++)
        lane[i * lanes] = numbers[i];
}

/* Cost and rows; with multipliers, their derivatives, too. Lanes that are left over repeat the last repetition. */
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
        int lanes = block->lanes, last = block->repetitions - 1;
        double *cost = s->work, *seen = cost + lanes, *slopes = seen + lanes * block->symbols;
        double *owned = slopes + lanes * block->symbols, *shared = owned + lanes * block->own;
        double *said = shared + lanes * p->shared, *forces = said + lanes * block->rows;
        double *jacobian = forces + lanes * block->rows, *hessian = jacobian + lanes * block->jacobian_entries;
        double *work = hessian + lanes * block->hessian_entries;
        const double *arguments[4] = {seen, owned, shared, forces};
        for (int lane = 0; lane < lanes; lane++)
            put(s->parameters, p->shared, lanes, shared + lane);
        for (int begin = 0; begin <= last; begin += lanes) {
            int end = begin + lanes > last ? last + 1 : begin + lanes;
            for (int lane = 0; lane < lanes; lane++) {
                int k = begin + lane > last ? last : begin + lane;
                see(block, k * block->symbols, primals, seen + lane);
                put(own + k * block->own, block->own, lanes, owned + lane);
                if (multipliers)
                    put(multipliers + k * block->rows, block->rows, lanes, forces + lane);
            }
            if (multipliers) {
                double *results[5] = {cost, slopes, said, jacobian, hessian};
                block->derivatives(arguments, results, s->integers, work, 0);
            } else {
                double *results[2] = {cost, said};
                block->values(arguments, results, s->integers, work, 0);
            }
            for (int k = begin, lane = 0; k < end; k++, lane++) {
                for (int i = 0; i < block->rows; i++)
                    rows[k * block->rows + i] = said[i * lanes + lane];
                at->cost += cost[lane];
                if (multipliers) {
                    add_slopes(block, k * block->symbols, slopes + lane, at->gradient);
                    add_entries(&block->jacobian, k * block->jacobian_entries, block->jacobian_entries,
                                jacobian + lane, lanes, at->jacobian);
                    add_entries(&block->hessian, k * block->hessian_entries, block->hessian_entries, hessian + lane,
                                lanes, at->hessian);
                }
            }
        }
        own += block->repetitions * block->own;
        rows += block->repetitions * block->rows;
        if (multipliers)
            multipliers += block->repetitions * block->rows;
    }
}
