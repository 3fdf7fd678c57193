/* So much of LinuxCNC's headers and of what halcompile writes around a component as the generated
   kinematics need: they can then be compiled and called without a controller. */
#include <math.h>
#include <stdio.h>
#include <string.h>

struct EmcPose {
    struct {
        double x, y, z;
    } tran;
    double a, b, c, u, v, w;
};
typedef enum { KINEMATICS_IDENTITY = 1, KINEMATICS_BOTH = 4 } KINEMATICS_TYPE;
typedef unsigned long int KINEMATICS_FORWARD_FLAGS;
typedef unsigned long int KINEMATICS_INVERSE_FLAGS;
KINEMATICS_TYPE kinematicsType(void);
int kinematicsForward(const double *, struct EmcPose *, const KINEMATICS_FORWARD_FLAGS *, KINEMATICS_INVERSE_FLAGS *);
int kinematicsInverse(const struct EmcPose *, double *, const KINEMATICS_INVERSE_FLAGS *, KINEMATICS_FORWARD_FLAGS *);
int kinematicsSwitchable(void);
int kinematicsSwitch(int);
#define RTAPI_MP_STRING(name, text) struct shim_nothing
#define RTAPI_MSG_ERR 1
#define rtapi_print_msg(level, ...) fprintf(stderr, __VA_ARGS__)
#define EXPORT_SYMBOL(name) struct shim_nothing

#include "abbekins_solve.h"

struct __comp_state {
    int enable_pin, orientation_pin, iterations_pin, failures_pin, tcp_pin, ramping_pin, refused_pin, zone_pin;
    double share_pin, tool_x_pin, tool_y_pin, tool_z_pin, residual_pin, largest_pin, speed_pin, acceleration_pin;
    double angle_pin;
};
static struct __comp_state shim_state, *__comp_first_inst = &shim_state;
/* What can be read only cannot be assigned. */
#define enable (0 + __comp_inst->enable_pin)
#define orientation (0 + __comp_inst->orientation_pin)
#define share (0 + __comp_inst->share_pin)
#define tool_x (0 + __comp_inst->tool_x_pin)
#define tool_y (0 + __comp_inst->tool_y_pin)
#define tool_z (0 + __comp_inst->tool_z_pin)
#define tool_speed (0 + __comp_inst->speed_pin)
#define tool_acceleration (0 + __comp_inst->acceleration_pin)
#define fperiod (period * 1e-9)
#define FUNCTION(name) static void name(struct __comp_state *__comp_inst, long period)
#ifdef SHIM_SETTERS
/* After LinuxCNC 2.9: pins are written by setters only. */
#define iterations (0 + __comp_inst->iterations_pin)
#define failures (0 + __comp_inst->failures_pin)
#define iterations_set(value) ((void)(__comp_inst->iterations_pin = (value)))
#define failures_set(value) ((void)(__comp_inst->failures_pin = (value)))
#define tcp_set(value) ((void)(__comp_inst->tcp_pin = (value)))
#define residual_set(value) ((void)(__comp_inst->residual_pin = (value)))
#define largest_set(value) ((void)(__comp_inst->largest_pin = (value)))
#define tool_ramping_set(value) ((void)(__comp_inst->ramping_pin = (value)))
#define tool_refused_set(value) ((void)(__comp_inst->refused_pin = (value)))
#define pole_zone_set(value) ((void)(__comp_inst->zone_pin = (value)))
#define pole_angle_set(value) ((void)(__comp_inst->angle_pin = (value)))
#else
#define iterations (__comp_inst->iterations_pin)
#define failures (__comp_inst->failures_pin)
#define tcp (__comp_inst->tcp_pin)
#define residual (__comp_inst->residual_pin)
#define largest (__comp_inst->largest_pin)
#define tool_ramping (__comp_inst->ramping_pin)
#define tool_refused (__comp_inst->refused_pin)
#define pole_zone (__comp_inst->zone_pin)
#define pole_angle (__comp_inst->angle_pin)
#endif
#define EXTRA_SETUP() static int extra_setup(struct __comp_state *__comp_inst, char *prefix, long extra_arg)
