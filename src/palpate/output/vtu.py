"""Fields in the body as files: a VTU for each moment, a PVD that lists them for ParaView, and a CSV for people.

Points are undeformed, in nm: x = r and y = z under a tip of revolution, x, y and z of the wedge under a pyramid.
ParaView's *Warp By Vector* with the displacement deforms them.
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import meshio
import numpy as np
import pandas as pd

from palpate.solver.axisymmetric.fields import Fields

CELLS = {4: "quad", 8: "hexahedron"}  # by their corners


def write(moments: Iterable[Fields], folder: Path) -> None:
    """Write ``fields_NNN.vtu``, ``fields.pvd`` and ``fields.csv`` into `folder`, which is made where it is missing."""
    folder.mkdir(parents=True, exist_ok=True)
    rows: list[dict[str, str | float]] = []
    for fields in moments:
        name = f"fields_{len(rows):03d}.vtu"
        mesh_of(fields).write(folder / name)
        rows.append({"file": name, "time_s": fields.time, "load_mN": fields.load, "depth_nm": fields.depth})
    pd.DataFrame(rows).to_csv(folder / "fields.csv", index=False)
    entries = "\n".join(f'    <DataSet timestep="{row["time_s"]:.12g}" file="{row["file"]}"/>' for row in rows)
    (folder / "fields.pvd").write_text(
        f'<VTKFile type="Collection" version="0.1">\n  <Collection>\n{entries}\n  </Collection>\n</VTKFile>\n',
        encoding="utf-8",
    )


def mesh_of(fields: Fields) -> meshio.Mesh:
    """Return points in nm, displacement in nm, and mean stresses of the elements in GPa."""
    stress, missing = fields.element_stress, 3 - fields.displacement.shape[1]
    nodes, displacement = (np.pad(each, ((0, 0), (0, missing))) for each in (fields.mesh.nodes, fields.displacement))
    return meshio.Mesh(
        1e3 * nodes,
        [(CELLS[fields.mesh.elements.shape[1]], fields.mesh.elements)],
        point_data={
            "displacement_nm": displacement,
            "contact": fields.touching.astype(np.int32),
        },
        cell_data={
            "von_mises_GPa": [fields.element_von_mises],
            **{f"stress_{name}_GPa": [stress[:, k]] for k, name in enumerate(fields.components)},
        },
    )
