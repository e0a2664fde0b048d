/* A node on springs, pulled along a rough floor: where it sticks the springs lift it off, so that its modes repeat, though it could slide. */
#include "stickslip_attach.h"

int main(void) {
    double px = 1, py = 0.25, mu = 0.2;
    int node = ss_node(0, 0), floor[] = {ss_node(5, 0), ss_node(-5, 0)}, next = SS_FREE;
    ss_surface("floor", floor, 2, 1);
    ss_contact(node, "floor", mu, 0, next);
    ss_begin("A node that opens where it sticks", "loops", "1");
    for (int k = 1; k <= 40; k++) {
        int mode = ss_mode(0, next);
        /* The springs: 2 x + y = px - f_t and x + y = py + f_n, where n = (0, 1) and t = (-1, 0). */
        double y = mode == SS_FREE ? 2 * py - px : 0;
        double x = mode == SS_FREE ? px - py : mode == SS_SLIDING ? (px + mu * py) / (2 + mu) : 0;
        double f_n = x + y - py, f_t = px - 2 * x - y, limit = copysign(mu * fabs(f_n), f_t);
        next = mode == SS_FREE ? (y < 0 ? SS_FIXED : SS_FREE) : f_n <= 0 ? SS_FREE : mode == SS_SLIDING ? SS_SLIDING
             : fabs(f_t) > fabs(limit) ? SS_SLIDING : SS_FIXED;
        ss_contact_result(0, mode, next, y, f_n, f_t, limit, x);
        ss_displacement(node, x, y);
        ss_pause(next == mode ? "done" : k < 40 ? "iteration" : "failure", 1, NAN, NAN);
    }
    ss_end();
}
