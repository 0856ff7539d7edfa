"""A virtual environment with the pinned peers, beside this file or where LAB_PEERS_VENV says. A peer that cannot be had is reported, not fatal."""

import hashlib
import os
import subprocess
import sys
import venv
from pathlib import Path

HERE = Path(__file__).resolve().parent
FOLDER = Path(os.environ.get("LAB_PEERS_VENV", HERE / ".venv")).resolve()
PYTHON = str(FOLDER / "bin" / "python")
REQUIREMENTS = HERE / "requirements.txt"


def ensure():
    """Installs what requirements.txt pins, once per content of that file."""
    wanted = hashlib.sha256(REQUIREMENTS.read_bytes()).hexdigest()
    stamp = FOLDER / "installed"
    if stamp.exists() and stamp.read_text() == wanted:
        return
    print(f"installing the peers into {FOLDER}", file=sys.stderr)
    venv.create(FOLDER, with_pip=True, clear=True)
    missing = []
    for line in REQUIREMENTS.read_text().split():
        # Every pin constrains every install, so that no peer moves another one's numpy.
        done = subprocess.run(
            [PYTHON, "-m", "pip", "install", "-q", "--disable-pip-version-check", "--only-binary", ":all:", "-c", REQUIREMENTS, line],
            stdout=sys.stderr,
        )
        if done.returncode != 0:
            missing.append(line)
    if "numpy" in " ".join(missing):
        sys.exit("numpy itself could not be installed; the comparison cannot be run")
    for line in missing:
        print(f"{line} could not be installed; its rows will say so", file=sys.stderr)
    stamp.write_text(wanted)
