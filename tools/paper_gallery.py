"""Copy the figures of `lutgen paper` into the gallery and list them on its page.

    python tools/paper_gallery.py build/paper [--output maps]

The figures go to OUTPUT/paper/*.png; in OUTPUT/README.md only the lines between the two marker
comments are written, as for a map.
"""

import argparse
import shutil
import sys
from pathlib import Path

from gallery import write_page

from lutgen.errors import InputError, LutgenError

NAME = "paper"
CAPTIONS = {
    "fig08_curve": "Fig 8: stability factor over alpha, standing on a level plane",
    "fig10_surface": "Fig 10: the stability map of 50 x 50 nodes",
    "fig11_plane": "Fig 11: the map of the robot standing on a level plane",
    "fig12_steps": "Fig 12: steps 1 to 3 of the searching algorithm",
    "fig16_17_path": "Figs 16 and 17: the rough-terrain path without and with control",
}
WIDE = ("fig16_17_path",)


def block() -> str:
    """Return what stands between the markers."""
    lines = ["`make paper` builds the whole report into `build/paper/paper.html`.", ""]
    for stem, caption in CAPTIONS.items():
        width = "98%" if stem in WIDE else "49%"
        lines.append(
            f'<img src="{NAME}/{stem}.png" width="{width}" alt="paper: {caption}" '
            f'title="paper: {caption}">'
        )
    return "\n".join(lines)


def main(arguments: list[str] | None = None) -> int:
    """Run the command."""
    parser = argparse.ArgumentParser(description="Put the paper's figures into the gallery.")
    parser.add_argument("report", type=Path, help="folder of `lutgen paper`")
    parser.add_argument("--output", type=Path, default=Path(__file__).resolve().parents[1] / "maps")
    options = parser.parse_args(arguments)
    try:
        folder = options.output / NAME
        folder.mkdir(parents=True, exist_ok=True)
        for stem in CAPTIONS:
            source = options.report / f"{stem}.png"
            if not source.is_file():
                raise InputError(
                    f"{source}: there is no such figure; run `lutgen paper -o {options.report}`."
                )
            shutil.copyfile(source, folder / source.name)
        write_page(options.output / "README.md", NAME, block())
    except LutgenError as error:
        print(f"paper_gallery: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
