"""High-level reasoning of KR3: an action language, histories with defaults, entailment, diagnosis
and planning. Names are those of the C++ library; statements are texts in the language."""

# Made by kr3_common/python/make_stub.py.

import datetime
from typing import Callable, ClassVar, Optional, overload

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

class SourcePosition:
    """Where something stands in a file; line and column count from 1."""
    @property
    def file(self) -> str:
        """its name as it was given"""
    @property
    def line(self) -> int:
        """0: in no file"""
    @property
    def column(self) -> int:
        """in bytes"""

class Description:
    """A domain description that passed every check of the language. str() gives it in the
    language.
    """
    @property
    def sorts(self) -> dict:
        """The elements of each sort."""
    @property
    def fluents(self) -> list[str]:
        """Names of the fluents, statics included."""
    @property
    def actions(self) -> list[str]:
        """Names of the actions, exogenous ones included."""

def parseDescription(text: str, file: str) -> Description:
    """Parses and checks a description; `file` is its name in messages. Raises InvalidArgument
    with a line 'file:line:column: message' for each problem.
    """

@overload
def readDescription(path: str) -> Description:
    """Reads and parses a file. Raises NotFound or InvalidArgument."""
@overload
def readDescription(paths: list[str]) -> Description:
    """Reads one description from several files. Raises NotFound or InvalidArgument."""

def parseRefinement(text: str, file: str, base: Description) -> Description:
    """Parses a refinement of the description `base`. Raises InvalidArgument."""

def readRefinement(path: str, base: Description) -> Description:
    """Reads and parses a refinement of the description `base`. Raises NotFound or
    InvalidArgument.
    """

class RecordKind:
    """Members:"""
    kObserved: ClassVar[RecordKind]
    kHappened: ClassVar[RecordKind]
    kAttempted: ClassVar[RecordKind]
    kInitially: ClassVar[RecordKind]
    @property
    def name(self) -> str: ...
    @property
    def value(self) -> int: ...
    def __int__(self) -> int: ...
    __members__: ClassVar[dict[str, RecordKind]]

class Record:
    """One record of a history (Zhang et al. 2014)."""
    def __init__(self, kind: RecordKind, statement: str, value: bool = True, step: int = 0, confidence: float = 1.0, source: str = 'robot') -> None: ...
    @property
    def kind(self) -> RecordKind:
        """what the record says"""
    @kind.setter
    def kind(self, value: RecordKind) -> None: ...
    @property
    def statement(self) -> str:
        """ground literal or ground action"""
    @statement.setter
    def statement(self, value: str) -> None: ...
    @property
    def value(self) -> bool:
        """of kObserved and kInitially: true or false"""
    @value.setter
    def value(self, value: bool) -> None: ...
    @property
    def step(self) -> int:
        """0 or more; of kInitially 0"""
    @step.setter
    def step(self, value: int) -> None: ...
    @property
    def confidence(self) -> float:
        """probability that it is right, (0, 1]"""
    @confidence.setter
    def confidence(self, value: float) -> None: ...
    @property
    def source(self) -> str:
        """who says so"""
    @source.setter
    def source(self, value: str) -> None: ...
    @property
    def position(self) -> SourcePosition:
        """in a history file; line 0 if in none"""

def parseHistory(text: str, file: str, description: Description) -> list[Record]:
    """Parses a history: obs(l, bool, step). hpd(a, step). attempt(a, step). init(l, bool)."""

def readHistory(path: str, description: Description) -> list[Record]:
    """Reads and parses a history file. Raises NotFound or InvalidArgument."""

class SparcImport:
    """What a SPARC program says, in KR3's language."""
    @property
    def description(self) -> str:
        """of the domain"""
    @property
    def history(self) -> str:
        """what the program states about its steps"""
    @property
    def goals(self) -> list[str]:
        """one for each rule goal(I) :- ..."""

def importSparc(text: str, file: str) -> SparcImport:
    """Translates a SPARC program of the common subset; `file` is its name in messages. Raises
    InvalidArgument with the place of every statement that is not in the subset.
    """

def readSparc(path: str) -> SparcImport:
    """Reads and translates a SPARC program. Raises NotFound or InvalidArgument."""

class Answer:
    """Members:"""
    kFalse: ClassVar[Answer]
    kTrue: ClassVar[Answer]
    kUnknown: ClassVar[Answer]
    @property
    def name(self) -> str: ...
    @property
    def value(self) -> int: ...
    def __int__(self) -> int: ...
    __members__: ClassVar[dict[str, Answer]]

class AssumptionKind:
    """Members:"""
    kException: ClassVar[AssumptionKind]
    kExogenous: ClassVar[AssumptionKind]
    kFailure: ClassVar[AssumptionKind]
    kWrongRecord: ClassVar[AssumptionKind]
    @property
    def name(self) -> str: ...
    @property
    def value(self) -> int: ...
    def __int__(self) -> int: ...
    __members__: ClassVar[dict[str, AssumptionKind]]

class Assumption:
    """One element of a minimal explanation."""
    @property
    def kind(self) -> AssumptionKind:
        """what is assumed"""
    @property
    def statement(self) -> str:
        """'init(f(x) = v, false)', 'a(x) at 2'"""
    @property
    def sentence(self) -> str:
        """in words"""
    @property
    def price(self) -> int:
        """of a wrong record: 100 times its log-odds"""
    @property
    def defaults(self) -> list[str]:
        """ground defaults to which this is an exception"""
    @property
    def because(self) -> list[int]:
        """records (indices) that contradict the history without it"""
    @property
    def because_in_words(self) -> str:
        """empty when no proof was found within bounds"""

class ExplanationAlternative:
    """One minimal explanation of a history."""
    @property
    def assumptions(self) -> list[Assumption]:
        """its elements"""
    @property
    def price(self) -> int:
        """the sum over its elements"""
    @property
    def in_words(self) -> str:
        """for people"""

class ExplanationPart:
    """What explains a part of what is unexpected; any of its explanations goes with any of
    those of the other parts.
    """
    @property
    def price(self) -> int:
        """of each of them"""
    @property
    def explanations(self) -> list[list[str]]:
        """lists of statements"""
    @property
    def in_words(self) -> list[str]:
        """each for people"""
    @property
    def complete(self) -> bool:
        """whether there are no others"""

class Diagnosis:
    """Minimal explanations of the history."""
    @property
    def consistent(self) -> bool:
        """whether there is an explanation"""
    @property
    def cost(self) -> int:
        """minimal price"""
    @property
    def explanations(self) -> list[list[str]]:
        """lists of statements"""
    @property
    def in_words(self) -> list[str]:
        """each explanation for people"""
    @property
    def alternatives(self) -> list[ExplanationAlternative]:
        """the same, with prices and reasons"""
    @property
    def complete(self) -> bool:
        """whether explanations has all of them, not the first 200 of more"""
    @property
    def parts(self) -> list[ExplanationPart]:
        """of which the explanations are put together"""
    @property
    def conflict(self) -> list[str]:
        """when inconsistent: a minimal set of conflicting records"""
    @property
    def conflict_records(self) -> list[int]:
        """the same, as indices into the history"""
    @property
    def conflict_in_words(self) -> str:
        """with files and lines where records have them"""

class Retraction:
    """Doubtful records that would have to be given up together."""
    @property
    def records(self) -> list[int]:
        """indices into the history"""
    @property
    def log_odds(self) -> float:
        """sum over the records; the smaller, the more doubtful"""
    @property
    def opens(self) -> str:
        """the literal that becomes possible; empty: consistency"""
    @property
    def in_words(self) -> str:
        """for people"""

class HistoryModel:
    """One model of a history: a path of states with an explanation."""
    @property
    def assumed(self) -> list[str]:
        """as in Diagnosis.explanations"""
    @property
    def states(self) -> list[list[str]]:
        """at each step the value of every fluent, as a literal"""
    @property
    def actions(self) -> list[list[str]]:
        """what occurs at each step but the last"""
    @property
    def first_step(self) -> int:
        """of states and actions"""

class Progress:
    """What became of a wish to progress a history."""
    @property
    def first_step(self) -> int:
        """where the history begins now"""
    @property
    def num_records(self) -> int:
        """that are left"""
    @property
    def kept_because(self) -> list[str]:
        """what could not be represented, in words"""

class ReasonKind:
    """Members:"""
    kObserved: ClassVar[ReasonKind]
    kHappened: ClassVar[ReasonKind]
    kCaused: ClassVar[ReasonKind]
    kInertia: ClassVar[ReasonKind]
    kConstraint: ClassVar[ReasonKind]
    kDefinition: ClassVar[ReasonKind]
    kExecutability: ClassVar[ReasonKind]
    kOnlyValue: ClassVar[ReasonKind]
    kStatic: ClassVar[ReasonKind]
    kDefault: ClassVar[ReasonKind]
    kException: ClassVar[ReasonKind]
    kAssumed: ClassVar[ReasonKind]
    kChange: ClassVar[ReasonKind]
    kContradiction: ClassVar[ReasonKind]
    kSupposed: ClassVar[ReasonKind]
    kCases: ClassVar[ReasonKind]
    kTogether: ClassVar[ReasonKind]
    kAgain: ClassVar[ReasonKind]
    kCarried: ClassVar[ReasonKind]
    @property
    def name(self) -> str: ...
    @property
    def value(self) -> int: ...
    def __int__(self) -> int: ...
    __members__: ClassVar[dict[str, ReasonKind]]

class Reason:
    """A node of a proof. Its children are what it rests on."""
    @property
    def kind(self) -> ReasonKind:
        """how it is known"""
    @property
    def statement(self) -> str:
        """what is known: a ground literal or action; empty for a contradiction"""
    @property
    def step(self) -> int:
        """when it holds or happens"""
    @property
    def record(self) -> Optional[int]:
        """index into the history, or None"""
    @property
    def default_name(self) -> str:
        """ground, as 'd(x)'"""
    @property
    def position(self) -> SourcePosition:
        """of the law, the default or the record"""
    @property
    def sentence(self) -> str:
        """this node in words, without its children"""
    @property
    def children(self) -> list[Reason]:
        """what this node rests on"""

class LawKind:
    """Members:"""
    kCausal: ClassVar[LawKind]
    kConstraint: ClassVar[LawKind]
    kDefinition: ClassVar[LawKind]
    kExecutability: ClassVar[LawKind]
    @property
    def name(self) -> str: ...
    @property
    def value(self) -> int: ...
    def __int__(self) -> int: ...
    __members__: ClassVar[dict[str, LawKind]]

class CitedLaw:
    """A law of the description that an explanation rests on."""
    @property
    def kind(self) -> LawKind:
        """which law it is"""
    @property
    def about(self) -> str:
        """the action, or the fluent of the head; empty for 'false if ...'"""
    @property
    def positions(self) -> list[SourcePosition]:
        """of its rules: several for a definition"""

class Explanation:
    """Why a literal is entailed."""
    @property
    def entailed(self) -> bool:
        """whether the literal is entailed at all"""
    @property
    def reasons(self) -> list[str]:
        """in words, from the literal downwards"""
    @property
    def records(self) -> list[str]:
        """the records it rests on"""
    @property
    def record_indices(self) -> list[int]:
        """the same, as indices into the history"""
    @property
    def defaults(self) -> list[str]:
        """ground defaults it rests on, as 'd(x)'"""
    @property
    def laws(self) -> list[CitedLaw]:
        """it rests on"""
    @property
    def proof(self) -> Reason:
        """meaningful when entailed"""

class OpenQuestion:
    """What is open about a literal, and what would settle it."""
    @property
    def open(self) -> bool:
        """whether it is possible and not entailed"""
    @property
    def values(self) -> list[str]:
        """that its fluent may have at the step"""
    @property
    def deciding(self) -> list[str]:
        """fluents whose value at the current step would settle it"""
    @property
    def reasons(self) -> list[str]:
        """in words, one sentence each"""

class PlanPreference:
    """Members:"""
    kShortest: ClassVar[PlanPreference]
    kCheapestShortest: ClassVar[PlanPreference]
    kCheapest: ClassVar[PlanPreference]
    @property
    def name(self) -> str: ...
    @property
    def value(self) -> int: ...
    def __int__(self) -> int: ...
    __members__: ClassVar[dict[str, PlanPreference]]

class PlanOptions:
    """Which plans are wanted, and within which limits."""
    def __init__(self, *, max_horizon: int = 12, time_limit: datetime.timedelta = ..., on_horizon: Optional[Callable[[int], None]] = None, preference: PlanPreference = ..., all: bool = False, max_plans: int = 100, relevant_only: bool = True) -> None: ...
    @property
    def max_horizon(self) -> int:
        """steps of the longest plan to try"""
    @max_horizon.setter
    def max_horizon(self, value: int) -> None: ...
    @property
    def time_limit(self) -> datetime.timedelta:
        """wall time, a timedelta or seconds"""
    @time_limit.setter
    def time_limit(self, value: datetime.timedelta) -> None: ...
    @property
    def on_horizon(self) -> Callable[[int], None]:
        """called with each horizon, if set"""
    @on_horizon.setter
    def on_horizon(self, value: Callable[[int], None]) -> None: ...
    @property
    def preference(self) -> PlanPreference:
        """which plans are wanted"""
    @preference.setter
    def preference(self, value: PlanPreference) -> None: ...
    @property
    def all(self) -> bool:
        """all plans that are equally good"""
    @all.setter
    def all(self, value: bool) -> None: ...
    @property
    def max_plans(self) -> int:
        """with `all`: at most so many for a hypothesis"""
    @max_plans.setter
    def max_plans(self, value: int) -> None: ...
    @property
    def relevant_only(self) -> bool:
        """plan on what can matter to the goal; the answer is the same"""
    @relevant_only.setter
    def relevant_only(self, value: bool) -> None: ...
    @property
    def extra_share(self) -> float:
        """this share of the constants that do not matter is kept, in [0, 1]"""
    @extra_share.setter
    def extra_share(self, value: float) -> None: ...

class ProblemSize:
    """The size of a description with its history."""
    @property
    def fluents(self) -> int:
        """ground, statics left out"""
    @property
    def constants(self) -> int:
        """elements of sorts"""
    @property
    def actions(self) -> int:
        """ground, exogenous ones left out"""
    @property
    def records(self) -> int:
        """of the history"""

class Plan:
    """A plan under a hypothesis."""
    @property
    def hypothesis(self) -> list[str]:
        """literals; empty when nothing is assumed"""
    @property
    def steps(self) -> list[list[str]]:
        """ground actions that occur together, a list a step"""
    @property
    def cost(self) -> float:
        """of its actions, the largest under the hypothesis"""

class PlanResult:
    """Plans, or why there is none."""
    @property
    def goal_entailed(self) -> bool:
        """nothing to do"""
    @property
    def plans(self) -> list[Plan]:
        """one a hypothesis, more with `all`"""
    @property
    def complete(self) -> bool:
        """False when max_plans or the time limit left plans out"""
    @property
    def covers_all(self) -> bool:
        """False when some possible state has no plan within the horizon"""
    @property
    def reason(self) -> str:
        """when there is no plan: why"""
    @property
    def cpu_s(self) -> float:
        """CPU time that planning took, in seconds"""
    @property
    def considered(self) -> ProblemSize:
        """what was planned with"""
    @property
    def whole(self) -> ProblemSize:
        """of how much"""
    @property
    def widened(self) -> int:
        """how often the relevant part was too small and was computed anew"""

class RelevantItem:
    """A constant, fluent or action that can matter to a goal, and why."""
    @property
    def name(self) -> str:
        """as in the language"""
    @property
    def why(self) -> list[str]:
        """from the goal to the item, a sentence a step"""

class RelevantPart:
    """What can matter to a goal."""
    @property
    def constants(self) -> list[RelevantItem]:
        """elements of sorts"""
    @property
    def fluents(self) -> list[RelevantItem]:
        """ground; a plan depends on no others"""
    @property
    def actions(self) -> list[RelevantItem]:
        """ground; an argument that may be anything relevant is _"""
    @property
    def records(self) -> list[Record]:
        """about relevant fluents and actions"""
    @property
    def considered(self) -> ProblemSize:
        """the size of this part"""
    @property
    def whole(self) -> ProblemSize:
        """of how much"""

class ReasonerOptions:
    """What a diagnosis may assume, and at what price."""
    def __init__(self, *, diagnose_exogenous: bool = False, exception_weight: int = 1, exogenous_weight: int = 1, default_weights: dict[str, int] = {}, least_step: int = 0, window: int = 0, max_combinations: int = 1000) -> None: ...
    @property
    def diagnose_exogenous(self) -> bool:
        """whether exogenous actions compete with exceptions from the start; otherwise they are
        assumed only if no exception explains the history
        """
    @diagnose_exogenous.setter
    def diagnose_exogenous(self, value: bool) -> None: ...
    @property
    def exception_weight(self) -> int:
        """price of one exception to a default, at least 1"""
    @exception_weight.setter
    def exception_weight(self, value: int) -> None: ...
    @property
    def exogenous_weight(self) -> int:
        """price of one exogenous action, and of one failed attempt, at least 1"""
    @exogenous_weight.setter
    def exogenous_weight(self, value: int) -> None: ...
    @property
    def default_weights(self) -> dict[str, int]:
        """price of an exception to the named default, where it differs"""
    @default_weights.setter
    def default_weights(self, value: dict[str, int]) -> None: ...
    @property
    def least_step(self) -> int:
        """the current step is at least this, even if no record is about it"""
    @least_step.setter
    def least_step(self, value: int) -> None: ...
    @property
    def window(self) -> int:
        """about how many steps the history keeps; 0: all of them"""
    @window.setter
    def window(self, value: int) -> None: ...
    @property
    def max_combinations(self) -> int:
        """of values that are kept when the history is progressed"""
    @max_combinations.setter
    def max_combinations(self, value: int) -> None: ...

class Cancellation:
    """Ends a call of plan from another thread: it raises Cancelled."""
    def __init__(self) -> None: ...
    def cancel(self) -> None:
        """May be called from any thread."""
    def cancelled(self) -> bool:
        """Whether cancel was called."""

class Reasoner:
    """The high-level reasoner: a description, a growing history, and questions about them,
    answered by clingo. Threads may share one; their questions wait for each other, the
    interpreter runs on meanwhile, and Ctrl-C ends a question.
    """
    def __init__(self, description: Description, options: ReasonerOptions = ...) -> None: ...
    @property
    def description(self) -> Description:
        """The description that it reasons about."""
    def history(self) -> list[Record]:
        """The records."""
    def currentStep(self) -> int:
        """The largest step among the records, or one more when an action is recorded there."""
    def setHistory(self, records: list[Record]) -> None:
        """Replaces the history; all records are taken or none. Raises InvalidArgument."""
    def addRecords(self, records: list[Record]) -> None:
        """Extends the history; all records are taken or none. Raises InvalidArgument."""
    def firstStep(self) -> int:
        """The step at which the history begins: 0 until it is progressed."""
    def progress(self, step: int) -> Progress:
        """Lets the history begin at a later step. What earlier records say about it is kept; all
        answers about later steps stay the same. Raises InvalidArgument, FailedPrecondition.
        """
    def setLimits(self, time_limit: datetime.timedelta) -> None:
        """Wall time of each question that follows, 0 for none; one that takes longer raises
        DeadlineExceeded.
        """
    def entails(self, literal: str, step: int) -> Answer:
        """Is the literal true in all models with a minimal explanation? Raises FailedPrecondition
        when the history is inconsistent.
        """
    def possible(self, literal: str, step: int) -> bool:
        """Is the literal true in some such model?"""
    def models(self, limit: int = 1000) -> list[HistoryModel]:
        """The models of the history, each once; limit 0 for all."""
    def entailedAt(self, step: int) -> list[str]:
        """All literals f = v (and f != v where no value of f is entailed) that are entailed at a
        step.
        """
    def possibleValues(self, fluent: str, step: int) -> list[str]:
        """The values that a ground fluent takes at a step in some model, in the order of its sort.
        """
    def diagnose(self) -> Diagnosis:
        """The minimal explanations of the history, or a minimal set of conflicting records."""
    def explain(self, literal: str, step: int) -> Explanation:
        """Why is the literal entailed? A proof, minimal and sufficient."""
    def whyUnknown(self, literal: str, step: int) -> OpenQuestion:
        """Why is the literal not known, and would observing its fluent now settle it?"""
    def supposing(self, hypothetical: list[Record]) -> Reasoner:
        """What if these records were in the history as well? A reasoner that answers; this one
        does not change. Raises InvalidArgument.
        """
    def retractions(self) -> list[Retraction]:
        """Which doubtful records (confidence below 1) would have to be given up so that the
        history is consistent; most doubtful first, at most eight sets.
        """
    def retractionsFor(self, literal: str, step: int) -> list[Retraction]:
        """The same, so that a literal is possible at a step."""
    def leastCertainRefutation(self, fluent: str) -> Retraction:
        """The least certain refutation of a value of a ground fluent at the current step."""
    def plan(self, goal: str, options: PlanOptions = ..., cancel: Optional[Cancellation] = None) -> PlanResult:
        """Plans from the current step, one for each hypothesis. Ctrl-C and `cancel` end it. Raises
        InvalidArgument, DeadlineExceeded or Cancelled.
        """
    def relevant(self, goal: str) -> RelevantPart:
        """What can matter to a goal, and why."""
    @overload
    def translation(self) -> str:
        """The answer set program of the history, for plain clingo."""
    @overload
    def translation(self, goal: str, length: int) -> str:
        """The same with a goal: the trajectories on which a plan of this length reaches it."""
