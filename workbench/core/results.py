"""The result of comparing: frozen values that can be read, drawn and written as JSON."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .recording import Recording
from .shown import Shown

FORMAT = 1


@dataclass(frozen=True, repr=False)
class RecordingError(Shown):
    """The distance between one recording and its simulation.

    Arrays over axes have shape (n,); NaN where the signal was not measured.

    Attributes:
        recording: what was measured.
        simulated: the model's run of the same experiment: signals ``position``, ``velocity``,
            ``torque_command``, ``torque_measured`` (each (N, n)), without sensor noise.
        position_rmse, torque_rmse: root mean square of measured minus simulated [rad or m; N m or N].
        position_noise, torque_noise: what a perfect model would leave, by simulating the noise.
        error, noise_error: the same two as the normalised score of `Comparison.error`, this
            recording alone.
        covers: duration of a long log [s], of which `recording` and `simulated` hold the worst stretch while
            the numbers are of all of it; None where they hold all.
        ground_force_rmse, ground_force_noise: of the force on the feet, (3 F,) [N]; None off the ground,
            where on it 'torque' is what that force is to the axes.
    """

    recording: Recording
    simulated: Recording
    position_rmse: np.ndarray
    torque_rmse: np.ndarray
    position_noise: np.ndarray
    torque_noise: np.ndarray
    error: float
    noise_error: float
    covers: float | None = None
    ground_force_rmse: np.ndarray | None = None
    ground_force_noise: np.ndarray | None = None

    def residual(self, signal: str) -> np.ndarray:
        """Return measured minus simulated of ``"position"`` or ``"torque_measured"``, shape (N, n)."""
        return self.recording.signals[signal] - self.simulated.signals[signal]


@dataclass(frozen=True)
class Share:
    """A place of error above the noise: its share of one axis's and signal's excess squared error.

    `quantity` is ``speed``, ``position``, ``frequency`` or ``time``; `range` its interval in `unit`;
    `share` the part (0 to 1) of all squared error above the noise that lies there.
    """

    axis: str
    signal: str
    quantity: str
    range: tuple[float, float]
    unit: str
    share: float


#: Noise error above which a model's loop is taken to be unstable: a perfect model's is at most about 1.
HOPELESS = 1.5
#: Times the noise, of a score and of a single signal. A right model's score scatters by a few per cent: noise
#: levels are known to about 2 %, and a single signal's floor from a few draws to about 3 %.
MARGIN_TOTAL, MARGIN_SIGNAL = 1.06, 1.3


@dataclass(frozen=True)
class InverseDynamics:
    """The torque that the model needs for the measured motion, compared with the measured torque.

    `relative_error` is ||tau - tau_model|| / ||tau|| over all axes and recordings, after `filter` on
    both; per axis in `axis_relative_error`, shape (n,).
    """

    relative_error: float
    axis_relative_error: np.ndarray
    filter: str


@dataclass(frozen=True)
class Outlier:
    """The signal that exceeds its own noise the most, if noise alone would not among so many signals.

    Attributes:
        axis: the axis' name.
        signal: ``position`` or ``torque``.
        ratio: root mean square of what is left over that of its noise, over all recordings.
        limit: the most that noise makes of it.
    """

    axis: str
    signal: str
    ratio: float
    limit: float


@dataclass(frozen=True, repr=False)
class Comparison(Shown):
    """A model compared with recordings.

    Attributes:
        model: the model's name.
        axes: axis names.
        recordings: one entry per recording.
        error: root mean square, over axes and over position and torque, of RMSE divided by the
            measured signal's standard deviation, both pooled by samples over all recordings; signals
            that never move are left out.
        noise_error: what a perfect model would score.
        noise_error_std: standard deviation of that from run to run of the noise.
        consistent: whether `error` is statistically compatible with `noise_error`.
        where: where the excess sits, largest share first.
        inverse_dynamics: the torque residual's size, where torque was measured; else None.
        notes: what the reader of the result should know (velocity derived, signals left out...).
        outlier: a signal that noise does not explain by itself; None where there is none.
    """

    model: str
    axes: tuple[str, ...]
    recordings: tuple[RecordingError, ...]
    error: float
    noise_error: float
    noise_error_std: float
    consistent: bool
    where: tuple[Share, ...] = ()
    inverse_dynamics: InverseDynamics | None = None
    notes: tuple[str, ...] = ()
    outlier: Outlier | None = None
