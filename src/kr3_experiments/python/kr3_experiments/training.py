"""`./kr3 train`: render labelled pictures of a domain's objects, learn their looks, check the detector on others."""
import argparse
import json
import os
import shutil
import time
from pathlib import Path
from typing import Any, Dict, List, Sequence

from kr3_experiments.bringup import add_domain_argument, existing_run_dir, new_run_dir
from kr3_experiments.domain import find_folder, repository_root
from kr3_experiments.errors import Kr3Error
from kr3_experiments.processes import ManagedProcess, describe_exit, end_processes
from kr3_experiments.programs import find_program
from kr3_experiments.terminal import Terminal
from kr3_experiments.yaml_file import read_mapping

MODEL = "perception.yml.gz"
NEEDED = ("building.yaml", "objects.yaml")
CHECKED = ("easy", "clutter", "rotated", "confusable", "home")
LOOKS_SIZE = 160  # pictures of a test set, to which those of the other sets are in proportion
CALIBRATION_SIZE = 240
CHECK_SIZE = 45
QUICK = 4  # with --quick, so many times less
CHECK_SEEDS_FROM = 10000  # seeds of pictures to check with: none of those to learn from


def add_options(parser: argparse.ArgumentParser) -> None:
    """Options of the command."""
    add_domain_argument(parser)
    parser.add_argument(
        "--also-in",
        nargs="+",
        default=[],
        metavar="DOMAIN",
        help="domains with the same objects that are to share the model: their buildings teach as well",
    )
    parser.add_argument("--seed", type=int, default=1, help="of the pictures (default: 1)")
    parser.add_argument("--quick", action="store_true", help="few pictures: a worse model")
    parser.add_argument(
        "--views", type=int, default=24, help="learned views of an object (default: 24)"
    )
    parser.add_argument(
        "--keypoints", type=int, default=50, help="local features of a view (default: 50)"
    )
    parser.add_argument(
        "--output",
        type=Path,
        metavar="FILE",
        help=f"where the model goes (default: the domain's {MODEL})",
    )
    parser.add_argument("--run-dir", type=Path, metavar="DIR", help="default: a new one in runs/")
    parser.add_argument(
        "--keep-pictures", action="store_true", help="leave the pictures in the run's folder"
    )


def run(args: argparse.Namespace) -> int:
    """@return 0 when the model was written and checked"""
    terminal = Terminal()
    if not 0 <= args.seed < CHECK_SEEDS_FROM:
        raise Kr3Error(f"--seed {args.seed}: expected a number from 0 to {CHECK_SEEDS_FROM - 1}")
    domains = [domain_folder(name) for name in (args.domain, *args.also_in)]
    require_same_objects(domains)
    output = (args.output or domains[0] / MODEL).resolve()
    run_dir = new_run_dir("train") if args.run_dir is None else existing_run_dir(args.run_dir)
    work = Work(run_dir, terminal)
    share = QUICK if args.quick else 1
    started = time.monotonic()
    terminal.heading(f"Rendering pictures of the objects of {domains[0].name}")
    work.render(domains, ["looks"], LOOKS_SIZE // share, args.seed)
    work.render(domains, ["calibration"], CALIBRATION_SIZE // share, args.seed)
    work.render(domains, CHECKED, CHECK_SIZE // share, args.seed + CHECK_SEEDS_FROM)
    terminal.heading("Learning")
    model = run_dir / MODEL
    learn = ["train_detector", str(work.pictures / "looks"), "--out", str(model)]
    learn += ["--calibrate", str(work.pictures / "calibration")]
    learn += ["--objects", str(domains[0] / "objects.yaml")]
    learn += ["--views", str(args.views), "--keypoints", str(args.keypoints)]
    work.program(*learn)
    terminal.heading("Checking on pictures from other rooms, viewpoints and lights")
    figures = run_dir / "perception.json"
    check = ["evaluate_detector", str(model), *(str(work.pictures / name) for name in CHECKED)]
    work.program(*check, "--json", str(figures), "--diagrams", str(run_dir / "diagrams"))
    report = table(json.loads(figures.read_text(encoding="utf-8")))
    (run_dir / "report.txt").write_text("\n".join(report) + "\n", encoding="utf-8")
    for line in report:
        terminal.line(line)
    if not args.keep_pictures:
        shutil.rmtree(work.pictures)
    # Last, so that an interrupted run leaves the old model as it was.
    try:
        shutil.copyfile(model, output)
    except OSError as error:
        raise Kr3Error(f"{output}: {error.strerror} (the model is in {model})") from error
    terminal.detail(f"report, reliability diagrams, logs: {run_dir}")
    terminal.verdict(
        True,
        f"model written: {output} ({os.path.getsize(output) / 1000:.0f} kB,"
        f" {time.monotonic() - started:.0f} s)",
    )
    return 0


def domain_folder(name: str) -> Path:
    """A domain of which pictures can be made. @throws Kr3Error  there is none, or it lacks a file"""
    root = repository_root()
    folder = find_folder(name, root)
    for file in NEEDED:
        if not (folder / file).is_file():
            known = sorted(
                entry.name
                for entry in (root / "domains").glob("*")
                if all((entry / needed).is_file() for needed in NEEDED)
            )
            raise Kr3Error(
                f"{folder / file} is missing; domains with building and objects are"
                f" {', '.join(known) or 'none'}"
            )
    return folder


def require_same_objects(domains: Sequence[Path]) -> None:
    """@throws Kr3Error  the objects' texts differ by more than the folder of their textures"""
    first = _objects_of(domains[0])
    for other in domains[1:]:
        theirs = _objects_of(other)
        if theirs != first:
            different = sorted(
                name for name in {*first, *theirs} if first.get(name) != theirs.get(name)
            )
            raise Kr3Error(
                f"{other / 'objects.yaml'}: not the objects of {domains[0].name}"
                f" ({', '.join(different)} differ): it needs a model of its own"
            )


def _objects_of(domain: Path) -> Dict[str, Any]:
    """Name to entry, its texture by the file's content."""
    file = domain / "objects.yaml"
    try:
        entries = read_mapping(file)["objects"]
        return {
            entry["name"]: {**entry, "texture": (domain / entry["texture"]).read_bytes()}
            for entry in entries
        }
    except (OSError, KeyError, TypeError) as error:
        raise Kr3Error(f"{file}: {error}") from error


class Work:
    """Runs the programs of kr3_perception one after the other, each with its log in the run's folder."""

    def __init__(self, run_dir: Path, terminal: Terminal) -> None:
        self.pictures = run_dir / "pictures"
        self._logs = run_dir / "log"
        self._terminal = terminal
        self._count = 0

    def render(self, domains: Sequence[Path], sets: Sequence[str], size: int, seed: int) -> None:
        """Sets of pictures of the first domain's objects. @throws Kr3Error  it failed"""
        command = ["make_labelled_sets", str(domains[0]), str(self.pictures)]
        command += ["--size", str(size), "--seed", str(seed), "--sets", *sets]
        if len(domains) > 1:
            command += ["--also-in", *(str(domain) for domain in domains[1:])]
        self.program(*command)

    def program(self, name: str, *arguments: str) -> None:
        """Run it to its end; its lines go to the terminal as well. @throws Kr3Error  it failed"""
        self._count += 1
        log = self._logs / f"{self._count}_{name}.log"
        command = [find_program("kr3_perception", name), *arguments]
        process = ManagedProcess(name, command, log, os.environ)
        try:
            shown = 0
            while process.exit_code() is None:
                time.sleep(0.2)
                shown = self._show(log, shown)
            self._show(log, shown)
        finally:
            end_processes([process])
        code = process.exit_code()
        if code != 0:
            raise Kr3Error(
                f"{name} failed ({describe_exit(code or 0)}); the end of {log}:\n{process.log_tail()}"
            )

    def _show(self, log: Path, shown: int) -> int:
        text = log.read_text(encoding="utf-8", errors="replace")
        complete = text[shown : text.rfind("\n") + 1]
        for line in complete.splitlines():
            self._terminal.detail(line)
        return shown + len(complete)


def table(figures: Dict[str, Any]) -> List[str]:
    """Precision and recall of each set and class, a line a set. @param figures  of evaluate_detector --json"""
    classes = sorted({name for result in figures["sets"] for name in result["classes"]})
    lines = [
        f"precision / recall of detections with a probability of {figures['threshold']:g} and more",
        f"{'set':<12}{'all':>14}{''.join(f'{name:>14}' for name in classes)}{'Brier':>8}{'CPU ms':>8}",
    ]
    for result in figures["sets"]:
        cells = [_cell(result["all"])]
        cells += [_cell(result["classes"].get(name)) for name in classes]
        lines.append(
            f"{result['set']:<12}{''.join(f'{cell:>14}' for cell in cells)}"
            f"{result['brier']:>8.3f}{result['cpu_ms']['median']:>8.1f}"
        )
    return lines


def _cell(score: Any) -> str:
    return "-" if score is None else f"{score['precision']:.3f} / {score['recall']:.3f}"
