"""Contours of the von Mises stress under the indenter, on the deformed body, at each moment that was written.

Of a pyramid both mirror planes are shown: to the left that through the middle of a face, to the right that through an
edge.
"""

from __future__ import annotations

from pathlib import Path

import meshio
import numpy as np
import pandas as pd
from matplotlib.colors import PowerNorm
from matplotlib.tri import Triangulation

from palpate.output.figures.style import DOUBLE_COLUMN, save, styled, subplots
from palpate.solver.pyramid.mesh_3d import FACES
from palpate.solver.pyramid.shell import WEDGE

ACROSS = 3  # panels in a row
CONTACT_RADII = 2.0  # that a panel shows
LEVELS = 13  # of the contours
TIP = 0.05  # part of the extent around a sharp apex, where the stress grows without bound, that sets no colour


@styled
def draw(folder: Path, path: str | Path) -> None:
    """Draw all moments that ``fields.csv`` of `folder` lists, with one scale of colours."""
    table = pd.read_csv(folder / "fields.csv")
    meshes = [meshio.read(folder / name) for name in table["file"]]
    extent = CONTACT_RADII * max(_contact_radius(mesh) for mesh in meshes)
    solid = any(mesh.cells[0].type == "hexahedron" for mesh in meshes)
    drawn = [(_sections(mesh), nodal(mesh)) for mesh in meshes]
    largest = max(values[_shown(mesh, extent)].max() for mesh, (_, values) in zip(meshes, drawn, strict=True))
    rows = -(-len(table) // ACROSS)
    columns = min(ACROSS, len(table))
    figure, axes = subplots(
        rows,
        columns,
        figsize=(DOUBLE_COLUMN * columns / ACROSS + 0.8, 2.4 * rows),
        squeeze=False,
        sharex=True,
        sharey=True,
    )
    levels = largest * np.linspace(0.0, 1.0, LEVELS) ** 2  # closer where the stress is low, as in most of the body
    moments = zip(table["time_s"], table["load_mN"].round(6), table["depth_nm"], strict=True)
    for axis, (time, load, depth), (sections, values) in zip(axes.flat, moments, drawn, strict=False):
        for shape in sections:
            filled = axis.tricontourf(shape, values, levels=levels, norm=PowerNorm(0.5), extend="max", cmap="viridis")
        axis.set_title(f"{time:.4g} s, {load:.3g} mN, {depth:.4g} nm")
        axis.set_aspect("equal")
        axis.set_xlim(-extent * solid, extent)
        axis.set_ylim(-extent, 0.2 * extent)
    for axis in axes.flat[len(table) :]:
        axis.set_visible(False)
    for axis in axes[-1]:
        axis.set_xlabel(r"under a face | $r$ [µm] | under an edge" if solid else r"$r$ [µm]")
    for axis in axes[:, 0]:
        axis.set_ylabel(r"$z$ [µm]")
    shrink = 0.7 if solid and rows == 1 else 1.0
    figure.colorbar(filled, ax=axes, shrink=shrink, label="von Mises stress [GPa]", format="%.2f")
    save(figure, path)


def nodal(mesh: meshio.Mesh) -> np.ndarray:
    """Return the von Mises stress [GPa] of the elements averaged at the nodes (n,)."""
    elements = mesh.cells[0].data
    total, count = np.zeros(len(mesh.points)), np.zeros(len(mesh.points))
    np.add.at(total, elements, mesh.cell_data["von_mises_GPa"][0][:, None])
    np.add.at(count, elements, 1.0)
    return total / count


def _deformed(mesh: meshio.Mesh) -> np.ndarray:
    """Return r and z (n, 2) of the points where they have moved to [um]; a plane mesh holds them as they are."""
    points = 1e-3 * (mesh.points + mesh.point_data["displacement_nm"])
    if mesh.cells[0].type == "quad":
        return points[:, :2]
    return np.column_stack([np.hypot(points[:, 0], points[:, 1]), points[:, 2]])


def _contact_radius(mesh: meshio.Mesh) -> float:
    """Return the largest distance from the axis that touches, or the innermost ring where only the apex does [um]."""
    r = _deformed(mesh)[:, 0]
    return float(max(r[mesh.point_data["contact"] > 0].max(), r[r > 1e-9].min()))


def _shown(mesh: meshio.Mesh, extent: float) -> np.ndarray:
    """Return which points (n,) decide the scale of colours."""
    distance = 1e-3 * np.linalg.norm(mesh.points, axis=1)
    return (distance > TIP * extent) & (distance < extent)


def _sections(mesh: meshio.Mesh) -> list[Triangulation]:
    """Return a plane mesh, or the two mirror planes of a wedge."""
    points, cells = _deformed(mesh), mesh.cells[0].data
    if mesh.cells[0].type == "quad":
        return [_triangles(points, cells)]
    facets = np.concatenate([cells[:, face] for face in FACES])
    angle = np.arctan2(mesh.points[:, 1], mesh.points[:, 0])
    axis = np.hypot(mesh.points[:, 0], mesh.points[:, 1]) < 1e-9 * np.abs(mesh.points).max()
    sections = []
    for where, side in ((0.0, -1.0), (WEDGE, 1.0)):
        inside = axis | (np.abs(angle - where) < 1e-6)
        sections.append(_triangles(points * [side, 1.0], facets[inside[facets].all(axis=1)]))
    return sections


def _triangles(points: np.ndarray, quads: np.ndarray) -> Triangulation:
    """Return each quadrilateral between points (n, 2) as two triangles, without those of no area at the tip."""
    triangles = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    whole = np.array([len(set(corners)) == 3 for corners in triangles.tolist()])
    return Triangulation(points[:, 0], points[:, 1], triangles[whole])
