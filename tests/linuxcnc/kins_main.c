/* Calls the generated kinematics for every line of standard input: enable, share, orientation, tool
   (3 numbers), pose (X Y Z A B C U V W), nine joints where the machine is before. Prints, for each, a line of
   nine joints, the nine coordinates that the forward kinematics find for them (the first is NaN where they
   find none), steps and failures so far.
   With an argument N it calls the inverse N times instead, at the poses that the joints of the lines are, and
   prints the nanoseconds of processor time of a call, then of a forward call. */
#include <stdlib.h>
#include <time.h>

#define MOST 4096

#define NUMBERS 24

static double line[MOST][NUMBERS];

static void apply(const double *in)
{
    shim_state.enable_pin = in[0] != 0.0;
    shim_state.share_pin = in[1];
    shim_state.orientation_pin = in[2] != 0.0;
    shim_state.tool_x_pin = in[3];
    shim_state.tool_y_pin = in[4];
    shim_state.tool_z_pin = in[5];
}

static struct EmcPose pose(const double *p)
{
    struct EmcPose world = { { p[6], p[7], p[8] }, p[9], p[10], p[11], p[12], p[13], p[14] };
    return world;
}

static double seconds(void)
{
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static void timed(int count, long calls)
{
    static double joint[MOST][16];
    static struct EmcPose at[MOST];
    double start, inverse, forward;
    struct EmcPose world = { { 0, 0, 0 }, 0, 0, 0, 0, 0, 0 };
    long k;
    int i;
    for (k = 0; k < count; k++) {
        for (i = 0; i < 9; i++) joint[k][i] = line[k][15 + i];
        if (kinematicsForward(joint[k], &at[k], NULL, NULL)) exit(1);
        /* About as far away as one cycle moves. */
        for (i = 0; i < 9; i++) joint[k][i] += 0.05;
    }
    start = seconds();
    for (k = 0; k < calls; k++) {
        double from[16];
        for (i = 0; i < 16; i++) from[i] = joint[k % count][i];
        if (kinematicsInverse(&at[k % count], from, NULL, NULL)) exit(1);
    }
    inverse = seconds() - start;
    start = seconds();
    for (k = 0; k < calls; k++)
        if (kinematicsForward(joint[k % count], &world, NULL, NULL)) exit(1);
    forward = seconds() - start;
    printf("%.0f %.0f\n", 1e9 * inverse / (double)calls, 1e9 * forward / (double)calls);
}

/* The first line is where the machine is; each further one is a tool that the pins are given for 8 s of servo cycles of
   1 ms while the words stay. A line for every cycle: joints, ramping, refused, zone, angle. */
static void ramped(int count)
{
    double joint[16] = { 0.0 };
    struct EmcPose world = pose(line[0]);
    int k, i, cycle;
    shim_state.speed_pin = 20.0;
    shim_state.acceleration_pin = 100.0;
    apply(line[0]);
    for (i = 0; i < 9; i++) joint[i] = line[0][15 + i];
    for (k = 0; k < count; k++) {
        apply(line[k]);
        for (cycle = 0; cycle < 8000; cycle++) {
            ramp(&shim_state, 1000000);
            if (kinematicsInverse(&world, joint, NULL, NULL)) exit(1);
            struct EmcPose seen = world;
            if (kinematicsForward(joint, &seen, NULL, NULL)) exit(1);
            for (i = 0; i < 9; i++) printf("%.17g ", joint[i]);
            printf("%d %d %d %.17g\n", shim_state.ramping_pin, shim_state.refused_pin, shim_state.zone_pin,
                   shim_state.angle_pin);
        }
    }
}

int main(int argc, char **argv)
{
    char prefix[] = "abbekins";
    int count = 0, k, i;
    if (extra_setup(&shim_state, prefix, 0) || kinematicsType() != KINEMATICS_BOTH) return 1;
    for (;; count++) {
        for (i = 0; i < NUMBERS && count < MOST; i++)
            if (scanf("%lf", &line[count][i]) != 1) break;
        if (i < NUMBERS) break;
    }
    if (argc > 1 && strcmp(argv[1], "ramp") == 0) {
        ramped(count);
        return 0;
    }
    if (argc > 1) {
        apply(line[0]);
        timed(count, atol(argv[1]));
        return 0;
    }
    for (k = 0; k < count; k++) {
        double joint[16] = { 0.0 };
        struct EmcPose world = pose(line[k]), back = { { 0, 0, 0 }, 0, 0, 0, 0, 0, 0 };
        apply(line[k]);
        for (i = 0; i < 9; i++) joint[i] = line[k][15 + i];
        /* Angles are found next to those of before. */
        back.a = world.a + 10.0;
        back.b = world.b + 10.0;
        back.c = world.c + 10.0;
        if (kinematicsInverse(&world, joint, NULL, NULL) == 0 && kinematicsForward(joint, &back, NULL, NULL))
            back.tran.x = NAN;
        for (i = 0; i < 9; i++) printf("%.17g ", joint[i]);
        printf("%.17g %.17g %.17g %.17g %.17g %.17g ", back.tran.x, back.tran.y, back.tran.z, back.a, back.b, back.c);
        printf("%.17g %.17g %.17g %d %d\n", back.u, back.v, back.w, shim_state.iterations_pin, shim_state.failures_pin);
    }
    return 0;
}
