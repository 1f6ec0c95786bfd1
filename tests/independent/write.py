# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""A phantom's folder: reference.nii.gz, target.nii.gz, organs.toml, truth.json."""
import json

import nibabel
import numpy as np


def write_labels(path, labels, grid):
    """labels (x, y, z) uint8 on a grid in LPS; NIfTI counts towards right, front and up."""
    affine = np.diag([*grid.spacing, 1.0])
    affine[:3, 3] = grid.origin
    image = nibabel.Nifti1Image(labels, np.diag([-1.0, -1.0, 1.0, 1.0]) @ affine)
    image.header.set_xyzt_units("mm")
    nibabel.save(image, path)


def settings_of(anatomy, background_kpa, background_ratio, prostate_ratio):
    """Text of organs.toml. Nothing but what each label is: all priors stay palpate's own."""
    lines = ["[background]", f"stiffness_kpa = {background_kpa}", f"poisson_ratio = {background_ratio}",
             'outer_boundary = "fixed"']
    for organ in anatomy.organs:
        lines += ["", "[[organ]]", f'name = "{organ.name}"', f"label = {organ.label}", f'role = "{organ.role}"']
        lines += (['stiffness_kpa = "unknown"', f"poisson_ratio = {prostate_ratio}"] if organ.role == "tissue"
                  else ["hollow = true"])
    return "\n".join(lines) + "\n"


def write_phantom(folder, grid, reference, target, settings, truth):
    folder.mkdir(parents=True, exist_ok=True)
    write_labels(folder / "reference.nii.gz", reference, grid)
    write_labels(folder / "target.nii.gz", target, grid)
    (folder / "organs.toml").write_text(settings)
    (folder / "truth.json").write_text(json.dumps(truth, indent=2) + "\n")
