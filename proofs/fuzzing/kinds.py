"""The kinds of input: who makes their cases, and how many belong to a campaign of full length."""

import random
import zlib
from collections.abc import Callable
from dataclasses import dataclass, replace

from proofs.fuzzing import commands, descriptions, mapfiles, recipes, terrains
from proofs.fuzzing.case import Case

__all__ = ["KINDS", "Kind"]


@dataclass(frozen=True)
class Kind:
    """A kind of input: its `title` in the table, and the `count` of its cases."""

    title: str
    count: int
    make: Callable[[random.Random], Case]

    def case(self, seed: int, at: int) -> Case:
        """Return the case of a number, which is the same whatever was made before it."""
        name = f"{seed} {self.title} {at}".encode()
        case = self.make(random.Random(zlib.crc32(name) + (at << 32)))
        # No system hands a NUL over.
        return replace(case, words=tuple(word.replace("\x00", "0") for word in case.words))


KINDS = {
    "recipe": Kind("recipes", 20_000, recipes.make),
    "urdf": Kind("robot descriptions", 10_000, descriptions.make),
    "csv": Kind("terrains", 5_000, terrains.make),
    "map": Kind("maps", 5_000, mapfiles.make),
    "command": Kind("command lines", 5_000, commands.make),
}
