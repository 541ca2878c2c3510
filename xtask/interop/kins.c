/* Calls a kinematics module of LinuxCNC outside of its realtime system.
 *
 * usage: kins MODULE.so forward|inverse [LENGTH [PIN=VALUE ...]] < numbers, six a line
 *   forward: joints 0 to 4 and one ignored number -> x y z a b c of the pose
 *   inverse: x y z a b c -> joints 0 to 4
 * The module wants HAL pins; here they are plain memory, all zero but those that are given and the pin tool-offset, which is
 * LENGTH in mm: as the sample machines connect it to the tool length offset in force. Poses then are the tip's with LENGTH added to z, as that control counts.
 */
#include <dlfcn.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int hal_init(const char *name) { (void)name; return 1; }
int hal_ready(int id) { (void)id; return 0; }
int hal_exit(int id) { (void)id; return 0; }
void *hal_malloc(long size) { return calloc(1, (size_t)size); }
static int pin(void **where) { *where = calloc(1, 64); return *where ? 0 : -1; }
static double *tool_offset;
static struct { char format[64]; double *at; } pins[64];
static int count;
int hal_pin_float_newf(int dir, void **where, int id, const char *format, ...) {
    (void)dir; (void)id;
    int failed = pin(where);
    if (!failed && strstr(format, "tool-offset")) tool_offset = *where;
    if (!failed && count < 64) {
        strncpy(pins[count].format, format, sizeof pins[count].format - 1);
        pins[count++].at = *where;
    }
    return failed;
}
int hal_pin_bit_new(const char *name, int dir, void **where, int id) {
    (void)name; (void)dir; (void)id;
    return pin(where);
}
int hal_pin_s32_new(const char *name, int dir, void **where, int id) { return hal_pin_bit_new(name, dir, where, id); }
void rtapi_print(const char *format, ...) { (void)format; }
void rtapi_print_msg(int level, const char *format, ...) {
    va_list rest;
    if (level > 1) return;
    va_start(rest, format);
    vfprintf(stderr, format, rest);
    va_end(rest);
}

typedef int (*forward_fn)(const double *, double *, const unsigned long *, unsigned long *);
typedef int (*inverse_fn)(const double *, double *, const unsigned long *, unsigned long *);

int main(int argc, char **argv) {
    double in[6];
    if (argc < 3) return 2;
    void *module = dlopen(argv[1], RTLD_NOW | RTLD_GLOBAL);
    if (!module) { fprintf(stderr, "%s\n", dlerror()); return 1; }
    int (*start)(void) = (int (*)(void))dlsym(module, "rtapi_app_main");
    forward_fn forward = (forward_fn)dlsym(module, "kinematicsForward");
    inverse_fn inverse = (inverse_fn)dlsym(module, "kinematicsInverse");
    if (!start || !forward || !inverse || start()) { fprintf(stderr, "the module does not start\n"); return 1; }
    if (argc > 3) {
        if (!tool_offset) { fprintf(stderr, "the module asks for no tool length\n"); return 1; }
        *tool_offset = atof(argv[3]);
    }
    for (int k = 4; k < argc; k++) {
        char *value = strchr(argv[k], '=');
        int set = 0;
        if (value) *value++ = 0;
        for (int i = 0; value && i < count; i++)
            if (strstr(pins[i].format, argv[k])) { *pins[i].at = atof(value); set = 1; }
        if (!set) { fprintf(stderr, "the module has no pin %s\n", argv[k]); return 1; }
    }
    while (scanf("%lf %lf %lf %lf %lf %lf", in, in + 1, in + 2, in + 3, in + 4, in + 5) == 6) {
        double joints[16] = {0}, pose[9] = {0};
        unsigned long f = 0, g = 0;
        if (!strcmp(argv[2], "forward")) {
            memcpy(joints, in, 5 * sizeof(double));
            forward(joints, pose, &f, &g);
            printf("%.17g %.17g %.17g %.17g %.17g %.17g\n", pose[0], pose[1], pose[2], pose[3], pose[4], pose[5]);
        } else {
            memcpy(pose, in, sizeof in);
            inverse(pose, joints, &f, &g);
            printf("%.17g %.17g %.17g %.17g %.17g 0\n", joints[0], joints[1], joints[2], joints[3], joints[4]);
        }
    }
    return 0;
}
