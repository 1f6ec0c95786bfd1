# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
"""The outline of tissue that is sucked into a tube, from frames as NumPy arrays.

    tracker = palpate.ContourTracker("aspiration.toml", width=180, height=180)
    profile = tracker.add(frame)                        # as a camera gives them
    found = palpate.contours(frames, "aspiration.toml")       # of a whole film
"""
from __future__ import annotations

import os
import pathlib
from typing import Iterable, List, NamedTuple, Optional, Union

import numpy as np
import numpy.typing as npt

from . import _core

Doubles = npt.NDArray[np.float64]
Flags = npt.NDArray[np.uint8]
Frame = npt.NDArray[np.generic]


class Profile(NamedTuple):
    """The tissue's edge in one frame, [columns]; z_mm counts from the rim's lower face.

    flag  0 ok; 1 guessed, cues disagree; 2 hidden behind the rim, z_mm is the middle of what it hides; 3 lost
    """

    z_mm: Doubles
    sd_mm: Doubles
    flag: Flags


class Contours(NamedTuple):
    """The profiles of a film, of the columns within the hole: what profiles.csv holds.

    r_mm            [columns] distance from the axis, negative left of it
    z_mm, sd_mm     [frames, columns]
    flag            [frames, columns], as of `Profile`
    axis_column_px  in whole frames
    """

    r_mm: Doubles
    z_mm: Doubles
    sd_mm: Doubles
    flag: Flags
    axis_column_px: float


def _settings(config: Union[str, "os.PathLike[str]"]) -> "tuple[str, str]":
    """Text and folder."""
    if isinstance(config, str) and "\n" in config:
        return config, ""
    path = pathlib.Path(config)
    return path.read_text(encoding="utf-8"), str(path.parent)


class ContourTracker:
    """Follows the tissue's edge from frame to frame, as `palpate aspirate contours` does; of a camera, live.

    config         the path of an aspiration's settings, or their text: tables [instrument] and [frames]
    width, height  of frames, pixels

    Raises PalpateError for settings that cannot be, or a rim that is not in the frames.
    """

    def __init__(self, config: Union[str, "os.PathLike[str]"], width: int, height: int) -> None:
        self._tracker = _core.Tracker(*_settings(config), width, height)

    def add(self, frame: Frame, white: Optional[int] = None) -> Profile:
        """The profile in the next frame.

        frame  [height, width] of 8-bit or 16-bit grey, rows from the top
        white  grey of white; default: 255 or 65535. A camera of 12 bits says 4095. What is brighter is white
        """
        grey = np.ascontiguousarray(frame)
        if grey.ndim != 2:
            raise TypeError(f"a frame is grey, [height, width], not of shape {grey.shape}")
        if grey.dtype not in (np.uint8, np.uint16):
            raise TypeError(f"a frame has 8-bit or 16-bit grey (uint8, uint16), not {grey.dtype}")
        chosen = int(np.iinfo(grey.dtype).max) if white is None else white
        if grey.dtype == np.uint16 and chosen <= 255:  # the library reads bytes then
            grey = np.minimum(grey, 255).astype(np.uint8)
        if grey.dtype == np.uint8 and chosen > 255:
            grey = grey.astype(np.uint16)
        add = self._tracker.add_bytes if grey.dtype == np.uint8 else self._tracker.add_words
        return Profile(*add(grey, chosen))

    @property
    def axis_column_px(self) -> float:
        """Of the tube's axis: as the settings say, or as the frames that show tissue tell, and from the tenth of them on
        for good. Raises PalpateError before the first."""
        return float(self._tracker.axis()[0])

    @property
    def r_mm(self) -> Doubles:
        """[columns] Distance from that axis, negative left of it."""
        return np.asarray(self._tracker.axis()[1])

    @property
    def is_within(self) -> npt.NDArray[np.bool_]:
        """[columns] Whether a column lies within the hole."""
        _, r_mm, radius_mm = self._tracker.axis()
        return np.asarray(np.abs(r_mm) <= radius_mm)


def contours(frames: Iterable[Frame], config: Union[str, "os.PathLike[str]"],
             white: Optional[int] = None) -> Contours:
    """The tissue's edge in the frames of a film, [frames, height, width] or one after the other.

    config, white  as of `ContourTracker`

    A film is not refused here for what `palpate aspirate contours` refuses (black or white frames, lost outlines, tissue
    that is brighter or darker than told, unequal sides): look at `flag`. Raises PalpateError where no outline tells the axis.
    """
    tracker: Optional[ContourTracker] = None
    found: List[Profile] = []
    for frame in frames:
        if tracker is None:
            if np.ndim(frame) != 2:
                raise TypeError(f"a frame is grey, [height, width], not of shape {np.shape(frame)}")
            height, width = np.shape(frame)
            tracker = ContourTracker(config, width, height)
        found.append(tracker.add(frame, white))
    if tracker is None:
        raise ValueError("there is no frame; give at least one")
    is_within = tracker.is_within
    z_mm, sd_mm, flag = (np.array(values)[:, is_within] for values in zip(*found))
    return Contours(tracker.r_mm[is_within], z_mm, sd_mm, flag, tracker.axis_column_px)
