"""Fortran subroutines of the nonlinear rod on a mesh for AUTO-07p: dz/dt and its exact derivatives.

The equations are those of `rodsweep.discretization.stress.balance` with Omega eliminated. The state is
z = C^(1/2) S; par(1) is F, and par(11) is the period in tau2. The subroutines read the mesh and the
parameters from the file `rod`, and the first cycle from the file `start`.
"""

EQUATIONS = """
module rod
  implicit none
  integer :: n = 0 ! nodes but the tip
  double precision :: c1, c2, gamma1, gamma3
  double precision, allocatable :: D(:, :), weights(:), weak(:, :), second(:, :), roots(:)
contains
  subroutine read_rod
    integer i
    open (77, file='rod', form='unformatted', access='stream')
    read (77) n
    allocate (D(0:n, 0:n), weights(0:n), weak(0:n, 0:n), second(0:n, 0:n), roots(3))
    read (77) D, weights, c1, c2, gamma1, gamma3
    close (77)
    roots = [sqrt(c1), sqrt(c2), 1d0]
    weak = -transpose(D)
    do i = 0, n
      weak(:, i) = weak(:, i)*weights(i)
    end do
    do i = 0, n
      weak(i, :) = weak(i, :)/weights(i)
    end do
    second = matmul(weak, D)
  end subroutine
end module
subroutine func(ndim, u, icp, par, ijac, f, dfdu, dfdp)
  use rod
  implicit none
  integer ndim, icp(*), ijac
  double precision u(ndim), par(*), f(ndim), dfdu(ndim, ndim), dfdp(ndim, *)
  double precision, dimension(0:ndim/3) :: s2, n1, h1, h2, Pi, v1, v2, Omega, zero
  double precision S(0:ndim/3, 3), V(0:ndim/3, 3)
  if (n == 0) call read_rod
  S = 0
  S(0:n - 1, 1) = u(:n)/roots(1)
  S(0:n - 1, 2) = u(n + 1:2*n)/roots(2)
  S(0:n - 1, 3) = u(2*n + 1:)
  s2 = S(:, 2)
  n1 = S(:, 1) - par(1)
  h1 = 1 - par(1)*c1 + c1*S(:, 1)
  h2 = c2*s2
  Pi = S(:, 3)
  V = matmul(D, S)
  v1 = (V(:, 1) - Pi*s2)/gamma1
  v2 = V(:, 2) + Pi*n1
  Omega = (V(:, 3) - h2*n1 + h1*s2)/gamma3
  call balance(v1, v2, Omega, h2*Omega - Pi*v2, Pi*v1 - h1*Omega, f)
  if (ijac >= 1) call derivative
  if (ijac == 2) then ! by F: of v2 -Pi, of Omega v1
    v1 = (h2 - c1*s2)/gamma3
    zero = 0
    call balance(zero, -Pi, v1, h2*v1 + Pi*Pi, c1*Omega - h1*v1, dfdp)
  end if
contains
  subroutine balance(a, b, c, g1, g2, rate)
    double precision, dimension(0:n) :: a, b, c, g1, g2
    double precision rate(ndim), W(0:n, 3)
    V(:, 1) = a
    V(:, 2) = b
    V(:, 3) = c
    W = matmul(weak, V)
    rate(:n) = (W(0:n - 1, 1) + g1(0:n - 1))/roots(1)
    rate(n + 1:2*n) = (W(0:n - 1, 2) + g2(0:n - 1))/roots(2)
    rate(2*n + 1:) = W(0:n - 1, 3)
  end subroutine
  subroutine derivative
    double precision, dimension(0:n - 1) :: l12, l13, l21, l23, l31, l32, k12, k13, k21, k23, w, g
    double precision r1, r2
    integer i, j, b, c
    l12 = -Pi(0:n - 1)/gamma1 ! v1 by S2, and so on, at the same node
    l13 = -s2(0:n - 1)/gamma1
    l21 = Pi(0:n - 1)
    l23 = n1(0:n - 1)
    l31 = (c1 - c2)*s2(0:n - 1)/gamma3
    l32 = (h1(0:n - 1) - c2*n1(0:n - 1))/gamma3
    k12 = -Pi(0:n - 1)
    k13 = h2(0:n - 1)/gamma3
    k21 = Pi(0:n - 1)/gamma1
    k23 = -h1(0:n - 1)/gamma3
    r1 = 1/roots(1)
    r2 = 1/roots(2)
    do j = 0, n - 1
      b = n + j + 1
      c = 2*n + j + 1
      w = weak(0:n - 1, j)
      g = D(0:n - 1, j)
      dfdu(:n, j + 1) = second(0:n - 1, j)*(r1*r1/gamma1)
      dfdu(n + 1:2*n, j + 1) = (w*l21(j) + k21*g)*(r1*r2)
      dfdu(2*n + 1:, j + 1) = w*(l31(j)*r1)
      dfdu(:n, b) = (w*l12(j) + k12*g)*(r1*r2)
      dfdu(n + 1:2*n, b) = second(0:n - 1, j)*(r2*r2)
      dfdu(2*n + 1:, b) = w*(l32(j)*r2)
      dfdu(:n, c) = (w*l13(j) + k13*g)*r1
      dfdu(n + 1:2*n, c) = (w*l23(j) + k23*g)*r2
      dfdu(2*n + 1:, c) = second(0:n - 1, j)/gamma3
    end do
    do i = 0, n - 1
      j = i + 1
      b = n + j
      c = 2*n + j
      dfdu(j, j) = dfdu(j, j) + (h2(i)*l31(i) - Pi(i)*l21(i))*(r1*r1)
      dfdu(j, b) = dfdu(j, b) + (h2(i)*l32(i) + c2*Omega(i))*(r1*r2)
      dfdu(j, c) = dfdu(j, c) - (Pi(i)*l23(i) + v2(i))*r1
      dfdu(b, j) = dfdu(b, j) - (h1(i)*l31(i) + c1*Omega(i))*(r1*r2)
      dfdu(b, b) = dfdu(b, b) + (Pi(i)*l12(i) - h1(i)*l32(i))*(r2*r2)
      dfdu(b, c) = dfdu(b, c) + (Pi(i)*l13(i) + v1(i))*r2
    end do
  end subroutine
end subroutine
subroutine stpnt(ndim, u, par, t)
  implicit none
  integer ndim, i
  integer, save :: last = -1
  double precision u(ndim), par(*), t
  double precision, save :: F, period
  double precision, allocatable, save :: states(:, :)
  if (last < 0) then ! states at equal times over the period
    open (77, file='start', form='unformatted', access='stream')
    read (77) last, F, period
    allocate (states(ndim, 0:last))
    read (77) states
    close (77)
  end if
  i = nint(t*last)
  u = states(:, i)
  par(1) = F
  par(11) = period
end subroutine
subroutine pvls(ndim, u, par) ! called wherever AUTO has solved
  implicit none
  integer ndim
  double precision u(ndim), par(*)
  write (*, '("at", 2es25.16)') par(1), par(11)
end subroutine
subroutine bcnd
end subroutine
subroutine icnd
end subroutine
subroutine fopt
end subroutine
"""
