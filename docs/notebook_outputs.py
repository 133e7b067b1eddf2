"""Take into `notebook.md` what its first lines show: ``python docs/notebook_outputs.py anonNI.TXT``.

The lines up to the first figure are executed as the page has them; `refresh.py` adds what a calibration and a diagnosis
show. The outputs go to ``docs/data/notebook.json`` and ``docs/images/notebook_curve.png``.
"""

from __future__ import annotations

import json
import os
import re
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import matplotlib

HERE = Path(__file__).parent
LAST = "curve.plot("  # the line of the first figure
SHOWN = ("test", "study")
TEMPORARY = re.compile(r"\S*tmp\w{8}/")  # folder of a draft
INCHES = (5.5, 3.4)


def main(words: Sequence[str]) -> int:
    """Execute the lines, and write their outputs."""
    file = Path(words[0]).resolve()
    matplotlib.use("Agg")
    matplotlib.rcParams["figure.figsize"] = INCHES
    (code,) = re.findall(
        r"```python\n(from palpate .*?)```", (HERE / "notebook.md").read_text(encoding="utf-8"), re.DOTALL
    )
    lines = code.splitlines()
    end = next(k for k, line in enumerate(lines) if line.startswith(LAST)) + 1
    names: dict[str, Any] = {}
    os.chdir(file.parent)
    exec("\n".join(lines[:end]), names)
    from matplotlib import pyplot as plt

    plt.gcf().savefig(HERE / "images/notebook_curve.png", dpi=130, metadata={"Software": None})
    texts = {name: TEMPORARY.sub(".../", names[name].summary()) for name in SHOWN}
    (HERE / "data/notebook.json").write_text(json.dumps(texts, indent=2) + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
