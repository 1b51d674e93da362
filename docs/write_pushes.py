"""Draws the pictures of docs/control.md: `python -m docs.write_pushes RUN IMPULSE DIRECTION HEIGHT`.

RUN is a search of problems/icub_push.toml. One picture is its front; in the other, the lightest robot of the
front, that of the least human torque and that of the largest push margin are pushed in turn, each by IMPULSE
[N s] to DIRECTION [deg] while they hold the load at HEIGHT [m]: moments of the films of `evodesign simulate`.
"""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path
from tempfile import TemporaryDirectory

from PIL import Image, ImageDraw, ImageSequence

import evodesign
from docs.write_gallery import COMMAND, DOCS, draw
from evodesign.api.run import Run
from evodesign.simulation.film import EVERY
from evodesign.simulation.rollout import FRAME

PICTURES = DOCS / "pictures"
SECONDS = (0.04, 0.2, 0.4, 0.8, 1.6)
"""Moments after the beginning of a push [s]; where a film is over by then, its last picture stays."""

SHOWN = (120, 30, 400, 345)
"""Left, top, right and bottom of what is shown of a picture [px]."""


def shown_designs(run: Run) -> dict[str, int]:
    """Three of the front, by what they are."""
    front = run.front
    return {
        "lightest": min(front, key=lambda each: each.objectives["mass"]).number,
        "least human torque": min(front, key=lambda each: each.objectives["human_torque"]).number,
        "largest push margin": max(front, key=lambda each: each.objectives["push_margin"]).number,
    }


def films(path: Path, designs: Mapping[str, int], push: tuple[str, str, str], picture: Path) -> None:
    """Moments of films of some designs, a row each."""
    impulse, direction, height = push
    left, top, right, bottom = SHOWN
    size = len(SECONDS) * (right - left), len(designs) * (bottom - top)
    whole = Image.new("RGB", size, "white")
    for row, (name, number) in enumerate(designs.items()):
        with TemporaryDirectory() as folder:
            video = Path(folder) / "push.gif"
            asked = ["--push", impulse, "--direction", direction, "--height", height, "--video", str(video)]
            subprocess.run([*COMMAND, "simulate", str(path), str(number), *asked], check=True)
            pictures = [each.convert("RGB") for each in ImageSequence.Iterator(Image.open(video))]
        for column, seconds in enumerate(SECONDS):
            shown = pictures[min(round(seconds / (EVERY * FRAME)), len(pictures) - 1)].crop(SHOWN)
            whole.paste(shown, (column * shown.width, row * shown.height))
            text = f"{seconds:g} s" if column else f"design {number}: {name}, {seconds:g} s"
            ImageDraw.Draw(whole).text((column * shown.width + 6, row * shown.height + 4), text, "white")
    whole.quantize(128).save(picture, optimize=True)


def main(path: Path, push: tuple[str, str, str]) -> None:
    """Draw front and films of a run."""
    run = evodesign.open_run(path)
    draw(run, PICTURES / "push_front.png")
    films(path, shown_designs(run), push, PICTURES / "push_films.png")


if __name__ == "__main__":
    main(Path(sys.argv[1]).resolve(), (sys.argv[2], sys.argv[3], sys.argv[4]))
