"""scripts/validation: predicts the measured limits of scenarios/validation and writes its page and its figure."""
import sys
from pathlib import Path

from hapbench_command import SUCCESS, Arguments, Notice, write

from .cases import FOLDER, ROOT, read_cases
from .page import figure, page
from .predict import Predictor, predictions, record

PAGE, FIGURE = FOLDER / "README.md", FOLDER / "validation.svg"


def main():
    parser = Arguments(prog="scripts/validation", description=__doc__)
    parser.add_argument("--program", type=Path, default=ROOT / "build" / "release" / "bin" / "hapbench", help="the built program")
    parser.add_argument("--samples", type=int, default=1600, help="of the unpublished inputs, for each fit (default 1600)")
    parser.add_argument("--jobs", type=int, default=2, help="runs at a time (default 2)")
    given = parser.parse_args()
    data, cases = read_cases()
    predictor = Predictor(given.program.resolve(), given.jobs)
    with Notice("predicting") as notice:
        found = predictions(predictor, data, cases, given.samples, notice.say)
    recorded = record(given.program.resolve(), data, cases, found)
    write(FIGURE, figure(data, cases, recorded))
    write(PAGE, page(data, cases, recorded))
    return SUCCESS


if __name__ == "__main__":
    sys.exit(main())
