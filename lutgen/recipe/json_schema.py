"""The JSON Schema of recipes, for editors."""

from typing import Any

from pydantic.json_schema import GenerateJsonSchema
from pydantic_core import core_schema

from lutgen.recipe.schema import File


class _Writer(GenerateJsonSchema):
    """Writes what TOML can say, in the order of the keys: it has no null."""

    def sort(self, value: Any, parent_key: str | None = None) -> Any:
        return value

    def field_title_should_be_set(self, schema: Any) -> bool:
        return False

    def nullable_schema(self, schema: core_schema.NullableSchema) -> dict[str, Any]:
        return self.generate_inner(schema["schema"])

    def default_schema(self, schema: core_schema.WithDefaultSchema) -> dict[str, Any]:
        if schema.get("default", ...) is None:
            return self.generate_inner(schema["schema"])
        return super().default_schema(schema)


def recipe_schema() -> dict[str, Any]:
    """Return the JSON Schema of recipes, draft 2020-12, as plain lists and dicts.

    It knows keys, types and intervals.  What keys demand of each other, such as that a name is that
    of a link, only `parse_recipe` refuses.
    """
    return {"$schema": _Writer.schema_dialect, **File.model_json_schema(schema_generator=_Writer)}
