/* The symmetric system of a step, with slacks and forces of bounds eliminated:

       | H + C_x   J'                 | | x step          |
       | J        -(1/C_s or 0) - d_c | | multiplier step |  =  right        C: curvature, by primals

   L D L' of fixed pattern, row by row (Davis, Direct Methods for Sparse Linear Systems, 2006, section 4.8), with
   no pivoting: the order pairs each equality's row with a variable, and steps of refinement undo d_c. */

#include "solver.h"

#define LEAST_PIVOT 1e-18
#define REFINEMENTS 3
#define REFINED 1e-11

/* Subtract a multiple of part of a column. Pointers and steps of four serve a compiler that does not optimise; to
   one that does, they make no difference. */
static inline void subtract(const double *restrict factor, const int *restrict below, int from, int until,
                            double value, double *restrict vector) {
    const double *entry = factor + from;
    const int *row = below + from, *end = below + until;
    for (; row + 3 < end; row += 4, entry += 4) {
        vector[row[0]] -= entry[0] * value;
        vector[row[1]] -= entry[1] * value;
        vector[row[2]] -= entry[2] * value;
        vector[row[3]] -= entry[3] * value;
    }
    for (; row < end; row++, entry++)
        vector[*row] -= *entry * value;
}

/* value less the product of part of a column with a vector, in the column's order. */
static inline double less_product(double value, const double *restrict factor, const int *restrict below, int from,
                                  int until, const double *restrict vector) {
    const double *entry = factor + from;
    const int *row = below + from, *end = below + until;
    for (; row + 3 < end; row += 4, entry += 4)
        value = value - entry[0] * vector[row[0]] - entry[1] * vector[row[1]] - entry[2] * vector[row[2]] -
                entry[3] * vector[row[3]];
    for (; row < end; row++, entry++)
        value -= *entry * vector[*row];
    return value;
}

/* Number of positive pivots, or -1 where a pivot is nearly zero; `hessian` NULL stands for zeros. */
int factorise(Solver *s, const double *hessian, double dual_shift) {
    const Problem *p = &s->problem;
    const int *restrict starts = p->factor_starts, *restrict below = p->factor_rows;
    double *restrict system = s->system, *restrict factor = s->factor, *restrict row = s->row_work;
    double *restrict inverse = s->inverse_pivots;
    int *restrict filled = s->filled;
    memset(system, 0, sizeof(double) * p->system_starts[s->unknowns]);
    if (hessian)
        for (int k = 0; k < p->hessian_starts[p->variables]; k++)
            system[p->hessian_places[k]] = hessian[k];
    for (int k = 0; k < p->jacobian_starts[p->variables]; k++)
        system[p->jacobian_places[k]] = s->now.jacobian[k];
    for (int i = 0; i < p->variables; i++)
        system[p->diagonal_places[i]] += s->curvature[i];
    for (int j = 0; j < p->rows; j++) {
        int slack = s->slack_of[j];
        system[p->diagonal_places[p->variables + j]] =
            (slack < 0 ? 0.0 : -1.0 / s->curvature[slack]) - dual_shift;
    }
    int positive = 0, regular = 1;
    for (int i = 0; i < s->unknowns; i++)
        filled[i] = starts[i];
    for (int i = 0; i < s->unknowns; i++) {
        for (int k = p->system_starts[i]; k < p->system_starts[i + 1]; k++)
            row[p->system_rows[k]] = system[k];
        double pivot = row[i];
        row[i] = 0;
        for (int k = p->pattern_starts[i]; k < p->pattern_starts[i + 1]; k++) {
            int column = p->pattern[k], last = filled[column];
            double value = row[column];
            filled[column] = last + 1;
            factor[last] = 0;
            if (value == 0) /* as for a row that is off */
                continue;
            row[column] = 0;
            subtract(factor, below, starts[column], last, value, row);
            double entry = value * inverse[column];
            pivot -= value * entry;
            factor[last] = entry;
        }
        if (!(fabs(pivot) > LEAST_PIVOT)) {
            regular = 0;
            pivot = pivot < 0 ? -LEAST_PIVOT : LEAST_PIVOT;
        }
        inverse[i] = 1.0 / pivot;
        positive += pivot > 0;
    }
    return regular ? positive : -1;
}

static void solve_factored(Solver *s, const double *right, double *solution) {
    const Problem *p = &s->problem;
    const int *restrict starts = p->factor_starts, *restrict below = p->factor_rows;
    const double *restrict factor = s->factor;
    double *restrict z = s->ordered;
    for (int i = 0; i < s->unknowns; i++)
        z[i] = right[p->order[i]];
    for (int i = 0; i < s->unknowns; i++) {
        double value = z[i];
        if (value != 0)
            subtract(factor, below, starts[i], starts[i + 1], value, z);
    }
    for (int i = s->unknowns - 1; i >= 0; i--) {
        z[i] = less_product(z[i] * s->inverse_pivots[i], factor, below, starts[i], starts[i + 1], z);
    }
    for (int i = 0; i < s->unknowns; i++)
        solution[p->order[i]] = z[i];
}

/* What the system with d_c = `dual_shift` leaves of the right side. */
static void take_remainder(Solver *s, const double *hessian, double dual_shift) {
    const Problem *p = &s->problem;
    const double *restrict x = s->solution;
    double *restrict r = s->remainder;
    for (int i = 0; i < p->variables; i++)
        r[i] = s->right[i] - s->curvature[i] * x[i];
    for (int j = 0; j < p->rows; j++) {
        int slack = s->slack_of[j], at = p->variables + j;
        r[at] = s->right[at] + x[at] * (slack < 0 ? dual_shift : dual_shift + 1.0 / s->curvature[slack]);
    }
    for (int column = 0; hessian && column < p->variables; column++) {
        double value = x[column], sum = 0;
        for (int k = p->hessian_starts[column]; k < p->hessian_starts[column + 1]; k++) {
            int i = p->hessian_rows[k];
            sum += hessian[k] * x[i];
            if (i != column)
                r[i] -= hessian[k] * value;
        }
        r[column] -= sum;
    }
    for (int column = 0; column < p->variables; column++) {
        double value = x[column], sum = 0;
        for (int k = p->jacobian_starts[column]; k < p->jacobian_starts[column + 1]; k++) {
            int at = p->variables + p->jacobian_rows[k];
            sum += s->now.jacobian[k] * x[at];
            r[at] -= s->now.jacobian[k] * value;
        }
        r[column] -= sum;
    }
}

/* Solve the factorised system; the size of what remains, relative to the right side, is returned. */
double solve_system(Solver *s, const double *hessian, double dual_shift) {
    double size = largest(s->right, s->unknowns) + 1e-30, left = 0;
    solve_factored(s, s->right, s->solution);
    for (int round = 0; round <= REFINEMENTS; round++) {
        take_remainder(s, hessian, dual_shift);
        double most = largest(s->solution, s->unknowns);
        left = largest(s->remainder, s->unknowns) / (size + 1e-3 * fmin(most, 1e6 * size));
        if (!(left > REFINED) || round == REFINEMENTS)
            break;
        solve_factored(s, s->remainder, s->transposed);
        for (int i = 0; i < s->unknowns; i++)
            s->solution[i] += s->transposed[i];
    }
    return left;
}
