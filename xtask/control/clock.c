/* A quicker clock for the realtime part of LinuxCNC: loaded before its libraries, it makes the monotonic clock run CLOCK_RATE times
 * as fast and sleeps that much shorter. The servo thread then runs its cycles in less time; what a cycle computes knows no clock.
 */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <stdlib.h>
#include <time.h>

#define SECOND 1000000000LL

typedef int (*get_fn)(clockid_t, struct timespec *);
typedef int (*sleep_fn)(clockid_t, int, const struct timespec *, struct timespec *);
static get_fn get;
static sleep_fn rest;
static double rate = 1;
static long long start;

static long long count(const struct timespec *t) { return t->tv_sec * SECOND + t->tv_nsec; }

static struct timespec of(double ns) {
    struct timespec t = { (long long)ns / SECOND, (long long)ns % SECOND };
    return t;
}

__attribute__((constructor)) static void begin(void) {
    struct timespec now;
    const char *given = getenv("CLOCK_RATE");
    get = (get_fn)dlsym(RTLD_NEXT, "clock_gettime");
    rest = (sleep_fn)dlsym(RTLD_NEXT, "clock_nanosleep");
    if (given && atof(given) > 0) rate = atof(given);
    get(CLOCK_MONOTONIC, &now);
    start = count(&now);
}

int clock_gettime(clockid_t id, struct timespec *t) {
    int failed = get(id, t);
    if (!failed && id == CLOCK_MONOTONIC) *t = of(start + rate * (count(t) - start));
    return failed;
}

int clock_nanosleep(clockid_t id, int flags, const struct timespec *t, struct timespec *left) {
    struct timespec real = *t;
    if (id == CLOCK_MONOTONIC) real = of(flags & TIMER_ABSTIME ? start + (count(t) - start) / rate : count(t) / rate);
    return rest(id, flags, &real, left);
}
