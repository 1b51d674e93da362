/* The filter: pairs of violation and barrier cost that no later iterate may be worse than in both. */

#include "solver.h"

/* value <= limit but for rounding in numbers of that size: IPOPT's Compare_le. */
int not_above(double value, double limit, double size) {
    return value - limit <= 10 * 2.220446049250313e-16 * fabs(size);
}

int filter_accepts(const Solver *s, double violation, double cost) {
    for (int k = 0; k < s->filter_count; k++) {
        const double *entry = s->filter[k];
        if (!not_above(violation, entry[0], entry[0]) && !not_above(cost, entry[1], entry[1]))
            return 0;
    }
    return 1;
}

/* Entries that the new one dominates go. */
void filter_add(Solver *s, double violation, double cost) {
    int kept = 0;
    for (int k = 0; k < s->filter_count; k++)
        if (!(s->filter[k][0] >= violation && s->filter[k][1] >= cost)) {
            s->filter[kept][0] = s->filter[k][0];
            s->filter[kept][1] = s->filter[k][1];
            kept++;
        }
    if (kept == FILTER_SIZE) { /* the oldest goes: solves end long before */
        memmove(s->filter[0], s->filter[1], sizeof(s->filter[0]) * (FILTER_SIZE - 1));
        kept--;
    }
    s->filter[kept][0] = violation;
    s->filter[kept][1] = cost;
    s->filter_count = kept + 1;
}
