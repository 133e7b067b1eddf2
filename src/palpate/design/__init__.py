"""Design of experiments: which parameters to simulate, and what an effect is worth."""

from palpate.design.anova import Anova, anova
from palpate.design.orthogonal import ARRAYS, OrthogonalArray
from palpate.design.reduction import reduce_levels
from palpate.design.sampling import factorial, latin_hypercube, midpoints, sobol

__all__ = [
    "ARRAYS",
    "Anova",
    "OrthogonalArray",
    "anova",
    "factorial",
    "latin_hypercube",
    "midpoints",
    "reduce_levels",
    "sobol",
]
