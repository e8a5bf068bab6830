"""Cycles of on-board control on an emulated chip give the bits of this machine."""

import pytest

from targets import control
from targets.boards import board


@pytest.mark.needs("arm-none-eabi-gcc")
@pytest.mark.needs("qemu-system-arm")
@pytest.mark.parametrize(
    ("name", "most", "stack"), [("paper_two", 5_000, 600), ("marv", 250_000, 2_000)]
)
def test_a_chip_commands_what_this_machine_does_bit_for_bit(
    name: str, most: int, stack: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    # The chip has the room of the export for a pose, this machine the most that there is.
    monkeypatch.setattr("firmware_export.control.objective.POSTURES", 100)
    robot = control.prepared(name)
    found = control.execute(robot, board("m4f"), "-O2")
    assert found.hash == robot.wanted
    assert len(found.counts) == control.CYCLES
    assert max(found.counts) < most
    assert found.stack is not None
    assert found.stack <= stack
