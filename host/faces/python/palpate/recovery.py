# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""Two segmentations in; stiffness, forces and the deformation out."""
from __future__ import annotations

import json
import os
import pathlib
from dataclasses import dataclass
from typing import Any, Dict, Sequence, Tuple, Union

import numpy as np
import numpy.typing as npt

from . import _core
from .solver import Doubles, Progress, solver_choice

Path = Union[str, "os.PathLike[str]"]


@dataclass
class LabelVolume:
    """Integer labels [k, j, i] and where they lie: voxel (i, j, k) has its centre at
    origin + direction @ (i sx, j sy, k sz), LPS mm; `direction` row by row."""

    voxels: npt.NDArray[Any]
    spacing: Sequence[float] = (1.0, 1.0, 1.0)
    origin: Sequence[float] = (0.0, 0.0, 0.0)
    direction: Sequence[float] = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
    name: str = ""

    @staticmethod
    def from_sitk(image: Any, name: str = "") -> LabelVolume:
        """Of a SimpleITK image; the voxels are copied."""
        import SimpleITK

        return LabelVolume(SimpleITK.GetArrayFromImage(image), image.GetSpacing(),
                           image.GetOrigin(), image.GetDirection(), name)

    def to_sitk(self) -> Any:
        """As a SimpleITK image."""
        import SimpleITK

        image = SimpleITK.GetImageFromArray(self.voxels)
        image.SetSpacing(tuple(self.spacing))
        image.SetOrigin(tuple(self.origin))
        image.SetDirection(tuple(self.direction))
        return image

    def _core(self, usual_name: str) -> _core.Labels:
        name = self.name or usual_name
        voxels = np.asarray(self.voxels)
        if voxels.ndim != 3:
            raise ValueError(f"{name}: voxels must be [k, j, i], not of {voxels.ndim} dimensions")
        for what, values, count in (("spacing", self.spacing, 3), ("origin", self.origin, 3),
                                    ("direction", self.direction, 9)):
            if np.size(values) != count:
                raise ValueError(f"{name}: {what} must be {count} numbers")
        if voxels.dtype != np.uint16:
            with np.errstate(invalid="ignore"):
                whole = voxels.astype(np.uint16)
            if not np.array_equal(voxels, whole):
                raise ValueError(f"{name}: labels must be whole numbers from 0 to 65535")
            voxels = whole
        return _core.Labels(np.ascontiguousarray(voxels), [float(x) for x in self.spacing],
                            [float(x) for x in self.origin],
                            [float(x) for x in np.ravel(self.direction)], name)


class Result:
    """What a recovery found. Arrays are views into it, not copies, and keep it alive."""

    def __init__(self, core: _core.Result) -> None:
        self._result = core

    @property
    def converged(self) -> bool:
        return self._result.converged

    @property
    def regions(self) -> Dict[str, Dict[str, Any]]:
        """By name: stiffness_kpa, interval_kpa (95 %), verdict, reason, label, role, poisson_ratio, and
        whatever else result.json holds of a region. Of hollow organs the numbers are 0."""
        written = self.to_dict()["regions"]
        return {core["name"]: {**figures, **core}
                for figures, core in zip(written, self._result.regions)}

    @property
    def nodes(self) -> Doubles:
        """[num_nodes, 3] mm, of the reference's mesh."""
        return self._result.nodes

    @property
    def elements(self) -> npt.NDArray[np.int32]:
        """[num_elements, 4] node numbers from 0; of tet10 [num_elements, 10], the middles of the edges
        01, 12, 02, 03, 13, 23 after the corners."""
        return self._result.elements

    @property
    def element_stiffness_kpa(self) -> Doubles:
        """[num_elements] Young's moduli."""
        return self._result.element_stiffness_kpa

    @property
    def displacement(self) -> Doubles:
        """[num_nodes, 3] mm, reference to the target as the rigid alignment laid it onto the
        reference; the alignment is in to_dict()["alignment"]."""
        return self._result.displacement

    @property
    def force(self) -> Doubles:
        """[num_nodes, 3] mN on the nodes."""
        return self._result.force

    @property
    def displacement_field(self) -> Doubles:
        """[k, j, i, 3] mm on the reference's grid, to where the target lies in its own image:
        the alignment is part of it."""
        return self._result.displacement_field

    def to_dict(self) -> Dict[str, Any]:
        """What the command line writes as result.json."""
        return json.loads(self._result.json)

    def write(self, folder: Path, fields: str = "one") -> None:
        """The result folder with report.html; it must not exist.

        fields  displacement fields, rounded to 1/128 mm: "none", "one" (NIfTI, for each direction)
                or "all" (ITK transforms, too)
        """
        self._result.write(os.fspath(folder), fields)


def _mesh_program() -> str:
    program = pathlib.Path(__file__).parent / "bin" / "palpate-mesh"
    return str(program) if program.exists() else ""


def _settings_text(settings: Path) -> str:
    """Of a path, or of the text itself; a text has more than one line."""
    if isinstance(settings, str) and "\n" in settings:
        return settings
    return pathlib.Path(settings).read_text(encoding="utf-8")


def recover(reference: Union[LabelVolume, Path], target: Union[LabelVolume, Path], settings: Path,
            align: str = "auto", material: str = "linear", num_nodes: int = 0, mesh: Path = "",
            progress: Progress = None, element: str = "tet4", **options: Any) -> Result:
    """Recovers stiffness from two states of one patient.

    reference, target  label volumes: two `LabelVolume`, or two paths of files
    settings           TOML text, or the path of such a file: organs and their roles
    align              "auto", "fixed", "centroid" or "none"
    material           "linear", "neo-hookean" or another law of docs/simulate.md
    num_nodes          of the mesh; 0: the default
    mesh               path of a ready mesh (.vtu) of the reference
    progress           called with (stage, fraction, message); False cancels
    element            "tet4" (linear) or "tet10" (quadratic tetrahedra)
    options            of `palpate.solver.solver_choice`

    Raises PalpateError, whose `status` is that of palpate.h (the exit code of the command line; 11 if
    cancelled). A search that did not converge is a result, with `converged` False.
    """
    choice = _core.RecoverChoice()
    choice.settings = _settings_text(settings)
    choice.align, choice.material, choice.element = align, material, element
    choice.num_nodes, choice.mesh = num_nodes, os.fspath(mesh)
    choice.mesh_program = _mesh_program()
    choice.solver = solver_choice(**options)
    if isinstance(reference, LabelVolume) and isinstance(target, LabelVolume):
        return Result(_core.recover(reference._core("reference"), target._core("target"), choice,
                                    progress))
    if not all(isinstance(one, (str, os.PathLike)) for one in (reference, target)):
        raise TypeError("reference and target must both be LabelVolumes or both be paths")
    return Result(_core.recover_files(os.fspath(reference), os.fspath(target), choice, progress))


@dataclass
class Phantom:
    """Two segmentations whose answer is known."""

    reference: LabelVolume
    target: LabelVolume
    settings: str
    stiffness_kpa: float


def phantom(seed: int = 1, stiffness_kpa: float = 80.0, background_stiffness_kpa: float = 10.0,
            spacing: Tuple[float, float, float] = (1.0, 1.0, 1.0), material: str = "linear",
            num_nodes: int = 0, progress: Progress = None, **options: Any) -> Phantom:
    """A pelvis: a prostate of `stiffness_kpa` pushed by bladder and rectum.

    spacing of the label volumes, mm; num_nodes of the mesh that the truth is solved on (0: the
    default); the rest as for `recover`.
    """
    core = _core.Phantom(seed, stiffness_kpa, background_stiffness_kpa,
                         [float(x) for x in spacing], num_nodes, material, _mesh_program(),
                         solver_choice(**options), progress)
    return Phantom(LabelVolume(name="reference", **core.reference),
                   LabelVolume(name="target", **core.target), core.settings, stiffness_kpa)
