"""Surrogates: from material parameters to a depth curve in microseconds."""

from palpate.surrogate.kernels import KERNELS, Kernel
from palpate.surrogate.leave_one_out import ConditionError
from palpate.surrogate.pod import POD
from palpate.surrogate.pod_rbf import PODRBF

__all__ = ["KERNELS", "POD", "PODRBF", "ConditionError", "Kernel"]
