"""Classical analyses of indentation: Oliver and Pharr, its correction for creep, linear viscoelastic closed forms."""

from palpate.classical.creep import corrected_stiffness
from palpate.classical.fitted_law import ViscoelasticFit, fit_viscoelastic
from palpate.classical.oliver_pharr import OliverPharr, TipConstants, fit_unloading, oliver_pharr
from palpate.classical.viscoelastic_depth import MODELS, depth_while_growing
from palpate.study.area_function import AreaFunction

__all__ = [
    "MODELS",
    "AreaFunction",
    "OliverPharr",
    "TipConstants",
    "ViscoelasticFit",
    "corrected_stiffness",
    "depth_while_growing",
    "fit_unloading",
    "fit_viscoelastic",
    "oliver_pharr",
]
