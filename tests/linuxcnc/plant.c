/* A machine behind the controller: where its axes stand, a touch probe in its spindle meets balls on its table.
 *
 * A realtime component (halcompile), and with -DOFFLINE a library for Python without a controller. It shares nothing
 * with abbe: axes are screws in machine coordinates, the machine of the file has them a little elsewhere than drawn.
 *
 * The file has a line for each thing, numbers apart by blanks, mm and rad, machine coordinates with all axes at 0:
 *   axis JOINT ROTARY TOOLSIDE SENSE  ux uy uz  ox oy oz  dx dy dz  ra rb rc  PLAY
 *        from the bed to the workpiece, and from the bed to the tool; rotary joints are in deg. The line or direction is
 *        displaced by d and turned by r about o.
 *   tip x y z | zero x y z              middle of the stylus; where coordinates of the workpiece count from
 *   stylus RADIUS LENGTH SHAFT BODY     radius, from its middle to the body, radii of shaft and body
 *   probe NOISE DELAY PRETRAVEL LOBE LOBE_ANGLE SEED    mm, servo cycles, rad
 *   ball RADIUS STEM x y z              in the workpiece; the stem goes along -Z
 *   loose BALL TOUCHES x y z            the ball moves by x y z when so many contacts have been made
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#define AXES 9
#define BALLS 16
#define REACH 150.0 /* how far body and stems go */
#define DEEP 1.5    /* a contact that goes farther than this breaks the stylus */
#define HOLD 10     /* servo cycles for which the signal stays */

typedef struct { double x, y, z; } vec;

struct axis {
    int joint, rotary, toolside;
    double sense, play, stands;
    vec u, o;
};

struct ball { double radius, stem; vec at; };

static struct {
    int axes, balls;
    struct axis axis[AXES];
    struct ball ball[BALLS];
    vec tip, zero;
    double radius, length, shaft, body;
    double noise, pretravel, lobe, lobe_angle;
    int delay, loose, loose_after;
    vec loose_by;
    unsigned long long random;
    /* of the run */
    double drawn;
    int touching, held;
    unsigned char past[64];
    int cycle;
    int touches, shaft_touches, crashes, shaft_now, crash_now;
    FILE *told; /* a line for each shaft touch and crash: what, its ball, the tip, the joints */
} m;

static vec add(vec a, vec b) { return (vec){a.x + b.x, a.y + b.y, a.z + b.z}; }
static vec sub(vec a, vec b) { return (vec){a.x - b.x, a.y - b.y, a.z - b.z}; }
static vec times(double s, vec a) { return (vec){s * a.x, s * a.y, s * a.z}; }
static double dot(vec a, vec b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static vec cross(vec a, vec b)
{
    return (vec){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
static double length(vec a) { return sqrt(dot(a, a)); }

/* Turns v by an angle about the unit vector u (Rodrigues). */
static vec turned(vec v, vec u, double angle)
{
    double c = cos(angle), s = sin(angle);
    return add(add(times(c, v), times(s, cross(u, v))), times((1 - c) * dot(u, v), u));
}

static vec by_vector(vec v, vec r)
{
    double angle = length(r);
    return angle > 0 ? turned(v, times(1 / angle, r), angle) : v;
}

/* Moves a point, or with `free` a direction, with an axis that stands at `q`; backwards with way = -1. */
static vec carried(const struct axis *axis, double q, double way, vec p, int is_free)
{
    if (!axis->rotary)
        return is_free ? p : add(p, times(way * axis->sense * q, axis->u));
    double angle = way * axis->sense * q * (M_PI / 180);
    if (is_free)
        return turned(p, axis->u, angle);
    return add(axis->o, turned(sub(p, axis->o), axis->u, angle));
}

/* A point of the tool, or a direction, as the workpiece sees it. */
static vec in_workpiece(const double *q, vec p, int is_free)
{
    int k;
    for (k = m.axes - 1; k >= 0; k--)
        if (m.axis[k].toolside)
            p = carried(&m.axis[k], q[m.axis[k].joint], 1, p, is_free);
    for (k = 0; k < m.axes; k++)
        if (!m.axis[k].toolside)
            p = carried(&m.axis[k], q[m.axis[k].joint], -1, p, is_free);
    return is_free ? p : sub(p, m.zero);
}

static double uniform(void)
{
    m.random ^= m.random << 13;
    m.random ^= m.random >> 7;
    m.random ^= m.random << 17;
    return (m.random >> 11) * (1.0 / 9007199254740992.0);
}

static double normal(void)
{
    double u = 1 - uniform(), v = uniform();
    return sqrt(-2 * log(u)) * cos(2 * M_PI * v);
}

static double clamped(double x) { return x < 0 ? 0 : x > 1 ? 1 : x; }

/* Distance of the segments a + s d and b + t e (Ericson's way: the other end clamped in turn). */
static double apart(vec a, vec d, vec b, vec e)
{
    vec r = sub(a, b);
    double dd = dot(d, d), ee = dot(e, e), de = dot(d, e), dr = dot(d, r), er = dot(e, r);
    double s = 0, t = 0, det = dd * ee - de * de;
    if (det > 1e-12 * dd * ee)
        s = clamped((de * er - dr * ee) / det);
    if (ee > 0)
        t = clamped((de * s + er) / ee);
    if (dd > 0)
        s = clamped((de * t - dr) / dd);
    return length(sub(add(a, times(s, d)), add(b, times(t, e))));
}

/* The distance at which a contact is seen, for the direction from the ball to the stylus in the tool's frame. */
static double seen_at(const struct ball *ball, vec n)
{
    double across = sqrt(n.x * n.x + n.y * n.y), angle = atan2(n.y, n.x);
    return ball->radius + m.radius - m.pretravel - m.drawn
           + m.lobe * across * cos(3 * (angle - m.lobe_angle));
}

/* Says what was met, and where. */
static void tell(const char *what, int ball, vec tip, const double *q)
{
    int k;
    if (!m.told || m.shaft_touches + m.crashes > 100)
        return;
    fprintf(m.told, "%s ball %d after %d contacts, tip %.3f %.3f %.3f, joints", what, ball, m.touches, tip.x, tip.y, tip.z);
    for (k = 0; k < m.axes; k++)
        fprintf(m.told, " %.3f", q[k]);
    fputc('\n', m.told);
    fflush(m.told);
}

/* One look: is anything touched? `q` as the controller commands; axes follow with their play. */
static int look(const double *commanded)
{
    double q[AXES];
    int k, now = 0, shaft = 0, crash = 0, met = 0, hit = 0;
    for (k = 0; k < m.axes; k++) {
        struct axis *axis = &m.axis[k];
        double c = commanded[axis->joint];
        if (c > axis->stands + axis->play / 2)
            axis->stands = c - axis->play / 2;
        if (c < axis->stands - axis->play / 2)
            axis->stands = c + axis->play / 2;
        q[axis->joint] = axis->stands;
    }
    vec tip = in_workpiece(q, m.tip, 0), none = {0, 0, 0};
    vec up = in_workpiece(q, (vec){0, 0, 1}, 1);
    vec ex = in_workpiece(q, (vec){1, 0, 0}, 1), ey = in_workpiece(q, (vec){0, 1, 0}, 1);
    for (k = 0; k < m.balls; k++) {
        struct ball *ball = &m.ball[k];
        vec off = sub(tip, ball->at), stem = {0, 0, -REACH};
        double far = length(off);
        vec n = {dot(off, ex) / far, dot(off, ey) / far, dot(off, up) / far};
        now |= far < seen_at(ball, n);
        crash |= far < ball->radius + m.radius - DEEP;
        shaft |= apart(tip, times(m.length, up), ball->at, none) < ball->radius + m.shaft;
        shaft |= apart(tip, times(m.length, up), ball->at, stem) < ball->stem + m.shaft;
        crash |= apart(add(tip, times(m.length, up)), times(REACH, up), ball->at, none) < ball->radius + m.body;
        crash |= apart(add(tip, times(m.length, up)), times(REACH, up), ball->at, stem) < ball->stem + m.body;
        crash |= apart(tip, none, ball->at, stem) < ball->stem + m.radius;
        met += !shaft;
        hit += !crash;
    }
    if (shaft && !m.shaft_now)
        tell("shaft", met, tip, q);
    if (crash && !m.crash_now)
        tell("crash", hit, tip, q);
    m.shaft_touches += shaft && !m.shaft_now;
    m.crashes += crash && !m.crash_now;
    m.shaft_now = shaft, m.crash_now = crash;
    now |= shaft;
    if (now && !m.touching) {
        m.touches++;
        m.held = HOLD;
        if (m.loose_after && m.touches == m.loose_after)
            m.ball[m.loose].at = add(m.ball[m.loose].at, m.loose_by);
    }
    /* The next contact scatters anew. */
    if (!now && m.touching && !m.held)
        m.drawn = m.noise * normal();
    if (m.held) {
        m.held--;
        now = 1;
    }
    m.touching = now;
    m.past[m.cycle & 63] = now;
    now = m.past[(m.cycle - m.delay) & 63];
    m.cycle++;
    return now;
}

/* Reads the file; the number of the line that is not understood, 0 if all are. */
static int read_machine(const char *path)
{
    FILE *in = fopen(path, "r");
    char text[512];
    int line = 0, bad = 0;
    memset(&m, 0, sizeof m);
    if (!in)
        return -1;
    while (!bad && fgets(text, sizeof text, in)) {
        struct axis axis = {0};
        struct ball ball;
        vec d, r, v;
        double seed;
        line++;
        if (sscanf(text, "axis %d %d %d %lf %lf %lf %lf %lf %lf %lf %lf %lf %lf %lf %lf %lf %lf", &axis.joint, &axis.rotary,
                   &axis.toolside, &axis.sense, &axis.u.x, &axis.u.y, &axis.u.z, &axis.o.x, &axis.o.y, &axis.o.z, &d.x,
                   &d.y, &d.z, &r.x, &r.y, &r.z, &axis.play) == 17 && m.axes < AXES) {
            axis.u = by_vector(times(1 / length(axis.u), axis.u), r);
            axis.o = add(axis.o, d);
            m.axis[m.axes++] = axis;
        } else if (sscanf(text, "ball %lf %lf %lf %lf %lf", &ball.radius, &ball.stem, &ball.at.x, &ball.at.y, &ball.at.z) == 5
                   && m.balls < BALLS)
            m.ball[m.balls++] = ball;
        else if (sscanf(text, "tip %lf %lf %lf", &v.x, &v.y, &v.z) == 3)
            m.tip = v;
        else if (sscanf(text, "zero %lf %lf %lf", &v.x, &v.y, &v.z) == 3)
            m.zero = v;
        else if (sscanf(text, "stylus %lf %lf %lf %lf", &m.radius, &m.length, &m.shaft, &m.body) == 4)
            ;
        else if (sscanf(text, "probe %lf %d %lf %lf %lf %lf", &m.noise, &m.delay, &m.pretravel, &m.lobe, &m.lobe_angle,
                        &seed) == 6 && m.delay >= 0 && m.delay < 64)
            m.random = 0x9E3779B97F4A7C15ULL * (unsigned long long)(seed + 1);
        else if (sscanf(text, "loose %d %d %lf %lf %lf", &m.loose, &m.loose_after, &v.x, &v.y, &v.z) == 5
                 && m.loose >= 0 && m.loose < BALLS)
            m.loose_by = v;
        else
            bad = line;
    }
    fclose(in);
    for (line = 0; line < 20 && m.random; line++)
        uniform();
    m.drawn = m.noise > 0 ? m.noise * normal() : 0;
    return bad;
}

#ifdef OFFLINE
int plant_read(const char *path) { return read_machine(path); }

int plant_look(const double *q) { return look(q); }

/* Tip, and the direction from it to the spindle, of axes that stand there. */
void plant_holds(const double *q, double *out)
{
    vec tip = in_workpiece(q, m.tip, 0), up = in_workpiece(q, (vec){0, 0, 1}, 1);
    out[0] = tip.x, out[1] = tip.y, out[2] = tip.z, out[3] = up.x, out[4] = up.y, out[5] = up.z;
}

void plant_counts(int *out)
{
    out[0] = m.touches, out[1] = m.shaft_touches, out[2] = m.crashes;
}
#else
#include "hal.h"
#include "rtapi.h"
#include "rtapi_app.h"

MODULE_LICENSE("GPL");
static char *machine = "plant.txt";
RTAPI_MP_STRING(machine, "file of the machine");
static int joints = 5;
RTAPI_MP_INT(joints, "number of joints");

static struct {
    hal_float_t *motor[AXES], *offset[AXES];
    hal_bit_t *probe;
    hal_s32_t *touches, *shaft, *crashes;
} *pin;

static int component;

static void update(void *unused, long period)
{
    double q[AXES];
    int k;
    (void)unused, (void)period;
    for (k = 0; k < joints; k++)
        q[k] = *pin->motor[k] - *pin->offset[k];
    *pin->probe = look(q);
    *pin->touches = m.touches;
    *pin->shaft = m.shaft_touches;
    *pin->crashes = m.crashes;
}

int rtapi_app_main(void)
{
    int k, failed = read_machine(machine);
    m.told = fopen("met.txt", "w");
    if (failed || joints < 1 || joints > AXES) {
        rtapi_print_msg(RTAPI_MSG_ERR, "plant: %s, line %d\n", machine, failed);
        return -1;
    }
    component = hal_init("plant");
    if (component < 0 || !(pin = hal_malloc(sizeof *pin)))
        return -1;
    for (k = 0; k < joints; k++) {
        failed |= hal_pin_float_newf(HAL_IN, &pin->motor[k], component, "plant.motor-%d", k);
        failed |= hal_pin_float_newf(HAL_IN, &pin->offset[k], component, "plant.offset-%d", k);
    }
    failed |= hal_pin_bit_newf(HAL_OUT, &pin->probe, component, "plant.probe");
    failed |= hal_pin_s32_newf(HAL_OUT, &pin->touches, component, "plant.touches");
    failed |= hal_pin_s32_newf(HAL_OUT, &pin->shaft, component, "plant.shaft");
    failed |= hal_pin_s32_newf(HAL_OUT, &pin->crashes, component, "plant.crashes");
    failed |= hal_export_funct("plant", update, 0, 1, 0, component);
    if (failed) {
        hal_exit(component);
        return -1;
    }
    hal_ready(component);
    return 0;
}

void rtapi_app_exit(void)
{
    hal_exit(component);
}
#endif
