"""Every threshold of the diagnosis: what is named, when a search stops, and how much it may simulate.

Modules read `POLICY.tie` and the like when they decide. `benchmarks/policy_sweep.py` shows what each changes.
Steps and tolerances of numerics, sizes of grids and numbers of iterations decide nothing: they stand beside
what they serve.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, fields


@dataclass(frozen=True)
class Policy:
    """The thresholds, one on each line: what it means and, after the semicolon, what a larger value does.

    An error is a weighted mean square (where it says rms, its root): a *fitted* one of data that were fitted,
    a *test* error of held-out recordings or left-out folds. *Noise* is what a perfect model leaves of it, the
    *excess* what is above. A share is one of the excess where nothing else is said.
    """

    # Noise, and which data judge
    fewest_rows: int = 60  # rows to fit; short logs are refused (5 Hz has 60 in twelve seconds)
    at_noise: float = 1.25  # test error / noise up to which noise explains the rest; searches stop earlier
    near_noise: float = 2.0  # both errors / noise: a plain rest above, nearly noise below; stops earlier
    noise_slack: float = 1.03  # error / noise that is none, as floors scatter; more is explained
    weighing_tolerance: float = 0.03  # share of the whole error that weighs as noise; signals weigh alike
    holdout_informative: float = 1.1  # held-out error / noise from which it judges; folds judge more often
    holdout_insensitive: float = 1.5  # fitted over held-out error, each / noise, so that folds judge; rarer
    holdout_unchanged: float = 0.02  # relative change of held-out rms error that is none; folds judge more
    holdout_contradicts: float = 3.0  # held-out error / noise that refutes a model; fewer models are refuted
    recording_shows: float = 0.02  # change of a fold's error over the mean, for a vote; fewer folds vote
    period_smooth: float = 0.9  # correlation from row to row of what moves; fewer motions are seen to repeat
    period_left: float = 0.5  # distance² (1: random instants) that has left a place; longer periods
    period_back: float = 0.01  # distance² that has come back to it; more motions are seen to repeat

    # Accepting an effect, and dropping it again
    effect_gain: float = 0.05  # share that an effect removes on test data; small true effects are missed
    fold_majority: float = 0.5  # share of the voting folds that are better with it; fewer effects
    later_gain: float = 0.25  # as effect_gain, for effects after the first, and refinements; fewer of them
    later_fall: float = 0.10  # share of the whole rms error that a later effect removes; fewer of them
    later_tolerance: float = 0.02  # share of the first error that weighs as noise there; fewer of them
    plain_rest_left: float = 0.15  # share that a later effect may leave of a small plain rest; more of them
    most_of_excess: float = 0.75  # share that is "most": of pairs and sets; fewer of them
    exchange_left: float = 0.5  # share that another cause may leave, to take the place of one; more exchanges
    cancelling: float = 5.0  # torques of effects one by one, over their sum; they may undo each other
    significant: float = 3.0  # deviations by which sizes or responses differ for certain; fewer names
    drop_ties: float = 0.3  # of a tie, that dropping a needless effect may lose; more are dropped
    drop_in_noise: float = 1.05  # test error / noise up to which dropping may lose more; more are dropped
    simpler_loss: float = 0.1  # relative loss that leaving out what may be nothing may make; simpler models
    simpler_unseen: float = 5e-4  # share of its gain that a simpler form may lose (2 % in size); simpler
    shrunk: float = 0.2  # size of a cause over that when it was taken; more stand-ins are left out

    # Ties and rivals
    tie: float = 0.03  # relative difference of errors that is none; simpler models, more rivals told
    basic_share: float = 0.75  # share of the best gain with which basic effects go first; refinements
    far_worse: float = 4.0  # error over another's, with which a form is out; basic and plain ones stay
    test_blind: float = 1.25  # ratio of test errors that fitted ones may overrule; more refinements
    chance_gain: float = 2.0  # error over a wider form's, up to which a special case will do; plainer
    pair_rival: float = 1.5  # fitted error over the best pair's, up to which one is a rival; more rivals
    replacement_close: float = 2.5  # test error over a cause's, of others tried in its place; more work
    merge_from: int = 4  # parameters of two effects in whose place one is tried; fewer tries
    merge_size: float = 0.5  # share of these that the one may have; more merges

    # Naming, and the verdict
    explained: float = 0.95  # share that is "all" (wrong causes seldom remove half); fewer names
    explained_elsewhere: float = 0.98  # the same from another start, of which there are many; fewer names
    near_named: float = 0.8  # share from which effects are told that are not named; fewer are told
    something: float = 0.2  # share from which it is told that known effects remove some; told less often
    surest: float = 0.98  # most probable that a name can be; surer names
    next_best_doubt: float = 0.5  # probability lost where the next explanation does as well; less sure names
    next_best_decay: float = 8.0  # how fast that goes with the relative error of the next; surer names
    rival_doubt: float = 0.25  # weight of rivals in the probability, times their number²; less sure names
    weight_alike: float = 0.95  # cosine of a body's weight and torque biases that look alike; surer names
    weight_most: float = 4.0  # times its stated mass that a body of a linkage may weigh; less sure names
    plain_parameters: int = 2  # parameters up to which no early effect is doubted; fewer new starts
    ground_error: float = 1.5  # rms error / noise up to which names stand on the ground; more names

    # Screening
    screened_gain: float = 0.5  # of the gain asked, what a first estimate promises; fewer simulated
    screened_times: float = 10.0  # excess over that of the best estimate, to be simulated; more are simulated
    screened_slack: float = 0.05  # share that is added to that; more are simulated
    promising: float = 0.4  # share that pairs and sets may leave by a linear loop, to be simulated; more are
    limit_left: float = 0.5  # share of a drive's missing torque that a limit may leave; more limits
    still_step: float = 0.02  # change from row to row over its rms, that is rest; more counts as rest
    still_rows: float = 0.2  # share of rows at rest from which friction is read off the motion; rarer
    still_explained: float = 0.05  # share left in the loop with which that is not needed; rarer
    sticking_rows: float = 0.1  # share of sticking rows from which slopes come from runs; less work

    # Pairs, sets and groups
    axis_share: float = 0.3  # share of an axis that one of a set removes by itself, to be in it; smaller sets
    axes_alike: int = 3  # such axes that make a set without the others; fewer sets
    certain_effects: int = 3  # effects certain by the torque, from which the search goes on; rarer
    certain_share: float = 0.5  # share that these explain, to be the answer in the end; rarer

    # Gaps, soft joints, and how friction sets in; "left" is a share of the squared torque that is lacking
    compliance_from: float = 1.04  # test error / noise from which gaps and soft joints are sought; rarer
    compliance_from_later: float = 1.5  # the same after a first effect; rarer
    compliance_left: float = 0.7  # what one may leave; more candidates
    compliance_times: float = 5.0  # what one may leave over what the best leaves; more candidates
    compliance_beside_gap: float = 0.1  # what a spring leaves that is tried beside any gap; more springs
    compliance_more: float = 0.95  # what one more spring leaves over what was left; more springs
    compliance_simulated: float = 3.0  # screened error over the best rigid fit's, to be simulated; more
    torque_first: float = 0.03  # what one leaves that goes before all other starts; more go first
    gap_effects: int = 4  # effects that come with a gap, at most; more of them
    gap_effect_left: float = 0.8  # what one more of these leaves over what was left; more of them
    gap_simpler: float = 1.15  # what it leaves over the least, up to which simpler ones win; simpler
    onset_to: float = 50.0  # fitted error / noise up to which the sliding speed is asked for; more work
    onset_close: float = 1.5  # fitted error over the best one's, of fits that are asked for it; more work

    # Delays
    delay_above: float = 1.1  # fitted error / noise from which the rows beside a delay's are tried; less work
    delay_left: float = 0.5  # share left with which delays that fell behind try them; more work
    shift_rows: int = 5  # rows by which a log may be shifted; longer shifts are told
    shift_left: float = 0.1  # share of the difference that whole rows leave; lags are called shifts

    # Wrong signs and units
    sign_above: float = 3.0  # rms error / noise from which axes are turned to see; fewer refused
    sign_error: float = 0.25  # relative rms error that the right sign may leave; more refused
    sign_left: float = 0.2  # what turning leaves of the error; more refused
    sign_alike: float = 1.2  # error over the least, of axes any of which may be meant; more are told
    unit_error: float = 0.25  # share of the torque² that the right unit may leave; guesses stand
    unit_left: float = 0.25  # what another unit leaves of that; more refused
    unit_near: float = 0.12  # relative distance of a factor from one between units; more doubts told
    sure: float = 4.0  # deviations by which data show another value without any fit; less is told

    # Intervals
    jackknife_from: float = 1.15  # fitted error / noise from which folds widen intervals; narrower ones
    rival_deviation: float = 0.5  # of the distance to another estimate, that is a deviation; wider ones
    delay_deviation: float = 0.005  # of a row: how a delay acts inside a step is not known; wider ones
    onset_deviation: float = 0.003  # of dry friction: hard stop and short creep differ so much; wider ones
    onset_deviation_of_many: float = 0.008  # the same where several parameters share it; wider ones
    model_deviation: float = 0.002  # of a whole number: right simulations differ by so much; wider
    start_deviation: float = 0.01  # the same on the ground, for the few rows about each start; wider ones

    # Adequacy: certain although something else is missing
    path_settles: float = 0.05  # share of a log in which what a current was before it dies away; fewer rows
    basic_law: float = 0.9  # as `explained`, of friction and inertia against any curve; fewer are certain
    fewest_moving_rows: int = 50  # rows on which an axis moves; fewer effects are certain
    mass_acts: float = 0.01  # share of a mass's squared torque that an axis has, to be asked; fewer axes are

    # Relations, shapes and responses shown as evidence; shares are of the squared torque that is lacking
    unknown_most: float = 0.5  # share of a rest that a free function explains, to be taken out of it; rarer
    relation_beside: float = 0.5  # share of a relation that is told beside a finding; told less often
    relation_first: float = 0.15  # share of one that is told of a rest; told less often
    relation_second: float = 0.3  # share of what the first leaves, of a second one; told less often
    relation_new: float = 0.3  # length of what a quantity adds to those told, to be asked; fewer relations
    relation_chance: float = 0.01  # probability that shuffled rows show as much; told more often
    order_turn: float = 0.6  # of its period, that a motion covers to show a position's order; fewer orders
    shape_share: float = 0.3  # share of a free function, drawn, and doubting a name; fewer shapes
    shape_same: float = 0.01  # difference of such shares that is none; shapes of one quantity rather than two
    tone_cycles: float = 3.0  # cycles of a tone in the longest recording; fewer slow tones
    response_lines: int = 20  # lines of a frequency response that says something; less is said
    response_certain: float = 0.3  # relative deviation of a line that counts; noisier lines count
    response_share: float = 0.15  # share of an effect by which bands may differ from it; more is said
    resonance_near: float = 0.1  # relative distance of two resonances that are one; fewer are new
    distortion_times: float = 2.0  # distortion over the model's own; less is said

    # What recordings can show, and the next experiment
    doubtful: float = 0.9  # probability of a name up to which one experiment more is proposed; more are
    small_effect: float = 0.02  # of the drives' torque, that recordings should show; more is excited
    related: float = 0.5  # correlation of responses from which two effects are held apart; fewer groups
    disagreement: float = 0.25  # relative difference of sizes by which recordings disagree; fewer do
    told_apart: float = 1.2  # rms error / noise with which an experiment tells two models apart; fewer do
    resolved: float = 0.2  # of the log's rate, the highest frequency that it shows; faster experiments

    # Effort: with more of it more is found, and it takes longer
    most_effects: int = 6  # effects that are added one by one; what needs more needs a better model first
    budget_steps: float = 1e8  # steps of a coordinate, then nothing new is begun (minutes on two cores)
    budget_runs: int = 200  # runs of all recordings before that, where these are more steps
    column_cost: float = 0.1  # of a run, what a column costs in a linear loop; searches end earlier
    informative_share: float = 0.6  # share in the recordings that races and grids simulate
    race_behind: float = 2.5  # excess over the best one's, with which a fit stays in a race, ...
    race_noise: float = 0.2  # ... with this much of the noise ...
    race_excess: float = 0.02  # ... and of the excess before added to it
    fit_behind: float = 8.0  # error over the best one's, with which a fit goes on after two steps
    simple_simulated: int = 5  # basic effects that are simulated for a step
    refined_simulated: int = 4  # refinements that are simulated for a step
    onset_simulated: int = 2  # fits of these that are asked how friction sets in
    compliance_candidates: int = 4  # gaps and soft joints that are simulated
    pair_values: float = 3e8  # numbers in the responses of all effects, that fit into memory; else no pairs
    pairs_solved: int = 300  # pairs that are solved within bounds
    pairs_simulated: int = 6  # pairs that are simulated
    sets_simulated: int = 4  # sets on every axis that are simulated
    doubted_singly: int = 3  # least certain effects that are left out one at a time, beside many at once
    replacements: int = 3  # others that are tried in place of a cause
    merge_candidates: int = 2  # effects that are tried in place of two
    check_recordings: int = 2  # recordings in which wrong signs and units are looked for
    check_seconds: float = 20.0  # s, of a log that is too long to be held, in which these are looked for


POLICY = Policy()  #: in force; only `trial` changes it


@contextmanager
def trial(**changes: float) -> Iterator[Policy]:
    """Set `POLICY` to other values for the duration of a block, for a sweep or a test; not safe across
    threads.

    Args:
        changes: values by the names of fields.

    Raises:
        ValueError: a name that is no field.
    """
    unknown = sorted(set(changes) - {field.name for field in fields(Policy)})
    if unknown:
        raise ValueError(f"no field of Policy: {', '.join(unknown)}")
    before = {name: getattr(POLICY, name) for name in changes}
    try:
        for name, value in changes.items():
            object.__setattr__(POLICY, name, value)
        yield POLICY
    finally:
        for name, value in before.items():
            object.__setattr__(POLICY, name, value)
