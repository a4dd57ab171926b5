"""Decisions under uncertainty: POMDP models, beliefs, policies, a solver with lower and upper
bounds, and planning online. Names are those of the C++ library; states, actions and
observations are given by index or name; arrays are numpy's."""

# Made by kr3_common/python/make_stub.py.

import numpy.typing
from typing import Any, Callable, ClassVar, Iterable, Optional, Union

class Error(RuntimeError):
    """Base of everything that KR3's cores throw. `code` says what a caller can act on."""
    code: ClassVar[str]

class InvalidArgument(Error):
    """An Error with the code of its name."""
    code: ClassVar[str]

class NotFound(Error):
    """An Error with the code of its name."""
    code: ClassVar[str]

class FailedPrecondition(Error):
    """An Error with the code of its name."""
    code: ClassVar[str]

class Unavailable(Error):
    """An Error with the code of its name."""
    code: ClassVar[str]

class ResourceExhausted(Error):
    """An Error with the code of its name."""
    code: ClassVar[str]

class DeadlineExceeded(Error):
    """An Error with the code of its name."""
    code: ClassVar[str]

class Cancelled(Error):
    """An Error with the code of its name."""
    code: ClassVar[str]

class InternalError(Error):
    """An Error with the code of its name."""
    code: ClassVar[str]

class Belief:
    """A probability distribution over the states of a model, shape [num_states].
    numpy.asarray(belief) reads it in place; where a function takes a Belief it takes an
    array too.
    """
    def __init__(self, probabilities: Union[Belief, numpy.typing.ArrayLike]) -> None:
        """Shape [num_states]; sums to 1 within 1e-6 and is normalised. Raises InvalidArgument."""
    @property
    def probabilities(self) -> numpy.typing.NDArray[numpy.float64]:
        """A copy, shape [num_states]."""
    def __len__(self) -> int: ...
    def __getitem__(self, arg0: int) -> float: ...

class BeliefUpdate:
    """What a belief becomes, and how likely that was."""
    @property
    def posterior(self) -> Belief:
        """the new belief"""
    @property
    def probability(self) -> float:
        """Pr(observation | belief, action), in (0, 1]"""

class Model:
    """A flat, sparse POMDP: an immutable value. From ModelBuilder, modelFromArrays, a
    FactoredModel or a file.
    """
    def numStates(self) -> int:
        """How many states."""
    def numActions(self) -> int:
        """How many actions."""
    def numObservations(self) -> int:
        """How many observations."""
    @property
    def states(self) -> list[str]:
        """Names, in the order of the indices."""
    @property
    def actions(self) -> list[str]:
        """Names, in the order of the indices."""
    @property
    def observations(self) -> list[str]:
        """Names, in the order of the indices."""
    def stateName(self, state: int) -> str:
        """The name of a state. Raises InvalidArgument."""
    def actionName(self, action: int) -> str:
        """The name of an action. Raises InvalidArgument."""
    def observationName(self, observation: int) -> str:
        """The name of an observation. Raises InvalidArgument."""
    def findState(self, name: str) -> Optional[int]:
        """Its index, or None."""
    def findAction(self, name: str) -> Optional[int]:
        """Its index, or None."""
    def findObservation(self, name: str) -> Optional[int]:
        """Its index, or None."""
    @property
    def discount(self) -> float:
        """In (0, 1]."""
    @property
    def initial_belief(self) -> Belief:
        """Before anything is seen."""
    @property
    def initial_labels(self) -> list[int]:
        """What the robot sees before its first action: a label for each state; empty when it sees
        nothing.
        """
    def initialOutcomes(self) -> list[tuple[float, Belief]]:
        """The beliefs that the robot may have before its first action, with their probabilities.
        """
    def transitionArray(self) -> numpy.typing.NDArray[numpy.float64]:
        """T(s' | s, a), shape [num_actions, num_states, num_states]. Raises ResourceExhausted
        above 2^27 entries.
        """
    def observationArray(self) -> numpy.typing.NDArray[numpy.float64]:
        """O(o | a, s'), shape [num_actions, num_states, num_observations]. Raises
        ResourceExhausted above 2^27 entries.
        """
    def transitionEntries(self) -> tuple[numpy.typing.NDArray[numpy.int64], numpy.typing.NDArray[numpy.float64]]:
        """What is not 0 in T: indices (action, state, next state), shape [n, 3], and
        probabilities, shape [n].
        """
    def observationEntries(self) -> tuple[numpy.typing.NDArray[numpy.int64], numpy.typing.NDArray[numpy.float64]]:
        """What is not 0 in O: indices (action, next state, observation), shape [n, 3], and
        probabilities, shape [n].
        """
    def rewardArray(self) -> numpy.typing.NDArray[numpy.float64]:
        """The expected immediate reward R(a, s), shape [num_actions, num_states]."""
    def withInitialBelief(self, belief: Union[Belief, numpy.typing.ArrayLike]) -> Model:
        """The same model started elsewhere; the robot sees nothing before its first action. Raises
        InvalidArgument.
        """
    def sizeInBytes(self) -> int:
        """Memory held, roughly."""

class ModelBuilder:
    """Collects a model piece by piece. What is set later replaces what was set before; what is
    never set is 0, and the initial belief is uniform. States, actions and observations are
    indices or names; None is every.
    """
    def __init__(self, states: list[str], actions: list[str], observations: list[str]) -> None:
        """From names. Raises InvalidArgument: an empty list, a duplicate or empty name."""
    def setDiscount(self, discount: float) -> None:
        """In (0, 1]."""
    def setInitialBelief(self, probabilities: Union[Belief, numpy.typing.ArrayLike]) -> None:
        """Shape [num_states]; build() checks it."""
    def setTransition(self, action: Optional[Union[int, str]], state: Optional[Union[int, str]], next_state: Optional[Union[int, str]], probability: float) -> None:
        """T(next_state | state, action) = probability. Raises InvalidArgument, NotFound."""
    def addTransition(self, action: Optional[Union[int, str]], state: Optional[Union[int, str]], next_state: Optional[Union[int, str]], probability: float) -> None:
        """Adds to T(next_state | state, action)."""
    def setObservation(self, action: Optional[Union[int, str]], next_state: Optional[Union[int, str]], observation: Optional[Union[int, str]], probability: float) -> None:
        """O(observation | action, next_state) = probability. Raises InvalidArgument, NotFound."""
    def addObservation(self, action: Optional[Union[int, str]], next_state: Optional[Union[int, str]], observation: Optional[Union[int, str]], probability: float) -> None:
        """Adds to O(observation | action, next_state)."""
    def setReward(self, action: Optional[Union[int, str]], state: Optional[Union[int, str]], value: float, next_state: Optional[Union[int, str]] = None, observation: Optional[Union[int, str]] = None) -> None:
        """R(action, state, next_state, observation) = value; the model keeps the expectation R(a,
        s).
        """
    def build(self, sum_tolerance: float = ...) -> Model:
        """The model. Raises InvalidArgument naming the row of T or O that does not sum to 1 within
        the tolerance, or the entry that is no probability.
        """

def modelFromArrays(transitions: Any, observations: Any, rewards: Any, *, discount: float, initial_belief: Optional[Union[Belief, numpy.typing.ArrayLike]] = None, states: Optional[Union[int, list[str]]] = None, actions: Optional[Union[int, list[str]]] = None, observation_names: Optional[Union[int, list[str]]] = None, sum_tolerance: float = ...) -> Model:
    """A model from arrays: T(s' | s, a) of shape [A, S, S], O(o | a, s') of shape [A, S, O], R
    of shape [A, S], [A, S, S] or [A, S, S, O]. Each may also be sparse: a pair of indices,
    shape [n, 3] (for R [n, 2], [n, 3] or [n, 4]), and values, shape [n]; or a dict from
    tuples of indices to values; probabilities of equal indices add up. `states`, `actions`
    and `observation_names` are names or how many there are; only what no dense array tells
    is needed. Raises InvalidArgument naming the array or row that is wrong.
    """

def loadModel(path: str) -> Model:
    """Reads a file in the .pomdp or .pomdpx format. Raises Unavailable, or InvalidArgument
    with 'file:line:column: message'.
    """

def writePomdp(path: str, model: Model) -> None:
    """Writes Cassandra's format such that loadModel gives the same model, to the last bit.
    Raises Unavailable, InvalidArgument.
    """

def writePomdpx(path: str, model: Model) -> None:
    """Writes the POMDPX format, with one state variable. Raises Unavailable."""

def updated(model: Model, belief: Union[Belief, numpy.typing.ArrayLike], action: Union[int, str], observation: Union[int, str]) -> BeliefUpdate:
    """The exact Bayesian update of a belief. Raises FailedPrecondition when the observation is
    impossible after the action, InvalidArgument, NotFound.
    """

def observationProbabilities(model: Model, belief: Union[Belief, numpy.typing.ArrayLike], action: Union[int, str]) -> numpy.typing.NDArray[numpy.float64]:
    """Pr(o | belief, action) for every observation, shape [num_observations]."""

class Variable:
    """A variable of a factored model."""
    def __init__(self, name: str, values: list[str]) -> None:
        """Its values are names."""
    @property
    def name(self) -> str:
        """what it is called"""
    @property
    def values(self) -> list[str]:
        """their names"""

class StateVariable(Variable):
    """A variable of the state."""
    def __init__(self, name: str, values: list[str], observed: bool = False) -> None:
        """Its values are names."""
    @property
    def observed(self) -> bool:
        """whether the robot sees it before each action, the first included"""

class VariableRole:
    """Members:"""
    kPrevious: ClassVar[VariableRole]
    kAction: ClassVar[VariableRole]
    kCurrent: ClassVar[VariableRole]
    kObservation: ClassVar[VariableRole]
    @property
    def name(self) -> str: ...
    @property
    def value(self) -> int: ...
    def __int__(self) -> int: ...
    __members__: ClassVar[dict[str, VariableRole]]

class VariableRef:
    """A variable in a factor."""
    def __init__(self, role: VariableRole, index: int) -> None:
        """The index counts among the variables of its role."""
    @property
    def role(self) -> VariableRole:
        """what it is in the factor"""
    @property
    def index(self) -> int:
        """among those of its role"""

class Factor:
    """A function of some variables."""
    def __init__(self, parents: list[VariableRef], of: list[VariableRef], values: numpy.typing.ArrayLike) -> None:
        """The probabilities of the values of `of` given those of `parents`; a reward has no `of`.
        Values: one axis for each variable, parents first, or that flattened row by row.
        """
    @property
    def parents(self) -> list[VariableRef]:
        """what it is given"""
    @property
    def of(self) -> list[VariableRef]:
        """what it gives the probabilities of; none for a reward"""
    @property
    def values(self) -> numpy.typing.NDArray[numpy.float64]:
        """Flat; the last variable changes fastest."""

class FactoredModel:
    """A POMDP in factors, a dynamic Bayesian network: products of the probabilities of its
    variables, sums of rewards. flattened() makes a Model of it.
    """
    def __init__(self, state: list[StateVariable], actions: list[Variable], observations: list[Variable], discount: float) -> None:
        """Its variables; factors are added afterwards."""
    @property
    def state(self) -> list[StateVariable]:
        """the variables of the state"""
    @property
    def actions(self) -> list[Variable]:
        """one of each is chosen at a time"""
    @property
    def observations(self) -> list[Variable]:
        """one of each is made at a time"""
    @property
    def discount(self) -> float:
        """in (0, 1]"""
    def ref(self, role: VariableRole, name: str) -> VariableRef:
        """A variable by its name. Raises NotFound."""
    def valuesOf(self, factor: Factor) -> numpy.typing.NDArray[numpy.float64]:
        """The values of a factor, an axis for each variable, parents first."""
    def flattened(self, sum_tolerance: float = ...) -> Model:
        """The flat model: a state is a value of each state variable, named by them joined with
        commas; an observation names the seen state variables too. Raises InvalidArgument naming
        the factor that is wrong, ResourceExhausted above 2^24 states.
        """
    @property
    def initial(self) -> list[Factor]:
        """Factors of kPrevious given kPrevious."""
    def addInitial(self, factor: Factor) -> None:
        """Adds one; flattened() checks it."""
    @property
    def transitions(self) -> list[Factor]:
        """Factors of kCurrent given kPrevious, kAction, kCurrent."""
    def addTransition(self, factor: Factor) -> None:
        """Adds one; flattened() checks it."""
    @property
    def observing(self) -> list[Factor]:
        """Factors of kObservation given kAction, kCurrent, kObservation."""
    def addObserving(self, factor: Factor) -> None:
        """Adds one; flattened() checks it."""
    @property
    def rewards(self) -> list[Factor]:
        """Factors that give a reward; it is their sum."""
    def addReward(self, factor: Factor) -> None:
        """Adds one; flattened() checks it."""

def loadPomdpx(path: str) -> FactoredModel:
    """Reads a .pomdpx file in its factors; loadModel gives the flat model. Raises Unavailable,
    or InvalidArgument with 'file:line:column: message'.
    """

class AlphaVector:
    """The value of one conditional plan in some states, and its first action."""
    def __init__(self, action: int, values: numpy.typing.ArrayLike, states: Optional[numpy.typing.ArrayLike] = None) -> None:
        """One value for each of `states` (ascending indices); without them, for all states."""
    @property
    def action(self) -> int:
        """the index of the plan's first action"""
    @property
    def values(self) -> numpy.typing.NDArray[numpy.float64]:
        """Shape [len(states)], or [num_states] when `states` is empty."""
    @property
    def states(self) -> numpy.typing.NDArray[numpy.uint32]:
        """Ascending; empty: all states of the model."""

class Choice:
    """What a policy does at a belief."""
    @property
    def action(self) -> int:
        """its index"""
    @property
    def value(self) -> float:
        """a lower bound of what is earned from there"""

class Policy:
    """At a belief, the action of the alpha vector that is greatest there, among those whose
    states hold all of the belief. An immutable value; pickled exactly.
    """
    def __init__(self, num_states: int, alpha_vectors: list[AlphaVector]) -> None:
        """From vectors, of which one at least is over all states. Raises InvalidArgument."""
    def numStates(self) -> int:
        """Of the model it is for."""
    def numAlphaVectors(self) -> int:
        """How many vectors."""
    def maxAction(self) -> int:
        """The greatest action index of any vector."""
    def sizeInBytes(self) -> int:
        """Memory held, roughly."""
    def alphaVectors(self) -> list[AlphaVector]:
        """All vectors, those with the same states together."""
    def actionAt(self, belief: Union[Belief, numpy.typing.ArrayLike]) -> int:
        """The index of the action. Raises InvalidArgument."""
    def valueAt(self, belief: Union[Belief, numpy.typing.ArrayLike]) -> float:
        """A lower bound of what the policy earns from the belief on."""
    def bestAt(self, belief: Union[Belief, numpy.typing.ArrayLike]) -> Choice:
        """Action and value at once."""
    def bestAtEach(self, beliefs: numpy.typing.ArrayLike) -> tuple[numpy.typing.NDArray[numpy.int64], numpy.typing.NDArray[numpy.float64]]:
        """Actions and values, shape [n] each, at beliefs of shape [n, num_states]."""
    def write(self, path: str) -> None:
        """Writes a file that Policy.read reads back exactly. Raises Unavailable."""
    @staticmethod
    def read(path: str) -> Policy:
        """Raises Unavailable, or InvalidArgument with 'file:line: message'."""

class SolverLimits:
    """When to stop solving, whichever comes first. With counted work alone a run repeats
    exactly.
    """
    def __init__(self, *, precision: float = 0.001, time_s: float = 0.0, max_backups: int = 0, max_memory_bytes: int = 0, num_threads: int = 1) -> None:
        """See the attributes."""
    @property
    def precision(self) -> float:
        """gap between the bounds at the initial belief, at least 0"""
    @precision.setter
    def precision(self, value: float) -> None: ...
    @property
    def time_s(self) -> float:
        """wall time; 0: no limit"""
    @time_s.setter
    def time_s(self, value: float) -> None: ...
    @property
    def max_backups(self) -> int:
        """point-based backups; 0: no limit"""
    @max_backups.setter
    def max_backups(self, value: int) -> None: ...
    @property
    def max_memory_bytes(self) -> int:
        """held by the search, without the model; 0: no limit"""
    @max_memory_bytes.setter
    def max_memory_bytes(self, value: int) -> None: ...
    @property
    def num_threads(self) -> int:
        """at least 1"""
    @num_threads.setter
    def num_threads(self, value: int) -> None: ...

class SolverProgress:
    """How far solving is."""
    @property
    def lower(self) -> float:
        """at the initial belief; never falls"""
    @property
    def upper(self) -> float:
        """at the initial belief; never rises"""
    @property
    def backups(self) -> int:
        """so far"""
    @property
    def num_alpha_vectors(self) -> int:
        """of the policy so far"""
    @property
    def elapsed_s(self) -> float:
        """wall time"""
    @property
    def memory_bytes(self) -> int:
        """held by the search"""

class StopReason:
    """Members:"""
    kPrecision: ClassVar[StopReason]
    kTimeLimit: ClassVar[StopReason]
    kBackupLimit: ClassVar[StopReason]
    kCancelled: ClassVar[StopReason]
    kMemoryLimit: ClassVar[StopReason]
    @property
    def name(self) -> str: ...
    @property
    def value(self) -> int: ...
    def __int__(self) -> int: ...
    __members__: ClassVar[dict[str, StopReason]]

class SolveResult:
    """A policy with its bounds."""
    @property
    def policy(self) -> Policy:
        """the best one found"""
    @property
    def lower(self) -> float:
        """what the policy earns at least"""
    @property
    def upper(self) -> float:
        """no policy earns more"""
    @property
    def backups(self) -> int:
        """counted work"""
    @property
    def reason(self) -> StopReason:
        """why it stopped"""
    @property
    def elapsed_s(self) -> float:
        """wall time"""
    @property
    def cpu_s(self) -> float:
        """CPU time, of all its threads"""
    @property
    def memory_bytes(self) -> int:
        """held by the search at its end"""

def solve(model: Model, limits: SolverLimits = ..., keep_going: Optional[Callable[[SolverProgress], Any]] = None, period_s: float = 0.05) -> SolveResult:
    """Solves a model from its initial belief with lower and upper bounds, anytime.
    `keep_going` is called at most every `period_s` seconds of wall time; when it returns
    False, the result is the best policy so far. Other Python threads run on meanwhile;
    Ctrl-C ends it with KeyboardInterrupt. Raises InvalidArgument: a limit out of range, or
    none that can end the run.
    """

class Random:
    """Random numbers; one seed gives the same ones everywhere."""
    def __init__(self, seed: int) -> None:
        """A generator of its own."""
    def uniform(self) -> float:
        """The next number in [0, 1)."""

class SampledStep:
    """One sampled step of the world."""
    @property
    def next_state(self) -> int:
        """its index"""
    @property
    def observation(self) -> int:
        """its index"""

def sampleStep(model: Model, state: Union[int, str], action: Union[int, str], random: Random) -> SampledStep:
    """Samples the next state and the observation; the reward is in rewardArray(). Raises
    InvalidArgument, NotFound.
    """

def sampleState(belief: Union[Belief, numpy.typing.ArrayLike], random: Random) -> int:
    """Samples the index of a state."""

class EvaluationLimits:
    """How much to simulate."""
    def __init__(self, *, trials: int = 1000, truncation: float = 0.001, max_steps: int = 10000, num_threads: int = 1) -> None:
        """See the attributes."""
    @property
    def trials(self) -> int:
        """how many"""
    @trials.setter
    def trials(self, value: int) -> None: ...
    @property
    def truncation(self) -> float:
        """a trial ends when its discount is below this"""
    @truncation.setter
    def truncation(self, value: float) -> None: ...
    @property
    def max_steps(self) -> int:
        """of a trial"""
    @max_steps.setter
    def max_steps(self, value: int) -> None: ...
    @property
    def num_threads(self) -> int:
        """at least 1; the result is the same for any number"""
    @num_threads.setter
    def num_threads(self, value: int) -> None: ...

class Evaluation:
    """The discounted return of a policy, simulated."""
    @property
    def mean(self) -> float:
        """over the trials"""
    @property
    def standard_error(self) -> float:
        """of the mean"""
    @property
    def half_width_95(self) -> float:
        """the mean is within this of the true value with 95 % confidence"""
    @property
    def trials(self) -> int:
        """how many"""
    @property
    def mean_steps(self) -> float:
        """of a trial"""
    @property
    def finished(self) -> float:
        """part of the trials that came to where all is over"""

def evaluate(model: Model, policy: Policy, limits: EvaluationLimits = ..., seed: int = 1) -> Evaluation:
    """Simulates a policy from the initial belief. Raises InvalidArgument: a policy that does
    not fit the model, no trials.
    """

class ExactSolution:
    """The optimal value function, as the maximum of alpha vectors over all states."""
    @property
    def stages(self) -> list[Policy]:
        """with a horizon, element k is for k + 1 steps to go; else one for all steps"""
    @property
    def error(self) -> float:
        """the value at any belief is at most the optimum, and at most this much below"""
    @property
    def iterations(self) -> int:
        """of value iteration"""
    def valueAt(self, belief: Union[Belief, numpy.typing.ArrayLike]) -> float:
        """With all steps to go. Raises InvalidArgument."""

def solveExactly(model: Model, *, horizon: int = 0, precision: float = ..., max_vectors: int = 20000, time_s: float = 0.0) -> ExactSolution:
    """Solves a small model exactly at every belief (incremental pruning): over `horizon`
    steps, with discount 1 too, or for ever (0) to within `precision`. Its work grows
    exponentially; `max_vectors` and `time_s` (wall time, 0 for none) bound it. Raises
    InvalidArgument, ResourceExhausted, DeadlineExceeded.
    """

class OnlineOptions:
    """How OnlinePlanner searches."""
    def __init__(self, *, num_scenarios: int = 500, max_depth: int = 90, regularisation: float = 0.01, target: float = 0.95, time_s: float = 0.1, max_expansions: int = 0) -> None:
        """See the attributes."""
    @property
    def num_scenarios(self) -> int:
        """samples of the belief"""
    @num_scenarios.setter
    def num_scenarios(self, value: int) -> None: ...
    @property
    def max_depth(self) -> int:
        """steps ahead"""
    @max_depth.setter
    def max_depth(self, value: int) -> None: ...
    @property
    def regularisation(self) -> float:
        """price of one more node in a plan's tree, at least 0: plans made for few samples must
        gain as much
        """
    @regularisation.setter
    def regularisation(self, value: float) -> None: ...
    @property
    def target(self) -> float:
        """of the gap at the root that a trial leaves, in (0, 1)"""
    @target.setter
    def target(self, value: float) -> None: ...
    @property
    def time_s(self) -> float:
        """wall time of a decision; 0: no limit"""
    @time_s.setter
    def time_s(self, value: float) -> None: ...
    @property
    def max_expansions(self) -> int:
        """counted work, repeats exactly; 0: no limit"""
    @max_expansions.setter
    def max_expansions(self, value: int) -> None: ...

class OnlineDecision:
    """What to do, and how sure that is."""
    @property
    def action(self) -> int:
        """its index"""
    @property
    def lower(self) -> float:
        """of the value over the scenarios, regularised"""
    @property
    def upper(self) -> float:
        """of the value over the scenarios"""
    @property
    def expansions(self) -> int:
        """counted work"""
    @property
    def num_nodes(self) -> int:
        """of the tree"""

class ParticleOptions:
    """Of a belief as samples."""
    def __init__(self, *, num_particles: int = 1000, tries: int = 100) -> None:
        """See the attributes."""
    @property
    def num_particles(self) -> int:
        """how many are kept"""
    @num_particles.setter
    def num_particles(self, value: int) -> None: ...
    @property
    def tries(self) -> int:
        """without observationProbability: samples for an update, per particle"""
    @tries.setter
    def tries(self, value: int) -> None: ...

class OnlinePlanner:
    """Plans one action at a time by sampling (DESPOT) on a Model. Without a policy its first
    lower bound is to act as if the state were known.
    """
    def __init__(self, model: Model, options: OnlineOptions = ..., policy: Optional[Policy] = None) -> None:
        """Raises InvalidArgument: an option out of range, a policy that does not fit."""
    def plan(self, belief: Union[Belief, numpy.typing.ArrayLike], seed: int = 1) -> OnlineDecision:
        """The action at a belief; counted work and one seed repeat exactly."""

class BeliefPlannerOptions:
    """How BeliefPlanner searches."""
    def __init__(self, *, precision: float = 0.001, time_s: float = 0.1, max_expansions: int = 0) -> None:
        """See the attributes."""
    @property
    def precision(self) -> float:
        """gap at the belief below which it stops, at least 0"""
    @precision.setter
    def precision(self, value: float) -> None: ...
    @property
    def time_s(self) -> float:
        """wall time of a decision; 0: no limit"""
    @time_s.setter
    def time_s(self, value: float) -> None: ...
    @property
    def max_expansions(self) -> int:
        """counted work, repeats exactly; 0: no limit"""
    @max_expansions.setter
    def max_expansions(self, value: int) -> None: ...

class BeliefDecision:
    """What to do, and how sure that is."""
    @property
    def action(self) -> int:
        """its index"""
    @property
    def lower(self) -> float:
        """planning on like this earns at least this"""
    @property
    def upper(self) -> float:
        """nobody earns more"""
    @property
    def expansions(self) -> int:
        """counted work"""

class BeliefPlanner:
    """Plans one action at a time on a Model by searching the tree of exact beliefs, with an
    offline policy as its lower bound, than which it never does worse. It keeps the robot's
    belief.
    """
    def __init__(self, model: Model, policy: Policy, options: BeliefPlannerOptions = ...) -> None:
        """At the model's initial belief, or at the first of its initial outcomes. Raises
        InvalidArgument.
        """
    @property
    def belief(self) -> Belief:
        """Where the robot is."""
    def restart(self, belief: Union[Belief, numpy.typing.ArrayLike]) -> None:
        """Begins anew at a belief that can follow from the model's initial one. Raises
        InvalidArgument.
        """
    def plan(self) -> BeliefDecision:
        """The action here."""
    def advance(self, action: int, observation: int) -> float:
        """Goes on to the next belief and gives the probability that the observation had. Raises
        FailedPrecondition when it was impossible, InvalidArgument.
        """

class GenerativePlanner:
    """Plans one action at a time by sampling (DESPOT) on a model written in Python, and keeps
    the robot's belief as samples. The model is any object with the methods numActions(),
    discount(), step(state, action, random) -> (next_state, observation, reward, terminal),
    where the same random number in [0, 1) gives the same step, and upperBound(state), no
    less than what can be earned from there. It may have defaultAction(states), the action
    of a simple policy (else 0), observationProbability(action, next_state, observation),
    which makes beliefs better, and perturbed(state, random), a state near by for when an
    observation contradicts all samples. States and observations are any objects that can be
    hashed.
    """
    def __init__(self, model: Any, states: Iterable, options: OnlineOptions = ..., particles: ParticleOptions = ..., seed: int = 1) -> None:
        """`states` are samples of the initial belief. Raises InvalidArgument: a method is missing,
        an option out of range, no states.
        """
    @property
    def states(self) -> list:
        """The samples of the belief."""
    def restart(self, states: Iterable) -> None:
        """Begins anew with these samples."""
    def plan(self) -> OnlineDecision:
        """The action here. What the model's methods raise goes through; Ctrl-C ends it."""
    def advance(self, action: int, observation: Any) -> None:
        """Goes on to the belief after an action and an observation. Raises FailedPrecondition when
        no sample agrees with the observation.
        """
