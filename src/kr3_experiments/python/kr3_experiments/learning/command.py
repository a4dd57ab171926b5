"""`./kr3 learn`: the training phase. The robot acts and looks, the simulator or a person says what was true, and the
counts become the domain's models file."""
import argparse
from pathlib import Path
from typing import Callable, Optional

from kr3_experiments.bringup import (
    LOCKSTEP_FACTOR,
    World,
    add_domain_argument,
    choose_port,
    existing_run_dir,
    new_run_dir,
    package_config,
    stack_variables,
    start_followers,
)
from kr3_experiments.domain import Domain, find_folder, load_domain, repository_root
from kr3_experiments.errors import Kr3Error
from kr3_experiments.experiment.sweep import commit
from kr3_experiments.learning.counts import AttemptLog, count, joined, read_attempts
from kr3_experiments.learning.models_file import agreement
from kr3_experiments.learning.session import Lesson, conclude, load_lesson
from kr3_experiments.learning.trials import Curriculum, NothingTried, train
from kr3_experiments.learning.truth import components
from kr3_experiments.own_process import in_own_process
from kr3_experiments.stack import Stack
from kr3_experiments.stack_file import load_stack
from kr3_experiments.terminal import Terminal

_WANTED = 200
_WANTED_QUICK = 15
_LEARNED = "models_learned.yaml"  # in the folder of what it was learned from
_ATTEMPTS_A_WORLD = 40  # about as many as there are before most things in it were handled
_WORLDS_IN_VAIN = 5
_NOT_NEEDED = ("executive_node", "reasoner_node", "policy_node")


def add_options(parser: argparse.ArgumentParser) -> None:
    """Options of the command."""
    add_domain_argument(parser)
    parser.add_argument(
        "--seed",
        type=int,
        default=1,
        help="of the world, its noise and the choice of trials (default: 1)",
    )
    parser.add_argument(
        "--trials",
        type=int,
        metavar="N",
        help=f"of each kind (default: {_WANTED}; --quick: {_WANTED_QUICK})",
    )
    parser.add_argument("--quick", action="store_true", help="few trials: wide intervals")
    parser.add_argument(
        "--classes",
        action="store_true",
        help="numbers of their own for classes of arguments tried often enough",
    )
    parser.add_argument(
        "--output",
        type=Path,
        metavar="FILE",
        help="models file (default: models_learned.yaml in the run's folder, or beside the bag, labels or attempts that"
        " it is learned from)",
    )
    parser.add_argument(
        "--run-dir",
        type=Path,
        metavar="DIR",
        help="an earlier run's folder: its attempts count, and it goes on",
    )
    parser.add_argument(
        "--bag", type=Path, metavar="FILE", help="learn from a recorded bag in place of driving"
    )
    parser.add_argument(
        "--attempts",
        type=Path,
        nargs="+",
        metavar="FILE",
        help="learn from files of attempts in place of driving",
    )
    parser.add_argument(
        "--export-looks",
        type=Path,
        metavar="DIR",
        help="with --bag: write the pictures of its looks for a person to label",
    )
    parser.add_argument(
        "--labels",
        type=Path,
        metavar="DIR",
        help="learn from such pictures and a person's labels of them",
    )
    parser.add_argument(
        "--real-time-factor",
        type=float,
        metavar="X",
        help="simulated s per s of wall time, waiting for nobody (default: lockstep, 8 at most);"
        " what the machine cannot keep up with is learned as the robot's fault",
    )
    parser.add_argument(
        "--world",
        choices=("robot", "abstract"),
        default="robot",
        help="where to try: on the robot of the simulator, or in the abstract world, in no time (default: robot)",
    )
    parser.add_argument(
        "--world-models",
        default="models.yaml",
        metavar="FILE",
        help="with --world abstract: its true numbers, file of the domain (default: models.yaml)",
    )
    parser.add_argument("--port", type=int, help="port of the ROS master (default: a free one)")


def run(args: argparse.Namespace) -> int:
    """@return 0 when the models file was written"""
    terminal = Terminal()
    lesson = load_lesson(find_folder(args.domain, repository_root()))
    wanted = args.trials or (_WANTED_QUICK if args.quick else _WANTED)
    if wanted <= 0 or not 0 <= args.seed < 2**31:
        raise Kr3Error(
            f"--trials {wanted} --seed {args.seed}: expected trials > 0 and a seed from 0 to {2**31 - 1}"
        )
    sources = [name for name in ("bag", "labels", "attempts") if getattr(args, name) is not None]
    if sources and args.world != "robot":
        raise Kr3Error(f"--{sources[0]} and --world {args.world}: expected one of them")
    if len(sources) > 1:
        raise Kr3Error(f"--{sources[0]} and --{sources[1]}: expected one of them")
    if args.export_looks is not None and args.bag is None:
        raise Kr3Error("--export-looks needs --bag: the pictures of looks come from a bag")
    if args.bag is not None:
        return _from_bag(args, lesson, terminal)
    if args.labels is not None:
        from kr3_experiments.learning.labels import attempts_from_labels

        attempts = attempts_from_labels(args.labels, lesson)
        return _write(
            args,
            lesson,
            attempts,
            args.labels,
            f"From a person's labels, {len(attempts)} looks.",
            terminal,
        )
    if args.attempts is not None:
        return _from_attempts(args, lesson, terminal)
    if args.world == "abstract":
        return _in_abstract_world(args, lesson, wanted, terminal)
    return _drive(args, lesson, wanted, terminal)


def _in_abstract_world(
    args: argparse.Namespace, lesson: Lesson, wanted: int, terminal: Terminal
) -> int:
    from kr3_experiments.learning.abstract import attempts_in_abstract_world

    run_dir = new_run_dir("learn") if args.run_dir is None else existing_run_dir(args.run_dir)
    file = run_dir / "attempts.jsonl"
    if file.exists():
        raise Kr3Error(f"{file} is there already, and would be lost: take another --run-dir")
    attempts = attempts_in_abstract_world(lesson.folder, wanted, args.seed, file, args.world_models)
    how = f"{len(attempts)} trials in the abstract world of {args.world_models}, seed {args.seed}."
    return _write(args, lesson, attempts, run_dir, how, terminal)


def _drive(args: argparse.Namespace, lesson: Lesson, wanted: int, terminal: Terminal) -> int:
    domain = load_domain(args.domain, repository_root())
    domain.require_map()
    domain.require_model()
    lesson.truth()  # where it is wrong, it is said now
    run_dir = new_run_dir("learn") if args.run_dir is None else existing_run_dir(args.run_dir)
    log = _log_of(args, run_dir)
    terminal.heading(
        f"KR3 learn: domain {args.domain}, seed {args.seed}, {wanted} trials of each kind"
    )
    if log.attempts:
        terminal.detail(f"{len(log.attempts)} attempts are there already")
    log.close()
    interrupted: Optional[BaseException] = None
    try:
        _through_worlds(
            lambda: in_own_process(lambda: _in_one_world(args, domain, lesson, wanted, run_dir))
        )
    except (KeyboardInterrupt, Kr3Error) as error:
        interrupted = error
    log = _log_of(args, run_dir)
    log.close()
    if log.attempts:
        how = [
            f"{len(log.attempts)} trials in the simulator, domain {args.domain}, seed {args.seed}."
        ]
        output = args.output or run_dir / _LEARNED
        lines = conclude(lesson, lesson.laws({}), log.attempts, output, how, args.classes)
        _show(lines, output, terminal)
    if interrupted is not None:
        terminal.verdict(False, f"not finished; go on with --run-dir {run_dir} --seed {args.seed}")
        raise interrupted
    return 0


def _through_worlds(one_world: Callable[[], int]) -> None:
    """@param one_world  goes through one, and tells how many trials are left

    @throws Kr3Error  worlds that bring nothing
    """
    least = left = one_world()
    in_vain = 0
    while left > 0:
        left = one_world()
        in_vain = 0 if left < least else in_vain + 1
        least = min(least, left)
        if in_vain == _WORLDS_IN_VAIN:
            raise Kr3Error(f"{in_vain} worlds brought no trial that is wanted; {left} are left")


def _in_one_world(
    args: argparse.Namespace, domain: Domain, lesson: Lesson, wanted: int, run_dir: Path
) -> int:
    """Trials in a world that depends on how many there are already. @return those that are left for others"""
    from kr3_experiments.learning.robot import Distances, Robot

    terminal = Terminal()
    log = _log_of(args, run_dir)
    before = len(log.attempts)
    lockstep = args.real_time_factor is None
    world = World(
        domain, args.seed, domain.target.at, LOCKSTEP_FACTOR if lockstep else args.real_time_factor
    )
    # The same world again would repeat the same chances.
    logs = run_dir / f"from_{before}"
    variables = {
        **stack_variables(world, logs),
        "seed": (args.seed + 1000003 * before) % 2**31,
    }
    specs = load_stack(package_config("stack.yaml"), variables, lockstep, _NOT_NEEDED)
    with Stack(logs, terminal.detail) as stack:
        stack.start_master(choose_port(args.port))
        start_followers(stack, specs)
        stack.start_nodes(specs)
        robot = Robot(
            stack, lesson.truth(), lesson.bindings, Distances(lesson.entries, lesson.keys)
        )
        laws = lesson.laws(components(robot.cells))
        curriculum = Curriculum(laws, lesson.bindings, lesson.entries, wanted, args.seed + before)
        try:
            train(
                robot,
                curriculum,
                laws,
                lesson.entries,
                lesson.bindings,
                log,
                terminal.line,
                _ATTEMPTS_A_WORLD,
            )
        except NothingTried as error:
            if len(log.attempts) == before:
                raise
            terminal.detail(f"{error}; the training goes on in another world")
        finally:
            log.close()
        return curriculum.left()


def _log_of(args: argparse.Namespace, run_dir: Path) -> AttemptLog:
    return AttemptLog(run_dir / "attempts.jsonl", {"domain": args.domain, "seed": args.seed})


def _from_attempts(args: argparse.Namespace, lesson: Lesson, terminal: Terminal) -> int:
    """Of several training phases together, and whether each two of them agree."""
    parts = [read_attempts(path) for path in args.attempts]
    laws = lesson.laws({})
    labels = {name: laws.labels(name) for name in lesson.entries}
    for i, second in enumerate(parts):
        for j, first in enumerate(parts[:i]):
            lines, apart = agreement(count(first, labels), count(second, labels))
            terminal.heading(f"{args.attempts[j]} and {args.attempts[i]}: mean [95 % interval]")
            for line in lines:
                terminal.detail(line)
            terminal.detail(f"{len(lines) - len(apart)} of {len(lines)} numbers agree")
    attempts = joined(parts)
    sizes = ", ".join(str(len(part)) for part in parts)
    how = f"From {len(attempts)} attempts ({sizes}), evaluated at commit {commit()}."
    return _write(args, lesson, attempts, args.attempts[0].parent, how, terminal)


def _from_bag(args: argparse.Namespace, lesson: Lesson, terminal: Terminal) -> int:
    from kr3_experiments.learning.bag import attempts_from_bag, export_looks

    if args.export_looks is not None:
        number = export_looks(args.bag, lesson, args.export_looks)
        terminal.verdict(
            True,
            f"{number} looks in {args.export_looks}: label them there, then --labels {args.export_looks}",
        )
        return 0
    attempts, skipped = attempts_from_bag(args.bag, lesson)
    if skipped:
        terminal.detail(
            f"{skipped} skills of the bag are no low-level action here, or have no truth: not counted"
        )
    return _write(
        args, lesson, attempts, args.bag.parent, f"From {len(attempts)} actions of a bag.", terminal
    )


def _write(args, lesson, attempts, folder: Path, how: str, terminal: Terminal) -> int:
    output = args.output or folder / _LEARNED
    _show(
        conclude(lesson, lesson.laws({}), attempts, output, [how], args.classes), output, terminal
    )
    return 0


def _show(lines, output: Path, terminal: Terminal) -> None:
    terminal.heading("Learned: mean [95 % interval]")
    for line in lines:
        terminal.detail(line)
    terminal.verdict(True, f"models written: {output}")
