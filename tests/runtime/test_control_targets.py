"""Cycles of on-board control on an emulated chip give the bits of this machine."""

import pytest

from targets import control
from targets.boards import board


@pytest.mark.needs("arm-none-eabi-gcc")
@pytest.mark.needs("qemu-system-arm")
def test_a_chip_commands_what_this_machine_does_bit_for_bit(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("firmware_export.control.objective.POSTURES", 100)
    robot = control.prepared("paper_two")
    found = control.execute(robot, board("m4f"), "-O2")
    assert found.hash == robot.wanted
    assert len(found.counts) == control.CYCLES
    assert max(found.counts) < 5_000
    assert found.stack is not None
    assert found.stack <= 600
