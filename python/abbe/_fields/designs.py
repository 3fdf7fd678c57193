"""Fields of results by type. python/generate.py writes this file from the results of the façade."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Union

from .._record import Named, Record
from .deviations import ActingValues, CharacteristicResult, DeviationBudget, DrawnMachineFigures, LimitVerdict, Over, PairedDifference, PathResult, Percentile, ReachedToolPoses, UnreachableCount, VersusFirst
from .machines import Coverage


class BoundedContribution(Record):
    """Effect of an error at its bound."""

    error: Annotated[str, "Name of the error."]
    share: Annotated[float, "Share of the sum of squares, 0 to 1."]
    um: Annotated[float, "Position deviation, um."]


class Tightening(Record):
    """A bounded error, and the effect of its tolerance."""

    error: Annotated[str, "Name of the error."]
    tolerance: Annotated[float, "Its tolerance, in ``unit``."]
    unit: Annotated[str, "``um`` or ``urad``."]
    direction: Annotated[list[float], "Its direction, machine frame."]
    by_letter: Annotated[bool, "True if its name has the letter of a direction."]
    of_class: Annotated[bool, "True if the class bounds it, false if the machine file does."]
    um_per_unit: Annotated[float, "Derivative of the 95 % value by the tolerance, um by unit."]
    sigma: Annotated[float, "Standard error of the derivative, um by unit."]
    um_of_p95: Annotated[float, "Its part of the 95 % value, um."]
    um_of_p95_sigma: Annotated[float, "Standard error of that part, um."]
    at_worst_um: Annotated[Union[float, None], "Its effect where the RSS is largest, um."]
    average_um: Annotated[Union[float, None], "Its effect averaged over the poses, um."]


class FittedBudget(Record):
    """A budget without the rigid motion of the part that fits the deviations best."""

    over: Annotated[Over, "Poses and reference that it is over."]
    position_um: Annotated[DeviationBudget, "The position deviation, um."]
    rotation_urad: Annotated[DeviationBudget, "The rotation of the tool, urad."]
    tighten_first: Annotated[str, "The error whose tolerance to tighten first."]
    agrees: Annotated[bool, "True if that is the same error in machine coordinates."]


class ZoneBudget(Record):
    """Machines drawn without the motion of the part that leaves the smallest largest deviation of each."""

    over: Annotated[Over, "Poses and reference that it is over."]
    position_um: Annotated[DrawnMachineFigures, "The position deviation, um."]
    rotation_urad: Annotated[DrawnMachineFigures, "The rotation of the tool, urad."]


class GoalCost(Record):
    """The cost of tolerances."""

    unit: Annotated[str, "Its unit."]
    power: Annotated[Union[float, None], "Power of the tolerance in the cost; none where the cost is relative to the present tolerances, weight x (present / new - 1)."]
    before: Annotated[float, "Value with the old tolerances."]
    after: Annotated[float, "Value with the new tolerances."]
    per_um: Annotated[Union[float, None], "Cost of lowering the 95 % value by one um; none if no tolerance is free."]


class GoalTolerance(Record):
    """A tolerance for a goal."""

    error: Annotated[str, "Name of the error."]
    kind: Annotated[Literal["positioning", "straightness", "angular", "squareness", "position", "orientation", "radial", "axial", "tilt", "angular_positioning"], "The kind by which it is paid for."]
    unit: Annotated[str, "``um`` or ``urad``."]
    old: Annotated[float, "Before, in ``unit``."]
    new: Annotated[float, "After, in ``unit``."]
    binds: Annotated[Literal["goal", "finest", "coarsest", "present", "held"], "The limit that holds it."]
    um_of_p95: Annotated[float, "Its part of the 95 % value, um."]
    weight: Annotated[float, "Its weight in the cost."]
    cost_before: Annotated[float, "Its cost before."]
    cost_after: Annotated[float, "Its cost after."]


class ToleranceGoal(Record):
    """The cheapest tolerances for a goal."""

    goal_um: Annotated[float, "The goal of the 95 % value, um."]
    before_um: Annotated[Percentile, "The 95 % value with the old tolerances, um, by the machines of the search."]
    proof_um: Annotated[Percentile, "The 95 % value with the new tolerances, um, of machines drawn anew."]
    proof_samples: Annotated[int, "Number of machines of the proof."]
    staying_um: Annotated[float, "The 95 % value of what no tolerance of the cost model changes, um."]
    steps: Annotated[int, "Number of steps of the search."]
    cost: Annotated[GoalCost, "The cost."]
    tolerances: Annotated[list[GoalTolerance], "The tolerances, those of the largest part in the 95 % value first."]


class ContributionsAt(Record):
    """Contributions at a pose."""

    axes: Annotated[Named[float], "The pose, mm and deg."]
    contributions: Annotated[list[BoundedContribution], "Effect of each error at its bound, largest first."]


class BudgetFields(Record):
    """A budget with what it is of."""

    class_source: Annotated[Union[str, None], "Source of the class."]
    samples: Annotated[int, "Number of machines drawn."]
    seed: Annotated[int, "Seed of poses and errors."]
    distribution: Annotated[Literal["uniform", "triangular"], "Distribution of an error between its bounds."]
    statistic: Annotated[Literal["max", "p95"], "Statistic of a machine over the poses."]
    frame: Annotated[Literal["workpiece", "machine", "tool"], "Frame of the vectors: the workpiece frame."]
    order: Annotated[str, "Order of the errors: 1."]
    left_out: Annotated[int, "Number of errors that have values and are left out, for bounds stand for them."]
    with_values: Annotated[Union[ActingValues, None], "The errors with values that no bound stands for, if there are any: they act in every machine drawn."]
    poses: Annotated[int, "Number of poses."]
    position_um: Annotated[DeviationBudget, "The position deviation, um."]
    rotation_urad: Annotated[DeviationBudget, "The rotation of the tool, urad."]
    contributions: Annotated[list[BoundedContribution], "Effect of each error at its bound where the RSS is largest, largest first."]
    contributions_on_average: Annotated[list[BoundedContribution], "The same, averaged over the poses."]
    tighten: Annotated[list[Tightening], "The bounded errors; first the one whose tightening lowers the 95 % value most."]
    coverage: Annotated[Coverage, "Which of the errors that act are known."]
    machine: Annotated[str, "Name of the machine."]
    chain: Annotated[str, "The kinematic chain."]
    over: Annotated[Over, "What the budget is over."]
    limit: Annotated[Union[LimitVerdict, None], "The 95 % value of the position against the limit of the job, if it states one."]
    path: Annotated[Union[PathResult, None], "Events of the path, if the tool poses are one."]
    best_fit: Annotated[Union[FittedBudget, None], "The same without the rigid motion of the best fit, for a volume whose reference is not stated."]
    minimum_zone: Annotated[Union[ZoneBudget, None], "The machines drawn without the minimum zone, where it is the reference: it has no worst case, RSS and effects of single errors, so the other figures are without the least squares."]
    tool_poses: Annotated[Union[ReachedToolPoses, None], "Tool poses of a file that the machine reaches."]
    characteristics: Annotated[Union[list[CharacteristicResult], None], "The characteristics of features for which the job states tolerances, over the machines drawn."]
    goal: Annotated[Union[ToleranceGoal, None], "The cheapest tolerances, if a goal was given."]
    at: Annotated[Union[ContributionsAt, None], "Contributions at the pose that was named."]


class TurnedVerdicts(Record):
    """Ranked arrangements that have no verdict because errors without a value or a bound could turn it."""

    arrangements: Annotated[int, "Number of these arrangements."]
    reason: Annotated[str, "The reason in words."]


class RoundCount(Record):
    """A finished round."""

    samples: Annotated[int, "Number of machines of each arrangement after it."]
    arrangements: Annotated[int, "Number of arrangements that took part."]


class RankingRounds(Record):
    """Rounds of a ranking."""

    max_samples: Annotated[int, "Maximum number of machines drawn of an arrangement."]
    first: Annotated[int, "Number of first ranks that were to be told apart."]
    told_apart: Annotated[bool, "True if they are."]
    done: Annotated[list[RoundCount], "The rounds done: machines drawn, and arrangements that took part."]
    drawn: Annotated[int, "Number of machines drawn of ranked arrangements."]
    drawn_without_elimination: Annotated[int, "Their number if all arrangements had as many as the one with most."]


class ExcludedArrangements(Record):
    """Arrangements that a rule of what can be built leaves out."""

    rule: Annotated[str, "The rule."]
    arrangements: Annotated[int, "Number of arrangements; one that breaks several rules counts for the first."]


class AgainstFirst(Record):
    """An arrangement against the best."""

    verdict: Annotated[Union[Literal["first", "equal", "not_told_apart", "worse", "better"], None], "The verdict; none if it is withheld."]
    minus_first: Annotated[PairedDifference, "The difference to the best on the machines drawn of both."]


class FittedArrangement(Record):
    """The position error of an arrangement without the rigid motion of the part that fits its deviations best."""

    um: Annotated[float, "Its figure, um."]
    versus_first: Annotated[Union[VersusFirst, None], "Its figure minus that of rank 1; none where it is not ranked."]


class Arrangement(Record):
    """An arrangement of the axes."""

    chain: Annotated[str, "Its kinematic chain."]
    on_table: Annotated[int, "Number of axes that carry the workpiece."]
    reached: Annotated[int, "Number of tool poses that it reaches."]
    unreachable: Annotated[UnreachableCount, "Number of tool poses that it does not reach, by reason."]
    um: Annotated[Union[float, None], "Its figure, um; none where it is not judged."]
    low: Annotated[Union[float, None], "Lower end of the confidence interval of the figure, um."]
    high: Annotated[Union[float, None], "Upper end of the confidence interval of the figure, um."]
    mean: Annotated[Union[float, None], "Mean of the machines drawn, um."]
    minus_file: Annotated[Union[float, None], "Its figure minus that of the arrangement of the file, um, on the tool poses that both reach; none without such."]
    samples: Annotated[Union[int, None], "Number of machines drawn."]
    versus_first: Annotated[Union[AgainstFirst, None], "Its figure minus that of the best."]
    best_fit: Annotated[Union[FittedArrangement, None], "The same with the best fit of each arrangement taken out, where neither tool poses nor a reference are given."]
    withheld: Annotated[Union[str, None], "The reason why there is no verdict against the best: what depends on the reference is none, nor is what errors without a value or a bound could turn."]
    misses_reference: Annotated[Union[bool, None], "True if it does not reach the point at which the part is probed."]
    travel: Annotated[Union[Named[list[float]], None], "Travel that the work needs by axis, mm or deg: minimum and maximum."]
    rewinds: Annotated[Union[int, None], "Number of its rewinds, where the tool poses are one path."]
    not_stated: Annotated[Union[list[str], None], "Geometry that the file does not state."]
    rank: Annotated[Union[int, None], "Its rank, from 1; of ranked arrangements only."]


class EnumerateFields(Record):
    """Arrangements in order."""

    machine: Annotated[str, "Name of the machine."]
    chain: Annotated[str, "Its kinematic chain as the file has it."]
    over: Annotated[Over, "Poses and reference of the ranking; reached are the poses that the machine reaches as its file has it."]
    by: Annotated[Literal["budget", "errors"], "Criterion of the arrangements."]
    class_source: Annotated[Union[str, None], "Source of the class."]
    errors: Annotated[int, "Number of errors that count."]
    left_out: Annotated[int, "Number of errors that have values and are left out of all arrangements, for bounds stand for them."]
    coverage: Annotated[Union[Coverage, None], "Which of the errors that act in the machine of the file are known, where the ranking is by a budget."]
    turned: Annotated[Union[TurnedVerdicts, None], "Verdicts that are withheld because errors without a value or a bound could turn them."]
    poses: Annotated[int, "Number of tool poses: all of a job, whether or not the machine of the file reaches them."]
    samples: Annotated[Union[int, None], "Number of machines drawn of every arrangement."]
    rounds: Annotated[Union[RankingRounds, None], "The rounds, where machines are drawn."]
    seed: Annotated[int, "Seed of poses and errors."]
    statistic: Annotated[Literal["max", "p95"], "Statistic of a machine over the poses."]
    reach: Annotated[float, "Fraction of the tool poses from which on arrangements that miss some are listed by their figure."]
    arrangements: Annotated[int, "Number of arrangements."]
    not_buildable: Annotated[Union[list[ExcludedArrangements], None], "Arrangements that are left out because they are hardly built, by rule."]
    ranked: Annotated[list[Arrangement], "The arrangements that do the whole work, best first."]
    reach_less: Annotated[list[Arrangement], "Arrangements that miss some tool poses: figures over their own tool poses, ``minus_file`` on those of them that the arrangement of the file reaches."]
    geometry_not_stated: Annotated[list[Arrangement], "Arrangements whose geometry the file does not state."]
    cannot_turn_the_tool: Annotated[list[str], "Arrangements that cannot turn the tool: their chains."]
    tool_poses: Annotated[Union[ReachedToolPoses, None], "Tool poses of a file that the machine reaches, as its file has it."]


class ReportFields(Record):
    """Size of a page."""

    bytes: Annotated[int, "Number of its bytes."]
