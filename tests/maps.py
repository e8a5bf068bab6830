"""Map files that tests edit."""

from pathlib import Path


def unseal(path: Path) -> None:
    """Make a map one without a digest, as of an earlier lutgen, so that HDF5 may edit it."""
    content = path.read_bytes()
    assert content.count(b"lutgen-digest-1") == 1
    path.write_bytes(content.replace(b"lutgen-digest-1", b"another-digest-"))
