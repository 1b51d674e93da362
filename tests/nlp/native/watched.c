/* Solves many draws of a random program, bad numbers too, for sanitizers to watch: prints how many were solved
   and how many were not. The method's memory is not zeroed (`calloc` is `unwritten` in its files), so that a
   number that is read before it is written does not pass as a zero. */

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "interior_point.h"

const Problem *evodesign_problem(void);
void *unwritten(size_t count, size_t size);

void *unwritten(size_t count, size_t size) {
    return malloc(count * size);
}

int main(void) {
    const Problem *problem = evodesign_problem();
    Solver *solver = create(problem);
    double *x = malloc(problem->variables * sizeof(double)), *given = malloc(NUMBERS * sizeof(double));
    double *bounds = malloc(problem->variables * sizeof(double)), *slopes = malloc(NUMBERS * sizeof(double));
    double *rows = malloc((problem->rows + 1) * sizeof(double)), fixed[64], sum = 0;
    Options options = {1e-8, 20, 0.1, 1e-2, 1e-8, 300, 0};
    int ends[2] = {0, 0};
    for (int draw = 0; draw < 300; draw++) {
        for (int k = 0; k < NUMBERS; k++)
            given[k] = 4.0 * rand() / RAND_MAX - 2.0;
        if (draw % 50 == 49)
            given[draw % NUMBERS] = draw % 100 == 99 ? NAN : INFINITY;
        for (int k = 0; k < problem->variables; k++)
            x[k] = draw % 7 == 6 ? 1e6 : 0.1;
        Outcome outcome;
        options.near = draw % 5 == 4;
        solve(solver, &options, given, x, bounds, rows, slopes, fixed, &outcome);
        ends[outcome.status > ACCEPTABLE]++;
        for (int k = 0; k < problem->variables; k++)
            sum += x[k] + bounds[k] > 0; /* a decision by each result: it has been written */
        for (int k = 0; k < problem->rows; k++)
            sum += rows[k] > 0;
        for (int k = 0; k < NUMBERS; k++)
            sum += slopes[k] + outcome.cost > 0;
    }
    destroy(solver);
    free(x), free(bounds), free(rows), free(given), free(slopes);
    printf("%d %d\n", ends[0], ends[1]);
    return sum < 0;
}
