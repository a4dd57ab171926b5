"""Room search with parts of the solver left out one by one: what each is worth."""

import json

from .figures import Figure
from .processes import run
from .session import Session, room_file


def measure(session: Session, sizes: list[int]) -> None:
    """Bounds at the times with all parts and with one part less."""
    times = ",".join(f"{time_s:g}" for time_s in session.times)
    print(
        "\nRoom search with one part of the solver left out: lower and upper bound after CPU seconds"
    )
    for cells in sizes:
        model = session.file(room_file(cells))
        output, _ = run([session.programs.path("ablation_bench"), str(model), "--times", times])
        rows = [json.loads(line) for line in output.splitlines()]
        print(f"{cells} cells{'':<24}" + "".join(f"{f'{t:g} s':>22}" for t in session.times))
        for without in dict.fromkeys(row["without"] for row in rows):
            of_part = {row["time_s"]: row for row in rows if row["without"] == without}
            bounds = "".join(_cell(of_part.get(time_s)) for time_s in session.times)
            print(f"  without {without:<26}{bounds}", flush=True)
            for row in of_part.values():
                params = {"problem": model.name, **row}
                gap = row["upper"] - row["lower"]
                session.figures.append(Figure("gap without a part", gap, params=params))


def _cell(row: dict | None) -> str:
    """Both bounds; a dash when the model was solved before."""
    return f"{row['lower']:11.3f} {row['upper']:10.3f}" if row else f"{'-':>22}"
