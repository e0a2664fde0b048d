! The node of loops.c in Fortran.
program loops
  use stickslip_attach
  use, intrinsic :: ieee_arithmetic
  implicit none
  double precision, parameter :: px = 1, py = 0.25d0, mu = 0.2d0
  double precision :: x, y, f_n, f_t, limit, none
  integer :: node, floor(2), contact, next, mode, k
  none = ieee_value(none, ieee_quiet_nan)
  next = ss_free
  node = ss_node(0d0, 0d0)
  floor = [ss_node(5d0, 0d0), ss_node(-5d0, 0d0)]
  call ss_surface("floor", floor, .true.)
  contact = ss_contact(node, "floor", mu, 0d0, next)
  call ss_begin("A node that opens where it sticks", "loops in Fortran", "1")
  do k = 1, 40
    mode = ss_mode(contact, next)
    y = merge(2*py - px, 0d0, mode == ss_free)
    x = merge(px - py, 0d0, mode == ss_free)
    if (mode == ss_sliding) x = (px + mu*py)/(2 + mu)
    f_n = x + y - py
    f_t = px - 2*x - y
    limit = sign(mu*abs(f_n), f_t)
    if (mode == ss_free) then
      next = merge(ss_fixed, ss_free, y < 0)
    else if (f_n <= 0) then
      next = ss_free
    else if (mode == ss_fixed) then
      next = merge(ss_sliding, ss_fixed, abs(f_t) > abs(limit))
    end if
    call ss_contact_result(contact, mode, next, y, f_n, f_t, limit, x)
    call ss_displacement(node, x, y)
    call ss_pause(trim(merge("done     ", merge("iteration", "failure  ", k < 40), next == mode)), 1d0, none, none)
  end do
  call ss_end()
end program
