"""`lutgen paper`: the paper's simulations, figures and table in one folder."""

from dataclasses import dataclass

import click

from lutgen.cli.options import Named, as_json, asks, force, log, option
from lutgen.cli.table import show


@dataclass(frozen=True)
class Asked:
    """What the command line says."""

    output: str = option("-o", required=True, type=Named(file_okay=False), help="Folder to write.")
    force: bool = force()
    as_json: bool = as_json()


@click.command(short_help="Reproduce the paper: figures, tables, one page.")
@asks(Asked)
def paper(asked: Asked) -> None:
    """Compute the paper's three simulations again and write a report.

    The folder gets paper.html, which needs no other file, and beside it the figures as PNG, the
    numbers as CSV and the stability map as HDF5.  It takes about half a minute of one core once the
    kernels are compiled.

    \b
    $ lutgen paper -o paper
    """
    from lutgen.paper import write_report

    page = str(write_report(asked.output, lambda what: log.info("%s", what), asked.force))
    show({"folder": asked.output, "page": page}, [page], asked.as_json)
