#!/usr/bin/env python3
"""Makes the report: rows in, one self-contained HTML file out.

bench/report/report.py ROWS.jsonl... [--pictures DIR]... --out report.html [--svg DIR] [--winners]
"""

import argparse
import sys
from pathlib import Path

if __package__ in (None, ""):  # run as a file
    sys.path[0] = str(Path(__file__).resolve().parents[2])

from bench.report import rows as reader
from bench.report import winners


MOST_WARNINGS = 10  # that are printed: two files of one run repeat thousands of cells


def main(argv=None, validate=True):
    """validate: hold each chart against Vega-Lite's schema, which takes longer than all else. Tests do; who makes a report
    draws the same charts of other rows, and need not wait for that."""
    parser = argparse.ArgumentParser(prog="report.py", description="Makes one HTML report of result rows.")
    parser.add_argument("rows", nargs="+", metavar="ROWS.jsonl", help="result files, as --rows of a benchmark writes them")
    parser.add_argument("--pictures", action="append", default=[], metavar="DIR", help="folder with a pictures.jsonl")
    parser.add_argument("--out", metavar="FILE", help="the report, an HTML file")
    parser.add_argument("--svg", metavar="DIR", help="each chart as SVG and PNG, too")
    parser.add_argument("--winners", action="store_true", help="print a short table of winners")
    parser.add_argument("--title", default="Treeline: speed against accuracy")
    arguments = parser.parse_args(argv)
    if not (arguments.out or arguments.svg or arguments.winners):
        parser.error("nothing to do: give --out, --svg or --winners")
    try:
        rows = reader.read(arguments.rows)
        if not len(rows):
            raise reader.RowError(f"no rows in {', '.join(arguments.rows)}")
        warnings = list(rows.warnings)
        if arguments.out or arguments.svg:
            warnings += _draw(rows, arguments, validate)
    except (OSError, reader.RowError) as error:
        print(f"report: {error}", file=sys.stderr)
        return 2
    for warning in warnings[:MOST_WARNINGS]:
        print(f"report: warning: {warning}", file=sys.stderr)
    if more := len(warnings[MOST_WARNINGS:]):
        print(f"report: {more} more warning{'s' if more > 1 else ''}; the report lists them", file=sys.stderr)
    if arguments.out and not arguments.winners:
        print(f"Report: {arguments.out}")
    if arguments.winners:
        print(winners.table(list(rows)) or "No row of a method that promises exact answers has a time.")
    return 0


def _draw(rows, arguments, validate):
    from altair.utils import schemapi
    from bench.report import model, page, pictures, static  # these need Altair; the rest does not

    shown, warnings = pictures.read(arguments.pictures)
    with schemapi.debug_mode(validate):
        if arguments.out:
            out = Path(arguments.out)
            out.parent.mkdir(parents=True, exist_ok=True)
            out.write_text(page.build(rows, shown, arguments.title))
        if arguments.svg:
            static.save_all(model.task_models(rows), arguments.svg)
    return warnings


if __name__ == "__main__":
    sys.exit(main(validate=False))
