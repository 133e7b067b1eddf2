"""Public files of the instruments' makers, which are no part of the repository."""

from pathlib import Path

import pytest

RECORDINGS = Path(__file__).parents[3] / "shared/recordings"
needs_recordings = pytest.mark.skipif(
    not RECORDINGS.is_dir(), reason="the public recordings are not part of the repository (folder shared/recordings)"
)
ANON = RECORDINGS / "indentationTools.jl/anonNI.TXT"
LONG = RECORDINGS / "gukin94/HT_V_300mN.TXT"
XP = RECORDINGS / "micromechanics/FS_XP.xls"
KLA = RECORDINGS / "micromechanics_indentationGUI/FusedSilica.xlsx"
STEEL = RECORDINGS / "micromechanics/RobinSteel0000LC.txt"
HLD = RECORDINGS / "micromechanics/Exp-50mN_0000.hld"
BRUKER = RECORDINGS / "merrypopins/grain1_6um_indent01_HL_QS_LC.txt"
