"""Mount compliance: the support of the specimen deflects under the load, in some places more than in others.

Depth gains compliance * load as with a compliant frame, but each recording has a compliance of its own: near an edge,
over a void in the glue or on a thin part of the specimen it is larger.
"""

from __future__ import annotations

from palpate.base.parameters import Parameter
from palpate.mechanisms.assumptions import Assumption
from palpate.mechanisms.draws import signed
from palpate.mechanisms.frame_compliance import plausible, record
from palpate.mechanisms.mechanism import Mechanism

MECHANISM = Mechanism(
    key="mount_compliance",
    title="mount compliance",
    family="frame",
    effect="depth gains compliance * load, another compliance in every recording",
    parameters=(Parameter("compliance", "C_s", "nm/mN", -1000.0, 1000.0, "compliance of the mount in one recording"),),
    neutral={"compliance": 0.0},
    example={"compliance": 5.0},
    source="Jakes et al., J. Mater. Res. 23 (2008) 1113-1127 (structural compliance)",
    plausible=plausible,
    concealed=lambda rng: {"compliance": signed(rng, 0.1, 5.0)},
    record=record,
    varies=True,
    breaks=frozenset({Assumption.ONE_COMPLIANCE}),
    unidentifiable_at_one_load=True,
    remedy="four or more unloadings from loads that span a factor of ten, within each test",
    includes=("frame_compliance",),
    by_default=False,
)
