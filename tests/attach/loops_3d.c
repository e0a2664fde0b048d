/* A node on springs over a rough plane: pushed along x and y in turn, it slides along the push. */
#include "stickslip_attach.h"

int main(void) {
    const double mu = 0.5, f_n = 2, limit = mu * f_n, normal[] = {0, 0, 1}, tangent[] = {0, 1, 0};
    int node = ss_node_3d(0, 0, 0), next = SS_SLIDING;
    int plane[] = {ss_node_3d(-1, -1, 0), ss_node_3d(2, -1, 0), ss_node_3d(2, 2, 0), ss_node_3d(-1, 2, 0)};
    ss_surface_3d("plane", plane, 1, 4, 1);
    ss_contact(node, "plane", mu, 0, next);
    ss_begin("A node pushed in turn", "loops in space", "1");
    for (int k = 1; k <= 40; k++) {
        int mode = ss_mode(0, next);
        double push = mode == SS_FIXED ? 0.1 : 4, slides = mode == SS_SLIDING;
        /* t is y and n x t is -x: friction on the node acts against its motion, and the plane moves ahead of it. */
        double f_t[2] = {k % 2 ? 0 : -limit, k % 2 ? limit : 0};
        double slip[2] = {f_t[0] * slides * (push - limit) / limit, f_t[1] * slides * (push - limit) / limit};
        if (mode != SS_SLIDING) f_t[0] = f_t[1] = 0;
        ss_frame(0, normal, tangent);
        ss_contact_result_3d(0, mode, next, 0, mode == SS_FREE ? 0 : f_n, f_t, mode == SS_FREE ? 0 : limit, slip);
        ss_displacement_3d(node, slip[1], -slip[0], 0);
        ss_pause(k < 40 ? "iteration" : "failure", 1, NAN, NAN);
    }
    ss_end();
}
