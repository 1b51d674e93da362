"""The disc between the fifth lumbar vertebra and the sacrum (L5/S1): which joints cross it, and its figures.

    compression = |extensor moment| / lever + axial force        shear = force across the axis, L5 forwards

The muscles of the back are one muscle parallel to the spine: it presses the disc and does not shear it. The
axis is that of the vertebra above the disc. Muscles that bend or turn the trunk, muscles that work against
each other, ligaments and the pressure in the abdomen are left out, and abdominal muscles have the lever of
those of the back, which is shorter.

Source: the lever is what simple models of the lumbar spine use, 5 cm (Guengoer 2013, Prediction of the
erector spinae muscle lever arm distance for biomechanical models, thesis, Auburn University, abstract, which
was read). A muscle parallel to the vertebrae's axis does not shear them (Robinovitch, Biomechanics of lifting
and lower back pain, lecture notes, which were read). The limit is NIOSH's: 3.4 kN of compression define an
increased risk of low-back injury (Waters, Putz-Anderson, Garg, Fine 1993, Ergonomics 36(7): 749-776; the
abstract was read).
"""

from __future__ import annotations

LUMBAR = "jL5S1_"
"""How the names of the joints begin that cross the disc."""

FLEXION = f"{LUMBAR}roty"
"""The one of them that bends the trunk forwards; muscles that extend it give a negative torque."""

MUSCLE_LEVER = 0.05
"""From the disc's centre to the muscles of the back [m]."""

ACTION_LIMIT = 3400.0
"""Compression [N] from which on the risk of an injury grows."""
