"""How the methods of the transfer study are drawn, everywhere alike."""

from __future__ import annotations

from workbench.core.palette import LINES, Line

#: By name in the figures' legends.
LOOKS: dict[str, Line] = {
    "Kin-Only": LINES["kin_only"],
    "Kin-Only HR": Line("fifth", (6.0, 1.5, 1.5, 1.5), 1.2),
    "S3N-Act": LINES["s3n_act"],
    "S3N-Full": LINES["s3n_full"],
    "S3N + found effects": Line("ink", (), 1.1),
    "trained with found effects": Line("quiet", (3.0, 1.2), 1.3),
}
