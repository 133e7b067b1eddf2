C     Nonlinear Burgers solid for Abaqus/Standard, written by palpate.
C
C       d e_s/dt             = C_s J2**m_s s
C       d e_t/dt + e_t/t_eps = (C_t/t_eps) J2**m_t s   for each Voigt
C                                                      element
C       J2 = s:s/2, creep is isochoric; Hooke's law for the rest.
C
C     The end of a step obeys one scalar equation for q = sqrt(J2),
C
C       q/(2G) + (dt/2) C_s q**(2 m_s + 1)
C              + sum_k c_k C_t,k q**(2 m_t,k + 1) = rho,
C       rho = sqrt(R:R/2),   s = (q/rho) R,
C
C     with R the strain deviator less all that the history fixes.
C     Steady creep is trapezoidal; Voigt strains are integrated exactly
C     for a driving term linear in time. DDSDDE is the derivative of
C     this update. Source: radial return after Simo & Hughes,
C     Computational Inelasticity (1998), section 3.3.
C
C     PROPS   G, K [GPa], C_s [GPa**-(2 m_s + 1)/s], m_s, then C_t
C             [GPa**-(2 m_t + 1)], m_t, t_eps [s] of each element
C     STATEV  steady strain (NTENS), then each Voigt strain (NTENS);
C             tensor shear
C     For NDI = 3 (axisymmetric, plane strain, solid), NSHR 1 or 3.
C     With NLGEOM, DROT turns the state (Abaqus turns STRESS itself).
C
      SUBROUTINE UMAT(STRESS, STATEV, DDSDDE, SSE, SPD, SCD, RPL,
     1 DDSDDT, DRPLDE, DRPLDT, STRAN, DSTRAN, TIME, DTIME, TEMP, DTEMP,
     2 PREDEF, DPRED, CMNAME, NDI, NSHR, NTENS, NSTATV, PROPS, NPROPS,
     3 COORDS, DROT, PNEWDT, CELENT, DFGRD0, DFGRD1, NOEL, NPT, LAYER,
     4 KSPT, JSTEP, KINC)
      IMPLICIT NONE
      CHARACTER*80 CMNAME
      INTEGER NDI, NSHR, NTENS, NSTATV, NPROPS, NOEL, NPT, LAYER, KSPT
      INTEGER JSTEP(4), KINC
      DOUBLE PRECISION STRESS(NTENS), STATEV(NSTATV)
      DOUBLE PRECISION DDSDDE(NTENS,NTENS), DDSDDT(NTENS)
      DOUBLE PRECISION DRPLDE(NTENS), STRAN(NTENS), DSTRAN(NTENS)
      DOUBLE PRECISION TIME(2), PREDEF(1), DPRED(1), PROPS(NPROPS)
      DOUBLE PRECISION COORDS(3), DROT(3,3), DFGRD0(3,3), DFGRD1(3,3)
      DOUBLE PRECISION SSE, SPD, SCD, RPL, DRPLDT, DTIME, TEMP, DTEMP
      DOUBLE PRECISION PNEWDT, CELENT
C
      DOUBLE PRECISION OLD(6), R(6), A, B, C, G, BULK, PRESSURE, VOLUME
      DOUBLE PRECISION QOLD, Q, RHO, RATIO, SLOPE, STEADY, CREEP
      DOUBLE PRECISION DRIVE, POWER
      INTEGER I, J, K, N, ELEMENTS
      LOGICAL CONVERGED
C
      G = PROPS(1)
      BULK = PROPS(2)
      ELEMENTS = (NPROPS - 4)/3
      STEADY = 0.5D0*DTIME*PROPS(3)
      DO K = 0, ELEMENTS
        CALL TURN(STATEV(K*NTENS + 1), DROT, NDI, NTENS)
      END DO
C
C     Strain deviator at the end of the step, as far as the past
C     does not fix it.
C
      PRESSURE = (STRESS(1) + STRESS(2) + STRESS(3))/3D0
      VOLUME = DSTRAN(1) + DSTRAN(2) + DSTRAN(3)
      DO I = 1, NTENS
        OLD(I) = STRESS(I)
        R(I) = 0.5D0*DSTRAN(I)
        IF (I .LE. NDI) THEN
          OLD(I) = STRESS(I) - PRESSURE
          R(I) = DSTRAN(I) - VOLUME/3D0
        END IF
      END DO
      CALL INVARIANT(OLD, NDI, NTENS, QOLD)
      CREEP = STEADY*POWER(QOLD, 2D0*PROPS(4))
      DO I = 1, NTENS
        R(I) = R(I) + (0.5D0/G - CREEP)*OLD(I)
      END DO
      DO K = 1, ELEMENTS
        N = 4 + 3*(K - 1)
        CALL VOIGT(DTIME/PROPS(N + 3), A, B, C)
        DRIVE = B*PROPS(N + 1)*POWER(QOLD, 2D0*PROPS(N + 2))
        DO I = 1, NTENS
          J = K*NTENS + I
          R(I) = R(I) + (1D0 - A)*STATEV(J) - DRIVE*OLD(I)
        END DO
      END DO
      CALL INVARIANT(R, NDI, NTENS, RHO)
      CALL RADIAL(RHO, DTIME, PROPS, NPROPS, Q, SLOPE, CONVERGED)
      IF (.NOT. CONVERGED) THEN
        PNEWDT = 0.25D0
        RETURN
      END IF
      RATIO = 2D0*G
      IF (RHO .GT. 0D0) RATIO = Q/RHO
C
C     State, stress and tangent at the end of the step.
C
      DO I = 1, NTENS
        STATEV(I) = STATEV(I) + CREEP*OLD(I)
     1    + STEADY*POWER(Q, 2D0*PROPS(4))*RATIO*R(I)
      END DO
      DO K = 1, ELEMENTS
        N = 4 + 3*(K - 1)
        CALL VOIGT(DTIME/PROPS(N + 3), A, B, C)
        DO I = 1, NTENS
          J = K*NTENS + I
          STATEV(J) = A*STATEV(J) + PROPS(N + 1)*(
     1      B*POWER(QOLD, 2D0*PROPS(N + 2))*OLD(I)
     2      + C*POWER(Q, 2D0*PROPS(N + 2))*RATIO*R(I))
        END DO
      END DO
      DO I = 1, NTENS
        STRESS(I) = RATIO*R(I)
        IF (I .LE. NDI) STRESS(I) = STRESS(I) + PRESSURE + BULK*VOLUME
        DO J = 1, NTENS
          DDSDDE(I,J) = 0D0
          IF (RHO .GT. 0D0) THEN
            DDSDDE(I,J) = (SLOPE - RATIO)*(R(I)/RHO)*(R(J)/RHO)/2D0
          END IF
          IF (I .LE. NDI .AND. J .LE. NDI) THEN
            DDSDDE(I,J) = DDSDDE(I,J) + BULK - RATIO/3D0
          END IF
        END DO
        IF (I .LE. NDI) DDSDDE(I,I) = DDSDDE(I,I) + RATIO
        IF (I .GT. NDI) DDSDDE(I,I) = DDSDDE(I,I) + 0.5D0*RATIO
      END DO
      RETURN
      END
C
C     Q and dQ/dRHO from the scalar equation, by Newton; its left side
C     is convex and increasing, so it converges from anywhere.
C
      SUBROUTINE RADIAL(RHO, DTIME, PROPS, NPROPS, Q, SLOPE, CONVERGED)
      IMPLICIT NONE
      INTEGER NPROPS, K, N, ITERATION
      DOUBLE PRECISION RHO, DTIME, PROPS(NPROPS), Q, SLOPE
      DOUBLE PRECISION VALUE, TERM, CHANGE, A, B, C, POWER
      LOGICAL CONVERGED
      Q = 2D0*PROPS(1)*RHO
      SLOPE = 2D0*PROPS(1)
      CONVERGED = .TRUE.
      IF (RHO .LE. 0D0) RETURN
      DO ITERATION = 1, 100
        TERM = 0.5D0*DTIME*PROPS(3)*POWER(Q, 2D0*PROPS(4))
        VALUE = (0.5D0/PROPS(1) + TERM)*Q - RHO
        SLOPE = 0.5D0/PROPS(1) + (2D0*PROPS(4) + 1D0)*TERM
        DO K = 1, (NPROPS - 4)/3
          N = 4 + 3*(K - 1)
          CALL VOIGT(DTIME/PROPS(N + 3), A, B, C)
          TERM = C*PROPS(N + 1)*POWER(Q, 2D0*PROPS(N + 2))
          VALUE = VALUE + TERM*Q
          SLOPE = SLOPE + (2D0*PROPS(N + 2) + 1D0)*TERM
        END DO
        SLOPE = 1D0/SLOPE
        CHANGE = VALUE*SLOPE
        IF (CHANGE .GE. Q) CHANGE = 0.5D0*Q
        Q = Q - CHANGE
        IF (ABS(CHANGE) .LE. 1D-12*Q) RETURN
      END DO
      CONVERGED = .FALSE.
      RETURN
      END
C
C     Weights of a Voigt element over a step of X retardation times:
C     A = exp(-X), B = (1 - A)/X - A, C = 1 - (1 - A)/X.
C
      SUBROUTINE VOIGT(X, A, B, C)
      IMPLICIT NONE
      DOUBLE PRECISION X, A, B, C, TERM
      INTEGER K
      A = EXP(-X)
      IF (X .GT. 0.1D0) THEN
        C = 1D0 - (1D0 - A)/X
        B = 1D0 - C - A
      ELSE
        B = 0D0
        C = 0D0
        TERM = 1D0
        DO K = 1, 10
          TERM = -TERM*X/K
          C = C - TERM/(K + 1)
          B = B - TERM*K/(K + 1)
        END DO
      END IF
      RETURN
      END
C
      DOUBLE PRECISION FUNCTION POWER(X, EXPONENT)
      IMPLICIT NONE
      DOUBLE PRECISION X, EXPONENT
      POWER = 0D0
      IF (EXPONENT .EQ. 0D0) POWER = 1D0
      IF (X .GT. 0D0) POWER = EXP(EXPONENT*LOG(X))
      RETURN
      END
C
C     sqrt(T:T/2) of a symmetric tensor with tensor shear.
C
      SUBROUTINE INVARIANT(T, NDI, NTENS, Q)
      IMPLICIT NONE
      INTEGER NDI, NTENS, I
      DOUBLE PRECISION T(NTENS), Q
      Q = 0D0
      DO I = 1, NTENS
        IF (I .LE. NDI) Q = Q + 0.5D0*T(I)*T(I)
        IF (I .GT. NDI) Q = Q + T(I)*T(I)
      END DO
      Q = SQRT(Q)
      RETURN
      END
C
C     T becomes DROT T DROT^T; components 11, 22, 33, 12, 13, 23.
C
      SUBROUTINE TURN(T, DROT, NDI, NTENS)
      IMPLICIT NONE
      INTEGER NDI, NTENS, I, J, K, L, N
      DOUBLE PRECISION T(NTENS), DROT(3,3), FULL(3,3), S
      INTEGER ROW(6), COLUMN(6)
      DATA ROW /1, 2, 3, 1, 1, 2/
      DATA COLUMN /1, 2, 3, 2, 3, 3/
      DO I = 1, 3
        DO J = 1, 3
          FULL(I,J) = 0D0
        END DO
      END DO
      DO N = 1, NTENS
        FULL(ROW(N),COLUMN(N)) = T(N)
        FULL(COLUMN(N),ROW(N)) = T(N)
      END DO
      DO N = 1, NTENS
        S = 0D0
        DO K = 1, 3
          DO L = 1, 3
            S = S + DROT(ROW(N),K)*FULL(K,L)*DROT(COLUMN(N),L)
          END DO
        END DO
        T(N) = S
      END DO
      RETURN
      END
