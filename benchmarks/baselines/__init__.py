"""What else one would do with the same recordings: other methods that name what is missing."""

from functools import partial

from .least_squares import least_squares
from .mujoco_sysid import identify_everything

#: Name -> method; each takes the training recordings and answers.
METHODS = {
    "least_squares_bic": partial(least_squares, criterion="bic"),
    "least_squares_aic": partial(least_squares, criterion="aic"),
    "sysid": identify_everything,
}

__all__ = ["METHODS", "identify_everything", "least_squares"]
