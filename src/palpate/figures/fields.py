"""Contours of the von Mises stress under the indenter, on the deformed body, at each moment that was written."""

from __future__ import annotations

from pathlib import Path

import meshio
import numpy as np
import pandas as pd
from matplotlib.tri import Triangulation

from palpate.figures.style import DOUBLE_COLUMN, plt, save

ACROSS = 3
CONTACT_RADII = 3.0
LEVELS = 13
TIP = 0.05  # part of the extent around a sharp apex, where the stress grows without bound, that sets no colour


def draw(folder: Path, path: str | Path) -> None:
    """Draw all moments that ``fields.csv`` of `folder` lists, with one scale of colours."""
    table = pd.read_csv(folder / "fields.csv")
    meshes = [meshio.read(folder / name) for name in table["file"]]
    extent = CONTACT_RADII * max(_contact_radius(mesh) for mesh in meshes)
    drawn = [(_triangles(mesh), nodal(mesh, "von_mises_GPa")) for mesh in meshes]
    largest = max(values[_shown(mesh, extent)].max() for mesh, (_, values) in zip(meshes, drawn, strict=True))
    rows = -(-len(table) // ACROSS)
    columns = min(ACROSS, len(table))
    figure, axes = plt.subplots(
        rows,
        columns,
        figsize=(DOUBLE_COLUMN * columns / ACROSS + 0.8, 2.4 * rows),
        squeeze=False,
        sharex=True,
        sharey=True,
    )
    for axis, row, (shape, values) in zip(axes.flat, table.itertuples(), drawn, strict=False):
        filled = axis.tricontourf(shape, values, levels=np.linspace(0.0, largest, LEVELS), extend="max", cmap="viridis")
        axis.set_title(f"{row.time_s:.4g} s, {row.load_mN:.3g} mN, {row.depth_nm:.4g} nm")
        axis.set_aspect("equal")
        axis.set_xlim(0.0, extent)
        axis.set_ylim(-extent, 0.2 * extent)
    for axis in axes.flat[len(table) :]:
        axis.set_visible(False)
    for axis in axes[-1]:
        axis.set_xlabel(r"$r$ [µm]")
    for axis in axes[:, 0]:
        axis.set_ylabel(r"$z$ [µm]")
    figure.colorbar(filled, ax=axes, label="von Mises stress [GPa]", format="%.2f")
    save(figure, path)


def nodal(mesh: meshio.Mesh, name: str) -> np.ndarray:
    """Return a field of the elements averaged at the nodes (n,)."""
    elements = mesh.cells[0].data
    total, count = np.zeros(len(mesh.points)), np.zeros(len(mesh.points))
    np.add.at(total, elements, mesh.cell_data[name][0][:, None])
    np.add.at(count, elements, 1.0)
    return total / count


def _deformed(mesh: meshio.Mesh) -> np.ndarray:
    """Return the points (n, 2) where they have moved to [um]."""
    return 1e-3 * (mesh.points + mesh.point_data["displacement_nm"])[:, :2]


def _contact_radius(mesh: meshio.Mesh) -> float:
    """Return the largest distance from the axis that touches, or the innermost ring where only the apex does [um]."""
    r = _deformed(mesh)[:, 0]
    return float(max(r[mesh.point_data["contact"] > 0].max(), r[r > 1e-9].min()))


def _shown(mesh: meshio.Mesh, extent: float) -> np.ndarray:
    """Return which points (n,) decide the scale of colours."""
    distance = 1e-3 * np.hypot(*mesh.points[:, :2].T)
    return (distance > TIP * extent) & (distance < extent)


def _triangles(mesh: meshio.Mesh) -> Triangulation:
    """Return each element as two triangles, without those of no area at the tip."""
    quads = mesh.cells[0].data
    triangles = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    whole = np.array([len(set(corners)) == 3 for corners in triangles.tolist()])
    points = _deformed(mesh)
    return Triangulation(points[:, 0], points[:, 1], triangles[whole])
