"""Compares generated problems with the published files, entry by entry."""

import numpy as np

from benchmark_models.catalogue import PROBLEMS

from .figures import Figure
from .processes import BenchmarkError
from .session import Session


def measure(session: Session) -> None:
    """The greatest difference of any probability or reward, and in how many rows it is above 1e-4.

    States, actions and observations correspond by their order. Published files round to six digits.

    @raises BenchmarkError  no data folder, no Python module, or sizes that differ
    """
    if session.data is None:
        raise BenchmarkError("the section 'models' needs --data")
    try:
        import kr3_pomdp
    except ImportError as error:
        raise BenchmarkError(f"the section 'models' needs the Python module: {error}") from error
    print("\nGenerated problems beside the published files: greatest difference of an entry")
    for name in PROBLEMS:
        if (session.data / name).is_file():
            published = kr3_pomdp.loadModel(str(session.data / name))
            ours = kr3_pomdp.loadModel(str(session.generated(name)))
            difference, rows = compare(ours, published, name)
            params = {"problem": name, "rows_above_1e-4": rows}
            session.add(Figure("difference", difference, params=params))


def compare(ours, published, name: str) -> tuple[float, int]:
    """The greatest difference, and the number of rows of T, O and R with one above 1e-4.

    @raises BenchmarkError  sizes that differ
    """
    sizes = [(m.numStates(), m.numActions(), m.numObservations()) for m in (ours, published)]
    if sizes[0] != sizes[1]:
        raise BenchmarkError(f"{name}: found sizes {sizes[0]}, published {sizes[1]}")
    by_row = [
        _rows(_entries(ours.transitionEntries(), published.transitionEntries(), sizes[0][0])),
        _rows(_entries(ours.observationEntries(), published.observationEntries(), sizes[0][2])),
        np.abs(ours.rewardArray() - published.rewardArray()).ravel(),
    ]
    greatest = max(float(row.max(initial=0.0)) for row in by_row)
    return greatest, sum(int((row > 1e-4).sum()) for row in by_row)


def _entries(ours, published, width: int) -> tuple[np.ndarray, np.ndarray]:
    """Row numbers and differences of what either model has; the row is made of the first two indices."""
    indices = np.concatenate([ours[0], published[0]])
    values = np.concatenate([ours[1], -published[1]])
    states = int(indices[:, 1].max()) + 1
    flat = (indices[:, 0] * states + indices[:, 1]) * width + indices[:, 2]
    places, inverse = np.unique(flat, return_inverse=True)
    return places // width, np.bincount(inverse, weights=values)


def _rows(entries: tuple[np.ndarray, np.ndarray]) -> np.ndarray:
    """The greatest difference of each row."""
    rows, differences = entries
    result = np.zeros(int(rows.max()) + 1)
    np.maximum.at(result, rows, np.abs(differences))
    return result
