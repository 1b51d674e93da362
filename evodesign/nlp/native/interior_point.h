/* A primal-dual interior-point method with a filter line search, for programs of fixed sparsity:

       minimise f(x)   subject to   lower <= x <= upper,   row_lower <= g(x) <= row_upper

   Source: Waechter and Biegler, Mathematical Programming 106 (2006), 25-57, cited as WB with its equations.
   Rows with different limits get a slack s between them; v = (x, s). All memory is taken in `create`. */

#ifndef EVODESIGN_INTERIOR_POINT_H
#define EVODESIGN_INTERIOR_POINT_H

typedef long long Size; /* CasADi's integer */
typedef int (*Function)(const double **arguments, double **results, Size *integers, double *work, int memory);

/* Where each entry of a block, one repetition after the other, is added among the program's, and with which weight:
   `starts` of each entry among `places`. */
typedef struct {
    const int *starts, *places;
    const double *weights;
} Scatter;

/* A part of a program that repeats: repetition k has f(y_k, p_k, s) and g(y_k, p_k, s) with y_k = A_k x + b_k, p_k
   numbers of its own and s numbers that all share. The image is stored by rows, one repetition after the other. */
typedef struct {
    int repetitions, lanes; /* how many the functions take at once */
    int symbols, own, rows, jacobian_entries, hessian_entries;
    Function values;      /* (y, p, s) -> f, g */
    Function derivatives; /* (y, p, s, multipliers) -> f, grad f, g, jacobian, hessian */
    const int *image_starts, *image_columns;
    const double *image, *constants; /* A and b */
    Scatter jacobian, hessian;
} Block;

/* A row that is there only where a parameter is not zero; elsewhere it has a value that violates nothing, and no
   derivatives. Its entries are added to those of the program. */
typedef struct {
    int parameter, row;
    int jacobian_entries, hessian_entries;
    const int *jacobian_places, *hessian_places;
    Function values;      /* (x, p) -> g */
    Function derivatives; /* (x, p, y) -> g, jacobian, hessian */
} SwitchedRow;

/* What is known of a program before it is solved. Matrices are stored by columns: `starts` of each column among
   the `rows` of its entries. */
typedef struct {
    int variables, rows;
    const double *lower, *upper, *row_lower, *row_upper; /* beyond +-UNBOUNDED: none */
    const int *hessian_starts, *hessian_rows;            /* of the Lagrangian, upper triangle */
    const int *jacobian_starts, *jacobian_rows;
    const int *order;                     /* of elimination: order[new] = old, variables and then rows */
    const int *system_starts, *system_rows; /* reordered system, upper triangle */
    const int *hessian_places, *jacobian_places, *diagonal_places; /* of entries, in the reordered system */
    const int *factor_starts, *factor_rows;     /* L below its diagonal, by columns */
    const int *pattern_starts, *pattern;        /* L below its diagonal, columns of each row, ascending */
    Function values;      /* (x, p) -> f, g */
    Function derivatives; /* (x, p, y) -> f, grad f, g, jacobian, hessian */
    Function slopes;      /* (x, p, y) -> gradients of f + y g by p and by variables that are no variables here */
    Size work, integers;  /* what the functions need */
    int block_count, shared; /* blocks, in place of functions; numbers that they share come first among p */
    const Block *blocks;     /* the rows of one after those of the other */
    int switched_count;
    const SwitchedRow *switched;
} Problem;

typedef struct {
    double tolerance;
    double seconds;
    double barrier;    /* mu at the start */
    double push;       /* least distance of the start from bounds, relative */
    double relaxation; /* of bounds, relative */
    int iterations;
    int near; /* whether multipliers of bounds follow from mu at the start */
} Options;

/* In the order of Python's WORDS. */
typedef enum {
    SOLVED,
    ACCEPTABLE,
    ITERATION_LIMIT,
    TIME_LIMIT,
    INFEASIBLE,
    RESTORATION_FAILED,
    STEP_FAILED,
    INVALID_NUMBER
} Status;

typedef struct {
    double cost;
    int status, iterations, restorations;
} Outcome;

typedef struct Solver Solver;

Solver *create(const Problem *problem); /* NULL where memory is short */
void destroy(Solver *solver);

/* Solve from x, which the solution replaces, with the multipliers of variables' bounds and of rows, and with the
   slopes of the Lagrangian, where the program is not made of blocks. */
void solve(Solver *solver, const Options *options, const double *parameters, double *x, double *bounds,
           double *rows, double *parameter_slopes, double *fixed_slopes, Outcome *outcome);

#endif
