/* POSIX.1-2008, <time.h>, as Linux and macOS of 64 bits have it. */

#ifndef EVODESIGN_TIME_H
#define EVODESIGN_TIME_H

struct timespec {
    long tv_sec, tv_nsec;
};

#ifdef __APPLE__
#define CLOCK_MONOTONIC 6
#else
#define CLOCK_MONOTONIC 1
#endif

int clock_gettime(int clock, struct timespec *now);

#endif
