"""`lutgen paper`: the paper's simulations, figures and table in one folder."""

import click

from lutgen.cli.options import log


@click.command(short_help="Reproduce the paper: figures, tables, one page.")
@click.option(
    "-o", "--output", required=True, type=click.Path(file_okay=False), help="Folder to write."
)
def paper(output: str) -> None:
    """Compute the paper's three simulations again and write a report.

    The folder gets paper.html, which needs no other file, and beside it the figures as PNG, the
    numbers as CSV and the stability map as HDF5.  It takes about half a minute of one core once the
    kernels are compiled.

    \b
    $ lutgen paper -o paper
    """
    from lutgen.paper import write_report

    click.echo(write_report(output, lambda what: log.info("%s", what)))
