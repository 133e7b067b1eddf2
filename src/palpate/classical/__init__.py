"""Classical analyses of indentation: Oliver and Pharr, its correction for creep, linear viscoelastic closed forms."""

from palpate.area_function import AreaFunction
from palpate.classical.creep import corrected_stiffness
from palpate.classical.fit import ViscoelasticFit, fit_viscoelastic
from palpate.classical.oliver_pharr import OliverPharr, fit_unloading, oliver_pharr
from palpate.classical.viscoelastic import MODELS, depth_while_growing

__all__ = [
    "MODELS",
    "AreaFunction",
    "OliverPharr",
    "ViscoelasticFit",
    "corrected_stiffness",
    "depth_while_growing",
    "fit_unloading",
    "fit_viscoelastic",
    "oliver_pharr",
]
