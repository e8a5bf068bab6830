"""`lutgen schema`: the JSON Schema of recipes, for editors."""

import json

import click


@click.command(short_help="Print the JSON Schema of recipes, for editors.")
def schema() -> None:
    """Print the JSON Schema of recipes (draft 2020-12), by which editors complete and check.

    It refuses unknown keys, wrong types and numbers out of range; `lutgen check` knows more.

    \b
    $ lutgen schema > recipe.schema.json
    """
    from lutgen.recipe import recipe_schema

    click.echo(json.dumps(recipe_schema(), indent=2, allow_nan=False))
