/* ISO C11, 7.22. */

#ifndef EVODESIGN_STDLIB_H
#define EVODESIGN_STDLIB_H

#include <stddef.h>

void *calloc(size_t count, size_t size);
void free(void *memory);

#endif
