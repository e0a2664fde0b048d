/* A node on two bars, pressed on a rough floor: where it sticks the bars pull it off, so that its modes repeat, though it could slide. */
#include <math.h>
#include "stickslip_attach.h"
int main(void) {
    double a = 95 * M_PI / 180, b = 30 * M_PI / 180, mu = 0.2, g0 = 0.05, px = -1, py = -0.05, t_max = 0;
    double xx = 10 * cos(a) * cos(a) + .1 * cos(b) * cos(b), xy = 10 * cos(a) * sin(a) + .1 * cos(b) * sin(b);
    double yy = 10 * sin(a) * sin(a) + .1 * sin(b) * sin(b), det = xx * yy - xy * xy;
    int node = ss_node(0, g0), floor[] = {ss_node(5, 0), ss_node(-5, 0)}, next = SS_FREE;
    ss_surface("floor", floor, 2, 1);
    ss_contact(node, "floor", mu, 0, SS_FREE);
    ss_begin("A node that opens where it sticks", "loops", "1");
    for (int k = 1; k <= 40; k++) {
        int mode = ss_mode(0, next);
        double x, y = -g0, f_n = 0, f_t = 0; /* n = (0, 1), t = (-1, 0): K u = p + f */
        if (mode == SS_FREE) { x = (yy * px - xy * py) / det; y = (xx * py - xy * px) / det; }
        else if (mode == SS_FIXED) { x = 0; f_t = px - xy * y; f_n = yy * y - py; }
        else { f_t = t_max; x = (px - f_t - xy * y) / xx; f_n = xy * x + yy * y - py; }
        t_max = copysign(mu * fabs(f_n), f_t);
        next = mode == SS_FREE ? (g0 + y < 0 ? SS_FIXED : SS_FREE) : f_n <= 0 ? SS_FREE
             : mode == SS_FIXED ? (fabs(f_t) > fabs(t_max) ? SS_SLIDING : SS_FIXED) : t_max * x < 0 ? SS_FIXED : SS_SLIDING;
        ss_contact_result(0, mode, next, g0 + y, f_n, f_t, t_max, -x);
        ss_displacement(node, x, y);
        ss_pause(k == 40 ? "failure" : "iteration", 1, NAN, NAN);
    }
    ss_end();
}
