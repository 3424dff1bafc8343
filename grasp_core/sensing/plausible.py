"""Whether a camera stands where it can see a table: depths in another unit than metres are told by that."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from grasp_core.errors import ImageError

_LOWEST, _HIGHEST = 0.25, 3.0
"""Metres above the table from which depth cameras see it and grasps 10 cm wide on it: nearer they are blind, and from
farther off fingers 1 cm thick are not two pixels wide."""
_NEAR_TABLE = 0.03
"""Metres above or below z = 0 within which what a camera of known pose sees is taken for the table."""
_LEAST_TABLE = 0.01
"""Share of what such a camera sees that the table is, at least."""


def check_height(height: float, posed: bool) -> None:
    """Refuse a camera that stands where none can: most often depths are not in metres.

    Args:
        height: of the camera above the table, metres.
        posed: whether its pose was given; else the table was found in the image.

    Raises:
        ImageError: too near or too far; heights that are not above 0 are refused where the view is made canonical.
    """
    if 0 < height < _LOWEST or height > _HIGHEST:
        where = "as its pose has it" if posed else "by the table that was found"
        mend = "world_from_camera in the camera file" if posed else "the scale of the depths"
        raise ImageError(
            f"the camera stands {height:.3g} m above the table {where}, and {_LOWEST:g} to {_HIGHEST:g} m are"
            f" plausible; check {mend}: values must be metres, not dm, cm or mm (--depth-scale METRES_PER_UNIT on the"
            " command line)"
        )


def check_table(turned: NDArray[np.float32]) -> None:
    """Refuse an image of a camera of known pose that shows no table at z = 0.

    Args:
        turned: heights above z = 0 (H, W), metres, not finite where nothing was seen.

    Raises:
        ImageError: less than a hundredth of what is seen lies near z = 0.
    """
    few = turned[::4, ::4]
    few = few[np.isfinite(few)]
    if len(few) and (np.abs(few) < _NEAR_TABLE).mean() < _LEAST_TABLE:
        raise ImageError(
            f"the depth image shows no table at z = 0, where world_from_camera puts it: what it shows lies"
            f" {float(np.median(few)):+.2f} m from there in the median; check the scale of the depths, which must be"
            " metres (--depth-scale METRES_PER_UNIT on the command line), and the pose in the camera file"
        )
