"""The picture of docs/clash.md: a dowel of the gearbox, and the plate that it enters.

    cargo build --release -p impinge-cli
    python3 docs/images/clash.py target/release/impinge

The script needs no packages. It writes docs/images/clash.png.
"""

import json
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
GEARBOX = ROOT / "data" / "cad_cycloidal_gearbox.glb"
RULES = """
[sets]
dowels = { name = "dowel*" }
plates = { name = "fixed_lower*" }

[[rule]]
a = "dowels"
b = "plates"
"""


def main() -> None:
    command = Path(sys.argv[1]).resolve()
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "rules.toml").write_text(RULES)
        # The numbers of the file are millimeters, although glTF is in meters.
        arguments = ["clash", GEARBOX, "--rules", "rules.toml", "--json=out.json", "--pictures", "out"]
        run = subprocess.run([command, *arguments], cwd=folder, stdout=subprocess.DEVNULL)
        if run.returncode != 1:
            sys.exit("a dowel and the plate should clash")
        report = json.loads((Path(folder) / "out.json").read_text())
        worst = report["groups"][0]["clashes"][0]
        shutil.copy(Path(folder) / "out" / f"{worst}.png", ROOT / "docs" / "images" / "clash.png")


if __name__ == "__main__":
    main()
