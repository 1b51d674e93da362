/* ISO C11, 7.19. */

#ifndef EVODESIGN_STDDEF_H
#define EVODESIGN_STDDEF_H

typedef __SIZE_TYPE__ size_t;

#define NULL ((void *)0)

#endif
