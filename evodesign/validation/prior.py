"""Measured postures without one of the men whom they were computed from, so that he can be predicted.

Source: the rows `boxlift` of `human/data/measured_posture.csv`, computed again from `data/box_lifts.csv`.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import cache

import numpy as np

from evodesign.human.measured_posture import ASSUMPTION, PostureRow, posture_rows
from evodesign.validation.measured import MeasuredCase, box_lifts

HAND = 0.0495
"""From wrist to palm, over stature: that of the generated man."""

USED = ((1, "empty"), (2, "box"), (3, "box"), (4, "box"), (5, "box"))
"""Ranges of height, from number times 0.15 m, and what the hands hold there."""

SIDEWAYS = (0.15, 0.2)
"""Mean and deviation of the upper arm's sine outwards: an assumption."""


def palm_height(wrist: float, fore: float, stature: float) -> float:
    """Height of the palms [m] from that of the wrists, with the forearm at an angle [rad] from hanging."""
    return wrist - HAND * stature * math.cos(fore)


@cache
def rows_without(who: str) -> tuple[PostureRow, ...]:
    """The data file's rows, those of the box lifts computed from all men but one."""
    others = [case for case in box_lifts() if case.who != who]
    by_range = [[_features(c) for c in others if (c.bin, c.hands) == used] for used in USED]
    names = [name for name in by_range[0][0] if name != "eta"]
    spread = {
        name: float(np.sqrt(np.mean([np.var([man[name] for man in of], ddof=1) for of in by_range])))
        for name in names
    }
    found = []
    for of in by_range:
        mean = {name: float(np.mean([man[name] for man in of])) for name in of[0]}
        found += [
            PostureRow(name, "both", mean["eta"], mean[name], spread[name], len(of), "measured", "boxlift")
            for name in names
        ]
        found.append(PostureRow("sideways", "both", mean["eta"], *SIDEWAYS, 0, ASSUMPTION, "none"))
    return (*found, *(row for row in posture_rows() if row.task != "both" or math.isnan(row.eta)))


def _features(case: MeasuredCase) -> Mapping[str, float]:
    """Of a man in one range of height, as the data file has them."""
    (frame,), stature = case.frames, case.person.stature
    fore = frame.features["arm"] + frame.features["elbow"]
    angles = {name: math.degrees(value) for name, value in frame.features.items() if name != "ahead"}
    ahead = frame.features["ahead"] + HAND * math.sin(fore)
    return {**angles, "ahead": ahead, "eta": palm_height(frame.wrist, fore, stature) / stature}
