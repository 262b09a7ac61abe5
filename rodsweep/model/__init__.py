"""The physics of the follower-loaded Cosserat rod; the package uses no meshes, PETSc, MPI or files.

Units: lengths in L, forces in k3/L^2, time in tau2 = gamma2 L^4/k3, so that gamma2 = k3 = 1.
Sections and tables refer to Warda & Adhikari, "Elastohydrodynamic instabilities of a soft
robotic arm in a viscous fluid". Perturbations of the straight rod grow like exp(w t).

=============  =====================================  =========  =============  ====================
symbol         meaning                                unit       place          in the result file
=============  =====================================  =========  =============  ====================
F              follower force, along -e1 at the tip   k3/L^2     Table I        ``F``
k1             stretch stiffness (inf: inextensible)  k3/L^2     Table I        ``k1``
k2             shear stiffness (inf: unshearable)     k3/L^2     Table I        ``k2``
gamma3         rotational drag                        gamma2 L^2 Table I        ``gamma3``
gamma1         axial drag gamma1/gamma2               1          Sec. VI        ``gamma1`` attribute
c1, c2         compliances 1/k1, 1/k2                 L^2/k3     (ours)         --
nu             compression 1 - F c1                   1          Sec. V         --
g              mu c2 = nu + F c2, mu = k2 nu + F      1          Sec. V         --
u              material coordinate in [0, 1]          L          Sec. II        ``u``
y, theta       deflection and angle                   L, 1       Sec. V         ``Y_*``, ``Theta_*``
s              shear force k2 (y' - nu theta)         k3/L^2     Sec. V         --
m              bending moment theta'                  k3/L       Sec. V         --
w              transverse eigenvalue, complex         1/tau2     Sec. VI        ``growth_rate`` (Re),
                                                                                ``frequency`` (Im)
D(w)           characteristic determinant, D(0) = 1   1          App. C         ``error_estimate``
                                                                                is abs(D/D')
=============  =====================================  =========  =============  ====================

Modes are ordered by descending real part; of a conjugate pair the positive frequency is first.
"""
