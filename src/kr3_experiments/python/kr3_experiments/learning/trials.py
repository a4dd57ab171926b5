"""Which trial comes next, and what it told. Knows no ROS: the robot, or a simulation of one, is a `Trainee`."""
import random
from dataclasses import dataclass, replace
from typing import Any, Callable, Dict, List, Mapping, Optional, Protocol, Sequence, Set, Tuple

from kr3_experiments.errors import Kr3Error
from kr3_experiments.learning.bindings import Binding
from kr3_experiments.learning.counts import Attempt, AttemptLog, Observed
from kr3_experiments.learning.laws import Atom, GroundAction, LowLevel, State, Value
from kr3_experiments.learning.models_file import noisy_fluents
from kr3_experiments.learning.truth import told

Stratum = Tuple[
    str, Optional[bool]
]  # action, and whether what it observes is so; None: it observes nothing noisy


@dataclass(frozen=True)
class Outcome:
    """What a skill answered."""

    label: str
    observation: Tuple[str, ...]  # values, for laws that tell one
    duration_s: float
    metres: Optional[float] = None


class NothingTried(Kr3Error):
    """Trial after trial could not be made at all."""


class Trainee(Protocol):
    """Something that acts, and whose truth is known."""

    def truth(self) -> Dict[str, Value]:
        """The state now."""

    def execute(self, action: GroundAction, state: State) -> Outcome:
        """Do the action. @throws Kr3Error  it could not be tried at all"""


class Curriculum:
    """Chooses trials until each action was tried often enough, on either side of the truth.

    @param models   the actions of the models file by name: what is noisy in them is to be learned
    @param wanted   trials of each stratum
    """

    def __init__(
        self,
        laws: LowLevel,
        bindings: Mapping[str, Binding],
        models: Mapping[str, Mapping[str, Any]],
        wanted: int,
        seed: int,
    ):
        self._laws = laws
        self._models = models
        self._wanted = wanted
        self._random = random.Random(seed)
        self.names = [name for name in models if name in bindings]
        missing = [name for name in models if name not in bindings]
        if missing:
            raise Kr3Error(f"the bindings have no skill for {', '.join(missing)}")
        self._actions = [action for name in self.names for action in laws.ground_actions(name)]
        self._done: Dict[Stratum, int] = {}
        self._of_arguments: Dict[Tuple[str, Tuple[str, ...]], int] = {}

    def strata(self) -> List[Stratum]:
        """Everything that is to be tried."""
        result: List[Stratum] = []
        for name in self.names:
            sides: Sequence[Optional[bool]] = (
                (True, False) if self._asking_law(name) is not None else (None,)
            )
            result += [(name, side) for side in sides]
        return result

    def left(self) -> int:
        """Trials still wanted."""
        return sum(max(0, self._need(stratum)) for stratum in self.strata())

    def record(self, attempt: Attempt) -> None:
        """Count an attempt that was made."""
        side = next((o.truth for o in attempt.observed if not o.tells_value), None)
        stratum = (attempt.action, side if self._asking_law(attempt.action) is not None else None)
        self._done[stratum] = self._done.get(stratum, 0) + 1
        key = (attempt.action, attempt.arguments)
        self._of_arguments[key] = self._of_arguments.get(key, 0) + 1

    def next(
        self,
        state: State,
        avoid: Sequence[GroundAction] = (),
        handled: Sequence[Set[str]] = (),
    ) -> GroundAction:
        """The possible action that is wanted most; else one after which such an action is possible; else any.

        @param avoid    could not be tried just now: others go before them
        @param handled  arguments of the fluents that the robot itself changed in this world: what it put down lies
                        on the floor, fallen over, as nothing does that it looks for in a mission. Actions that ask
                        about that, or need it known, are for another world
        @throws Kr3Error  nothing is possible
        """
        possible = [action for action in self._actions if self._laws.possible(action, state)]
        possible = [
            action for action in possible if not self._is_stale(action, state, handled)
        ] or possible
        possible = [
            action for action in possible if action.name not in {a.name for a in avoid}
        ] or possible
        if not possible:
            raise Kr3Error(
                "no action of the low level is possible in the state that the robot is in"
            )
        wanted = max(self._need(self._stratum(action, state)) for action in possible)
        most = max((self._need(stratum) for stratum in self.strata()), default=0)
        here = [a for a in possible if self._need(self._stratum(a, state)) == wanted]
        if wanted > 0 and (wanted == most or self._random.random() < 0.8):
            return self._least_tried(here)
        leading = [a for a in possible if self._leads(a, state, most)]
        return self._least_tried(leading or here)

    def _is_stale(self, action: GroundAction, state: State, handled: Sequence[Set[str]]) -> bool:
        """Whether the action, or what is to be asked before it, asks about something that was handled."""
        if not handled:
            return False
        first = self.enquiry(action, state, set())
        about = [fluent for each in (action, first) if each for fluent in self.asked(each)]
        return any(arguments_of(fluent) <= things for fluent in about for things in handled)

    def enquiry(
        self, action: GroundAction, state: State, known: Set[str]
    ) -> Optional[GroundAction]:
        """What the robot should ask before it acts, as it does in missions: whether a condition of the action is so.

        Without it an action would also fail because the robot does not know where things are, and would be learned as
        worse than it is where a policy uses it.

        @param known  ground fluents about which it was said that they are so
        @return None: nothing of the action's conditions is to be asked, or can be now
        """
        for fluent in self._laws.conditions(action):
            if fluent in known or not isinstance(state.get(fluent), str):
                continue
            for other in self._actions:
                law = self._asking_law(other.name)
                if law is None or other.name == action.name:
                    continue
                values = dict(zip(law[0].arguments, other.arguments))
                asks = (law[1].under(values), values.get(law[2] or "", law[2]))
                if asks == (fluent, state[fluent]) and self._laws.possible(other, state):
                    return other
        return None

    def _least_tried(self, actions: Sequence[GroundAction]) -> GroundAction:
        least = min(self._of_arguments.get((a.name, a.arguments), 0) for a in actions)
        return self._random.choice(
            [a for a in actions if self._of_arguments.get((a.name, a.arguments), 0) == least]
        )

    def _need(self, stratum: Stratum) -> int:
        return self._wanted - self._done.get(stratum, 0)

    def asked(self, action: GroundAction) -> List[str]:
        """The ground fluent that an action asks about."""
        law = self._asking_law(action.name)
        return [law[1].under(dict(zip(law[0].arguments, action.arguments)))] if law else []

    def _asking_law(self, name: str) -> Optional[Tuple[Atom, Atom, Optional[str]]]:
        """(head, fluent, value) of the first noisy law that asks whether something is so."""
        noisy = noisy_fluents(self._models[name])
        for law in self._laws.observations:
            if law.action.name == name and law.fluent.name in noisy and law.value is not None:
                return law.action, law.fluent, law.value
        return None

    def _stratum(self, action: GroundAction, state: State) -> Stratum:
        law = self._asking_law(action.name)
        if law is None:
            return (action.name, None)
        values = dict(zip(law[0].arguments, action.arguments))
        value = None if law[2] is None else values.get(law[2], law[2])
        return (action.name, told(state, law[1].under(values), value))

    def _leads(self, action: GroundAction, state: State, most: int) -> bool:
        """Whether an action that is wanted most is possible after this one, if it does what it promises."""
        after = self._laws.promised(action, state)
        return after is not None and any(
            self._need(self._stratum(other, after)) == most and self._laws.possible(other, after)
            for other in self._actions
            if other.name != action.name
        )


def attempt_of(
    laws: LowLevel,
    model: Mapping[str, Any],
    binding: Binding,
    action: GroundAction,
    before: State,
    after: State,
    outcome: Outcome,
) -> Attempt:
    """What one trial told.

    An outcome is what happened in truth, whatever the skill says of it.
    @throws Kr3Error  the skill answered what the bindings do not know
    """
    if outcome.label not in binding.outcomes:
        raise Kr3Error(
            f"{action}: the skill answered '{outcome.label}', expected one of {', '.join(binding.outcomes)}"
        )
    answers = list(binding.outcomes[outcome.label])
    values = list(outcome.observation)
    noisy = noisy_fluents(model)
    observed = []
    for law in laws.observations:
        if law.action.name != action.name:
            continue
        arguments = dict(zip(law.action.arguments, action.arguments))
        fluent = law.fluent.under(arguments)
        tells_value = law.value is None and isinstance(after.get(fluent), str)
        answer = (values if tells_value else answers)[:1]
        del (values if tells_value else answers)[:1]
        if law.fluent.name not in noisy or not answer:
            continue
        if tells_value:
            observed.append(Observed(law.fluent.name, True, answer[0] == after[fluent], True))
        else:
            value = None if law.value is None else arguments.get(law.value, law.value)
            observed.append(
                Observed(law.fluent.name, told(after, fluent, value), answer[0] == "true")
            )
    return Attempt(
        action.name,
        action.arguments,
        laws.possible(action, before),
        laws.outcome(action, after),
        tuple(observed),
        outcome.duration_s,
        outcome.metres,
    )


def arguments_of(fluent: str) -> Set[str]:
    """Of a ground fluent, f(a, b)."""
    return {item.strip() for item in fluent.partition("(")[2].rstrip(")").split(",")} - {""}


def moved(before: State, after: State) -> bool:
    """Whether a fluent has another value, which begins a new visit. Truths may change within one."""
    return any(
        isinstance(value, str) and before.get(fluent) != value for fluent, value in after.items()
    )


def _repeated(actions: Sequence[GroundAction]) -> List[GroundAction]:
    """Those that were done twice: more of the same in the same state would tell of that state only."""
    return [action for action in set(actions) if actions.count(action) > 1]


def train(
    trainee: Trainee,
    curriculum: Curriculum,
    laws: LowLevel,
    models: Mapping[str, Mapping[str, Any]],
    bindings: Mapping[str, Binding],
    log: AttemptLog,
    report: Callable[[str], None],
    most: int,
) -> None:
    """Trials in one world until the curriculum is through, each kept in the log. Those already there count.

    @param most  trials in this world: later ones need another, in which nothing was handled yet
    @throws NothingTried  five trials in a row could not be made
    """
    for attempt in log.attempts:
        curriculum.record(attempt)
    visit = 1 + max((attempt.visit or 0 for attempt in log.attempts), default=0)
    failed: List[GroundAction] = []
    idle: List[GroundAction] = []  # since the state last changed
    known: Set[str] = set()  # said to be so since then
    handled: List[Set[str]] = []  # arguments of what the robot changed in this world
    in_vain: List[GroundAction] = []  # asked about since then, and said not to be so
    enough = len(log.attempts) + most
    while curriculum.left() > 0 and len(log.attempts) < enough:
        before = trainee.truth()
        wanted = curriculum.next(before, [*failed, *in_vain, *_repeated(idle)], handled)
        enquiry = curriculum.enquiry(wanted, before, known)
        if enquiry is not None and wanted in in_vain:
            enquiry = None  # nothing else is possible
        action = enquiry or wanted
        try:
            outcome = trainee.execute(action, before)
            after = trainee.truth()
            attempt = attempt_of(
                laws, models[action.name], bindings[action.name], action, before, after, outcome
            )
        except Kr3Error as error:
            failed.append(action)
            report(f"not counted: {error}")
            if len(failed) == 5:
                raise NothingTried(
                    f"five trials in a row could not be made; the last: {error}"
                ) from error
            continue
        failed = []
        if not moved(before, after):
            handled += [arguments_of(f) for f, value in after.items() if before.get(f) != value]
        if before != after:
            idle, known, in_vain = [], set(), []
        else:
            idle.append(action)
            if any(o.said and o.truth and not o.tells_value for o in attempt.observed):
                known.update(curriculum.asked(action))
            elif enquiry is not None:
                in_vain.append(wanted)
        attempt = replace(attempt, visit=visit)
        visit += moved(before, after)
        log.add(attempt)
        curriculum.record(attempt)
        said = ", ".join(
            f"{o.fluent} {'so' if o.truth else 'not so'}, said {'yes' if o.said else 'no'}"
            for o in attempt.observed
            if not o.tells_value
        )
        report(
            f"{action}: {outcome.label}{' (' + said + ')' if said else ''}; {curriculum.left()} to go"
        )
