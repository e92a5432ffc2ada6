"""How far a model is from measurements, and where."""

from .by_law import with_torque_by_law
from .closed_loop import ClosedLoop
from .compare import cannot_run, compare, noise_rules, told
from .evaluate import evaluate
from .following import followed
from .long import compare_logs
from .matching import as_compared, explained_by_mujoco, made_by_mujoco, matched, matched_ways
from .measured_motion import nearest_in_time
from .noise import NoiseModel
from .replay import Replay
from .replay_of import replay_of
from .reversed import reversed_torques
from .score import Scale, normalised, score_runs, scored_signals
from .shifted import shifted_axes
from .signs import Turn, Turned, turned_axes
from .simulated import Simulated
from .soft_friction import softness_note
from .standing import on_ground
from .swapped import swapped_axes
from .swings import is_free
from .weighed import is_weighable, torque_left

__all__ = [
    "ClosedLoop",
    "NoiseModel",
    "Replay",
    "Scale",
    "Simulated",
    "Turn",
    "Turned",
    "as_compared",
    "cannot_run",
    "compare",
    "compare_logs",
    "evaluate",
    "explained_by_mujoco",
    "followed",
    "is_free",
    "is_weighable",
    "made_by_mujoco",
    "matched",
    "matched_ways",
    "nearest_in_time",
    "noise_rules",
    "normalised",
    "on_ground",
    "replay_of",
    "reversed_torques",
    "score_runs",
    "scored_signals",
    "shifted_axes",
    "softness_note",
    "swapped_axes",
    "told",
    "torque_left",
    "turned_axes",
    "with_torque_by_law",
]
