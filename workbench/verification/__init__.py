"""Whether the closed chain, the serial tree and S3N agree, with each other and with a measured response."""

from .page import frf_figure, frf_sheet
from .responses import FrfComparison, compare_frf, model_responses
from .verify import verify

__all__ = ["FrfComparison", "compare_frf", "frf_figure", "frf_sheet", "model_responses", "verify"]
