! The node of loops.c in Fortran.
program loops
  use stickslip_attach
  use, intrinsic :: ieee_arithmetic
  implicit none
  double precision :: x, y, f_n, f_t, t_max, px, py, g0, mu, xx, xy, yy, det, a, b, none
  integer :: node, from, to, c, next, mode, k
  a = 95 * acos(-1d0) / 180; b = 30 * acos(-1d0) / 180; mu = 0.2d0; g0 = 0.05d0; px = -1; py = -0.05d0; t_max = 0
  none = ieee_value(none, ieee_quiet_nan)
  xx = 10*cos(a)**2 + .1d0*cos(b)**2; xy = 10*cos(a)*sin(a) + .1d0*cos(b)*sin(b); yy = 10*sin(a)**2 + .1d0*sin(b)**2
  det = xx*yy - xy*xy
  node = ss_node(0d0, g0); from = ss_node(5d0, 0d0); to = ss_node(-5d0, 0d0)
  call ss_surface("floor", [from, to], .true.)
  c = ss_contact(node, "floor", mu, 0d0, ss_free)
  call ss_begin("A node that opens where it sticks", "loops in Fortran", "1")
  next = ss_free
  do k = 1, 40
    mode = ss_mode(c, next)
    f_n = 0; f_t = 0; y = -g0
    select case (mode)                      ! n = (0, 1), t = (-1, 0): K u = p + f
    case (ss_free)
      x = (yy*px - xy*py)/det; y = (xx*py - xy*px)/det
    case (ss_fixed)
      x = 0; f_t = px - xy*y; f_n = yy*y - py
    case default
      f_t = t_max; x = (px - f_t - xy*y)/xx; f_n = xy*x + yy*y - py
    end select
    t_max = sign(mu*abs(f_n), f_t)
    if (mode == ss_free) then
      next = merge(ss_fixed, ss_free, g0 + y < 0)
    else if (f_n <= 0) then
      next = ss_free
    else if (mode == ss_fixed) then
      next = merge(ss_sliding, ss_fixed, abs(f_t) > abs(t_max))
    else
      next = merge(ss_fixed, ss_sliding, t_max*x < 0)
    end if
    call ss_contact_result(c, mode, next, g0 + y, f_n, f_t, t_max, -x)
    call ss_displacement(node, x, y)
    call ss_pause(trim(merge("failure  ", "iteration", k == 40)), 1d0, none, none)
  end do
  call ss_end()
end program
