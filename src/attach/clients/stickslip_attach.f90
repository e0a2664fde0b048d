! Attach a solver written in Fortran to stickslip, the debugger for contact iterations. The solver keeps its loops.
!
!   call ss_begin("Block on a slope", "my solver", "1.0")
!   do ...                                              ! increments, iterations
!      mode(c) = ss_mode(c, mode(c))                    ! for each contact: the user may force another mode
!      ...                                              ! solve, and choose the next modes
!      call ss_contact_result(c, was(c), mode(c), gap, f_n, f_t, limit, slip)
!      call ss_pause("iteration", load, residual, tolerance)
!   end do
!   call ss_end()
!
! The functions are those of the C header, which describes them and is compiled next to this module; nodes and contacts are numbered
! from 1 here:
!
!   stickslip attach --c > stickslip_attach.h
!   cc -x c -DSS_IMPLEMENTATION -c stickslip_attach.h -o stickslip_c.o
!   gfortran stickslip_attach.f90 solver.f90 stickslip_c.o -o solver
!   stickslip attach -- ./solver
!
! Part of stickslip, MIT or Apache-2.0.
module stickslip_attach
  use, intrinsic :: iso_c_binding
  implicit none
  private
  public :: ss_node, ss_line, ss_surface, ss_contact, ss_begin, ss_mode, ss_contact_result, ss_displacement, ss_pause, ss_end
  public :: ss_node_3d, ss_surface_3d, ss_frame, ss_contact_result_3d, ss_displacement_3d
  integer, parameter, public :: ss_free = 0, ss_sliding = 1, ss_fixed = 2

  interface
    integer(c_int) function c_node(x, y) bind(c, name="ss_node")
      import; real(c_double), value :: x, y
    end function
    subroutine c_line(from, to) bind(c, name="ss_line")
      import; integer(c_int), value :: from, to
    end subroutine
    subroutine c_surface(name, nodes, count, rigid) bind(c, name="ss_surface")
      import; character(kind=c_char), intent(in) :: name(*); integer(c_int), intent(in) :: nodes(*)
      integer(c_int), value :: count, rigid
    end subroutine
    integer(c_int) function c_contact(node, surface, mu, cohesion, mode) bind(c, name="ss_contact")
      import; integer(c_int), value :: node, mode; character(kind=c_char), intent(in) :: surface(*)
      real(c_double), value :: mu, cohesion
    end function
    subroutine c_begin(title, name, version) bind(c, name="ss_begin")
      import; character(kind=c_char), intent(in) :: title(*), name(*), version(*)
    end subroutine
    integer(c_int) function c_mode(contact, chosen) bind(c, name="ss_mode")
      import; integer(c_int), value :: contact, chosen
    end function
    subroutine c_contact_result(contact, mode, next, gap, f_n, f_t, limit, slip) bind(c, name="ss_contact_result")
      import; integer(c_int), value :: contact, mode, next; real(c_double), value :: gap, f_n, f_t, limit, slip
    end subroutine
    subroutine c_displacement(node, x, y) bind(c, name="ss_displacement")
      import; integer(c_int), value :: node; real(c_double), value :: x, y
    end subroutine
    integer(c_int) function c_node_3d(x, y, z) bind(c, name="ss_node_3d")
      import; real(c_double), value :: x, y, z
    end function
    subroutine c_surface_3d(name, corners, faces, each, rigid) bind(c, name="ss_surface_3d")
      import; character(kind=c_char), intent(in) :: name(*); integer(c_int), intent(in) :: corners(*)
      integer(c_int), value :: faces, each, rigid
    end subroutine
    subroutine c_frame(contact, normal, tangent) bind(c, name="ss_frame")
      import; integer(c_int), value :: contact; real(c_double), intent(in) :: normal(*), tangent(*)
    end subroutine
    subroutine c_contact_result_3d(contact, mode, next, gap, f_n, f_t, limit, slip) bind(c, name="ss_contact_result_3d")
      import; integer(c_int), value :: contact, mode, next; real(c_double), value :: gap, f_n, limit
      real(c_double), intent(in) :: f_t(*), slip(*)
    end subroutine
    subroutine c_displacement_3d(node, x, y, z) bind(c, name="ss_displacement_3d")
      import; integer(c_int), value :: node; real(c_double), value :: x, y, z
    end subroutine
    subroutine c_pause(ended, load, residual, tolerance) bind(c, name="ss_pause")
      import; character(kind=c_char), intent(in) :: ended(*); real(c_double), value :: load, residual, tolerance
    end subroutine
    subroutine ss_end() bind(c, name="ss_end")
    end subroutine
  end interface

contains

  integer function ss_node(x, y)
    real(c_double), intent(in) :: x, y
    ss_node = c_node(x, y) + 1
  end function

  subroutine ss_line(from, to)
    integer, intent(in) :: from, to
    call c_line(from - 1, to - 1)
  end subroutine

  subroutine ss_surface(name, nodes, rigid)
    character(*), intent(in) :: name
    integer, intent(in) :: nodes(:)
    logical, intent(in) :: rigid
    call c_surface(trim(name)//c_null_char, int(nodes - 1, c_int), size(nodes), merge(1, 0, rigid))
  end subroutine

  integer function ss_contact(node, surface, mu, cohesion, mode)
    integer, intent(in) :: node, mode
    character(*), intent(in) :: surface
    real(c_double), intent(in) :: mu, cohesion
    ss_contact = c_contact(node - 1, trim(surface)//c_null_char, mu, cohesion, mode) + 1
  end function

  subroutine ss_begin(title, name, version)
    character(*), intent(in) :: title, name, version
    call c_begin(trim(title)//c_null_char, trim(name)//c_null_char, trim(version)//c_null_char)
  end subroutine

  integer function ss_mode(contact, chosen)
    integer, intent(in) :: contact, chosen
    ss_mode = c_mode(contact - 1, chosen)
  end function

  subroutine ss_contact_result(contact, mode, next, gap, f_n, f_t, limit, slip)
    integer, intent(in) :: contact, mode, next
    real(c_double), intent(in) :: gap, f_n, f_t, limit, slip
    call c_contact_result(contact - 1, mode, next, gap, f_n, f_t, limit, slip)
  end subroutine

  subroutine ss_displacement(node, x, y)
    integer, intent(in) :: node
    real(c_double), intent(in) :: x, y
    call c_displacement(node - 1, x, y)
  end subroutine

  integer function ss_node_3d(x, y, z)
    real(c_double), intent(in) :: x, y, z
    ss_node_3d = c_node_3d(x, y, z) + 1
  end function

  ! Faces are the columns of `corners`.
  subroutine ss_surface_3d(name, corners, rigid)
    character(*), intent(in) :: name
    integer, intent(in) :: corners(:, :)
    logical, intent(in) :: rigid
    integer(c_int) :: list(size(corners))
    list = reshape(corners - 1, [size(corners)])
    call c_surface_3d(trim(name)//c_null_char, list, size(corners, 2), size(corners, 1), merge(1, 0, rigid))
  end subroutine

  subroutine ss_frame(contact, normal, tangent)
    integer, intent(in) :: contact
    real(c_double), intent(in) :: normal(3), tangent(3)
    call c_frame(contact - 1, normal, tangent)
  end subroutine

  subroutine ss_contact_result_3d(contact, mode, next, gap, f_n, f_t, limit, slip)
    integer, intent(in) :: contact, mode, next
    real(c_double), intent(in) :: gap, f_n, f_t(2), limit, slip(2)
    call c_contact_result_3d(contact - 1, mode, next, gap, f_n, f_t, limit, slip)
  end subroutine

  subroutine ss_displacement_3d(node, x, y, z)
    integer, intent(in) :: node
    real(c_double), intent(in) :: x, y, z
    call c_displacement_3d(node - 1, x, y, z)
  end subroutine

  subroutine ss_pause(ended, load, residual, tolerance)
    character(*), intent(in) :: ended
    real(c_double), intent(in) :: load, residual, tolerance
    call c_pause(trim(ended)//c_null_char, load, residual, tolerance)
  end subroutine
end module
