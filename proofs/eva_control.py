"""Frama-C Eva on on-board control: no undefined behaviour, whatever bits come in.

Owns the export that it is shown for, on three points; a state begins as `smap_start` leaves it and
goes through three cycles of any input.  Of many contacts there is no proof, as of their reads.
That commands are on their axes it does not show; `proofs.control` attacks that.
"""

import re
import shutil
from pathlib import Path

from firmware_export.control import Wishes, steered
from firmware_export.emit import package
from proofs.annotate import annotate
from proofs.eva import analysed, verdict
from proofs.exports import tripod_export
from proofs.tools import FAILED, OK, Clock, Result

HARNESS = Path(__file__).with_name("eva_control.c")
NAME = "steered"


def prove_steered(folder: Path, patience: float) -> Result:
    """Prove an export on three points with a policy; `folder` is to work in."""
    export, _ = steered(tripod_export(NAME), Wishes(nodes=5))
    made = folder / "export"
    package.write(export, made)
    for path in made.glob("*.[ch]"):
        shutil.copy(path, folder / path.name)
    smap = folder / "smap.c"
    smap.write_text(annotate(smap.read_text("utf-8")), "utf-8")
    text = HARNESS.read_text("utf-8").replace("@NAME@", NAME)
    text = text.replace("@PARAMS@", str(export.model.k))
    with Clock() as clock:
        said = analysed(text, folder, patience)
    (folder / "eva.log").write_text(said, encoding="utf-8")
    wrong = verdict(said)
    reached = re.search(r"statements reached \(out of \d+\): (\d+)%", said)
    words = wrong or f"0 alarms, {reached[1] if reached else 0} % read"
    return Result("eva, control", NAME, FAILED if wrong else OK, words, clock.seconds)
