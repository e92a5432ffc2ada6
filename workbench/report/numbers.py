"""Numbers for people: the significant digits, a unit of handy size, a 95 % interval."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable

from workbench.core import Estimate
from workbench.core.text import plain as plain  # pages take it from here
from workbench.core.units import unit_text

#: Half a 95 % interval, in standard deviations.
Z95 = 1.959964

_MISSING = "–"


def number(value: float | None, digits: int = 3) -> str:
    """Return `value` with `digits` significant digits and a true minus sign; a dash without a value."""
    if value is None or not math.isfinite(value):
        return _MISSING
    if value == 0:
        return "0"
    size = math.floor(math.log10(abs(value)))
    if not -5 < size < 6:
        return _scientific(f"{value:.{digits - 1}e}")
    return f"{value:.{max(0, digits - 1 - size)}f}".replace("-", "−")


def short(value: float, digits: int = 3) -> str:
    """Return `value` without trailing zeros, for the ends of ranges and ticks: ``"−0.5"``, ``"2"``."""
    text = number(value, digits)
    return text.rstrip("0").rstrip(".") if "." in text and "×" not in text else text


def rounded(values: Iterable[float], digits: int = 4) -> list[float | None]:
    """Return the values for the data of a page, with that many significant digits; None for NaN."""
    return [float(f"{v:.{digits}g}") if math.isfinite(v) else None for v in values]


def unbroken(text: str) -> str:
    """Return `text` with non-breaking spaces inside quantities."""
    for old, new in (
        (" ± ", "\u00a0±\u00a0"),
        (" %", "\u00a0%"),
        (" N m", "\u00a0N\u00a0m"),
        (" kg m", "\u00a0kg\u00a0m"),
    ):
        text = text.replace(old, new)
    return re.sub(r"(?<=\d) (?=[µm]?(?:rad|kg|m|N|s|Hz)\b)", "\u00a0", text)


def percent(share: float | None) -> str:
    """Return a share of one in percent; never rounded up to 100 %."""
    if share is None or not math.isfinite(share):
        return _MISSING
    if 0 < share < 0.005:
        return "< 1 %"
    if 0.99 < share < 1:
        return "> 99 %"
    return f"{100 * share:.0f} %"


def interval(estimate: Estimate) -> str:
    """Return the estimate with half its 95 % interval and unit, e.g. ``"0.254 ± 0.003 N m"``."""
    value, half, unit = estimate.value, Z95 * estimate.std, unit_text(estimate.unit)
    tail = f" {unit}" if unit else ""
    if not (math.isfinite(half) and half > 0 and math.isfinite(value)):
        return number(value, 4) + tail
    places = -math.floor(math.log10(half))
    leading = half * 10.0**places
    places += leading < 3  # two digits where one would round coarsely
    size = math.floor(math.log10(max(abs(value), half)))
    if -5 < size < 6 and places < 9:
        digits = max(0, places)
        value, half = round(value, places) + 0.0, round(half, places)  # also before the point; no minus zero
        return f"{value:.{digits}f} ± {half:.{digits}f}".replace("-", "−") + tail
    digits = max(0, places + size)
    body = f"{round(value / 10.0**size, digits) + 0.0:.{digits}f} ± {half / 10.0**size:.{digits}f}".replace(
        "-", "−"
    )
    return f"({body}) × 10{_superscript(size)}{tail}"


def handy(values: Iterable[float], unit: str) -> tuple[float, str]:
    """Return a factor and a prefixed unit that bring the largest of `values` near one.

    Args:
        values: magnitudes in `unit`; NaN is passed over.
        unit: an SI unit, e.g. ``"rad"`` or ``"N m"``.

    Returns:
        ``(factor, unit)``: number in the new unit = factor * number in `unit`.
    """
    top = max((abs(v) for v in values if math.isfinite(v)), default=0.0)
    if top == 0 or top >= 0.1:
        return 1.0, unit
    return (1e3, f"m{unit}") if top >= 1e-4 else (1e6, f"µ{unit}")


def quantity(value: float, unit: str, digits: int = 3) -> str:
    """Return a number with a unit of handy size, e.g. ``"0.42 mrad"``."""
    if not math.isfinite(value):
        return _MISSING
    factor, scaled = handy([value], unit)
    return f"{number(factor * value, digits)} {scaled}".strip()


def _scientific(text: str) -> str:
    mantissa, exponent = text.split("e")
    return f"{mantissa} × 10{_superscript(int(exponent))}".replace("-", "−")


def _superscript(n: int) -> str:
    return str(n).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))
